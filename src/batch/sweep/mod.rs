//! A sweep: variants of one file over a grid, each run and reduced to one row.
//!
//! A [`subject::Subject`] turns a point of a grid into an [`outcome::PointOutcome`], a
//! [`points::PointStore`] keeps those that are done, and [`table`] makes columns of them.

pub mod finished;
pub mod outcome;
pub mod points;
pub mod subject;
pub mod table;

use std::sync::atomic::AtomicBool;
use std::sync::Arc;

use super::engine::{check, Control, Interrupted, Job, Threads};
use super::store::journal::JournalError;
use super::variation::grid::Grid;
use outcome::{PointOutcome, FAILED};
use points::PointStore;
use subject::Subject;

/// Why a sweep did not finish.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// It was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// A point cannot be kept.
    #[error(transparent)]
    Journal(#[from] JournalError),
}

/// The points of a grid.
struct SweepJob<'a> {
    subject: &'a Subject,
    grid: &'a Grid,
}

impl Job for SweepJob<'_> {
    type Record = PointOutcome;
    type Error = SweepError;

    fn run(&self, index: u64, stop: &Arc<AtomicBool>) -> Result<PointOutcome, SweepError> {
        let point = index as usize;
        let outcome = self.subject.run(self.grid, &self.grid.point(point), stop);
        // A synthesis that was stopped says nothing about its point.
        check(stop)?;
        Ok(outcome.at(point, self.grid))
    }

    fn failed(&self, index: u64, message: &str) -> Option<PointOutcome> {
        let reason = format!("the program failed here: {message}");
        let outcome = PointOutcome::without_numbers(FAILED, reason);
        Some(outcome.at(index as usize, self.grid))
    }
}

/// Runs every point that is not known yet and keeps each in the store. The outcomes are in the order of
/// the grid, whatever the number of threads.
///
/// # Errors
/// The sweep was stopped; a point that cannot be kept.
pub fn run(
    subject: &Subject,
    grid: &Grid,
    threads: &Threads,
    store: &PointStore,
    control: &Control,
) -> Result<Vec<PointOutcome>, SweepError> {
    threads.execute(&SweepJob { subject, grid }, store, control)?;
    // All are there now.
    Ok(store.outcomes()?.ok_or(Interrupted)?)
}
