//! The search for a design with two certificates.

use super::assemble::{assemble, Coupled, Scaled, UNBOUNDED_GAIN};
use crate::certify::theorem1::Certificate;
use crate::certify::Verdict;
use crate::conditions::Task;
use crate::design::{recover, CertificateFile, Coupling, OuterFile, ProblemUnits, SolverRun};
use crate::model::{Model, ModelError, OuterSpecs};
use crate::optimality::Optimality;
use crate::programs::{
    blocking, run_solver, Answer, Decision, DesignRequest, Form, Goal, Outcome, SolveRequest,
    SynthesisError, Synthesized, CONTAINMENT_WEIGHTS,
};
use crate::scaling::Scaling;
use sdp::lmi::LmiProblem;
use sdp::solve::{alternative, Backend, Observer, Solution, Status};

/// Back-offs of the exported design's gain bound above the smallest one, relative, tried in order: they leave a margin
/// for the proof.
const GAIN_BACK_OFFS: [f64; 2] = [1e-3, 1e-2];

/// Relative allowance in gamma of the large-set certificate, so that the check can prove it.
const CLAIM_ALLOWANCE: f64 = 1e-5;

/// The first ratio of the sizes of the inner and the large set.
const FIRST_SCALE: f64 = 0.25;

/// Factor from one ratio to the next: the smaller the inner set, the smaller its gain, until the
/// large-set certificate no longer holds.
const SCALE_STEP: f64 = 0.7;

/// Ratios are tried down to this one.
const SMALLEST_SCALE: f64 = 1e-3;

/// Halvings of the last step, on a logarithmic scale.
const HALVINGS: usize = 2;

/// The scalars that must be chosen before the problem is linear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CouplingChoice {
    /// Weight rho of the containment condition.
    pub containment_weight: f64,
    /// How the certificates are tied together.
    pub coupling: Coupling,
}

impl CouplingChoice {
    /// The choice with a ratio of the sizes of the two sets. Upsilon goes with the inverse square of the
    /// size of a set, as Q does.
    pub fn new(containment_weight: f64, inner_scale: f64) -> Self {
        CouplingChoice {
            containment_weight,
            coupling: Coupling {
                inner_scale,
                trigger_multiple: inner_scale * inner_scale,
            },
        }
    }

    /// What is tried first for a model.
    pub fn first(outer: &OuterSpecs) -> Self {
        let weight = outer.containment_weight.unwrap_or(CONTAINMENT_WEIGHTS[0]);
        CouplingChoice::new(weight, outer.inner_scale.unwrap_or(FIRST_SCALE))
    }
}

/// A choice that was tried, and its result.
#[derive(Debug, Clone)]
pub struct TriedCoupling {
    /// The choice.
    pub choice: CouplingChoice,
    /// The solver's status, unverified.
    pub status: String,
    /// Guaranteed gain of the inner certificate in the solver's point, which is not proved; `None`
    /// without a point.
    pub guaranteed_gain: Option<f64>,
}

/// The outcome of the search.
#[derive(Debug, Clone)]
pub enum TwoCertificatesOutcome {
    /// A design; its report says whether it is proved.
    Solved(Box<Synthesized>, Vec<TriedCoupling>),
    /// The solver found no design in any attempt. Nothing is proved by that.
    None {
        /// True when it called every attempt infeasible; otherwise it failed numerically.
        infeasible: bool,
        /// The attempts.
        tried: Vec<TriedCoupling>,
        /// The conditions with the largest fractions of an attempt's dual solution, largest first.
        blocking: Vec<(String, f64)>,
        /// The solver's runs.
        runs: Vec<SolverRun>,
    },
}

impl TwoCertificatesOutcome {
    /// True for a design whose two certificates are proved.
    fn is_proved(&self) -> bool {
        matches!(self, TwoCertificatesOutcome::Solved(design, _) if design.report.verdict == Verdict::Proved)
    }

