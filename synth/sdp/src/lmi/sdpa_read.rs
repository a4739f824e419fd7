//! Reading SDPA sparse text (.dat-s).

use std::collections::BTreeMap;
use std::str::FromStr;

use super::{Cone, Entry, Semidefinite};

/// Largest number of unknowns, of blocks and of rows of a block that is read: a number beyond it is a mistake
/// in the file, and would only exhaust the memory.
const LARGEST_COUNT: usize = 1_000_000;

/// Why a text is not an SDPA sparse problem.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SdpaError {
    /// The text ends too early.
    #[error("the file ends before {what}")]
    Ends {
        /// What is missing.
        what: &'static str,
    },
    /// A word is not the number it should be.
    #[error("line {line}: '{word}' is not {what}")]
    NotANumber {
        /// Line, from 1.
        line: usize,
        /// The word.
        word: String,
        /// What is expected.
        what: &'static str,
    },
    /// A number is outside of its range.
    #[error("line {line}: {what} is {value}, it must be from {least} to {most}")]
    OutOfRange {
        /// Line, from 1.
        line: usize,
        /// Which number.
        what: &'static str,
        /// Its value.
        value: i64,
        /// Smallest value allowed.
        least: usize,
        /// Largest value allowed.
        most: usize,
    },
    /// A list of the header has fewer or more numbers than it should.
    #[error("line {line}: {what} must be {expected} numbers, and {found} stand up to the end of this line")]
    WrongCount {
        /// Last line of the list, from 1.
        line: usize,
        /// Which list.
        what: &'static str,
        /// Numbers there should be.
        expected: usize,
        /// Numbers found.
        found: usize,
    },
    /// An entry has the wrong number of words.
    #[error("line {line}: an entry has five numbers (matrix, block, row, column, value), this line has {found}")]
    NotAnEntry {
        /// Line, from 1.
        line: usize,
        /// Words found.
        found: usize,
    },
    /// An entry off the diagonal of a diagonal block.
    #[error(
        "line {line}: entry ({row}, {column}) is off the diagonal, block {block} is a diagonal one"
    )]
    OffDiagonal {
        /// Line, from 1.
        line: usize,
        /// Block, from 1.
        block: usize,
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
    },
}

/// Where an entry stands: cone, matrix of the file, row and column, row <= column.
type Place = (usize, usize, usize, usize);

/// A block of the file: the cones it becomes, one for each row when it is diagonal.
struct FileBlock {
    side: usize,
    diagonal: bool,
    first_cone: usize,
}

struct Reader<'a> {
    lines: Vec<(usize, &'a str)>,
    next: usize,
}

impl Semidefinite {
    /// Reads SDPA sparse text. A diagonal block (negative size) becomes one cone of side 1 for each row; entries given
    /// twice are added. The comments that [`to_sdpa`](Semidefinite::to_sdpa) writes (objective offset, names of
    /// blocks) are understood.
    pub fn from_sdpa(text: &str) -> Result<Self, SdpaError> {
        let mut reader = Reader::new(text);
        let (offset, names) = comments(text);
        let unknowns = reader.count("the number of unknowns")?;
        let count = reader.count("the number of blocks")?;
        let sizes = reader.words(count, "the sizes of the blocks", true)?;
        let mut cones: Vec<Cone> = Vec::new();
        let mut blocks = Vec::new();
        for (index, (line, word)) in sizes.into_iter().enumerate() {
            let size: i64 = number(line, word, "the size of a block")?;
            let what = "the size of a block";
            let side = in_range(line, what, size.saturating_abs(), 1, LARGEST_COUNT)?;
            let name = names.get(&(index + 1)).cloned();
            let name = name.unwrap_or_else(|| format!("block {}", index + 1));
            let diagonal = size < 0;
            blocks.push(FileBlock {
                side,
                diagonal,
                first_cone: cones.len(),
            });
            let cone = |name: String, side: usize| Cone {
                name,
                side,
                constant: Vec::new(),
                coefficients: Vec::new(),
            };
            match diagonal {
                true => cones.extend((1..=side).map(|row| cone(format!("{name} row {row}"), 1))),
                false => cones.push(cone(name, side)),
            }
        }
        let costs = reader.words(unknowns, "the costs", false)?.into_iter();
        let cost = costs.map(|(line, word)| number(line, word, "a cost"));
        let cost = cost.collect::<Result<Vec<f64>, _>>()?;
        let mut entries: BTreeMap<Place, f64> = BTreeMap::new();
        while let Some((line, text)) = reader.line() {
            let (place, value) = file_entry(line, text, unknowns, &blocks)?;
            *entries.entry(place).or_insert(0.0) += value;
        }
        for ((cone, matrix, row, column), value) in entries.into_iter().filter(|e| e.1 != 0.0) {
            let Cone {
                constant,
                coefficients,
                ..
            } = &mut cones[cone];
            match (matrix, coefficients.last_mut()) {
                // The format subtracts matrix 0.
                (0, _) => constant.push(Entry::new(row, column, -value)),
                (_, Some((unknown, entries))) if *unknown + 1 == matrix => {
                    entries.push(Entry::new(row, column, value));
                }
                _ => coefficients.push((matrix - 1, vec![Entry::new(row, column, value)])),
            }
        }
        Ok(Semidefinite {
            cost,
            offset,
            cones,
        })
    }
}

