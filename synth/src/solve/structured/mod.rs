//! A primal-dual interior-point method on the inequality form, for few unknowns and many small cones.

mod dense;
mod interior_point;
mod iterate;
mod layout;
mod ray;
mod schur;
mod system;
mod warm;

use std::time::Instant;

use super::{Accuracy, Backend, Observer, Progress, Solution, SolveError, Status};
use crate::lmi::{svec_index, Semidefinite};
use interior_point::{End, Measures, Outcome, Task};
use layout::Layout;

const NAME: &str = "structured";

/// The structured solver.
#[derive(Debug, Clone)]
pub struct Structured {
    /// Threads that may be used; the result does not depend on it.
    pub threads: usize,
}

impl Default for Structured {
    fn default() -> Self {
        let available = std::thread::available_parallelism().map_or(1, |count| count.get());
        Structured { threads: available.min(2) }
    }
}

impl Backend for Structured {
    fn name(&self) -> String {
        format!("{NAME} {}", env!("CARGO_PKG_VERSION"))
    }

    fn solve(
        &self,
        problem: &Semidefinite,
        accuracy: Accuracy,
        observer: Option<Observer>,
    ) -> Result<Solution, SolveError> {
        let begin = Instant::now();
        super::check_finite(NAME, problem)?;
        let layout = Layout::new(problem);
        let unit = layout.objective_unit;
        let watch = |iteration: u32, measures: &Measures| match &observer {
            None => true,
            Some(observer) => observer(&Progress {
                iteration,
                objective: measures.objective * unit + problem.offset,
                relative_gap: measures.relative_gap,
            }),
        };
        let task = Task {
            layout: &layout,
            relative_gap: accuracy.relative_gap,
            objective_unit: accuracy.objective_unit / unit,
            threads: self.threads,
            observer: &watch,
        };
        let mut trail = warm::Trail::default();
        let outcome = interior_point::solve(&task, interior_point::cold_start(&layout), &mut trail);
        if std::env::var_os("SDP_TIME").is_some() {
            eprintln!("{:?} {:?} {:?}", outcome.end, outcome.measures, outcome.seconds);
        }
        Ok(solution(problem, &layout, outcome, begin))
    }
}

fn solution(problem: &Semidefinite, layout: &Layout, outcome: Outcome, begin: Instant) -> Solution {
    let (status, text) = match outcome.end {
        End::Solved => (Status::Solved, "Solved".to_string()),
        End::Reduced => (Status::Inaccurate, "ReducedAccuracy".to_string()),
        End::Infeasible => (Status::Infeasible, "Infeasible".to_string()),
        End::Unbounded => (Status::Unbounded, "Unbounded".to_string()),
        End::Stalled(why) => (Status::Failed, format!("Stalled: {why}")),
        End::Cancelled => (Status::Cancelled, "Cancelled".to_string()),
    };
    let objective = match status {
        Status::Infeasible | Status::Unbounded => f64::NAN,
        _ => outcome.measures.objective * layout.objective_unit + problem.offset,
    };
    let _ = svec_index;
    Solution {
        status,
        status_text: text,
        values: layout.values(&outcome.point.y, problem.cost.len()),
        duals: layout.duals(&outcome.point.z, problem),
        objective,
        iterations: outcome.iterations,
        seconds: begin.elapsed().as_secs_f64(),
    }
}