    /// The outcome of two solvers, in this order: the proved design, or the first design that is not, with the
    /// runs of both.
    fn or(self, other: Self) -> Self {
        let swap = other.is_proved() || !matches!(self, TwoCertificatesOutcome::Solved(..));
        let mut all = self.runs().to_vec();
        all.extend_from_slice(other.runs());
        let refused = |one: &Self| {
            matches!(
                one,
                TwoCertificatesOutcome::None {
                    infeasible: true,
                    ..
                }
            )
        };
        let any_refused = refused(&self) || refused(&other);
        let mut out = if swap { other } else { self };
        match &mut out {
            TwoCertificatesOutcome::Solved(design, _) => {
                design.solve_seconds = all.iter().map(|run| run.seconds).sum();
                design.file.provenance.solver_runs = all;
            }
            TwoCertificatesOutcome::None {
                infeasible, runs, ..
            } => {
                *infeasible = any_refused;
                *runs = all;
            }
        }
        out
    }

    fn runs(&self) -> &[SolverRun] {
        match self {
            TwoCertificatesOutcome::Solved(design, _) => &design.file.provenance.solver_runs,
            TwoCertificatesOutcome::None { runs, .. } => runs,
        }
    }
}

impl From<TwoCertificatesOutcome> for Outcome {
    /// Without a design nothing is proved.
    fn from(found: TwoCertificatesOutcome) -> Self {
        match found {
            TwoCertificatesOutcome::Solved(design, _) => Outcome::Solved(design),
            TwoCertificatesOutcome::None {
                infeasible,
                blocking,
                runs,
                ..
            } => {
                let decision = Decision {
                    answer: Answer::Undecided(None),
                    slack: None,
                    blocking,
                    limiting_factors: None,
                    solve_seconds: runs.iter().map(|run| run.seconds).sum(),
                    runs,
                };
                match infeasible {
                    true => Outcome::Undecided(decision),
                    false => Outcome::SolverFailed(decision),
                }
            }
        }
    }
}

/// Both tasks in units of their own.
fn scaled(model: &Model, outer: &Model, choice: CouplingChoice) -> (Scaled, Scaled) {
    let outer_task = outer.task();
    let starts = outer_task.specification.must_contain.iter();
    let farthest = starts.map(|state| state.norm()).fold(0.0, f64::max);
    let size = (0.5 * farthest).max(f64::MIN_POSITIVE);
    let in_units = |mut task: Task, size: f64| {
        task.specification.containment_weight = choice.containment_weight;
        let scaling = Scaling::of_size(&task.system, size);
        Scaled {
            task: scaling.apply(&task),
            scaling,
        }
    };
    (
        in_units(model.task(), choice.coupling.inner_scale * size),
        in_units(outer_task, size),
    )
}

/// The problem of the smallest inner gain, for export: with the given choice, or what synthesis tries
/// first.
///
/// # Errors
/// A model without `specs.outer`.
pub fn coupled_problem(
    model: &Model,
    form: Form,
    choice: Option<CouplingChoice>,
) -> Result<LmiProblem, ModelError> {
    let outer = model.large_set()?;
    let first = model.file.specs.outer.as_ref().map(CouplingChoice::first);
    let choice = choice
        .or(first)
        .unwrap_or(CouplingChoice::new(CONTAINMENT_WEIGHTS[0], FIRST_SCALE));
    let (inner, outer) = scaled(model, &outer, choice);
    Ok(assemble(&inner, &outer, choice.coupling, form, Goal::SmallestGain).problem)
}

