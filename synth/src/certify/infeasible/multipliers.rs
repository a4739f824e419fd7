//! Dual multipliers of the conditions, and which of them fit a model.

use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::model::bounded::{As, Finite, Rows};
use crate::model::{check_shape, check_symmetric, GainForm, Mismatch, Model, ModelError};

/// Dual multiplier of (18) at one vertex.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VertexDual {
    /// Number of the vertex, from 1.
    pub vertex: usize,
    /// Second moments of (x, v), 2n x 2n, symmetric.
    #[serde(with = "As::<Rows>")]
    pub moments: DMatrix<f64>,
}

/// Moments with the held state w = x(t_k).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeldMoments {
    /// E[v w'], n x n.
    #[serde(with = "As::<Rows>")]
    pub multiplied_held: DMatrix<f64>,
    /// E[x(t_k^l) w'], n x n.
    #[serde(with = "As::<Rows>")]
    pub sample_held: DMatrix<f64>,
    /// E[w w'], n x n, symmetric.
    #[serde(with = "As::<Rows>")]
    pub held: DMatrix<f64>,
}

/// Moments with the dead zone p, for given gains.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeadZoneMoments {
    /// E[v p'], n x m.
    #[serde(rename = "multiplied_zone", with = "As::<Rows>")]
    pub multiplied: DMatrix<f64>,
    /// E[w p'], n x m.
    #[serde(rename = "held_zone", with = "As::<Rows>")]
    pub held: DMatrix<f64>,
    /// E[p p'], m x m, symmetric.
    #[serde(rename = "zone", with = "As::<Rows>")]
    pub own: DMatrix<f64>,
}

/// Dual multipliers of (18) at one end of the sampling interval. n states, m inputs, d disturbances.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Moments {
    /// One for each vertex that matters; the multipliers of the others are 0.
    pub vertices: Vec<VertexDual>,
    /// E[x x(t_k^l)'], n x n.
    #[serde(with = "As::<Rows>")]
    pub state_sample: DMatrix<f64>,
    /// E[v x(t_k^l)'], n x n; `None` when the stationarity of the multiplier determines it (r = 2 of the first
    /// gain only).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Rows>>")]
    pub multiplied_sample: Option<DMatrix<f64>>,
    /// E[x(t_k^l) x(t_k^l)'], n x n, symmetric.
    #[serde(with = "As::<Rows>")]
    pub sample: DMatrix<f64>,
    /// E[v tau'], n x d.
    #[serde(with = "As::<Rows>")]
    pub multiplied_disturbance: DMatrix<f64>,
    /// E[tau tau'], d x d, symmetric.
    #[serde(with = "As::<Rows>")]
    pub disturbance: DMatrix<f64>,
    /// Moments with the held state; `None` stands for w = x(t_k^l) (no trigger error).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held: Option<HeldMoments>,
    /// Moments with the dead zone; `None` exactly where the gain is free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dead_zone: Option<DeadZoneMoments>,
}

/// Dual multiplier of one condition (19): `[ state, *; *, unit ]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InputDual {
    /// n x n, symmetric.
    #[serde(with = "As::<Rows>")]
    pub state: DMatrix<f64>,
    /// The corner.
    #[serde(with = "As::<Finite>")]
    pub unit: f64,
}

/// Dual multiplier of one condition of the region, with k rows: `[ state, cross; *, unit ]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionDual {
    /// n x n, symmetric.
    #[serde(with = "As::<Rows>")]
    pub state: DMatrix<f64>,
    /// n x k.
    #[serde(with = "As::<Rows>")]
    pub cross: DMatrix<f64>,
    /// k x k, symmetric.
    #[serde(with = "As::<Rows>")]
    pub unit: DMatrix<f64>,
}

/// Dual multipliers of the conditions of one gain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GainDuals {
    /// Number of the given gain, from 1; 1 where the gain is free.
    pub gain: usize,
    /// Dual multipliers of (18), r = 1.
    #[serde(rename = "decrease_start")]
    pub start: Moments,
    /// Dual multipliers of (18), r = 2.
    #[serde(rename = "decrease_end")]
    pub end: Moments,
    /// E[s s'] of r = 2, with the integral's coordinate s: n x n, symmetric.
    #[serde(with = "As::<Rows>")]
    pub integral: DMatrix<f64>,
    /// E[x s'] of r = 2, n x n; left out exactly for the first gain, where the stationarity of L1h and L2h
    /// determines it and the next one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Rows>>")]
    pub state_integral: Option<DMatrix<f64>>,
    /// E[x(t_k^l) s'] of r = 2, n x n.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Rows>>")]
    pub sample_integral: Option<DMatrix<f64>>,
    /// Dual multipliers of (19), one for each input.
    #[serde(rename = "anti_windup")]
    pub inputs: Vec<InputDual>,
}

