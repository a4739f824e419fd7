//! Reading SDPA text, sparse (.dat-s) and dense (.dat).

mod dense;
mod entries;
mod error;
mod lines;

use std::collections::{btree_map, BTreeMap};

use super::{Cone, Entry, Semidefinite};
use entries::{Entries, FileBlock, Source};
use lines::{finite, in_range, is_number, number, shown, split, Reader, LARGEST_COUNT};

pub use error::{RepeatedEntry, SdpaError};

/// How the matrices are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SdpaForm {
    /// Entry by entry: matrix, block, row, column, value (.dat-s).
    Sparse,
    /// Every number of every matrix (.dat).
    Dense,
}

impl Semidefinite {
    /// Reads SDPA sparse text; see [`from_sdpa_form`](Semidefinite::from_sdpa_form).
    pub fn from_sdpa(text: &str) -> Result<Self, SdpaError> {
        Semidefinite::from_sdpa_form(text, SdpaForm::Sparse)
    }

    /// Reads SDPA text. A diagonal block (negative size) becomes one cone of side 1 for each row. An entry stands in
    /// one triangle, once; several may stand on a line, and a remark without numbers after them. A byte order mark is
    /// skipped. The comments that [`to_sdpa`](Semidefinite::to_sdpa) writes (objective offset, names of blocks) are
    /// understood.
    pub fn from_sdpa_form(text: &str, form: SdpaForm) -> Result<Self, SdpaError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut reader = Reader::new(text)?;
        let (offset, names) = comments(text);
        let unknowns = reader.count("the number of unknowns")?;
        let count = reader.count("the number of blocks")?;
        let (mut cones, blocks) = blocks(&mut reader, count, &names)?;
        let costs = reader.words(unknowns, "the costs")?.into_iter();
        let cost = costs.map(|(line, word)| finite(line, word, "a cost"));
        let cost = cost.collect::<Result<Vec<f64>, _>>()?;
        let entries = match form {
            SdpaForm::Sparse => sparse(&mut reader, unknowns, &blocks)?,
            SdpaForm::Dense => dense::entries(&mut reader, unknowns, &blocks)?,
        };
        let nonzero = entries.into_iter().filter(|(_, (value, _))| *value != 0.0);
        for ((cone, matrix, row, column), (value, _)) in nonzero {
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

/// The blocks and the cones that they become, without entries.
fn blocks(
    reader: &mut Reader,
    count: usize,
    names: &BTreeMap<usize, String>,
) -> Result<(Vec<Cone>, Vec<FileBlock>), SdpaError> {
    let (mut cones, mut blocks, mut rows) = (Vec::new(), Vec::new(), 0);
    let sizes = reader.words(count, "the sizes of the blocks")?;
    for (index, (line, word)) in sizes.into_iter().enumerate() {
        let what = "the size of a block";
        let size: i64 = number(line, word, what)?;
        let side = in_range(line, what, size.saturating_abs(), 1, LARGEST_COUNT)?;
        rows += side;
        if rows > LARGEST_COUNT {
            let most = LARGEST_COUNT;
            return Err(SdpaError::TooManyRows { line, rows, most });
        }
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
    Ok((cones, blocks))
}

/// The entries that are given one by one.
fn sparse(
    reader: &mut Reader,
    unknowns: usize,
    blocks: &[FileBlock],
) -> Result<Entries, SdpaError> {
    let mut entries = Entries::new();
    let mut words = Vec::new();
    while let Some((line, text)) = reader.line() {
        words.clear();
        words.extend(split(text));
        for entry in numbers(line, &words)?.chunks_exact(ENTRY_WORDS) {
            add(&mut entries, line, entry, unknowns, blocks)?;
        }
    }
    Ok(entries)
}

/// Words of an entry.
const ENTRY_WORDS: usize = 5;

/// The words of a line that belong to entries: all of them, or those before a remark.
fn numbers<'w, 'a>(line: usize, words: &'w [&'a str]) -> Result<&'w [&'a str], SdpaError> {
    let count = words.iter().take_while(|word| is_number(word)).count();
    let (numbers, remark) = words.split_at(count);
    if numbers.is_empty() || count % ENTRY_WORDS != 0 {
        return Err(match remark.first() {
            // A number is meant where the first word that is none stands.
            Some(word) => SdpaError::NotANumber {
                line,
                word: shown(word),
                what: "a number of an entry (matrix, block, row, column, value)",
            },
            None => SdpaError::NotAnEntry { line, found: count },
        });
    }
    match remark.iter().find(|word| is_number(word)) {
        Some(word) => Err(SdpaError::NumberInRemark {
            line,
            word: shown(word),
        }),
        None => Ok(numbers),
    }
}

/// Adds an entry of five words.
fn add(
    entries: &mut Entries,
    line: usize,
    words: &[&str],
    unknowns: usize,
    blocks: &[FileBlock],
) -> Result<(), SdpaError> {
    let index = |k: usize, what: &'static str, least: usize, most: usize| {
        in_range(
            line,
            what,
            number(line, words[k], "a whole number")?,
            least,
            most,
        )
    };
    let matrix = index(0, "the matrix", 0, unknowns)?;
    let number_of_block = index(1, "the block", 1, blocks.len())?;
    let block = &blocks[number_of_block - 1];
    let row = index(2, "the row", 1, block.side)?;
    let column = index(3, "the column", 1, block.side)?;
    let value = finite(line, words[4], "a finite number")?;
    if block.diagonal && row != column {
        return Err(SdpaError::OffDiagonal {
            line,
            block: number_of_block,
            row,
            column,
        });
    }
    let place = match block.diagonal {
        true => (block.first_cone + row - 1, matrix, 0, 0),
        false => (
            block.first_cone,
            matrix,
            row.min(column) - 1,
            row.max(column) - 1,
        ),
    };
    let flipped = row > column;
    let first = match entries.entry(place) {
        btree_map::Entry::Vacant(vacant) => {
            vacant.insert((value, Source { line, flipped }));
            return Ok(());
        }
        btree_map::Entry::Occupied(occupied) => occupied.get().1,
    };
    let repeated = RepeatedEntry {
        line,
        before: first.line,
        matrix,
        block: number_of_block,
        row,
        column,
    };
    Err(match first.flipped == flipped {
        true => SdpaError::Duplicate(repeated),
        false => SdpaError::BothTriangles(repeated),
    })
}

/// The objective's constant part and the names of the blocks, from the comments.
fn comments(text: &str) -> (f64, BTreeMap<usize, String>) {
    let mut offset = 0.0;
    let mut names = BTreeMap::new();
    for comment in text.lines().map_while(|line| line.strip_prefix('"')) {
        if let Some(value) = comment.strip_prefix("objective offset ") {
            let value = value.trim().parse().ok();
            offset = value.filter(|value: &f64| value.is_finite()).unwrap_or(0.0);
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
