//! The part of a design file that only the proof needs.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The unknowns of Theorem 1. n states, m inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CertificateFile {
    /// U: x'Ux <= 1 is the certified set. n x n, symmetric.
    pub lyapunov: Vec<Vec<f64>>,
    /// Y: weight of the integral term. n x n, symmetric.
    pub integral_weight: Vec<Vec<f64>>,
    /// Q: multiplier of the plant's equation (for a spacecraft, of the equation multiplied by the
    /// inertia). n x n.
    pub multiplier: Vec<Vec<f64>>,
    /// L1. n x n.
    pub free_state: Vec<Vec<f64>>,
    /// L2. n x n.
    pub free_sample: Vec<Vec<f64>>,
    /// N_j: anti-windup gains, each m x n.
    pub anti_windup: Vec<Vec<Vec<f64>>>,
    /// Diagonal of M. m entries.
    pub sector_weight: Vec<f64>,
    /// Slack of the mismatch bound, for r = 1 and r = 2; only with scheduled gains and kappa > 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mismatch: Vec<MismatchFile>,
    /// xi: V' <= -phi V + xi |tau|^2.
    pub xi: f64,
    /// gamma: the paper's bound on sup|y| / sup|tau| from rest, not below xi.
    pub gamma: f64,
    /// The sharper bound sqrt(g xi) with C'C <= g phi U.
    pub guaranteed_gain: f64,
    /// Radius s: every attitude at rest with |q| <= s is in the certified set. Spacecraft only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certified_vector_part: Option<f64>,
}

/// P_j and R with P_j >= +-(N_j - R), N_j the form of gain j on (B'Q'v, M p, x(t_k)); the rows of M p are
/// left out where all anti-windup gains are equal. Each m + n (or 2 m + n) square, symmetric.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MismatchFile {
    /// P_j of every gain.
    pub bounds: Vec<Vec<Vec<f64>>>,
    /// R.
    pub common: Vec<Vec<f64>>,
}
