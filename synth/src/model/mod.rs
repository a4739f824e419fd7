//! Model files: what an engineer writes.

mod error;
mod explain;
mod file;
mod read;
mod validate;

pub use error::{FileError, Kind, ModelError};
pub use file::{
    ExactPlant, GainForm, LinearBound, Mismatch, ModelFile, Objective, PlantFile, Specs,
    ThresholdUpdate, VerticesPlant, MODEL_SCHEMA_VERSION,
};
pub use read::{kind_of, parse, read_text, read_text_up_to, write_atomically, MAX_FILE_BYTES};
pub use validate::Model;

pub use validate::{
    check_matrix, check_positive, check_positive_definite, check_symmetric, finite,
};

use crate::fuzzy::{ExactSpacecraft, TakagiSugeno, VertexSystem};

/// A checked plant.
#[derive(Debug, Clone, PartialEq)]
pub enum Plant {
    /// The rigid spacecraft, exactly, on a box.
    Spacecraft(ExactSpacecraft),
    /// User-given vertex systems.
    Vertices(VertexSystem),
}

impl Plant {
    /// The T-S model in SI units.
    pub fn takagi_sugeno(&self) -> TakagiSugeno {
        match self {
            Plant::Spacecraft(craft) => craft.takagi_sugeno(),
            Plant::Vertices(system) => system.takagi_sugeno(),
        }
    }

    /// Numbers of states, inputs, disturbances, outputs.
    pub fn sizes(&self) -> (usize, usize, usize, usize) {
        match self {
            Plant::Spacecraft(_) => (6, 3, 3, 6),
            Plant::Vertices(system) => (
                system.input_matrix.nrows(),
                system.input_matrix.ncols(),
                system.disturbance_matrix.ncols(),
                system.output_matrix.nrows(),
            ),
        }
    }
}
