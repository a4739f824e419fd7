//! What a search is watched and stopped by.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

/// What a search is watched and stopped by.
pub struct Watch<'a> {
    /// Called after each candidate.
    pub done: &'a (dyn Fn() + Sync),
    /// Set it to stop.
    pub stop: Arc<AtomicBool>,
}

/// The search was stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("interrupted")]
pub struct Interrupted;

pub(crate) fn stop(watch: &Watch) -> Result<(), Interrupted> {
    match watch.stop.load(Ordering::Relaxed) {
        true => Err(Interrupted),
        false => Ok(()),
    }
}