/// Synthesizes one controller with two certificates and checks both. Where the given solver finds none that is
/// proved, the other one is tried.
///
/// # Errors
/// As for a design with one; a model without `specs.outer`.
pub fn synthesize_two_certificates(
    model: &Model,
    model_text: &str,
    form: Form,
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<TwoCertificatesOutcome, SynthesisError> {
    let first = synthesize_with(model, model_text, form, backend, observer.clone())?;
    let other = alternative(backend);
    let Some(other) = other.as_deref().filter(|_| !first.is_proved()) else {
        return Ok(first);
    };
    let form = form.for_backend(other);
    let second = synthesize_with(model, model_text, form, other, observer)?;
    Ok(first.or(second))
}

/// With one solver.
fn synthesize_with(
    model: &Model,
    model_text: &str,
    form: Form,
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<TwoCertificatesOutcome, SynthesisError> {
    let outer = model.large_set()?;
    let task = model.task();
    let run = CoupledSynthesis {
        subject: DesignRequest::of_model(model, model_text, &task, form),
        outer: &outer,
        backend,
        observer,
        runs: Vec::new(),
        tried: Vec::new(),
        points: Vec::new(),
        blocking: Vec::new(),
        infeasible: false,
    };
    run.search()
}

/// A solver's point of the smallest gain.
#[derive(Clone, Copy)]
struct GainPoint {
    choice: CouplingChoice,
    /// The smallest gamma, SI units.
    gamma: f64,
    /// Guaranteed gain.
    gain: f64,
}

struct CoupledSynthesis<'a> {
    subject: DesignRequest<'a>,
    outer: &'a Model,
    backend: &'a dyn Backend,
    observer: Option<Observer>,
    runs: Vec<SolverRun>,
    tried: Vec<TriedCoupling>,
    points: Vec<GainPoint>,
    blocking: Vec<(String, f64)>,
    infeasible: bool,
}

impl CoupledSynthesis<'_> {
    fn search(mut self) -> Result<TwoCertificatesOutcome, SynthesisError> {
        let specs = self.subject.model.file.specs.outer.clone();
        let given = specs.as_ref().and_then(|outer| outer.inner_scale);
        let weight = specs.as_ref().and_then(|outer| outer.containment_weight);
        let weights = weight.map_or(CONTAINMENT_WEIGHTS.to_vec(), |weight| vec![weight]);
        for weight in weights {
            match given {
                Some(scale) => {
                    self.point(CouplingChoice::new(weight, scale))?;
                }
                None => self.search_scale(weight)?,
            }
            if !self.points.is_empty() {
                break;
            }
        }
        self.points.sort_by(|a, b| a.gain.total_cmp(&b.gain));
        let mut unproved = None;
        let points = self.points.clone();
        for (point, back_off) in points
            .iter()
            .flat_map(|point| GAIN_BACK_OFFS.map(|back_off| (*point, back_off)))
        {
            match self.design(point, back_off)? {
                Some(design) if design.report.verdict == Verdict::Proved => {
                    return Ok(self.closed(design));
                }
                Some(design) => unproved = unproved.or(Some(design)),
                None => {}
            }
        }
        Ok(match unproved {
            Some(design) => self.closed(design),
            None => TwoCertificatesOutcome::None {
                infeasible: self.infeasible && self.points.is_empty(),
                tried: self.tried,
                blocking: self.blocking,
                runs: self.runs,
            },
        })
    }

    /// Smaller and smaller ratios until one fails, then between the last two; larger ones first where
    /// the first fails.
    fn search_scale(&mut self, weight: f64) -> Result<(), SynthesisError> {
        let mut scale = FIRST_SCALE;
        while self.point(CouplingChoice::new(weight, scale))?.is_none() {
            scale *= 2.0;
            if scale > 1.0 {
                return Ok(());
            }
        }
        let (mut best, mut failed) = (scale, None);
        while failed.is_none() && best > SMALLEST_SCALE {
            let next = best * SCALE_STEP;
            match self.better(CouplingChoice::new(weight, next))? {
                true => best = next,
                false => failed = Some(next),
            }
        }
        let mut failed = failed.unwrap_or(best);
        for _ in 0..HALVINGS {
            let next = (best * failed).sqrt();
            match self.better(CouplingChoice::new(weight, next))? {
                true => best = next,
                false => failed = next,
            }
        }
        Ok(())
    }

    /// Whether a choice has a point with a smaller gain than all before it.
    fn better(&mut self, choice: CouplingChoice) -> Result<bool, SynthesisError> {
        let gains = self.points.iter().map(|point| point.gain);
        let least = gains.fold(f64::INFINITY, f64::min);
        let point = self.point(choice)?;
        Ok(point.is_some_and(|point| point.gain < least))
    }

    /// The smallest gain for a choice; kept where there is one.
    fn point(&mut self, choice: CouplingChoice) -> Result<Option<GainPoint>, SynthesisError> {
        let (inner, outer) = scaled(self.subject.model, self.outer, choice);
        let goal = Goal::SmallestGain;
        let (coupled, solution) = self.solve((&inner, &outer), choice, goal)?;
        let mut found = None;
        match solution.status {
            Status::Solved | Status::Inaccurate => {
                let model = self.subject.model;
                let recovered = recover(model, &coupled.inner, &solution.values, &inner.scaling);
                found = recovered.ok().map(|certificate| GainPoint {
                    choice,
                    gamma: solution.objective,
                    gain: certificate.guaranteed_gain,
                });
                found = found.filter(|point| point.gamma > 0.0 && point.gain.is_finite());
            }
            Status::Infeasible => {
                self.infeasible = true;
                self.blocking = blocking(&coupled.problem.conditions, &solution);
            }
            Status::Unbounded | Status::Failed | Status::Cancelled => {}
        }
        self.tried.push(TriedCoupling {
            choice,
            status: solution.status_text,
            guaranteed_gain: found.map(|point| point.gain),
        });
        self.points.extend(found);
        Ok(found)
    }

    fn solve(
        &mut self,
        (inner, outer): (&Scaled, &Scaled),
        choice: CouplingChoice,
        goal: Goal,
    ) -> Result<(Coupled, Solution), SynthesisError> {
        let coupled = assemble(inner, outer, choice.coupling, self.subject.form, goal);
        let request = SolveRequest {
            goal: goal.name(),
            vertices: inner.task.system.vertices.len() + outer.task.system.vertices.len(),
            accuracy: goal.accuracy(&inner.task),
        };
        let observer = self.observer.as_ref();
        let (solution, run) = run_solver(self.backend, &coupled.problem, &request, observer)?;
        self.runs.push(run);
        Ok((coupled, solution))
    }

    /// A design well inside, with a gamma a little above the smallest, checked as a reader of its file
    /// would; `None` where its numbers cannot be recovered.
    fn design(
        &mut self,
        point: GainPoint,
        back_off: f64,
    ) -> Result<Option<Box<Synthesized>>, SynthesisError> {
        let choice = point.choice;
        let (inner, outer) = scaled(self.subject.model, self.outer, choice);
        let goal = Goal::LargestMargin {
            gain_bound: point.gamma * (1.0 + back_off),
        };
        let (coupled, solution) = self.solve((&inner, &outer), choice, goal)?;
        let values = &solution.values;
        let parts = (
            recover(self.subject.model, &coupled.inner, values, &inner.scaling),
            recover(self.outer, &coupled.outer, values, &outer.scaling),
        );
        let (Ok(first), Ok(second)) = parts else {
            return Ok(None);
        };
        // The controller is the inner certificate's; that of the large set differs in the last digits only.
        let (_, mut certificate) = CertificateFile::split(&second);
        certificate.gamma = smallest_gamma(&second);
        certificate.xi = certificate.xi.min(self.outer.file.specs.xi_max);
        let outer = OuterFile {
            trigger_multiple: choice.coupling.trigger_multiple,
            certificate,
        };
        let units = ProblemUnits {
            state_fraction: 1.0,
            containment_weight: choice.containment_weight,
        };
        let second = (outer, choice.coupling);
        match self.subject.design_of_two(&first, second, units) {
            Ok(design) => Ok(Some(design)),
            // Numbers that no design file may hold: a failed attempt.
            Err(SynthesisError::Invalid(_)) => Ok(None),
            Err(other) => Err(other),
        }
    }

    /// A design with the record of all runs.
    fn closed(self, mut design: Box<Synthesized>) -> TwoCertificatesOutcome {
        let gains = self.points.iter().map(|point| point.gain);
        let best = gains.fold(f64::INFINITY, f64::min);
        let gain = design.file.certificate.guaranteed_gain;
        design.optimality = Optimality::of_smallest(gain, best);
        design.solve_seconds = self.runs.iter().map(|run| run.seconds).sum();
        design.file.provenance.solver_runs = self.runs;
        TwoCertificatesOutcome::Solved(design, self.tried)
    }
}

/// The smallest gamma with C'C <= gamma phi U and gamma >= xi, with a small allowance: from the guaranteed
/// gain sqrt(g xi), which was computed under a bound on gamma that does not bind.
fn smallest_gamma(certificate: &Certificate) -> f64 {
    let xi = certificate.disturbance_weight;
    let g = certificate.guaranteed_gain.powi(2) / xi;
    g.max(xi).min(UNBOUNDED_GAIN) * (1.0 + CLAIM_ALLOWANCE)
}
