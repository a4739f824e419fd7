//! The design file of a law with a trigger on the command, and its check.

use nalgebra::DVector;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::certify::held_command::{
    check, check_exactly, reached_from_rest, HandOver, HeldCommandCertificate, HeldCommandLaw,
    HeldCommandProof, Stage,
};
use crate::certify::reach::fall_time;
use crate::certify::{ExactReport, Report};
use crate::design::{
    positive_list, rows, symmetric, FinalBoundsFile, SolverRun, DESIGN_SCHEMA_VERSION,
};
use crate::model::{
    check_matrix, check_positive, check_version, parse, FileError, GivenTrigger, Kind, Model,
    ModelError, ModelFile,
};
use crate::programs::Recorded;

/// A law with its proof. Every number stands once: what the model says is in the model, what flies in the controller,
/// what only the proof needs in the certificates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeldCommandDesignFile {
    /// Version of this format: 1.
    pub schema_version: u32,
    /// Name of the model.
    pub name: String,
    /// The model, whole.
    pub model: ModelFile,
    /// What flies.
    pub controller: CommandControllerFile,
    /// What proves it on the set of starts.
    pub certificate: CommandCertificateFile,
    /// What proves it on the set of the model's `specs.command_trigger.final`; only where the model has that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hand_over: Option<HandOverFile>,
    /// The outcome of the check when the file was written. A reader does not trust it: `verify`
    /// checks again.
    pub verdict: Report,
    /// What made the file.
    pub provenance: HeldCommandProvenance,
}

/// u = F x(t_k), held and saturated, with its trigger. n states, m inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CommandControllerFile {
    /// F, m x n.
    pub gain: Vec<Vec<f64>>,
    /// When a sample is sent.
    pub trigger: GivenTrigger,
}

/// The unknowns of one certificate. n states, m inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CommandCertificateFile {
    /// theta, in (0, 1]: theta times the command stays within the limits on the certified set.
    pub within_limit: f64,
    /// U of the certified set x'Ux <= 1, n x n, symmetric.
    pub lyapunov: Vec<Vec<f64>>,
    /// Y, n x n, symmetric.
    pub integral_weight: Vec<Vec<f64>>,
    /// Q1, n x n.
    pub state_multiplier: Vec<Vec<f64>>,
    /// Q2, n x n.
    pub rate_multiplier: Vec<Vec<f64>>,
    /// L1, n x n.
    pub free_state: Vec<Vec<f64>>,
    /// L2, n x n.
    pub free_sample: Vec<Vec<f64>>,
    /// R1, n x 3.
    pub annihilator_state: Vec<Vec<f64>>,
    /// R2, n x 3.
    pub annihilator_rate: Vec<Vec<f64>>,
    /// Diagonal of M, m entries above 0; empty where theta is 1.
    #[serde(default)]
    pub sector_weight: Vec<f64>,
    /// m, above 0.
    pub command_weight: f64,
    /// c, above 0: how the trigger's two parts are weighted against each other.
    pub command_split: f64,
    /// xi, above 0.
    pub xi: f64,
    /// Every attitude at rest whose error quaternion has a vector part up to this norm is certified.
    pub certified_vector_part: f64,
    /// Bounds from rest, and in the end from every certified start.
    pub final_bounds: FinalBoundsFile,
}

/// What proves the law on the set that the state reaches.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HandOverFile {
    /// rho', above 0: the state reaches x'Ux <= rho' with the U of the certificate of the starts.
    pub level: f64,
    /// The unknowns on the smaller set.
    pub certificate: CommandCertificateFile,
}

/// What made a design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeldCommandProvenance {
    /// Program and version.
    pub generator: String,
    /// SHA-256 of the model file's bytes.
    pub model_sha256: String,
    /// SHA-256 of the gains file's bytes.
    pub gains_sha256: String,
    /// Date and time (UTC, RFC 3339).
    pub date: String,
    /// The solver's runs, in order. Their statuses are the solver's opinion and prove nothing.
    pub solver_runs: Vec<SolverRun>,
}

