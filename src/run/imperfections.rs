//! The imperfections of a run beside those that the design's proof allows, one by one.

use synth::claim::Claim;
use synth::model::{Imperfections, MeasurementBounds, MomentumBound};

use super::design::Design;
use crate::plants::{RigidBodySystem, System};
use crate::scenario::Scenario;
use crate::sim::actuator::{ActuatorData, AnyEffect};
use crate::sim::network::NetworkOutcome;
use crate::sim::reference::Reference;

/// What a run had.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Flown {
    /// The largest errors of the sensor: see [`crate::sim::sensor::Sensor::largest_errors`].
    pub measurement: Vec<f64>,
    /// What the network did, where there was one.
    pub network: Option<NetworkOutcome>,
    /// The largest norm and components of the wheels' momentum, N m s, where there were wheels.
    pub momentum: Option<[f64; 4]>,
}

/// What of the imperfections the proof covers and what not, in sentences with the numbers of both.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Coverage {
    /// What it covers.
    pub covered: Vec<String>,
    /// What it does not cover.
    pub not_covered: Vec<String>,
}

/// Room for the rounding of measured errors: relative, and absolute for those of small angles.
const ROUNDING: [f64; 2] = [1e-9, 1e-14];

impl Coverage {
    /// Notes a number of the run, in `unit`, and the bound that was proved. Says nothing when neither differs from 0.
    fn compare(&mut self, name: &str, run: f64, proved: f64, unit: &str) {
        if run == 0.0 && proved == 0.0 {
            return;
        }
        let [relative, absolute] = ROUNDING;
        let inside = run <= proved * (1.0 + relative) + absolute;
        let unit = if unit.is_empty() {
            String::new()
        } else {
            format!(" {unit}")
        };
        // Within the room for rounding a number is on its bound, not beyond it.
        let run = Claim::AtMost(if inside { run.min(proved) } else { run });
        let text = match proved == 0.0 {
            true => format!("{name}: {run}{unit}; the proof is for none"),
            false => format!("{name}: {run}{unit}; proved for up to {proved}{unit}"),
        };
        match inside {
            true => self.covered.push(text),
            false => self.not_covered.push(text),
        }
    }

    /// Notes the gains of a run between which an entry lies, and those that were proved.
    fn compare_range(&mut self, name: &str, run: [f64; 2], proved: [f64; 2]) {
        if run == [1.0; 2] && proved == [1.0; 2] {
            return;
        }
        let [relative, _] = ROUNDING;
        let inside =
            run[0] >= proved[0] * (1.0 - relative) && run[1] <= proved[1] * (1.0 + relative);
        let [low, high] = run;
        let text = format!(
            "{name}: {} to {}; proved for {} to {}",
            Claim::AtLeast(low),
            Claim::AtMost(high),
            proved[0],
            proved[1]
        );
        match inside {
            true => self.covered.push(text),
            false => self.not_covered.push(text),
        }
    }
}

/// Compares what a run had with what the design's model allows.
pub(crate) fn compare(design: &Design, scenario: &Scenario, flown: &Flown) -> Coverage {
    let proved = &design.model.file.imperfections;
    let mut out = Coverage::default();
    let spacecraft = matches!(scenario.system, System::RigidBody(_));
    measurement(
        proved.measurement.as_ref(),
        &flown.measurement,
        spacecraft,
        &mut out,
    );
    network(proved, scenario, flown.network.as_ref(), &mut out);
    match &scenario.system {
        System::RigidBody(body) => {
            gains(proved, &body.actuators, 3, &mut out);
            spacecraft_only(proved, scenario, body, flown.momentum, &mut out);
        }
        System::TakagiSugeno(model) => {
            let inputs = model.system.input_matrix.ncols();
            let actuators = ActuatorData {
                gain_error: model.gain_error,
                ..ActuatorData::ideal()
            };
            gains(proved, &actuators, inputs, &mut out);
        }
    }
    out
}

fn measurement(
    proved: Option<&MeasurementBounds>,
    largest: &[f64],
    spacecraft: bool,
    out: &mut Coverage,
) {
    let of = |index: usize| largest.get(index).copied().unwrap_or(0.0);
    if spacecraft {
        let bound = |of: fn(&MeasurementBounds) -> Option<f64>| proved.and_then(of).unwrap_or(0.0);
        let rate = bound(|bounds| bounds.rate_rad_s);
        let angle = bound(|bounds| bounds.attitude_deg);
        out.compare("error of the measured rate", of(0), rate, "rad/s");
        out.compare(
            "error of the measured attitude",
            of(1).to_degrees(),
            angle,
            "deg",
        );
        return;
    }
    let bounds = proved.and_then(|bounds| bounds.state.as_deref());
    let count = bounds.map_or(0, <[f64]>::len).max(largest.len());
    for state in 0..count {
        let bound = bounds.and_then(|bounds| bounds.get(state)).copied();
        let name = format!("error of the measured state {}", state + 1);
        out.compare(&name, of(state), bound.unwrap_or(0.0), "");
    }
}

