//! The numbers of a certificate.

use nalgebra::{DMatrix, DVector};

use crate::model::{Mismatch, Model};

/// The gains of one rule, beyond the first.
#[derive(Debug, Clone, PartialEq)]
pub struct RuleGains {
    /// F_j, m x n.
    pub gain: DMatrix<f64>,
    /// N_j, m x n.
    pub anti_windup: DMatrix<f64>,
}

/// Slack of the mismatch bound for one end of the sampling interval. Rows: B'Q'v (m), M p (m; left out
/// where all N_j are equal), x(t_k) (n).
#[derive(Debug, Clone, PartialEq)]
pub struct MismatchSlack {
    /// P_j of every gain, symmetric.
    pub bounds: Vec<DMatrix<f64>>,
    /// R, symmetric.
    pub common: DMatrix<f64>,
}

/// What a measurement error needs beside the trigger weight.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementWeights {
    /// Wp, n x n, symmetric: what is left of the trigger weight on the error.
    pub error_weight: DMatrix<f64>,
    /// Diagonal of Lam, n entries above 0: the weight of the measurement error in the supply.
    pub sample_weight: DVector<f64>,
}

/// The functional before the first message arrives, when there is no torque.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstTorque {
    /// kappa, above 0: V' <= kappa V + xi |tau|^2 [1/s].
    pub growth: f64,
    /// Multiplier of x, n x n.
    pub state: DMatrix<f64>,
    /// Multiplier of x', n x n.
    pub rate: DMatrix<f64>,
    /// Multiplier of the disturbance, d x n.
    pub disturbance: DMatrix<f64>,
}

/// a and b, above 0: where they show that a held state asks for no more than a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldWeights {
    /// a: weight of the state in the large set.
    pub state: f64,
    /// b: weight of the trigger's decision.
    pub trigger: f64,
}

/// How the states of a large set come under the certificate of a small one.
#[derive(Debug, Clone, PartialEq)]
pub struct HandOver {
    /// rho', above r / phi of the large set: x'Ux <= rho' is reached from every certified start.
    pub level: f64,
    /// One for each input of each gain, gain after gain.
    pub held: Vec<HeldWeights>,
}

/// Claimed bounds from rest, and in the end from every certified start. Spacecraft only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinalBounds {
    /// On the norm of the rate [rad/s].
    pub rate: f64,
    /// On the norm of the error quaternion's vector part.
    pub vector_part: f64,
}

/// The numbers of a certificate, exactly as a reader of the file gets them. n states, m inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// F, m x n; with several gains the first.
    pub gain: DMatrix<f64>,
    /// The other gains; empty for a constant gain.
    pub further: Vec<RuleGains>,
    /// Slack for r = 1 and r = 2; empty unless a mismatch above 0 is assumed.
    pub mismatch: Vec<MismatchSlack>,
    /// Upsilon, n x n, symmetric.
    pub trigger_weight: DMatrix<f64>,
    /// eps_a, 0 or above: a sample is sent when e' Upsilon e >= nu w' Upsilon w + eps_a.
    pub trigger_floor: f64,
    /// Above 0: the functional of this certificate uses this multiple of Upsilon, which does not
    /// change the trigger; 1 where there is one certificate.
    pub trigger_multiple: f64,
    /// U, n x n, symmetric.
    pub lyapunov: DMatrix<f64>,
    /// Y, n x n, symmetric.
    pub integral_weight: DMatrix<f64>,
    /// Q, n x n: the multiplier of the plant's equation in descriptor form.
    pub multiplier: DMatrix<f64>,
    /// L1, n x n.
    pub free_state: DMatrix<f64>,
    /// L2, n x n.
    pub free_sample: DMatrix<f64>,
    /// N, m x n.
    pub anti_windup: DMatrix<f64>,
    /// Diagonal of M, m entries.
    pub sector_weight: DVector<f64>,
    /// xi.
    pub disturbance_weight: f64,
    /// gamma.
    pub gain_bound: f64,
    /// Claimed bound on sup|y| / sup|tau| from rest; at most gamma.
    pub guaranteed_gain: f64,
    /// Claimed radius: every attitude at rest whose error quaternion has a vector part up to this
    /// norm lies in the certified set. Spacecraft only.
    pub certified_vector_part: Option<f64>,
    /// Claimed bounds from rest and in the end.
    pub final_bounds: Option<FinalBounds>,
    /// The weights of a measurement error; `None` where the measurement is perfect.
    pub measurement: Option<MeasurementWeights>,
    /// T: one number above 0 for each uncertain entry of the actuators' gain, row after row.
    pub gain_error_weight: DVector<f64>,
    /// The functional before the first torque; `None` where every message arrives at once.
    pub first_torque: Option<FirstTorque>,
}

impl Certificate {
    /// Multiplies every number of the functional and of the multipliers, xi included, by a factor above 0: without the
    /// slack of a mismatch (18) is homogeneous in them. Gains and claims stay as they are.
    pub fn scale_functional(&mut self, factor: f64) {
        for matrix in [
            &mut self.trigger_weight,
            &mut self.lyapunov,
            &mut self.integral_weight,
            &mut self.multiplier,
            &mut self.free_state,
            &mut self.free_sample,
        ] {
            *matrix *= factor;
        }
        self.sector_weight *= factor;
        self.disturbance_weight *= factor;
        self.trigger_floor *= factor;
        self.gain_error_weight *= factor;
        if let Some(measurement) = &mut self.measurement {
            measurement.error_weight *= factor;
            measurement.sample_weight *= factor;
        }
        if let Some(first) = &mut self.first_torque {
            for matrix in [&mut first.state, &mut first.rate, &mut first.disturbance] {
                *matrix *= factor;
            }
        }
    }

    /// Number of gains.
    pub fn gain_count(&self) -> usize {
        1 + self.further.len()
    }

    /// All gains F_j.
    pub fn gains(&self) -> impl Iterator<Item = &DMatrix<f64>> {
        std::iter::once(&self.gain).chain(self.further.iter().map(|rule| &rule.gain))
    }

    /// All anti-windup gains N_j.
    pub fn anti_windups(&self) -> impl Iterator<Item = &DMatrix<f64>> {
        std::iter::once(&self.anti_windup).chain(self.further.iter().map(|rule| &rule.anti_windup))
    }

    /// True when the proof takes rule j of the plant and gain j to have nearly the same weight.
    /// Otherwise the gains may be weighted in any way at any time.
    pub fn is_matched(&self, model: &Model) -> bool {
        matches!(model.file.mismatch, Mismatch::Kappa(_))
            && self.gain_count() > 1
            && model.plant.membership_count() == Some(self.gain_count())
    }

    /// Side of P_j and R: with rows for M p only where the N_j differ.
    pub fn mismatch_side(&self) -> usize {
        let (m, n) = self.gain.shape();
        let equal = self.anti_windups().all(|gain| *gain == self.anti_windup);
        n + if equal { m } else { 2 * m }
    }
}
