//! What the optimum of the smallest-gain program of a model is.

use crate::model::Model;

/// What the optimum of the program is that makes the gain of a model small, which does not depend on the units in which
/// the program is stated. The program minimises a bound of g and of `w xi`, where w is the weight of the model's
/// objective (see [`scaling`](crate::scaling)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Optimum {
    /// gamma: w is 1.
    Gamma,
    /// A multiple of a bound of the guaranteed gain sqrt(g xi).
    GuaranteedGain {
        /// The optimum over the guaranteed gain: sqrt(w), in units of the output times the disturbance.
        factor: f64,
    },
}

impl Optimum {
    /// That of a model.
    pub fn of(model: &Model) -> Self {
        match model.task().gain_per_weight {
            1.0 => Optimum::Gamma,
            weight => Optimum::GuaranteedGain {
                factor: weight.sqrt(),
            },
        }
    }

    /// The bound of gamma, or of the guaranteed gain, that goes with a value of the optimum.
    pub fn bound(self, optimum: f64) -> f64 {
        match self {
            Optimum::Gamma => optimum,
            Optimum::GuaranteedGain { factor } => optimum / factor,
        }
    }

    /// In words.
    pub fn as_text(self) -> String {
        match self {
            Optimum::Gamma => "optimum gamma".to_string(),
            Optimum::GuaranteedGain { factor } => {
                format!("optimum {factor} times a bound of the guaranteed gain")
            }
        }
    }
}
