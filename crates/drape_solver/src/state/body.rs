//! A body: topology, particles and settings, with what one step needs.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::constraint::direct::line::LineScratch;
use crate::constraint::stick::{greatest_error, iteration_stiffness, substep_damping};
use crate::contact::embedded_obstacle::EmbeddedContacts;
use crate::contact::face_obstacle::FaceContacts;
use crate::contact::particle_obstacle::ObstacleContacts;
use crate::motion::frame_motion::SubstepMotion;
use crate::motion::integrate::Drag;
use crate::simd::columns::Columns;
use crate::simd::rows::Rows;
use crate::state::layers::Layers;
use crate::state::particles::Particles;
use crate::state::settings::{SolverSettings, StructuralSolve};
use crate::state::topology::Topology;
use crate::substep::plan::{Extras, Plan};

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
    pub(crate) contacts: ObstacleContacts,
    pub(crate) faces: FaceContacts,
    pub(crate) embedded: EmbeddedContacts,
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
    pub(crate) lines: LineScratch,
    /// How the volume grows with each particle's place.
    pub(crate) gradient: Vec<DVec3>,
    /// The order of work of a substep.
    pub(crate) plan: Plan,
    pub(crate) still_for: f32,
}

impl BodyContext {
    /// How long the body has been slower than the threshold of rest, in seconds.
    pub fn still_for(&self) -> f32 {
        self.still_for
    }
}

impl Body {
    /// Puts the particles where the topology looks for them, and takes a look at them where something has changed.
    pub(crate) fn prepare(&mut self) {
        let Self { particles, topology, .. } = self;
        particles.arrange(&topology.layout);
        particles.masses.update(&particles.inverse_mass, &particles.layout);
        particles.take_survey();
    }

    /// Sets everything that stays the same through the substeps of one step.
    ///
    /// `projections` is the number of iterations of the island, and so of the projections of contacts.
    pub(crate) fn begin_step(&mut self, substep: f32, substeps: u32, projections: u32) {
        let Self { particles, topology, settings, context, .. } = self;
        particles.set_substep(substep);
        context.drag = Drag::new(settings.drag, substep);
        let materials = topology.batches.iter().map(|batch| &batch.material);
        let felt = context.drag.felt_substep(substep);
        context.stiffness.clear();
        context
            .stiffness
            .extend(materials.clone().map(|m| iteration_stiffness(m.stiffness, felt, settings.iterations)));
        context.damping.clear();
        context.damping.extend(materials.map(|m| substep_damping(m, substep)));
        if context.integrated.cells.len() != particles.layout.cells() {
            context.integrated.reset(particles.layout.cells());
        }
        context.rows.reset(topology.window(), particles.layout.cells());
        if settings.structural == StructuralSolve::Lines {
            context.lines.reserve(&topology.layout);
        }
        let frame = particles.frame.as_ref();
        context.frame = frame.map(|motion| SubstepMotion::new(motion, substeps, particles.origin));
        let extras = Extras { has_frame: context.frame.is_some(), has_limits: !particles.limits.is_empty() };
        context.plan.make(topology, settings, &context.stiffness, projections, extras);
        context.pin_shifts.clear();
        for &(i, target) in &particles.pin_targets {
            let way = target - particles.origin - particles.position.get(i as usize);
            context.pin_shifts.push((i, way / substeps as f32));
        }
    }

    /// How far an edit can make sticks, pins, limits and the frame pull a particle in the coming step, in metres. Zero where nothing was
    /// edited: what sticks did in the last step is in the velocities already.
    pub(crate) fn pull(&self) -> f32 {
        if !self.particles.disturbed {
            return 0.0;
        }
        let pins = self.particles.pin_targets.iter();
        let ways = pins.map(|&(i, target)| {
            target.distance(self.particles.origin + self.particles.position.get(i as usize))
        });
        let pull = ways.fold(greatest_error(&self.particles, &self.topology), f32::max);
        let Particles { layout, limits, position, frame, .. } = &self.particles;
        let limited = layout.slots().filter(|_| !limits.is_empty());
        let held_back = limited.filter_map(|slot| {
            let (_, target, reach) = limits.get(slot)?;
            Some(target.distance(position.get(slot)) - reach)
        });
        let carried = frame.map_or(0.0, |motion| motion.reach(self.particles.bounds()));
        held_back.fold(pull, f32::max) + carried
    }

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

    /// Memory of the state, of what a step needs, and of sticks and tethers, in bytes. Faces, which only contacts with
    /// balls and the wind read, and lists of contacts are not counted.
    pub fn bytes(&self) -> usize {
        let Self { particles, topology, context, .. } = self;
        let columns = [&particles.position, &particles.displacement, &context.integrated];
        let cells = columns.into_iter().map(|column| size_of_val(&*column.cells)).sum::<usize>();
        let masses = size_of_val(&*particles.inverse_mass) + size_of_val(&*particles.masses.common);
        cells + masses + context.rows.bytes() + context.lines.bytes() + topology.bytes()
    }
}
