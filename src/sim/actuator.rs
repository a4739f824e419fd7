//! Actuators: from the command to the torque that acts, with delay, dead band, saturation and faults.

use std::collections::VecDeque;

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::ModelError;

use super::effect::{Effect, Fault};
use super::gain_error::{GainError, GainErrorFile, GainKind};
use super::random::{Purpose, Random};
use crate::base::bounded::{As, Finite, NonNegative, Positive};

/// Makes the list of effects from the types that implement [`Effect`].
macro_rules! effects {
    ($($(#[doc = $doc:literal])+ $name:ident;)+) => {
        /// The effects.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum AnyEffect {
            $($(#[doc = $doc])+ $name($name),)+
        }

        impl<const M: usize> Effect<M> for AnyEffect {
            fn change(&mut self, time_s: f64, torque: &mut SVector<f64, M>) {
                match self {
                    $(AnyEffect::$name(effect) => effect.change(time_s, torque),)+
                }
            }

            fn acted(&mut self, span_s: f64, torque: &SVector<f64, M>) {
                match self {
                    $(AnyEffect::$name(effect) => effect.acted(span_s, torque),)+
                }
            }

            fn discontinuities_s(&self) -> Vec<f64> {
                match self {
                    $(AnyEffect::$name(effect) => Effect::<M>::discontinuities_s(effect),)+
                }
            }
        }
    };
}

effects! {
    /// A fault of one axis.
    Fault;
}

/// Limits of the actuators.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ActuatorsFile {
    /// Largest torque of each axis, above 0; no limit but the controller's when left out [N m].
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        with = "As::<Option<[Positive; 3]>>"
    )]
    pub torque_limit_nm: Option<[f64; 3]>,
    /// Commands below this magnitude give no torque, not negative [N m].
    #[serde(default, with = "As::<[NonNegative; 3]>")]
    pub dead_band_nm: [f64; 3],
    /// Time from command to torque, not negative (s).
    #[serde(default, with = "As::<NonNegative>")]
    pub delay_s: f64,
    /// Torque about each body axis (rows) per unit torque of each actuator (columns); the identity
    /// when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub matrix: Option<[[Finite; 3]; 3]>,
    /// Uncertain gains, in the place of `matrix`; none when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_error: Option<GainErrorFile>,
    /// Step to which the torque about each axis is rounded, not negative; 0 for none [N m].
    #[serde(default, with = "As::<NonNegative>")]
    pub torque_quantum_nm: f64,
}

impl ActuatorsFile {
    /// Actuators without faults.
    ///
    /// # Errors
    /// Gains that are stated twice or out of their range.
    pub fn data(&self) -> Result<ActuatorData<3>, ModelError> {
        let gain_error = self.gain_error.as_ref().map(|file| file.data(3));
        let gain_error = gain_error.transpose();
        let gain_error = gain_error.map_err(|error| error.within("actuators.gain_error"))?;
        if self.matrix.is_some() && gain_error.is_some() {
            let expected = "one of matrix and gain_error";
            return Err(ModelError::shape("actuators", "both", expected));
        }
        Ok(ActuatorData {
            limit: Vector3::from(self.torque_limit_nm.unwrap_or([f64::INFINITY; 3])),
            dead_band: Vector3::from(self.dead_band_nm),
            delay_s: self.delay_s,
            matrix: self.matrix.map_or(Matrix3::identity(), |rows| {
                Matrix3::from_fn(|row, column| rows[row][column].get())
            }),
            gain_error,
            quantum: self.torque_quantum_nm,
            effects: Vec::new(),
        })
    }
}

/// Actuators of `M` axes.
#[derive(Clone, Debug, PartialEq)]
pub struct ActuatorData<const M: usize> {
    /// Largest torque of each axis, N m; infinite for none.
    pub limit: SVector<f64, M>,
    /// Commands below this magnitude give no torque, N m.
    pub dead_band: SVector<f64, M>,
    /// Time from command to torque, s.
    pub delay_s: f64,
    /// Torque about each axis per unit torque of each actuator.
    pub matrix: SMatrix<f64, M, M>,
    /// Uncertain gains after the matrix.
    pub gain_error: Option<GainError<M>>,
    /// Step to which the torque about each axis is rounded at last, N m; zero for none.
    pub quantum: f64,
    /// What changes the torque before the matrix, in this order.
    pub effects: Vec<AnyEffect>,
}

impl<const M: usize> ActuatorData<M> {
    /// Actuators that follow their commands.
    pub fn ideal() -> Self {
        Self {
            limit: SVector::repeat(f64::INFINITY),
            dead_band: SVector::zeros(),
            delay_s: 0.0,
            matrix: SMatrix::identity(),
            gain_error: None,
            quantum: 0.0,
            effects: Vec::new(),
        }
    }

