//! The problem file, as written: a plant given by vertices and what is asked of its state feedback.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::model::bounded::{As, NonNegative, Positive};
use crate::model::LinearBound;

/// The version this program reads and writes.
pub const PROBLEM_SCHEMA_VERSION: u32 = 1;

/// A design problem for a state feedback u = F x. n states, m inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProblemFile {
    /// Version of this format: 1.
    pub schema_version: u32,
    /// A short name, used in reports.
    pub name: String,
    /// Where the numbers come from.
    #[serde(default)]
    pub source: String,
    /// The plant.
    pub plant: ProblemPlantFile,
    /// A given feedback F, m x n, to be analysed; one is designed when it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<Vec<Vec<f64>>>,
    /// What is asked.
    pub problem: ProblemKindFile,
}

/// How the plant is given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProblemPlantFile {
    /// Vertex systems given by their matrices.
    Vertices(HullFile),
}

/// x' = A(t) x + B u with A(t) in the convex hull of the state matrices.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HullFile {
    /// State matrices A_i, each n x n.
    pub state_matrices: Vec<Vec<Vec<f64>>>,
    /// Input matrix B, n x m.
    pub input_matrix: Vec<Vec<f64>>,
}

/// What is asked of the feedback.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProblemKindFile {
    /// One quadratic function and one feedback for the whole hull, with a decay rate.
    QuadraticStabilisation(QuadraticStabilisationFile),
    /// The smallest L2 gain from a disturbance to an output.
    HInfinity(HInfinityFile),
    /// The largest ellipsoid from which the saturated loop converges.
    SaturatedRegion(SaturatedRegionFile),
}

/// |x(t)| <= c e^(-alpha t) |x(0)|; c is minimised.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct QuadraticStabilisationFile {
    /// Decay rate alpha of the state, 0 or above [1/s].
    #[serde(default, with = "As::<NonNegative>")]
    pub decay_rate_per_s: f64,
}

/// z = C x + D u + D_w w; the L2 gain from w to z is minimised. d disturbances, p outputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HInfinityFile {
    /// Disturbance matrix B_w, n x d.
    pub disturbance_matrix: Vec<Vec<f64>>,
    /// Output matrix C, p x n.
    pub output_matrix: Vec<Vec<f64>>,
    /// From input to output: D, p x m; 0 when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input_to_output_matrix: Option<Vec<Vec<f64>>>,
    /// From disturbance to output: D_w, p x d; 0 when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disturbance_to_output_matrix: Option<Vec<Vec<f64>>>,
    /// The L2 gain that is wanted, above 0: a design below it, and not the smallest gain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub gamma: Option<f64>,
    /// The largest L2 gain that meets the requirement, above 0: the smallest is sought, and any up to this is a success.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub gamma_max: Option<f64>,
}

/// x' = A(t) x + B sat(F x); the largest multiple of the reference set inside the region is sought.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SaturatedRegionFile {
    /// Saturation level of each input, above 0.
    #[serde(with = "As::<Vec<Positive>>")]
    pub input_limit: Vec<f64>,
    /// Decay rate alpha of the state inside the region, 0 or above [1/s].
    #[serde(default, with = "As::<NonNegative>")]
    pub decay_rate_per_s: f64,
    /// What is blown up; the unit ball when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<ReferenceFile>,
    /// Where the vertices describe the plant, |row x| <= bound each; everywhere when empty.
    #[serde(default, rename = "box")]
    pub region: Vec<LinearBound>,
}

/// The reference set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReferenceFile {
    /// x'Wx <= 1: W, n x n, symmetric positive definite.
    Ellipsoid(Vec<Vec<f64>>),
    /// The convex hull of points of n entries each.
    Points(Vec<Vec<f64>>),
}
