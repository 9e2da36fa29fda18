//! Parameters: what a run can change about a scene.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Literal;

/// A value with a name of its own, which a run can replace by `--set NAME=VALUE`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// What it is if a run does not say, as it would be written where it goes.
    pub default: Literal,
    /// The paths that it sets, such as `["curtain.particles", "settings.solver.substeps"]`.
    pub sets: Vec<String>,
    /// What it means; nothing by default.
    #[serde(default)]
    pub about: String,
}