/// An entry of the file: where it stands and its value.
fn file_entry(
    line: usize,
    text: &str,
    unknowns: usize,
    blocks: &[FileBlock],
) -> Result<(Place, f64), SdpaError> {
    let words: Vec<&str> = split(text).collect();
    let [matrix, block, row, column, value] = words[..] else {
        return Err(SdpaError::NotAnEntry {
            line,
            found: words.len(),
        });
    };
    let index = |word: &str, what: &'static str, least: usize, most: usize| {
        in_range(line, what, number(line, word, "an index")?, least, most)
    };
    let matrix = index(matrix, "the matrix", 0, unknowns)?;
    let number_of_block = index(block, "the block", 1, blocks.len())?;
    let block = &blocks[number_of_block - 1];
    let row = index(row, "the row", 1, block.side)?;
    let column = index(column, "the column", 1, block.side)?;
    let value: f64 = number(line, value, "the value of an entry")?;
    match block.diagonal {
        true if row != column => Err(SdpaError::OffDiagonal {
            line,
            block: number_of_block,
            row,
            column,
        }),
        true => Ok(((block.first_cone + row - 1, matrix, 0, 0), value)),
        false => {
            let (row, column) = (row.min(column) - 1, row.max(column) - 1);
            Ok(((block.first_cone, matrix, row, column), value))
        }
    }
}

impl<'a> Reader<'a> {
    fn new(text: &'a str) -> Self {
        let lines = (1..).zip(text.lines().map(str::trim));
        let lines = lines.filter(|(_, line)| !(line.is_empty() || line.starts_with(['"', '*'])));
        Reader {
            lines: lines.collect(),
            next: 0,
        }
    }

    fn line(&mut self) -> Option<(usize, &'a str)> {
        let line = self.lines.get(self.next).copied();
        self.next += 1;
        line
    }

    /// The first number of a line of its own; what follows it is a remark.
    fn count(&mut self, what: &'static str) -> Result<usize, SdpaError> {
        let (line, text) = self.line().ok_or(SdpaError::Ends { what })?;
        let word = split(text).next().unwrap_or("");
        let value = number(line, word, "a whole number")?;
        in_range(line, what, value, 1, LARGEST_COUNT)
    }

    /// So many numbers, on one line or more. What follows the last one on its line may be a remark, but no
    /// number: then one is missing before, or there is one too many.
    fn words(
        &mut self,
        count: usize,
        what: &'static str,
        whole: bool,
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
            if !out.is_empty() && looks_like_entry(text) {
                return Err(wrong(out.len()));
            }
            let missing = count - out.len();
            let mut usable = split(text).map(|word| match whole {
                // Some writers put a plus sign before sizes.
                true => (line, word.trim_start_matches('+')),
                false => (line, word),
            });
            out.extend(usable.by_ref().take(missing));
            let more = usable.take_while(|(_, word)| word.parse::<f64>().is_ok());
            match more.count() {
                0 => {}
                more => return Err(wrong(count + more)),
            }
        }
        Ok(out)
    }
}

/// True for a line that can be an entry: four whole numbers, of which the last three are at least 1, and a number.
fn looks_like_entry(text: &str) -> bool {
    let words: Vec<&str> = split(text).collect();
    let [matrix, indices @ .., value] = words.as_slice() else {
        return false;
    };
    indices.len() == 3
        && matrix.parse::<usize>().is_ok()
        && indices
            .iter()
            .all(|word| word.parse::<usize>().is_ok_and(|index| index > 0))
        && value.parse::<f64>().is_ok()
}

/// Words between blanks, commas, parentheses and braces.
fn split(text: &str) -> impl Iterator<Item = &str> {
    let separator = |c: char| c.is_whitespace() || ",(){}".contains(c);
    text.split(separator).filter(|word| !word.is_empty())
}

fn number<T: FromStr>(line: usize, word: &str, what: &'static str) -> Result<T, SdpaError> {
    let shown: String = word.chars().take(40).collect();
    word.parse().map_err(|_| SdpaError::NotANumber {
        line,
        word: shown,
        what,
    })
}

fn in_range(
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

/// The objective's constant part and the names of the blocks, from the comments.
fn comments(text: &str) -> (f64, BTreeMap<usize, String>) {
    let mut offset = 0.0;
    let mut names = BTreeMap::new();
    for comment in text.lines().map_while(|line| line.strip_prefix('"')) {
        if let Some(value) = comment.strip_prefix("objective offset ") {
            offset = value.trim().parse().unwrap_or(0.0);
        }
        let block = comment.strip_prefix("block ");
        if let Some((head, name)) = block.and_then(|rest| rest.split_once(": ")) {
            let index = head.split_whitespace().next();
            if let Some(index) = index.and_then(|word| word.parse().ok()) {
                names.insert(index, name.to_string());
            }
        }
    }
    (offset, names)
}
