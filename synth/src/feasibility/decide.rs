//! One solve, one proof.

use super::candidate::Source;
use super::centre::centred;
use super::file::{InfeasibilityFile, WeightsFile};
use crate::certify::infeasible::{refute, Refutation, Weights};
use crate::certify::Verdict;
use crate::conditions::{GainPlan, Task};
use crate::design::{recover, ProblemUnits, SolverRun};
use crate::lmi::Affine;
use crate::model::Model;
use crate::scaling::Scaling;
use crate::solve::{Backend, Observer, Solution, Status};
use crate::synthesis::{
    blocking, containment_weights, scaled, Assembled, Form, Goal, Search, Shortfall, Subject,
    SynthesisError, Synthesized, STATE_UNITS,
};

/// A proved no.
#[derive(Debug, Clone)]
pub struct Infeasible {
    /// The file that proves it.
    pub file: InfeasibilityFile,
    /// No design exists whose multiplier Qh has all entries (SI units) within this bound; the largest
    /// double when none is needed.
    pub bound: f64,
}

/// The answer.
#[derive(Debug, Clone)]
pub enum Answer {
    /// A design exists: this one is proved. Its gain is not the smallest.
    Feasible(Box<Synthesized>),
    /// No design exists: proved.
    Infeasible(Box<Infeasible>),
    /// Neither is proved.
    Unknown,
}

/// The answer and what is known beside it.
#[derive(Debug, Clone)]
pub struct Decision {
    /// The answer.
    pub answer: Answer,
    /// The smallest slack t with which every condition but the gain's holds, in scaled units, where
    /// the solver found it: an estimate, not proved. Above 0 they cannot hold with the margin of the
    /// model.
    pub slack: Option<f64>,
    /// The conditions with the largest share of the dual solution: those that block, when t is
    /// above 0.
    pub blocking: Vec<(String, f64)>,
    /// What a search reached instead, where there was one.
    pub shortfall: Option<Box<Shortfall>>,
    /// Time spent in solvers (s).
    pub solve_seconds: f64,
    /// The solver's runs.
    pub runs: Vec<SolverRun>,
}

/// Decides whether a design exists for a model. `model_text` is its file's text.
pub fn decide(
    model: &Model,
    model_text: &str,
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<Decision, SynthesisError> {
    let mut search = Search::new(Form::Reduced, backend, observer);
    decide_after(subject(model, model_text, &model.task()), &mut search)
}

/// Looks for a design only: an answer that is not [`Answer::Feasible`] is [`Answer::Unknown`].
pub(super) fn look_for_a_design(
    model: &Model,
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<Decision, SynthesisError> {
    let mut search = Search::new(Form::Reduced, backend, observer);
    let task = model.task();
    let found = settle(subject(model, "", &task), &mut search, Sought::Design)?;
    Ok(found.decision(&search))
}

fn subject<'a>(model: &'a Model, model_text: &'a str, task: &'a Task) -> Subject<'a> {
    Subject {
        model,
        model_text,
        task,
        gains_text: None,
        form: Form::Reduced,
    }
}

/// The same after other runs, which are counted.
pub(crate) fn decide_after(
    subject: Subject,
    search: &mut Search,
) -> Result<Decision, SynthesisError> {
    // Only the reduced form's dual solution has the blocks of a proof.
    let mut own = search.fresh(Form::Reduced);
    let subject = Subject {
        form: Form::Reduced,
        ..subject
    };
    let found = settle(subject, &mut own, Sought::Proof);
    search.runs.append(&mut own.runs);
    Ok(found?.decision(search))
}

/// What is sought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sought {
    /// A design, or a proof that there is none.
    Proof,
    /// A design; where the solver says that there is none, nothing more.
    Design,
}

struct Found {
    answer: Answer,
    slack: Option<f64>,
    blocking: Vec<(String, f64)>,
}

impl Found {
    fn decision(self, search: &Search) -> Decision {
        Decision {
            answer: self.answer,
            slack: self.slack,
            blocking: self.blocking,
            shortfall: None,
            solve_seconds: search.seconds(),
            runs: search.runs.clone(),
        }
    }
}

/// What one containment weight gave.
enum Part {
    Point(Box<Synthesized>),
    Refuted(Box<WeightsFile>, Refutation),
    /// The solver says that there is no design, and nobody asked for a proof.
    Denied,
    Open,
}

