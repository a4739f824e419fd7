//! One gain, two certificates.
//!
//! The inner certificate is for performance: a small set, the smallest gamma. The large-set certificate is for the
//! region: it must contain given starts. The controller (F, Upsilon) is the same, so that in each set
//! what is proved for it holds, and the command may saturate in the large set: with an N of its own, each certificate
//! admits as much saturation as it can prove.

use super::attempts::{Attempt, Attempts, Smallest, Synthesis};
use super::coupled::{assemble, Coupled, UNBOUNDED_GAIN};
use crate::certify::theorem1::{reached_from_rest, relative_supply, Certificate};
use crate::conditions::Task;
use crate::design::{
    hand_over, recover, CertificateFile, Coupling, DesignFile, OuterFile, ProblemUnits,
    SetHandOverFile,
};
use crate::model::{Model, ModelError};
use crate::optimality::Optimality;
use crate::programs::{
    blocking, complete_both, Answer, Blocking, Decision, DesignRequest, Form, Goal, Outcome,
    Session, Solvers, SynthesisError, Synthesized, CONTAINMENT_WEIGHTS,
};
use crate::scaling::Scaling;
use sdp::lmi::LmiProblem;
use sdp::solve::{Observer, Solution};

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

/// Ratios that differ by less than this, relative, are one.
const SAME_RATIO: f64 = 1e-9;

/// Ratios are tried down to this one.
const SMALLEST_SCALE: f64 = 1e-3;

/// Halvings of the last step, on a logarithmic scale.
const HALVINGS: usize = 1;

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
    fn new(containment_weight: f64, inner_scale: f64) -> Self {
        CouplingChoice {
            containment_weight,
            coupling: Coupling {
                inner_scale,
                trigger_multiple: inner_scale * inner_scale,
            },
        }
    }

    /// Whether another choice is the same but for the rounding of its ratio.
    fn is_about(&self, other: &Self) -> bool {
        let ratio = self.coupling.inner_scale / other.coupling.inner_scale;
        self.containment_weight == other.containment_weight && (ratio - 1.0).abs() < SAME_RATIO
    }

    /// What is tried first for a model.
    fn first(model: &Model) -> Self {
        let outer = model.file.specs.outer.as_ref();
        let weight = outer.and_then(|outer| outer.containment_weight);
        let scale = outer.and_then(|outer| outer.inner_scale);
        let weight = weight.unwrap_or(CONTAINMENT_WEIGHTS[0]);
        CouplingChoice::new(weight, scale.unwrap_or(FIRST_SCALE))
    }

    /// Both tasks in units of their own.
    fn scaled(self, model: &Model, outer: &Model) -> [(Scaling, Task); 2] {
        let outer = outer.task();
        let starts = outer.specification.must_contain.iter();
        let farthest = starts.map(|state| state.norm()).fold(0.0, f64::max);
        let size = (0.5 * farthest).max(f64::MIN_POSITIVE);
        let in_units = |mut task: Task, size: f64| {
            task.specification.containment_weight = self.containment_weight;
            let scaling = Scaling::of_size(&task.system, size);
            let scaled = scaling.apply(&task);
            (scaling, scaled)
        };
        [
            in_units(model.task(), self.coupling.inner_scale * size),
            in_units(outer, size),
        ]
    }
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
    let choice = choice.unwrap_or(CouplingChoice::first(model));
    let scaled = choice.scaled(model, &outer);
    Ok(assemble(&scaled, choice.coupling, form, Goal::SmallestGain).problem)
}