    /// Times at which an effect begins or ends, s.
    pub fn discontinuities_s(&self) -> Vec<f64> {
        let effects = self.effects.iter();
        effects.flat_map(Effect::<M>::discontinuities_s).collect()
    }
}

/// Actuators during a run.
#[derive(Clone, Debug)]
pub struct Actuators<'a, const M: usize> {
    data: &'a ActuatorData<M>,
    effects: Vec<AnyEffect>,
    /// What the actuators give now, before the matrix.
    given: SVector<f64, M>,
    gain: SMatrix<f64, M, M>,
    random: Random,
    ideal: bool,
    pending: VecDeque<(f64, SVector<f64, M>)>,
    commanded: SVector<f64, M>,
    last_command: SVector<f64, M>,
}

impl<'a, const M: usize> Actuators<'a, M> {
    /// Actuators at rest, for a scenario's seed.
    pub fn new(data: &'a ActuatorData<M>, seed: u64) -> Self {
        let mut random = Random::new(seed, Purpose::ActuatorGain);
        let gain = data.gain_error.as_ref();
        Self {
            data,
            effects: data.effects.clone(),
            given: SVector::zeros(),
            gain: gain.map_or(SMatrix::identity(), |gain| gain.draw(&mut random)),
            random,
            ideal: *data == ActuatorData::ideal(),
            pending: VecDeque::new(),
            commanded: SVector::zeros(),
            last_command: SVector::zeros(),
        }
    }

    /// Takes a command at `time_s` seconds.
    #[inline]
    pub fn command(&mut self, time_s: f64, torque: &SVector<f64, M>) {
        if self.data.delay_s == 0.0 {
            self.commanded = *torque;
        } else if *torque != self.last_command {
            self.pending
                .push_back((time_s + self.data.delay_s, *torque));
        }
        self.last_command = *torque;
    }

    /// When the next delayed command arrives, s; infinite when there is none.
    #[inline]
    pub fn next_change_s(&self) -> f64 {
        self.pending
            .front()
            .map_or(f64::INFINITY, |(time, _)| *time)
    }

    /// New gains where they change in time; `gradient` says how x'Ux grows with the torque, where that is known.
    #[inline]
    pub fn renew(&mut self, gradient: Option<&SVector<f64, M>>) {
        let Some(gain) = &self.data.gain_error else {
            return;
        };
        match (gain.kind, gradient) {
            (GainKind::Random, _) => self.gain = gain.draw(&mut self.random),
            (GainKind::Worst, Some(gradient)) => self.gain = gain.worst(gradient, &self.given),
            (GainKind::Constant, _) | (GainKind::Worst, None) => {}
        }
    }

    /// The torque that acts from `time_s` on, N m.
    #[inline]
    pub fn torque(&mut self, time_s: f64) -> SVector<f64, M> {
        if self.ideal {
            return self.commanded;
        }
        self.limited_torque(time_s)
    }

    #[inline(never)]
    fn limited_torque(&mut self, time_s: f64) -> SVector<f64, M> {
        while let Some((_, torque)) = self.pending.front().filter(|(due, _)| *due <= time_s) {
            self.commanded = *torque;
            self.pending.pop_front();
        }
        let data = self.data;
        let mut torque = SVector::from_fn(|axis, _| {
            let value: f64 = self.commanded[axis];
            if value.abs() < data.dead_band[axis] {
                0.0
            } else {
                value.clamp(-data.limit[axis], data.limit[axis])
            }
        });
        for effect in &mut self.effects {
            effect.change(time_s, &mut torque);
        }
        self.given = torque;
        let mut torque = data.matrix * torque;
        if data.gain_error.is_some() {
            torque = self.gain * torque;
        }
        if data.quantum > 0.0 {
            torque = torque.map(|value| (value / data.quantum).round() * data.quantum);
        }
        torque
    }

    /// The torque acted for `span_s` seconds.
    #[inline]
    pub fn acted(&mut self, span_s: f64) {
        for effect in &mut self.effects {
            effect.acted(span_s, &self.given);
        }
    }

