//! Particles that follow an entity: a cape on a character's bones, a rope between two posts.

use bevy::ecs::entity::MapEntities;
use bevy::prelude::*;

use crate::attach::attachment_state::AttachmentState;

/// Ties particles of the body that it is on to other entities: a hand, a ship, a joint of a skinned character.
///
/// A tied particle keeps the place that it has relative to the entity's [`GlobalTransform`] when it is tied, and goes there evenly
/// over the substeps of each step, pulling the cloth along. Nothing else moves it. Of two ties of one particle the later counts;
/// any counts more than the body's own entity, which pins follow otherwise.
///
/// Particles are let go when the component or the tie is removed, or when the entity they are tied to is despawned, which is told in
/// the log; those that were pinned before stay where they are. The component may be changed at any time: what stays tied to the same
/// entity keeps its place.
///
/// A body that is culled, or whose entity jumps farther than anything moves in a step, is carried along as a whole.
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

/// Which particles of a body a [`Tie`] holds.
#[derive(Reflect, Clone, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum TiedParticles {
    /// Those that the body has pinned itself: a cape's painted collar, a curtain's top edge.
    #[default]
    Pinned,
    /// The first: the start of a rope.
    First,
    /// The last: the end of a rope.
    Last,
    /// Those with these indices. What is not there is told in the log, and left out.
    Indices(Vec<u32>),
}

impl Tie {
    /// Ties these particles to `entity`.
    pub fn new(entity: Entity, particles: TiedParticles) -> Self {
        Self { entity, particles }
    }

    /// Ties the particles that the body has pinned itself.
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
    /// Ties the particles that the body has pinned itself to `entity`.
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

    /// Another tie besides.
    pub fn and(mut self, tie: Tie) -> Self {
        self.ties.push(tie);
        self
    }
}
