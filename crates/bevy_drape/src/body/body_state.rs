//! State of a body that the plugin keeps from step to step.

use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::world::bounds::Bounds;
use drape_solver::world::extent::Extent;
use drape_solver::{BodyContext, BodyScratch};

/// What the plugin keeps about a body between steps.
#[derive(Component, Default)]
pub(crate) struct BodyState {
    /// Order of creation: what bodies are sorted by, so that entity ids do not matter to the result.
    pub order: u64,
    /// State and memory of the solver that a body keeps from step to step.
    pub context: BodyContext,
    /// The same of its contacts and its substeps, beside the body in its island.
    pub scratch: BodyScratch,
    /// The transform that pins are attached to, as it was when they were last brought there.
    pub anchor: Affine3A,
    /// What took the entity's own coordinates to where its particles rest, when the body was built.
    pub rest: Affine3A,
    /// Places of the pinned particles in the entity's own coordinates.
    pub pins: Vec<(u32, Vec3)>,
    /// Where the particles are and how fast, as of the last step or edit.
    pub extent: Extent,
    /// Whether the body cannot be simulated; see the log for why.
    pub refused: bool,
    /// Settings of the last step; a change wakes the body.
    pub settings: drape_solver::SolverSettings,
    /// Layers of the last step, likewise.
    pub layers: drape_solver::Layers,
}

impl BodyState {
    /// Box around the surface of the body.
    pub fn bounds(&self) -> Bounds {
        self.extent.surface(&self.settings)
    }

    /// Box that the surface does not leave within a step of `dt` seconds.
    pub fn bounds_within_step(&self, dt: f32, gravity: f32) -> Bounds {
        self.extent.reach(&self.settings, dt, gravity)
    }
}

/// Hands out creation numbers.
#[derive(Resource, Default)]
pub(crate) struct CreationOrder(u64);

impl CreationOrder {
    pub fn next(&mut self) -> u64 {
        self.0 += 1;
        self.0
    }

    /// The number that was handed out last.
    pub fn last(&self) -> u64 {
        self.0
    }

    /// Hands out the numbers after `last` from now on.
    pub fn go_on_from(&mut self, last: u64) {
        self.0 = last;
    }
}
