//! The checked controller of Lei et al. 2022.

use nalgebra::{Matrix3, Vector3};
use runtime::lei2022::{
    Barrier, CompositeTrigger, ControlLaw, DisturbanceCompensation, Parameters,
    PerformanceFunction, TriggerRule, VirtualLaw,
};
use synth::model::{check_matrix, check_positive, check_positive_definite, ModelError};

use super::file::{CompositeTriggerFile, LeiFile, LeiTriggerFile, PerformanceFile};
use crate::base::ranges::{each, not_negative, require};
use crate::controllers::law::LawFile;
use crate::plants::rigid_body::RigidBodySystem;
use crate::sim::rigid_body_state::rigid_body_state;

impl LawFile for LeiFile {
    type Law = Parameters;

    fn check(&self, system: &RigidBodySystem) -> Result<Parameters, ModelError> {
        checked(self, system)
    }

    fn assume_inertia(&mut self, inertia_kg_m2: &[[f64; 3]; 3]) {
        self.inertia_kg_m2.get_or_insert(*inertia_kg_m2);
    }
}

/// Checks the controller's numbers, and that the start is inside of its funnel.
fn checked(file: &LeiFile, system: &RigidBodySystem) -> Result<Parameters, ModelError> {
    let law = ControlLaw {
        inertia: match &file.inertia_kg_m2 {
            Some(rows) => inertia(rows)?,
            None => *system.body.inertia(),
        },
        performance: performance(&file.performance)?,
        barrier: Barrier {
            gain_j: positive("barrier.gain_j", file.barrier.gain_j)?,
            width: positive("barrier.width", file.barrier.width)?,
        },
        virtual_law: VirtualLaw {
            gain: positive("virtual_law.gain", file.virtual_law.gain)?,
            rate_scale_rad_s: positive(
                "virtual_law.rate_scale_rad_s",
                file.virtual_law.rate_scale_rad_s,
            )?,
            slope: positive("virtual_law.slope", file.virtual_law.slope)?,
        },
        rate_gain: positive("rate_gain_nm_s_rad", file.rate_gain_nm_s_rad)?,
        disturbance: DisturbanceCompensation {
            bound_nm: file.disturbance.bound_nm,
            smoothing_rad_s: positive(
                "disturbance.smoothing_rad_s",
                file.disturbance.smoothing_rad_s,
            )?,
        },
    };
    not_negative("disturbance.bound_nm", file.disturbance.bound_nm)?;
    let trigger = match &file.trigger {
        LeiTriggerFile::Composite(rule) => {
            let rule = composite(rule).map_err(|error| error.within("trigger.composite"))?;
            TriggerRule::Composite(rule)
        }
        LeiTriggerFile::EverySample(_) => TriggerRule::EverySample,
    };
    each("torque_limit_nm", &file.torque_limit_nm, check_positive)?;
    let hysteresis = file.sign_hysteresis;
    let ok = (0.0..1.0).contains(&hysteresis);
    require(ok, "sign_hysteresis", hysteresis, "in [0, 1)")?;
    start_inside(&law.performance, system)?;
    Ok(Parameters {
        law,
        trigger,
        torque_limit: Vector3::from(file.torque_limit_nm),
        sign_hysteresis: hysteresis,
    })
}

fn positive(field: &str, value: f64) -> Result<f64, ModelError> {
    check_positive(field, value).map(|()| value)
}

/// A value strictly between zero and an upper bound that is itself a field of the file.
fn below(field: &str, value: f64, bound: (&str, f64)) -> Result<f64, ModelError> {
    let (name, limit) = bound;
    let allowed = format!("above 0 and below {name} = {limit}");
    require(value > 0.0 && value < limit, field, value, &allowed)?;
    Ok(value)
}

fn inertia(rows: &[[f64; 3]; 3]) -> Result<Matrix3<f64>, ModelError> {
    let field = "inertia_kg_m2";
    let lists: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
    let matrix = check_matrix(field, &lists, (Some(3), Some(3)))?;
    check_positive_definite(field, &matrix)?;
    Ok(Matrix3::from_fn(|r, c| rows[r][c]))
}

fn performance(file: &PerformanceFile) -> Result<PerformanceFunction, ModelError> {
    each("performance.initial", &file.initial, check_positive)?;
    for (axis, (&terminal, &initial)) in file.terminal.iter().zip(&file.initial).enumerate() {
        let bound = format!("initial[{axis}]");
        let field = format!("performance.terminal[{axis}]");
        below(&field, terminal, (&bound, initial))?;
    }
    not_negative("performance.midpoint_s", file.midpoint_s)?;
    Ok(PerformanceFunction {
        initial: Vector3::from(file.initial),
        terminal: Vector3::from(file.terminal),
        midpoint_s: file.midpoint_s,
        time_scale_s: positive("performance.time_scale_s", file.time_scale_s)?,
    })
}

fn composite(file: &CompositeTriggerFile) -> Result<CompositeTrigger, ModelError> {
    let initial = positive("envelope_initial_j", file.envelope_initial_j)?;
    let bound = ("envelope_initial_j", initial);
    let terminal = below("envelope_terminal_j", file.envelope_terminal_j, bound)?;
    let relative = file.relative_buffer;
    let ok = (0.0..1.0).contains(&relative);
    require(ok, "relative_buffer", relative, "in [0, 1)")?;
    let bound = if relative > 0.0 {
        "(1 - relative_buffer) envelope_terminal_j"
    } else {
        "envelope_terminal_j"
    };
    let room = (bound, (1.0 - relative) * terminal);
    Ok(CompositeTrigger {
        held_error_initial: positive("held_error_initial_n2m2", file.held_error_initial_n2m2)?,
        held_error_terminal: positive("held_error_terminal_n2m2", file.held_error_terminal_n2m2)?,
        longest_on_s: positive("longest_on_s", file.longest_on_s)?,
        envelope_initial_j: initial,
        envelope_terminal_j: terminal,
        decay_rate_per_s: positive("decay_rate_per_s", file.decay_rate_per_s)?,
        buffer_j: below("buffer_j", file.buffer_j, room)?,
        relative_buffer: relative,
    })
}

/// The funnel (4) must hold the error at the start.
fn start_inside(
    performance: &PerformanceFunction,
    system: &RigidBodySystem,
) -> Result<(), ModelError> {
    let state = rigid_body_state(&system.attitude, &system.rate_rad_s);
    let error = system.reference.error(0.0, &state).error.vector;
    let width = performance.value(0.0);
    for axis in 0..3 {
        let (rho, component) = (width[axis], error[axis].abs());
        let allowed = format!(
            "large enough to hold the start: rho is {rho:.6} at 0 s, and component {} of the error \
             quaternion's vector part is {component:.6}",
            axis + 1
        );
        let field = format!("performance.initial[{axis}]");
        let initial = performance.initial[axis];
        require(component < rho, &field, initial, &allowed)?;
    }
    Ok(())
}
