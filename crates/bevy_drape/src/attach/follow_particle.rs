//! Entities that follow a particle: a lamp on a chain, a bucket on a rope.

use bevy::prelude::*;

use crate::body::activity::Activity;
use crate::body::particles::Particles;
use crate::change_detection::collect_changed;

/// Keeps an entity at a particle of a body. Each step sets the translation of its [`Transform`], and the rotation if it
/// [turns](Self::turns) with the rope. Add [`Interpolated`](crate::transform::interpolation::Interpolated) for smooth
/// motion.
///
/// The entity has no mass: add the mass of the lamp to the particle
/// ([`set_inverse_mass`](drape_solver::Particles::set_inverse_mass)), or to the [end](crate::build::rope::Rope::end_mass) of a
/// rope. If body or particle is gone, the entity stays in place.
///
/// It is a relationship: the body has its [`ParticleFollowers`]. To change it, insert it again.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// fn light_up(mut commands: Commands) {
///     let rope = commands.spawn(Rope::default()).id();
///     commands.spawn((PointLight::default(), FollowParticle::last(rope).turning()));
/// }
/// # #[derive(Component, Default)] struct PointLight;
/// ```
#[derive(Component, FromTemplate, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Clone, PartialEq)]
#[require(Transform)]
#[relationship(relationship_target = ParticleFollowers)]
pub struct FollowParticle {
    /// The body.
    #[relationship]
    #[entities]
    pub body: Entity,
    /// The particle.
    pub particle: FollowedParticle,
    /// Position of the entity relative to the particle, in the entity's coordinates, in metres.
    pub offset: Vec3,
    /// True to turn the entity's Y axis from the particle towards the one before it (from the first to the second): up
    /// the rope that it hangs on. The turn is minimal, so the entity does not spin about the rope.
    pub turns: bool,
}

/// The entities that follow particles of a body: see [`FollowParticle`].
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[relationship_target(relationship = FollowParticle)]
pub struct ParticleFollowers(Vec<Entity>);

/// The particle that is followed.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum FollowedParticle {
    /// The first particle.
    First,
    /// The last particle.
    #[default]
    Last,
    /// The particle with this index.
    Index(u32),
}

impl FollowParticle {
    /// Follows a particle of `body`, without an offset.
    pub fn new(body: Entity, particle: FollowedParticle) -> Self {
        Self { body, particle, offset: Vec3::ZERO, turns: false }
    }

    /// Follows the first particle.
    pub fn first(body: Entity) -> Self {
        Self::new(body, FollowedParticle::First)
    }

    /// Follows the last particle.
    pub fn last(body: Entity) -> Self {
        Self::new(body, FollowedParticle::Last)
    }

    /// Follows the particle with this index.
    pub fn index(body: Entity, index: u32) -> Self {
        Self::new(body, FollowedParticle::Index(index))
    }

    /// Sets the position of the entity relative to the particle, in the entity's coordinates, in metres.
    pub fn with_offset(mut self, offset: Vec3) -> Self {
        self.offset = offset;
        self
    }

    /// Turns the entity along the rope.
    pub fn turning(mut self) -> Self {
        self.turns = true;
        self
    }

    /// Returns the indices of the particle and of its neighbour; none if there is no such particle.
    fn indices(&self, count: usize) -> Option<[usize; 2]> {
        let particle = match self.particle {
            FollowedParticle::First => 0,
            FollowedParticle::Last => count.checked_sub(1)?,
            FollowedParticle::Index(index) => index as usize,
        };
        let neighbour = particle.checked_sub(1).unwrap_or(1);
        (particle < count && neighbour < count).then_some([particle, neighbour])
    }
}

/// Moves entities to the particles that they follow.
pub(crate) fn follow_particles(
    changed: Query<(Entity, Ref<FollowParticle>)>,
    mut followers: Query<(Entity, &FollowParticle, &mut Transform, Option<&ChildOf>)>,
    bodies: Query<(Ref<Particles>, &Activity)>,
    parents: Query<&GlobalTransform>,
    mut new: Local<Vec<Entity>>,
) {
    new.clear();
    collect_changed(&changed, &mut new);
    for (entity, follow, mut transform, child_of) in &mut followers {
        let Ok((particles, activity)) = bodies.get(follow.body) else { continue };
        // Frozen and culled bodies may be carried along.
        let is_carried = particles.is_changed();
        let is_due =
            *activity == Activity::Active || is_carried || child_of.is_some() || new.contains(&entity);
        let Some([particle, neighbour]) = follow.indices(particles.len()).filter(|_| is_due) else {
            continue;
        };
        let place = particles.position(particle);
        let to_parent = child_of.and_then(|child_of| parents.get(child_of.parent()).ok());
        let to_parent = to_parent.map(|parent| parent.affine().inverse());
        let local = |point: Vec3| to_parent.map_or(point, |to_parent| to_parent.transform_point3(point));
        let mut placed = Transform { translation: local(place), ..*transform };
        let up = (local(particles.position(neighbour)) - placed.translation).normalize_or_zero();
        if follow.turns && up != Vec3::ZERO {
            let turn = Quat::from_rotation_arc(placed.rotation * Vec3::Y, up);
            placed.rotation = (turn * placed.rotation).normalize();
        }
        placed.translation += placed.rotation * follow.offset;
        // The transform of the parent may have a scale of zero, or not be finite.
        if placed.is_finite() {
            transform.set_if_neq(placed);
        }
    }
}
