//! Phones and how syllables are made of them. Formants are those of a man of average size, hertz.
//!
//! Vowels after Peterson and Barney (1952); places of consonants as usual in formant synthesis (Klatt 1980).

use crate::acoustics::random::{Generator, between};
use rand::Rng;

/// What a phone asks of source and tract.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Phone {
    /// The first three formants.
    pub(crate) formants_hz: [f32; 3],
    /// Voice, 0 to 1.
    pub(crate) voice: f32,
    /// Breath through the tract, 0 to 1.
    pub(crate) breath: f32,
    /// Noise of a narrow passage: its strength, middle and width.
    pub(crate) friction: f32,
    pub(crate) friction_hz: f32,
    pub(crate) friction_width_hz: f32,
    /// How far the mouth is open, 0 to 1.
    pub(crate) mouth: f32,
    /// Usual length, seconds.
    pub(crate) length_s: f32,
    /// Whether it sets in and ends at once: the burst of a stop.
    pub(crate) sudden: bool,
}

const fn vowel(formants_hz: [f32; 3], mouth: f32) -> Phone {
    Phone {
        formants_hz,
        voice: 1.0,
        breath: 0.03,
        friction: 0.0,
        friction_hz: 3000.0,
        friction_width_hz: 1000.0,
        mouth,
        length_s: 0.125,
        sudden: false,
    }
}

const fn sonorant(formants_hz: [f32; 3], voice: f32, mouth: f32) -> Phone {
    Phone {
        voice,
        length_s: 0.06,
        ..vowel(formants_hz, mouth)
    }
}

const fn fricative(
    formants_hz: [f32; 3],
    friction: f32,
    hz: f32,
    width_hz: f32,
    voice: f32,
    mouth: f32,
) -> Phone {
    Phone {
        voice,
        breath: 0.0,
        friction,
        friction_hz: hz,
        friction_width_hz: width_hz,
        length_s: 0.09,
        ..vowel(formants_hz, mouth)
    }
}

const VOWELS: [Phone; 9] = [
    vowel([270.0, 2290.0, 3010.0], 0.30),
    vowel([390.0, 1990.0, 2550.0], 0.40),
    vowel([530.0, 1840.0, 2480.0], 0.60),
    vowel([660.0, 1720.0, 2410.0], 0.85),
    vowel([730.0, 1090.0, 2440.0], 1.00),
    vowel([570.0, 840.0, 2410.0], 0.75),
    vowel([440.0, 1020.0, 2240.0], 0.45),
    vowel([300.0, 870.0, 2240.0], 0.30),
    vowel([500.0, 1400.0, 2450.0], 0.50),
];

/// Formants towards which lips, tip and back of the tongue move.
const LIPS: [f32; 3] = [250.0, 900.0, 2200.0];
const TIP: [f32; 3] = [260.0, 1700.0, 2650.0];
const BACK: [f32; 3] = [260.0, 1950.0, 2350.0];

const SONORANTS: [Phone; 6] = [
    sonorant([260.0, 1100.0, 2200.0], 0.35, 0.0),
    sonorant([260.0, 1500.0, 2500.0], 0.35, 0.15),
    sonorant([360.0, 1200.0, 2700.0], 0.60, 0.30),
    sonorant([400.0, 1200.0, 1700.0], 0.60, 0.30),
    sonorant([290.0, 700.0, 2200.0], 0.60, 0.20),
    sonorant([270.0, 2100.0, 2950.0], 0.60, 0.25),
];

const FRICATIVES: [Phone; 6] = [
    fricative(TIP, 0.30, 6300.0, 2500.0, 0.0, 0.10),
    fricative(BACK, 0.35, 3300.0, 1500.0, 0.0, 0.20),
    fricative(LIPS, 0.07, 4500.0, 5000.0, 0.0, 0.05),
    fricative(TIP, 0.15, 6000.0, 2500.0, 0.30, 0.10),
    fricative(LIPS, 0.04, 4500.0, 5000.0, 0.40, 0.05),
    fricative([500.0, 1500.0, 2500.0], 0.05, 1500.0, 1500.0, 0.0, 0.40),
];

/// Stops: where the tract closes, middle and width of the burst, whether lips close.
const STOPS: [([f32; 3], f32, f32, bool); 3] = [
    (LIPS, 900.0, 1200.0, true),
    (TIP, 4000.0, 2500.0, false),
    (BACK, 1900.0, 900.0, false),
];

/// Silence with the mouth shut.
pub(crate) const REST: Phone = Phone {
    voice: 0.0,
    breath: 0.0,
    ..vowel([500.0, 1500.0, 2500.0], 0.0)
};

/// Appends a syllable: one or no consonant, a vowel, and sometimes another consonant.
pub(crate) fn syllable(random: &mut Generator, phones: &mut Vec<Phone>) {
    if between(random, 0.0, 1.0) < 0.88 {
        consonant(random, phones);
    }
    phones.push(one_of(random, &VOWELS));
    if between(random, 0.0, 1.0) < 0.25 {
        let coda = if between(random, 0.0, 1.0) < 0.6 {
            one_of(random, &SONORANTS)
        } else {
            one_of(random, &FRICATIVES)
        };
        phones.push(Phone {
            length_s: 0.8 * coda.length_s,
            ..coda
        });
    }
}

fn consonant(random: &mut Generator, phones: &mut Vec<Phone>) {
    match between(random, 0.0, 1.0) {
        ..0.32 => phones.push(one_of(random, &SONORANTS)),
        ..0.58 => phones.push(one_of(random, &FRICATIVES)),
        _ => {
            let (place, burst_hz, width_hz, lips) = one_of(random, &STOPS);
            let voiced = random.next_u32().is_multiple_of(2);
            let closure = fricative(
                place,
                0.0,
                burst_hz,
                width_hz,
                if voiced { 0.12 } else { 0.0 },
                0.15,
            );
            phones.push(Phone {
                mouth: if lips { 0.0 } else { 0.15 },
                length_s: 0.06,
                ..closure
            });
            let strength = if voiced { 0.15 } else { 0.3 };
            phones.push(Phone {
                friction: strength,
                length_s: 0.012,
                sudden: true,
                ..closure
            });
            if !voiced {
                phones.push(Phone {
                    breath: 0.4,
                    voice: 0.0,
                    length_s: 0.03,
                    mouth: 0.3,
                    ..closure
                });
            }
        }
    }
}

fn one_of<T: Copy>(random: &mut Generator, all: &[T]) -> T {
    all[(random.next_u32() % all.len() as u32) as usize]
}
