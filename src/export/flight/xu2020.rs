//! The law of a design: Xu and Huang 2020, (10) and (12).

use runtime::local_rules::FuzzySet;
use runtime::trigger::ThresholdUpdate;
use synth::fuzzy::{ExactSpacecraft, RuleModel};
use synth::model::Plant;

use super::law_text::list;
use super::source::{
    Constant, Measurement, Precision, Sending, Source, ATTITUDE, CLOSING, COMMON, INPUT, MARK,
    STEP, TORQUE,
};
use crate::export::c_text::prefix;
use crate::export::design::DesignData;
use crate::export::opening::opening;
use crate::export::quantity::Numbers;
use crate::run::design::{threshold_update, Design, NoLaw};

const FIELDS: &str = "    double command[@NAME@_INPUTS];
    double sent[@NAME@_STATES];
    double sent_form;
    double threshold;
    double time_s;
    uint8_t has_time;
    uint8_t has_sent;";

const LAW: &str = include_str!("templates/xu2020.c");
const STATE_OF_ATTITUDE: &str = include_str!("templates/state_of_attitude.c");
const STATE_GIVEN: &str = include_str!("templates/state_given.c");
const REGION_ANY: &str = include_str!("templates/membership_any.c");
const REGION_BOUNDS: &str = include_str!("templates/membership_bounds.c");
const REGION_BOX: &str = include_str!("templates/membership_box.c");
const WEIGHTS_ONE: &str = include_str!("templates/weights_one.c");
const WEIGHTS_BOX: &str = include_str!("templates/weights_box.c");
const WEIGHTS_RULES: &str = include_str!("templates/weights_rules.c");
const IN_MATLAB: &str = include_str!("templates/reference_xu2020.m");
const THRESHOLD_FIXED: &str = include_str!("templates/threshold_fixed.c");
const THRESHOLD_ADAPTIVE: &str = include_str!("templates/threshold_adaptive.c");

/// The C text of a design's controller.
///
/// # Errors
/// Gains that are no law.
pub fn source(design: &Design) -> Result<Source, NoLaw> {
    let gains = design.law_gains()?;
    let data = DesignData::of_design(design);
    let (states, inputs, _, _) = design.model.plant.sizes();
    let attitude = design.model.plant.inertia().is_some();
    let mut about = opening(&data, "flight code in C99");
    about.push(format!("format: {MARK}"));
    let mut out = Source {
        title: data.name.clone(),
        name: prefix(&data.name),
        proved: data.proved,
        about,
        sizes: [states, inputs],
        repeats: design.repeats(),
        interval_s: design.model.file.specs.hbar_s,
        precision: Precision::Double,
        sampling: format!(
            "At least one sample every {} s, lost ones included: what is proved holds for such samples, and later ones are \
             reported as late.",
            design.model.file.specs.hbar_s
        ),
        sending: Sending::AtTriggers,
        measurement: match attitude {
            true => Measurement::Attitude,
            false => Measurement::State,
        },
        command: if attitude { TORQUE } else { INPUT },
        fields: FIELDS,
        further: [""; 2],
        constants: numbers(design),
        counts: vec![("GAINS", gains)],
        macros: Vec::new(),
        parts: vec![COMMON],
        library: Vec::new(),
        words: states + inputs + 4,
        given_fault: false,
        in_matlab: Some(IN_MATLAB),
    };
    match attitude {
        true => out.parts.extend([ATTITUDE, STATE_OF_ATTITUDE]),
        false => out.parts.push(STATE_GIVEN),
    }
    memberships(design, gains, &mut out);
    threshold(&threshold_update(&design.model.file.specs), &mut out);
    out.parts.extend([LAW, STEP, CLOSING]);
    Ok(out)
}

/// A number or a list of them in the source.
fn listed<T: Numbers + ?Sized>(variable: &'static str, meaning: &str, numbers: &T) -> Constant {
    list(variable, "SI units of the design", meaning, numbers)
}

/// What every design has.
fn numbers(design: &Design) -> Vec<Constant> {
    let controller = &design.file.controller;
    let limits = design.law().1;
    vec![
        listed(
            "GAIN",
            "the gains F_j, one for each rule",
            &controller.gains,
        ),
        listed(
            "WEIGHT",
            "W of the trigger (Upsilon)",
            &controller.trigger_weight,
        ),
        listed(
            "FLOOR",
            "absolute part of the trigger, eps_a",
            &controller.trigger_floor,
        ),
        listed("LIMITS", "saturation of each input", &limits[..]),
        listed(
            "LONGEST_INTERVAL_S",
            "longest sampling interval (s)",
            &design.model.file.specs.hbar_s,
        ),
    ]
}

