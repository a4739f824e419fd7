//! The matrices in dense form (.dat): every number of every matrix, row by row; of a diagonal block its diagonal.

use super::entries::{Entries, FileBlock, Place, Source};
use super::error::SdpaError;
use super::lines::{finite, shown, split, Reader};

/// The entries of all matrices. Braces, parentheses and commas separate; line breaks do not matter.
pub fn entries(
    reader: &mut Reader,
    unknowns: usize,
    blocks: &[FileBlock],
) -> Result<Entries, SdpaError> {
    let mut words = Words {
        reader,
        line: 0,
        rest: Vec::new(),
    };
    let mut entries = Entries::new();
    for matrix in 0..=unknowns {
        for (index, block) in blocks.iter().enumerate() {
            let mut add = |place: Place, value: f64, source: Source| {
                if value != 0.0 {
                    entries.insert(place, (value, source));
                }
            };
            match block.diagonal {
                true => diagonal(&mut words, matrix, index, block, &mut add)?,
                false => square(&mut words, matrix, index, block, &mut add)?,
            }
        }
    }
    match words.next() {
        Some((line, word)) => Err(SdpaError::DenseExcess {
            line,
            word: shown(word),
        }),
        None => Ok(entries),
    }
}

/// The words of the lines that are left.
struct Words<'r, 'a> {
    reader: &'r mut Reader<'a>,
    line: usize,
    /// Of the line, the last first.
    rest: Vec<&'a str>,
}

impl<'a> Words<'_, 'a> {
    fn next(&mut self) -> Option<(usize, &'a str)> {
        loop {
            if let Some(word) = self.rest.pop() {
                return Some((self.line, word));
            }
            let (line, text) = self.reader.line()?;
            self.line = line;
            self.rest = split(text).collect();
            self.rest.reverse();
        }
    }

    /// The next number of a block, of which `found` are known.
    fn number(
        &mut self,
        matrix: usize,
        block: usize,
        (found, expected): (usize, usize),
    ) -> Result<(usize, f64), SdpaError> {
        let (line, word) = self.next().ok_or(SdpaError::DenseEnds {
            matrix,
            block: block + 1,
            found,
            expected,
        })?;
        Ok((line, finite(line, word, "a finite number")?))
    }
}

fn diagonal(
    words: &mut Words,
    matrix: usize,
    index: usize,
    block: &FileBlock,
    add: &mut impl FnMut(Place, f64, Source),
) -> Result<(), SdpaError> {
    for row in 0..block.side {
        let (line, value) = words.number(matrix, index, (row, block.side))?;
        let source = Source {
            line,
            flipped: false,
        };
        add((block.first_cone + row, matrix, 0, 0), value, source);
    }
    Ok(())
}

fn square(
    words: &mut Words,
    matrix: usize,
    index: usize,
    block: &FileBlock,
    add: &mut impl FnMut(Place, f64, Source),
) -> Result<(), SdpaError> {
    let side = block.side;
    let mut values: Vec<f64> = Vec::new();
    for row in 0..side {
        for column in 0..side {
            let (line, value) = words.number(matrix, index, (values.len(), side * side))?;
            values.push(value);
            if column < row && values[column * side + row] != value {
                return Err(SdpaError::NotSymmetric {
                    line,
                    matrix,
                    block: index + 1,
                    row: row + 1,
                    column: column + 1,
                });
            }
            if column >= row {
                let source = Source {
                    line,
                    flipped: false,
                };
                add((block.first_cone, matrix, row, column), value, source);
            }
        }
    }
    Ok(())
}
