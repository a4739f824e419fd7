//! A design with its proof and its claims, the same in every verb that proves one.

use nalgebra::DVector;
use serde::Serialize;
use synth::certify::reach::{angle_above_vector_part_deg, angle_of_vector_part_deg, Along};
use synth::certify::theorem1::certified_start;
use synth::certify::{Report, Verdict};
use synth::design::{DesignFile, LargeSetCertificate, SearchRecord};
use synth::model::Model;
use synth::optimality::Optimality;
use synth::synthesis::{reached, CrossCheck, Synthesized};

use super::cross_check::CrossCheckReport;
use super::facts::{titled, ProofReport, SolverReport, SolverStatus};
use crate::base::number::short;
use crate::run::design::certified_angle_deg;
use crate::sim::transmissions::TransmissionBound;
use synth::claim::Claim;

/// What is proved of a design.
#[derive(Debug, Serialize)]
pub struct DesignReport<'a> {
    /// Its proof.
    #[serde(flatten)]
    pub proof: ProofReport<'a>,
    /// What it claims.
    #[serde(flatten)]
    pub claims: DesignClaims,
}

impl<'a> DesignReport<'a> {
    /// From a design and the outcome of its check.
    pub fn new(design: &DesignFile, model: &Model, report: &'a Report) -> Self {
        DesignReport {
            proof: ProofReport::new(report),
            claims: DesignClaims::of(design, model, report.verdict),
        }
    }

    /// In words.
    pub fn lines(&self) -> Vec<String> {
        let claims = self.claims.gain_lines().into_iter();
        let claims = claims.chain(self.claims.further_lines());
        claims.chain(self.proof.lines(None)).collect()
    }
}

/// What a synthesis or an analysis found.
#[derive(Debug, Serialize)]
pub struct SynthesisReport<'a> {
    /// The design.
    #[serde(flatten)]
    pub design: DesignReport<'a>,
    /// What the solvers did.
    #[serde(flatten)]
    solver: SolverReport<'a>,
    /// Its objective beside the best one that a solver reported; null where it is not proved.
    optimality: Option<Optimality>,
    /// Form of the decrease condition.
    form: &'a str,
    /// Vertices of the model.
    vertices: usize,
    /// The search that chose the model's numbers; null without one.
    search: Option<&'a SearchRecord>,
    /// The same in words.
    #[serde(skip)]
    found: Vec<String>,
    /// The smallest bound from both solvers; null where they were not asked.
    cross_check: Option<CrossCheckReport>,
}

impl<'a> SynthesisReport<'a> {
    /// From a design and the outcome of its check.
    pub fn new(
        found: &'a Synthesized,
        model: &Model,
        report: &'a Report,
        cross_check: Option<CrossCheck>,
    ) -> Self {
        let provenance = &found.file.provenance;
        let design = DesignReport::new(&found.file, model, report);
        SynthesisReport {
            // A gain that was asked for is not worse than the smallest: it is what was asked for.
            optimality: found
                .optimality
                .filter(|_| design.claims.gamma.is_some() && model.file.specs.gamma.is_none()),
            design,
            solver: SolverReport {
                status: SolverStatus::Solved,
                solve_seconds: found.solve_seconds,
                solver_runs: &provenance.solver_runs,
            },
            form: &provenance.form,
            vertices: model.task().system.vertices.len(),
            search: provenance.search.as_ref(),
            found: found_lines(model, provenance.search.as_ref()),
            cross_check: cross_check.map(|check| CrossCheckReport::new(model, &check)),
        }
    }

    /// In words.
    pub fn lines(&self, name: &str) -> Vec<String> {
        let mut lines = vec![format!("model: {name} ({} vertices)", self.vertices)];
        lines.extend(self.solver.lines());
        lines.extend(self.cross_check.iter().flat_map(CrossCheckReport::lines));
        lines.extend(self.found.iter().cloned());
        lines.extend(self.design.claims.gain_lines());
        lines.extend(self.design.claims.further_lines());
        let remark = self.optimality.and_then(|optimality| optimality.remark());
        lines.extend(self.design.proof.lines(remark.as_deref()));
        lines
    }
}

