//! Parameters: what a run can change about a scene.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A value with a name of its own, which a run can replace by `--set NAME=VALUE`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// What it is if a run does not say: a number, a text, or a list of such. Choices such as `High` stand in quotes.
    pub default: Value,
    /// The paths that it sets, such as `["curtain.particles", "settings.solver.substeps"]`.
    pub sets: Vec<String>,
    /// What it means; nothing by default.
    #[serde(default)]
    pub about: String,
}
