//! The controllers that a scenario file may name.

use nalgebra::Vector3;
use runtime::{lei2022, wu2018};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::ModelError;

use super::lei2022::LeiFile;
use super::wu2018::{wu2018, WuFile};
use super::xu2020::{xu2020, XuChoice, XuFile};
use super::yang2025::{YangChoice, YangFile};
use crate::controllers::lei2022::check::lei2022;
use crate::controllers::yang2025::check::check_yang;
use crate::plants::System;

/// The controllers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ControllerFile {
    /// The controller of a design file, which `simulate --design` names.
    Design(DesignReferenceFile),
    /// Wu, Shen and Cao 2018.
    Wu2018(WuFile),
    /// Xu and Huang 2020 with given gains: nothing is proved.
    Xu2020(Box<XuFile>),
    /// Lei et al. 2022.
    Lei2022(Box<LeiFile>),
    /// Yang, Yang, Ji, Wang and Ma 2025.
    Yang2025(Box<YangFile>),
}

/// Which design file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DesignReferenceFile {
    /// Path of the design file, from the scenario file's folder; the command line's takes precedence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
}

/// The controller of a scenario.
#[derive(Debug, Clone)]
pub enum ControllerChoice {
    /// That of a design file, by the path in the scenario if there is one.
    Design(Option<String>),
    /// Wu, Shen and Cao 2018.
    Wu(wu2018::Parameters),
    /// Xu and Huang 2020 with given gains.
    Xu(Box<XuChoice>),
    /// Lei et al. 2022.
    Lei(Box<lei2022::Parameters>),
    /// Yang, Yang, Ji, Wang and Ma 2025.
    Yang(Box<YangChoice>),
}

impl ControllerChoice {
    /// Torque limit of each axis, N m, where the scenario gives it.
    pub fn torque_limit(&self) -> Option<Vector3<f64>> {
        match self {
            ControllerChoice::Design(_) => None,
            ControllerChoice::Wu(parameters) => Some(parameters.torque_limit),
            ControllerChoice::Xu(choice) => Some(choice.torque_limit),
            ControllerChoice::Lei(parameters) => Some(parameters.torque_limit),
            ControllerChoice::Yang(choice) => Some(choice.parameters.torque_limit),
        }
    }

    /// Whether the torque changes at every sample, so that there is no trigger to watch.
    pub(crate) fn sends_every_sample(&self) -> bool {
        match self {
            ControllerChoice::Wu(parameters) => {
                parameters.trigger == wu2018::TriggerRule::EverySample
            }
            ControllerChoice::Lei(parameters) => {
                parameters.trigger == lei2022::TriggerRule::EverySample
            }
            ControllerChoice::Yang(_) => true,
            ControllerChoice::Design(_) | ControllerChoice::Xu(_) => false,
        }
    }
}

/// Checks the controller of a file.
pub(crate) fn check_controller(
    file: &ControllerFile,
    system: &System,
) -> Result<ControllerChoice, ModelError> {
    match (file, system) {
        (ControllerFile::Design(design), _) => Ok(ControllerChoice::Design(design.file.clone())),
        (ControllerFile::Wu2018(wu), System::RigidBody(body)) => {
            let inertia = body.body.inertia().symmetric_eigenvalues().max();
            let parameters = wu2018(wu, inertia).map_err(|e| e.within("controller.wu2018"))?;
            Ok(ControllerChoice::Wu(parameters))
        }
        (ControllerFile::Xu2020(xu), System::RigidBody(_)) => {
            let choice = xu2020(xu).map_err(|error| error.within("controller.xu2020"))?;
            Ok(ControllerChoice::Xu(Box::new(choice)))
        }
        (ControllerFile::Lei2022(lei), System::RigidBody(body)) => {
            let parameters = lei2022(lei, body).map_err(|e| e.within("controller.lei2022"))?;
            Ok(ControllerChoice::Lei(Box::new(parameters)))
        }
        (ControllerFile::Yang2025(yang), System::RigidBody(body)) => {
            let choice = check_yang(yang, body.body.inertia())
                .map_err(|error| error.within("controller.yang2025"))?;
            Ok(ControllerChoice::Yang(Box::new(choice)))
        }
        (_, System::TakagiSugeno(_)) => Err(ModelError::WrongShape {
            field: "controller".to_string(),
            found: "an attitude controller".to_string(),
            expected: "design, because system is takagi_sugeno".to_string(),
        }),
    }
}
