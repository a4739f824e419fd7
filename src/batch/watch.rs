//! What many runs are watched and stopped by.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

/// What many runs are watched and stopped by.
pub struct Watch<'a> {
    /// Called after each run, from several threads.
    pub done: &'a (dyn Fn() + Sync),
    /// Set it to stop; runs that are not begun yet are left out then.
    pub stop: Arc<AtomicBool>,
}

impl Watch<'_> {
    /// Whether it was stopped.
    pub fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
