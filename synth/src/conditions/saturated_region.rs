//! The region of attraction of a saturated state feedback.
//!
//! T. Hu, Z. Lin, B. M. Chen, "An analysis and design method for linear systems subject to actuator
//! saturation and disturbance", Automatica 38 (2002) 351-359: where |h_s x| <= ubar_s for every input s,
//! sat(F x) lies in the convex hull of the vectors whose entries are those of F x or of H x.

use nalgebra::{DMatrix, DVector};

use super::state_feedback::{
    DesignProblem, Floor, Inequality, Proof, StateFeedback, Transformed, VertexPlant,
};
use super::units::{power_of_two, Sizes, Units};
use crate::riccati::{lyapunov, spectral_radius};
use sdp::lmi::{Affine, SymmetricBlocks};
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
    /// The set in other units, with beta in the unit `objective^(-1/2)`.
    fn in_units(&self, units: &Units) -> Self {
        match self {
            ReferenceSet::Ellipsoid(w) => {
                ReferenceSet::Ellipsoid(units.weighing(w) * units.objective)
            }
            ReferenceSet::Points(points) => {
                let factor = 1.0 / units.objective.sqrt();
                ReferenceSet::Points(points.iter().map(|x| units.driving(x) * factor).collect())
            }
        }
    }

    /// About 1/beta^2 for the ellipsoid `{x: x'G^+ x <= 1}`: the mean of the squares along the axes of the set.
    fn objective_within(&self, gram: &DMatrix<f64>) -> f64 {
        match self {
            ReferenceSet::Ellipsoid(w) => w.nrows() as f64 / (w * gram).trace(),
            ReferenceSet::Points(points) => {
                let sum = points.iter().map(|x| x * x.transpose());
                let sum = sum.reduce(|a, b| a + b);
                let inverse = sum.and_then(|sum| {
                    let size = sum.norm();
                    let inverse = (sum / size).pseudo_inverse(1e-12).ok()?;
                    Some(inverse / size)
                });
                let rank = points.len().min(gram.nrows()) as f64;
                inverse.map_or(f64::NAN, |inverse| rank / (inverse * gram).trace())
            }
        }
    }
}

/// Relative allowance in the claimed beta, so that the check can prove it.
const CLAIM_ALLOWANCE: f64 = 1e-5;

/// The largest multiple of the reference set that is looked for, in units of what the saturated input can reach: the
/// region of a stable plant has no end.
const LARGEST_SCALE: f64 = 1e3;

