//! How many threads a solve may use, and work split in two, by the problem and never by the threads: sums are the same
//! however many threads there are.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Solves in progress in this process.
static RUNNING: AtomicUsize = AtomicUsize::new(0);

/// Counts one solve for as long as it lives.
pub struct Running;

impl Running {
    /// Counts this solve until the value is dropped.
    pub fn enter() -> Self {
        RUNNING.fetch_add(1, Ordering::Relaxed);
        Running
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        RUNNING.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Threads of those allowed that are worth using: one while other solves keep the processors busy.
pub fn threads_now(allowed: usize) -> usize {
    match RUNNING.load(Ordering::Relaxed) {
        0 | 1 => allowed,
        _ => 1,
    }
}

/// Runs both, side by side where two threads may be used.
pub fn both<A: Send, B: Send>(
    threads: usize,
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    if threads > 1 {
        rayon::join(first, second)
    } else {
        (first(), second())
    }
}

/// Index after the first items that have at least half of all the work.
pub fn halfway(work: &[usize]) -> usize {
    let total: usize = work.iter().sum();
    let mut sum = 0;
    let half = work.iter().position(|work| {
        sum += work;
        2 * sum >= total
    });
    half.map_or(work.len(), |at| at + 1)
}
