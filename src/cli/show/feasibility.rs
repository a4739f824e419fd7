//! Whether a design exists, as text.

use synth::certify::infeasible::Limit;
use synth::feasibility::{Answer, InfeasibilityFile};

/// The answer's name in reports.
pub fn verdict(answer: &Answer) -> &'static str {
    match answer {
        Answer::Feasible(_) => "feasible",
        Answer::Infeasible(_) => "infeasible",
        Answer::Undecided(_) => "undecided",
    }
}

/// The bound of proved weights.
pub fn bound(answer: &Answer) -> Option<f64> {
    match answer {
        Answer::Infeasible(proof) | Answer::Undecided(Some(proof)) => Some(proof.bound),
        _ => None,
    }
}

/// What was proved about a part of the designs, where the whole is undecided.
pub fn shown(answer: &Answer) -> Option<String> {
    match answer {
        Answer::Undecided(Some(proof)) => Some(partial_statement(&proof.file, &proof.limits)),
        _ => None,
    }
}

/// What weights state that do not cover every design.
pub(crate) fn partial_statement(proof: &InfeasibilityFile, limits: &[Limit]) -> String {
    let limits: Vec<String> = limits.iter().map(Limit::to_string).collect();
    let what = match proof.gains.is_empty() {
        true => "no design satisfies the conditions",
        false => "for these gains the conditions cannot hold",
    };
    format!("{what} {}", limits.join(", and "))
}

/// The given gains, from 1, that a proved no is about.
pub fn blocking_gains(answer: &Answer) -> Vec<usize> {
    match answer {
        Answer::Infeasible(proof) => proof.file.blocking_gains(),
        _ => Vec::new(),
    }
}

/// What an infeasibility certificate states.
pub(crate) fn statement(file: &InfeasibilityFile, bound: f64) -> String {
    let unbounded = bound == f64::MAX;
    let within = match unbounded {
        true => String::new(),
        false => format!(" with multiplier entries up to R = {bound:.3e} (SI units)"),
    };
    if file.gains.is_empty() {
        return format!("no design{within} satisfies the conditions");
    }
    let blocking: Vec<String> = file.blocking_gains().iter().map(usize::to_string).collect();
    let because = match (file.gains.len(), blocking.as_slice()) {
        (1, _) => String::new(),
        (_, [one]) => format!(": gain {one} alone rules them out"),
        (_, several) => format!(": gains {} together rule them out", several.join(", ")),
    };
    format!("for these gains the conditions cannot hold{within}{because}")
}

/// The answer as text.
pub fn headline(answer: &Answer) -> String {
    match answer {
        Answer::Feasible(design) => format!(
            "FEASIBLE, proved by a design with gamma {:.6} (not the smallest)",
            design.file.certificate.gamma
        ),
        Answer::Infeasible(proof) => format!(
            "INFEASIBLE, proved: {}",
            statement(&proof.file, proof.bound)
        ),
        Answer::Undecided(None) => {
            "UNDECIDED: neither a design nor its impossibility could be proved".to_string()
        }
        Answer::Undecided(Some(proof)) => format!(
            "UNDECIDED: neither a design nor its impossibility could be proved; shown: {}",
            partial_statement(&proof.file, &proof.limits)
        ),
    }
}

/// The smallest slack as text.
pub fn slack_line(slack: Option<f64>) -> Option<String> {
    let slack = slack?;
    Some(format!(
        "smallest slack t with which every condition holds: {slack:.4e} (scaled units; the solver's number, not proved)"
    ))
}

/// The conditions that block.
pub fn blocking_lines(blocking: &[(String, f64)]) -> Vec<String> {
    if blocking.is_empty() {
        return Vec::new();
    }
    let mut lines = vec!["conditions that block (share of the dual solution):".to_string()];
    let shares = blocking.iter().take(12);
    lines.extend(shares.map(|(name, fraction)| format!("  {:5.1} %  {name}", 100.0 * fraction)));
    lines
}
