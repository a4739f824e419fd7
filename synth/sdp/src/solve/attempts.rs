//! One solver, then the other where the first does not decide.

use super::clarabel::work_per_iteration;
use super::outcome::Judgement;
use super::structured::{Structured, Timings};
use super::{Backend, Clarabel};
use crate::backend::{Accuracy, Observer, Solution, SolveError, Solver};
use crate::lmi::Semidefinite;

/// Work of one of Clarabel's iterations [multiplications] above which it is not asked to improve a result that is only
/// inaccurate: about a minute for a whole solve.
const TOO_MUCH_WORK: f64 = 2e9;

/// One solver's attempt.
#[derive(Debug, Clone)]
pub struct Attempt {
    /// Which solver.
    pub solver: Solver,
    /// Its name and version.
    pub name: String,
    /// What it found, or why it could not start.
    pub found: Result<Found, SolveError>,
}

/// What a solver found.
#[derive(Debug, Clone)]
pub struct Found {
    /// As it was returned.
    pub solution: Solution,
    /// Where the time went, where that is known.
    pub timings: Option<Timings>,
    /// What the numbers show.
    pub judgement: Judgement,
}

impl Attempt {
    /// Runs one solver.
    pub fn run(
        solver: Solver,
        problem: &Semidefinite,
        accuracy: Accuracy,
        observer: Option<Observer>,
    ) -> Self {
        let found = |(solution, timings): (Solution, Option<Timings>)| Found {
            judgement: Judgement::new(problem, &solution),
            solution,
            timings,
        };
        let (name, solved) = match solver {
            Solver::Structured => {
                let own = Structured::default();
                let solved = own.solve_timed(problem, accuracy, observer);
                (
                    own.name(),
                    solved.map(|(own, timings)| (own, Some(timings))),
                )
            }
            Solver::Clarabel => {
                let own = Clarabel::default();
                let solved = own.solve(problem, accuracy, observer);
                (own.name(), solved.map(|solution| (solution, None)))
            }
        };
        Attempt {
            solver,
            name,
            found: solved.map(found),
        }
    }

    /// Whether the numbers decide.
    pub fn decides(&self) -> bool {
        self.found
            .as_ref()
            .is_ok_and(|found| found.judgement.decides())
    }
}

/// The structured solver, which needs little memory, and, where its numbers do not decide, Clarabel.
pub fn attempts(
    problem: &Semidefinite,
    accuracy: Accuracy,
    observer: Option<Observer>,
) -> Vec<Attempt> {
    let first = Attempt::run(Solver::Structured, problem, accuracy, observer.clone());
    if first.decides() {
        return vec![first];
    }
    let second = match first
        .found
        .as_ref()
        .ok()
        .and_then(|_| too_much(problem, &first))
    {
        Some(reason) => Attempt {
            solver: Solver::Clarabel,
            name: Clarabel::default().name(),
            found: Err(reason),
        },
        None => Attempt::run(Solver::Clarabel, problem, accuracy, observer),
    };
    vec![first, second]
}

/// Why Clarabel is not asked: there is an inaccurate result, and it would take long.
fn too_much(problem: &Semidefinite, first: &Attempt) -> Option<SolveError> {
    let inaccurate = first.found.as_ref().is_ok_and(|found| {
        let measured = found.judgement.residuals.as_ref();
        found.judgement.outcome == super::Outcome::Inaccurate
            && measured.is_some_and(|measured| measured.violation <= 0.0)
    });
    let work = work_per_iteration(problem);
    (inaccurate && work > TOO_MUCH_WORK).then(|| SolveError::Refused {
        backend: "clarabel",
        reason: format!(
            "not asked, because an iteration would take about {work:.0e} multiplications; --solver clarabel asks it"
        ),
    })
}

/// The attempt whose numbers show most, and what it found, if any solver could start.
pub fn best(attempts: &[Attempt]) -> Option<(&Attempt, &Found)> {
    let started = attempts.iter().filter_map(|attempt| {
        let found = attempt.found.as_ref().ok()?;
        Some((attempt, found))
    });
    started.min_by(|(_, a), (_, b)| {
        let (a, b) = (a.judgement.rank(), b.judgement.rank());
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    })
}
