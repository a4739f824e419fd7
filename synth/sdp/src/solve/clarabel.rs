//! The `clarabel` crate as a backend.

use std::collections::HashSet;
use std::f64::consts::SQRT_2;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultInfo, DefaultSettings, DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus,
    SupportedConeT,
};

use crate::backend::{
    check_finite, Accuracy, Backend, Observer, Progress, Solution, SolveError, Solver, Status,
};
use crate::lmi::{svec_index, Cone, Entry, Semidefinite};
use crate::memory;

/// In which cones explicit zeros are stored, so that every column that touches such a cone touches
/// all its rows.
///
/// Clarabel orders its factorization by minimum degree. Sparse columns go first and couple all the
/// cones they touch; full columns make the cones go first, each on its own. For wide cones that
/// share many unknowns that is several times faster; narrow ones are better left sparse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DenseColumns {
    /// No zeros are stored.
    None,
    /// Whole columns in cones of at least this side.
    FromSide(usize),
}

impl Default for DenseColumns {
    /// From side 13: the cliques of (18) for a spacecraft (18), not its vertex blocks (12).
    fn default() -> Self {
        DenseColumns::FromSide(13)
    }
}

impl DenseColumns {
    fn covers(self, cone: &Cone) -> bool {
        match self {
            DenseColumns::None => false,
            DenseColumns::FromSide(side) => cone.side >= side,
        }
    }
}

/// Clarabel with its faer factorization.
#[derive(Debug, Clone, Default)]
pub struct Clarabel {
    /// Storage of zeros.
    pub dense_columns: DenseColumns,
}

const NAME: &str = "clarabel";
/// The version that Cargo.toml pins.
const VERSION: &str = "0.11.1";

impl Backend for Clarabel {
    fn name(&self) -> String {
        format!("{NAME} {VERSION}")
    }

    fn solver(&self) -> Option<Solver> {
        Some(Solver::Clarabel)
    }

    fn solve(
        &self,
        problem: &Semidefinite,
        accuracy: Accuracy,
        observer: Option<Observer>,
    ) -> Result<Solution, SolveError> {
        check_finite(NAME, problem)?;
        memory::check(NAME, memory_needed(problem), problem.widest())?;
        super::lapack::link();
        let (matrix, rhs, cones) = conic_form(problem, self.dense_columns);
        let unknowns = problem.cost.len();
        let quadratic = CscMatrix::zeros((unknowns, unknowns));
        let settings = settings(accuracy.relative_gap)?;
        // The tolerance on the gap is absolute for objectives below 1.
        let unit = accuracy.objective_unit;
        let cost: Vec<f64> = problem.cost.iter().map(|cost| cost / unit).collect();
        let offset = problem.offset;
        let mut solver = DefaultSolver::new(&quadratic, &cost, &matrix, &rhs, &cones, settings)
            .map_err(refused)?;
        if let Some(observer) = observer {
            solver.set_termination_callback(move |info: &DefaultInfo<f64>| {
                !observer(&Progress {
                    iteration: info.iterations,
                    objective: info.cost_primal * unit + offset,
                    relative_gap: info.gap_rel,
                })
            });
        }
        solver.solve();
        let found = &solver.solution;
        Ok(Solution {
            status: status(found.status),
            status_text: format!("{:?}", found.status),
            values: found.x.clone(),
            duals: split_duals(problem, &found.z, unit),
            objective: found.obj_val * unit + offset,
            iterations: found.iterations,
            seconds: found.solve_time,
        })
    }
}

/// Estimate of the memory that a solve takes [bytes]. For each semidefinite cone of height h (entries of its triangle)
/// Clarabel stores a dense matrix of side h, its triangle in the system of equations, and the factor: 60 bytes for
/// each of the h^2 entries; a column that has entries in the cone couples with all its rows. The factors are fitted to
/// the largest memory of single solves, which the estimate exceeds by up to a quarter.
pub fn memory_needed(problem: &Semidefinite) -> u64 {
    let unknowns = problem.cost.len() as u64;
    let per_cone = problem.cones.iter().map(|cone| {
        let height = cone.height() as u64;
        let dense = height.saturating_mul(height).saturating_mul(60);
        let columns = height.saturating_mul(cone.coefficients.len() as u64);
        dense.saturating_add(columns.saturating_mul(180))
    });
    let cones = per_cone.fold(0, u64::saturating_add);
    cones.saturating_add(unknowns.saturating_mul(unknowns).saturating_mul(24))
}

