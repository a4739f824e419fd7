//! The points that are done, on disk: a sweep that was ended can go on.
//!
//! `points.jsonl` is one JSON object a line: first what is swept, then a line for each point in the order
//! in which they were finished. A line is appended and flushed as soon as its point is done. A process
//! that is killed leaves at most one torn line at the end, which is dropped.

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use serde_json::Number;

use super::grid::Grid;
use super::outcome::PointOutcome;
use super::subject::Subject;
use crate::base::files as output;
use crate::base::files::OutputError;
use crate::base::provenance::{sha256_of, GENERATOR};

/// Name of the journal.
pub const JOURNAL_FILE: &str = "points.jsonl";
/// Time between two writes through to the disk: what a power failure costs at most.
const DURABLE_EVERY: Duration = Duration::from_secs(1);

/// Bytes of a line at most: the first one has every value of every axis. A longer one is taken for torn.
const LONGEST_LINE: u64 = 64 << 20;

/// What is swept: a sweep goes on only where all of it is the same.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Identity {
    /// Program and version.
    pub generator: String,
    /// Kind of the file.
    pub kind: String,
    /// SHA-256 of the file's text.
    pub file_sha256: String,
    /// SHA-256 of the design's file, for a scenario that has one.
    pub design_sha256: Option<String>,
    /// The solver and the form of its problems, for a model.
    pub solver: Option<String>,
    /// The axes.
    pub axes: Vec<AxisRecord>,
}

/// An axis: the full name of its number, and the values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisRecord {
    /// Full name of the number.
    pub name: String,
    /// Its values.
    pub values: Vec<f64>,
}

impl Identity {
    /// Of a sweep of a file with this text.
    pub fn new(text: &str, subject: &Subject, grid: &Grid) -> Self {
        let axes = grid.axes().map(|(name, values)| AxisRecord {
            name: name.to_string(),
            values: values.to_vec(),
        });
        Identity {
            generator: GENERATOR.to_string(),
            kind: subject.kind().to_string(),
            file_sha256: sha256_of(text),
            design_sha256: subject.design_sha256().map(str::to_string),
            solver: subject.solver(),
            axes: axes.collect(),
        }
    }

    /// The first thing in which two sweeps differ.
    fn difference(&self, other: &Identity) -> Option<&'static str> {
        let differ = [
            (self.file_sha256 != other.file_sha256, "file"),
            (self.kind != other.kind, "kind of file"),
            (self.axes != other.axes, "--vary"),
            (self.design_sha256 != other.design_sha256, "design"),
            (self.solver != other.solver, "solver"),
            (self.generator != other.generator, "version of the program"),
        ];
        let first = differ.into_iter().find(|(differs, _)| *differs);
        first.map(|(_, what)| what)
    }
}

/// First line of the journal.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FirstRecord {
    sweep: Identity,
}

/// A line of the journal.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PointRecord {
    point: usize,
    verdict: String,
    reason: Option<String>,
    metrics: Vec<(String, Option<Number>)>,
    worst_condition: Option<String>,
}

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
        /// What the system says.
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
        /// What the system says.
        source: std::io::Error,
    },
    /// The folder holds the points of another sweep.
    #[error(
        "{} holds the points of another sweep (the {difference} differs); choose another folder, or \
         give --restart to throw them away",
        folder.display()
    )]
    Other {
        /// The folder.
        folder: PathBuf,
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
    #[error("{} is in use by another sweep", folder.display())]
    InUse {
        /// The folder.
        folder: PathBuf,
    },
}

/// The outcomes known, by number of the point.
pub type Known = Vec<Option<PointOutcome>>;

/// A journal that is open for more points. Nobody else can open it meanwhile.
pub struct Journal {
    path: PathBuf,
    writer: Mutex<Writer>,
}

struct Writer {
    file: File,
    durable: Instant,
}

