//! From what was watched to the summary and its verdict.

use synth::claim::Claim;
use synth::model::Mismatch;

use super::design::Design;
use super::imperfections::{self, Flown};
use super::inner::InnerMonitor;
use super::log::{has_every_sample, Log};
use super::summary::{
    CertificateOutcome, InnerOutcome, OutputBound, RunProvenance, RunVerdict, Scales, Summary,
    SUMMARY_SCHEMA_VERSION,
};
use crate::base::provenance::GENERATOR;
use crate::plants::{System, SystemKind};
use crate::scenario::Scenario;
use crate::sim::bench::Gauge;
use crate::sim::closed_loop::End;
use crate::sim::events::EventCount;
use crate::sim::integrator::Method;
use crate::sim::lyapunov::{exceeds, LyapunovMonitor, ROUNDING};
use crate::sim::metrics::Measured;
use crate::sim::transmissions::TransmissionBound;

/// What the summary says of a plant and its controller.
pub(crate) struct About {
    pub system: SystemKind,
    pub controller: String,
    /// Torque limits of the controller, N m (inputs of another plant).
    pub torque_limit: Vec<f64>,
    /// Settling tolerance, deg (norm of the state for another plant).
    pub settle_tolerance: f64,
    pub notes: Vec<String>,
    /// Whether the messages of the link count, where there is one.
    pub sends_by_link: bool,
}

/// The summary, not judged yet.
pub(crate) fn summary<G, const N: usize, const M: usize, const D: usize, const L: usize>(
    scenario: &Scenario,
    design: Option<&Design>,
    log: &Log<G, N, M, D, L>,
    (about, end): (About, End),
    certificate: Option<CertificateOutcome>,
) -> Summary
where
    G: Gauge<N, M, D, L>,
{
    let events = &log.events;
    let mut notes = about.notes;
    if let End::Diverged { time_s } = end {
        notes.push(format!(
            "The state was no longer finite at {time_s} s; the run stopped there."
        ));
    }
    let broken = certificate
        .as_ref()
        .map_or(0, CertificateOutcome::violations);
    let left = log.funnel.as_ref().map_or(0, |usage| usage.outside_steps);
    let bound = TransmissionBound::of_instants(&scenario.instants);
    notes.extend(closer_samples(design, bound));
    if !has_every_sample(scenario) {
        notes.push(
            "The run has too many samples for a row each: its trajectory has those at which a message was sent."
                .to_string(),
        );
    }
    Summary {
        schema_version: SUMMARY_SCHEMA_VERSION,
        scenario: scenario.name.clone(),
        source: scenario.source.clone(),
        system: about.system,
        controller: about.controller,
        verdict: RunVerdict::RequirementsMissed,
        measured: Measured {
            violations: broken.max(left),
            ..log.measured(scenario.duration_s)
        },
        requirements: Vec::new(),
        samples: events.samples,
        steps: log.steps,
        shortest_interval_s: events.shortest_interval_s,
        mean_interval_s: events.mean_interval_s(),
        triggers_per_s: 0.0,
        min_inter_event_s: bound.map(|bound| bound.min_inter_event_s),
        max_transmissions_per_s: bound.map(|bound| bound.max_transmissions_per_s),
        held_samples: events.held,
        first_hold: events.first_hold.map(|reason| reason.to_string()),
        samples_outside_box: events.outside_box,
        late_samples: events.late,
        largest_membership_mismatch: events.largest_mismatch,
        certificate,
        link: log.link.clone(),
        network: log.network.clone(),
        funnel: log.funnel.clone(),
        threshold: log.threshold.clone(),
        notes,
        scales: Scales {
            duration_s: scenario.duration_s,
            torque_limit: about.torque_limit,
            settle_tolerance: about.settle_tolerance,
            settle_tolerance_component: scenario.settle_tolerance_component,
            tail_s: scenario.tail_s,
        },
        provenance: RunProvenance {
            generator: GENERATOR.to_string(),
            scenario_sha256: scenario.sha256.clone(),
            design_sha256: design.map(|design| design.sha256.clone()),
            random_generator: "chacha8".to_string(),
            seed: scenario.seed,
            integrator: integrator(&scenario.method),
        },
    }
}

/// What is to be said when the scenario samples faster than the design's model allows.
fn closer_samples(design: Option<&Design>, bound: Option<TransmissionBound>) -> Option<String> {
    let promised = TransmissionBound::of_model(&design?.model)?.min_inter_event_s;
    let shortest = bound?.min_inter_event_s;
    (shortest < promised * (1.0 - ROUNDING)).then(|| {
        format!(
            "Samples may be {shortest} s apart, closer than the model's {promised} s, so its minimum \
             inter-event time does not hold in this run."
        )
    })
}

fn integrator(method: &Method) -> String {
    match method {
        Method::RungeKutta4 { step_s } => format!("Runge-Kutta 4, steps of at most {step_s} s"),
        Method::DormandPrince853 { tolerance } => {
            format!("Dormand-Prince 8(5,3), tolerance {tolerance:e}")
        }
    }
}

