//! What a loop that flies does otherwise than an ideal one, as the conditions see it.

use nalgebra::{DMatrix, DVector};

/// Bounds on the departures, in the units of a [`Task`](super::Task); an ideal loop by default.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LoopImperfections {
    /// h_m = (N + 1) hbar + d_max (s), where messages may come late or be lost; [`None`] where each acts at once.
    pub oldest_sample: Option<f64>,
    /// The set of the actuators' gains, where it is not the identity alone.
    pub gain_error: Option<GainErrorSet>,
    /// The bound on the measurement error, where there is one.
    pub measurement: Option<MeasurementError>,
    /// What the trigger's floor adds to the supply.
    pub floor: FloorSupply,
}

/// The floor's part of the supply r = (1 + share) (xi + s / taubar^2) taubar^2 + constant taubar^2.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FloorSupply {
    /// Relative to what disturbance and measurement error supply.
    pub share: f64,
    /// In units of xi.
    pub constant: f64,
}

/// The actuators apply G sat(u) with G = diag(centre) + sum_k a_k delta_k e_i e_j', |delta_k| <= 1.
#[derive(Debug, Clone, PartialEq)]
pub struct GainErrorSet {
    /// Diagonal of the centre, m entries.
    pub centre: DVector<f64>,
    /// The uncertain entries (i, j), each with its half-width a_k.
    pub entries: Vec<((usize, usize), f64)>,
}

impl GainErrorSet {
    /// The columns B e_i a_k, n x K.
    pub fn columns(&self, input: &DMatrix<f64>) -> DMatrix<f64> {
        let columns = self.entries.iter();
        let columns = columns.map(|&((i, _), width)| input.column(i) * width);
        DMatrix::from_columns(&columns.collect::<Vec<_>>())
    }

    /// The rows e_j' that select the torque of each uncertain entry, K x m.
    pub fn selection(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.entries.len(), self.centre.len(), |k, column| {
            let ((_, j), _) = self.entries[k];
            f64::from(u8::from(j == column))
        })
    }

    /// The set in units in which u = E u'.
    pub fn in_units(&self, input: &DVector<f64>) -> Self {
        let entries = self.entries.iter();
        let entries = entries.map(|&((i, j), width)| ((i, j), width * (input[j] / input[i])));
        GainErrorSet {
            centre: self.centre.clone(),
            entries: entries.collect(),
        }
    }
}

/// A measurement error in balls of some states each, relative to the disturbance.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementError {
    /// For each state the radius of its ball over the bound on the disturbance, above 0.
    pub sizes: DVector<f64>,
    /// For each state the index of its ball, from 0.
    pub balls: Vec<usize>,
    /// Where the condition on the weights is linearised; without it the condition cannot be stated.
    pub point: Option<MeasurementPoint>,
    /// eta_s: what the error makes of each command at most, m entries.
    pub reserve: DVector<f64>,
}

/// A point about which `Qh Lam Qh'` is bounded from below by a linear expression, exactly there.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementPoint {
    /// Qh, n x n.
    pub multiplier: DMatrix<f64>,
    /// lambda of each ball: its part of the supply is taubar^2 / lambda.
    pub shares: Vec<f64>,
}

impl MeasurementError {
    /// Number of balls.
    pub fn count(&self) -> usize {
        self.balls.iter().max().map_or(0, |last| last + 1)
    }

    /// The error in units x = D x', u = E u', tau = c tau'.
    pub fn in_units(&self, state: &DVector<f64>, input: &DVector<f64>, disturbance: f64) -> Self {
        let inverse = DMatrix::from_diagonal(&state.map(|unit| 1.0 / unit));
        MeasurementError {
            sizes: self.sizes.component_div(state) * disturbance,
            balls: self.balls.clone(),
            reserve: self.reserve.component_div(input),
            point: self.point.as_ref().map(|point| MeasurementPoint {
                multiplier: &inverse * &point.multiplier * &inverse,
                shares: point
                    .shares
                    .iter()
                    .map(|share| share / (disturbance * disturbance))
                    .collect(),
            }),
        }
    }
}