impl Journal {
    /// Opens the journal in a folder, or begins one, and reads the points that are done. With `restart`
    /// it is begun in any case.
    ///
    /// # Errors
    /// The journal is another sweep's, damaged, in use, or cannot be read or written.
    pub fn open(
        folder: &Path,
        identity: &Identity,
        grid: &Grid,
        restart: bool,
    ) -> Result<(Self, Known), JournalError> {
        let path = folder.join(JOURNAL_FILE);
        let io = |action: &'static str| {
            let path = path.clone();
            move |source| JournalError::Io {
                path,
                action,
                source,
            }
        };
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(&path).map_err(io("written"))?;
        if !file.metadata().map_err(io("read"))?.is_file() {
            return Err(io("written")(std::io::Error::other(
                "it is not an ordinary file",
            )));
        }
        lock(&file, folder)?;
        let mut found = Found::nothing(grid);
        if !restart {
            found = read(&file, identity, grid).map_err(|error| match error {
                ReadError::Io(source) => io("read")(source),
                ReadError::Other(difference) => JournalError::Other {
                    folder: folder.to_path_buf(),
                    difference,
                },
                ReadError::Damaged { line, reason } => JournalError::Damaged {
                    path: path.clone(),
                    line,
                    reason,
                },
            })?;
        }
        let length = file.metadata().map_err(io("read"))?.len();
        if length != found.bytes {
            file.set_len(found.bytes).map_err(io("written"))?;
        }
        file.seek(SeekFrom::Start(found.bytes))
            .map_err(io("written"))?;
        if found.bytes == 0 {
            file.write_all(header(identity).as_bytes())
                .and_then(|()| file.sync_data())
                .map_err(io("written"))?;
        }
        let writer = Mutex::new(Writer {
            file,
            durable: Instant::now(),
        });
        Ok((Journal { path, writer }, found.known))
    }

    /// Keeps a point that is done.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn keep(&self, index: usize, outcome: &PointOutcome) -> Result<(), JournalError> {
        let text = line(index, outcome);
        let mut writer = self.writer.lock().unwrap_or_else(PoisonError::into_inner);
        let written = writer.file.write_all(text.as_bytes());
        let written = written.and_then(|()| match writer.durable.elapsed() {
            elapsed if elapsed < DURABLE_EVERY => Ok(()),
            _ => {
                writer.durable = Instant::now();
                writer.file.sync_data()
            }
        });
        written.map_err(|source| self.unwritten(source))
    }

    /// Writes what is kept through to the disk.
    ///
    /// # Errors
    /// The system's.
    pub fn flush(&self) -> Result<(), JournalError> {
        let writer = self.writer.lock().unwrap_or_else(PoisonError::into_inner);
        let done = writer.file.sync_data();
        done.map_err(|source| self.unwritten(source))
    }

    /// Puts the lines of a finished sweep in the order of the grid, so that the journal's bytes do not
    /// tell how often the sweep was ended.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn sort(self, identity: &Identity, outcomes: &[PointOutcome]) -> Result<(), OutputError> {
        let mut text = header(identity);
        for (index, outcome) in outcomes.iter().enumerate() {
            text += &line(index, outcome);
        }
        output::write(&self.path, &text)
    }

    fn unwritten(&self, source: std::io::Error) -> JournalError {
        JournalError::Full {
            path: self.path.clone(),
            source,
        }
    }
}

fn header(identity: &Identity) -> String {
    let header = FirstRecord {
        sweep: identity.clone(),
    };
    json_line(&header)
}

fn line(index: usize, outcome: &PointOutcome) -> String {
    json_line(&PointRecord {
        point: index,
        verdict: outcome.verdict.clone(),
        reason: outcome.reason.clone(),
        metrics: outcome.metrics.clone(),
        worst_condition: outcome.worst_condition.clone(),
    })
}

/// The lines' types hold finite numbers, texts and lists only, so they can always be written.
fn json_line(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default() + "\n"
}

#[cfg(unix)]
fn lock(file: &File, folder: &Path) -> Result<(), JournalError> {
    use rustix::fs::{flock, FlockOperation};
    match flock(file, FlockOperation::NonBlockingLockExclusive) {
        Err(rustix::io::Errno::WOULDBLOCK) => Err(JournalError::InUse {
            folder: folder.to_path_buf(),
        }),
        // A file system without locks: the user has to look after it.
        Ok(()) | Err(_) => Ok(()),
    }
}

#[cfg(not(unix))]
fn lock(_file: &File, _folder: &Path) -> Result<(), JournalError> {
    Ok(())
}

/// What a journal holds.
struct Found {
    known: Known,
    /// Length of its whole lines.
    bytes: u64,
}

impl Found {
    fn nothing(grid: &Grid) -> Self {
        Found {
            known: vec![None; grid.points()],
            bytes: 0,
        }
    }
}

enum ReadError {
    Io(std::io::Error),
    Other(&'static str),
    Damaged { line: usize, reason: String },
}

fn read(file: &File, identity: &Identity, grid: &Grid) -> Result<Found, ReadError> {
    let mut found = Found::nothing(grid);
    let mut reader = BufReader::new(file);
    let mut bytes = Vec::new();
    for number in 1.. {
        bytes.clear();
        let mut line = reader.by_ref().take(LONGEST_LINE);
        line.read_until(b'\n', &mut bytes).map_err(ReadError::Io)?;
        if bytes.last() != Some(&b'\n') {
            break;
        }
        let damaged = |reason: String| ReadError::Damaged {
            line: number,
            reason,
        };
        if number == 1 {
            let header: FirstRecord =
                serde_json::from_slice(&bytes).map_err(|error| damaged(error.to_string()))?;
            if let Some(difference) = header.sweep.difference(identity) {
                return Err(ReadError::Other(difference));
            }
        } else {
            let line: PointRecord =
                serde_json::from_slice(&bytes).map_err(|error| damaged(error.to_string()))?;
            let place = found.known.get_mut(line.point);
            let place = place
                .ok_or_else(|| damaged(format!("there is no point {} in the grid", line.point)))?;
            *place = Some(PointOutcome {
                values: grid.point(line.point),
                verdict: line.verdict,
                reason: line.reason,
                metrics: line.metrics,
                worst_condition: line.worst_condition,
            });
        }
        found.bytes += bytes.len() as u64;
    }
    Ok(found)
}
