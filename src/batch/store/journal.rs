//! Lines that are appended as soon as they are there.
//!
//! The first line says what the journal is about, and the others come in any order. A process that is killed
//! leaves at most one torn line at the end, which is dropped.

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::lock::{lock, InUse};
use crate::base::files::{write, OutputError};

/// Time between two writes through to the disk: what a power failure costs at most.
const DURABLE_EVERY: Duration = Duration::from_secs(1);
/// Bytes of a line at most: the first one has every value of every axis. A longer one is taken for torn.
const LONGEST_LINE: u64 = 64 << 20;

/// Why points cannot be kept or read.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The journal cannot be read or written.
    #[error("{}: cannot be {action}: {source}", path.display())]
    Io {
        /// The journal.
        path: PathBuf,
        /// What was tried: `read` or `written`.
        action: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A point cannot be kept.
    #[error(
        "{}: cannot be written: {source}; the points before are kept, and the same command goes on from them",
        path.display()
    )]
    Full {
        /// The journal.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The folder holds the points of another sweep.
    #[error(
        "{} holds the points of another sweep (the {difference} differs); choose another folder, or \
         give --restart to delete them",
        path.parent().unwrap_or(path).display()
    )]
    Other {
        /// The journal.
        path: PathBuf,
        /// What differs.
        difference: &'static str,
    },
    /// A line that is none of a journal.
    #[error(
        "{}: line {line} is not a line of a sweep's journal: {reason}; give --restart to throw its points away",
        path.display()
    )]
    Damaged {
        /// The journal.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// Another process is at it.
    #[error("{}: is in use by another sweep", folder.display())]
    InUse {
        /// The folder.
        folder: PathBuf,
    },
}

/// Why a line is refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LineError {
    /// The journal is about something else; this differs.
    Other(&'static str),
    /// It is none of a journal.
    Damaged(String),
}

/// A journal that is open for more lines. Nobody else can open it meanwhile.
pub struct Journal {
    path: PathBuf,
    writer: Mutex<Writer>,
}

struct Writer {
    file: File,
    durable: Instant,
}

impl Journal {
    /// Opens the journal of that name in a folder and gives `take` its whole lines, the first of which is
    /// numbered 1; or begins one with the line `header`. With `restart` it is begun in any case.
    ///
    /// # Errors
    /// A line that `take` refuses; the journal is in use, or cannot be read or written.
    pub fn open(
        (folder, name): (&Path, &str),
        header: &str,
        restart: bool,
        take: impl FnMut(usize, &[u8]) -> Result<(), LineError>,
    ) -> Result<Self, JournalError> {
        let path = folder.join(name);
        let unwritten = |source| io(&path, "written", source);
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(&path).map_err(unwritten)?;
        let data = file
            .metadata()
            .map_err(|source| io(&path, "read", source))?;
        if !data.is_file() {
            let reason = std::io::Error::other("it is not an ordinary file");
            return Err(unwritten(reason));
        }
        lock(&file).map_err(|InUse| JournalError::InUse {
            folder: folder.to_path_buf(),
        })?;
        let whole = match restart {
            true => 0,
            false => read(&path, &file, take)?,
        };
        begin(&mut file, whole, header).map_err(unwritten)?;
        let durable = Instant::now();
        let writer = Mutex::new(Writer { file, durable });
        Ok(Journal { path, writer })
    }

    /// Appends a line.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn append(&self, line: &str) -> Result<(), JournalError> {
        let mut writer = self.writer();
        let written = writer.file.write_all(line.as_bytes());
        let written = written.and_then(|()| match writer.durable.elapsed() {
            elapsed if elapsed < DURABLE_EVERY => Ok(()),
            _ => {
                writer.durable = Instant::now();
                writer.file.sync_data()
            }
        });
        written.map_err(|source| self.full(source))
    }

    /// Writes what is kept through to the disk.
    ///
    /// # Errors
    /// The system's.
    pub fn flush(&self) -> Result<(), JournalError> {
        let done = self.writer().file.sync_data();
        done.map_err(|source| self.full(source))
    }

    /// Puts a text in place of all lines, whole or not at all.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn replace(self, text: &str) -> Result<(), OutputError> {
        write(&self.path, text)
    }

    fn writer(&self) -> MutexGuard<'_, Writer> {
        self.writer.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn full(&self, source: std::io::Error) -> JournalError {
        let path = self.path.clone();
        JournalError::Full { path, source }
    }
}

fn io(path: &Path, action: &'static str, source: std::io::Error) -> JournalError {
    JournalError::Io {
        path: path.to_path_buf(),
        action,
        source,
    }
}

/// Length of the whole lines, bytes.
fn read(
    path: &Path,
    file: &File,
    mut take: impl FnMut(usize, &[u8]) -> Result<(), LineError>,
) -> Result<u64, JournalError> {
    let mut reader = BufReader::new(file);
    let mut bytes = Vec::new();
    let mut length = 0;
    for line in 1.. {
        bytes.clear();
        let mut whole = reader.by_ref().take(LONGEST_LINE);
        let read = whole.read_until(b'\n', &mut bytes);
        read.map_err(|source| io(path, "read", source))?;
        if bytes.last() != Some(&b'\n') {
            break;
        }
        let path = path.to_path_buf();
        take(line, &bytes).map_err(|error| match error {
            LineError::Other(difference) => JournalError::Other { path, difference },
            LineError::Damaged(reason) => JournalError::Damaged { path, line, reason },
        })?;
        length += bytes.len() as u64;
    }
    Ok(length)
}

/// Drops what is behind the whole lines; without any, writes the header.
fn begin(file: &mut File, whole: u64, header: &str) -> std::io::Result<()> {
    if file.metadata()?.len() != whole {
        file.set_len(whole)?;
    }
    file.seek(SeekFrom::Start(whole))?;
    if whole == 0 {
        file.write_all(header.as_bytes())?;
        file.sync_data()?;
    }
    Ok(())
}
