//! The plant in the form the proof uses: `E x' = A_i x + B sat(u) + B_w tau`.
//!
//! For the rigid spacecraft the equation of motion is kept multiplied by E = diag(J, I), so that the
//! inertia enters as the doubles of the file and its inverse never does.
//!
//! An uncertain inertia gives one such plant for each vertex of its set ([`DescriptorPlant::each_inertia`]).

pub use crate::fuzzy::inertia_bounds;

use nalgebra::{DMatrix, Matrix3, Vector4};

use crate::fuzzy::{
    exact_inertia, inertia_vertices, pairs, ExactSpacecraft, InertiaExtremes, RuleModel,
    VertexSystem, WheelMomentum, ROUNDED_AXES,
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
    let limits = ExchangeLimits::<S>::of(craft);
    let zero = Matrix3::zeros();
    let form = exact_inertia(craft.gyroscopic_form.as_ref().unwrap_or(&zero));
    let (momenta, corners) = (limits.corners(craft), craft.corners());
    let vertices = pairs(&momenta, &corners)
        .map(|(momentum, corner)| frozen_matrix(corner, inertia, &form, momentum));
    DescriptorPlant {
        input_limit: exact_limits(craft.torque_limit.iter()),
        disturbance_bound: S::from_f64(craft.disturbance_bound) + limits.further_torque(craft),
        region: spacecraft_region(craft),
        vertices: vertices.collect(),
        output: Matrix::from_fn(6, 6, |r, c| match r == c {
            true => S::from_f64(craft.output_weights[r]),
            false => S::zero(),
        }),
        ..rigid_body(inertia, &[])
    }
}

/// Bounds on the inertias of a spacecraft's set, as far as a moving reference needs them. They are doubles a little
/// beyond the numbers that they bound, which [`ExchangeLimits::statements`] shows.
struct ExchangeLimits<S> {
    /// Below every principal moment.
    smallest: S,
    /// Above every principal moment.
    largest: S,
    /// Above |tr(J) I - 2 J|.
    coupling: S,
}

/// How far a bound lies beyond a number that was rounded to nearest, relative to the largest moment.
const BEYOND: f64 = 1e-9;

impl<S: Scalar> ExchangeLimits<S> {
    fn of(craft: &ExactSpacecraft) -> Self {
        let set = &craft.inertia_uncertainty;
        let extremes = InertiaExtremes::of(&set.vertices(&craft.inertia));
        let beyond = BEYOND * extremes.largest;
        ExchangeLimits {
            smallest: S::from_f64(extremes.smallest - beyond),
            largest: S::from_f64(extremes.largest + beyond),
            coupling: S::from_f64(extremes.coupling + beyond),
        }
    }

    /// The bounds hold at every vertex of the inertia's set, hence for all of it.
    fn statements(&self, inertia: &Matrix<S>) -> [(&'static str, Matrix<S>); 4] {
        let trace = (0..3).fold(S::zero(), |sum, k| sum + inertia.at(k, k).clone());
        let unit = |value: &S| Matrix::identity(3, value.clone());
        let twice = inertia.plus(inertia);
        let difference = unit(&trace).minus(&twice);
        [
            (
                "above the smallest moment",
                inertia.minus(&unit(&self.smallest)),
            ),
            (
                "below the largest moment",
                unit(&self.largest).minus(inertia),
            ),
            ("coupling above", unit(&self.coupling).minus(&difference)),
            ("coupling below", unit(&self.coupling).plus(&difference)),
        ]
    }

    /// The corners of a polytope that contains every h_eff = h + (2 J - tr(J) I) omega_r [N m s].
    fn corners(&self, craft: &ExactSpacecraft) -> Vec<[S; 3]> {
        let exchange = &craft.exchange;
        let moving = S::from_f64(exchange.reference_rate) * self.coupling.clone();
        let widths: [S; 3] = match exchange.wheels {
            None => [S::zero(), S::zero(), S::zero()],
            Some(WheelMomentum::Norm(bound)) => [bound; 3].map(S::from_f64),
            Some(WheelMomentum::PerAxis(bounds)) => bounds.map(S::from_f64),
        };
        let widths = widths.map(|width| width + moving.clone());
        let corner = |direction: [f64; 3]| {
            std::array::from_fn(|axis| S::from_f64(direction[axis]) * widths[axis].clone())
        };
        exchange.directions().into_iter().map(corner).collect()
    }

    /// `rho^2 (l_max - l_min) / 2 + rho |h| + l_max a` and the rounding of the torque: a bound on the norm of the torques
    /// beside command and disturbance [N m].
    fn further_torque(&self, craft: &ExactSpacecraft) -> S {
        let exchange = &craft.exchange;
        let rate = S::from_f64(exchange.reference_rate);
        let wheels = match exchange.wheels {
            None => S::zero(),
            Some(WheelMomentum::Norm(bound)) => S::from_f64(bound),
            // The sum is above the norm.
            Some(WheelMomentum::PerAxis(bounds)) => {
                let bounds = bounds.map(S::from_f64).into_iter();
                bounds.fold(S::zero(), |sum, bound| sum + bound)
            }
        };
        let spread = (self.largest.clone() - self.smallest.clone()) * S::from_f64(0.5);
        rate.clone() * rate.clone() * spread
            + rate * wheels
            + self.largest.clone() * S::from_f64(exchange.reference_acceleration)
            + S::from_f64(ROUNDED_AXES) * S::from_f64(exchange.torque_quantum)
    }
}

/// What the effect of a moving reference on the vertices and on the disturbance bound relies on; nothing without one.
pub fn reference_statements<S: Scalar>(plant: &Plant) -> Vec<(String, Matrix<S>)> {
    let Plant::Spacecraft(craft) = plant else {
        return Vec::new();
    };
    let exchange = &craft.exchange;
    if exchange.reference_rate == 0.0 && exchange.reference_acceleration == 0.0 {
        return Vec::new();
    }
    let limits = ExchangeLimits::<S>::of(craft);
    let inertias = inertia_vertices(craft);
    let numbered = inertias.iter().enumerate();
    let statements = numbered.flat_map(|(index, inertia)| {
        let named = limits.statements(inertia).into_iter();
        named.map(move |(name, matrix)| (format!("reference {name} {}", index + 1), matrix))
    });
    statements.collect()
}

fn exact_limits<'a, S: Scalar>(limits: impl Iterator<Item = &'a f64>) -> Vec<S> {
    limits.map(|&limit| S::from_f64(limit)).collect()
}

