//! How many threads a solve may use.

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