fn network(
    proved: &Imperfections,
    scenario: &Scenario,
    network: Option<&NetworkOutcome>,
    out: &mut Coverage,
) {
    let dead_time = match &scenario.system {
        System::RigidBody(body) => body.actuators.delay_s,
        System::TakagiSugeno(model) => model.input_delay_s,
    };
    let delay = network.map_or(0.0, |network| network.longest_delay_s) + dead_time;
    out.compare("delay from sample to torque", delay, proved.delay_s, "s");
    let lost = network.map_or(0, |network| network.longest_loss);
    let allowed = proved.lost_in_a_row;
    out.compare(
        "messages lost in a row",
        f64::from(lost),
        f64::from(allowed),
        "",
    );
    if let Some(repeats) = network
        .map(|network| network.repeats)
        .filter(|&count| count < allowed)
    {
        out.not_covered.push(format!(
            "a value is sent again at {repeats} following samples; the proof is for {allowed}"
        ));
    }
}

fn gains<const M: usize>(
    proved: &Imperfections,
    actuators: &ActuatorData<M>,
    inputs: usize,
    out: &mut Coverage,
) {
    let mut misalignment = actuators.gain_error.map_or(0.0, |gain| gain.misalignment);
    for input in 0..inputs {
        let [mut low, mut high] = actuators
            .gain_error
            .map_or([1.0; 2], |gain| gain.range[input]);
        for AnyEffect::Fault(fault) in &actuators.effects {
            if fault.axis == input {
                low *= fault.effectiveness.min(1.0);
                high *= fault.effectiveness.max(1.0);
            }
        }
        let own = actuators.matrix[(input, input)];
        let ends = [low * own, high * own];
        let range = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let name = format!("effectiveness of input {}", input + 1);
        out.compare_range(&name, range, proved.effectiveness_of(input));
        let others = (0..inputs).filter(|&row| row != input);
        let largest = others.map(|row| actuators.matrix[(row, input)].abs());
        misalignment = largest.fold(misalignment, f64::max);
    }
    out.compare(
        "misalignment of the actuators",
        misalignment,
        proved.misalignment,
        "",
    );
}

fn spacecraft_only(
    proved: &Imperfections,
    scenario: &Scenario,
    body: &RigidBodySystem,
    momentum: Option<[f64; 4]>,
    out: &mut Coverage,
) {
    let [norm, axes @ ..] = momentum.unwrap_or([0.0; 4]);
    match proved.wheel_momentum_nms {
        Some(MomentumBound::PerAxis(bounds)) => {
            for (axis, (run, bound)) in axes.into_iter().zip(bounds).enumerate() {
                let name = format!("momentum of the wheels about axis {}", axis + 1);
                out.compare(&name, run, bound, "N m s");
            }
        }
        Some(MomentumBound::Norm(bound)) => {
            out.compare("momentum of the wheels", norm, bound, "N m s");
        }
        None => out.compare("momentum of the wheels", norm, 0.0, "N m s"),
    }
    let quantum = body.actuators.quantum;
    out.compare(
        "rounding of the torque to steps of",
        quantum,
        proved.torque_quantum_nm,
        "N m",
    );
    let allowed = proved.reference.unwrap_or_default();
    let [rate, acceleration] = motion(&body.reference, scenario.duration_s);
    out.compare("rate of the reference", rate, allowed.rate_rad_s, "rad/s");
    let (name, bound) = ("acceleration of the reference", allowed.acceleration_rad_s2);
    match acceleration.is_finite() {
        true => out.compare(name, acceleration, bound, "rad/s^2"),
        false => out
            .not_covered
            .push("the rate of the reference jumps".to_string()),
    }
}

/// The largest rate (rad/s) and angular acceleration (rad/s^2) of a reference in a run; infinite where the rate jumps.
fn motion(reference: &Reference, duration_s: f64) -> [f64; 2] {
    match *reference {
        Reference::Fixed(_) => [0.0; 2],
        Reference::Slew {
            rate_rad_s,
            from_s,
            until_s,
            ..
        } => {
            let jumps = from_s > 0.0 || until_s < duration_s;
            [
                rate_rad_s.abs(),
                if jumps && rate_rad_s != 0.0 {
                    f64::INFINITY
                } else {
                    0.0
                },
            ]
        }
        Reference::Sine {
            amplitude_rad,
            frequency_rad_s,
            ..
        } => {
            let rate = (amplitude_rad * frequency_rad_s).abs();
            [rate, rate * frequency_rad_s.abs()]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_within_its_bound_is_covered_and_one_beyond_it_is_not() {
        let mut out = Coverage::default();
        out.compare("delay", 0.02, 0.02, "s");
        out.compare("misalignment", 0.03, 0.02, "");
        out.compare("momentum", 1.0, 0.0, "N m s");
        out.compare("nothing", 0.0, 0.0, "s");
        assert_eq!(out.covered, ["delay: 0.02 s; proved for up to 0.02 s"]);
        let expected = [
            "misalignment: 0.03; proved for up to 0.02",
            "momentum: 1 N m s; the proof is for none",
        ];
        assert_eq!(out.not_covered, expected);
    }

    #[test]
    fn a_slew_is_smooth_only_where_it_lasts_for_the_whole_run() {
        let slew = |from_s, until_s| Reference::Slew {
            start: runtime::attitude::Quaternion::identity(),
            axis: nalgebra::Vector3::x(),
            rate_rad_s: -0.001,
            from_s,
            until_s,
        };
        assert_eq!(motion(&slew(0.0, 100.0), 100.0), [0.001, 0.0]);
        assert_eq!(motion(&slew(1.0, 100.0), 100.0), [0.001, f64::INFINITY]);
        assert_eq!(motion(&slew(0.0, 99.0), 100.0), [0.001, f64::INFINITY]);
    }
}
