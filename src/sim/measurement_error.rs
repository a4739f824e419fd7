//! Measurement errors that stay within bounds, chosen at random or against a design.

use std::ops::Range;

use nalgebra::{SMatrix, SVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::ModelError;

use super::random::{Purpose, Random};
use crate::base::bounded::Finite;

/// How an error is chosen within its bounds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ErrorKind {
    /// Anew at every sample, uniform in the ball (for one state: the interval).
    Random,
    /// Always the same, at the bound.
    Constant {
        /// One number for each state: for a spacecraft the direction of the rate's error, then the axis about which the
        /// attitude is off. Only the directions count; all ones when left out.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        direction: Vec<Finite>,
    },
    /// From the true state towards the one sent last, so that the trigger stays silent.
    TowardsHeld,
    /// Along F'B'Ux of the design: the error that makes x'Ux grow fastest.
    Worst,
}

/// A constant error has a direction with one number for each state, or none.
pub(crate) fn check_direction(
    field: &str,
    kind: &ErrorKind,
    states: usize,
) -> Result<(), ModelError> {
    let ErrorKind::Constant { direction } = kind else {
        return Ok(());
    };
    match direction.is_empty() || direction.len() == states {
        true => Ok(()),
        false => {
            let [found, expected] =
                [direction.len(), states].map(|count| format!("{count} entries"));
            let field = format!("{field}.kind.constant.direction");
            Err(ModelError::shape(field, found, expected))
        }
    }
}

/// States whose errors are bounded together.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorGroup {
    /// The states.
    pub states: Range<usize>,
    /// Bound on the norm of their error.
    pub bound: f64,
    /// Error per change of the state: 2 where the error is a small rotation and the state a quaternion's vector part.
    pub scale: f64,
}

/// A bounded error.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorBounds {
    /// Its bounds.
    pub groups: Vec<ErrorGroup>,
    /// How it is chosen.
    pub kind: ErrorKind,
}

/// The errors of a run, of `L` states.
#[derive(Debug, Clone)]
pub struct BoundedError<const L: usize> {
    bounds: ErrorBounds,
    /// F'B'U of the design.
    worst: SMatrix<f64, L, L>,
    held: Option<SVector<f64, L>>,
    random: Random,
}

impl<const L: usize> BoundedError<L> {
    /// Errors for a scenario's seed. `worst`: F'B'U of the design, where there is one.
    pub fn new(bounds: ErrorBounds, worst: Option<SMatrix<f64, L, L>>, seed: u64) -> Self {
        Self {
            bounds,
            worst: worst.unwrap_or_else(SMatrix::zeros),
            held: None,
            random: Random::new(seed, Purpose::MeasurementError),
        }
    }

    /// Whether the direction of the error depends on the state.
    pub fn follows_state(&self) -> bool {
        matches!(self.bounds.kind, ErrorKind::TowardsHeld | ErrorKind::Worst)
    }

    /// The measured state that was sent.
    pub fn sent(&mut self, measured: &SVector<f64, L>) {
        self.held = Some(*measured);
    }

    /// The error of a sample of the true state.
    pub fn error(&mut self, state: &SVector<f64, L>) -> SVector<f64, L> {
        let towards = match &self.bounds.kind {
            ErrorKind::Random => SVector::from_fn(|_, _| self.random.normal()),
            ErrorKind::Constant { direction } => {
                SVector::from_fn(|row, _| direction.get(row).map_or(1.0, |value| value.get()))
            }
            ErrorKind::TowardsHeld => self.held.map_or(SVector::zeros(), |held| held - state),
            ErrorKind::Worst => self.worst * state,
        };
        let mut error = SVector::zeros();
        for group in &self.bounds.groups {
            let parts = towards.as_slice().get(group.states.clone());
            let squares = parts.unwrap_or_default().iter().map(|part| part * part);
            let length = squares.sum::<f64>().sqrt();
            if length == 0.0 {
                continue;
            }
            let size = match self.bounds.kind {
                ErrorKind::Random => {
                    let dimension = group.states.len() as f64;
                    group.bound * libm::pow(self.random.uniform(), 1.0 / dimension)
                }
                ErrorKind::TowardsHeld => group.bound.min(group.scale * length),
                _ => group.bound,
            };
            for state in group.states.clone() {
                error[state] = towards[state] * (size / length);
            }
        }
        error
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Vector3};

    fn errors(kind: ErrorKind) -> BoundedError<3> {
        let group = |states, bound| ErrorGroup {
            states,
            bound,
            scale: 1.0,
        };
        let bounds = ErrorBounds {
            groups: vec![group(0..2, 0.5), group(2..3, 0.1)],
            kind,
        };
        let worst = Matrix3::new(0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, -2.0);
        BoundedError::new(bounds, Some(worst), 4)
    }

    #[test]
    fn random_errors_fill_the_ball_and_never_leave_it() {
        let mut errors = errors(ErrorKind::Random);
        let (mut inside, mut largest) = (0, [0.0_f64; 2]);
        let count = 20_000;
        for _ in 0..count {
            let error = errors.error(&Vector3::zeros());
            let sizes = [error.xy().norm() / 0.5, error.z.abs() / 0.1];
            inside += u32::from(sizes[0] < 0.5);
            largest = [0, 1].map(|group| largest[group].max(sizes[group]));
        }
        assert!(largest
            .iter()
            .all(|&size| size > 0.99 && size <= 1.0 + 1e-12));
        // A quarter of a disc lies within half of its radius; the standard deviation is 0.3 %.
        let share = f64::from(inside) / f64::from(count);
        assert!((share - 0.25).abs() < 0.015, "{share}");
    }

    #[test]
    fn the_worst_error_is_at_the_bound_along_its_direction() {
        let error = errors(ErrorKind::Worst).error(&Vector3::new(3.0, 0.0, 1.0));
        assert!((error - Vector3::new(0.0, -0.5, -0.1)).amax() < 1e-15);
    }

    #[test]
    fn an_error_towards_the_state_sent_last_ends_there() {
        let mut errors = errors(ErrorKind::TowardsHeld);
        let state = Vector3::new(1.0, 0.0, 0.02);
        assert_eq!(errors.error(&state), Vector3::zeros());
        errors.sent(&Vector3::new(3.0, 0.0, 0.0));
        let error = errors.error(&state);
        assert!((error - Vector3::new(0.5, 0.0, -0.02)).amax() < 1e-15);
    }

    #[test]
    fn a_constant_error_is_the_same_at_every_state() {
        let kind = ErrorKind::Constant { direction: vec![] };
        let mut errors = errors(kind);
        let first = errors.error(&Vector3::zeros());
        assert_eq!(first, errors.error(&Vector3::new(1.0, 2.0, 3.0)));
        assert!((first.xy().norm() - 0.5).abs() < 1e-15 && (first.z - 0.1).abs() < 1e-15);
    }
}
