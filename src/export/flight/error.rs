//! Why there is no source text of a controller.

use runtime::error::ParameterError;

use crate::run::design::NoLaw;
use crate::run::outcome::SimulateError;

/// Why there is no source text of a controller.
#[derive(Debug, thiserror::Error)]
pub enum NoSource {
    /// Its gains are no law.
    #[error(transparent)]
    NoLaw(#[from] NoLaw),
    /// A number that the flight code refuses.
    #[error(transparent)]
    Refused(#[from] ParameterError),
    /// The controller cannot be run for the reference vectors.
    #[error(transparent)]
    NotRun(#[from] SimulateError),
    /// The scenario flies a design.
    #[error("this scenario flies the controller of a design file; export that file")]
    OfDesign,
    /// No C text of this law.
    #[error(
        "there is no C source of this controller: {law}; designs and the laws of Wu et al. 2018, Lei et al. 2022 and Yang \
         et al. 2025 have one"
    )]
    Law {
        /// The law.
        law: String,
    },
    /// Not the exact model of a spacecraft.
    #[error("the design is not for the exact model of a spacecraft (plant.exact), which this format needs")]
    NotASpacecraft,
    /// A law that needs more than single precision.
    #[error(
        "there is no text in single precision of this controller: --float is for designs with a fixed threshold and for the law \
         of Wu et al. 2018"
    )]
    SinglePrecision,
    /// A number that is none in single precision.
    #[error("the number {value:e} is too large to compute with in single precision (--float)")]
    BeyondSingle {
        /// The number.
        value: f64,
    },
    /// No zip file.
    #[error("the unit cannot be put together: {0}")]
    NotPacked(#[from] zip::result::ZipError),
    /// The desired attitude moves, and a step takes errors only.
    #[error("the scenario's reference moves; the C source is for a fixed desired attitude")]
    MovingReference,
}
