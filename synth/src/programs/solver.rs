//! One run of a solver, with its record.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;
use std::time::Instant;

use sha2::{Digest, Sha256};
use time::format_description::well_known::Rfc3339;
use time::OffsetDateTime;

use super::outcome::{Cancelled, SynthesisError};
use crate::design::SolverRun;
use sdp::lmi::{svec_index, Condition, LmiProblem};
use sdp::solve::{Accuracy, Backend, Observer, Solution};

/// The goal and the accuracy of a run, and the number of vertices for its record.
pub(crate) struct SolveRequest<'a> {
    pub goal: &'a str,
    pub vertices: usize,
    pub accuracy: Accuracy,
}

/// Lowers and solves a problem; a run that the observer stopped is an error.
pub(crate) fn run_solver(
    backend: &dyn Backend,
    problem: &LmiProblem,
    request: &SolveRequest,
    observer: Option<&Observer>,
) -> Result<(Solution, SolverRun), SynthesisError> {
    let cancelled = Arc::new(AtomicBool::new(false));
    let observer = observer.cloned().map(|observer| -> Observer {
        let cancelled = Arc::clone(&cancelled);
        Arc::new(move |progress| {
            let go_on = observer(progress);
            if !go_on {
                cancelled.store(true, Ordering::Relaxed);
            }
            go_on
        })
    });
    let start = Instant::now();
    let solution = backend.solve(&problem.lower(), request.accuracy, observer)?;
    if cancelled.load(Ordering::Relaxed) {
        return Err(Cancelled.into());
    }
    let run = SolverRun {
        goal: request.goal.to_string(),
        vertices: request.vertices,
        solver: backend.name(),
        status: solution.status_text.clone(),
        objective: finite_or_zero(solution.objective),
        iterations: solution.iterations,
        seconds: start.elapsed().as_secs_f64(),
    };
    Ok((solution, run))
}

/// Conditions by their fraction of the dual solution's trace, largest first, those below 1 % left out.
/// The cliques of a reduced condition (18) count together, at all its vertices.
pub(crate) fn blocking(conditions: &[Condition], solution: &Solution) -> Vec<(String, f64)> {
    let mut traces = BTreeMap::<String, f64>::new();
    for (condition, dual) in conditions.iter().zip(&solution.duals) {
        let diagonal = (0..condition.side()).map(|k| dual[svec_index(k, k)]);
        let trace: f64 = diagonal.sum();
        let whole = match condition.name().split_once(" clique ") {
            Some((whole, _)) => format!("{whole} all vertices"),
            None => condition.name().to_string(),
        };
        if trace.is_finite() {
            *traces.entry(whole).or_default() += trace;
        }
    }
    let mut shares: Vec<(String, f64)> = traces.into_iter().collect();
    let total: f64 = shares.iter().map(|(_, trace)| trace).sum();
    shares
        .iter_mut()
        .for_each(|(_, trace)| *trace /= total.max(f64::MIN_POSITIVE));
    shares.retain(|(_, share)| *share >= 0.01);
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    shares
}

fn finite_or_zero(value: f64) -> f64 {
    if value.is_finite() {
        value
    } else {
        0.0
    }
}

/// Program and version, for a file's provenance.
pub(crate) fn generator() -> String {
    concat!("steadfast ", env!("CARGO_PKG_VERSION")).to_string()
}

/// Date and time, UTC, to the second.
pub(crate) fn now() -> String {
    let now = OffsetDateTime::now_utc().replace_nanosecond(0);
    let date = now.ok().and_then(|now| now.format(&Rfc3339).ok());
    date.unwrap_or_default()
}

/// SHA-256 of a text, in hexadecimal.
pub fn sha256_of(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
