//! What a proof takes for granted, in words.

use super::Certificate;
use crate::claim::Claim;
use crate::fuzzy::{ExactSpacecraft, RuleModel};
use crate::model::{Imperfections, Mismatch, Model, MomentumBound, Plant};

/// What the proof of a certificate takes for granted, one line each.
pub(super) fn not_covered(model: &Model, certificate: &Certificate) -> Vec<String> {
    let specs = &model.file.specs;
    let imperfections = &model.file.imperfections;
    let mut out = vec![
        measurement_assumed(imperfections),
        network_assumed(imperfections),
        gap_assumed(imperfections, specs.hbar_s),
        "a first sample at the start, t = 0, that is sent".to_string(),
        format!(
            "a trigger threshold that never exceeds {} (clamped at run time)",
            specs.nu
        ),
    ];
    if let Some(shortest) = model.sampling_interval_min() {
        out.push(format!(
            "no two samples closer than {shortest} s, for the number of messages only"
        ));
    }
    if let (Mismatch::Kappa(kappa), true) = (model.file.mismatch, certificate.is_matched(model)) {
        out.push(format!(
            "memberships at the last sent state that differ from the present ones by at most kappa = \
             {kappa} in each rule"
        ));
    }
    match &model.plant {
        Plant::Rules(rules) => rules_not_covered(rules, &mut out),
        Plant::Spacecraft(craft) => {
            out.push(inertia_assumed(model, craft));
            out.push("a scalar part q0 that starts positive".to_string());
            actuators_assumed(imperfections, &mut out);
            out.push(format!(
                "a disturbance torque whose norm stays within {} N m",
                craft.disturbance_bound
            ));
        }
        Plant::Vertices(system) => {
            out.push("a plant inside the convex hull of the vertex systems".to_string());
            out.push(format!(
                "a disturbance whose norm stays within {}",
                system.disturbance_bound
            ));
        }
    }
    out
}

/// The measurement.
fn measurement_assumed(imperfections: &Imperfections) -> String {
    let Some(bounds) = imperfections.measurement_error() else {
        return "the state is measured without error".to_string();
    };
    match &bounds.state {
        Some(state) => format!("a measurement error of each state within {state:?}"),
        None => format!(
            "a measured rate within {} rad/s and a measured attitude within {} deg of the true ones",
            bounds.rate_rad_s.unwrap_or(0.0),
            bounds.attitude_deg.unwrap_or(0.0)
        ),
    }
}

/// The way from a sample to the actuators.
fn network_assumed(imperfections: &Imperfections) -> String {
    if !imperfections.is_networked() {
        return "no delay between sample, trigger, controller and actuator".to_string();
    }
    let delay = imperfections.delay_s;
    match imperfections.lost_in_a_row {
        0 => format!("every message acts within {delay} s of its sample"),
        lost => format!(
            "every value is transmitted at its sample and at the {lost} that follow; at most {lost} transmissions in a \
             row are lost, and the others act within {delay} s of their sample"
        ),
    }
}

/// The time between samples.
fn gap_assumed(imperfections: &Imperfections, hbar_s: f64) -> String {
    match imperfections.lost_in_a_row {
        0 => format!("no gap between samples longer than {hbar_s} s, dropouts included"),
        _ => format!("no gap between samples longer than {hbar_s} s"),
    }
}

/// Torques, wheels and reference of a spacecraft.
fn actuators_assumed(imperfections: &Imperfections, out: &mut Vec<String>) {
    match &imperfections.effectiveness {
        None => out.push("torques applied as commanded, within their limits".to_string()),
        Some(effectiveness) => {
            let [one, two, three] = [0, 1, 2].map(|input| effectiveness.of(input));
            out.push(format!(
                "an applied torque within {one:?}, {two:?} and {three:?} times the commanded one on the three axes"
            ));
        }
    }
    if imperfections.misalignment > 0.0 {
        let bound = imperfections.misalignment;
        out.push(format!(
            "no more than {bound} of one axis's torque on another"
        ));
    }
    match imperfections.wheel_momentum_nms {
        None => out.push("no angular momentum in wheels".to_string()),
        Some(MomentumBound::Norm(bound)) => {
            out.push(format!(
                "an angular momentum of the wheels within {bound} N m s"
            ));
        }
        Some(MomentumBound::PerAxis([x, y, z])) => out.push(format!(
            "an angular momentum of the wheels within {x}, {y} and {z} N m s on the three axes"
        )),
    }
    match &imperfections.reference {
        None => out.push("a reference attitude that does not move".to_string()),
        Some(motion) => out.push(format!(
            "a reference whose rate stays within {} rad/s and whose acceleration within {} rad/s^2",
            motion.rate_rad_s, motion.acceleration_rad_s2
        )),
    }
    if imperfections.torque_quantum_nm > 0.0 {
        let step = imperfections.torque_quantum_nm;
        out.push(format!(
            "torques rounded to the nearest multiple of {step} N m"
        ));
    }
}

fn inertia_assumed(model: &Model, craft: &ExactSpacecraft) -> String {
    if !model.plant.has_uncertain_inertia() {
        return "an inertia equal to the model's, and a rigid body".to_string();
    }
    let set = &craft.inertia_uncertainty;
    let amount = match set.off_diagonal_amount {
        0.0 => String::new(),
        amount => format!(" + {amount} kg m^2"),
    };
    format!(
        "a constant inertia, each diagonal entry within {} % and each off-diagonal entry within {} %{amount} of \
         the model's, and a rigid body",
        set.diagonal_percent, set.off_diagonal_percent
    )
}

fn rules_not_covered(rules: &RuleModel, out: &mut Vec<String>) {
    out.push("a plant that is the blend of the local rules, not what they interpolate".to_string());
    if let Some(error) = rules.worst_model_error() {
        out.push(format!(
            "no difference between the blend and the rigid spacecraft; over the box it reaches at least \
             {:.4} N m in torque and {:.4} 1/s in q'",
            Claim::AtLeast(error.torque_nm),
            Claim::AtLeast(error.attitude_rate_per_s)
        ));
    }
    out.push(format!(
        "a disturbance whose norm stays within {}",
        rules.system.disturbance_bound
    ));
}
