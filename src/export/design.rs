//! A design as a list of quantities, with its verdict checked again.

use runtime::local_rules::FuzzySet;
use synth::certify::{Report, Verdict};
use synth::design::CertificateFile;
use synth::fuzzy::{ExactSpacecraft, RuleModel, SPACECRAFT_VERTICES};
use synth::model::{Model, Plant};
use synth::problem::{Problem, ProblemDesignFile};

use super::quantity::Quantity;
use crate::base::provenance::{sha256_of, GENERATOR};
use crate::run::design::Design;

const PER_STATE: &str = "input per state";
const WEIGHT: &str = "1/state^2";
/// Of a weight in a bound of the rate of change of the functional.
const RATE_WEIGHT: &str = "1/(s state^2)";
const MIXED: &str = "mixed";
const GAIN: &str = "output per disturbance";

/// A design and what is to be said of it.
#[derive(Debug, Clone)]
pub struct DesignData {
    /// Its name.
    pub name: String,
    /// True when every condition is proved, checked from the numbers of the file.
    pub proved: bool,
    /// The control law and what the numbers mean, in sentences.
    pub law: Vec<String>,
    /// The conditions that are not proved, by name.
    pub failed: Vec<String>,
    /// What the proof assumes; none where nothing is proved.
    pub assumptions: Vec<String>,
    /// Keys and texts of the file's provenance, in order.
    pub provenance: Vec<(&'static str, String)>,
    /// The numbers: those of the law, and those of the proof where there is one.
    pub quantities: Vec<Quantity>,
}

impl DesignData {
    /// A design with the outcome of its check.
    pub fn of_design(design: &Design) -> Self {
        let made = &design.file.provenance;
        let mut data = Self::new(&design.file.name, &design.report, &design.sha256);
        data.law = law(design);
        data.provenance.extend([
            ("generator", made.generator.clone()),
            ("date", made.date.clone()),
            ("model_sha256", made.model_sha256.clone()),
            ("source", design.model.file.source.clone()),
        ]);
        if let Some(digest) = &made.gains_sha256 {
            data.provenance.push(("gains_sha256", digest.clone()));
        }
        data.quantities = law_quantities(design);
        // What is not proved claims nothing.
        if data.proved {
            data.quantities.extend(proof(design));
        }
        data
    }

    /// The design of a problem with its text and the outcome of its check.
    pub fn of_problem(
        file: &ProblemDesignFile,
        problem: &Problem,
        report: &Report,
        text: &str,
    ) -> Self {
        let mut data = Self::new(&file.name, report, &sha256_of(text));
        let meaning = format!("the guaranteed number: {}", problem.task.guarantee());
        data.law = vec!["u = F x, saturated where the problem says so.".to_string()];
        data.law.push(match data.proved {
            true => format!("Problem: {}; guarantee: {meaning}.", problem.task.name()),
            false => format!("Problem: {}.", problem.task.name()),
        });
        data.provenance.extend([
            ("generator", file.provenance.generator.clone()),
            ("date", file.provenance.date.clone()),
            ("model_sha256", file.provenance.model_sha256.clone()),
            ("source", problem.file.source.clone()),
            ("problem", problem.task.name().to_string()),
        ]);
        let proof = &file.certificate;
        let gain = &file.controller.gain;
        data.quantities = vec![Quantity::new("gain", PER_STATE, gain).means("the feedback F")];
        if !data.proved {
            return data;
        }
        data.quantities.extend([
            Quantity::new("lyapunov", WEIGHT, &proof.lyapunov).means("P of x'Px"),
            Quantity::new("guarantee", "1", &proof.guarantee).means(&meaning),
        ]);
        let further = proof.auxiliary.iter();
        data.quantities.extend(further.map(|(name, rows)| {
            Quantity::new(name, PER_STATE, rows).means("a further gain that the proof needs")
        }));
        data
    }

    fn new(name: &str, report: &Report, sha256: &str) -> Self {
        let failed = report.conditions.iter().filter(|one| one.margin < 0.0);
        let mut provenance = vec![
            ("exported_by", GENERATOR.to_string()),
            ("design_sha256", sha256.to_string()),
        ];
        if let Some(worst) = report.worst() {
            provenance.push(("worst_condition", worst.name.clone()));
            provenance.push(("smallest_margin", worst.margin.to_string()));
        }
        Self {
            name: name.to_string(),
            proved: report.verdict == Verdict::Proved,
            law: Vec::new(),
            failed: failed.map(|one| one.name.clone()).collect(),
            assumptions: match report.verdict {
                Verdict::Proved => report.not_covered.clone(),
                Verdict::NotProved => Vec::new(),
            },
            provenance,
            quantities: Vec::new(),
        }
    }

    /// The verdict in a word.
    pub fn verdict(&self) -> &'static str {
        match self.proved {
            true => "proved",
            false => "not_proved",
        }
    }

