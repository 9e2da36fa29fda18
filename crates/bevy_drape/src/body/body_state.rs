//! State of bodies that the plugin keeps from step to step.

use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::world::bounds::Bounds;
use drape_solver::world::extent::Extent;
use drape_solver::{BodyContext, BodyScratch};

use crate::body::particles::{Particles, Sticks};
use crate::body::torn_from::TornFrom;

/// State of bodies that the plugin keeps from step to step.
#[derive(Component, Default)]
pub(crate) struct BodyState {
    /// Order of creation. Bodies are sorted by it, so that entity ids do not matter to the result.
    pub order: u64,
    /// State and memory of the solver that a body keeps from step to step.
    pub context: BodyContext,
    /// The same of its contacts and its substeps, beside the body in its island.
    pub scratch: BodyScratch,
    /// Transform of the entity when pins were last moved with it.
    pub anchor: Affine3A,
    /// Transform from the entity's coordinates to the rest positions of the particles, from when the body was built.
    pub rest: Affine3A,
    /// Positions of the pinned particles in the entity's coordinates.
    pub pins: Vec<(u32, Vec3)>,
    /// Box and greatest speed of the particles, as of the last step or edit.
    pub extent: Extent,
    /// The whole body that it comes from, if it is torn or a piece.
    pub torn_from: Option<TornFrom>,
    /// True if the body cannot be simulated; the log has the reason.
    pub refused: bool,
    /// The material of its sticks, if it is of a fabric.
    pub material: Option<drape_solver::ClothMaterial>,
    /// Settings of the last step; a change wakes the body.
    pub settings: drape_solver::BodySettings,
    /// Layers of the last step; a change wakes the body.
    pub layers: drape_solver::Layers,
}

impl BodyState {
    /// Box around the surface of the body.
    pub fn bounds(&self) -> Bounds {
        self.extent.surface(&self.settings)
    }

    /// Box and greatest speed of the particles as they are now: the kept ones are those of the last step, and a body without an order
    /// has not taken part in any.
    pub fn extent_now(&self, particles: &Particles, sticks: &Sticks) -> Extent {
        let is_kept = !particles.is_disturbed() && self.order != 0;
        if is_kept { self.extent } else { Extent::of(particles, sticks) }
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

    /// Continues with the numbers after `last`.
    pub fn go_on_from(&mut self, last: u64) {
        self.0 = last;
    }
}
