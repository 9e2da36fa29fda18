//! The order of a step.

use bevy::prelude::*;

/// The systems of a bridge, in the order of a step. An engine's own systems are those that read and write.
///
/// ```text
/// engine's schedule   ReadStarts -> Start -> (the engine takes its step)
/// DrapeSchedule       NoteChanges -> ReadColliders -> (new cloth is built) -> FindNear -> ReadEnds -> Plan
///                     -> (cloth takes its step) -> HandBack -> Write
/// ```
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BridgeSystems {
    /// The engine's bodies are read into [`EngineBody`](crate::EngineBody), before its step.
    ReadStarts,
    /// Obstacles go where their bodies begin the step.
    Start,
    /// Colliders and bodies that were changed in place are listed.
    NoteChanges,
    /// Obstacles of colliders and of bodies are brought up to date.
    ReadColliders,
    /// The engine looks which of its bodies are near cloth: see [`Surroundings`](crate::Surroundings).
    FindNear,
    /// The engine's bodies are read again, after its step.
    ReadEnds,
    /// Obstacles learn where the engine has brought their bodies.
    Plan,
    /// Cloth has taken its step: bodies that it pushed learn where they are.
    HandBack,
    /// Bodies that were pushed are written back to the engine.
    Write,
}