/// One line for each number that a search chose, beside the model's own.
fn found_lines(model: &Model, search: Option<&SearchRecord>) -> Vec<String> {
    // A model's types hold numbers, texts and lists only, so they can always be written.
    let file = serde_json::to_value(&model.file).unwrap_or_default();
    let varied = search.into_iter().flat_map(|search| &search.varied);
    let lines = varied.map(|one| {
        let place = one.field.replace(['.', '['], "/").replace(']', "");
        let own = file
            .pointer(&format!("/{place}"))
            .and_then(|own| own.as_f64());
        let own = own.map_or(String::new(), |own| format!("; the model has {own}"));
        let [lowest, highest] = [one.lowest, one.highest].map(short);
        format!(
            "  {} = {} (from {lowest} to {highest}{own})",
            one.field, one.value
        )
    });
    titled("found by the search:", lines)
}

/// The claims of a design; null, and no words, where it is not proved.
#[derive(Debug, Default, Serialize)]
pub struct DesignClaims {
    /// The bound of the L-infinity gain.
    pub gamma: Option<f64>,
    /// sup|y| / sup|tau| from rest.
    pub guaranteed_gain: Option<f64>,
    /// The weight of the disturbance.
    xi: Option<f64>,
    /// Pointing error from rest, and in the end from every certified start, at most (deg); null without such a claim.
    pointing_deg: Option<f64>,
    /// The rate likewise [rad/s].
    rate_bound_rad_s: Option<f64>,
    /// Starts with x0'U x0 up to this are certified: 1 where the torque acts at once.
    certified_start: Option<f64>,
    /// Largest angle such that every attitude at rest within it is a certified start (deg).
    certified_angle_deg: Option<f64>,
    /// Every attitude at rest up to this angle, about any axis, is in the set (deg).
    certified_angle_any_axis_deg: Option<f64>,
    /// The smallest angle along the must-contain states that are attitudes at rest (deg).
    certified_angle_along_deg: Option<f64>,
    /// How far the set goes along each must-contain state.
    must_contain: Vec<Along>,
    /// No two messages are closer than this (s); null where the model gives no shortest sampling interval.
    min_inter_event_s: Option<f64>,
    /// Its inverse.
    max_transmissions_per_s: Option<f64>,
    /// The large-set certificate; null for a design with one certificate.
    outer: Option<OuterClaims>,
    /// The bound that both numbers above come from.
    #[serde(skip)]
    transmissions: Option<TransmissionBound>,
}

/// The claims of the large-set certificate of a design with two.
#[derive(Debug, Serialize)]
struct OuterClaims {
    /// The bound of the L-infinity gain.
    gamma: f64,
    /// sup|y| / sup|tau| from rest.
    guaranteed_gain: f64,
    /// The weight of the disturbance.
    xi: f64,
    /// Largest angle such that every attitude at rest within it is a certified start (deg).
    certified_angle_deg: Option<f64>,
    /// Its trigger weight as a multiple of the inner one's.
    trigger_multiple: f64,
    /// x'Ux at each start that the large set must contain.
    start_levels: Vec<f64>,
    /// Time by which every certified start has come under the small set's certificate (s); null where that is not proved.
    hand_over_s: Option<f64>,
}

impl DesignClaims {
    /// From the numbers of a design and the verdict about them.
    pub fn of(design: &DesignFile, model: &Model, verdict: Verdict) -> Self {
        if verdict == Verdict::NotProved {
            return DesignClaims::default();
        }
        let part = &design.certificate;
        let along = reached(model, design);
        let angles = along.iter().filter_map(|one| one.angle_deg);
        let smallest = angles.reduce(f64::min);
        let transmissions = TransmissionBound::of_model(model);
        // A file that was read has been checked, so its large-set certificate can be read again.
        let outer = design.large_set_certificate(model).ok().flatten();
        DesignClaims {
            gamma: Some(part.gamma),
            guaranteed_gain: Some(part.guaranteed_gain),
            xi: Some(part.xi),
            pointing_deg: part
                .final_bounds
                .map(|bounds| angle_above_vector_part_deg(bounds.vector_part)),
            rate_bound_rad_s: part.final_bounds.map(|bounds| bounds.rate_rad_s),
            certified_start: design
                .certificate(model)
                .ok()
                .map(|certificate| certified_start(model, &certificate)),
            certified_angle_deg: certified_angle_deg(part.certified_vector_part),
            certified_angle_any_axis_deg: part.certified_vector_part.map(angle_of_vector_part_deg),
            certified_angle_along_deg: smallest,
            must_contain: along,
            min_inter_event_s: transmissions.map(|bound| bound.min_inter_event_s),
            max_transmissions_per_s: transmissions.map(|bound| bound.max_transmissions_per_s),
            outer: outer.as_ref().map(OuterClaims::of),
            transmissions,
        }
    }

