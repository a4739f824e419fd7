//! Units for one certificate: each state relative to its box, time relative to the closed loop's bandwidth, commands
//! relative to the limit. They are powers of two, so that changing them adds no error.

use nalgebra::{DMatrix, DVector, Vector4};

use crate::certify::held_command::{HeldCommandCertificate, HeldCommandLaw};
use crate::certify::FinalBounds;
use crate::conditions::held_command::{HeldCommandTask, HeldCommandUnknowns};
use crate::conditions::units::power_of_two;
use crate::design::descriptor_multiplier;
use crate::fuzzy::{ExactSpacecraft, TakagiSugeno};
use crate::model::{Model, Plant};
use sdp::lmi::Affine;

/// The units of a certificate.
#[derive(Debug, Clone)]
pub(super) struct CommandUnits {
    /// Unit of each state.
    pub state: DVector<f64>,
    /// Unit of time (s).
    time: f64,
    /// Unit of every command [N m].
    command: f64,
    /// Unit of the disturbance [N m].
    disturbance: f64,
    /// Unit of the annihilator's rate [rad/s].
    rate: f64,
}

/// Shares of a certificate that the model gives or that were chosen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shares {
    /// theta.
    pub within_limit: f64,
    /// Largest r / phi.
    pub final_level: f64,
}

/// A certificate to be found, in units of its own.
pub(super) struct ScaledTask {
    pub task: HeldCommandTask,
    pub units: CommandUnits,
}

impl ScaledTask {
    /// The task of a spacecraft's model.
    pub fn new(
        model: &Model,
        craft: &ExactSpacecraft,
        law: &HeldCommandLaw,
        shares: Shares,
    ) -> Self {
        let system = model.plant.takagi_sugeno();
        let specs = &model.file.specs;
        let units = CommandUnits::of(&system, law, specs.phi_per_s * shares.final_level);
        let task = HeldCommandTask {
            system: units.system(&system),
            annihilators: units.annihilators(craft),
            gain: &law.gain * units.to_state() / units.command,
            relative: law.trigger.relative,
            absolute: law.trigger.absolute_nm / units.command,
            decay_rate: specs.phi_per_s * units.time,
            sampling_interval_max: specs.hbar_s / units.time,
            within_limit: shares.within_limit,
            final_level: shares.final_level,
        };
        ScaledTask { task, units }
    }

    /// U of a certificate in SI units, in these.
    pub fn lyapunov_from(&self, lyapunov: &DMatrix<f64>) -> DMatrix<f64> {
        let to_state = self.units.to_state();
        &to_state * lyapunov * &to_state
    }

    /// A solver's values as numbers of a certificate in SI units; its claims are left at 0.
    pub fn recover(
        &self,
        plant: &Plant,
        own: &HeldCommandUnknowns,
        values: &[f64],
    ) -> HeldCommandCertificate {
        let CommandUnits {
            time,
            command,
            disturbance,
            rate,
            ..
        } = self.units;
        let from_state = self.units.to_state().map_diagonal(|unit| 1.0 / unit);
        let from_state = DMatrix::from_diagonal(&from_state);
        let square = |matrix: &DMatrix<f64>| &from_state * matrix * &from_state;
        let at = |unknown: &Affine| unknown.value(values);
        let number = |unknown: &Affine| unknown.value(values)[(0, 0)];
        let symmetric = |unknown: &Affine| {
            let full = square(&at(unknown));
            0.5 * (&full + full.transpose())
        };
        let hbar = self.task.sampling_interval_max;
        let free_sample = -at(&own.free_change) / (hbar * hbar);
        let free_state = at(&own.free_state) / hbar - &free_sample;
        let input = command * command * time;
        let sector = own.sector_weight.as_ref();
        HeldCommandCertificate {
            within_limit: self.task.within_limit,
            lyapunov: symmetric(&own.lyapunov),
            integral_weight: symmetric(&own.integral_weight) / hbar,
            state_multiplier: descriptor_multiplier(plant, square(&at(&own.state_multiplier))),
            rate_multiplier: descriptor_multiplier(plant, square(&at(&own.rate_multiplier)) * time),
            free_state: square(&free_state) / time,
            free_sample: square(&free_sample) / time,
            annihilator_state: &from_state * at(&own.annihilator_state) / (rate * time),
            annihilator_rate: &from_state * at(&own.annihilator_rate) / rate,
            sector_weight: sector.map_or(DVector::zeros(0), |weight| at(weight).diagonal() / input),
            command_weight: number(&own.command_weight) / input,
            command_split: number(&own.relative_weight) / number(&own.command_weight),
            disturbance_weight: number(&own.disturbance_weight)
                / (disturbance * disturbance * time),
            certified_vector_part: 0.0,
            final_bounds: FinalBounds {
                rate: 0.0,
                vector_part: 0.0,
            },
        }
    }
}

impl CommandUnits {
    fn of(system: &TakagiSugeno, law: &HeldCommandLaw, supply: f64) -> Self {
        let extent = |state: usize| power_of_two(system.extent(state).unwrap_or(1.0));
        let time = power_of_two(1.0 / bandwidth(system, law));
        let bound = system.disturbance_bound;
        CommandUnits {
            state: DVector::from_fn(system.states(), |state, _| extent(state)),
            time,
            command: power_of_two(system.input_limit.min()),
            // With xi about 1 the disturbance is the whole supply.
            disturbance: match bound > 0.0 {
                true => power_of_two(bound / (supply * time).sqrt()),
                false => 1.0,
            },
            rate: extent(0).max(extent(1)).max(extent(2)),
        }
    }

    /// x = T z.
    fn to_state(&self) -> DMatrix<f64> {
        DMatrix::from_diagonal(&self.state)
    }

    fn system(&self, system: &TakagiSugeno) -> TakagiSugeno {
        let to_state = self.to_state();
        let from_state = DMatrix::from_diagonal(&self.state.map(|unit| 1.0 / unit));
        let rows = |matrix: &DMatrix<f64>, unit: f64| &from_state * matrix * (unit * self.time);
        let mut out = system.clone();
        for vertex in &mut out.vertices {
            *vertex = rows(&(&*vertex * &to_state), 1.0);
        }
        out.input = rows(&system.input, self.command);
        out.disturbance = rows(&system.disturbance, self.disturbance);
        out.output = &system.output * &to_state;
        out.input_limit = &system.input_limit / self.command;
        out.disturbance_bound = system.disturbance_bound / self.disturbance;
        for bound in &mut out.region {
            bound.rows = &bound.rows * &to_state;
        }
        out
    }

    /// [omega^x, 0] T over the unit of rates.
    fn annihilators(&self, craft: &ExactSpacecraft) -> Vec<DMatrix<f64>> {
        let scaled = |corner: Vector4<f64>| {
            let spin = corner.fixed_rows::<3>(0).cross_matrix();
            let mut out = DMatrix::zeros(3, 6);
            out.view_mut((0, 0), (3, 3)).copy_from(&spin);
            out * self.to_state() / self.rate
        };
        craft.corners().into_iter().map(scaled).collect()
    }
}

/// Geometric mean of the closed loop's poles, in magnitude, at the mean of the vertices [1/s].
fn bandwidth(system: &TakagiSugeno, law: &HeldCommandLaw) -> f64 {
    let count = system.vertices.len() as f64;
    let sum: DMatrix<f64> = system.vertices.iter().sum();
    let closed = sum / count + &system.input * &law.gain;
    let mean = closed
        .determinant()
        .abs()
        .powf(1.0 / system.states() as f64);
    match mean.is_normal() {
        true => mean,
        false => 1.0,
    }
}
