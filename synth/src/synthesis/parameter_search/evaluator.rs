//! The semidefinite program of one point of the search: its value and the gradient with respect to the parameters.

use nalgebra::DMatrix;

use super::progress::SearchProgress;
use super::space::{Range, Space};
use crate::conditions::xu2020::Containment;
use crate::conditions::Task;
use crate::model::{Model, ModelFile};
use crate::programs::{
    assemble, blocking, has_point, Assembled, Blocking, Form, Goal, Parameter, SynthesisError,
};
use crate::scaling::Scaling;
use sdp::lmi::{inner_product, Semidefinite};
use sdp::solve::{Backend, Solution};

/// Bounds on the gain.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GainBounds {
    /// Largest gain bound, if any.
    pub gamma: Option<f64>,
    /// Largest guaranteed gain, if any.
    pub gain: Option<f64>,
}

/// The objective of the search.
#[derive(Debug, Clone, PartialEq)]
pub enum Aim {
    /// The largest common scale s with which the certified set contains s times every set of `scaled`.
    Reach {
        /// The sets, as matrices D of ellipsoids {D z, |z| <= 1}; SI units.
        scaled: Vec<DMatrix<f64>>,
        /// What the gain must not exceed.
        bounds: GainBounds,
    },
    /// The smallest guaranteed gain.
    Gain,
}

impl Aim {
    /// The bounds on the gain; none where it is what is minimised.
    pub fn bounds(&self) -> GainBounds {
        match self {
            Aim::Reach { bounds, .. } => *bounds,
            Aim::Gain => GainBounds::default(),
        }
    }

    /// The scale or the guaranteed gain of an objective.
    pub fn value(&self, objective: f64) -> f64 {
        match self {
            Aim::Reach { .. } => objective.exp(),
            Aim::Gain => (-objective).exp(),
        }
    }
}

/// The program that is solved at every point.
#[derive(Clone, Copy)]
pub struct Evaluator<'a> {
    /// What is varied.
    pub space: &'a Space,
    /// The objective.
    pub aim: &'a Aim,
    /// Sets to be contained at scale 1, SI units.
    pub contained: &'a [DMatrix<f64>],
    /// Units, the same at every point.
    pub scaling: &'a Scaling,
    /// The solver.
    pub backend: &'a (dyn Backend + Sync),
    /// Progress is reported here; its observer may stop the search.
    pub progress: &'a SearchProgress,
}

/// A solved point.
#[derive(Debug, Clone)]
pub struct SearchPoint {
    /// Its coordinates.
    pub coordinates: Vec<f64>,
    /// ln of the scale, or -ln of the guaranteed gain: to be maximised.
    pub objective: f64,
    /// Its gradient with respect to the coordinates.
    pub slope: Vec<f64>,
    /// P = Uh^-1 Qh there, SI units.
    pub linearisation: DMatrix<f64>,
    /// The conditions' fractions of the dual solution's trace.
    pub blocking: Vec<Blocking>,
}

/// Least margin of the strict inequalities in the search for a region, in scaled units: a large set has entries
/// of very different sizes in one condition, in which the model's own margin may be lost.
pub const REGION_MARGIN: f64 = 1e-4;

/// Step of the coordinates in the derivatives.
const STEP: f64 = 1e-6;

