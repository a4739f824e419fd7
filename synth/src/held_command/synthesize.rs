//! From given gains with a trigger on the command to a checked proof.

use nalgebra::DMatrix;

use super::claims::{claimed, largest_hand_over};
use super::file::{
    check_covered, CommandCertificateFile, CommandControllerFile, CommandProof, HandOverFile,
    HeldCommandDesignFile, HeldCommandProvenance,
};
use super::program::{Aim, Stated, Tie};
use super::scaled::{ScaledTask, Shares};
use crate::certify::held_command::{
    reached_from_rest, HeldCommandCertificate, HeldCommandLaw, Stage,
};
use crate::certify::Report;
use crate::design::{rows, DESIGN_SCHEMA_VERSION};
use crate::fuzzy::ExactSpacecraft;
use crate::model::{CommandTrigger, CommandTriggerSpecs, GivenTrigger, Model, ModelError, Plant};
use crate::programs::{
    has_point, now, sha256_of, Decision, Form, Outcome, Session, Solvers, SynthesisError,
    Synthesized, GENERATOR,
};
use sdp::solve::Observer;

/// A proof and how it was found.
pub type HeldCommandSynthesized = Synthesized<HeldCommandDesignFile>;

/// The outcome of a synthesis; there is no proof that no proof exists.
pub type HeldCommandOutcome = Outcome<HeldCommandDesignFile, Decision<()>>;

/// Back-offs of the objective from its optimum, relative: they leave a margin for the proof. Tried in order.
const BACK_OFFS: [f64; 3] = [5e-3, 1e-2, 3e-2];

/// The hand-over level above r / phi, relative.
const ABOVE_REACHED: f64 = 1e-3;

/// Values of theta that are tried where none is given; the best one's neighbours are tried too.
const SHARES: [f64; 5] = [1.0, 0.7, 0.5, 0.4, 0.3];

/// Model and law with the texts that they come from.
pub struct CommandRequest<'a> {
    /// The model.
    pub model: &'a Model,
    /// Its text.
    pub model_text: &'a str,
    /// F, m x n.
    pub gain: &'a DMatrix<f64>,
    /// The trigger.
    pub trigger: CommandTrigger,
    /// The text of the gains file.
    pub gains_text: &'a str,
}

/// A certificate that was found on the way.
struct Candidate {
    certificate: HeldCommandCertificate,
    /// r / phi, rounded up.
    reached: f64,
}

/// Seeks a proof: one certificate, or the chain of two where the model asks for it. The solvers are asked in the order
/// given, each only where those before it prove nothing. Only the check decides what is proved.
///
/// # Errors
/// A model without `specs.command_trigger`, with imperfections, an uncertain inertia or another plant than a known
/// spacecraft; a cancelled run.
pub fn synthesize(
    request: &CommandRequest,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<HeldCommandOutcome, SynthesisError> {
    let search = Search::new(request)?;
    let mut runs = Vec::new();
    let mut unproved = None;
    let asked = solvers.in_order().into_iter();
    let asked = asked.map(|(backend, _)| (backend, Form::Full));
    for mut session in Session::each_alone(asked, observer.as_ref()) {
        let found = search.run(&mut session)?;
        runs.append(&mut session.runs);
        match found {
            Some(design) if design.is_proved() => {
                return Ok(Outcome::Solved(design.with_runs(&runs)))
            }
            Some(design) => unproved = Some(design),
            None => {}
        }
    }
    Ok(match unproved {
        Some(design) => Outcome::Solved(design.with_runs(&runs)),
        None => Outcome::Undecided(Decision::new((), &runs)),
    })
}

/// What is asked, checked.
struct Search<'a> {
    request: &'a CommandRequest<'a>,
    law: HeldCommandLaw,
    specs: &'a CommandTriggerSpecs,
    craft: &'a ExactSpacecraft,
    last: Option<Model>,
}

/// Refuses models for which no certificate is sought, though a file's may be checked.
///
/// # Errors
/// An uncertain inertia, and what [`check_covered`] refuses.
pub fn check_synthesized(model: &Model) -> Result<(), ModelError> {
    if model.plant.has_uncertain_inertia() {
        let reason = "gains with a trigger on the command need an inertia that is known";
        return Err(ModelError::choice(
            "plant.exact.inertia_uncertainty",
            reason,
        ));
    }
    check_covered(model)
}

