//! What a design is chosen for.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bounded::{As, NonNegative};
use super::error::ModelError;

/// What is optimised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Objective {
    /// The smallest guaranteed L-infinity gain from the disturbance to the output, in the model's own units.
    #[default]
    Gain,
    /// The smallest pointing error from rest and in the end. Spacecraft only.
    Pointing,
    /// The smallest gamma of the paper, which bounds both that gain and xi; it depends on the units of disturbance
    /// and output.
    Gamma,
    /// One gain with two certificates: the smallest gamma in the model's own box, while the set of
    /// `outer` is certified too.
    Both,
    /// The largest certified set along the must-contain states; without such states, every attitude at rest up
    /// to the largest angle. The box, eps, xi and what `search` names are searched.
    Region,
}

impl Objective {
    /// Whether the guaranteed gain is what is made small: that of the attitude alone is the pointing error.
    pub fn is_guaranteed_gain(self) -> bool {
        matches!(self, Objective::Gain | Objective::Pointing)
    }
}

/// The output y = (rate weight times omega, attitude weight times q); not both weights 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputWeights {
    /// Of the rate, not negative (s).
    #[serde(with = "As::<NonNegative>")]
    pub rate_s: f64,
    /// Of the quaternion's vector part, not negative.
    #[serde(with = "As::<NonNegative>")]
    pub attitude: f64,
}

impl OutputWeights {
    /// y = q.
    pub const ATTITUDE: OutputWeights = OutputWeights {
        rate_s: 0.0,
        attitude: 1.0,
    };

    /// y = x.
    pub const STATE: OutputWeights = OutputWeights {
        rate_s: 1.0,
        attitude: 1.0,
    };

    /// Those given, or what an objective takes in their place.
    ///
    /// # Errors
    /// Both are 0; the objective `pointing` with others than those of the attitude.
    pub fn of(given: Option<OutputWeights>, objective: Objective) -> Result<Self, ModelError> {
        const FIELD: &str = "plant.exact.output_weights";
        let pointing = objective == Objective::Pointing;
        let Some(own) = given else {
            return Ok(match pointing {
                true => OutputWeights::ATTITUDE,
                false => OutputWeights::STATE,
            });
        };
        if own.rate_s == 0.0 && own.attitude == 0.0 {
            return Err(ModelError::choice(FIELD, "must not both be 0"));
        }
        if pointing && (own.rate_s != 0.0 || own.attitude <= 0.0) {
            let reason =
                "must have rate_s 0 and attitude above 0 where the objective is 'pointing'";
            return Err(ModelError::choice(FIELD, reason));
        }
        Ok(own)
    }

    /// The weight of each state.
    pub fn each(self) -> [f64; 6] {
        let (rate, attitude) = (self.rate_s, self.attitude);
        [rate, rate, rate, attitude, attitude, attitude]
    }
}
