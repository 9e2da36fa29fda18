//! A body: topology, particles and settings, with what one step needs.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::simd::columns::Columns;
use crate::simd::rows::Rows;
use crate::state::drag::Drag;
use crate::state::frame_motion::SubstepMotion;
use crate::state::layers::Layers;
use crate::state::particles::Particles;
use crate::state::settings::SolverSettings;
use crate::state::topology::Topology;

/// A cloth, a rope or a rig, ready to be stepped.
#[derive(Clone, Debug, Default)]
pub struct Body {
    /// Where the particles are and how they move.
    pub particles: Particles,
    /// How they are joined; shared between equal bodies.
    pub topology: Arc<Topology>,
    /// How the body is stepped.
    pub settings: SolverSettings,
    /// Which layers it belongs to, and which it touches.
    pub layers: Layers,
    /// Whether [`Island::contacts`](crate::Island::contacts) tells what it touches. Such a body is stepped substep by
    /// substep while it touches something.
    pub reports_contacts: bool,
    /// The volume that a closed body keeps, in parts of that at rest: 1 keeps it, more blows it up; 0, the default, lets it be.
    /// Nothing happens where [faces are not closed](Topology::rest_volume).
    pub pressure: f32,
    /// Scratch of the step, kept so that a step allocates nothing once warm.
    pub context: BodyContext,
}

impl Body {
    /// A body of these particles, joined by this topology.
    pub fn new(particles: Particles, topology: Arc<Topology>, settings: SolverSettings) -> Self {
        Self { particles, topology, settings, ..Self::default() }
    }

    /// How long the body has been slower than the threshold of rest, in seconds.
    pub fn still_for(&self) -> f32 {
        self.context.still_for()
    }

    /// True if the body touches itself and others that do so.
    pub(crate) fn has_self_contact(&self) -> bool {
        self.settings.has_self_contact() && !self.particles.is_empty()
    }
}

/// What one body needs during a step. Holds nothing that outlives the step but its own memory and the time
/// that the body has been still.
#[derive(Clone, Debug, Default)]
pub struct BodyContext {
    /// Gravity: the same for all particles.
    pub(crate) uniform_acceleration: Vec3,
    /// Accelerations by wind and forces; empty where there are none.
    pub(crate) acceleration: Columns,
    /// Positions after integration: what projections are measured against.
    pub(crate) integrated: Columns,
    pub(crate) drag: Drag,
    /// Factors of stiffness and damping, one for each batch of sticks.
    pub(crate) stiffness: Vec<f32>,
    pub(crate) damping: Vec<f32>,
    /// Where the pins are that tethers hold on to.
    pub(crate) anchors: Columns,
    /// How far each kinematic pin moves in a substep.
    pub(crate) pin_shifts: Vec<(u32, Vec3)>,
    /// How the frame moves in a substep, if it does.
    pub(crate) frame: Option<SubstepMotion>,
    /// Particles, by slot, that their limits kept in an obstacle at the end of the last step.
    pub(crate) limit_conflicts: Vec<u32>,
    /// What listed sticks are relaxed in.
    pub(crate) rows: Rows,
    /// How the volume grows with each particle's place.
    pub(crate) gradient: Vec<DVec3>,
    pub(crate) still_for: f32,
}

impl BodyContext {
    /// Particles that were deeper in an obstacle at the end of the last step than contacts leave them, as their
    /// [limit](Particles::set_motion_limit) let them go no farther.
    pub fn limit_conflicts(&self) -> usize {
        self.limit_conflicts.len()
    }

    /// How long the body has been slower than the threshold of rest, in seconds.
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

    /// Takes pinned particles one substep further on their way.
    pub(crate) fn move_pins(&mut self) {
        for &(slot, shift) in &self.context.pin_shifts {
            self.particles.position.add(slot as usize, shift);
        }
    }

    /// Gives pins that move their displacement, once integration has left them without one.
    pub(crate) fn note_pin_travel(&mut self) {
        for &(slot, shift) in &self.context.pin_shifts {
            self.particles.displacement.set(slot as usize, shift);
        }
    }

    /// Memory of the state, of the scratch here, and of sticks and tethers, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let Self { particles, topology, context, .. } = self;
        let columns = [&particles.position, &particles.displacement, &context.integrated];
        let cells = columns.into_iter().map(|column| size_of_val(&*column.cells)).sum::<usize>();
        let masses = size_of_val(&*particles.inverse_mass) + size_of_val(&*particles.masses.common);
        cells + masses + context.rows.bytes() + topology.bytes()
    }
}