fn refused(field: &str, reason: &str) -> SynthesisError {
    ModelError::choice(field, reason).into()
}

impl<'a> Search<'a> {
    fn new(request: &'a CommandRequest<'a>) -> Result<Self, SynthesisError> {
        let model = request.model;
        let Plant::Spacecraft(craft) = &model.plant else {
            let reason = "gains with a trigger on the command need an 'exact' plant";
            return Err(refused("plant", reason));
        };
        check_synthesized(model)?;
        let Some(specs) = &model.file.specs.command_trigger else {
            return Err(refused("specs.command_trigger", "is missing"));
        };
        Ok(Search {
            law: HeldCommandLaw {
                gain: request.gain.clone(),
                trigger: request.trigger,
            },
            specs,
            craft,
            last: model.final_set()?,
            request,
        })
    }

    fn run(
        &self,
        session: &mut Session,
    ) -> Result<Option<Box<HeldCommandSynthesized>>, SynthesisError> {
        let Some(within_limit) = self.share(session)? else {
            return Ok(None);
        };
        let mut best = None;
        for back_off in BACK_OFFS {
            let Some(proof) = self.attempt(session, within_limit, back_off)? else {
                continue;
            };
            let design = self.design(&proof);
            if design.is_proved() {
                return Ok(Some(design));
            }
            best = Some(design);
        }
        Ok(best)
    }

    /// theta: as given, or the one with the best objective.
    fn share(&self, session: &mut Session) -> Result<Option<f64>, SynthesisError> {
        if self.specs.within_limit.is_some() {
            return Ok(self.specs.within_limit);
        }
        let mut tried: Vec<(f64, f64)> = Vec::new();
        let mut list = SHARES.to_vec();
        for round in 0..2 {
            for within_limit in list.drain(..) {
                let scaled = self.scaled(self.request.model, within_limit, self.specs.final_level);
                let stated = Stated::state(&scaled, self.aim(), &self.tie(&scaled));
                let name = format!("best at theta = {within_limit:.3}");
                let found = self.best(session, &stated, &name)?;
                tried.extend(found.map(|(objective, _)| (objective, within_limit)));
            }
            tried.sort_by(|a, b| a.0.total_cmp(&b.0));
            let Some(&(_, best)) = tried.first() else {
                break;
            };
            if round == 0 {
                list = neighbours(best);
            }
        }
        Ok(tried.first().map(|&(_, within_limit)| within_limit))
    }

    /// What the certificate of the starts is to do best.
    fn aim(&self) -> Aim {
        let pointing = self.request.model.file.specs.objective.is_guaranteed_gain();
        match self.last.is_none() && pointing {
            true => Aim::SmallestPointing,
            false => Aim::LargestAngle,
        }
    }

    /// What the hand-over requires of the certificate of the starts.
    fn tie(&self, scaled: &ScaledTask) -> Tie {
        let last = self.specs.last.as_ref();
        last.map_or(Tie::Alone, |last| Tie::HandsOver {
            level: self.specs.final_level * (1.0 + ABOVE_REACHED),
            bound: scaled.task.system.input_limit.min() / last.within_limit,
        })
    }

    fn scaled(&self, model: &Model, within_limit: f64, final_level: f64) -> ScaledTask {
        let shares = Shares {
            within_limit,
            final_level,
        };
        let craft = match &model.plant {
            Plant::Spacecraft(craft) => craft,
            _ => self.craft,
        };
        ScaledTask::new(model, craft, &self.law, shares)
    }

    /// The certificate of the starts, then that of the set which it hands over to.
    fn attempt(
        &self,
        session: &mut Session,
        within_limit: f64,
        back_off: f64,
    ) -> Result<Option<CommandProof>, SynthesisError> {
        let model = self.request.model;
        let scaled = self.scaled(model, within_limit, self.specs.final_level);
        let tie = self.tie(&scaled);
        let found = self.certificate(session, (model, &scaled), (self.aim(), &tie), back_off)?;
        let Some(start) = found else {
            return Ok(None);
        };
        let proof = CommandProof {
            model: model.clone(),
            law: self.law.clone(),
            certificate: start.certificate,
            hand_over: None,
        };
        let (Some(last), Some(specs)) = (&self.last, &self.specs.last) else {
            return Ok(Some(proof));
        };
        let level = start.reached * (1.0 + ABOVE_REACHED);
        let scaled = self.scaled(last, specs.within_limit, specs.final_level);
        let tie = Tie::TakesOver {
            lyapunov: scaled.lyapunov_from(&proof.certificate.lyapunov),
            level,
        };
        let aim = (Aim::SmallestPointing, &tie);
        let found = self.certificate(session, (last, &scaled), aim, back_off)?;
        Ok(found.map(|found| {
            let start = self.stage(model, &proof.certificate);
            let end = self.stage(last, &found.certificate);
            let largest = largest_hand_over(&start, &end).unwrap_or(level);
            let hand_over = Some((level.max(largest), last.clone(), found.certificate));
            CommandProof { hand_over, ..proof }
        }))
    }

