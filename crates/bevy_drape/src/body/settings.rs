//! Solver settings: a component for one body, a resource for all others.

use bevy::prelude::*;
pub use drape_solver::{Quality, SelfContact, SolverSettings, StickProjection, StructuralSolve};

/// The [`SolverSettings`] of all bodies that have none of their own.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Deref, DerefMut)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DefaultSolverSettings(pub SolverSettings);