/// Synthesizes one controller with two certificates and checks both. Where the given solver finds none that is
/// proved, the other one is tried. Without a design nothing is proved.
///
/// # Errors
/// As for a design with one; a model without `specs.outer`.
pub fn synthesize(
    model: &Model,
    model_text: &str,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Outcome, SynthesisError> {
    let outer = model.large_set()?;
    let task = model.task();
    let mut session = Session::new(solvers, observer);
    let (mut smallest, mut couplings, mut blocking) = (f64::INFINITY, 0, Vec::new());
    let proved = |found: &CouplingAttempts| found.best.is_some();
    let found = Attempts::with_each_solver::<CoupledSynthesis>(&mut session, proved, |session| {
        let mut synthesis = CoupledSynthesis {
            request: DesignRequest::of_model(model, model_text, &task, session.form),
            outer: &outer,
            session,
            gains: Vec::new(),
            tried: Vec::new(),
            couplings: 0,
            blocking: Vec::new(),
        };
        let found = synthesis.in_all_settings()?;
        smallest = synthesis.gains.into_iter().fold(smallest, f64::min);
        (couplings, blocking) = (synthesis.couplings, synthesis.blocking);
        Ok(found)
    })?;
    if let Some(design) = found.best.or(found.unproved) {
        let mut design = design.with_runs(&session.runs);
        let gain = design.file.certificate.guaranteed_gain;
        design.optimality = Optimality::of_smallest(gain, smallest);
        return Ok(Outcome::Solved(design));
    }
    let decision = Decision {
        blocking,
        couplings,
        ..Decision::new(Answer::Undecided(None), &session.runs)
    };
    Ok(match found.infeasible > 0 {
        true => Outcome::Undecided(decision),
        false => Outcome::SolverFailed(decision),
    })
}

/// The smallest gain of the inner certificate, with one solver.
struct CoupledSynthesis<'a, 'b, 'c> {
    request: DesignRequest<'a>,
    outer: &'a Model,
    session: &'b mut Session<'c>,
    /// Guaranteed gain of the inner certificate in every point of a smallest gain, in their order.
    gains: Vec<f64>,
    /// The choices of the search of a ratio, in their order.
    tried: Vec<CouplingChoice>,
    /// How many choices were tried.
    couplings: usize,
    /// The conditions with the largest fractions of the last dual solution that refutes a choice.
    blocking: Vec<Blocking>,
}

impl Synthesis for CoupledSynthesis<'_, '_, '_> {
    type Settings = CouplingChoice;
    type File = DesignFile;

    fn smallest(&mut self, &choice: &CouplingChoice) -> Result<Smallest, SynthesisError> {
        let scaled = choice.scaled(self.request.model, self.outer);
        let (coupled, solution) = self.solve(&scaled, choice, Goal::SmallestGain)?;
        self.couplings += 1;
        let smallest = Smallest::of(&coupled.problem, &solution);
        match smallest {
            Smallest::Bound { .. } => {
                let [(scaling, task), _] = &scaled;
                let model = self.request.model;
                let recovered = recover(model, &coupled.inner, &solution.values, (scaling, task));
                let gain = recovered.map_or(f64::NAN, |certificate| certificate.guaranteed_gain);
                if !gain.is_finite() {
                    return Ok(Smallest::Failed);
                }
                self.gains.push(gain);
            }
            Smallest::Infeasible => {
                self.blocking = blocking(&coupled.problem.conditions, &solution);
            }
            Smallest::Failed => {}
        }
        Ok(smallest)
    }

    fn design(
        &mut self,
        &choice: &CouplingChoice,
        gain_bound: f64,
    ) -> Result<Option<Box<Synthesized>>, SynthesisError> {
        let scaled = choice.scaled(self.request.model, self.outer);
        let goal = Goal::LargestMargin { gain_bound };
        let (coupled, solution) = self.solve(&scaled, choice, goal)?;
        let [inner, outer] = &scaled;
        let values = &solution.values;
        let parts = (
            recover(
                self.request.model,
                &coupled.inner,
                values,
                (&inner.0, &inner.1),
            ),
            recover(self.outer, &coupled.outer, values, (&outer.0, &outer.1)),
        );
        let (Some(first), Some(second)) = parts else {
            return Ok(None);
        };
        let multiple = choice.coupling.trigger_multiple;
        let models = [self.request.model, self.outer];
        let complete = complete_both(models, [first, second], multiple, self.session)?;
        let Some([first, second]) = complete else {
            return Ok(None);
        };
        // The controller is the inner certificate's; that of the large set differs in the last digits only.
        let large = (self.outer, &second);
        let handed_over = hand_over(large, (self.request.model, &first));
        let (_, mut certificate) = CertificateFile::split(&second);
        certificate.gamma = smallest_gamma(self.outer, &second);
        certificate.xi = certificate.xi.min(self.outer.file.specs.xi_max);
        let second = OuterFile {
            trigger_multiple: multiple,
            certificate,
            hand_over: handed_over.as_ref().map(SetHandOverFile::of),
        };
        let units = ProblemUnits::of_fraction(1.0, choice.containment_weight);
        let second = Some((second, choice.coupling));
        Ok(self.request.design(&first, second, &units))
    }

    fn objective(file: &DesignFile) -> f64 {
        file.certificate.guaranteed_gain
    }
}

/// The results of the attempts with all couplings.
type CouplingAttempts = Attempts<CouplingChoice, DesignFile>;

