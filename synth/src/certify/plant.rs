//! The plant in the form the proof uses: `E x' = A_i x + B sat(u) + B_w tau`.
//!
//! For the rigid spacecraft the equation of motion is kept multiplied by E = diag(J, I), so that the
//! inertia enters as the doubles of the file and its inverse never does.
//!
//! An uncertain inertia gives one such plant for each vertex of its set ([`DescriptorPlant::each_inertia`]).

pub use crate::fuzzy::inertia_bounds;

use nalgebra::{DMatrix, Vector4};

use crate::fuzzy::{
    exact_inertia, inertia_vertices, ExactSpacecraft, RuleModel, VertexSystem, SPACECRAFT_VERTICES,
};
use crate::model::Plant;
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// One bound of the region, `|rows x|^2 <= bound_squared`.
#[derive(Debug, Clone)]
pub struct RegionBound<S> {
    /// What is bounded.
    pub name: String,
    /// k x n.
    pub rows: Matrix<S>,
    /// Square of the bound.
    pub bound_squared: S,
}

/// The plant's matrices over a [`Scalar`]; every entry encloses the exact value for the doubles of
/// the file.
#[derive(Debug, Clone)]
pub struct DescriptorPlant<S> {
    /// E, n x n.
    pub descriptor: Matrix<S>,
    /// A_i, n x n each.
    pub vertices: Vec<Matrix<S>>,
    /// B, n x m.
    pub input: Matrix<S>,
    /// B_w, n x d.
    pub disturbance: Matrix<S>,
    /// C, p x n.
    pub output: Matrix<S>,
    /// Saturation levels.
    pub input_limit: Vec<S>,
    /// Bound on the norm of the disturbance.
    pub disturbance_bound: S,
    /// Bounds of the region.
    pub region: Vec<RegionBound<S>>,
}

impl<S: Scalar> DescriptorPlant<S> {
    /// The plants at the vertices of the inertia's set; for an inertia that is known, or a plant without
    /// one, the plant of [`DescriptorPlant::new`] alone.
    pub fn each_inertia(plant: &Plant) -> Vec<Self> {
        let Plant::Spacecraft(craft) = plant else {
            return vec![DescriptorPlant::new(plant)];
        };
        let vertices = inertia_vertices(craft);
        vertices
            .iter()
            .map(|inertia| spacecraft(craft, inertia))
            .collect()
    }

    /// The plant of a model; where its inertia is uncertain, that with the nominal one.
    pub fn new(plant: &Plant) -> Self {
        match plant {
            Plant::Spacecraft(craft) => spacecraft(craft, &exact_inertia(&craft.inertia)),
            Plant::Vertices(system) => vertex_system(system),
            Plant::Rules(rules) => rule_model(rules),
        }
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        self.input.nrows()
    }

    /// The plant of a model solved for x': A_i, B and B_w multiplied by E^-1, E the identity.
    ///
    /// An inertia so close to singular that its inverse cannot be bounded gives unbounded entries,
    /// which make every proof fail that uses them.
    pub fn explicit(plant: &Plant) -> Self {
        let implicit = DescriptorPlant::new(plant);
        // Only a rigid body is kept multiplied by its inertia.
        if plant.inertia().is_none() {
            return implicit;
        }
        let inverse = inverse_of_descriptor(&implicit.descriptor);
        DescriptorPlant {
            descriptor: Matrix::identity(implicit.states(), S::one()),
            vertices: implicit
                .vertices
                .iter()
                .map(|vertex| inverse.times(vertex))
                .collect(),
            input: inverse.times(&implicit.input),
            disturbance: inverse.times(&implicit.disturbance),
            ..implicit
        }
    }
}

/// Inverse of diag(J, I), by the adjugate of the 3 x 3 block J.
fn inverse_of_descriptor<S: Scalar>(descriptor: &Matrix<S>) -> Matrix<S> {
    let at = |r: usize, c: usize| descriptor.at(r % 3, c % 3).clone();
    // Indices modulo 3 carry the cofactors' signs.
    let cofactor = |r: usize, c: usize| {
        at(r + 1, c + 1) * at(r + 2, c + 2) - at(r + 1, c + 2) * at(r + 2, c + 1)
    };
    let determinant = (0..3).fold(S::zero(), |sum, c| sum + at(0, c) * cofactor(0, c));
    let mut out = Matrix::identity(descriptor.nrows(), S::one());
    for row in 0..3 {
        for column in 0..3 {
            out.set(row, column, cofactor(column, row) / determinant.clone());
        }
    }
    out
}

fn spacecraft<S: Scalar>(craft: &ExactSpacecraft, inertia: &Matrix<S>) -> DescriptorPlant<S> {
    let corners = (0..SPACECRAFT_VERTICES).map(|vertex| craft.corner(vertex));
    let places: Vec<Vector4<f64>> = corners.collect();
    DescriptorPlant {
        input_limit: exact_limits(craft.torque_limit.iter()),
        disturbance_bound: S::from_f64(craft.disturbance_bound),
        region: spacecraft_region(craft),
        ..rigid_body(inertia, &places)
    }
}

