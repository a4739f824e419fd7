//! The points that are done, on disk: a sweep that was ended can go on.
//!
//! `points.jsonl` is one JSON object a line: first what is swept, then a line for each point in the order
//! in which they were finished.

use std::ops::Range;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::{Deserialize, Serialize};

use super::outcome::PointOutcome;
use super::subject::Subject;
use crate::base::files::OutputError;
use crate::base::provenance::{sha256_of, GENERATOR};
use crate::batch::store::identity::first_difference;
use crate::batch::store::journal::{Journal, JournalError, LineError};
use crate::batch::store::Store;
use crate::batch::variation::axis::Axis;
use crate::batch::variation::grid::Grid;

/// Name of the journal.
pub const JOURNAL_FILE: &str = "points.jsonl";

/// What is swept: a sweep goes on only where all of it is the same.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepIdentity {
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
    /// The axes, with the full names of their numbers.
    pub axes: Vec<Axis>,
}

impl SweepIdentity {
    /// Of a sweep of a file with this text.
    pub fn new(text: &str, subject: &Subject, grid: &Grid) -> Self {
        let axes = grid.axes().map(|(name, values)| Axis {
            name: name.to_string(),
            values: values.to_vec(),
        });
        SweepIdentity {
            generator: GENERATOR.to_string(),
            kind: subject.kind().to_string(),
            file_sha256: sha256_of(text),
            design_sha256: subject.design_sha256().map(str::to_string),
            solver: subject.solver(),
            axes: axes.collect(),
        }
    }
}

/// The keys of the identity, those that explain a difference best first, and what they are called.
const IDENTITY: [(&str, &str); 6] = [
    ("file_sha256", "file"),
    ("kind", "kind of file"),
    ("axes", "--vary"),
    ("design_sha256", "design"),
    ("solver", "solver"),
    ("generator", "version of the program"),
];

/// First line of the journal.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FirstRecord {
    sweep: SweepIdentity,
}

/// The outcomes of a sweep's points, in a folder that nobody else can write to meanwhile.
pub struct PointStore {
    journal: Journal,
    header: String,
    /// By number of the point.
    known: Mutex<Vec<Option<PointOutcome>>>,
}

impl PointStore {
    /// Opens the points in a folder, or begins them. With `restart` they are begun in any case.
    ///
    /// # Errors
    /// The points are another sweep's, damaged, in use, or cannot be read or written.
    pub fn open(
        folder: &Path,
        identity: &SweepIdentity,
        grid: &Grid,
        restart: bool,
    ) -> Result<Self, JournalError> {
        let header = json_line(&FirstRecord {
            sweep: identity.clone(),
        });
        let mut known = vec![None; grid.points()];
        let take = |number: usize, line: &[u8]| match number {
            1 => check_header(line, identity),
            _ => take_point(line, grid, &mut known),
        };
        let journal = Journal::open((folder, JOURNAL_FILE), &header, restart, take)?;
        Ok(PointStore {
            journal,
            header,
            known: Mutex::new(known),
        })
    }

    /// Points that are done.
    pub fn done(&self) -> usize {
        self.known().iter().flatten().count()
    }

    /// The outcomes in the order of the grid, written through to the disk; `None` when one is missing.
    ///
    /// # Errors
    /// They cannot be written.
    pub fn outcomes(&self) -> Result<Option<Vec<PointOutcome>>, JournalError> {
        self.journal.flush()?;
        Ok(self.known().iter().cloned().collect())
    }

    /// Puts the lines of a finished sweep in the order of the grid, so that the journal's bytes do not
    /// tell how often the sweep was ended.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn sort(self, outcomes: &[PointOutcome]) -> Result<(), OutputError> {
        let mut text = self.header;
        text.extend(outcomes.iter().map(json_line));
        self.journal.replace(&text)
    }

    fn known(&self) -> MutexGuard<'_, Vec<Option<PointOutcome>>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Store<PointOutcome> for PointStore {
    type Error = JournalError;

    fn missing(&self) -> Vec<Range<u64>> {
        let known = self.known();
        let missing = (0u64..).zip(known.iter());
        let missing = missing.filter(|(_, outcome)| outcome.is_none());
        missing.map(|(index, _)| index..index + 1).collect()
    }

    fn keep(&self, chunk: Range<u64>, outcomes: Vec<PointOutcome>) -> Result<(), JournalError> {
        for (index, outcome) in chunk.zip(outcomes) {
            self.journal.append(&json_line(&outcome))?;
            if let Some(place) = self.known().get_mut(index as usize) {
                *place = Some(outcome);
            }
        }
        Ok(())
    }
}

fn parse<T: for<'a> Deserialize<'a>>(line: &[u8]) -> Result<T, LineError> {
    serde_json::from_slice(line).map_err(|error| LineError::Damaged(error.to_string()))
}

fn check_header(line: &[u8], identity: &SweepIdentity) -> Result<(), LineError> {
    let header: FirstRecord = parse(line)?;
    let keys = IDENTITY.map(|(key, _)| key);
    match first_difference(&header.sweep, identity, &keys) {
        None => Ok(()),
        Some(difference) => {
            let named = IDENTITY.into_iter().find(|(key, _)| *key == difference.key);
            Err(LineError::Other(named.map_or("work", |(_, name)| name)))
        }
    }
}

fn take_point(
    line: &[u8],
    grid: &Grid,
    known: &mut [Option<PointOutcome>],
) -> Result<(), LineError> {
    let outcome: PointOutcome = parse(line)?;
    let point = outcome.point;
    let place = known.get_mut(point);
    let place = place
        .ok_or_else(|| LineError::Damaged(format!("there is no point {point} in the grid")))?;
    *place = Some(outcome.at(point, grid));
    Ok(())
}

/// The lines' types hold finite numbers, texts and lists only, so they can always be written.
fn json_line<T: Serialize>(value: &T) -> String {
    serde_json::to_string(value).unwrap_or_default() + "\n"
}