    /// The gain and the certified angle, rounded.
    pub fn gain_lines(&self) -> Vec<String> {
        let gamma = self.gamma.map(Claim::AtMost);
        let gamma = gamma.map(|gamma| format!("gamma: {gamma}"));
        let gain = self.guaranteed_gain.map(Claim::AtMost);
        let gain =
            gain.map(|gain| format!("guaranteed gain: {gain} (sup|y| / sup|tau| from rest)"));
        let angle = self.certified_angle_deg.map(Claim::AtLeast);
        let angle =
            angle.map(|angle| format!("certified set: every attitude at rest up to {angle} deg"));
        let bounds = self.pointing_deg.zip(self.rate_bound_rad_s);
        let handed_over = |outer: &OuterClaims| outer.hand_over_s.is_some();
        let set = match self.outer.as_ref().map(handed_over) {
            None => "",
            Some(true) => " from every start in the large set",
            Some(false) => " from the small set",
        };
        let bounds = bounds.map(|(pointing, rate)| {
            format!(
                "from rest, and in the end{set}: pointing error at most {} deg, rate at most {} rad/s",
                Claim::AtMost(pointing),
                Claim::AtMost(rate)
            )
        });
        let start = self.certified_start.filter(|start| *start < 1.0);
        let start = start.map(|start| {
            format!(
                "certified starts: x'Ux up to {}, because no torque acts before the first message",
                Claim::AtLeast(start)
            )
        });
        let lines = [gamma, gain, angle, start, bounds];
        lines.into_iter().flatten().collect()
    }

    /// One line for each further claim.
    pub fn further_lines(&self) -> Vec<String> {
        let mut lines = self.outer.as_ref().map_or(Vec::new(), OuterClaims::lines);
        lines.extend(self.must_contain.iter().enumerate().map(|(index, state)| {
            let angle = state.angle_deg.map(Claim::AtLeast);
            let angle = angle.map_or(String::new(), |angle| {
                format!(", up to {angle} deg at rest")
            });
            let (number, scale) = (index + 1, Claim::AtLeast(state.scale));
            format!("must-contain state {number}: contained up to {scale} times the state{angle}")
        }));
        lines.extend(self.transmissions.iter().map(TransmissionBound::describe));
        lines
    }
}

impl OuterClaims {
    fn of(outer: &LargeSetCertificate) -> Self {
        let certificate = &outer.certificate;
        let level = |state: &Vec<f64>| {
            let state = DVector::from_column_slice(state);
            (state.transpose() * &certificate.lyapunov * &state)[(0, 0)]
        };
        let starts = outer.model.file.specs.must_contain.iter();
        OuterClaims {
            gamma: certificate.gain_bound,
            guaranteed_gain: certificate.guaranteed_gain,
            xi: certificate.disturbance_weight,
            certified_angle_deg: certified_angle_deg(certificate.certified_vector_part),
            trigger_multiple: certificate.trigger_multiple,
            start_levels: starts.map(level).collect(),
            hand_over_s: outer.hand_over_time(),
        }
    }

    fn lines(&self) -> Vec<String> {
        let mut lines = vec![format!(
            "large-set certificate: gamma {}, guaranteed gain {}",
            Claim::AtMost(self.gamma),
            Claim::AtMost(self.guaranteed_gain)
        )];
        let angle = self.certified_angle_deg.map(Claim::AtLeast);
        lines.extend(
            angle.map(|angle| {
                format!("large certified set: every attitude at rest up to {angle} deg")
            }),
        );
        lines.extend(self.start_levels.iter().enumerate().map(|(index, level)| {
            format!(
                "start {} in the large set: x'Ux = {} (the set: at most 1)",
                index + 1,
                Claim::AtMost(*level)
            )
        }));
        lines.push(match self.hand_over_s.map(Claim::AtMost) {
            Some(seconds) => {
                format!("every start in the large set comes under the small set's certificate within {seconds:.4} s")
            }
            None => "that a start in the large set reaches the small one is not proved".to_string(),
        });
        lines
    }
}
