//! Values of options, read with what is allowed in the refusal.

use crate::batch::campaign::plan::MAX_RUNS;

/// A whole number, 0 or above, of an option.
pub(crate) fn whole(text: &str) -> Result<u64, String> {
    let number = text.parse();
    number.map_err(|_| format!("it must be a whole number from 0 to {}", u64::MAX))
}

/// The number of runs of a campaign.
pub(crate) fn run_count(text: &str) -> Result<u64, String> {
    let number = text.parse().ok();
    let number = number.filter(|runs| (1..=MAX_RUNS).contains(runs));
    number.ok_or_else(|| format!("it must be a whole number from 1 to {MAX_RUNS}"))
}
