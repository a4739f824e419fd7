//! Integration of the plant between events, with the input held.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::base::bounded::{As, Positive, Tolerance};

/// How the plant is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Method {
    /// The classical Runge-Kutta method of order 4.
    RungeKutta4 {
        /// Longest step, above 0 (s); 1/32 s when the integrator is left out.
        #[serde(with = "As::<Positive>")]
        step_s: f64,
    },
    /// Dormand and Prince's adaptive method of order 8, with a step chosen from its error estimate: the
    /// reference that the other is checked against.
    DormandPrince853 {
        /// Allowed error of a step, relative to the state (and absolute where it is below 1), in
        /// [1e-14, 0.001].
        #[serde(with = "As::<Tolerance>")]
        tolerance: f64,
    },
}

impl Default for Method {
    fn default() -> Self {
        Method::RungeKutta4 { step_s: 0.03125 }
    }
}
