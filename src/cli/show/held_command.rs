//! Given gains with a trigger on the command: what is proved of them.

use serde::Serialize;
use synth::certify::held_command::HeldCommandCertificate;
use synth::certify::reach::{angle_above_vector_part_deg, angle_of_vector_part_deg};
use synth::certify::{Report, Verdict};
use synth::claim::Claim;
use synth::held_command::{CommandProof, HeldCommandSynthesized};
use synth::programs::Decision;

use super::facts::{ProofReport, SolverReport, SolverStatus};
use super::no_design::FailureReport;

/// What a proof claims; nulls where nothing is proved.
#[derive(Debug, Default, Serialize)]
pub struct HeldCommandClaims {
    /// Every attitude at rest up to this angle, about any axis, is a certified start (deg).
    certified_angle_deg: Option<f64>,
    /// Bound on the angle from rest, and in the end from every certified start (deg).
    pointing_deg: Option<f64>,
    /// The same of the rate [rad/s].
    rate_bound_rad_s: Option<f64>,
    /// Share of the command within the torque limit on the set of starts.
    within_limit: Option<f64>,
    /// Time by which every certified start has reached the last set (s); null where there is one certificate.
    hand_over_s: Option<f64>,
}

impl HeldCommandClaims {
    fn of(proof: &CommandProof, verdict: Verdict) -> Self {
        if verdict != Verdict::Proved {
            return HeldCommandClaims::default();
        }
        let start: &HeldCommandCertificate = &proof.certificate;
        let last = proof.last().final_bounds;
        HeldCommandClaims {
            certified_angle_deg: Some(angle_of_vector_part_deg(start.certified_vector_part)),
            pointing_deg: Some(angle_above_vector_part_deg(last.vector_part)),
            rate_bound_rad_s: Some(last.rate),
            within_limit: Some(start.within_limit),
            hand_over_s: proof.hand_over_time(),
        }
    }

    fn lines(&self) -> impl Iterator<Item = String> {
        let angle = self.certified_angle_deg.map(Claim::AtLeast);
        let angle =
            angle.map(|angle| format!("certified set: every attitude at rest up to {angle} deg"));
        let share = self.within_limit.filter(|share| *share < 1.0);
        let share = share.map(|share| {
            format!("the torque may saturate there: {share} of the command stays within the limit")
        });
        let time = self.hand_over_s.map(|seconds| {
            format!(
                "handed over to the final set within {:.4} s",
                Claim::AtMost(seconds)
            )
        });
        let bound = self.pointing_deg.zip(self.rate_bound_rad_s);
        let bound = bound.map(|(angle, rate)| {
            let (angle, rate) = (Claim::AtMost(angle), Claim::AtMost(rate));
            format!("in the end: at most {angle:.4} deg and {rate:.4} rad/s")
        });
        [angle, share, time, bound].into_iter().flatten()
    }
}

/// A proof of given gains with a trigger on the command.
#[derive(Debug, Serialize)]
pub struct HeldCommandReport<'a> {
    /// Its proof.
    #[serde(flatten)]
    proof: ProofReport<'a>,
    /// What it claims.
    #[serde(flatten)]
    claims: HeldCommandClaims,
    /// How it was found; without it where a file is verified.
    #[serde(flatten)]
    solver: Option<SolverReport<'a>>,
}

impl<'a> HeldCommandReport<'a> {
    /// Of a file, and the outcome of its check.
    pub fn verified(proof: &CommandProof, report: &'a Report) -> Self {
        HeldCommandReport {
            proof: ProofReport::new(report),
            claims: HeldCommandClaims::of(proof, report.verdict),
            solver: None,
        }
    }

    /// Of what was found, and the outcome of its check.
    pub fn found(
        proof: &CommandProof,
        found: &'a HeldCommandSynthesized,
        report: &'a Report,
    ) -> Self {
        HeldCommandReport {
            solver: Some(SolverReport {
                status: SolverStatus::Solved,
                solve_seconds: found.solve_seconds,
                solver_runs: &found.file.provenance.solver_runs,
            }),
            ..HeldCommandReport::verified(proof, report)
        }
    }

    /// In words.
    pub fn lines(&self) -> Vec<String> {
        let solver = self.solver.iter().flat_map(SolverReport::lines);
        let lines = solver.chain(self.claims.lines());
        lines.chain(self.proof.lines(None)).collect()
    }
}

/// No proof was found.
pub fn nothing_found(failure: &Decision<()>) -> (FailureReport<'_>, Vec<String>) {
    let status = SolverStatus::Undecided;
    let solver = SolverReport {
        status,
        solve_seconds: failure.solve_seconds,
        solver_runs: &failure.runs,
    };
    let mut lines: Vec<String> = solver.lines().collect();
    lines.push(status.nothing_found("proof for these gains"));
    (FailureReport::new(solver, &failure.blocking), lines)
}
