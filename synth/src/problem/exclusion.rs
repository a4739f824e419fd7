//! Proofs that a design problem has no solution.

use super::program::{program, ProblemGoal, Program, SLACK_MARGIN};
use super::scaled::Scaled;
use super::unreachable::UnreachableMode;
use nalgebra::DMatrix;

use crate::certify::judge;
use crate::certify::theorem1::Statement;
use crate::conditions::state_feedback::{DesignProblem, VertexPlant};
use crate::conditions::units::Units;
use sdp::centre::centred;
use sdp::exclusion::exclude;
use sdp::lmi::{dual_matrix, dual_trace, svec_index, Cone, Semidefinite};
use sdp::solve::Solution;
use verified::interval::Interval;
use verified::matrix::Matrix;

/// Fraction of the slack above the margin that the dual multipliers of a proof keep; the rest moves them into the
/// interior.
const KEPT: f64 = 0.25;

/// Fractions of their mean eigenvalue by which dual matrices are shifted into the interior of their cones.
const SHIFTS: [f64; 4] = [1e-12, 1e-10, 1e-8, 1e-6];

/// Where the conditions have no solution: proved for the numbers of the scaled problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InfeasibilityProof {
    /// No solution has all scalar unknowns below this in magnitude; infinite when no bound is needed.
    pub radius: f64,
    /// What every condition exceeds in such a solution; 0 excludes solutions that are not strict too. Conditions
    /// without a constant part hold at zero, and only a margin excludes anything.
    pub margin: f64,
    /// The largest scalar unknown that any solver returned for the problem or its relaxation, at least 1.
    pub largest_returned: f64,
    /// The mode that no input reaches, where it is the reason; found without a solver.
    pub unreachable: Option<UnreachableMode>,
}

impl InfeasibilityProof {
    /// Of a mode that no feedback moves.
    pub(super) fn of_mode(mode: UnreachableMode) -> Self {
        InfeasibilityProof {
            radius: f64::INFINITY,
            margin: 0.0,
            largest_returned: 1.0,
            unreachable: Some(mode),
        }
    }

    /// True when the statement needs neither a bound on the unknowns nor a margin. A bound proves nothing, however
    /// large: plants exist whose only solutions have entries far beyond what any solver returns.
    pub fn conclusive(&self) -> bool {
        self.radius == f64::INFINITY && self.margin == 0.0
    }
}

/// The dual solution of the smallest slack as a proof that there is no solution. `original` are the problem and its
/// plant in the file's units.
pub(super) fn infeasibility_proof<P: DesignProblem>(
    original: (&P, &VertexPlant),
    scaled: &Scaled<P>,
    smallest_slack: &Program,
    solution: &Solution,
    largest_returned: f64,
) -> Option<InfeasibilityProof> {
    let problem = smallest_slack.problem.lower();
    let excess = solution.objective - SLACK_MARGIN;
    let targets = [SLACK_MARGIN + KEPT * excess.max(0.0), SLACK_MARGIN];
    let centres = targets.map(|target| centred(&problem, &solution.duals, -target));
    let shifts = SHIFTS.iter();
    let shifted = shifts.map(|&shift| shifted(&problem, &solution.duals, shift));
    let carried = targets.map(|target| carried_only(&problem, &solution.duals, -target));
    let centres = centres.into_iter().chain(carried).flatten();
    let candidates: Vec<_> = centres.chain(shifted).collect();
    let exactly =
        |multipliers: &Vec<Vec<f64>>| refutes(original, &scaled.units, &problem, multipliers);
    if candidates.iter().any(exactly) {
        return Some(InfeasibilityProof {
            radius: f64::INFINITY,
            margin: 0.0,
            largest_returned,
            unreachable: None,
        });
    }
    [0.0, SLACK_MARGIN].into_iter().find_map(|margin| {
        let bare = program(scaled, ProblemGoal::Margin(margin)).problem.lower();
        let radii = candidates
            .iter()
            .map(|weights| exclude(&bare, weights).radius);
        let radius = radii.fold(0.0, f64::max);
        (radius > 0.0).then_some(InfeasibilityProof {
            radius,
            margin,
            largest_returned,
            unreachable: None,
        })
    })
}

