//! Model files: what an engineer writes.

pub mod bounded;
mod command_trigger;
mod error;
mod explain;
mod file;
mod final_set;
mod gains;
mod gyroscopic;
mod imperfections;
mod inertia;
mod kind;
mod large_set;
mod loop_bounds;
mod objective;
mod ranges;
mod read;
mod rules;
mod search;
mod validate;
mod vanishing;

pub use command_trigger::{CommandTrigger, CommandTriggerSpecs, FinalSetSpecs, GivenTrigger};
pub use error::{readable, FileError, ModelError};
pub use file::{
    ExactPlant, FuzzySetFile, GainForm, InertiaUncertaintyFile, LinearBound, LocalRuleFile,
    Mismatch, ModelFile, OuterSpecs, PlantFile, PremiseFile, RulesLinear, RulesPlant,
    RulesSpacecraft, RulesSystem, SearchFile, Specs, ThresholdUpdate, VerticesPlant,
    MODEL_SCHEMA_VERSION,
};
pub use gains::{GainsFile, GAINS_SCHEMA_VERSION};
pub use gyroscopic::GyroscopicForm;
pub(crate) use imperfections::is_none as is_ideal;
pub use imperfections::{
    Auto, Effectiveness, ErrorBall, ErrorUnit, Imperfections, MeasurementBounds, MomentumBound,
    ReferenceMotion, TriggerFloor,
};
pub use kind::{kind_of, Kind};
pub use loop_bounds::FLOOR_SHARE;
pub use objective::{Objective, OutputWeights};
pub use ranges::{
    check_count, check_inertia, check_line, check_matrix, check_not_negative, check_positive,
    check_positive_definite, check_seen, check_shape, check_symmetric, check_version, entries,
    finite, Size, MAX_BOUNDS, MAX_COLUMNS,
};
pub use read::{
    is_temporary, make_readable, new_in, parse, read_bytes_up_to, read_text, read_text_up_to,
    write_atomically, MAX_FILE_BYTES,
};
pub use validate::{
    check_bounds, check_state_matrices, spacecraft, vertex_system, Model, MAX_SCHEDULED_RULES,
};

use nalgebra::{DMatrix, Matrix3};

use crate::fuzzy::{ExactSpacecraft, RuleModel, TakagiSugeno, VertexSystem};

/// A checked plant.
#[derive(Debug, Clone, PartialEq)]
pub enum Plant {
    /// The rigid spacecraft, exactly, on a box.
    Spacecraft(ExactSpacecraft),
    /// User-given vertex systems.
    Vertices(VertexSystem),
    /// Local rules, blended by their memberships.
    Rules(RuleModel),
}

impl Plant {
    /// Inertia [kg m^2], when the plant's equation is kept multiplied by it.
    pub fn inertia(&self) -> Option<&Matrix3<f64>> {
        match self {
            Plant::Spacecraft(craft) => Some(&craft.inertia),
            Plant::Vertices(_) => None,
            Plant::Rules(rules) => rules.inertia.as_ref(),
        }
    }

    /// True when the proof is for a set of inertias.
    pub fn has_uncertain_inertia(&self) -> bool {
        match self {
            Plant::Spacecraft(craft) => {
                let uncertain = craft.inertia_uncertainty.uncertain_entries(&craft.inertia);
                !uncertain.is_empty()
            }
            Plant::Vertices(_) | Plant::Rules(_) => false,
        }
    }

    /// The plant that refutations are about: whatever satisfies the conditions for this plant satisfies them for that one.
    /// It has the nominal inertia of a set; and its vertices are those at omega = 0, where the form of the gyroscopic torque
    /// plays no part, as long as that form is free.
    pub fn relaxed(&self) -> Self {
        match self {
            Plant::Spacecraft(craft) => {
                let nominal = craft.nominal();
                Plant::Spacecraft(match craft.gyroscopic_form {
                    Some(_) => nominal,
                    None => nominal.at_rest(),
                })
            }
            other => other.clone(),
        }
    }

    /// Whether [`Plant::relaxed`] is another plant.
    pub fn is_relaxed_for_refutations(&self) -> bool {
        self.relaxed() != *self
    }

    /// The factor E of the plant's equation E x' = ...: diag(J, I) for a spacecraft (J the nominal
    /// inertia), else the identity.
    pub fn descriptor(&self) -> DMatrix<f64> {
        let states = self.sizes().0;
        let mut out = DMatrix::identity(states, states);
        if let Some(inertia) = self.inertia() {
            out.view_mut((0, 0), (3, 3)).copy_from(inertia);
        }
        out
    }

    /// Number of rules whose memberships are known as functions of the state.
    pub fn membership_count(&self) -> Option<usize> {
        match self {
            Plant::Spacecraft(_) => Some(crate::fuzzy::SPACECRAFT_VERTICES),
            Plant::Vertices(_) => None,
            Plant::Rules(rules) => Some(rules.sets.len()),
        }
    }

    /// The T-S model in SI units.
    pub fn takagi_sugeno(&self) -> TakagiSugeno {
        match self {
            Plant::Spacecraft(craft) => craft.takagi_sugeno(),
            Plant::Vertices(system) => system.takagi_sugeno(),
            Plant::Rules(rules) => rules.takagi_sugeno(),
        }
    }

    /// Numbers of states, inputs, disturbances, outputs.
    pub fn sizes(&self) -> (usize, usize, usize, usize) {
        match self {
            Plant::Spacecraft(_) => (6, 3, 3, 6),
            Plant::Vertices(system) => system.sizes(),
            Plant::Rules(rules) => rules.system.sizes(),
        }
    }
}
