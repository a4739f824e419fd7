//! Lines, words and numbers of an SDPA text.

use std::str::FromStr;

use super::error::SdpaError;

/// Largest number of unknowns, of blocks and of rows of all blocks that is read: a number beyond it is a mistake
/// in the file, and would only exhaust the memory.
pub const LARGEST_COUNT: usize = 1_000_000;

/// The lines that are neither empty nor comments.
pub struct Reader<'a> {
    lines: Vec<(usize, &'a str)>,
    next: usize,
}

impl<'a> Reader<'a> {
    /// The sections that mixed-integer solvers add as comments are an error.
    pub fn new(text: &'a str) -> Result<Self, SdpaError> {
        let numbered = (1..).zip(text.lines().map(str::trim));
        let mut lines = Vec::new();
        for (line, text) in numbered {
            if let Some(comment) = text.strip_prefix('*') {
                refuse_section(line, comment)?;
            } else if !(text.is_empty() || text.starts_with('"')) {
                lines.push((line, text));
            }
        }
        Ok(Reader { lines, next: 0 })
    }

    /// The next line and its number.
    pub fn line(&mut self) -> Option<(usize, &'a str)> {
        let line = self.lines.get(self.next).copied();
        self.next += 1;
        line
    }

    /// The number of a line of its own; what follows it is a remark, which does not begin with a number.
    pub fn count(&mut self, what: &'static str) -> Result<usize, SdpaError> {
        let (line, text) = self.line().ok_or(SdpaError::Ends { what })?;
        let mut words = split(text);
        let value = number(line, words.next().unwrap_or(""), "a whole number")?;
        match words.next().filter(|word| is_number(word)) {
            Some(word) => Err(SdpaError::NumberFollows {
                line,
                what,
                word: shown(word),
            }),
            None => in_range(line, what, value, 1, LARGEST_COUNT),
        }
    }

    /// So many numbers, on one line or more. What follows the last one on its line may be a remark, but no
    /// number: then one is missing before, or there is one too many.
    pub fn words(
        &mut self,
        count: usize,
        what: &'static str,
    ) -> Result<Vec<(usize, &'a str)>, SdpaError> {
        let mut out = Vec::new();
        while out.len() < count {
            let (line, text) = self.line().ok_or(SdpaError::Ends { what })?;
            let wrong = |found: usize| SdpaError::WrongCount {
                line,
                what,
                expected: count,
                found,
            };
            if !out.is_empty() && looks_like_entries(text) {
                return Err(wrong(out.len()));
            }
            let missing = count - out.len();
            let mut usable = split(text).map(|word| (line, word));
            out.extend(usable.by_ref().take(missing));
            let more = usable.take_while(|(_, word)| is_number(word));
            match more.count() {
                0 => {}
                more => return Err(wrong(count + more)),
            }
        }
        Ok(out)
    }
}

fn refuse_section(line: usize, comment: &str) -> Result<(), SdpaError> {
    let known = ["INTEGER", "RANK1"];
    let named = |section: &&&str| comment.trim().eq_ignore_ascii_case(section);
    match known.iter().find(named) {
        Some(section) => Err(SdpaError::Section { line, section }),
        None => Ok(()),
    }
}

/// True for a line that can be entries: each four whole numbers, of which the last three are at least 1, and a number.
fn looks_like_entries(text: &str) -> bool {
    let words: Vec<&str> = split(text).collect();
    let entry = |words: &[&str]| match words {
        [matrix, indices @ .., value] => {
            let index = |word: &&str| word.parse::<usize>().is_ok_and(|index| index > 0);
            matrix.parse::<usize>().is_ok() && indices.iter().all(index) && is_number(value)
        }
        _ => false,
    };
    !words.is_empty() && words.len() % 5 == 0 && words.chunks(5).all(entry)
}

/// Words between blanks, commas, parentheses and braces.
pub fn split(text: &str) -> impl Iterator<Item = &str> {
    let separator = |c: char| c.is_whitespace() || ",(){}".contains(c);
    text.split(separator).filter(|word| !word.is_empty())
}

/// Whether a word is a number, or as good as one.
pub fn is_number(word: &str) -> bool {
    word.parse::<f64>().is_ok()
}

/// As much of a word as a message shows.
pub fn shown(word: &str) -> String {
    word.chars().take(40).collect()
}

/// A word as a whole number; a plus sign may stand before it.
pub fn number<T: FromStr>(line: usize, word: &str, what: &'static str) -> Result<T, SdpaError> {
    word.parse().map_err(|_| SdpaError::NotANumber {
        line,
        word: shown(word),
        what,
    })
}

/// A word as a finite number.
pub fn finite(line: usize, word: &str, what: &'static str) -> Result<f64, SdpaError> {
    let value = word.parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| SdpaError::NotANumber {
        line,
        word: shown(word),
        what,
    })
}

/// A whole number within limits.
pub fn in_range(
    line: usize,
    what: &'static str,
    value: i64,
    least: usize,
    most: usize,
) -> Result<usize, SdpaError> {
    let fits = usize::try_from(value)
        .ok()
        .filter(|v| (least..=most).contains(v));
    fits.ok_or(SdpaError::OutOfRange {
        line,
        what,
        value,
        least,
        most,
    })
}
