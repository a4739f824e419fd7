//! One run of a solver, with its record.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;
use std::time::Instant;

use sha2::{Digest, Sha256};
use time::format_description::well_known::Rfc3339;
use time::OffsetDateTime;

use super::{Cancelled, SynthesisError};
use crate::design::SolverRun;
use crate::lmi::Problem;
use crate::solve::{Accuracy, Backend, Observer, Solution};

/// What is sought, and at how many vertices, for the record.
pub(crate) struct Sought<'a> {
    pub goal: &'a str,
    pub vertices: usize,
    pub accuracy: Accuracy,
}

/// Lowers and solves a problem; a run that the observer stopped is an error.
pub(crate) fn run_solver(
    backend: &dyn Backend,
    problem: &Problem,
    sought: &Sought,
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
    let solution = backend.solve(&problem.lower(), sought.accuracy, observer)?;
    if cancelled.load(Ordering::Relaxed) {
        return Err(Cancelled.into());
    }
    let run = SolverRun {
        goal: sought.goal.to_string(),
        vertices: sought.vertices,
        solver: backend.name(),
        status: solution.status_text.clone(),
        objective: finite_or_zero(solution.objective),
        iterations: solution.iterations,
        seconds: start.elapsed().as_secs_f64(),
    };
    Ok((solution, run))
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
pub(crate) fn sha256_of(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