/// What is added to a feedback that just reaches its limits at the edge of the region, in units of the limits.
const QUICKENING: f64 = 2.0;

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
    const OBJECTIVE: &'static str = "1/beta^2";
    const GUARANTEE: &'static str = "beta: beta times the reference set lies in the region";
    const LARGER_IS_BETTER: bool = true;
    const AUXILIARY_GAINS: &'static [&'static str] = &["saturation_gain"];
    /// The choice that takes every row of Z is one of the conditions, so F = H satisfies all of them.
    const GAIN_IS_AUXILIARY: bool = true;

    /// Where nothing is known yet, the largest state unit is about what the saturated input moves in a unit of time.
    fn units(&self, plant: &VertexPlant, sizes: &Sizes) -> Units {
        let limits = self.input_limit.map(power_of_two);
        if let Some(objective) = sizes.objective {
            return Units {
                input: limits,
                objective: power_of_two(objective),
                ..Units::of(plant, sizes)
            };
        }
        let first = Units::of(plant, sizes);
        let input = &plant.input * DMatrix::from_diagonal(&self.input_limit);
        let reach = first.time * first.driving(&input).norm();
        let extents = self.region.iter();
        let extents = extents.map(|(row, bound)| bound / first.reading(row).norm());
        let sizes = sizes.clone().times(extents.fold(reach, f64::min));
        let units = Units::of(plant, &sizes);
        let within = DMatrix::from_diagonal(&units.state.component_mul(&units.state));
        Units {
            input: limits,
            objective: power_of_two(self.reference.objective_within(&within)),
            ..units
        }
    }

    /// `F = H - K B'P` with a diagonal K >= 0: whichever rows a choice takes from F, it adds `-2 P B K E B'P <= 0` to the
    /// conditions of H. On the ellipsoid |b_s'P x| is at most `(b_s'P b_s)^(1/2)`.
    fn quickened(
        &self,
        plant: &VertexPlant,
        lyapunov: &DMatrix<f64>,
        auxiliary: &DMatrix<f64>,
    ) -> DMatrix<f64> {
        let inward = plant.input.transpose() * lyapunov;
        let reach = (&inward * &plant.input).diagonal();
        let gains = self
            .input_limit
            .zip_map(&reach, |limit, square| match square > 0.0 {
                true => QUICKENING * limit / square.sqrt(),
                false => 0.0,
            });
        auxiliary - DMatrix::from_diagonal(&gains) * inward
    }

    /// Of the choice that takes every row of F x.
    fn decay_rate(&self) -> f64 {
        self.decay_rate
    }

    fn in_units(&self, units: &Units) -> Self {
        let region = self.region.iter();
        SaturatedRegion {
            input_limit: self.input_limit.component_div(&units.input),
            decay_rate: self.decay_rate * units.time,
            reference: self.reference.in_units(units),
            region: region
                .map(|(row, bound)| (units.reading(row) / *bound, 1.0))
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
    fn conditions(&self, plant: &VertexPlant, transformed: &Transformed) -> Vec<Inequality> {
        let n = plant.states();
        let (q, y, z) = (
            &transformed.inverse,
            &transformed.gain,
            &transformed.auxiliary[0],
        );
        let mut out = vec![Inequality::strict("inverse positive", q.clone())];
        // Without a given feedback F = H, and all choices are the same.
        let choices = match plant.gain {
            Some(_) => usize::MAX,
            None => 1,
        };
        for (vertex, a) in plant.vertices.iter().enumerate() {
            for choice in self.choices().take(choices) {
                let taken = DVector::from_fn(choice.len(), |s, _| f64::from(u8::from(choice[s])));
                let from_h = DMatrix::from_diagonal(&taken);
                let from_f = DMatrix::from_diagonal(&taken.map(|share| 1.0 - share));
                let mixed = from_f * y + from_h * z;
                let decay = transformed.decay(a, &plant.input, &mixed, self.decay_rate);
                out.push(Inequality::strict(name_of(vertex, &choice), -decay));
            }
        }
        let mut within = |name: String, column: Affine, bound: f64| {
            let corner = Affine::identity(1, bound * bound);
            let lhs = SymmetricBlocks::of(&[&[q, &column], &[&corner]]);
            out.push(Inequality::strict(name, lhs));
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
        out
    }

    fn guarantee_of(objective: f64) -> f64 {
        1.0 / objective.sqrt()
    }

    fn objective_of(guarantee: f64) -> f64 {
        1.0 / (guarantee * guarantee)
    }

    /// Of `LARGEST_SCALE` times the ellipsoid of six times the Gramian of the plant at full input, shifted by twice the
    /// largest natural frequency s of the mean vertex (1/s where that is 0), per s: for `x' = -s x + b u` the point b
    /// ubar / s at which it comes to rest.
    fn floor(&self, plant: &VertexPlant) -> Option<Floor> {
        let n = plant.states();
        let mean = plant.mean();
        let radius = spectral_radius(&mean).max(self.decay_rate);
        let rate = if radius > 0.0 { radius } else { 1.0 };
        let input = &plant.input * DMatrix::from_diagonal(&self.input_limit);
        let driven = (6.0 / rate) * &input * input.transpose();
        let units = Units::of(plant, &Sizes::of(plant, self.decay_rate));
        let shifted = units.reading(&units.driving(&(mean - 2.0 * rate * DMatrix::identity(n, n))));
        let gram = lyapunov(&shifted.transpose(), &units.unweighed(&driven))?;
        let objective = self.reference.objective_within(&units.weighing(&gram));
        Some(Floor {
            name: "largest scale",
            objective: objective / (LARGEST_SCALE * LARGEST_SCALE),
        })
    }

    fn claim(&self, found: &mut StateFeedback, _objective: f64) {
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
    fn containment(&self, n: usize, transformed: &Transformed) -> Vec<Inequality> {
        let contains = |name: String, corner: Affine, columns: &DMatrix<f64>| {
            let beside = Affine::constant(&columns.transpose());
            let lhs = SymmetricBlocks::of(&[&[&corner, &beside], &[&transformed.inverse]]);
            Inequality::weak(name, lhs)
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