/// Dual multipliers that show that no design exists, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct DualMultipliers {
    /// The given gains F_j, m x n, that no design has; empty: no constant gain has one.
    pub given: Vec<DMatrix<f64>>,
    /// The weight rho of the containment condition; above 0. Without effect when the model has no
    /// states that must be contained.
    pub containment_weight: f64,
    /// Dual multipliers of the conditions of each gain that matters: at least one, and exactly one where the gain is
    /// free.
    pub gains: Vec<GainDuals>,
    /// Dual multipliers of the region's conditions, in their order.
    pub region: Vec<RegionDual>,
    /// Dual multipliers of the containment conditions, n x n, symmetric, one for each state; empty where the rest is
    /// refuted already, which covers every rho.
    pub must_contain: Vec<DMatrix<f64>>,
}

impl DualMultipliers {
    /// True when the model's conditions hold for rule i of the plant with gain i, not for every vertex
    /// with every gain.
    pub fn is_matched(&self, model: &Model) -> bool {
        matches!(model.file.mismatch, Mismatch::Kappa(_))
            && self.given.len() > 1
            && model.plant.membership_count() == Some(self.given.len())
    }

    /// Every dual multiplier belongs to an existing condition.
    pub(super) fn fits(&self, model: &Model) -> bool {
        // Dual multipliers about a free gain prove nothing about scheduled ones.
        let constant = model.file.gains == GainForm::Constant;
        let free = self.given.is_empty();
        let matched = self.is_matched(model);
        let pairs = self.gains.iter().all(|part| {
            let mut vertices = part.start.vertices.iter().chain(&part.end.vertices);
            !matched || vertices.all(|dual| dual.vertex == part.gain)
        });
        (!free || constant) && pairs && self.check(model).is_ok()
    }

    /// Checks that every dual multiplier has its shape, and that the parts that are determined or without meaning are
    /// left out. Fields are named as in files.
    ///
    /// # Errors
    /// The first that does not fit.
    pub fn check(&self, model: &Model) -> Result<(), ModelError> {
        let system = model.plant.relaxed().takagi_sugeno();
        let sizes = Sizes {
            states: system.states(),
            inputs: system.inputs(),
            disturbances: system.disturbance.ncols(),
            vertices: system.vertices.len(),
            given: self.given.len(),
        };
        let n = sizes.states;
        check_length("region", self.region.len(), system.region.len())?;
        for (index, (dual, bound)) in self.region.iter().zip(&system.region).enumerate() {
            let field = |key: &str| format!("region[{index}].{key}");
            let k = bound.rows.nrows();
            symmetric(&field("state"), &dual.state, n)?;
            shape(&field("cross"), &dual.cross, (n, k))?;
            symmetric(&field("unit"), &dual.unit, k)?;
        }
        for (index, dual) in self.must_contain.iter().enumerate() {
            symmetric(&format!("must_contain[{index}]"), dual, n)?;
        }
        let Some((first, further)) = self.gains.split_first() else {
            return Err(missing("gain", "the dual multipliers of a gain"));
        };
        first.check(sizes)?;
        let because = match (&first.end.multiplied_sample, &first.end.held) {
            (None, _) if model.file.specs.eps[2] == 0.0 => Some("eps[2] is 0"),
            (None, None) if sizes.given > 0 => Some("there is no held state"),
            _ => None,
        };
        if let Some(because) = because {
            let expected = format!("{n} x {n}, because {because}");
            return Err(missing("decrease_end.multiplied_sample", &expected));
        }
        if first.state_integral.is_some() || first.sample_integral.is_some() {
            let expected = "nothing: it is determined by the rest";
            return Err(ModelError::shape("state_integral", "a matrix", expected));
        }
        for (index, part) in further.iter().enumerate() {
            let fits = part.check_further(sizes);
            fits.map_err(|error| error.within(&format!("further_gains[{index}]")))?;
        }
        Ok(())
    }
}

/// Sizes of a model, and how many gains are given.
#[derive(Clone, Copy)]
struct Sizes {
    states: usize,
    inputs: usize,
    disturbances: usize,
    vertices: usize,
    given: usize,
}

