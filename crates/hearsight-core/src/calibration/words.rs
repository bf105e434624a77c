//! Names of fields: which are the same, and which was probably meant.

/// Longer words are no misspelling of a field.
const LONGEST_WORD: usize = 60;

/// A field's name without capitals, `_`, `-` and blanks, in which writers differ.
pub(super) fn plain(name: &str) -> String {
    name.chars()
        .filter(|c| !matches!(c, '_' | '-' | ' '))
        .flat_map(char::to_lowercase)
        .collect()
}

/// The first `characters` of a text, with dots where there were more.
pub(super) fn shorten(text: &str, characters: usize) -> String {
    match text.char_indices().nth(characters) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// Characters to insert, leave out or replace to get from one word to the other; long words count as far apart.
pub(super) fn distance(from: &str, to: &str) -> usize {
    let (from, to): (Vec<char>, Vec<char>) = (from.chars().collect(), to.chars().collect());
    if to.len() > LONGEST_WORD {
        return usize::MAX;
    }
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (i, a) in from.iter().enumerate() {
        let mut diagonal = i;
        row[0] = i + 1;
        for (j, b) in to.iter().enumerate() {
            let replaced = diagonal + usize::from(a != b);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_compared_and_shortened_by_characters() {
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "\u{e9}\u{e9}"), 2);
        assert_eq!(plain("Camera_Matrix"), plain("cameraMatrix"));
        assert_eq!(shorten("\u{e9}\u{e9}\u{e9}", 2), "\u{e9}\u{e9}...");
    }
}
