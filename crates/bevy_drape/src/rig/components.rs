//! Hand-built rigs: bridges, chains, ragdolls, mobiles, with one entity per particle and one per stick.
//!
//! ```text
//!   Particle o=====Stick { a, b }=====o Particle        InRig ----> Rig + Particles + Sticks + Activity
//!            pinned                     \=====o                     (one entity, spawned by the plugin)
//! ```
//!
//! Particles that sticks join form one body. Before a step the plugin compiles the additions, changes and removals
//! since the last one: it spawns an entity with a [`Rig`] and the body's columns, and puts [`InRig`] on each particle.
//! After a step it writes the particles' [`Transform`]s.
//!
//! An edit keeps the velocities of all remaining particles, even if it splits a body or joins two. Particles are
//! numbered in the order of insertion, so that entity ids do not matter to the result.

use bevy::ecs::lifecycle::HookContext;
use bevy::ecs::world::DeferredWorld;
use bevy::prelude::*;
use drape_solver::constants::MAX_MAGNITUDE;
use drape_solver::error::{in_range, positive};
use drape_solver::{BuildError, StickMaterial};
pub use drape_solver::{StickBound, StickKind};

/// A point mass of a hand-built rig. Join it to others with [`Stick`]s; alone it just falls.
///
/// It starts at its [`Transform`]. From then on the plugin writes the translation of a free particle; moving it by hand
/// teleports the particle, which keeps its velocity. A pinned particle follows its `Transform`, evenly over the next
/// step, and pulls the rig along.
///
/// A [`SolverSettings`](crate::body::settings::SolverSettings) on a particle applies to its whole rig. If several
/// particles have one, that of the oldest particle counts.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform, ParticleRecord)]
#[component(on_add = particle_added, on_remove = note_removal)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Particle {
    /// Mass in kilograms, from 1e-6 to 1e6. A pinned particle needs one too, for the moment it is freed.
    pub mass: f32,
    /// True if the particle is held at its [`Transform`].
    pub pinned: bool,
    /// Velocity at the start in m/s. Read once; later velocities are in the body's
    /// [`Particles`](crate::body::particles::Particles).
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub velocity: Vec3,
}

impl Default for Particle {
    fn default() -> Self {
        Self { mass: 1.0, pinned: false, velocity: Vec3::ZERO }
    }
}

impl Particle {
    /// A free particle of `mass` kilograms.
    pub fn new(mass: f32) -> Self {
        Self { mass, ..Self::default() }
    }

    /// Continues the motion between two frames of an animation that are `dt` seconds apart, from `previous` to
    /// `current` (world, metres). With `dt` zero the velocity stays.
    #[must_use]
    pub fn moved(self, previous: Vec3, current: Vec3, dt: f32) -> Self {
        let velocity = (current - previous) / dt;
        if velocity.is_finite() { Self { velocity, ..self } } else { self }
    }

    /// A particle that is held at its [`Transform`].
    pub fn pinned() -> Self {
        Self { pinned: true, ..Self::default() }
    }

    pub(crate) fn inverse_mass(&self) -> f32 {
        if self.pinned { 0.0 } else { 1.0 / self.mass }
    }

    pub(crate) fn validate(&self) -> Result<(), BuildError> {
        if self.mass <= 0.0 {
            return Err(BuildError::NotPositive { field: "mass", value: self.mass });
        }
        in_range("mass", self.mass, 1.0 / MAX_MAGNITUDE, MAX_MAGNITUDE)?;
        for speed in self.velocity.to_array() {
            in_range("velocity", speed, -MAX_MAGNITUDE, MAX_MAGNITUDE)?;
        }
        Ok(())
    }
}

/// Keeps two [`Particle`]s of a hand-built rig at a distance, or bounds their distance.
///
/// Sticks that share a particle are joined by a ball joint. Two bodies of sticks that share two particles are joined by
/// a hinge through both. A stick with a [`bound`](Self::bound) from one to the other limits the angle of the joint.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// use bevy_drape::rig::{Particle, Stick};
///
/// fn spawn_pendulum(mut commands: Commands) {
///     let a = commands.spawn((Particle::pinned(), Transform::from_xyz(0.0, 2.0, 0.0))).id();
///     let b = commands.spawn((Particle::new(0.5), Transform::from_xyz(1.0, 2.0, 0.0))).id();
///     commands.spawn(Stick::new(a, b));
/// }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(StickRecord)]
#[component(on_add = stick_added, on_remove = note_removal)]
pub struct Stick {
    /// Entity of one end, which has a [`Particle`].
    #[entities]
    pub a: Entity,
    /// Entity of the other end.
    #[entities]
    pub b: Entity,
    /// Length in metres that the stick keeps, above 0. `None`: the distance between its ends when it is first
    /// compiled.
    pub rest_length: Option<f32>,
    /// From 0 (slack) to 1 (rigid).
    pub stiffness: f32,
    /// Damping along the stick in 1/s, 0 or more: the relative speed of the ends decays as `exp(-damping t)`.
    pub damping: f32,
    /// Purpose of the stick. Structural sticks are relaxed first, bend sticks last.
    pub kind: StickKind,
    /// Lengths that it allows; only the rest length by default.
    pub bound: StickBound,
}

impl Default for Stick {
    fn default() -> Self {
        Self {
            a: Entity::PLACEHOLDER,
            b: Entity::PLACEHOLDER,
            rest_length: None,
            stiffness: 1.0,
            damping: 0.0,
            kind: StickKind::Structural,
            bound: StickBound::Exact,
        }
    }
}

impl Stick {
    /// A rigid structural stick between two particles, as long as they are apart.
    pub fn new(a: Entity, b: Entity) -> Self {
        Self { a, b, ..Self::default() }
    }