/// Work of an iteration [multiplications]: the factor of each cone's dense matrix, and what the columns leave.
pub fn work_per_iteration(problem: &Semidefinite) -> f64 {
    let per_cone = problem.cones.iter().map(|cone| {
        let (height, columns) = (cone.height() as f64, cone.coefficients.len() as f64);
        height * height * (height / 3.0 + columns) + height * columns * columns
    });
    per_cone.sum()
}

fn settings(relative_gap: f64) -> Result<DefaultSettings<f64>, SolveError> {
    DefaultSettingsBuilder::default()
        .verbose(false)
        .direct_solve_method("faer".to_string())
        .max_threads(1)
        .chordal_decomposition_enable(false)
        .presolve_enable(false)
        .tol_gap_rel(relative_gap)
        .tol_gap_abs(relative_gap)
        .build()
        .map_err(refused)
}

fn refused(error: impl std::fmt::Display) -> SolveError {
    SolveError::Refused {
        backend: NAME,
        reason: error.to_string(),
    }
}

/// An entry in the stacked vector.
fn stacked(entry: &Entry) -> f64 {
    entry.count().sqrt() * entry.value
}

/// `A y + s = b` with s in the cones: b stacks the constants, -A the coefficients.
fn conic_form(
    problem: &Semidefinite,
    dense_columns: DenseColumns,
) -> (CscMatrix<f64>, Vec<f64>, Vec<SupportedConeT<f64>>) {
    let height: usize = problem.cones.iter().map(Cone::height).sum();
    let mut rhs = vec![0.0; height];
    let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
    let mut cones = Vec::with_capacity(problem.cones.len());
    let mut base = 0;
    for cone in &problem.cones {
        for entry in &cone.constant {
            let row = base + svec_index(entry.row, entry.column);
            rhs[row] = stacked(entry);
        }
        for (unknown, entries) in &cone.coefficients {
            let start = rows.len();
            for entry in entries {
                rows.push(base + svec_index(entry.row, entry.column));
                values.push(-stacked(entry));
            }
            if dense_columns.covers(cone) {
                let present: HashSet<usize> = rows[start..].iter().copied().collect();
                rows.extend((base..base + cone.height()).filter(|row| !present.contains(row)));
                values.resize(rows.len(), 0.0);
            }
            columns.resize(rows.len(), *unknown);
        }
        cones.push(match cone.side {
            1 => SupportedConeT::NonnegativeConeT(1),
            side => SupportedConeT::PSDTriangleConeT(side),
        });
        base += cone.height();
    }
    let unknowns = problem.cost.len();
    let matrix = CscMatrix::new_from_triplets(height, unknowns, rows, columns, values);
    (matrix, rhs, cones)
}

fn split_duals(problem: &Semidefinite, stacked: &[f64], factor: f64) -> Vec<Vec<f64>> {
    let mut base = 0;
    let mut out = Vec::with_capacity(problem.cones.len());
    for cone in &problem.cones {
        let mut dual = stacked[base..base + cone.height()].to_vec();
        dual.iter_mut().for_each(|entry| *entry *= factor);
        for column in 0..cone.side {
            for row in 0..column {
                dual[svec_index(row, column)] /= SQRT_2;
            }
        }
        out.push(dual);
        base += cone.height();
    }
    out
}

fn status(status: SolverStatus) -> Status {
    match status {
        SolverStatus::Solved => Status::Solved,
        SolverStatus::AlmostSolved => Status::Inaccurate,
        SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => Status::Infeasible,
        SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => Status::Unbounded,
        SolverStatus::CallbackTerminated => Status::Cancelled,
        SolverStatus::Unsolved
        | SolverStatus::MaxIterations
        | SolverStatus::MaxTime
        | SolverStatus::NumericalError
        | SolverStatus::InsufficientProgress => Status::Failed,
    }
}