/// Where the proof holds, and how the gains are weighted.
fn memberships(design: &Design, gains: usize, out: &mut Source) {
    match &design.model.plant {
        Plant::Spacecraft(craft) => {
            out.constants.extend(of_box(craft));
            out.parts.push(REGION_BOX);
            out.parts
                .push(if gains == 1 { WEIGHTS_ONE } else { WEIGHTS_BOX });
        }
        Plant::Rules(rules) => {
            let bounds = rules.system.box_bounds.as_slice();
            out.constants
                .push(listed("BOUNDS", "the box in which the rules hold", bounds));
            out.parts.push(REGION_BOUNDS);
            match gains {
                1 => out.parts.push(WEIGHTS_ONE),
                _ => rule_weights(rules, gains, out),
            }
        }
        Plant::Vertices(_) => out.parts.extend([REGION_ANY, WEIGHTS_ONE]),
    }
}

/// The ends of the scheduling variables.
fn of_box(craft: &ExactSpacecraft) -> [Constant; 2] {
    let [w1, w2, w3] = craft.rate_bound.into();
    let unit = "the box: rates (rad/s) and scalar part";
    [
        listed("LOWER", unit, &[-w1, -w2, -w3, craft.scalar_part_min][..]),
        listed("UPPER", unit, &[w1, w2, w3, 1.0][..]),
    ]
}

fn rule_weights(rules: &RuleModel, gains: usize, out: &mut Source) {
    let coded = |set: &FuzzySet| match *set {
        FuzzySet::Any => vec![0.0; 5],
        FuzzySet::Triangular { left, peak, right } => vec![2.0, left, peak, peak, right],
        FuzzySet::Trapezoidal {
            left,
            left_top,
            right_top,
            right,
        } => vec![2.0, left, left_top, right_top, right],
        FuzzySet::Gaussian { centre, width } => vec![3.0, centre, width, 0.0, 0.0],
        FuzzySet::Never => vec![4.0, 0.0, 0.0, 0.0, 0.0],
    };
    let sets: Vec<Vec<Vec<f64>>> = rules
        .sets
        .iter()
        .map(|sets| sets.iter().map(coded).collect())
        .collect();
    let has_bells = rules.sets.iter().flatten();
    let has_bells = has_bells
        .into_iter()
        .any(|set| matches!(set, FuzzySet::Gaussian { .. }));
    out.constants.push(listed(
        "SETS",
        "fuzzy sets of each rule: kind, then four numbers",
        &sets,
    ));
    // As in the simulation, whose rules are padded to a power of two.
    let equal = 1.0 / gains.next_power_of_two() as f64;
    out.constants.push(listed(
        "EQUAL_WEIGHT",
        "the weight where no rule applies",
        &equal,
    ));
    out.macros.push(match has_bells {
        true => ("EXPONENTIAL(x)", "exp(x)"),
        false => ("EXPONENTIAL(x)", "1.0"),
    });
    out.library.extend(has_bells.then_some("exp"));
    out.parts.push(WEIGHTS_RULES);
}

/// How the threshold of the trigger moves.
fn threshold(update: &ThresholdUpdate, out: &mut Source) {
    out.constants.push(listed(
        "FIRST_THRESHOLD",
        "threshold before the first trigger",
        &update.initial(),
    ));
    let ThresholdUpdate::Clamped {
        adaptation,
        minimum,
        maximum,
    } = update
    else {
        out.parts.push(THRESHOLD_FIXED);
        return;
    };
    let amplitude = 2.0 * adaptation.amplitude / std::f64::consts::PI;
    out.constants.extend([
        listed("AMPLITUDE", "2 mu_1 / pi", &amplitude),
        listed("SLOPE", "mu_2", &adaptation.slope),
        listed("DEAD_BAND", "mu_3", &adaptation.dead_band),
        listed("LEAST_THRESHOLD", "nu_min", minimum),
        listed("LARGEST_THRESHOLD", "nu", maximum),
    ]);
    out.library.push("atan");
    out.parts.push(THRESHOLD_ADAPTIVE);
}