impl CoupledSynthesis<'_, '_, '_> {
    /// The smallest gain over all ratios under the first containment weight that has one; then designs from the
    /// smallest gain upwards, until one is proved.
    fn in_all_settings(&mut self) -> Result<CouplingAttempts, SynthesisError> {
        let mut found = Attempts::default();
        let specs = self.request.model.file.specs.outer.as_ref();
        let given = specs.and_then(|outer| outer.inner_scale);
        let weight = specs.and_then(|outer| outer.containment_weight);
        for weight in weight.map_or(CONTAINMENT_WEIGHTS.to_vec(), |weight| vec![weight]) {
            match given {
                Some(scale) => {
                    found.smallest(self, &CouplingChoice::new(weight, scale))?;
                }
                None => self.search_scale(weight, &mut found)?,
            }
            if !found.bounds.is_empty() {
                // The conditions can hold.
                found.infeasible = 0;
                break;
            }
        }
        let mut points: Vec<_> = self.gains.iter().zip(&found.bounds).collect();
        points.sort_by(|a, b| a.0.total_cmp(b.0));
        let points: Vec<_> = points.into_iter().map(|(_, point)| *point).collect();
        let mut unproved = None;
        'points: for point in points {
            for back_off in GAIN_BACK_OFFS {
                if found.back_off(self, &[point], &[back_off])? == Attempt::Proved {
                    break 'points;
                }
                unproved = unproved.or(found.unproved.take());
            }
        }
        found.unproved = unproved;
        Ok(found)
    }

    /// Ratios until one has a point; then smaller and smaller ones, or larger and larger ones, as long as the gain falls; the
    /// same with smaller steps.
    fn search_scale(
        &mut self,
        weight: f64,
        found: &mut CouplingAttempts,
    ) -> Result<(), SynthesisError> {
        let mut best = FIRST_SCALE;
        while !self.is_better(CouplingChoice::new(weight, best), found)? {
            best *= 2.0;
            if best > 1.0 {
                return Ok(());
            }
        }
        let mut step = SCALE_STEP;
        for _ in 0..=HALVINGS {
            for factor in [step, 1.0 / step] {
                let before = best;
                while self.is_better_ratio(weight, best * factor, found)? {
                    best *= factor;
                }
                if best != before {
                    break;
                }
            }
            step = step.sqrt();
        }
        Ok(())
    }

    /// As [`Self::is_better`] for a ratio; false where it is too small or too large.
    fn is_better_ratio(
        &mut self,
        weight: f64,
        ratio: f64,
        found: &mut CouplingAttempts,
    ) -> Result<bool, SynthesisError> {
        let choice = CouplingChoice::new(weight, ratio);
        let allowed = (SMALLEST_SCALE..=1.0).contains(&ratio);
        let is_new = self.tried.iter().all(|other| !other.is_about(&choice));
        Ok(allowed && is_new && self.is_better(choice, found)?)
    }

    /// Whether a choice has a point with a smaller gain than all before it.
    fn is_better(
        &mut self,
        choice: CouplingChoice,
        found: &mut CouplingAttempts,
    ) -> Result<bool, SynthesisError> {
        let least = self.gains.iter().copied().fold(f64::INFINITY, f64::min);
        self.tried.push(choice);
        found.smallest(self, &choice)?;
        Ok(self.gains.iter().any(|gain| *gain < least))
    }

    fn solve(
        &mut self,
        scaled: &[(Scaling, Task); 2],
        choice: CouplingChoice,
        goal: Goal,
    ) -> Result<(Coupled, Solution), SynthesisError> {
        let coupled = assemble(scaled, choice.coupling, self.request.form, goal);
        let tasks = scaled.iter().map(|(_, task)| task.system.vertices.len());
        let accuracy = goal.accuracy(&scaled[0].1);
        let vertices = tasks.sum();
        let solution = self
            .session
            .run(&coupled.problem, goal.name(), accuracy, vertices)?;
        Ok((coupled, solution))
    }
}

/// The smallest gamma with C'C <= gamma phi U that is not below what feeds the functional, with a small allowance: from
/// the guaranteed gain, which was computed under a bound on gamma that does not bind.
fn smallest_gamma(model: &Model, certificate: &Certificate) -> f64 {
    let xi = certificate.disturbance_weight;
    let taubar = model.task().system.disturbance_bound;
    let reached = reached_from_rest(model, certificate);
    let gain = certificate.guaranteed_gain;
    let g = match taubar > 0.0 {
        true => (gain * taubar).powi(2) / (reached * model.file.specs.phi_per_s),
        false => gain.powi(2) / xi,
    };
    let least = relative_supply(model, certificate).max(xi);
    g.max(least).min(UNBOUNDED_GAIN) * (1.0 + CLAIM_ALLOWANCE)
}