    /// Keeps two particles at least `length` metres apart.
    pub fn at_least(a: Entity, b: Entity, length: f32) -> Self {
        Self { rest_length: Some(length), bound: StickBound::AtLeast, ..Self::new(a, b) }
    }

    /// Keeps two particles at most `length` metres apart.
    pub fn at_most(a: Entity, b: Entity, length: f32) -> Self {
        Self { rest_length: Some(length), bound: StickBound::AtMost, ..Self::new(a, b) }
    }

    pub(crate) fn material(&self) -> StickMaterial {
        StickMaterial { kind: self.kind, stiffness: self.stiffness, damping: self.damping, bound: self.bound }
    }

    /// Checks everything but the ends.
    pub(crate) fn validate(&self) -> Result<(), BuildError> {
        in_range("stiffness", self.stiffness, 0.0, 1.0)?;
        in_range("damping", self.damping, 0.0, MAX_MAGNITUDE)?;
        match self.rest_length {
            Some(length) => positive("rest_length", length).map(|_| ()),
            None => Ok(()),
        }
    }
}

/// A body that was compiled from [`Particle`]s and [`Stick`]s.
///
/// Its entity also has [`Particles`](crate::body::particles::Particles), [`Sticks`](crate::body::particles::Sticks) and
/// [`Activity`](crate::body::activity::Activity). [`InRig`] leads here from a particle entity. The plugin spawns and
/// despawns it.
#[derive(Component, Reflect, Clone, Debug, Default)]
#[reflect(Component, Default, Debug, Clone)]
#[component(on_remove = note_lost_rig, clone_behavior = Ignore)]
pub struct Rig {
    pub(crate) particles: Vec<Entity>,
    pub(crate) sticks: Vec<Entity>,
    /// The particle that gives the body its settings.
    #[reflect(ignore)]
    pub(crate) settings_from: Option<Entity>,
    /// The particle whose surface counts.
    #[reflect(ignore)]
    pub(crate) surface_from: Option<Entity>,
}

impl Rig {
    /// The particle entities, in the order of the body's columns.
    pub fn particles(&self) -> &[Entity] {
        &self.particles
    }

    /// The stick entities in the order of insertion. The solver has another order.
    pub fn sticks(&self) -> &[Entity] {
        &self.sticks
    }
}

/// The body that simulates a [`Particle`], on the particle's entity. Absent until its first step, and while the
/// particle is refused.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, Clone, PartialEq)]
#[component(clone_behavior = Ignore)]
pub struct InRig {
    /// The entity with the [`Rig`], its [`Particles`](crate::body::particles::Particles) and its
    /// [`Activity`](crate::body::activity::Activity).
    pub body: Entity,
    /// The particle's index in the body.
    pub index: usize,
}

/// State of a particle entity that the plugin keeps from step to step.
#[derive(Component, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct ParticleRecord {
    /// Order of insertion; 0 before it is known.
    pub order: u64,
    /// The translation that the plugin wrote or read last; another one found there is a teleport.
    pub written: Vec3,
    /// The same in the world. Pinned particles are compared with it, so that they follow their parents.
    pub placed: Vec3,
    /// True if the particle is refused.
    pub refused: bool,
}

/// State of a stick entity that the plugin keeps from step to step.
#[derive(Component, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct StickRecord {
    /// Order of insertion; 0 before it is known.
    pub order: u64,
    /// Distance in metres between these ends when the stick was first compiled. Later, under load, the stick is longer
    /// or shorter.
    pub measured: Option<([Entity; 2], f32)>,
    /// True if the stick is refused.
    pub refused: bool,
}

/// Removals since the last step, and the count of insertions.
#[derive(Resource, Default)]
pub(crate) struct RigEdits {
    insertions: u64,
    /// Entities that lost a particle or a stick.
    pub removed: Vec<Entity>,
    /// True if a body was removed by hand.
    pub lost_rig: bool,
    /// Particles that are refused as long as their transforms are not finite.
    pub misplaced: Vec<Entity>,
}

impl RigEdits {
    /// Restarts the count at 1.
    pub fn begin_anew(&mut self) {
        self.insertions = 0;
    }

    pub fn next_order(&mut self) -> u64 {
        self.insertions += 1;
        self.insertions
    }
}

/// Hooks know the exact order of insertion and miss no removal, however rare steps are. Without the plugin they do
/// nothing.
fn next_order(world: &mut DeferredWorld) -> u64 {
    world.get_resource_mut::<RigEdits>().map_or(0, |mut edits| edits.next_order())
}

fn particle_added(mut world: DeferredWorld, context: HookContext) {
    let order = next_order(&mut world);
    if let Some(mut record) = world.get_mut::<ParticleRecord>(context.entity) {
        record.order = order;
    }
}

fn stick_added(mut world: DeferredWorld, context: HookContext) {
    let order = next_order(&mut world);
    if let Some(mut record) = world.get_mut::<StickRecord>(context.entity) {
        *record = StickRecord { order, ..default() };
    }
}

fn note_removal(mut world: DeferredWorld, context: HookContext) {
    if let Some(mut edits) = world.get_resource_mut::<RigEdits>() {
        edits.removed.push(context.entity);
    }
}

fn note_lost_rig(mut world: DeferredWorld, context: HookContext) {
    // The plugin empties a rig before it despawns it.
    let is_lost = world.get::<Rig>(context.entity).is_some_and(|rig| !rig.particles.is_empty());
    if is_lost && let Some(mut edits) = world.get_resource_mut::<RigEdits>() {
        edits.lost_rig = true;
    }
}