fn exact_limits<'a, S: Scalar>(limits: impl Iterator<Item = &'a f64>) -> Vec<S> {
    limits.map(|&limit| S::from_f64(limit)).collect()
}

/// The rigid body with A frozen at the given (omega, q0); no limits, no disturbance, no region.
fn rigid_body<S: Scalar>(inertia: &Matrix<S>, places: &[Vector4<f64>]) -> DescriptorPlant<S> {
    let mut descriptor = Matrix::identity(6, S::one());
    let mut input = Matrix::zeros(6, 3);
    for row in 0..3 {
        input.set(row, row, S::one());
        for column in 0..3 {
            descriptor.set(row, column, inertia.at(row, column).clone());
        }
    }
    DescriptorPlant {
        descriptor,
        vertices: places
            .iter()
            .map(|place| frozen_matrix(place, inertia))
            .collect(),
        disturbance: input.clone(),
        input,
        output: Matrix::identity(6, S::one()),
        input_limit: Vec::new(),
        disturbance_bound: S::zero(),
        region: Vec::new(),
    }
}

/// [ -omega^x J, 0 ; 1/2 q0 I, -1/2 omega^x ] at (omega, q0).
fn frozen_matrix<S: Scalar>(corner: &Vector4<f64>, inertia: &Matrix<S>) -> Matrix<S> {
    let rate = |axis: usize| S::from_f64(corner[axis]);
    let spin = Matrix::from_fn(3, 3, |r, c| match (r, c) {
        (0, 1) => -rate(2),
        (0, 2) => rate(1),
        (1, 0) => rate(2),
        (1, 2) => -rate(0),
        (2, 0) => -rate(1),
        (2, 1) => rate(0),
        _ => S::zero(),
    });
    let gyroscopic = spin.times(inertia);
    let half = S::from_f64(0.5);
    let attitude = half.clone() * S::from_f64(corner[3]);
    Matrix::from_fn(6, 6, |r, c| match (r < 3, c < 3) {
        (true, true) => -gyroscopic.at(r, c).clone(),
        (true, false) => S::zero(),
        (false, true) if r - 3 == c => attitude.clone(),
        (false, true) => S::zero(),
        (false, false) => -(half.clone() * spin.at(r - 3, c - 3).clone()),
    })
}

fn spacecraft_region<S: Scalar>(craft: &ExactSpacecraft) -> Vec<RegionBound<S>> {
    let unit =
        |axis: usize| Matrix::from_fn(1, 6, |_, c| if c == axis { S::one() } else { S::zero() });
    let rates = (0..3).map(|axis| {
        let bound = S::from_f64(craft.rate_bound[axis]);
        RegionBound {
            name: format!("rate axis {}", axis + 1),
            rows: unit(axis),
            bound_squared: bound.clone() * bound,
        }
    });
    let scalar_part = S::from_f64(craft.scalar_part_min);
    let attitude = RegionBound {
        name: "attitude".to_string(),
        rows: Matrix::from_fn(3, 6, |r, c| if c == r + 3 { S::one() } else { S::zero() }),
        bound_squared: S::one() - scalar_part.clone() * scalar_part,
    };
    rates.chain([attitude]).collect()
}

fn vertex_system<S: Scalar>(system: &VertexSystem) -> DescriptorPlant<S> {
    let exactly = |matrix: &DMatrix<f64>| Matrix::exactly(matrix);
    let region = (0..system.box_rows.nrows()).map(|row| {
        let bound = S::from_f64(system.box_bounds[row]);
        RegionBound {
            name: format!("box row {}", row + 1),
            rows: exactly(&system.box_rows.rows(row, 1).into_owned()),
            bound_squared: bound.clone() * bound,
        }
    });
    DescriptorPlant {
        descriptor: Matrix::identity(system.input_matrix.nrows(), S::one()),
        vertices: system.state_matrices.iter().map(exactly).collect(),
        input: exactly(&system.input_matrix),
        disturbance: exactly(&system.disturbance_matrix),
        output: exactly(&system.output_matrix),
        input_limit: exact_limits(system.input_limit.iter()),
        disturbance_bound: S::from_f64(system.disturbance_bound),
        region: region.collect(),
    }
}

/// For a spacecraft the inertia stays on the left-hand side here too.
fn rule_model<S: Scalar>(rules: &RuleModel) -> DescriptorPlant<S> {
    let mut common = vertex_system(&rules.system);
    for (index, bound) in common.region.iter_mut().enumerate() {
        bound.name = format!("state {}", index + 1);
    }
    match &rules.inertia {
        None => common,
        Some(inertia) => DescriptorPlant {
            input_limit: common.input_limit,
            disturbance_bound: common.disturbance_bound,
            region: common.region,
            ..rigid_body(&exact_inertia(inertia), &rules.frozen_at)
        },
    }
}