impl Evaluator<'_> {
    /// The task of a model, in scaled units, linearised about P.
    fn task(&self, file: ModelFile, linearisation: &DMatrix<f64>) -> Option<Task> {
        let mut task = Model::new(file).ok()?.task();
        task.specification.must_contain = Vec::new();
        // Neighbouring programs are compared, so that their unknowns must have the same units.
        task.gain_per_weight = 1.0;
        if let Aim::Reach { .. } = self.aim {
            let margin = &mut task.specification.margin;
            *margin = margin.max(REGION_MARGIN);
        }
        task.containment = Some(Containment {
            linearisation: linearisation.clone(),
            contained: self.contained.to_vec(),
            scaled: match self.aim {
                Aim::Reach { scaled, .. } => scaled.clone(),
                Aim::Gain => Vec::new(),
            },
        });
        Some(self.scaling.apply(&task))
    }

    /// The goal of the program for a task, with the bounds on the gain multiplied by `factor`.
    fn goal(&self, task: &Task, factor: f64) -> Goal {
        match *self.aim {
            Aim::Gain => Goal::SmallestPeak,
            Aim::Reach { .. } => Goal::LargestScale {
                peak: self.peak_bound(task).map(|peak| peak * factor),
            },
        }
    }

    /// The largest g that meets the bounds on the gain, whatever xi <= xi_max.
    pub fn peak_bound(&self, task: &Task) -> Option<f64> {
        let bounds = self.aim.bounds();
        let implied = bounds.gain.map(|gain| gain * gain / weight_max(task));
        bounds.gamma.into_iter().chain(implied).reduce(f64::min)
    }

    fn program(
        &self,
        file: ModelFile,
        linearisation: &DMatrix<f64>,
        factor: f64,
    ) -> Option<Semidefinite> {
        let task = self.task(file, linearisation)?;
        let problem = assemble(&task, Form::VertexRelaxed, self.goal(&task, factor)).problem;
        Some(problem.lower())
    }

    /// Solves at a point; `None` where there is no solution.
    pub fn solve(
        &self,
        point: &[f64],
        linearisation: &DMatrix<f64>,
    ) -> Result<Option<SearchPoint>, SynthesisError> {
        let Some(solved) = self.solved(point, linearisation)? else {
            return Ok(None);
        };
        let values = &solved.solution.values;
        let lyapunov = solved.assembled.design.lyapunov.value(values);
        let multiplier = solved.assembled.design.multiplier.value(values);
        let Some(inverse) = lyapunov.try_inverse() else {
            return Ok(None);
        };
        let d = DMatrix::from_diagonal(&self.scaling.state);
        // Beyond the largest xi that gains anything the value is flat: the point moves to its edge, where it has a slope.
        let useful = solved.weight_max.ln();
        let point = self
            .space
            .with_weight(point, |coordinate| coordinate.min(useful));
        Ok(Some(SearchPoint {
            objective: solved.objective,
            slope: self.slope(&point, linearisation, &solved),
            coordinates: point,
            linearisation: self.scaling.to_state() * inverse * multiplier * d,
            blocking: blocking(&solved.assembled.problem.conditions, &solved.solution),
        }))
    }

    fn solved(
        &self,
        point: &[f64],
        linearisation: &DMatrix<f64>,
    ) -> Result<Option<SolvedProgram>, SynthesisError> {
        let file = self.space.at(point);
        let Some(task) = self.task(file, linearisation) else {
            return Ok(None);
        };
        let goal = self.goal(&task, 1.0);
        let assembled = assemble(&task, Form::VertexRelaxed, goal);
        let program = assembled.problem.lower();
        let accuracy = goal.accuracy(&task);
        let solution = self
            .backend
            .solve(&program, accuracy, Some(self.progress.evaluator()))?;
        self.progress.solved()?;
        if !has_point(&solution) {
            return Ok(None);
        }
        let (objective, per_program_objective) = match self.aim {
            Aim::Reach { .. } => {
                let squared = -solution.objective;
                (0.5 * squared.ln(), -0.5 / squared)
            }
            Aim::Gain => {
                let peak = solution.objective;
                (-0.5 * (peak * weight_max(&task)).ln(), -0.5 / peak)
            }
        };
        Ok(objective.is_finite().then_some(SolvedProgram {
            assembled,
            program,
            solution,
            objective,
            per_program_objective,
            weight_max: weight_max(&task),
        }))
    }

    /// The gradient at a solved point.
    fn slope(
        &self,
        point: &[f64],
        linearisation: &DMatrix<f64>,
        solved: &SolvedProgram,
    ) -> Vec<f64> {
        let along = |(coordinate, range): (usize, &Range)| {
            let [low, high] = range.coordinates();
            let step = match point[coordinate] > 0.5 * (low + high) {
                true => -STEP,
                false => STEP,
            };
            let mut moved = point.to_vec();
            moved[coordinate] += step;
            let file = self.space.at(&moved);
            let slope = self.derivative(solved, file, linearisation, step);
            slope.unwrap_or(0.0)
        };
        self.space.ranges.iter().enumerate().map(along).collect()
    }

    /// The logarithmic derivatives of the value with respect to other numbers of the model.
    pub fn slopes_along(
        &self,
        point: &SearchPoint,
        parameters: &[Parameter],
    ) -> Result<Vec<f64>, SynthesisError> {
        let linearisation = &point.linearisation;
        let Some(solved) = self.solved(&point.coordinates, linearisation)? else {
            return Ok(vec![f64::NAN; parameters.len()]);
        };
        let along = |parameter: &Parameter| {
            let mut file = self.space.at(&point.coordinates);
            parameter.scale(&mut file, 1.0 - STEP);
            let slope = self.derivative(&solved, file, linearisation, -STEP);
            slope.unwrap_or(f64::NAN)
        };
        Ok(parameters.iter().map(along).collect())
    }

    /// The derivative of the objective from a solved point to the program of another model, a step away. The optimum
    /// v = min c'y s.t. S(y; t) >= 0 has dv/dt = -<Z, dS/dt> with the multipliers Z. `None` where there is no such
    /// model.
    fn derivative(
        &self,
        solved: &SolvedProgram,
        file: ModelFile,
        linearisation: &DMatrix<f64>,
        step: f64,
    ) -> Option<f64> {
        // The guaranteed gain is the root of g times the largest xi.
        let explicit = match self.aim {
            Aim::Gain => {
                let largest = weight_max(&self.task(file.clone(), linearisation)?);
                -0.5 * (largest / solved.weight_max).ln() / step
            }
            Aim::Reach { .. } => 0.0,
        };
        let other = self.program(file, linearisation, 1.0)?;
        Some(explicit - solved.per_program_objective * (solved.change(&other) / step))
    }

    /// The logarithmic derivative of the value with respect to the bounds on the gain.
    pub fn slope_along_gamma(&self, point: &SearchPoint) -> Result<Option<f64>, SynthesisError> {
        let linearisation = &point.linearisation;
        let Some(solved) = self.solved(&point.coordinates, linearisation)? else {
            return Ok(None);
        };
        let file = self.space.at(&point.coordinates);
        let other = self.program(file, linearisation, 1.0 - STEP);
        Ok(other.map(|other| solved.per_program_objective * solved.change(&other) / STEP))
    }
}