    fn stage<'b>(&'b self, model: &'b Model, certificate: &'b HeldCommandCertificate) -> Stage<'b> {
        Stage {
            model,
            law: &self.law,
            certificate,
        }
    }

    /// The best objective and the solver's point; `None` where it found none.
    fn best(
        &self,
        session: &mut Session,
        stated: &Stated,
        name: &str,
    ) -> Result<Option<(f64, Vec<f64>)>, SynthesisError> {
        let vertices = 2 * crate::fuzzy::SPACECRAFT_VERTICES;
        let solution = session.run(&stated.best(), name, Stated::BEST, vertices)?;
        let usable = has_point(&solution) && solution.objective.is_finite();
        Ok(usable.then_some((solution.objective, solution.values)))
    }

    /// A certificate well inside its conditions, with an objective a little beyond the best one.
    fn certificate(
        &self,
        session: &mut Session,
        (model, scaled): (&Model, &ScaledTask),
        (aim, tie): (Aim, &Tie),
        back_off: f64,
    ) -> Result<Option<Candidate>, SynthesisError> {
        let stated = Stated::state(scaled, aim, tie);
        let name = match aim {
            Aim::LargestAngle => "largest angle",
            Aim::SmallestPointing => "smallest pointing bound",
        };
        let Some((best, values)) = self.best(session, &stated, name)? else {
            return Ok(None);
        };
        let target = best + back_off * best.abs();
        let weights = stated.weights(&values);
        let problem = stated.centred(target, &weights);
        let vertices = 2 * crate::fuzzy::SPACECRAFT_VERTICES;
        let name = format!("largest margin, {name}");
        let solution = session.run(&problem, &name, Stated::CENTRED, vertices)?;
        if !has_point(&solution) {
            return Ok(None);
        }
        let found = scaled.recover(&model.plant, &stated.own, &solution.values);
        let stage = self.stage(model, &found);
        let reached = reached_from_rest(&stage);
        let claimed = claimed(&stage);
        Ok(claimed.map(|certificate| Candidate {
            certificate,
            reached,
        }))
    }

    /// Puts the file together and checks what a reader of its text would get.
    fn design(&self, proof: &CommandProof) -> Box<HeldCommandSynthesized> {
        let request = self.request;
        let report: Report = proof.verify();
        let hand_over = proof.hand_over.as_ref();
        let file = HeldCommandDesignFile {
            schema_version: DESIGN_SCHEMA_VERSION,
            name: request.model.file.name.clone(),
            model: request.model.file.clone(),
            controller: CommandControllerFile {
                gain: rows(request.gain),
                trigger: GivenTrigger::Command(request.trigger),
            },
            certificate: CommandCertificateFile::new(&proof.certificate),
            hand_over: hand_over.map(|(level, _, certificate)| HandOverFile {
                level: *level,
                certificate: CommandCertificateFile::new(certificate),
            }),
            verdict: report.clone(),
            provenance: HeldCommandProvenance {
                generator: GENERATOR.to_string(),
                model_sha256: sha256_of(request.model_text),
                gains_sha256: sha256_of(request.gains_text),
                date: now(),
                solver_runs: Vec::new(),
            },
        };
        Box::new(Synthesized {
            file,
            report,
            solve_seconds: 0.0,
            optimality: None,
        })
    }
}

/// Values of theta on either side of one of [`SHARES`].
fn neighbours(best: f64) -> Vec<f64> {
    let factors = [0.82, 0.88, 0.94, 1.08];
    let around = factors.map(|factor| best * factor).into_iter();
    around.filter(|share| *share <= 1.0).collect()
}
