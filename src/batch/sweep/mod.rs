//! A sweep: variants of one file over a grid, each run and reduced to one row.
//!
//! An [`axis::Axis`] is one number of the file with its values, a [`grid::Grid`] is their product, a
//! [`subject::Subject`] turns a point into an [`outcome::PointOutcome`], a [`journal::Journal`] keeps those
//! that are done, [`table`] makes columns of them.

pub mod axis;
pub mod finished;
pub mod grid;
pub mod journal;
pub mod outcome;
pub mod subject;
pub mod table;

use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use grid::Grid;
use journal::{Journal, JournalError, Known};
use outcome::{PointOutcome, FAILED};
use subject::Subject;

use super::watch::Watch;

/// Why a sweep did not finish.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// It was stopped.
    #[error("interrupted: {done} of {points} points are done")]
    Interrupted {
        /// Points that are kept.
        done: usize,
        /// Points of the grid.
        points: usize,
    },
    /// A point cannot be kept.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The threads could not be started.
    #[error("the threads cannot be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// Runs every point that is not known yet on `jobs` threads (0: one for each processor) and keeps each in
/// the journal. The outcomes are in the order of the grid, whatever the number of threads.
///
/// # Errors
/// The sweep was stopped; a point that cannot be kept; threads that cannot be started.
pub fn run(
    subject: &Subject,
    grid: &Grid,
    jobs: usize,
    (journal, mut known): (&Journal, Known),
    watch: &Watch,
) -> Result<Vec<PointOutcome>, SweepError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build()?;
    let stopped = || watch.stopped();
    let failure = OnceLock::new();
    let one = |index: usize| {
        if stopped() || failure.get().is_some() {
            return None;
        }
        let outcome = run_point(subject, grid, index, &watch.stop);
        // A synthesis that was stopped says nothing about its point.
        if stopped() {
            return None;
        }
        if let Err(error) = journal.keep(index, &outcome) {
            let _ = failure.set(error);
            return None;
        }
        (watch.done)();
        Some((index, outcome))
    };
    let missing = 0..grid.points();
    let missing: Vec<usize> = missing.filter(|&index| known[index].is_none()).collect();
    let found: Vec<Option<(usize, PointOutcome)>> =
        pool.install(|| missing.into_par_iter().with_max_len(1).map(one).collect());
    for (index, outcome) in found.into_iter().flatten() {
        known[index] = Some(outcome);
    }
    if let Some(error) = failure.into_inner() {
        return Err(error.into());
    }
    journal.flush()?;
    let done = known.iter().flatten().count();
    let complete: Option<Vec<PointOutcome>> = known.into_iter().collect();
    complete.ok_or(SweepError::Interrupted {
        done,
        points: grid.points(),
    })
}

/// Runs a point; a defect of the program that one point shows must not cost the others.
fn run_point(subject: &Subject, grid: &Grid, index: usize, stop: &Arc<AtomicBool>) -> PointOutcome {
    let values = grid.point(index);
    let outcome = catch_unwind(AssertUnwindSafe(|| subject.run(grid, &values, stop)));
    outcome.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        let reason = format!("the program failed here: {}", text.unwrap_or("no message"));
        PointOutcome::without_numbers(values, FAILED, reason)
    })
}