    /// What the actuators have been commanded last.
    pub fn last_command(&self) -> &SVector<f64, M> {
        &self.last_command
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    #[test]
    fn torque_is_limited_per_axis_and_zero_inside_the_dead_band() {
        let data = ActuatorData {
            limit: Vector2::new(1.0, 2.0),
            dead_band: Vector2::new(0.1, 0.0),
            ..ActuatorData::ideal()
        };
        let mut actuators = Actuators::new(&data, 1);
        actuators.command(0.0, &Vector2::new(-3.0, 1.5));
        assert_eq!(actuators.torque(0.0), Vector2::new(-1.0, 1.5));
        actuators.command(1.0, &Vector2::new(0.09, 5.0));
        assert_eq!(actuators.torque(1.0), Vector2::new(0.0, 2.0));
    }

    #[test]
    fn a_delayed_command_acts_when_it_arrives() {
        let data = ActuatorData {
            delay_s: 0.5,
            ..ActuatorData::ideal()
        };
        let mut actuators = Actuators::new(&data, 1);
        let (first, second) = (Vector2::new(1.0, 0.0), Vector2::new(2.0, 0.0));
        actuators.command(0.0, &first);
        actuators.command(0.25, &second);
        assert_eq!(actuators.torque(0.25), Vector2::zeros());
        assert_eq!(actuators.next_change_s(), 0.5);
        assert_eq!(actuators.torque(0.5), first);
        assert_eq!(actuators.torque(0.75), second);
        assert_eq!(actuators.next_change_s(), f64::INFINITY);
    }

    #[test]
    fn a_fault_acts_inside_its_window_only() {
        let data = ActuatorData {
            effects: vec![AnyEffect::Fault(Fault {
                axis: 1,
                from_s: 1.0,
                until_s: 2.0,
                effectiveness: 0.5,
            })],
            ..ActuatorData::ideal()
        };
        let mut actuators = Actuators::new(&data, 1);
        actuators.command(0.0, &Vector2::new(1.0, 1.0));
        let second = |actuators: &mut Actuators<2>, time| actuators.torque(time).y;
        assert_eq!(second(&mut actuators, 0.999), 1.0);
        assert_eq!(second(&mut actuators, 1.0), 0.5);
        assert_eq!(second(&mut actuators, 2.0), 1.0);
    }

    #[test]
    fn the_matrix_acts_on_what_the_actuators_give() {
        let data = ActuatorData {
            limit: Vector2::new(1.0, 1.0),
            matrix: nalgebra::Matrix2::new(1.0, 0.5, 0.0, -2.0),
            ..ActuatorData::ideal()
        };
        let mut actuators = Actuators::new(&data, 1);
        actuators.command(0.0, &Vector2::new(0.25, 4.0));
        assert_eq!(actuators.torque(0.0), Vector2::new(0.75, -2.0));
        assert_eq!(*actuators.last_command(), Vector2::new(0.25, 4.0));
    }

    fn uncertain(kind: GainKind) -> ActuatorData<2> {
        ActuatorData {
            gain_error: Some(GainError {
                range: [[0.5, 1.0], [0.8, 0.9]],
                misalignment: 0.1,
                inputs: 2,
                kind,
            }),
            ..ActuatorData::ideal()
        }
    }

    #[test]
    fn the_worst_gains_give_the_most_of_what_harms_and_the_least_of_what_helps() {
        let data = uncertain(GainKind::Worst);
        let mut actuators = Actuators::new(&data, 1);
        actuators.command(0.0, &Vector2::new(2.0, -1.0));
        actuators.torque(0.0);
        actuators.renew(Some(&Vector2::new(1.0, 1.0)));
        let torque = actuators.torque(0.0);
        assert!((torque - Vector2::new(2.0 + 0.1, -0.8 + 0.2)).amax() < 1e-15);
    }

    #[test]
    fn random_gains_change_and_constant_ones_do_not_and_both_keep_within_their_bounds() {
        for (kind, changes) in [(GainKind::Random, true), (GainKind::Constant, false)] {
            let data = uncertain(kind);
            let mut actuators = Actuators::new(&data, 1);
            actuators.command(0.0, &Vector2::new(1.0, 0.0));
            let first = actuators.torque(0.0);
            let mut changed = false;
            for _ in 0..100 {
                actuators.renew(None);
                let torque = actuators.torque(0.0);
                assert!((0.5..=1.0).contains(&torque.x) && torque.y.abs() <= 0.1);
                changed |= torque != first;
            }
            assert_eq!(changed, changes);
        }
    }

    #[test]
    fn a_rounded_torque_is_off_by_half_a_step_at_most() {
        let data = ActuatorData {
            quantum: 0.25,
            ..ActuatorData::ideal()
        };
        let mut actuators = Actuators::new(&data, 1);
        actuators.command(0.0, &Vector2::new(0.3, -0.4));
        assert_eq!(actuators.torque(0.0), Vector2::new(0.25, -0.5));
    }
}
