//! One point of the search: a semidefinite program, its value, and how the value changes with the parameters.

use nalgebra::DMatrix;

use super::parameters::Space;
use crate::conditions::xu2020::Coverage;
use crate::conditions::Task;
use crate::lmi::{svec_index, Semidefinite};
use crate::model::Model;
use crate::scaling::Scaling;
use crate::solve::{Backend, Observer, Solution, SolveError, Status};
use crate::synthesis::{assemble, Form, Goal};

/// What is sought at every point.
#[derive(Debug, Clone, PartialEq)]
pub enum Aim {
    /// The largest scale of the sets to be grown.
    Reach {
        /// The sets to be grown, SI units.
        grown: Vec<DMatrix<f64>>,
        /// Largest gain bound, if any.
        gamma_max: Option<f64>,
        /// Largest guaranteed gain, if any.
        gain_max: Option<f64>,
    },
    /// The smallest guaranteed gain.
    Gain,
}

/// The program that is solved at every point.
pub struct Inner<'a> {
    /// What is varied.
    pub space: &'a Space,
    /// What is sought.
    pub aim: &'a Aim,
    /// Sets to be covered as they are, SI units.
    pub covered: &'a [DMatrix<f64>],
    /// Units, the same at every point.
    pub scaling: &'a Scaling,
    /// The solver.
    pub backend: &'a (dyn Backend + Sync),
    /// Asked between iterations whether to go on.
    pub observer: Option<Observer>,
}

/// What the program gave at a point.
#[derive(Debug, Clone)]
pub struct Value {
    /// ln of the scale, or -ln of the guaranteed gain: to be maximised.
    pub height: f64,
    /// Its derivatives along the coordinates.
    pub slope: Vec<f64>,
    /// P = Uh^-1 Qh there, SI units.
    pub linearisation: DMatrix<f64>,
    /// The conditions' shares of the dual solution.
    pub blocking: Vec<(String, f64)>,
}

/// Step of the coordinates in the derivatives.
const STEP: f64 = 1e-6;

impl Inner<'_> {
    /// The task at a point, in scaled units, linearised about P.
    pub fn task(&self, point: &[f64], linearisation: &DMatrix<f64>) -> Option<Task> {
        let model = Model::new(self.space.at(point)).ok()?;
        let mut task = model.task();
        task.specification.must_contain = Vec::new();
        task.coverage = Some(Coverage {
            linearisation: linearisation.clone(),
            covered: self.covered.to_vec(),
            grown: match self.aim {
                Aim::Reach { grown, .. } => grown.clone(),
                Aim::Gain => Vec::new(),
            },
        });
        Some(self.scaling.apply(&task))
    }

    /// The optimum sought for a task.
    pub fn goal(&self, task: &Task) -> Goal {
        let specification = &task.specification;
        let xi_max = specification.disturbance_weight_max * task.disturbance_weight_unit;
        match *self.aim {
            Aim::Gain => Goal::SmallestPeak,
            Aim::Reach {
                gamma_max,
                gain_max,
                ..
            } => {
                let implied = gain_max.map(|gain| gain * gain / xi_max);
                let peak = gamma_max.into_iter().chain(implied).reduce(f64::min);
                Goal::LargestReach { peak }
            }
        }
    }

    fn program(&self, point: &[f64], linearisation: &DMatrix<f64>) -> Option<Semidefinite> {
        let task = self.task(point, linearisation)?;
        let problem = assemble(&task, Form::Slack, self.goal(&task)).problem;
        Some(problem.lower())
    }

    /// Solves at a point; `None` where there is no solution.
    pub fn solve(
        &self,
        point: &[f64],
        linearisation: &DMatrix<f64>,
    ) -> Result<Option<Value>, SolveError> {
        let Some(task) = self.task(point, linearisation) else {
            return Ok(None);
        };
        let goal = self.goal(&task);
        let assembled = assemble(&task, Form::Slack, goal);
        let program = assembled.problem.lower();
        let accuracy = goal.accuracy(&task);
        let t0 = std::time::Instant::now();
        let solution = self.backend.solve(&program, accuracy, self.observer.clone())?;
        if !matches!(solution.status, Status::Solved | Status::Inaccurate) {
            return Ok(None);
        }
        let xi_max = task.specification.disturbance_weight_max * task.disturbance_weight_unit;
        let (height, per_objective) = match self.aim {
            Aim::Reach { .. } => {
                let squared = -solution.objective;
                (0.5 * squared.ln(), -0.5 / squared)
            }
            Aim::Gain => {
                let peak = solution.objective;
                (-0.5 * (peak * xi_max).ln(), -0.5 / peak)
            }
        };
        if !height.is_finite() {
            return Ok(None);
        }
        let values = &solution.values;
        let lyapunov = assembled.design.lyapunov.value(values);
        let multiplier = assembled.design.multiplier.value(values);
        let Some(inverse) = lyapunov.try_inverse() else {
            return Ok(None);
        };
        let d = DMatrix::from_diagonal(&self.scaling.state);
        let d_inverse = DMatrix::from_diagonal(&self.scaling.state.map(|unit| 1.0 / unit));
        let t1 = std::time::Instant::now();
        let slope = self.slope(point, linearisation, &program, &solution, per_objective);
        Ok(Some(Value {
            height,
            slope,
            linearisation: d_inverse * inverse * multiplier * d,
            blocking: crate::synthesis::blocking(&assembled.problem.conditions, &solution),
        }))
    }

    /// The optimum v = min c'y s.t. S(y; t) >= 0 has dv/dt = -<Z, dS/dt> with the multipliers Z.
    fn slope(
        &self,
        point: &[f64],
        linearisation: &DMatrix<f64>,
        program: &Semidefinite,
        solution: &Solution,
        per_objective: f64,
    ) -> Vec<f64> {
        let here = pairing(program, solution);
        let along = |coordinate: usize| {
            let [low, high] = self.space.ranges[coordinate].coordinates();
            let middle = 0.5 * (low + high);
            let step = if point[coordinate] > middle { -STEP } else { STEP };
            let mut moved = point.to_vec();
            moved[coordinate] += step;
            let Some(other) = self.program(&moved, linearisation) else {
                return 0.0;
            };
            let optimum = -(pairing(&other, solution) - here) / step;
            let explicit = match (self.aim, self.space.ranges[coordinate].parameter) {
                (Aim::Gain, super::parameters::Parameter::DisturbanceWeight) => -0.5,
                _ => 0.0,
            };
            per_objective * optimum + explicit
        };
        (0..point.len()).map(along).collect()
    }
}

/// <Z, S(y)> of a program at a solution of another one with the same cones.
fn pairing(program: &Semidefinite, solution: &Solution) -> f64 {
    let mut total = 0.0;
    for (cone, dual) in program.cones.iter().zip(&solution.duals) {
        let form = |entries: &[crate::lmi::Entry]| -> f64 {
            let terms = entries.iter().map(|entry| {
                let twice = if entry.row == entry.column { 1.0 } else { 2.0 };
                twice * entry.value * dual[svec_index(entry.row, entry.column)]
            });
            terms.sum()
        };
        total += form(&cone.constant);
        for (unknown, entries) in &cone.coefficients {
            total += solution.values[*unknown] * form(entries);
        }
    }
    total
}