/// The rigid body with A frozen at the given (omega, q0); no limits, no disturbance, no region.
fn rigid_body<S: Scalar>(inertia: &Matrix<S>, places: &[Vector4<f64>]) -> DescriptorPlant<S> {
    let zeros = Matrix::zeros(3, 3);
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
            .map(|place| frozen_matrix(place, inertia, &zeros, &[S::zero(), S::zero(), S::zero()]))
            .collect(),
        disturbance: input.clone(),
        input,
        output: Matrix::identity(6, S::one()),
        input_limit: Vec::new(),
        disturbance_bound: S::zero(),
        region: Vec::new(),
    }
}

/// The skew matrix v^x with v^x w = v x w.
fn skew<S: Scalar>(vector: &[S; 3]) -> Matrix<S> {
    let entry = |axis: usize| vector[axis].clone();
    Matrix::from_fn(3, 3, |r, c| match (r, c) {
        (0, 1) => -entry(2),
        (0, 2) => entry(1),
        (1, 0) => entry(2),
        (1, 2) => -entry(0),
        (2, 0) => -entry(1),
        (2, 1) => entry(0),
        _ => S::zero(),
    })
}

/// [ -omega^x J + K omega^x + h^x, 0 ; 1/2 q0 I, -1/2 omega^x ] at (omega, q0) with a momentum h.
fn frozen_matrix<S: Scalar>(
    corner: &Vector4<f64>,
    inertia: &Matrix<S>,
    form: &Matrix<S>,
    momentum: &[S; 3],
) -> Matrix<S> {
    let spin = skew(&[0, 1, 2].map(|axis| S::from_f64(corner[axis])));
    let gyroscopic = form.times(&spin).minus(&spin.times(inertia));
    let gyroscopic = gyroscopic.plus(&skew(momentum));
    let half = S::from_f64(0.5);
    let attitude = half.clone() * S::from_f64(corner[3]);
    Matrix::from_fn(6, 6, |r, c| match (r < 3, c < 3) {
        (true, true) => gyroscopic.at(r, c).clone(),
        (true, false) => S::zero(),
        (false, true) if r - 3 == c => attitude.clone(),
        (false, true) => S::zero(),
        (false, false) => -(half.clone() * spin.at(r - 3, c - 3).clone()),
    })
}

/// [omega^x, 0], which gives 0 when it is multiplied by x = [omega; q], at every vertex of a spacecraft's plant with one
/// inertia, in the order of [`DescriptorPlant::vertices`].
pub fn annihilators<S: Scalar>(craft: &ExactSpacecraft) -> Vec<Matrix<S>> {
    let momenta = ExchangeLimits::<S>::of(craft).corners(craft);
    let corners = craft.corners();
    let frozen = pairs(&momenta, &corners).map(|(_, corner)| {
        let spin = skew(&[0, 1, 2].map(|axis| S::from_f64(corner[axis])));
        Matrix::from_fn(3, 6, |r, c| match c < 3 {
            true => spin.at(r, c).clone(),
            false => S::zero(),
        })
    });
    frozen.collect()
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
            name: format!("row {}", row + 1),
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
