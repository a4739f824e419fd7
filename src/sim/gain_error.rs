//! Actuators that give more, less or another torque than they are told, within bounds.

use nalgebra::{SMatrix, SVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::{Effectiveness, ModelError};

use super::random::Random;
use crate::base::bounded::{As, NonNegative};
use crate::base::ranges::require;

/// How the gains are chosen within their bounds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GainKind {
    /// Once for the run, uniform.
    Constant,
    /// Anew at every sample and every arrival, uniform.
    #[default]
    Random,
    /// At every sample and every arrival those for which x'Ux of the design grows fastest.
    Worst,
}

/// Applied torque over commanded torque, after saturation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GainErrorFile {
    /// [lowest, highest] share of an input's torque that acts, above 0, for all inputs or one pair for each; 1 when left
    /// out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effectiveness: Option<Effectiveness>,
    /// Largest share of one input's torque that acts in another's place, not negative.
    #[serde(default, with = "As::<NonNegative>")]
    pub misalignment: f64,
    /// How they are chosen.
    #[serde(default)]
    pub kind: GainKind,
}

impl GainErrorFile {
    /// The bounds for `inputs` inputs, padded to `M`.
    ///
    /// # Errors
    /// Another number of pairs; a lowest share above the highest.
    pub fn data<const M: usize>(&self, inputs: usize) -> Result<GainError<M>, ModelError> {
        let mut range = [[1.0; 2]; M];
        if let Some(Effectiveness::PerInput(pairs)) = &self.effectiveness {
            if pairs.len() != inputs {
                let [found, expected] = [pairs.len(), inputs].map(|count| format!("{count} pairs"));
                return Err(ModelError::shape("effectiveness", found, expected));
            }
        }
        for (input, range) in range.iter_mut().enumerate().take(inputs) {
            let given = self.effectiveness.as_ref();
            *range = given.map_or([1.0; 2], |given| given.of(input));
            let allowed = "at most the highest effectiveness";
            require(range[0] <= range[1], "effectiveness", range[0], allowed)?;
        }
        Ok(GainError {
            range,
            misalignment: self.misalignment,
            inputs,
            kind: self.kind,
        })
    }
}

/// Bounds on the gains of `M` inputs, of which the last ones may be padding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GainError<const M: usize> {
    /// Lowest and highest share of each input that acts.
    pub range: [[f64; 2]; M],
    /// Largest share that acts in another input's place.
    pub misalignment: f64,
    /// Inputs that are not padding.
    pub inputs: usize,
    /// How the gains are chosen.
    pub kind: GainKind,
}

impl<const M: usize> GainError<M> {
    /// Bounds of an entry: applied at `row` per unit commanded at `column`.
    fn bounds(&self, row: usize, column: usize) -> [f64; 2] {
        match (row == column, row.max(column) < self.inputs) {
            (true, _) => self.range[row],
            (false, true) => [-self.misalignment, self.misalignment],
            (false, false) => [0.0; 2],
        }
    }

    /// The same bounds for `K` inputs: padding is added or left out.
    pub fn resized<const K: usize>(&self) -> GainError<K> {
        GainError {
            range: std::array::from_fn(|input| self.range.get(input).copied().unwrap_or([1.0; 2])),
            misalignment: self.misalignment,
            inputs: self.inputs,
            kind: self.kind,
        }
    }

    /// Gains drawn from the bounds.
    pub fn draw(&self, random: &mut Random) -> SMatrix<f64, M, M> {
        SMatrix::from_fn(|row, column| {
            let [lowest, highest] = self.bounds(row, column);
            lowest + (highest - lowest) * random.uniform()
        })
    }

    /// The gains with the largest `gradient' G torque`.
    pub fn worst(
        &self,
        gradient: &SVector<f64, M>,
        torque: &SVector<f64, M>,
    ) -> SMatrix<f64, M, M> {
        SMatrix::from_fn(|row, column| {
            let [lowest, highest] = self.bounds(row, column);
            match gradient[row] * torque[column] > 0.0 {
                true => highest,
                false => lowest,
            }
        })
    }
}
