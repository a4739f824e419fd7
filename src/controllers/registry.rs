//! The controllers that a scenario file may name: a new one is a file and a row here.

use runtime::attitude::AttitudeMeasurement;
use runtime::error::ParameterError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::ModelError;

use super::law::{AttitudeLaw, LawFile, Surroundings};
use super::lei2022::LeiFile;
use super::wu2018::WuFile;
use super::xu2020::XuFile;
use super::yang2025::YangFile;
use crate::plants::System;
use crate::sim::controller::Use;

/// Makes the file's and the checked list of controllers and what is the same for all. A row: the words
/// for the schema, the key in the file, the names in the two lists and the file's type.
macro_rules! controllers {
    ($($(#[doc = $doc:literal])+ $key:literal $file:ident $law:ident ($type:ty);)+) => {
        /// The controllers.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum ControllerFile {
            /// The controller of a design file, which `simulate --design` names.
            Design(DesignReferenceFile),
            $($(#[doc = $doc])+ #[serde(rename = $key)] $file(Box<$type>),)+
        }

        /// The controller of a scenario.
        #[derive(Debug, Clone)]
        pub enum ControllerChoice {
            /// That of a design file, by the path in the scenario if there is one.
            Design(Option<String>),
            $($(#[doc = $doc])+ $law(Box<<$type as LawFile>::Law>),)+
        }

        impl ControllerFile {
            /// See [`LawFile::assume_inertia`].
            pub fn assume_inertia(&mut self, inertia_kg_m2: &[[f64; 3]; 3]) {
                match self {
                    ControllerFile::Design(_) => {}
                    $(ControllerFile::$file(file) => file.assume_inertia(inertia_kg_m2),)+
                }
            }
        }

        impl ControllerChoice {
            /// The controller, unless it is that of a design.
            pub fn law(&self) -> Option<&dyn AttitudeLaw> {
                match self {
                    ControllerChoice::Design(_) => None,
                    $(ControllerChoice::$law(law) => Some(law.as_ref()),)+
                }
            }

            /// Hands on the controller, unless it is that of a design: then `then` comes back.
            ///
            /// # Errors
            /// A parameter that the flight code refuses.
            pub fn build<U: Use<AttitudeMeasurement, 3>>(
                &self,
                around: &Surroundings,
                then: U,
            ) -> Result<Result<U::Output, U>, ParameterError> {
                match self {
                    ControllerChoice::Design(_) => Ok(Err(then)),
                    $(ControllerChoice::$law(law) => law.build(around, then).map(Ok),)+
                }
            }
        }

        /// Checks the controller of a file.
        pub(crate) fn check_controller(
            file: &ControllerFile,
            system: &System,
        ) -> Result<ControllerChoice, ModelError> {
            match (file, system) {
                (ControllerFile::Design(design), _) => {
                    Ok(ControllerChoice::Design(design.file.clone()))
                }
                $((ControllerFile::$file(file), System::RigidBody(system)) => {
                    let law = file.check(system);
                    let law = law.map_err(|error| error.within(concat!("controller.", $key)))?;
                    Ok(ControllerChoice::$law(Box::new(law)))
                })+
                (_, System::TakagiSugeno(_)) => Err(ModelError::shape(
                    "controller",
                    "an attitude controller",
                    "design, because system is takagi_sugeno",
                )),
            }
        }
    };
}

controllers! {
    /// Wu, Shen and Cao 2018.
    "wu2018" Wu2018 Wu(WuFile);
    /// Xu and Huang 2020 with given gains: nothing is proved.
    "xu2020" Xu2020 Xu(XuFile);
    /// Lei et al. 2022.
    "lei2022" Lei2022 Lei(LeiFile);
    /// Yang, Yang, Ji, Wang and Ma 2025.
    "yang2025" Yang2025 Yang(YangFile);
}

/// Which design file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DesignReferenceFile {
    /// Path of the design file, from the scenario file's folder; the command line's takes precedence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
}
