//! Takagi-Sugeno (T-S) models: a nonlinear plant as a convex combination of linear vertex systems.

mod exact;
mod inertia_bounds;
mod inertia_set;
mod momentum;
mod rules;
mod vertices;

pub(crate) use exact::pairs;
pub use exact::{ExactSpacecraft, SCHEDULING_VARIABLES, SPACECRAFT_VERTICES};
pub use inertia_bounds::inertia_bounds;
pub(crate) use inertia_bounds::{exact_inertia, inertia_vertices};
pub use inertia_set::{triangle_excess, InertiaUncertainty, INERTIA_ENTRIES};
pub(crate) use momentum::{InertiaExtremes, ROUNDED_AXES};
pub use momentum::{MomentumExchange, WheelMomentum};
pub use rules::{BlendError, RuleModel};
pub use vertices::VertexSystem;

use nalgebra::{DMatrix, DVector};

/// One constraint of the region in which the model holds: `|rows x| <= bound`, Euclidean norm.
#[derive(Debug, Clone, PartialEq)]
pub struct BoxCondition {
    /// What is bounded, such as `rate axis 1`.
    pub name: String,
    /// k x n, in units of the bound per unit of state.
    pub rows: DMatrix<f64>,
    /// Square of the bound.
    pub bound_squared: f64,
}

/// The vertex systems `E_i x' = A_i x + B sat(u) + B_w tau`, `y = C x` of a T-S model, its region and
/// its limits, in physical units. Input and output matrices are common to all vertices.
#[derive(Debug, Clone, PartialEq)]
pub struct TakagiSugeno {
    /// State matrices A_i, n x n.
    pub vertices: Vec<DMatrix<f64>>,
    /// E_i, n x n, one for each state matrix; empty when all are the identity. An uncertain inertia makes
    /// them differ.
    pub descriptors: Vec<DMatrix<f64>>,
    /// Input matrix B, n x m.
    pub input: DMatrix<f64>,
    /// Disturbance matrix B_w, n x d (the paper takes B_w = B).
    pub disturbance: DMatrix<f64>,
    /// Output matrix C, p x n.
    pub output: DMatrix<f64>,
    /// Saturation level of each input, `ubar_s` of (4).
    pub input_limit: DVector<f64>,
    /// Bound `taubar` on the Euclidean norm of the disturbance.
    pub disturbance_bound: f64,
    /// The region in which the model equals the plant; empty when it does so everywhere.
    pub region: Vec<BoxCondition>,
}

impl TakagiSugeno {
    /// Number of states n.
    pub fn states(&self) -> usize {
        self.input.nrows()
    }

    /// The smallest extent of the region along a state, from 0; `None` where it is unbounded along it.
    pub fn extent(&self, state: usize) -> Option<f64> {
        let along = self.region.iter().filter_map(|bound| {
            let reach = bound.rows.column(state).norm();
            (reach > 0.0).then(|| bound.bound_squared.max(0.0).sqrt() / reach)
        });
        along.reduce(f64::min).filter(|extent| *extent > 0.0)
    }

    /// Number of inputs m.
    pub fn inputs(&self) -> usize {
        self.input.ncols()
    }
}
