//! Whether a search was stopped.

use crate::batch::watch::Watch;

/// The search was stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("interrupted")]
pub struct Interrupted;

pub(crate) fn stop(watch: &Watch) -> Result<(), Interrupted> {
    match watch.stopped() {
        true => Err(Interrupted),
        false => Ok(()),
    }
}
