//! A sweep: variants of one file over a grid, each run and reduced to one row.
//!
//! An [`axis::Axis`] is one number of the file with its values, a [`grid::Grid`] is their product, a
//! [`subject::Subject`] turns a point into an [`outcome::PointOutcome`], and [`table`] writes the rows.

pub mod axis;
pub mod grid;
pub mod outcome;
pub mod parameter;
pub mod subject;
pub mod table;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use rayon::prelude::*;

use grid::Grid;
use outcome::PointOutcome;
use subject::Subject;

/// What a sweep is watched and stopped by.
pub struct Watch<'a> {
    /// Called after each point, from several threads.
    pub done: &'a (dyn Fn() + Sync),
    /// Set it to stop; the points not begun yet are left out then.
    pub stop: Arc<AtomicBool>,
}

/// Why a sweep did not finish.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// It was stopped.
    #[error("interrupted")]
    Interrupted,
    /// The threads could not be started.
    #[error("the threads cannot be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// Runs every point on `jobs` threads (0: one for each processor). The outcomes are in the order of
/// the grid, whatever the number of threads.
///
/// # Errors
/// The sweep was stopped; threads that cannot be started.
pub fn run(
    subject: &Subject,
    grid: &Grid,
    jobs: usize,
    watch: &Watch,
) -> Result<Vec<PointOutcome>, SweepError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build()?;
    let stopped = || watch.stop.load(Ordering::Relaxed);
    let one = |index: usize| {
        if stopped() {
            return None;
        }
        let outcome = subject.run(grid, &grid.point(index), &watch.stop);
        (watch.done)();
        Some(outcome)
    };
    let outcomes: Option<Vec<_>> =
        pool.install(|| (0..grid.points()).into_par_iter().map(one).collect());
    match outcomes {
        Some(outcomes) if !stopped() => Ok(outcomes),
        _ => Err(SweepError::Interrupted),
    }
}
