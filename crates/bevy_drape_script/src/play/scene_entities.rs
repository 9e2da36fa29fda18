//! The names of a scene and their entities.

use std::collections::BTreeMap;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::rig::Rig;

use super::named_entity::{NamedEntity, despawn, is_ball, is_body};
use super::simulated_entities::SimulatedEntities;

/// All that the scene has spawned and not despawned, by name.
#[derive(Debug, Default)]
pub(super) struct SceneEntities {
    by_name: BTreeMap<String, NamedEntity>,
}

impl From<BTreeMap<String, NamedEntity>> for SceneEntities {
    fn from(by_name: BTreeMap<String, NamedEntity>) -> Self {
        Self { by_name }
    }
}

impl SceneEntities {
    pub fn get(&self, name: &str) -> Option<&NamedEntity> {
        self.by_name.get(name)
    }

    pub fn contains(&self, name: &str) -> bool {
        self.by_name.contains_key(name)
    }

    pub fn insert(&mut self, name: &str, entity: NamedEntity) {
        self.by_name.insert(name.to_string(), entity);
    }

    pub fn iter(&self) -> impl Iterator<Item = (&String, &NamedEntity)> {
        self.by_name.iter()
    }

    /// Adds a ball that a cannon has shot. Returns its name.
    pub fn add_shot(&mut self, cannon: Entity, projectile: Entity) -> Option<String> {
        self.by_name.iter_mut().find_map(|(name, named)| match named {
            NamedEntity::Cannon { cannon: own, balls } if *own == cannon => {
                balls.push(projectile);
                Some(format!("{name}#{}", balls.len()))
            }
            _ => None,
        })
    }

    /// Adds a piece that came off a body. Returns its name.
    pub fn add_piece(&mut self, from: Entity, piece: Entity) -> Option<String> {
        self.by_name.iter_mut().find_map(|(name, named)| match named {
            NamedEntity::Body { body, pieces } if *body == from || pieces.contains(&from) => {
                pieces.push(piece);
                Some(format!("{name}#{}", pieces.len() + 1))
            }
            _ => None,
        })
    }

    /// Despawns the pieces of a body that is built anew.
    pub fn despawn_pieces(&mut self, world: &mut World, name: &str) {
        if let Some(NamedEntity::Body { pieces, .. }) = self.by_name.get_mut(name) {
            pieces.drain(..).for_each(|piece| despawn(world, piece));
        }
    }

    /// The entities that `name` or `name#number` stands for.
    pub fn entities(&self, name: &str) -> Vec<Entity> {
        match self.by_name.get(name) {
            Some(named) => named.entities(),
            None => self.numbered(name).into_iter().collect(),
        }
    }

    /// The ball or piece that `name#number` stands for.
    pub fn numbered(&self, name: &str) -> Option<Entity> {
        let (group, number) = name.split_once('#')?;
        let index = number.parse::<usize>().ok()?.checked_sub(1)?;
        self.by_name.get(group)?.part(index)
    }

    /// All simulated entities of `names`; of everything that moves by itself, if there are no names.
    pub fn simulated<'a>(
        &self,
        world: &World,
        names: impl IntoIterator<Item = &'a String>,
    ) -> SimulatedEntities {
        let mut simulated = SimulatedEntities::default();
        let mut names = names.into_iter().peekable();
        if names.peek().is_none() {
            for named in self.by_name.values() {
                simulated.add(world, named);
            }
            simulated.obstacles.retain(|&obstacle| world.get::<DynamicObstacle>(obstacle).is_some());
            return simulated;
        }
        for name in names {
            match self.by_name.get(name) {
                Some(named) => simulated.add(world, named),
                None => {
                    let numbered = self.numbered(name);
                    simulated.bodies.extend(numbered.filter(|&body| is_body(world, body)));
                    simulated.balls.extend(numbered.filter(|&ball| is_ball(world, ball)));
                }
            }
        }
        simulated
    }

    /// All bodies and balls, in the order of names.
    pub fn moving(&self, world: &World) -> Vec<(String, Entity)> {
        let mut moving = Vec::new();
        for (name, named) in &self.by_name {
            let mut simulated = SimulatedEntities::default();
            simulated.add(world, named);
            let is_whole = simulated.bodies.len() == 1;
            let bodies = simulated.bodies.into_iter().enumerate();
            moving.extend(bodies.map(|(index, body)| {
                let name = if is_whole { name.clone() } else { format!("{name}#{}", index + 1) };
                (name, body)
            }));
            if let NamedEntity::Balls(balls) | NamedEntity::Cannon { balls, .. } = named {
                let numbered = balls.iter().enumerate().filter(|&(_, &ball)| is_ball(world, ball));
                moving.extend(numbered.map(|(index, &ball)| (format!("{name}#{}", index + 1), ball)));
            }
        }
        moving
    }

    /// All obstacles.
    pub fn obstacles(&self) -> impl Iterator<Item = (&String, Entity)> {
        self.by_name.iter().filter_map(|(name, named)| match named {
            NamedEntity::Obstacle(obstacle) => Some((name, *obstacle)),
            _ => None,
        })
    }

    /// The name of an entity: of balls and pieces with their number.
    pub fn name_of(&self, world: &World, entity: Entity) -> Option<String> {
        // The body of a rig is an entity of the plugin's own.
        let particle = world.get::<Rig>(entity).and_then(|rig| rig.particles().first().copied());
        let entity = particle.unwrap_or(entity);
        self.by_name.iter().find_map(|(name, named)| named.name_of(entity, name))
    }

    /// Despawns all entities of `name`, and forgets them.
    pub fn despawn(&mut self, world: &mut World, name: &str) {
        if let Some(named) = self.by_name.remove(name) {
            named.despawn(world);
        }
    }

    /// Despawns everything.
    pub fn clear(&mut self, world: &mut World) {
        while let Some((_, named)) = self.by_name.pop_first() {
            named.despawn(world);
        }
    }
}
