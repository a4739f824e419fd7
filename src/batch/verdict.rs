//! The names of verdicts in tables.

use crate::run::summary::RunVerdict;

/// Verdicts, the worst first.
pub const VERDICTS: [RunVerdict; 4] = [
    RunVerdict::ProofBroken,
    RunVerdict::Diverged,
    RunVerdict::RequirementsMissed,
    RunVerdict::RequirementsMet,
];

/// The name of a verdict as files have it.
pub fn verdict_name(verdict: RunVerdict) -> &'static str {
    match verdict {
        RunVerdict::RequirementsMet => "requirements_met",
        RunVerdict::RequirementsMissed => "requirements_missed",
        RunVerdict::Diverged => "diverged",
        RunVerdict::ProofBroken => "proof_broken",
    }
}

/// The verdict of that name.
pub fn verdict_of(name: &str) -> Option<RunVerdict> {
    let found = VERDICTS.iter().find(|known| verdict_name(**known) == name);
    found.copied()
}