impl GainDuals {
    /// What the dual multipliers of every gain have.
    fn check(&self, sizes: Sizes) -> Result<(), ModelError> {
        let n = sizes.states;
        numbered("gain", self.gain, sizes.given.max(1))?;
        check_length("anti_windup", self.inputs.len(), sizes.inputs)?;
        for (index, dual) in self.inputs.iter().enumerate() {
            symmetric(&format!("anti_windup[{index}].state"), &dual.state, n)?;
        }
        self.start.check("decrease_start", sizes)?;
        self.end.check("decrease_end", sizes)?;
        let sampled = &self.start.multiplied_sample;
        required("decrease_start.multiplied_sample", sampled, n)?;
        symmetric("integral", &self.integral, n)
    }

    /// What those of a gain beyond the first have.
    fn check_further(&self, sizes: Sizes) -> Result<(), ModelError> {
        let n = sizes.states;
        self.check(sizes)?;
        let sampled = &self.end.multiplied_sample;
        required("decrease_end.multiplied_sample", sampled, n)?;
        required("state_integral", &self.state_integral, n)?;
        required("sample_integral", &self.sample_integral, n)
    }
}

impl Moments {
    fn check(&self, end: &str, sizes: Sizes) -> Result<(), ModelError> {
        let (n, m, d) = (sizes.states, sizes.inputs, sizes.disturbances);
        let field = |key: &str| format!("{end}.{key}");
        for (index, dual) in self.vertices.iter().enumerate() {
            let field = field(&format!("vertices[{index}]"));
            numbered(&format!("{field}.vertex"), dual.vertex, sizes.vertices)?;
            symmetric(&format!("{field}.moments"), &dual.moments, 2 * n)?;
        }
        let given = sizes.given > 0;
        if self.dead_zone.is_some() != given {
            let found = if given { "nothing" } else { "moments" };
            let expected = "moments of the dead zone exactly where gains are given";
            return Err(ModelError::shape(field("dead_zone"), found, expected));
        }
        let (held, zone) = (self.held.as_ref(), self.dead_zone.as_ref());
        let driven = &self.multiplied_disturbance;
        let general = [
            ("state_sample", Some(&self.state_sample), n),
            ("multiplied_sample", self.multiplied_sample.as_ref(), n),
            ("multiplied_disturbance", Some(driven), d),
            (
                "held.multiplied_held",
                held.map(|held| &held.multiplied_held),
                n,
            ),
            ("held.sample_held", held.map(|held| &held.sample_held), n),
            (
                "dead_zone.multiplied_zone",
                zone.map(|zone| &zone.multiplied),
                m,
            ),
            ("dead_zone.held_zone", zone.map(|zone| &zone.held), m),
        ];
        for (key, matrix, columns) in general {
            matrix.map_or(Ok(()), |matrix| shape(&field(key), matrix, (n, columns)))?;
        }
        let squares = [
            ("sample", Some(&self.sample), n),
            ("disturbance", Some(&self.disturbance), d),
            ("held.held", held.map(|held| &held.held), n),
            ("dead_zone.zone", zone.map(|zone| &zone.own), m),
        ];
        for (key, matrix, side) in squares {
            matrix.map_or(Ok(()), |matrix| symmetric(&field(key), matrix, side))?;
        }
        Ok(())
    }
}

/// Refuses a number that does not count one of so many things.
fn numbered(field: &str, number: usize, count: usize) -> Result<(), ModelError> {
    match (1..=count).contains(&number) {
        true => Ok(()),
        false => {
            let allowed = format!("1 to {count}");
            Err(ModelError::range(field, number as f64, allowed))
        }
    }
}

/// A key that is left out.
pub(crate) fn missing(field: &str, expected: &str) -> ModelError {
    ModelError::shape(field, "nothing", expected)
}

/// Refuses a list of another length.
pub(crate) fn check_length(field: &str, found: usize, expected: usize) -> Result<(), ModelError> {
    if found == expected {
        return Ok(());
    }
    let [found, expected] = [found, expected].map(|count| format!("{count} entries"));
    Err(ModelError::shape(field, found, expected))
}

fn shape(field: &str, matrix: &DMatrix<f64>, (r, c): (usize, usize)) -> Result<(), ModelError> {
    check_shape(field, matrix, (Some(r), Some(c)))
}

fn required(field: &str, matrix: &Option<DMatrix<f64>>, n: usize) -> Result<(), ModelError> {
    match matrix {
        Some(matrix) => shape(field, matrix, (n, n)),
        None => Err(missing(field, &format!("{n} x {n}"))),
    }
}

fn symmetric(field: &str, matrix: &DMatrix<f64>, side: usize) -> Result<(), ModelError> {
    shape(field, matrix, (side, side))?;
    check_symmetric(field, matrix)
}
