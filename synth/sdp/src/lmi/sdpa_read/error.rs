//! Why a text is not an SDPA problem.

use std::fmt;

/// Why a text is not an SDPA problem.
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
    /// A line that should hold one number holds more.
    #[error("line {line}: {what} must stand on a line of its own, and '{word}' follows it")]
    NumberFollows {
        /// Line, from 1.
        line: usize,
        /// Which number.
        what: &'static str,
        /// The number that follows.
        word: String,
    },
    /// All blocks together have too many rows.
    #[error("line {line}: the blocks have {rows} rows together, at most {most} are read")]
    TooManyRows {
        /// Line of the size that exceeds the limit, from 1.
        line: usize,
        /// Rows up to there.
        rows: usize,
        /// Most rows.
        most: usize,
    },
    /// An entry has the wrong number of words.
    #[error("line {line}: an entry has five numbers (matrix, block, row, column, value), this line has {found}")]
    NotAnEntry {
        /// Line, from 1.
        line: usize,
        /// Numbers found.
        found: usize,
    },
    /// A number stands in the remark after an entry.
    #[error("line {line}: the number '{word}' stands in the remark after an entry; SDPA would read it as the next entry")]
    NumberInRemark {
        /// Line, from 1.
        line: usize,
        /// The number.
        word: String,
    },
    /// An entry that was given before.
    #[error(
        "line {line}: {0} was given on line {before} already; which of the two is meant is not known (they are not added)",
        line = .0.line, before = .0.before
    )]
    Duplicate(RepeatedEntry),
    /// An entry off the diagonal that was given before in the other triangle.
    #[error(
        "line {line}: {0} was given on line {before} as ({column}, {row}); matrices are symmetric and only one triangle is \
         given (the two are not added)",
        line = .0.line, before = .0.before, column = .0.column, row = .0.row
    )]
    BothTriangles(RepeatedEntry),
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
    /// A section that asks for more than a semidefinite program.
    #[error("line {line}: a section *{section} is not supported: the problem would not be a semidefinite program")]
    Section {
        /// Line, from 1.
        line: usize,
        /// INTEGER or RANK1.
        section: &'static str,
    },
    /// A matrix in dense form is not complete.
    #[error("the file ends within matrix {matrix}, block {block}: {found} of its {expected} numbers are there")]
    DenseEnds {
        /// Matrix, from 0.
        matrix: usize,
        /// Block, from 1.
        block: usize,
        /// Numbers found.
        found: usize,
        /// Numbers there should be.
        expected: usize,
    },
    /// More numbers than the matrices in dense form have.
    #[error("line {line}: '{word}' follows the last matrix")]
    DenseExcess {
        /// Line, from 1.
        line: usize,
        /// The word.
        word: String,
    },
    /// A matrix in dense form is not symmetric.
    #[error("line {line}: matrix {matrix}, block {block} is not symmetric: its entries ({row}, {column}) and ({column}, {row}) differ")]
    NotSymmetric {
        /// Line of the second of the two entries, from 1.
        line: usize,
        /// Matrix, from 0.
        matrix: usize,
        /// Block, from 1.
        block: usize,
        /// Row of the second, from 1.
        row: usize,
        /// Column of the second, from 1.
        column: usize,
    },
}

/// An entry of a matrix that was given twice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RepeatedEntry {
    /// Line, from 1.
    pub line: usize,
    /// Line of the first.
    pub before: usize,
    /// Matrix, from 0.
    pub matrix: usize,
    /// Block, from 1.
    pub block: usize,
    /// Row as given, from 1.
    pub row: usize,
    /// Column as given, from 1.
    pub column: usize,
}

impl fmt::Display for RepeatedEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let RepeatedEntry {
            matrix,
            block,
            row,
            column,
            ..
        } = self;
        write!(
            f,
            "entry ({row}, {column}) of block {block} of matrix {matrix}"
        )
    }
}