    /// Name, verdict, provenance and assumptions as pairs of key and text.
    pub fn about(&self) -> Vec<(String, String)> {
        let mut out = vec![
            ("name".to_string(), self.name.clone()),
            ("verdict".to_string(), self.verdict().to_string()),
        ];
        let provenance = self.provenance.iter();
        out.extend(provenance.map(|(key, text)| (key.to_string(), text.clone())));
        for (index, text) in self.assumptions.iter().enumerate() {
            out.push((format!("assumption_{}", index + 1), text.clone()));
        }
        out
    }
}

fn scheduled(design: &Design) -> bool {
    design.file.controller.gains.len() > 1
}

fn law(design: &Design) -> Vec<String> {
    let mut out = vec![
        "At the times t_k at which the state is sent: u = sat(F x(t_k)), held until the next message. \
         The state is sent when e' W e >= threshold x(t_k)' W x(t_k) + trigger_floor, with e = x - x(t_k) and W = \
         trigger_weight; nu is the largest threshold."
            .to_string(),
    ];
    if design.model.plant.inertia().is_some() {
        out.push(
            "State: body rate (rad/s, 3 entries), then the vector part of the error quaternion (3 \
             entries, scalar part not negative). Input: torque about the body axes (N m)."
                .to_string(),
        );
    }
    if !scheduled(design) {
        return out;
    }
    out.push(
        "F is the sum of the gains, each weighted by the membership of its rule at x(t_k)."
            .to_string(),
    );
    out.push(match &design.model.plant {
        Plant::Spacecraft(_) => {
            "Membership of rule j: the product over the scheduling variables (the three rates and the \
             scalar part q0, clamped to their interval) of (z - low) / (high - low) where rule_corners \
             has the upper end, and of 1 minus that where it has the lower end."
        }
        _ => {
            "Membership of rule j: the product of the grades of its fuzzy_sets over the states (clamped \
             to +-state_bounds), divided by the sum over all rules. A fuzzy set is its kind and four \
             numbers: 0 any (1 everywhere), 1 triangular (left, peak, right), 2 trapezoidal (left, \
             left_top, right_top, right), 3 Gaussian (centre, width), 4 never (0 everywhere)."
        }
    }
    .to_string());
    out
}

/// What the flight code needs.
fn law_quantities(design: &Design) -> Vec<Quantity> {
    let (controller, specs) = (&design.file.controller, &design.model.file.specs);
    let limit = design.model.plant.takagi_sugeno().input_limit;
    let (per_state, limit_name, limit_unit) = match design.model.plant.inertia() {
        Some(_) => (
            "N m per rad/s (columns 1 to 3), N m (columns 4 to 6)",
            "torque_limit_nm",
            "N m",
        ),
        None => (PER_STATE, "input_limit", "input"),
    };
    let mut out = vec![
        Quantity::new("gains", per_state, &controller.gains)
            .means("the gains F_j, one for each rule"),
        Quantity::new("trigger_floor", "1/s", &controller.trigger_floor)
            .means("eps_a: send when e'We >= nu w'Ww + eps_a"),
        Quantity::new("trigger_weight", RATE_WEIGHT, &controller.trigger_weight)
            .means("W of the trigger (Upsilon)"),
        Quantity::new(limit_name, limit_unit, limit.as_slice())
            .means("saturation level of each input"),
        Quantity::new("hbar_s", "s", &specs.hbar_s).means("longest sampling interval"),
        Quantity::new("nu", "1", &specs.nu).means("largest trigger threshold"),
    ];
    let shortest = design.model.sampling_interval_min();
    out.extend(shortest.map(|shortest| {
        Quantity::new("hmin_s", "s", &shortest).means("shortest sampling interval")
    }));
    if let Some(update) = &specs.threshold_update {
        let least = specs.nu_min.unwrap_or(specs.nu);
        out.extend([
            Quantity::new("nu_min", "1", &least).means("smallest trigger threshold"),
            Quantity::new("threshold_mu", "1", &update.mu[..])
                .means("amplitude, slope and dead band of the threshold's update"),
        ]);
    }
    if scheduled(design) {
        match &design.model.plant {
            Plant::Spacecraft(craft) => out.push(corners(craft)),
            Plant::Rules(rules) => out.extend(fuzzy_sets(rules)),
            Plant::Vertices(_) => {}
        }
    }
    out
}

/// The scheduling variables at which each rule of the exact model counts alone.
fn corners(craft: &ExactSpacecraft) -> Quantity {
    let corner = |rule: usize| craft.corner(rule).iter().copied().collect();
    let rows: Vec<Vec<f64>> = (0..SPACECRAFT_VERTICES).map(corner).collect();
    let unit = "rad/s (columns 1 to 3), 1 (column 4)";
    Quantity::new("rule_corners", unit, &rows)
        .means("rates 1 to 3 and scalar part q0 at the corner of each rule")
}

