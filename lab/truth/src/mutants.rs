//! Mutants of a file: bytes of a good file that are changed, lost, doubled, swapped or replaced by
//! words that change what the file says.
//!
//! The tests of `lin-canny-formats` and the package `truth` use this file.

use super::rng::Rng;

/// Words that are numbers out of range, half of a construct, or no UTF-8 letter.
const WORDS: [&str; 22] = [
    "nan",
    "inf",
    "-1",
    "0",
    "7",
    "9e99",
    "1e308",
    "1e-308",
    "1e400",
    "4294967295",
    "18446744073709551615",
    "-",
    "\"",
    "<",
    ">",
    "/>",
    "<!--",
    "&",
    "/",
    " ",
    "\n",
    "\u{fffd}",
];

/// Bytes between which a value stands.
const MARKS: &[u8] = b"\"<>,[] \n";

/// Returns a file with one to three changes; `words` are words of its format.
pub fn mutant(good: &[u8], words: &[&str], rng: &mut Rng) -> Vec<u8> {
    let mut bytes = good.to_vec();
    for _ in 0..=rng.below(3) {
        if bytes.is_empty() {
            break;
        }
        change(&mut bytes, words, rng);
    }
    bytes
}

/// Makes one change.
fn change(bytes: &mut Vec<u8>, words: &[&str], rng: &mut Rng) {
    let (start, end) = if rng.below(2) == 0 {
        value(bytes, rng)
    } else {
        let at = rng.below(bytes.len());
        (at, (at + 1 + rng.below(12)).min(bytes.len()))
    };
    let k = rng.below(WORDS.len() + words.len());
    let word = WORDS
        .iter()
        .chain(words)
        .nth(k)
        .map_or(&b""[..], |word| word.as_bytes());
    match rng.below(10) {
        0 => bytes[start.min(end - 1)] ^= 1 << rng.below(8),
        1 => bytes[start.min(end - 1)] = rng.below(256) as u8,
        2 => drop(bytes.drain(start..end)),
        3 => {
            let copy = bytes[start..end].to_vec();
            drop(bytes.splice(start..start, copy));
        }
        4 => {
            let (copy, to) = (bytes[start..end].to_vec(), rng.below(bytes.len()));
            drop(bytes.splice(to..to, copy));
        }
        5 => {
            let digits: Vec<usize> = (0..bytes.len()).filter(|k| bytes[*k].is_ascii_digit()).collect();
            if !digits.is_empty() {
                bytes.swap(*rng.pick(&digits), *rng.pick(&digits));
            }
        }
        6 => drop(bytes.splice(start..start, word.iter().copied())),
        7 if rng.below(4) == 0 => bytes.truncate(start),
        _ => drop(bytes.splice(start..end, word.iter().copied())),
    }
}

/// Returns the range between two neighbouring marks, or of one byte if there are none.
fn value(bytes: &[u8], rng: &mut Rng) -> (usize, usize) {
    let marks: Vec<usize> = (0..bytes.len()).filter(|k| MARKS.contains(&bytes[*k])).collect();
    if marks.len() < 2 {
        return (0, 1);
    }
    let k = 1 + rng.below(marks.len() - 1);
    let start = marks[k - 1] + 1;
    (start, marks[k].max(start + 1).min(bytes.len()))
}

/// Reads mutants of a file by a function that returns whether a mutant was read.
///
/// # Panics
/// Panics if at most one of 500 mutants was read, or all were.
pub fn read(good: &[u8], words: &[&str], count: usize, mut is_read: impl FnMut(&[u8]) -> bool) {
    let mut rng = Rng::new(1);
    let read = (0..count).filter(|_| is_read(&mutant(good, words, &mut rng))).count();
    assert!(500 * read > count, "{read} of {count} mutants were read");
    assert!(read < count, "{read} of {count} mutants were read");
}
