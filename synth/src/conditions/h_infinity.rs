//! H-infinity state feedback: the smallest L2 gain from a disturbance to an output.
//!
//! The bounded real lemma with Q = P^-1, Y = F Q: P. Gahinet, P. Apkarian, "A linear matrix inequality
//! approach to H-infinity control", Int. J. Robust and Nonlinear Control 4 (1994) 421-448; Boyd et al.,
//! "Linear Matrix Inequalities in System and Control Theory", SIAM 1994, section 7.5.

use nalgebra::DMatrix;

use super::bounded_real::{reference_gain, BoundedReal, Signals};
use super::state_feedback::{
    DesignProblem, Direct, Floor, Inequality, Proof, StateFeedback, Transformed, VertexPlant,
    Wanted,
};
use super::units::{power_of_two, Sizes, Units};
use sdp::lmi::{Affine, SymmetricBlocks};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// `x' = A(t) x + B u + B_w w`, `z = C x + D u + D_w w`: the L2 norm of z is below gamma times that of w,
/// from rest, for every A(t) in the hull.
#[derive(Debug, Clone, PartialEq)]
pub struct HInfinity {
    /// B_w, n x d.
    pub disturbance: DMatrix<f64>,
    /// C, p x n.
    pub output: DMatrix<f64>,
    /// D, p x m.
    pub input_to_output: DMatrix<f64>,
    /// D_w, p x d.
    pub disturbance_to_output: DMatrix<f64>,
    /// What is asked of gamma.
    pub wanted: Wanted,
}

/// The search for the smallest gain stops at this part of the gain without control, or with a linear-quadratic
/// regulator: the infimum may be 0.
pub const FLOOR: f64 = 1e-3;

/// A search that needs a gain of at most a number aims at this part of it.
const WELL_BELOW: f64 = 0.998;

/// Columns of D this far below the largest singular value, relative, count as dependent.
const RANK_TOLERANCE: f64 = 1e-10;

impl HInfinity {
    /// The signals and the plant in the units for numbers of given sizes.
    fn in_sizes<'a>(
        &'a self,
        plant: &'a VertexPlant,
    ) -> impl Fn(&Sizes) -> (Units, Signals, VertexPlant) + 'a {
        move |sizes| {
            let units = self.units(plant, sizes);
            let scaled = self.in_units(&units);
            let signals = Signals {
                disturbance: scaled.disturbance,
                output: scaled.output,
                input_to_output: scaled.input_to_output,
                disturbance_to_output: scaled.disturbance_to_output,
            };
            let plant = plant.in_units(&units);
            (units, signals, plant)
        }
    }

    /// True where D has full column rank.
    fn sees_every_input(&self) -> bool {
        let columns = self.input_to_output.ncols();
        let scaled = self.input_to_output.clone();
        let sizes: Vec<f64> = scaled.column_iter().map(|column| column.norm()).collect();
        let unit = DMatrix::from_fn(scaled.nrows(), columns, |r, c| scaled[(r, c)] / sizes[c]);
        sizes.iter().all(|&size| size > 0.0) && unit.rank(RANK_TOLERANCE) == columns
    }
}

impl DesignProblem for HInfinity {
    const NAME: &'static str = "h_infinity";
    const OBJECTIVE: &'static str = "gamma";
    const GUARANTEE: &'static str = "gamma: |z| < gamma |w| in L2, from rest";

    /// Where gamma is known, `Q_ii` and gamma become about 1.
    fn units(&self, plant: &VertexPlant, sizes: &Sizes) -> Units {
        let units = Units::of(plant, sizes);
        let (disturbance, output) = match sizes.objective {
            Some(gamma) => (
                (units.time * gamma).recip().sqrt(),
                (gamma / units.time).sqrt(),
            ),
            None => (
                1.0 / (units.time * units.driving(&self.disturbance).norm()),
                units.reading(&self.output).norm(),
            ),
        };
        let (disturbance, output) = (power_of_two(disturbance), power_of_two(output));
        Units {
            disturbance,
            output,
            objective: output / disturbance,
            energy: units.time * disturbance * output,
            ..units
        }
    }

    /// The first diagonal block of the bounded real lemma asks for no rate.
    fn decay_rate(&self) -> f64 {
        0.0
    }

    fn in_units(&self, units: &Units) -> Self {
        let inputs = DMatrix::from_diagonal(&units.input);
        let disturbance = units.disturbance;
        let in_gamma = |gamma: Option<f64>| gamma.map(|gamma| gamma / units.objective);
        HInfinity {
            disturbance: units.driving(&self.disturbance) * (units.time * disturbance),
            output: units.reading(&self.output) / units.output,
            input_to_output: &self.input_to_output * inputs / units.output,
            disturbance_to_output: &self.disturbance_to_output * (disturbance / units.output),
            wanted: Wanted {
                exactly: in_gamma(self.wanted.exactly),
                at_most: in_gamma(self.wanted.at_most),
            },
        }
    }

