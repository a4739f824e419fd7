//! The plants that a scenario file may name: a new one is a folder and a row here.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::ModelError;

use super::rigid_body::RigidBodyFile;
use super::takagi_sugeno::TakagiSugenoFile;
use crate::sim::plant::PlantFile;

/// Makes the file's and the checked list of plants, their kinds and what is the same for all. A row: the
/// words for the schema, the key in the file, the name in the lists and the file's type.
macro_rules! plants {
    ($($(#[doc = $doc:literal])+ $key:literal $name:ident ($type:ty);)+) => {
        /// The kinds of systems.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        pub enum SystemFile {
            $($(#[doc = $doc])+ #[serde(rename = $key)] $name(Box<$type>),)+
        }

        /// The plant with its initial state, disturbance, sensors and actuators.
        #[derive(Debug, Clone)]
        pub enum System {
            $($(#[doc = $doc])+ $name(Box<<$type as PlantFile>::System>),)+
        }

        /// A kind of system.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
        pub enum SystemKind {
            $($(#[doc = $doc])+ #[serde(rename = $key)] $name,)+
        }

        impl SystemKind {
            /// Its key in files.
            pub fn key(self) -> &'static str {
                match self {
                    $(SystemKind::$name => $key,)+
                }
            }
        }

        impl System {
            /// The quantities of a profile, with units.
            pub fn profile_quantities(&self) -> &'static [&'static str] {
                match self {
                    $(System::$name(_) => <$type as PlantFile>::QUANTITIES,)+
                }
            }
        }

        impl SystemFile {
            /// Checks the system.
            ///
            /// # Errors
            /// See [`PlantFile::check`].
            pub(crate) fn check(&self, seed: u64) -> Result<System, ModelError> {
                match self {
                    $(SystemFile::$name(file) => {
                        let system = file.check(seed);
                        let system = system.map_err(|error| error.within(concat!("system.", $key)));
                        Ok(System::$name(Box::new(system?)))
                    })+
                }
            }
        }
    };
}

plants! {
    /// A rigid spacecraft.
    "rigid_body" RigidBody(RigidBodyFile);
    /// A Takagi-Sugeno model of any size.
    "takagi_sugeno" TakagiSugeno(TakagiSugenoFile);
}
