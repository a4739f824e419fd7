//! What kind of file a text is: the kind that its keys claim, and whether it reads as one.

use synth::design::DesignFile;
use synth::feasibility::InfeasibilityFile;
use synth::held_command::HeldCommandDesignFile;
use synth::model::{kind_of, FileError, GainsFile, Kind, Model, ModelError};
use synth::problem::{Problem, ProblemDesignFile};
use synth::requirements::Facts;

use crate::batch::tune::file::Requirements;
use crate::run::summary::Summary;
use crate::scenario::Scenario;

/// A valid file, read.
pub enum Document {
    /// A model.
    Model(Box<Model>),
    /// A spacecraft with requirements.
    Facts(Box<Facts>),
    /// A design, and its model.
    Design(Box<DesignFile>, Box<Model>),
    /// A scenario.
    Scenario(Box<Scenario>),
    /// An infeasibility certificate, and its model.
    Infeasibility(Box<InfeasibilityFile>, Box<Model>),
    /// A problem.
    Problem(Box<Problem>),
    /// The design of a problem, and the problem.
    ProblemDesign(Box<Problem>),
    /// The design of a law with a trigger on the command, and its model.
    HeldCommandDesign(Box<HeldCommandDesignFile>, Box<Model>),
    /// Gains.
    Gains(GainsFile),
    /// Requirements of the parameter search.
    Requirements(Box<Requirements>),
    /// The summary of a run.
    Summary(Box<Summary>),
}

impl Document {
    /// Reads a text as a file of a kind.
    ///
    /// # Errors
    /// The text is no valid file of this kind.
    pub fn read(kind: Kind, text: &str) -> Result<Self, FileError> {
        Ok(match kind {
            Kind::Model => Document::Model(Box::new(Model::from_json(text)?)),
            Kind::Facts => Document::Facts(Box::new(Facts::from_json(text)?)),
            Kind::Design => {
                let (file, model) = DesignFile::from_json(text)?;
                Document::Design(Box::new(file), Box::new(model))
            }
            Kind::Scenario => Document::Scenario(Box::new(Scenario::from_json(text)?)),
            Kind::Infeasibility => {
                let (file, model) = InfeasibilityFile::from_json(text)?;
                Document::Infeasibility(Box::new(file), Box::new(model))
            }
            Kind::Problem => Document::Problem(Box::new(Problem::from_json(text)?)),
            Kind::ProblemDesign => {
                let (_, problem) = ProblemDesignFile::from_json(text)?;
                Document::ProblemDesign(Box::new(problem))
            }
            Kind::HeldCommandDesign => {
                let (file, proof) = HeldCommandDesignFile::from_json(text)?;
                Document::HeldCommandDesign(Box::new(file), Box::new(proof.model))
            }
            Kind::Gains => Document::Gains(GainsFile::from_json(text)?),
            Kind::Requirements => Document::Requirements(Box::new(Requirements::from_json(text)?)),
            Kind::Summary => Document::Summary(Box::new(Summary::from_json(text)?)),
        })
    }
}

/// What a text is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Recognised {
    /// A valid file of this kind, or one of an older version of its format.
    Valid(Kind),
    /// A text with the keys of this kind that does not read as one.
    Invalid(Kind),
    /// Nothing that is known.
    Unknown,
}

/// Recognises a text by reading all of it.
pub fn recognise(text: &str) -> Recognised {
    let Some(kind) = kind_of(text) else {
        return Recognised::Unknown;
    };
    match Document::read(kind, text) {
        Ok(_) => Recognised::Valid(kind),
        Err(FileError::Value(ModelError::SchemaVersion { found, expected }))
            if found < expected =>
        {
            Recognised::Valid(kind)
        }
        Err(_) => Recognised::Invalid(kind),
    }
}
