//! Ways to damage a file.

use crate::random::Random;
use std::ops::Range;

/// Numbers at the edges of what types hold, as they are written in text.
const EXTREMES: &[&str] = &[
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "0.5",
    "1e-320",
    "-1e-9",
    "1e39",
    "1e308",
    "-1e308",
    "1e999",
    "nan",
    "NaN",
    ".nan",
    "-nan",
    "inf",
    "-inf",
    ".inf",
    "64",
    "127",
    "128",
    "255",
    "256",
    "1000",
    "32768",
    "65535",
    "65536",
    "1000000",
    "2147483647",
    "2147483648",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "1_000",
    "0x10",
    "0b1",
    "1e",
    "1.",
    "+1",
];

/// Bytes that mean something to binary formats: lengths, numbers that are not finite, variable-length integers.
const BYTES: &[&[u8]] = &[
    &[0],
    &[1],
    &[0x7f],
    &[0x80],
    &[0xff],
    &[0, 0, 0, 0],
    &[0xff, 0xff, 0xff, 0xff],
    &[0xff, 0xff, 0xff, 0x7f],
    &[0, 0, 0xc0, 0x7f],
    &[0, 0, 0x80, 0x7f],
    &[0, 0, 0x80, 0xff],
    &[0xff, 0xff, 0x7f, 0x7f],
    &[0, 0, 0, 0, 0, 0, 0xf8, 0x7f],
    &[0, 0, 0, 0, 0, 0, 0xf0, 0x7f],
    &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xef, 0x7f],
    &[0xff, 0xff, 0xff, 0xff, 0x0f],
    &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01],
];

/// What damages: whether files are text, words that mean something in them, and how long they may get.
pub(crate) struct Damage<'a> {
    pub(crate) text: bool,
    pub(crate) words: &'a [&'a str],
    pub(crate) longest: usize,
}

impl Damage<'_> {
    /// Damages `input` once or a few times; `other` is another file to take parts from.
    pub(crate) fn apply(&self, input: &mut Vec<u8>, other: &[u8], random: &mut Random) {
        let mut more = true;
        while more {
            if self.text && !random.one_in(4) {
                self.damage_words(input, other, random);
            } else {
                self.damage_bytes(input, other, random);
            }
            input.truncate(self.longest);
            // Mostly once: what is damaged in many places is refused for the first of them.
            more = random.one_in(3);
        }
    }

    fn damage_words(&self, input: &mut Vec<u8>, other: &[u8], random: &mut Random) {
        let words = words(input);
        if words.is_empty() {
            input.extend_from_slice(other);
            return;
        }
        let word = random.pick(&words).clone();
        match random.below(14) {
            0..=6 => {
                let numbers: Vec<_> = words
                    .into_iter()
                    .filter(|word| is_number(&input[word.clone()]))
                    .collect();
                if !numbers.is_empty() {
                    let (number, other) = (random.pick(&numbers).clone(), random.pick(&numbers).clone());
                    let instead = match random.below(3) {
                        0 => input[other].to_vec(),
                        1 => near(&input[number.clone()], random),
                        _ => random.pick(EXTREMES).as_bytes().to_vec(),
                    };
                    replace(input, number, &instead);
                }
            }
            7 => replace(input, word, &[]),
            8 => {
                let times = if random.one_in(8) {
                    1 + random.below(3000)
                } else {
                    2
                };
                let repeated = input[word.clone()].repeat(times);
                replace(input, word, &repeated);
            }
            9 => {
                let (a, b) = (input[word.clone()].to_vec(), random.pick(&words).clone());
                let b = input[b].to_vec();
                replace(input, word, &[b, a].concat());
            }
            10 if !self.words.is_empty() => replace(input, word, random.pick(self.words).as_bytes()),
            11 if !self.words.is_empty() => insert(input, word.start, random.pick(self.words).as_bytes()),
            12 => self.move_lines(input, other, random),
            _ => {
                let others = self::words(other);
                if !others.is_empty() {
                    replace(input, word, &other[random.pick(&others).clone()]);
                }
            }
        }
    }

    /// Deletes, doubles, swaps or takes over whole lines.
    fn move_lines(&self, input: &mut Vec<u8>, other: &[u8], random: &mut Random) {
        let lines = |bytes: &[u8]| {
            bytes
                .split_inclusive(|&byte| byte == b'\n')
                .map(<[u8]>::to_vec)
                .collect::<Vec<_>>()
        };
        let (mut own, others) = (lines(input), lines(other));
        if own.is_empty() || others.is_empty() {
            return;
        }
        let (from, to) = (random.below(own.len()), random.below(own.len()));
        match random.below(4) {
            0 => drop(own.remove(from)),
            1 => own.insert(to, own[from].clone()),
            2 => own.swap(from, to),
            _ => {
                let first = random.below(others.len());
                let end = (first + 1 + random.below(6)).min(others.len());
                own.splice(to..to, others[first..end].iter().cloned());
            }
        }
        *input = own.concat();
    }

    fn damage_bytes(&self, input: &mut Vec<u8>, other: &[u8], random: &mut Random) {
        let at = random.below(input.len());
        let length = if random.one_in(4) {
            random.below(input.len())
        } else {
            random.below(9)
        };
        let range = at..(at + length).min(input.len());
        match random.below(9) {
            0 if at < input.len() => input[at] ^= 1 << random.below(8),
            1 if at < input.len() => input[at] = random.next() as u8,
            2 if at < input.len() => {
                input[at] = input[at].wrapping_add(if random.one_in(2) { 1 } else { 255 })
            }
            3 => replace(input, range, &[]),
            4 => {
                let copy = input[range].to_vec();
                insert(input, random.below(input.len() + 1), &copy);
            }
            5 => insert(input, at, random.pick::<&[u8]>(BYTES)),
            6 => {
                let bytes: &[u8] = random.pick::<&[u8]>(BYTES);
                let end = (at + bytes.len()).min(input.len());
                replace(input, at..end, bytes);
            }
            7 => {
                let from = random.below(other.len());
                input.truncate(at);
                input.extend_from_slice(&other[from..]);
            }
            _ => input.truncate(at),
        }
    }
}

fn replace(input: &mut Vec<u8>, range: Range<usize>, bytes: &[u8]) {
    input.splice(range, bytes.iter().copied());
}

fn insert(input: &mut Vec<u8>, at: usize, bytes: &[u8]) {
    replace(input, at..at, bytes);
}

/// Runs of letters and digits, and every other byte that is no blank.
fn words(bytes: &[u8]) -> Vec<Range<usize>> {
    let inner = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'_' | b'-' | b'+');
    let mut words = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let length = bytes[at..].iter().take_while(|&&byte| inner(byte)).count().max(1);
        if !bytes[at].is_ascii_whitespace() {
            words.push(at..at + length);
        }
        at += length;
    }
    words
}

/// A number a little larger or smaller, or its negative.
fn near(word: &[u8], random: &mut Random) -> Vec<u8> {
    let number = std::str::from_utf8(word)
        .ok()
        .and_then(|word| word.parse::<f64>().ok())
        .unwrap_or(0.0);
    let changed = match random.below(5) {
        0 => number + 1.0,
        1 => number - 1.0,
        2 => -number,
        3 => 2.0 * number,
        _ => 0.5 * number,
    };
    changed.to_string().into_bytes()
}

fn is_number(word: &[u8]) -> bool {
    std::str::from_utf8(word).is_ok_and(|word| word.parse::<f64>().is_ok())
}