/// True when the multipliers of the decay conditions, those that are proved positive definite, refute the problem
/// whatever the size of its unknowns.
fn refutes<P: DesignProblem>(
    (requested, plant): (&P, &VertexPlant),
    units: &Units,
    problem: &Semidefinite,
    multipliers: &[Vec<f64>],
) -> bool {
    let n = plant.states();
    let proved = |name: String, matrix: Matrix<Interval>| judge(&Statement { name, matrix }).0;
    let of_vertex = |vertex: usize| {
        let name = format!("decay vertex {}", vertex + 1);
        let index = problem.cones.iter().position(|cone| cone.name == name)?;
        let dual = multipliers.get(index)?;
        // <Z', D^-1 M D^-1> = <Z, M>, powers of two.
        let z = units.unweighed(&dual_matrix(n, dual));
        let definite = z.iter().all(|entry| entry.is_finite()) && proved(name, Matrix::exactly(&z));
        definite.then_some(z)
    };
    let found: Vec<Option<DMatrix<f64>>> = (0..plant.vertices.len()).map(of_vertex).collect();
    if found.iter().all(Option::is_none) {
        return false;
    }
    let z: Vec<DMatrix<f64>> = found
        .into_iter()
        .map(|z| z.unwrap_or_else(|| DMatrix::zeros(n, n)))
        .collect();
    let matrix = requested.refutation::<Interval>(plant, &z);
    matrix.is_some_and(|matrix| proved("refutation".to_string(), matrix))
}

/// The centred dual matrices of the cones that carry the dual solution, zero for all others. A matrix that must vanish,
/// such as that of a bound on the objective, has no middle and would spoil the others'.
fn carried_only(problem: &Semidefinite, duals: &[Vec<f64>], target: f64) -> Option<Vec<Vec<f64>>> {
    let cones = problem.cones.iter().zip(duals);
    let traces: Vec<f64> = cones
        .map(|(cone, dual)| dual_trace(cone.side, dual))
        .collect();
    let least = NEGLIGIBLE * traces.iter().sum::<f64>();
    let carries = |index: &usize| traces[*index] > least;
    let kept: Vec<usize> = (0..traces.len()).filter(carries).collect();
    let part = Semidefinite {
        cones: kept
            .iter()
            .map(|&index| problem.cones[index].clone())
            .collect(),
        ..problem.clone()
    };
    let own: Vec<Vec<f64>> = kept.iter().map(|&index| duals[index].clone()).collect();
    let centred = centred(&part, &own, target)?;
    let mut out: Vec<Vec<f64>> = duals.iter().map(|dual| vec![0.0; dual.len()]).collect();
    for (index, weight) in kept.into_iter().zip(centred) {
        out[index] = weight;
    }
    Some(out)
}

/// The dual matrices shifted by a fraction of the mean of their eigenvalues.
fn shifted(problem: &Semidefinite, duals: &[Vec<f64>], share: f64) -> Vec<Vec<f64>> {
    let diagonal = |side: usize| (0..side).map(|k| svec_index(k, k));
    let sides: usize = problem.cones.iter().map(|cone| cone.side).sum();
    let cones = || problem.cones.iter().zip(duals);
    let traces = cones().flat_map(|(cone, dual)| diagonal(cone.side).map(|k| dual[k]));
    let shift = share * traces.sum::<f64>() / sides as f64;
    let one = |(cone, dual): (&Cone, &Vec<f64>)| {
        let mut out = dual.clone();
        diagonal(cone.side).for_each(|k| out[k] += shift);
        out
    };
    cones().map(one).collect()
}

/// Cones whose dual matrix has less than this part of all traces carry nothing.
const NEGLIGIBLE: f64 = 1e-5;