fn settle(subject: Subject, search: &mut Search, sought: Sought) -> Result<Found, SynthesisError> {
    let mut out = Found {
        answer: Answer::Unknown,
        slack: None,
        blocking: Vec::new(),
    };
    let mut refuted = Vec::new();
    let mut open = false;
    let mut last_units = None;
    for &containment_weight in containment_weights(subject.model) {
        let mut part = Part::Open;
        for state_fraction in STATE_UNITS {
            let units = ProblemUnits {
                state_fraction,
                containment_weight,
            };
            last_units = Some(units);
            part = attempt(subject, search, units, sought, &mut out)?;
            if !matches!(part, Part::Open) {
                break;
            }
        }
        match part {
            Part::Point(mut design) => {
                design.solve_seconds = search.seconds();
                design.file.provenance.solver_runs = search.runs.clone();
                out.answer = Answer::Feasible(design);
                return Ok(out);
            }
            Part::Refuted(weights, refutation) => refuted.push((*weights, refutation)),
            Part::Denied | Part::Open => open = true,
        }
    }
    if let (false, Some(units)) = (open, last_units) {
        let bounds = refuted.iter().map(|(_, refutation)| refutation.bound);
        let bound = bounds.fold(f64::MAX, f64::min);
        let weights = refuted.into_iter().map(|(weights, _)| weights).collect();
        let mut provenance = subject.provenance(units);
        provenance.solver_runs = search.runs.clone();
        let file = InfeasibilityFile::new(subject.model, weights, provenance);
        out.answer = Answer::Infeasible(Box::new(Infeasible { file, bound }));
    }
    Ok(out)
}

fn attempt(
    subject: Subject,
    search: &mut Search,
    units: ProblemUnits,
    sought: Sought,
    out: &mut Found,
) -> Result<Part, SynthesisError> {
    let (scaling, mut task) = scaled(subject.task, units);
    let threshold = &mut task.specification.trigger_threshold;
    *threshold = threshold.max(SMALLEST_THRESHOLD);
    let (assembled, solution) = search.solve(&task, Goal::SmallestSlack)?;
    let usable = matches!(solution.status, Status::Solved | Status::Inaccurate);
    if usable {
        let smaller = out.slack.is_none_or(|slack| solution.objective < slack);
        if smaller {
            out.slack = Some(solution.objective);
            out.blocking = blocking(&assembled.problem.conditions, &solution);
        }
    }
    if solution.objective < task.specification.margin {
        if let Some(design) = point(subject, &assembled, &solution, &scaling, units)? {
            return Ok(Part::Point(design));
        }
    }
    if usable && sought == Sought::Design {
        return Ok(Part::Denied);
    }
    // The weights speak of one gain that is free.
    if task.gains != GainPlan::constant() {
        return Ok(Part::Open);
    }
    let margin = task.specification.margin;
    let excess = solution.objective - margin;
    if excess.is_nan() || excess <= 0.0 {
        return Ok(Part::Open);
    }
    let problem = assembled.problem.lower();
    let centre = centred(&problem, &solution.duals, -(margin + KEPT * excess));
    let source = Source {
        model: subject.model,
        scaling: &scaling,
        task: &task,
        assembled: &assembled,
        duals: centre.as_ref().unwrap_or(&solution.duals),
        size: KEPT * excess,
    };
    if let Some((file, weights)) = as_read(&source) {
        let refutation = refute(subject.model, &weights);
        if refutation.proved {
            return Ok(Part::Refuted(Box::new(file), refutation));
        }
    }
    Ok(Part::Open)
}

/// The weights as a reader of their file gets them, `None` where no file may hold them.
fn as_read(source: &Source) -> Option<(WeightsFile, Weights)> {
    let file = WeightsFile::new(&source.weights()?, source.model);
    let weights = file.weights(source.model).ok()?;
    Some((file, weights))
}

/// The smallest trigger threshold with which the problem is solved: with 0 its dual solutions have no
/// inside. A design for a larger threshold is one for the model's; the weights leave the held state
/// out, see [`Source::weights`].
const SMALLEST_THRESHOLD: f64 = 1e-6;

/// Part of the slack above the margin that the weights of a proof keep; the rest moves them inside.
const KEPT: f64 = 0.25;

/// Stands for a gain bound that is not known yet.
const UNKNOWN_GAIN: f64 = 1e300;

/// Room above the smallest gain bound that a point admits.
const GAIN_ROOM: f64 = 1e-3;

/// The solver's point as a proved design, with the gain bound it admits.
fn point(
    subject: Subject,
    assembled: &Assembled,
    solution: &Solution,
    scaling: &Scaling,
    units: ProblemUnits,
) -> Result<Option<Box<Synthesized>>, SynthesisError> {
    let mut unknowns = assembled.design.clone();
    unknowns.gain_bound = Affine::identity(1, UNKNOWN_GAIN);
    let Ok(mut certificate) = recover(subject.model, &unknowns, &solution.values, scaling) else {
        return Ok(None);
    };
    let xi = certificate.disturbance_weight;
    let guaranteed = certificate.guaranteed_gain;
    let gain_bound = (guaranteed * guaranteed / xi).max(xi) * (1.0 + GAIN_ROOM);
    if !(gain_bound > 0.0 && gain_bound.is_finite()) {
        return Ok(None);
    }
    certificate.gain_bound = gain_bound;
    certificate.guaranteed_gain = guaranteed.min(gain_bound);
    let design = match subject.design(&certificate, units) {
        Ok(design) => design,
        // Numbers that no design file may hold prove nothing.
        Err(SynthesisError::Invalid(_)) => return Ok(None),
        Err(other) => return Err(other),
    };
    Ok((design.report.verdict == Verdict::Proved).then_some(design))
}