/// A program with its solution.
struct SolvedProgram {
    assembled: Assembled,
    program: Semidefinite,
    solution: Solution,
    objective: f64,
    /// Derivative of the search's objective with respect to the program's.
    per_program_objective: f64,
    /// The largest xi, SI.
    weight_max: f64,
}

impl SolvedProgram {
    /// <Z, S(y)> of another program with the same cones, less that of this one.
    fn change(&self, other: &Semidefinite) -> f64 {
        pairing(other, &self.solution) - pairing(&self.program, &self.solution)
    }
}

/// xi_max in SI units.
fn weight_max(task: &Task) -> f64 {
    task.specification.disturbance_weight_max * task.disturbance_weight_unit
}

/// <Z, S(y)> of a program at a solution of another one with the same cones.
fn pairing(program: &Semidefinite, solution: &Solution) -> f64 {
    let mut total = 0.0;
    for (cone, dual) in program.cones.iter().zip(&solution.duals) {
        total += inner_product(&cone.constant, dual);
        for (unknown, entries) in &cone.coefficients {
            total += solution.values[*unknown] * inner_product(entries, dual);
        }
    }
    total
}

#[cfg(test)]
mod tests {
    use super::super::plan::Plan;
    use super::*;
    use sdp::solve::Structured;

    const CART: &str = r#"{
        "schema_version": 1, "name": "cart",
        "plant": { "vertices": {
            "state_matrices": [[[0, 1], [0, 0]], [[0, 1], [0, -0.1]]],
            "input_matrix": [[0], [1]], "input_limit": [1], "disturbance_bound": 0.02,
            "box": [{ "row": [1, 0], "bound": 1 }, { "row": [0, 1], "bound": 1 }]
        } },
        "specs": {
            "phi_per_s": 0.1, "hbar_s": 0.05, "nu": 0.05, "xi_max": 100, "objective": "region",
            "must_contain": [[0.3, 0.1]],
            "search": { "phi_per_s": [0.01, 1], "nu": [0.01, 0.5] }
        }
    }"#;

    fn assert_slopes(aim: &Aim, plan: &Plan, model: &Model) {
        let progress = SearchProgress::new(None);
        let backend = Structured::default();
        let scaling = Scaling::automatic(&model.task().system, 0.5);
        let evaluator = Evaluator {
            space: &plan.space,
            aim,
            contained: &[],
            scaling: &scaling,
            backend: &backend,
            progress: &progress,
        };
        let at = plan.space.start();
        let p = DMatrix::identity(2, 2) * 0.3;
        let here = evaluator.solve(&at, &p).unwrap().expect("a solution");
        for coordinate in 0..at.len() {
            let objective = |step: f64| {
                let mut moved = at.clone();
                moved[coordinate] += step;
                evaluator
                    .solve(&moved, &p)
                    .unwrap()
                    .expect("a solution")
                    .objective
            };
            // One-sided where the start lies on a limit.
            let [low, high] = plan.space.ranges[coordinate].coordinates();
            let (back, ahead) = (
                (at[coordinate] - low).min(0.02),
                (high - at[coordinate]).min(0.02),
            );
            let slope = (objective(ahead) - objective(-back)) / (ahead + back);
            let error = (slope - here.slope[coordinate]).abs();
            assert!(
                error < 0.01 + 0.03 * slope.abs(),
                "{coordinate}: {slope} {:?}",
                here.slope
            );
        }
    }

    #[test]
    fn the_multipliers_give_the_slopes_that_differences_give() {
        let model = Model::from_json(CART).expect("a valid model");
        let plan = Plan::of(&model);
        assert_eq!(plan.space.ranges.len(), 5);
        assert_slopes(&plan.aim, &plan, &model);
        assert_slopes(&Aim::Gain, &plan, &model);
    }
}
