//! Parameters: values that a run can set by name.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Literal;

/// A parameter, which a run can set by `--set NAME=VALUE`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// Its value if a run does not set it, written as the value at its paths.
    pub default: Literal,
    /// The paths that it sets, such as `["curtain.particles", "settings.solver.substeps"]`.
    pub sets: Vec<String>,
    /// Its meaning, in words; empty by default.
    #[serde(default)]
    pub about: String,
}
