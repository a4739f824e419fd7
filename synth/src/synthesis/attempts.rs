//! Attempts at a design: the smallest bound in some settings, a back-off from it, a design well inside, and its check.
//!
//! A [`Synthesis`] says how one attempt is made; its settings and back-offs are data, and [`Attempts`] keeps what
//! came of them. Nothing that a solver reports is trusted: only the check decides whether a design is proved.

use crate::programs::{has_point, satisfied, Session, SynthesisError, Synthesized};
use sdp::lmi::{Condition, LmiProblem};
use sdp::solve::{Solution, Status};

/// A problem at whose design attempts are made.
pub(crate) trait Synthesis {
    /// What is chosen before a program can be stated: units, weights.
    type Settings: Clone;

    /// The file that is made.
    type File;

    /// Solves for the smallest bound in these settings.
    fn smallest(&mut self, settings: &Self::Settings) -> Result<Smallest, SynthesisError>;

    /// The design with the largest margin at a bound, checked as a reader of its file would; `None` where no file can
    /// hold the numbers of the solver's point.
    fn design(
        &mut self,
        settings: &Self::Settings,
        bound: f64,
    ) -> Result<Option<Box<Synthesized<Self::File>>>, SynthesisError>;

    /// The number by which proved designs are compared: the smallest is the best.
    fn objective(file: &Self::File) -> f64;
}

/// The result of a solve for the smallest bound.
pub(crate) enum Smallest {
    /// A bound that the solver reports.
    Bound {
        /// Above 0 and finite.
        bound: f64,
        /// Whether its point satisfies the conditions: else the bound says nothing about the optimum.
        satisfied: bool,
    },
    /// The solver reports that there is none.
    Infeasible,
    /// The solver returned no usable point.
    Failed,
}

impl Smallest {
    /// What a solver returned for a problem.
    pub fn of(problem: &LmiProblem, solution: &Solution) -> Self {
        let bound = solution.objective;
        match solution.status {
            Status::Infeasible => Smallest::Infeasible,
            _ if has_point(solution) && bound.is_finite() && bound > 0.0 => Smallest::Bound {
                bound,
                satisfied: satisfied(
                    solution,
                    problem.conditions.iter().map(Condition::expression),
                ),
            },
            _ => Smallest::Failed,
        }
    }
}

/// The result of one attempt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Attempt {
    /// A design that is proved.
    Proved,
    /// A design that is not.
    Unproved,
    /// The solver reports that there is no design.
    Infeasible,
    /// The solver failed, or returned numbers that no file can hold.
    Failed,
}

/// The results of all attempts.
pub(crate) struct Attempts<Settings, File> {
    /// The best proved design.
    pub best: Option<Box<Synthesized<File>>>,
    /// The last design that is not proved.
    pub unproved: Option<Box<Synthesized<File>>>,
    /// The settings that gave a bound, with the solver's smallest in each.
    pub bounds: Vec<(Settings, f64)>,
    /// The smallest bound whose point satisfies the conditions; infinite without one.
    pub best_seen: f64,
    /// How often the solver called the problem infeasible.
    pub infeasible: u32,
}

impl<Settings, File> Default for Attempts<Settings, File> {
    fn default() -> Self {
        Attempts {
            best: None,
            unproved: None,
            bounds: Vec::new(),
            best_seen: f64::INFINITY,
            infeasible: 0,
        }
    }
}

impl<Settings: Clone, File> Attempts<Settings, File> {
    /// Runs attempts with the session's first solver, and with the second where what it found is not enough.
    pub fn with_each_solver<S: Synthesis<Settings = Settings, File = File>>(
        session: &mut Session,
        enough: impl Fn(&Self) -> bool,
        mut run: impl FnMut(&mut Session) -> Result<Self, SynthesisError>,
    ) -> Result<Self, SynthesisError> {
        let mut found = run(session)?;
        if !enough(&found) {
            if let Some(other) = session.with_other(run)? {
                found.keep::<S>(other.best);
                found.unproved = found.unproved.or(other.unproved);
                found.bounds.extend(other.bounds);
                found.best_seen = found.best_seen.min(other.best_seen);
                found.infeasible += other.infeasible;
            }
        }
        Ok(found)
    }

    /// Keeps the better one of the best design and another.
    pub fn keep<S: Synthesis<File = File>>(&mut self, other: Option<Box<Synthesized<File>>>) {
        let both = self.best.take().into_iter().chain(other);
        self.best = both.min_by(|a, b| S::objective(&a.file).total_cmp(&S::objective(&b.file)));
    }

    /// The smallest bound that a solver reported, whatever its point.
    pub fn smallest_bound(&self) -> f64 {
        let bounds = self.bounds.iter().map(|(_, bound)| *bound);
        bounds.fold(f64::INFINITY, f64::min)
    }

    /// Solves for the smallest bound, which is kept where there is one.
    pub fn smallest(
        &mut self,
        synthesis: &mut impl Synthesis<Settings = Settings, File = File>,
        settings: &Settings,
    ) -> Result<Smallest, SynthesisError> {
        let smallest = synthesis.smallest(settings)?;
        match smallest {
            Smallest::Bound { bound, satisfied } => {
                self.bounds.push((settings.clone(), bound));
                if satisfied {
                    self.best_seen = self.best_seen.min(bound);
                }
            }
            Smallest::Infeasible => self.infeasible += 1,
            Smallest::Failed => {}
        }
        Ok(smallest)
    }

    /// The same, and designs at back-offs from the bound until one is proved.
    pub fn attempt(
        &mut self,
        synthesis: &mut impl Synthesis<Settings = Settings, File = File>,
        settings: &Settings,
        back_offs: &[f64],
    ) -> Result<Attempt, SynthesisError> {
        match self.smallest(synthesis, settings)? {
            Smallest::Bound { bound, .. } => {
                self.back_off(synthesis, &[(settings.clone(), bound)], back_offs)
            }
            Smallest::Infeasible => Ok(Attempt::Infeasible),
            Smallest::Failed => Ok(Attempt::Failed),
        }
    }

    /// Designs at relative back-offs from known bounds, one back-off after the other until a design is proved; the
    /// best of all settings is kept.
    pub fn back_off<S: Synthesis<Settings = Settings, File = File>>(
        &mut self,
        synthesis: &mut S,
        bounds: &[(Settings, f64)],
        back_offs: &[f64],
    ) -> Result<Attempt, SynthesisError> {
        let mut attempt = Attempt::Failed;
        for back_off in back_offs {
            for (settings, smallest) in bounds {
                match synthesis.design(settings, smallest * (1.0 + back_off))? {
                    Some(design) if design.is_proved() => {
                        attempt = Attempt::Proved;
                        self.keep::<S>(Some(design));
                    }
                    Some(design) => {
                        self.unproved = Some(design);
                        if attempt == Attempt::Failed {
                            attempt = Attempt::Unproved;
                        }
                    }
                    None => {}
                }
            }
            if attempt == Attempt::Proved {
                break;
            }
        }
        Ok(attempt)
    }
}
