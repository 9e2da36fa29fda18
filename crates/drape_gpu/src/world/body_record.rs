//! One body of a world: what the processor remembers of it.

use drape_solver::constants::TETHER_SPEED;
use drape_solver::glam::Vec3;
use drape_solver::state::drag::Drag;
use drape_solver::{Body, BodySettings, Layers, StickProjection};

use crate::layout::BodyData;
use crate::model::Model;

/// The name of a body in its [`GpuWorld`](crate::GpuWorld), never used again for another one. Another world cannot tell that it is not its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GpuBodyId(pub(super) u32);

/// The place of a body in the buffers of its world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BodyPlace {
    pub origin: Vec3,
    pub first_particle: u32,
    pub particle_count: u32,
    pub first_fan: u32,
}

#[derive(Debug)]
pub(super) struct BodyRecord {
    pub model: usize,
    pub settings: BodySettings,
    pub layers: Layers,
    pub origin: Vec3,
    pub first_particle: u32,
    /// Its place in the table of bodies; none before its first step, and while it rests.
    pub number: Option<u32>,
    /// True once its particles are on the GPU.
    pub has_arrived: bool,
    /// True if steps leave it alone.
    pub is_resting: bool,
    /// 1 over the mass of all particles in 1/kg; 0 if some are pinned.
    pub inverse_mass: f32,
    /// The factor on its displacements in the coming step, as its substeps were set.
    pub rescale: f32,
    /// Particles that are pinned, in ascending order.
    pub pins: Vec<u32>,
}

impl BodyRecord {
    /// A body whose particles lie from `first_particle` on.
    pub fn new(body: &Body, model: usize, first_particle: u32) -> Self {
        let particles = &body.particles;
        let masses = (0..particles.len()).map(|i| 1.0 / f64::from(particles.inverse_mass(i)));
        Self {
            model,
            settings: body.settings,
            layers: body.layers,
            origin: particles.origin(),
            first_particle,
            number: None,
            has_arrived: false,
            is_resting: false,
            inverse_mass: (1.0 / masses.sum::<f64>()) as f32,
            rescale: 1.0,
            pins: (0..particles.len() as u32).filter(|&i| particles.is_pinned(i as usize)).collect(),
        }
    }

    /// Its entry in the table of bodies, for steps of `dt` seconds, if the pairs of its model begin at `first_pair`.
    pub fn data(&self, model: &Model, dt: f32, first_pair: u32, first_batch: u32) -> BodyData {
        let settings = &self.settings;
        let substep = dt / settings.substeps as f32;
        let drag = Drag::new(settings.drag, substep);
        let [columns, rows] = model.grid.unwrap_or_default();
        BodyData {
            origin: self.origin.to_array(),
            first_particle: self.first_particle,
            particle_count: model.particle_count,
            substeps: settings.substeps,
            iterations: settings.iterations,
            is_square_root_free: u32::from(settings.projection == StickProjection::SquareRootFree),
            first_batch,
            batch_count: model.batches.len() as u32,
            first_tether: first_pair + model.first_tether,
            tethers_per_particle: if settings.tethers { model.tethers_per_particle } else { 0 },
            first_fan: first_pair + model.first_fan,
            memberships: self.layers.memberships,
            filters: self.layers.filters,
            thickness: settings.thickness,
            friction: settings.friction,
            static_friction: settings.static_friction.max(settings.friction),
            substep,
            decay: drag.decay(),
            gain: drag.gain() * substep * substep,
            tether_pull: TETHER_SPEED * substep,
            columns,
            rows,
            inverse_mass: self.inverse_mass,
            rescale: self.rescale,
            has_squares: u32::from(model.has_squares),
            unused: 0,
        }
    }
}
