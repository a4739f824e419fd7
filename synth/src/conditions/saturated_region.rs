//! The region of attraction of a saturated state feedback.
//!
//! T. Hu, Z. Lin, B. M. Chen, "An analysis and design method for linear systems subject to actuator
//! saturation and disturbance", Automatica 38 (2002) 351-359: where |h_s x| <= ubar_s for every input s,
//! sat(F x) lies in the convex hull of the vectors whose entries are those of F x or of H x.

use nalgebra::{DMatrix, DVector};

use super::state_feedback::{
    power_of_two, DesignProblem, Proof, StateFeedback, Transformed, Units, VertexPlant,
};
use sdp::lmi::{Affine, Condition, Strictness, SymmetricBlocks};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// An ellipsoid x'Px <= 1 from which every trajectory of `x' = A(t) x + B sat(F x)` tends to 0, as large
/// as possible in the sense of a reference set.
#[derive(Debug, Clone, PartialEq)]
pub struct SaturatedRegion {
    /// Saturation level of each input, above 0.
    pub input_limit: DVector<f64>,
    /// alpha [1/s], 0 or above: inside the ellipsoid V decays at twice this rate.
    pub decay_rate: f64,
    /// What is blown up until it no longer fits.
    pub reference: ReferenceSet,
    /// (row h, bound b): the plant is the model's while |h x| <= b, so the ellipsoid stays inside.
    pub region: Vec<(DMatrix<f64>, f64)>,
}

/// A set X; the largest beta with beta X inside the ellipsoid is computed.
#[derive(Debug, Clone, PartialEq)]
pub enum ReferenceSet {
    /// x'Wx <= 1 with W symmetric positive definite, n x n.
    Ellipsoid(DMatrix<f64>),
    /// The convex hull of points, n x 1 each.
    Points(Vec<DMatrix<f64>>),
}

impl ReferenceSet {
    /// The same shape in a size of about 1, whatever the units of the state: beta is computed from P.
    fn normalised(&self) -> Self {
        match self {
            ReferenceSet::Ellipsoid(w) => ReferenceSet::Ellipsoid(w / power_of_two(w.norm())),
            ReferenceSet::Points(points) => {
                let largest = points.iter().map(DMatrix::norm).fold(0.0, f64::max);
                let unit = power_of_two(largest);
                ReferenceSet::Points(points.iter().map(|x| x / unit).collect())
            }
        }
    }
}

/// Relative allowance in the claimed beta, so that the check can prove it.
const CLAIM_ALLOWANCE: f64 = 1e-5;

/// The largest multiple of the normalised reference set that is looked for, in scaled units: the region
/// of a stable plant has no end.
const LARGEST_SCALE: f64 = 1e3;

/// The most inputs for which the 2^m choices of `F x` and `H x` are listed.
pub const MAX_SATURATED_INPUTS: usize = 8;

impl SaturatedRegion {
    /// For every choice, true where an input takes H x in place of F x.
    fn choices(&self) -> impl Iterator<Item = Vec<bool>> {
        let inputs = self.input_limit.len();
        (0..1_usize << inputs)
            .map(move |choice| (0..inputs).map(|s| choice >> s & 1 == 1).collect())
    }
}

fn name_of(vertex: usize, choice: &[bool]) -> String {
    let letters: String = choice.iter().map(|&h| if h { 'H' } else { 'F' }).collect();
    format!("decay vertex {} inputs {letters}", vertex + 1)
}

