//! Whether a design exists, and what an infeasibility certificate states.

use std::path::Path;

use serde::Serialize;
use synth::certify::infeasible::{Limit, Refutation};
use synth::certify::ConditionMargin;
use synth::feasibility::{Answer, InfeasibilityFile};

use super::facts::not_proved;
use crate::cli::answer::Exit;
use synth::claim::Claim;

/// What is proved about the existence of a design.
#[derive(Debug, Serialize)]
pub struct Existence<'a> {
    /// No design exists whose multiplier entries (SI units) are at most this; null where none is excluded.
    bound: Option<f64>,
    /// What was proved about a part of the designs; null where the answer is about all.
    shown: Option<String>,
    /// `feasible`, `infeasible` (both proved) or `undecided`.
    #[serde(skip)]
    pub verdict: &'static str,
    /// The answer in words.
    #[serde(skip)]
    pub headline: String,
    /// The file that proves a no, or a part of one.
    #[serde(skip)]
    pub certificate: Option<&'a InfeasibilityFile>,
}

impl<'a> Existence<'a> {
    /// From the answer.
    pub fn of(answer: &'a Answer) -> Self {
        let (proof, shown) = match answer {
            Answer::Feasible(_) | Answer::Undecided(None) => (None, None),
            Answer::Infeasible(proof) => (Some(proof), None),
            Answer::Undecided(Some(proof)) => {
                let shown = partial_statement(&proof.file, &proof.limits);
                (Some(proof), Some(shown))
            }
        };
        let (verdict, headline) = match answer {
            Answer::Feasible(design) => {
                let gamma = Claim::AtMost(design.file.certificate.gamma);
                let how = format!("proved by a design with gamma {gamma} (not the smallest)");
                ("feasible", format!("FEASIBLE, {how}"))
            }
            Answer::Infeasible(proof) => {
                let what = statement(&proof.file, proof.bound);
                ("infeasible", format!("INFEASIBLE, proved: {what}"))
            }
            Answer::Undecided(_) => {
                let shown = shown.as_ref();
                let part = shown.map_or(String::new(), |shown| format!("; shown: {shown}"));
                let neither = "neither a design nor its impossibility could be proved";
                ("undecided", format!("UNDECIDED: {neither}{part}"))
            }
        };
        Existence {
            bound: proof.map(|proof| proof.bound),
            shown,
            verdict,
            headline,
            certificate: proof.map(|proof| &proof.file),
        }
    }
}

/// What weights state that do not cover every design.
fn partial_statement(proof: &InfeasibilityFile, limits: &[Limit]) -> String {
    let limits: Vec<String> = limits.iter().map(Limit::to_string).collect();
    let what = match proof.gains.is_empty() {
        true => "no design satisfies the conditions",
        false => "for these gains the conditions cannot hold",
    };
    format!("{what} {}", limits.join(", and "))
}

/// What an infeasibility certificate states.
fn statement(file: &InfeasibilityFile, bound: f64) -> String {
    let unbounded = bound == f64::MAX;
    let within = match unbounded {
        true => String::new(),
        false => {
            let bound = Claim::AtLeast(bound);
            format!(" with multiplier entries up to R = {bound:.4} (SI units)")
        }
    };
    if file.gains.is_empty() {
        return format!("no design{within} satisfies the conditions");
    }
    let blocking: Vec<String> = file.blocking_gains().iter().map(usize::to_string).collect();
    let because = match (file.gains.len(), blocking.as_slice()) {
        (1, _) => String::new(),
        (_, [one]) => format!(": gain {one} alone excludes them"),
        (_, several) => format!(": gains {} together exclude them", several.join(", ")),
    };
    format!("for these gains the conditions cannot hold{within}{because}")
}

/// What `verify` finds of an infeasibility certificate.
#[derive(Debug, Serialize)]
pub struct RefutationReport<'a> {
    /// Whether it is proved that no design exists.
    verdict: RefutationVerdict,
    /// Always `infeasible`.
    statement: &'static str,
    /// No design exists whose multiplier entries (SI units) are at most this; null where nothing is proved.
    bound: Option<f64>,
    /// The designs that are not covered.
    limits: Vec<String>,
    /// The given gains, from 1, that it is about.
    gains: Vec<usize>,
    /// The weight with the smallest margin.
    worst: Option<&'a ConditionMargin>,
    /// Every weight.
    conditions: Vec<&'a ConditionMargin>,
    /// The file, each of its sets of weights checked, and the designs that are not covered.
    #[serde(skip)]
    checked: (&'a InfeasibilityFile, &'a [Refutation], &'a [Limit]),
}

/// What is proved by an infeasibility certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum RefutationVerdict {
    /// No design exists.
    Proved,
    /// A part of the designs does not exist.
    Undecided,
    /// Nothing.
    NotProved,
}

impl<'a> RefutationReport<'a> {
    /// From the check of the file's sets of weights, and the designs that they leave open.
    pub fn new(
        file: &'a InfeasibilityFile,
        checked: &'a [Refutation],
        limits: &'a [Limit],
    ) -> Self {
        let conditions: Vec<_> = checked.iter().flat_map(|one| &one.conditions).collect();
        let worst = conditions.iter().copied();
        let bounds = checked.iter().map(|one| one.bound);
        RefutationReport {
            verdict: match (is_proved(checked), limits) {
                (true, []) => RefutationVerdict::Proved,
                (true, _) => RefutationVerdict::Undecided,
                (false, _) => RefutationVerdict::NotProved,
            },
            statement: "infeasible",
            bound: is_proved(checked).then(|| bounds.fold(f64::MAX, f64::min)),
            limits: limits.iter().map(Limit::to_string).collect(),
            gains: file.blocking_gains(),
            worst: worst.min_by(|a, b| a.margin.total_cmp(&b.margin)),
            conditions,
            checked: (file, checked, limits),
        }
    }

    /// Yes where no design exists.
    pub fn exit(&self) -> Exit {
        Exit::of(self.verdict == RefutationVerdict::Proved)
    }

    /// In words.
    pub fn lines(&self, path: &Path) -> Vec<String> {
        let (file, checked, limits) = self.checked;
        let title = format!("infeasibility of: {} ({})", file.name, path.display());
        let mut lines = vec![title];
        lines.extend(checked.iter().enumerate().map(|(index, one)| {
            format!(
                "dual multipliers {}: constant {:.6e} (must be below 0), {} matrices checked",
                index + 1,
                one.constant,
                one.conditions.len()
            )
        }));
        lines.extend(not_proved(self.conditions.iter().copied()));
        lines.push(match self.verdict {
            RefutationVerdict::Proved => {
                let bound = self.bound.unwrap_or(0.0);
                format!("verdict: PROVED, {}", statement(file, bound))
            }
            RefutationVerdict::Undecided => {
                format!("verdict: UNDECIDED, {}", partial_statement(file, limits))
            }
            RefutationVerdict::NotProved => "verdict: NOT PROVED".to_string(),
        });
        lines
    }
}

/// Whether every set of weights is proved.
pub fn is_proved(checked: &[Refutation]) -> bool {
    checked.iter().all(|one| one.proved)
}
