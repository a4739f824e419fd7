//! One process at a time.

use std::fs::File;
use std::path::Path;

/// Another process is at it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct InUse;

/// Keeps other processes away from a file for as long as it is open.
///
/// # Errors
/// Another process has it.
#[cfg(unix)]
pub fn lock(file: &File) -> Result<(), InUse> {
    use rustix::fs::{flock, FlockOperation};
    match flock(file, FlockOperation::NonBlockingLockExclusive) {
        Err(rustix::io::Errno::WOULDBLOCK) => Err(InUse),
        // A file system without locks: the user has to look after it.
        Ok(()) | Err(_) => Ok(()),
    }
}

/// Nothing: only Unix has these locks.
///
/// # Errors
/// None.
#[cfg(not(unix))]
pub fn lock(_file: &File) -> Result<(), InUse> {
    Ok(())
}

/// Keeps other processes away from a folder for as long as the result is there; `None` where a folder
/// cannot be opened.
///
/// # Errors
/// Another process has it.
pub fn lock_folder(folder: &Path) -> Result<Option<File>, InUse> {
    match File::open(folder) {
        Ok(file) => lock(&file).map(|()| Some(file)),
        Err(_) => Ok(None),
    }
}