impl DesignProblem for SaturatedRegion {
    const NAME: &'static str = "saturated_region";
    const GUARANTEE: &'static str = "beta: beta times the reference set lies in the region";
    const LARGER_IS_BETTER: bool = true;
    const AUXILIARY_GAINS: &'static [&'static str] = &["saturation_gain"];

    /// The unit of the state is about what the saturated input moves in a unit of time.
    fn units(&self, plant: &VertexPlant) -> Units {
        let time = Units::of(plant, 1.0).time;
        let reach = (&plant.input * DMatrix::from_diagonal(&self.input_limit)).norm();
        let extents = self.region.iter().map(|(row, bound)| bound / row.norm());
        let state = power_of_two(extents.fold(time * reach, f64::min));
        Units {
            input: self.input_limit.map(power_of_two),
            ..Units::of(plant, state)
        }
    }

    /// Of the choice that takes every row of F x.
    fn decay_rate(&self) -> f64 {
        self.decay_rate
    }

    fn in_units(&self, units: &Units) -> Self {
        let state = units.state;
        SaturatedRegion {
            input_limit: self.input_limit.component_div(&units.input),
            decay_rate: self.decay_rate * units.time,
            reference: self.reference.normalised(),
            region: self
                .region
                .iter()
                .map(|(row, bound)| (row * (state / bound), 1.0))
                .collect(),
        }
    }

    /// With g = 1/beta^2, which is minimised:
    ///
    /// ```text
    /// A_i Q + Q A_i' + B Y_c + Y_c'B' + 2 alpha Q < 0   for every choice c of the rows of Y = F Q and Z = H Q,
    /// [ Q, z_s' ; *, ubar_s^2 ] >= 0,   [ Q, Q h' ; *, b^2 ] >= 0,
    /// [ g W, I ; *, Q ] >= 0   or   [ g, x' ; *, Q ] >= 0 for every point x.
    /// ```
    fn conditions(
        &self,
        plant: &VertexPlant,
        transformed: &Transformed,
        strictness: &Strictness,
    ) -> Vec<Condition> {
        let n = plant.states();
        let (q, y, z) = (
            &transformed.inverse,
            &transformed.gain,
            &transformed.auxiliary[0],
        );
        let mut out = vec![strictness.positive("inverse positive", q.clone())];
        for (vertex, a) in plant.vertices.iter().enumerate() {
            for choice in self.choices() {
                let taken = DVector::from_fn(choice.len(), |s, _| f64::from(u8::from(choice[s])));
                let from_h = DMatrix::from_diagonal(&taken);
                let from_f = DMatrix::from_diagonal(&taken.map(|share| 1.0 - share));
                let mixed = from_f * y + from_h * z;
                let decay = transformed.decay(a, &plant.input, &mixed, self.decay_rate);
                out.push(strictness.positive(name_of(vertex, &choice), -decay));
            }
        }
        let mut within = |name: String, column: Affine, bound: f64| {
            let corner = Affine::identity(1, bound * bound);
            let lhs = SymmetricBlocks::of(&[&[q, &column], &[&corner]]);
            out.push(strictness.positive(name, lhs));
        };
        for (s, &limit) in self.input_limit.iter().enumerate() {
            within(
                format!("limit input {}", s + 1),
                z.row(s).transposed(),
                limit,
            );
        }
        for (index, (row, bound)) in self.region.iter().enumerate() {
            within(
                format!("box row {}", index + 1),
                q * &row.transpose(),
                *bound,
            );
        }
        out.extend(self.containment(n, transformed));
        let least = Affine::identity(1, LARGEST_SCALE.powi(-2));
        out.push(Condition::semidefinite(
            "largest scale",
            &transformed.objective - &least,
        ));
        out
    }

    fn claim(&self, found: &mut StateFeedback, _objective: f64, _units: &Units) {
        let p = &found.lyapunov;
        let largest = match &self.reference {
            ReferenceSet::Ellipsoid(w) => match w.clone().cholesky() {
                Some(factor) => {
                    let l = factor.l();
                    let half = l.solve_lower_triangular(p).map(|x| x.transpose());
                    let whole = half.and_then(|half| l.solve_lower_triangular(&half));
                    whole.map_or(f64::NAN, |matrix| matrix.symmetric_eigenvalues().max())
                }
                None => f64::NAN,
            },
            ReferenceSet::Points(points) => {
                let values = points.iter().map(|x| (x.transpose() * p * x)[(0, 0)]);
                values.fold(0.0, f64::max)
            }
        };
        found.guarantee = (1.0 - CLAIM_ALLOWANCE) / largest.sqrt();
    }

    fn statements<S: Scalar>(&self, proof: &Proof<S>, emit: &mut dyn FnMut(String, Matrix<S>)) {
        let rate = S::from_f64(self.decay_rate);
        let h = &proof.auxiliary[0];
        emit("lyapunov positive".into(), proof.lyapunov.clone());
        for (vertex, a) in proof.vertices.iter().enumerate() {
            for choice in self.choices() {
                let mixed = Matrix::from_fn(h.nrows(), h.ncols(), |s, c| match choice[s] {
                    true => h.at(s, c).clone(),
                    false => proof.gain.at(s, c).clone(),
                });
                emit(name_of(vertex, &choice), proof.decay(a, &mixed, &rate));
            }
        }
        for (s, &limit) in self.input_limit.iter().enumerate() {
            emit(
                format!("limit input {}", s + 1),
                proof.within(&h.row(s), limit),
            );
        }
        for (index, (row, bound)) in self.region.iter().enumerate() {
            let row = Matrix::exactly(row);
            emit(format!("box row {}", index + 1), proof.within(&row, *bound));
        }
        let square = proof.guarantee.clone() * proof.guarantee.clone();
        match &self.reference {
            ReferenceSet::Ellipsoid(w) => {
                let room = Matrix::exactly(w).minus(&proof.lyapunov.scaled(&square));
                emit("contains reference ellipsoid".into(), room);
            }
            ReferenceSet::Points(points) => {
                for (index, point) in points.iter().enumerate() {
                    let point = Matrix::exactly(point);
                    let value = point.transposed().times(&proof.lyapunov).times(&point);
                    let room = S::one() - square.clone() * value.at(0, 0).clone();
                    let name = format!("contains reference point {}", index + 1);
                    emit(name, Matrix::identity(1, room));
                }
            }
        }
    }

    fn assumptions(&self) -> Vec<String> {
        let mut out = vec!["a start in the region x'Px <= 1".to_string()];
        out.push("inputs that saturate at their limits and not below".to_string());
        out
    }
}

impl SaturatedRegion {
    fn containment(&self, n: usize, transformed: &Transformed) -> Vec<Condition> {
        let contains = |name: String, corner: Affine, columns: &DMatrix<f64>| {
            let beside = Affine::constant(&columns.transpose());
            let lhs = SymmetricBlocks::of(&[&[&corner, &beside], &[&transformed.inverse]]);
            Condition::semidefinite(name, lhs)
        };
        match &self.reference {
            ReferenceSet::Ellipsoid(w) => vec![contains(
                "contains reference ellipsoid".to_string(),
                transformed.objective.times_matrix(w),
                &DMatrix::identity(n, n),
            )],
            ReferenceSet::Points(points) => {
                let numbered = points.iter().enumerate().map(|(index, point)| {
                    let name = format!("contains reference point {}", index + 1);
                    contains(name, transformed.objective.clone(), point)
                });
                numbered.collect()
            }
        }
    }
}
