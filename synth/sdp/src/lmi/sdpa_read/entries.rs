//! What is known of a file's blocks and entries while it is read.

use std::collections::BTreeMap;

/// Where an entry stands: cone, matrix of the file, row and column, row <= column.
pub type Place = (usize, usize, usize, usize);

/// The entries of the file.
pub type Entries = BTreeMap<Place, (f64, Source)>;

/// Where an entry was read.
#[derive(Debug, Clone, Copy)]
pub struct Source {
    /// Line, from 1.
    pub line: usize,
    /// Whether it was given below the diagonal.
    pub flipped: bool,
}

/// A block of the file: the cones it becomes, one for each row when it is diagonal.
pub struct FileBlock {
    /// Rows.
    pub side: usize,
    /// Whether it has a diagonal only.
    pub diagonal: bool,
    /// Index of its first cone.
    pub first_cone: usize,
}