impl Recorded for HeldCommandDesignFile {
    fn solver_runs(&mut self) -> &mut Vec<SolverRun> {
        &mut self.provenance.solver_runs
    }
}

/// The numbers of a file, with the models that they are about.
#[derive(Debug, Clone, PartialEq)]
pub struct CommandProof {
    /// The model.
    pub model: Model,
    /// The law.
    pub law: HeldCommandLaw,
    /// The certificate of the set of starts.
    pub certificate: HeldCommandCertificate,
    /// The level, model and certificate of the set that the state reaches.
    pub hand_over: Option<(f64, Model, HeldCommandCertificate)>,
}

impl CommandProof {
    /// The proof as the check takes it.
    pub fn stages(&self) -> HeldCommandProof<'_> {
        let stage = |model, certificate| Stage {
            model,
            law: &self.law,
            certificate,
        };
        HeldCommandProof {
            start: stage(&self.model, &self.certificate),
            hand_over: self
                .hand_over
                .as_ref()
                .map(|(level, model, certificate)| HandOver {
                    level: *level,
                    stage: stage(model, certificate),
                }),
        }
    }

    /// Proves the law from these numbers, or says what is not proved.
    pub fn verify(&self) -> Report {
        check(&self.stages())
    }

    /// As [`CommandProof::verify`], in exact rational arithmetic.
    pub fn verify_exactly(&self) -> ExactReport {
        check_exactly(&self.stages())
    }

    /// Time by which x'Ux of every certified start has fallen to the hand-over level, with the sample that follows (s).
    pub fn hand_over_time(&self) -> Option<f64> {
        let level = self.hand_over.as_ref()?.0;
        let reached = reached_from_rest(&self.stages().start);
        let specs = &self.model.file.specs;
        let fall = fall_time(specs.phi_per_s, reached, level)?;
        Some(fall + specs.hbar_s)
    }

    /// The certificate that bounds the pointing in the end.
    pub fn last(&self) -> &HeldCommandCertificate {
        let last = self.hand_over.as_ref();
        last.map_or(&self.certificate, |(_, _, certificate)| certificate)
    }
}

impl HeldCommandDesignFile {
    /// Reads the text of a design file; shapes and ranges are checked, nothing is proved.
    ///
    /// # Errors
    /// A text that is no such file, and any number that cannot be one of a proof.
    pub fn from_json(text: &str) -> Result<(Self, CommandProof), FileError> {
        let file: HeldCommandDesignFile = parse(text, Kind::HeldCommandDesign)?;
        check_version(file.schema_version, DESIGN_SCHEMA_VERSION)?;
        let model = Model::new(file.model.clone()).map_err(|error| error.within("model"))?;
        let proof = file.proof(&model)?;
        Ok((file, proof))
    }

