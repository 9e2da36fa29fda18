//! A body: topology, particles and settings, with the scratch of a step.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::simd::columns::Columns;
use crate::simd::rows::Rows;
use crate::state::bends::BendScratch;
use crate::state::drag::Drag;
use crate::state::frame_motion::SubstepMotion;
use crate::state::layers::Layers;
use crate::state::particles::Particles;
use crate::state::settings::BodySettings;
use crate::state::topology::Topology;
use crate::state::watch::Watch;

/// A cloth, a rope or a rig, ready to be stepped.
#[derive(Clone, Debug, Default)]
pub struct Body {
    /// Positions and motion of the particles.
    pub particles: Particles,
    /// Sticks, faces and tethers; shared between equal bodies.
    pub topology: Arc<Topology>,
    /// Accuracy, damping and surface.
    pub settings: BodySettings,
    /// The layers that the body belongs to, and those that it touches.
    pub layers: Layers,
    /// True if [`Island::contacts`](crate::Island::contacts) reports the body's contacts. Such a body is stepped
    /// substep by substep while it touches something.
    pub reports_contacts: bool,
    /// Target volume of a closed body, in parts of its rest volume: 1 keeps it, more inflates it, and 0, the default,
    /// turns pressure off. Has no effect if the [faces are not closed](Topology::rest_volume).
    pub pressure: f32,
    /// Scratch of the step, kept so that a step allocates nothing once warm.
    pub context: BodyContext,
}

impl Body {
    /// A body of these particles, joined by this topology.
    pub fn new(particles: Particles, topology: Arc<Topology>, settings: BodySettings) -> Self {
        Self { particles, topology, settings, ..Self::default() }
    }

    /// Seconds for which the body has been slower than the threshold of rest.
    pub fn still_for(&self) -> f32 {
        self.context.still_for()
    }

    /// True if the body collides with itself, and with others that have self-contact.
    pub(crate) fn has_self_contact(&self) -> bool {
        self.settings.has_self_contact() && !self.particles.is_empty()
    }
}

/// Scratch of one body during a step. Only its memory and the time at rest outlive the step.
#[derive(Clone, Debug, Default)]
pub struct BodyContext {
    /// Gravity: the same for all particles.
    pub(crate) uniform_acceleration: Vec3,
    /// Accelerations by wind and forces; empty where there are none.
    pub(crate) acceleration: Columns,
    /// Positions after integration, from which the projections of a substep are measured.
    pub(crate) integrated: Columns,
    pub(crate) drag: Drag,
    /// Factors of stiffness and damping, one for each batch of sticks.
    pub(crate) stiffness: Vec<f32>,
    /// The number of times that bends and membranes are solved in a substep over the square of its duration, in 1/s^2: the factor of
    /// their compliances.
    pub(crate) compliance_scale: f32,
    pub(crate) bends: BendScratch,
    pub(crate) damping: Vec<f32>,
    /// Positions of the pins of tethers.
    pub(crate) anchors: Columns,
    /// Slot and displacement in a substep, in metres, of each pin that moves.
    pub(crate) pin_shifts: Vec<(u32, Vec3)>,
    /// Motion of the frame in a substep; none if it is at rest.
    pub(crate) frame: Option<SubstepMotion>,
    /// Slots of the particles that their motion limits held inside an obstacle at the end of the last step.
    pub(crate) limit_conflicts: Vec<u32>,
    /// Rows in which listed sticks are relaxed and damped: of positions, and of displacements.
    pub(crate) rows: [Rows; 2],
    /// Gradient of the volume by each particle's position, in square metres.
    pub(crate) gradient: Vec<DVec3>,
    /// The ways of the particles, while nothing of the body is expected to touch.
    pub(crate) watch: Watch,
    pub(crate) still_for: f32,
}

impl BodyContext {
    /// The number of particles that their [limits](Particles::set_motion_limit) held in an obstacle at the end of the
    /// last step, deeper than contacts leave them.
    pub fn limit_conflicts(&self) -> usize {
        self.limit_conflicts.len()
    }

    /// Seconds for which the body has been slower than the threshold of rest.
    pub fn still_for(&self) -> f32 {
        self.still_for
    }
}

impl Body {
    /// Displacement of the particle in `slot` in this substep so far: integration and projections.
    pub(crate) fn travel(&self, slot: usize) -> Vec3 {
        let projected = self.particles.position.get(slot) - self.context.integrated.get(slot);
        self.particles.displacement.get(slot) + projected
    }

    /// Moves pinned particles by one substep towards their targets.
    pub(crate) fn move_pins(&mut self) {
        for &(slot, shift) in &self.context.pin_shifts {
            self.particles.position.add(slot as usize, shift);
        }
    }

    /// Stores the displacement of pins that move, which integration has set to zero.
    pub(crate) fn note_pin_travel(&mut self) {
        for &(slot, shift) in &self.context.pin_shifts {
            self.particles.displacement.set(slot as usize, shift);
        }
    }

    /// Memory of the state, of this scratch, and of sticks and tethers, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let Self { particles, topology, context, .. } = self;
        let columns = [&particles.position, &particles.displacement, &context.integrated];
        let cells = columns.into_iter().map(|column| size_of_val(&*column.cells)).sum::<usize>();
        let masses = size_of_val(&*particles.inverse_mass) + size_of_val(&*particles.masses.common);
        let bends = context.bends.bytes() + particles.plastic.bytes();
        cells + masses + context.rows.iter().map(Rows::bytes).sum::<usize>() + bends + topology.bytes()
    }
}