/// The fuzzy sets of every rule (row) over every state (column of the matrix of a rule).
fn fuzzy_sets(rules: &RuleModel) -> [Quantity; 2] {
    let coded = |set: &FuzzySet| match *set {
        FuzzySet::Any => vec![0.0; 5],
        FuzzySet::Triangular { left, peak, right } => vec![1.0, left, peak, right, 0.0],
        FuzzySet::Trapezoidal {
            left,
            left_top,
            right_top,
            right,
        } => vec![2.0, left, left_top, right_top, right],
        FuzzySet::Gaussian { centre, width } => vec![3.0, centre, width, 0.0, 0.0],
        FuzzySet::Never => vec![4.0, 0.0, 0.0, 0.0, 0.0],
    };
    let sets = rules.sets.iter();
    let sets = sets.map(|sets| sets.iter().map(coded).collect());
    let sets: Vec<Vec<Vec<f64>>> = sets.collect();
    let bounds = rules.system.box_bounds.as_slice();
    let unit = "kind, then four numbers in the unit of the state";
    [
        Quantity::new("state_bounds", "state", bounds).means("the box in which the rules hold"),
        Quantity::new("fuzzy_sets", unit, &sets)
            .means("fuzzy sets: a matrix for each rule, a row for each state"),
    ]
}

/// What only the proof needs.
fn proof(design: &Design) -> Vec<Quantity> {
    let model: &Model = &design.model;
    let specs = &model.file.specs;
    let (bound, unit) = match model.plant.inertia().is_some() {
        true => ("disturbance_bound_nm", "N m"),
        false => ("disturbance_bound", "disturbance"),
    };
    let most = model.plant.takagi_sugeno().disturbance_bound;
    let mut out = certificate(&design.file.certificate);
    out.extend([
        Quantity::new("phi_per_s", "1/s", &specs.phi_per_s).means("decay rate"),
        Quantity::new(bound, unit, &most).means("bound on the norm of the disturbance"),
    ]);
    if let (Some(outer), Some(specs)) = (&design.file.outer, &specs.outer) {
        out.extend([
            Quantity::new("outer_trigger_multiple", "1", &outer.trigger_multiple)
                .means("the outer functional uses this multiple of trigger_weight"),
            Quantity::new("outer_phi_per_s", "1/s", &specs.phi_per_s)
                .means("decay rate of the outer functional"),
        ]);
        let outer = certificate(&outer.certificate).into_iter();
        out.extend(outer.map(|quantity| Quantity {
            name: format!("outer_{}", quantity.name),
            meaning: format!("outer certificate: {}", quantity.meaning),
            ..quantity
        }));
    }
    out
}

/// The unknowns of one certificate.
fn certificate(proof: &CertificateFile) -> Vec<Quantity> {
    let mut out = vec![
        Quantity::new("lyapunov", WEIGHT, &proof.lyapunov)
            .means("U: x'Ux <= 1 is the certified set"),
        Quantity::new("integral_weight", WEIGHT, &proof.integral_weight)
            .means("Y of the integral of V2"),
        Quantity::new("multiplier", MIXED, &proof.multiplier)
            .means("multiplier of the plant's equation"),
        Quantity::new("free_state", RATE_WEIGHT, &proof.free_state).means("L1"),
        Quantity::new("free_sample", RATE_WEIGHT, &proof.free_sample).means("L2"),
        Quantity::new("anti_windup", PER_STATE, &proof.anti_windup).means("N_j, one for each rule"),
        Quantity::new("sector_weight", MIXED, &proof.sector_weight).means("the diagonal of M"),
        Quantity::new("xi", MIXED, &proof.xi)
            .means("weight of the disturbance: V' <= -phi V + xi |tau|^2"),
        Quantity::new("gamma", GAIN, &proof.gamma).means("bound on sup|y| / sup|tau| from rest"),
        Quantity::new("guaranteed_gain", GAIN, &proof.guaranteed_gain)
            .means("the sharper bound on sup|y| / sup|tau| from rest"),
    ];
    if let Some(bounds) = &proof.final_bounds {
        out.extend([
            Quantity::new("final_rate_rad_s", "rad/s", &bounds.rate_rad_s)
                .means("bound on the norm of the rate from rest and in the end"),
            Quantity::new("final_vector_part", "1", &bounds.vector_part)
                .means("bound on |q| from rest and in the end"),
        ]);
    }
    out.extend(proof.certified_vector_part.map(|radius| {
        Quantity::new("certified_vector_part", "1", &radius)
            .means("every attitude at rest with |q| up to this is a certified start")
    }));
    for (index, side) in proof.mismatch.iter().enumerate() {
        let (bounds, common) = ("mismatch_bounds", "mismatch_common");
        let name = |what| format!("{what}_{}", index + 1);
        out.extend([
            Quantity::new(&name(bounds), MIXED, &side.bounds)
                .means("slack of the mismatch of the memberships, one for each rule"),
            Quantity::new(&name(common), MIXED, &side.common)
                .means("what these slacks have in common"),
        ]);
    }
    out
}