    /// The file's text: JSON whose numbers read back exactly.
    pub fn to_json(&self) -> String {
        // A design holds finite numbers and string keys only, so it can always be written.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// The numbers of the file.
    ///
    /// # Errors
    /// Shapes and ranges; a model that asks for a second certificate in a file that has none, or the reverse.
    pub fn proof(&self, model: &Model) -> Result<CommandProof, ModelError> {
        check_covered(model).map_err(|error| error.within("model"))?;
        let sizes = model.plant.sizes();
        let (n, m) = (sizes.0, sizes.1);
        let gain = &self.controller.gain;
        let gain = check_matrix("controller.gain", gain, (Some(m), Some(n)))?;
        let GivenTrigger::Command(trigger) = self.controller.trigger;
        let last = model.final_set().map_err(|error| error.within("model"))?;
        let hand_over = match (last, &self.hand_over) {
            (None, None) => None,
            (Some(last), Some(own)) => {
                check_positive("hand_over.level", own.level)?;
                let read = own.certificate.read(&last, (n, m));
                let certificate = read.map_err(|error| error.within("hand_over"))?;
                Some((own.level, last, certificate))
            }
            (Some(_), None) => {
                let reason = "is missing; the model's specs.command_trigger.final needs it";
                return Err(ModelError::choice("hand_over", reason));
            }
            (None, Some(_)) => {
                let reason = "has no specs.command_trigger.final in the model";
                return Err(ModelError::choice("hand_over", reason));
            }
        };
        Ok(CommandProof {
            model: model.clone(),
            law: HeldCommandLaw { gain, trigger },
            certificate: self.certificate.read(model, (n, m))?,
            hand_over,
        })
    }
}

/// Refuses a model that the theorem does not cover.
///
/// # Errors
/// Imperfections; no `specs.command_trigger`.
pub fn check_covered(model: &Model) -> Result<(), ModelError> {
    if model.file.imperfections != Default::default() {
        let reason = "are not covered for gains with a trigger on the command";
        return Err(ModelError::choice("imperfections", reason));
    }
    if model.file.specs.command_trigger.is_none() {
        let reason = "is missing: gains with a trigger on the command need it";
        return Err(ModelError::choice("specs.command_trigger", reason));
    }
    Ok(())
}

impl CommandCertificateFile {
    /// The numbers of a certificate as the file has them.
    pub fn new(own: &HeldCommandCertificate) -> Self {
        CommandCertificateFile {
            within_limit: own.within_limit,
            lyapunov: rows(&own.lyapunov),
            integral_weight: rows(&own.integral_weight),
            state_multiplier: rows(&own.state_multiplier),
            rate_multiplier: rows(&own.rate_multiplier),
            free_state: rows(&own.free_state),
            free_sample: rows(&own.free_sample),
            annihilator_state: rows(&own.annihilator_state),
            annihilator_rate: rows(&own.annihilator_rate),
            sector_weight: own.sector_weight.iter().copied().collect(),
            command_weight: own.command_weight,
            command_split: own.command_split,
            xi: own.disturbance_weight,
            certified_vector_part: own.certified_vector_part,
            final_bounds: FinalBoundsFile::of(&own.final_bounds),
        }
    }

    fn read(
        &self,
        model: &Model,
        (n, m): (usize, usize),
    ) -> Result<HeldCommandCertificate, ModelError> {
        let matrix = |name: &str, rows: &[Vec<f64>], columns: usize| {
            check_matrix(&within(name), rows, (Some(n), Some(columns)))
        };
        let square = |name: &str, rows: &[Vec<f64>]| matrix(name, rows, n);
        let annihilator = |name: &str, rows: &[Vec<f64>]| matrix(name, rows, 3);
        let even = |name: &str, rows: &[Vec<f64>]| symmetric(&within(name), rows, n);
        let positive = [
            ("within_limit", self.within_limit),
            ("command_weight", self.command_weight),
            ("command_split", self.command_split),
            ("xi", self.xi),
            ("certified_vector_part", self.certified_vector_part),
        ];
        for (name, value) in positive {
            check_positive(&within(name), value)?;
        }
        if self.within_limit > 1.0 {
            let field = within("within_limit");
            return Err(ModelError::range(
                field,
                self.within_limit,
                "at most 1".to_string(),
            ));
        }
        Ok(HeldCommandCertificate {
            within_limit: self.within_limit,
            lyapunov: even("lyapunov", &self.lyapunov)?,
            integral_weight: even("integral_weight", &self.integral_weight)?,
            state_multiplier: square("state_multiplier", &self.state_multiplier)?,
            rate_multiplier: square("rate_multiplier", &self.rate_multiplier)?,
            free_state: square("free_state", &self.free_state)?,
            free_sample: square("free_sample", &self.free_sample)?,
            annihilator_state: annihilator("annihilator_state", &self.annihilator_state)?,
            annihilator_rate: annihilator("annihilator_rate", &self.annihilator_rate)?,
            sector_weight: self.read_sector(m)?,
            command_weight: self.command_weight,
            command_split: self.command_split,
            disturbance_weight: self.xi,
            certified_vector_part: self.certified_vector_part,
            final_bounds: self.final_bounds.read(model)?,
        })
    }

    fn read_sector(&self, m: usize) -> Result<DVector<f64>, ModelError> {
        let expected = match self.within_limit == 1.0 {
            true => 0,
            false => m,
        };
        positive_list(&within("sector_weight"), &self.sector_weight, expected)
    }
}

fn within(name: &str) -> String {
    format!("certificate.{name}")
}