    /// `Q > 0` and
    ///
    /// ```text
    /// [ A_i Q + Q A_i' + B Y + Y'B',  B_w,       (C Q + D Y)' ]
    /// [ *                             -gamma I,  D_w'         ]  <  0.
    /// [ *                             *          -gamma I     ]
    /// ```
    fn conditions(&self, plant: &VertexPlant, transformed: &Transformed) -> Vec<Inequality> {
        let (d, p) = (self.disturbance.ncols(), self.output.nrows());
        let gamma = |side| {
            transformed
                .objective
                .times_matrix(&DMatrix::identity(side, side))
        };
        let q = &transformed.inverse;
        let output = &self.output * q + &self.input_to_output * &transformed.gain;
        let mut out = vec![Inequality::strict("inverse positive", q.clone())];
        for (index, a) in plant.vertices.iter().enumerate() {
            let decay = transformed.decay(a, &plant.input, &transformed.gain, 0.0);
            let driven = Affine::constant(&self.disturbance);
            let direct = Affine::constant(&self.disturbance_to_output.transpose());
            let lhs = SymmetricBlocks::of(&[
                &[&decay, &driven, &output.transposed()],
                &[&-gamma(d), &direct],
                &[&-gamma(p)],
            ]);
            let name = format!("bounded real vertex {}", index + 1);
            out.push(Inequality::strict(name, -lhs));
        }
        out
    }

    /// In other units dV/dt <= gamma |w|^2 - |z|^2 / gamma holds for another multiple of V, as the units say.
    fn claim(&self, found: &mut StateFeedback, objective: f64) {
        found.guarantee = objective;
    }

    fn guarantee_of(objective: f64) -> f64 {
        objective
    }

    fn objective_of(guarantee: f64) -> f64 {
        guarantee
    }

    /// Where the output does not see every input, large inputs may cost nothing.
    fn floor(&self, plant: &VertexPlant) -> Option<Floor> {
        if plant.gain.is_some() || self.sees_every_input() {
            return None;
        }
        let objective = FLOOR * reference_gain(&self.in_sizes(plant), plant)?;
        Some(Floor {
            name: "smallest gain",
            objective,
        })
    }

    fn wanted(&self) -> Wanted {
        self.wanted
    }

    fn without_wanted(&self) -> Self {
        HInfinity {
            wanted: Wanted::default(),
            ..self.clone()
        }
    }

    fn direct(&self, plant: &VertexPlant) -> Option<Box<dyn Direct + '_>> {
        match plant.vertices.len() {
            1 => {
                let floor = self.floor(plant).map_or(0.0, |floor| floor.objective);
                let at_most = self.wanted.at_most.unwrap_or(f64::INFINITY);
                let aim = self
                    .wanted
                    .exactly
                    .unwrap_or(floor.min(at_most * WELL_BELOW));
                let direct = BoundedReal::new(&self.in_sizes(plant), plant, aim)?;
                Some(Box::new(direct))
            }
            _ => None,
        }
    }

    fn statements<S: Scalar>(&self, proof: &Proof<S>, emit: &mut dyn FnMut(String, Matrix<S>)) {
        let exactly = |matrix: &DMatrix<f64>| Matrix::<S>::exactly(matrix);
        let (d, p) = (self.disturbance.ncols(), self.output.nrows());
        let feedthrough = exactly(&self.input_to_output).times(&proof.gain);
        let output = exactly(&self.output).plus(&feedthrough);
        let gamma = |side| Matrix::identity(side, proof.guarantee.clone());
        emit("lyapunov positive".into(), proof.lyapunov.clone());
        for (index, a) in proof.vertices.iter().enumerate() {
            let driven = proof.lyapunov.times(&exactly(&self.disturbance));
            let direct = exactly(&self.disturbance_to_output.transpose());
            let (seen, decay) = (output.transposed(), proof.decay(a, &proof.gain, &S::zero()));
            let matrix = Matrix::symmetric(&[
                &[&decay, &driven.negated(), &seen.negated()],
                &[&gamma(d), &direct.negated()],
                &[&gamma(p)],
            ]);
            emit(format!("bounded real vertex {}", index + 1), matrix);
        }
        if let Some(gamma) = self.wanted.exactly {
            let room = S::one() - proof.guarantee.clone() / S::from_f64(gamma);
            emit("gain below gamma".into(), Matrix::identity(1, room));
        }
    }

    fn assumptions(&self) -> Vec<String> {
        vec![
            "inputs without limits".to_string(),
            "a disturbance of finite energy".to_string(),
        ]
    }
}
