//! An object without keys.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Nothing.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EmptyFile {}
