//! Particles that follow an entity: a cape on a character's bones, a rope between two posts.

use bevy::ecs::entity::MapEntities;
use bevy::prelude::*;

use crate::attach::attachment_state::AttachmentState;

/// Ties particles of a body to other entities: a hand, a ship, a joint of a skinned character.
///
/// A tied particle keeps its place relative to the entity's [`GlobalTransform`], as it was at the moment of tying. In
/// each step it moves there evenly over the substeps and pulls the cloth along; nothing else moves it. The last tie of
/// a particle counts. A tied pin no longer follows the body's own entity.
///
/// A [`DynamicObstacle`](crate::environment::dynamic_obstacle::DynamicObstacle) is pulled in turn by what is tied to it, and so is a
/// dynamic body of a bridged physics engine: a wrecking ball on a chain, a crate under a parachute. Tied to a point inside
/// it, a body passes its surface. Children of such an entity pull at nothing.
///
/// Remove the component or the tie to release its particles. Despawning the entity releases them too, with a line in
/// the log. Particles that were pinned before stay pinned. Change the component at any time: particles that stay tied
/// to the same entity keep their places.
///
/// A culled body is carried along as a whole, and so is a body whose entity jumps faster than 1500 m/s.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// fn hang(mut commands: Commands) {
///     let hook = commands.spawn(Transform::from_xyz(0.0, 2.0, 0.0)).id();
///     let boat = commands.spawn(Transform::from_xyz(1.0, 2.0, 0.0)).id();
///     let rope = Rope::new(Vec3::new(0.0, 2.0, 0.0), Vec3::new(1.0, 2.0, 0.0), 32);
///     commands.spawn((rope, Attachment::first(hook).and(Tie::last(boat))));
/// }
/// ```
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(AttachmentState)]
pub struct Attachment {
    /// The ties.
    #[entities]
    pub ties: Vec<Tie>,
}

/// Particles that are tied to one entity.
#[derive(MapEntities, Reflect, Clone, Debug, PartialEq, Eq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct Tie {
    /// The entity that they follow.
    #[entities]
    pub entity: Entity,
    /// The particles.
    pub particles: TiedParticles,
}

/// The particles of a body that a [`Tie`] holds.
#[derive(Reflect, Clone, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum TiedParticles {
    /// The pinned particles of the body: a cape's painted collar, a curtain's top edge.
    #[default]
    Pinned,
    /// The first particle: the start of a rope.
    First,
    /// The last particle: the end of a rope.
    Last,
    /// The particles with these indices. Missing ones are logged and left out.
    Indices(Vec<u32>),
}

impl Tie {
    /// Ties these particles to `entity`.
    pub fn new(entity: Entity, particles: TiedParticles) -> Self {
        Self { entity, particles }
    }

    /// Ties the pinned particles of the body.
    pub fn pinned(entity: Entity) -> Self {
        Self::new(entity, TiedParticles::Pinned)
    }

    /// Ties the first particle.
    pub fn first(entity: Entity) -> Self {
        Self::new(entity, TiedParticles::First)
    }

    /// Ties the last particle.
    pub fn last(entity: Entity) -> Self {
        Self::new(entity, TiedParticles::Last)
    }

    /// Ties the particles with these indices.
    pub fn indices(entity: Entity, indices: impl IntoIterator<Item = u32>) -> Self {
        Self::new(entity, TiedParticles::Indices(indices.into_iter().collect()))
    }
}

impl From<Tie> for Attachment {
    fn from(tie: Tie) -> Self {
        Self { ties: vec![tie] }
    }
}

impl Attachment {
    /// Ties the pinned particles of the body to `entity`.
    pub fn pinned(entity: Entity) -> Self {
        Tie::pinned(entity).into()
    }

    /// Ties the first particle to `entity`.
    pub fn first(entity: Entity) -> Self {
        Tie::first(entity).into()
    }

    /// Ties the last particle to `entity`.
    pub fn last(entity: Entity) -> Self {
        Tie::last(entity).into()
    }

    /// Ties the particles with these indices to `entity`.
    pub fn indices(entity: Entity, indices: impl IntoIterator<Item = u32>) -> Self {
        Tie::indices(entity, indices).into()
    }

    /// Adds another tie.
    pub fn and(mut self, tie: Tie) -> Self {
        self.ties.push(tie);
        self
    }
}