/// What became of a design's claims.
pub(crate) fn certificate<const N: usize>(
    scenario: &Scenario,
    design: &Design,
    (monitor, inner): (&LyapunovMonitor<N>, Option<&InnerMonitor<N>>),
    (events, flown): (&EventCount, &Flown),
    from_rest_in_origin: bool,
) -> CertificateOutcome {
    let mut not_covered = design.not_covered(scenario);
    let imperfections = imperfections::compare(design, scenario, flown);
    not_covered.extend(imperfections.not_covered);
    let start = monitor.start_level;
    let bound = monitor.claims().disturbance_bound;
    let peak_disturbance = monitor.disturbance_squared.sqrt();
    if exceeds(peak_disturbance, bound * (1.0 + ROUNDING)) {
        not_covered.push(format!(
            "the disturbance reaches {}; the proof is for at most {bound}",
            Claim::AtMost(peak_disturbance)
        ));
    }
    let seen = events.largest_mismatch.unwrap_or(0.0);
    match design.model.file.mismatch {
        Mismatch::Kappa(kappa) if design.certificate.is_matched(&design.model) && seen > kappa => {
            not_covered.push(format!(
                "a membership differs by {} from that at the sample sent last; the proof assumes \
                 at most kappa = {kappa}",
                Claim::AtMost(seen)
            ));
        }
        _ => {}
    }
    let certificate = &design.certificate;
    // What is not proved claims nothing.
    let gains = [certificate.gain_bound, certificate.guaranteed_gain];
    let [gamma, guaranteed_gain] = gains.map(|gain| design.proved().then_some(gain));
    let claims = monitor.claims();
    let enters = not_covered.is_empty();
    let level = claims.start_level;
    if exceeds(start, level * (1.0 + ROUNDING)) {
        not_covered.push(format!(
            "the start is not in the certified set: x'Ux is {}, the set is x'Ux <= {level}",
            Claim::AtMost(start)
        ));
    }
    let from_start = enters && not_covered.is_empty();
    let gains = [gamma, guaranteed_gain];
    // With late messages the functional at the entry is not x'Ux alone: what is known of it comes from the start.
    let enters = if claims.networked { from_start } else { enters };
    let inner = inner.map(|inner| inner.outcome([enters, from_start], gains));
    let worst = design.report.worst();
    let peak_output = monitor.output_squared.sqrt();
    let ratio = peak_output / peak_disturbance;
    CertificateOutcome {
        proved: design.proved(),
        worst_condition: worst.map(|condition| condition.name.clone()),
        worst_margin: worst.map(|condition| condition.margin),
        covers_run: not_covered.is_empty(),
        not_covered,
        covered: imperfections.covered,
        start_level: start,
        largest_lyapunov_ratio: monitor.largest_ratio,
        largest_lyapunov_ratio_at_s: monitor.largest_ratio_s,
        bound_broken_steps: monitor.bound_broken,
        outside_steps: monitor.outside,
        left_invariant_set_s: monitor.left_set_s,
        left_box_s: monitor.left_region_s,
        peak_output,
        peak_disturbance,
        peak_ratio: Some(ratio).filter(|ratio| ratio.is_finite()),
        from_rest_in_origin,
        gamma,
        guaranteed_gain,
        ultimate_level: claims.ultimate_level,
        output_bound: design.output_bound(),
        inner,
    }
}

impl CertificateOutcome {
    /// What is proved of the run.
    pub fn as_text(&self) -> String {
        match (self.proved, self.covers_run) {
            (true, true) => "proved; the proof covers this run".to_string(),
            (true, false) => format!(
                "proved; the proof does not cover this run: {}",
                self.not_covered.join("; ")
            ),
            (false, _) => "not proved".to_string(),
        }
    }

    /// The guaranteed gain and gamma; `None` where they are not proved.
    pub fn gains(&self) -> Option<[Claim; 2]> {
        let gains = self.guaranteed_gain.zip(self.gamma);
        gains.map(|(gain, gamma)| [gain, gamma].map(Claim::AtMost))
    }

    /// True when the proof covers the run and the run broke it.
    pub fn broken(&self) -> bool {
        let measured = match self.output_bound {
            OutputBound::Gain => self.peak_ratio.zip(self.guaranteed_gain),
            OutputBound::Peak(peak) => Some((self.peak_output, peak)),
            OutputBound::None => None,
        };
        let gain = self.from_rest_in_origin
            && measured.is_some_and(|(value, bound)| value > bound * (1.0 + ROUNDING));
        let inner = self.inner.as_ref().is_some_and(InnerOutcome::broken);
        inner || self.covers_run && (self.bound_broken_steps > 0 || self.outside_steps > 0 || gain)
    }

    /// Steps at which a claim of either certificate was broken.
    fn violations(&self) -> u64 {
        let inner = self
            .inner
            .as_ref()
            .map_or(0, |inner| inner.violations().max(u64::from(inner.late)));
        self.outside_steps.max(self.bound_broken_steps).max(inner)
    }
}

/// The inertia that was drawn, as text.
fn drawn_inertia(scenario: &Scenario) -> Option<String> {
    let System::RigidBody(system) = &scenario.system else {
        return None;
    };
    let inertia = system.body.inertia();
    system.inertia_is_drawn.then(|| {
        format!(
            "The inertia was drawn: {} {} {} / {} {} / {} kg m^2 (upper triangle, row by row).",
            inertia[(0, 0)],
            inertia[(0, 1)],
            inertia[(0, 2)],
            inertia[(1, 1)],
            inertia[(1, 2)],
            inertia[(2, 2)]
        )
    })
}

/// Judges the requirements and the proof.
pub(crate) fn conclude(scenario: &Scenario, summary: &mut Summary, end: End) {
    let diverged = matches!(end, End::Diverged { .. });
    let length_s = match end {
        End::Diverged { time_s } => time_s,
        _ => scenario.duration_s,
    };
    summary.triggers_per_s = summary.triggers as f64 / length_s.max(f64::MIN_POSITIVE);
    summary.notes.extend(drawn_inertia(scenario));
    let broken = summary
        .certificate
        .as_ref()
        .is_some_and(CertificateOutcome::broken);
    summary.judge(&scenario.requirements, diverged, broken);
}
