//! Folders and files of results.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use synth::model::{read_text, write_atomically, FileError};

use super::table::TableError;
use crate::base::trajectory::TrajectoryError;

/// Why a run's files cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// A file cannot be read or written.
    #[error("{}: {problem}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: FileError,
    },
    /// A trajectory is no table.
    #[error("{}: {problem}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: TableError,
    },
    /// A table is no trajectory.
    #[error("{}: not a trajectory: {problem}", path.display())]
    Trajectory {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: TrajectoryError,
    },
    /// A summary is not one.
    #[error("{}: not a summary: {problem}", path.display())]
    Summary {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: FileError,
    },
}

impl OutputError {
    /// A file that cannot be read or written.
    pub fn file(path: &Path, problem: FileError) -> Self {
        let path = path.to_path_buf();
        OutputError::File { path, problem }
    }

    /// A file for which the system refuses something, such as `cannot be written`.
    pub fn io(path: &Path, action: &'static str, source: std::io::Error) -> Self {
        Self::file(path, FileError::Io { action, source })
    }

    /// A file whose contents cannot be put together.
    pub fn unmade(path: &Path, error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::io(path, "cannot be written", std::io::Error::other(error))
    }
}

/// Creates a folder with those above it.
///
/// # Errors
/// A folder that cannot be created.
pub fn create_folder(folder: &Path) -> Result<(), OutputError> {
    std::fs::create_dir_all(folder)
        .map_err(|source| OutputError::io(folder, "cannot be created", source))
}

/// A file's text.
///
/// # Errors
/// A file that cannot be read.
pub fn read(path: &Path) -> Result<String, OutputError> {
    read_text(path).map_err(|problem| OutputError::file(path, problem))
}

/// Writes a file whole or not at all.
///
/// # Errors
/// A file that cannot be written.
pub fn write(path: &Path, contents: &(impl AsRef<[u8]> + ?Sized)) -> Result<(), OutputError> {
    write_atomically(path, contents.as_ref())
        .map_err(|problem| OutputError::file(path, problem))?;
    note_written(path);
    Ok(())
}

/// What this process has written so far, in order, for who interrupts it.
static WRITTEN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Notes that a file is on the disk.
pub fn note_written(path: &Path) {
    let mut written = WRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
    if !written.iter().any(|known| known == path) {
        written.push(path.to_path_buf());
    }
}

/// What is on the disk when the work ends here: `nothing was written`, or which files were.
pub fn what_was_written() -> String {
    let written = WRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
    let (some, rest) = written.split_at(written.len().min(NAMED));
    let names: Vec<String> = some.iter().map(|path| path.display().to_string()).collect();
    match (names.as_slice(), rest.len()) {
        ([], _) => "nothing was written".to_string(),
        (names, 0) => format!("written before: {}", names.join(", ")),
        (names, more) => format!("written before: {} and {more} more", names.join(", ")),
    }
}

/// Files that are named one by one.
const NAMED: usize = 8;
