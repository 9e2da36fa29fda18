//! The entities that a name of the scene stands for.

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::prelude::*;

/// The entities that a name stands for.
#[derive(Clone, Debug)]
pub(super) enum NamedEntity {
    /// A body that the plugin builds of a description, such as a cloth or rope, and the pieces that came off it.
    Body {
        body: Entity,
        pieces: Vec<Entity>,
    },
    /// The particles of a rig, in the order of their names, and its sticks.
    Rig {
        particles: Vec<Entity>,
        sticks: Vec<Entity>,
    },
    Balls(Vec<Entity>),
    Obstacle(Entity),
    Wind(Entity),
    Cannon {
        cannon: Entity,
        balls: Vec<Entity>,
    },
}

impl NamedEntity {
    /// Its entities, without the sticks of rigs and the balls of cannons.
    pub fn entities(&self) -> Vec<Entity> {
        match self {
            Self::Body { body, pieces } => [&[*body], &pieces[..]].concat(),
            Self::Obstacle(entity) | Self::Wind(entity) => vec![*entity],
            Self::Rig { particles, .. } => particles.clone(),
            Self::Balls(balls) => balls.clone(),
            Self::Cannon { cannon, .. } => vec![*cannon],
        }
    }

    /// Piece or ball `index`, from 0. The first piece is the body itself.
    pub fn part(&self, index: usize) -> Option<Entity> {
        match self {
            Self::Balls(balls) | Self::Cannon { balls, .. } => balls.get(index).copied(),
            Self::Body { body, .. } if index == 0 => Some(*body),
            Self::Body { pieces, .. } => pieces.get(index - 1).copied(),
            _ => None,
        }
    }

    /// The name of `entity`, if it is one of these called `name`: of balls and pieces with their number.
    pub fn name_of(&self, entity: Entity, name: &str) -> Option<String> {
        let position = |entities: &[Entity]| entities.iter().position(|&own| own == entity);
        match self {
            Self::Body { body, pieces } if *body == entity && pieces.is_empty() => Some(name.to_string()),
            Self::Body { body, .. } if *body == entity => Some(format!("{name}#1")),
            Self::Body { pieces, .. } => position(pieces).map(|index| format!("{name}#{}", index + 2)),
            Self::Obstacle(own) | Self::Wind(own) => (*own == entity).then(|| name.to_string()),
            Self::Rig { particles, .. } => particles.contains(&entity).then(|| name.to_string()),
            Self::Balls(balls) | Self::Cannon { balls, .. } => {
                position(balls).map(|index| format!("{name}#{}", index + 1))
            }
        }
    }

    /// Despawns all entities, with sticks and shot balls.
    pub fn despawn(self, world: &mut World) {
        let entities = match self {
            Self::Body { body, mut pieces } => {
                pieces.push(body);
                pieces
            }
            Self::Obstacle(entity) | Self::Wind(entity) => vec![entity],
            Self::Rig { particles, sticks } => sticks.into_iter().chain(particles).collect(),
            Self::Balls(balls) => balls,
            Self::Cannon { cannon, mut balls } => {
                balls.push(cannon);
                balls
            }
        };
        entities.into_iter().for_each(|entity| despawn(world, entity));
    }
}

/// Despawns an entity that may be gone already, as lost balls are.
pub(super) fn despawn(world: &mut World, entity: Entity) {
    if let Ok(entity) = world.get_entity_mut(entity) {
        entity.despawn();
    }
}

/// True for a body of particles that has been built.
pub(super) fn is_body(world: &World, entity: Entity) -> bool {
    world.get::<Particles>(entity).is_some()
}

/// True for a ball.
pub(super) fn is_ball(world: &World, entity: Entity) -> bool {
    world.get::<ProjectileState>(entity).is_some()
}
