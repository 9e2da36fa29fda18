//! Who is on the stage: names and their entities.

use std::collections::BTreeMap;

use bevy::ecs::message::MessageRegistry;
use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::ScenePlay;
use super::orders::{Order, OrderKind};
use crate::scene::{self, Body, Motion, Selection, Solver};

/// What a name stands for.
#[derive(Clone, Debug)]
pub(super) enum Actor {
    /// What the plugin builds of a description, such as a cloth or rope: what it is now, and the pieces that came off it.
    Body {
        body: Entity,
        pieces: Vec<Entity>,
    },
    /// A rig's particles, in the order of their names, and its sticks.
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

/// What there is of a name: bodies with particles, balls, obstacles.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub bodies: Vec<Entity>,
    pub balls: Vec<Entity>,
    pub obstacles: Vec<Entity>,
}

impl Parts {
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty() && self.balls.is_empty() && self.obstacles.is_empty()
    }
}

/// Names and what they stand for.
#[derive(Debug, Default)]
pub(super) struct Stage {
    actors: BTreeMap<String, Actor>,
}

impl Stage {
    pub fn get(&self, name: &str) -> Option<&Actor> {
        self.actors.get(name)
    }

    pub fn contains(&self, name: &str) -> bool {
        self.actors.contains_key(name)
    }

    fn enter(&mut self, name: &str, actor: Actor) {
        self.actors.insert(name.to_string(), actor);
    }

    /// All who are on the stage, by name.
    pub fn actors(&self) -> impl Iterator<Item = (&String, &Actor)> {
        self.actors.iter()
    }

    /// Replaces who is on the stage, without a word to the world.
    pub fn cast(&mut self, actors: BTreeMap<String, Actor>) {
        self.actors = actors;
    }

    /// Notes the ball that a cannon has shot.
    pub fn note_shot(&mut self, cannon: Entity, projectile: Entity) -> Option<String> {
        self.actors.iter_mut().find_map(|(name, actor)| match actor {
            Actor::Cannon { cannon: own, balls } if *own == cannon => {
                balls.push(projectile);
                Some(format!("{name}#{}", balls.len()))
            }
            _ => None,
        })
    }

    /// Notes a piece that came off a body; its name.
    pub fn note_piece(&mut self, from: Entity, piece: Entity) -> Option<String> {
        self.actors.iter_mut().find_map(|(name, actor)| match actor {
            Actor::Body { body, pieces } if *body == from || pieces.contains(&from) => {
                pieces.push(piece);
                Some(format!("{name}#{}", pieces.len() + 1))
            }
            _ => None,
        })
    }

    /// Takes the pieces of a body off the stage, as it is built anew.
    pub fn drop_pieces(&mut self, world: &mut World, name: &str) {
        if let Some(Actor::Body { pieces, .. }) = self.actors.get_mut(name) {
            pieces.drain(..).for_each(|piece| despawn(world, piece));
        }
    }

    /// All entities of a name.
    pub fn entities(&self, name: &str) -> Vec<Entity> {
        match self.actors.get(name) {
            Some(Actor::Body { body, pieces }) => [&[*body], &pieces[..]].concat(),
            Some(Actor::Obstacle(entity) | Actor::Wind(entity)) => vec![*entity],
            Some(Actor::Rig { particles, .. }) => particles.clone(),
            Some(Actor::Balls(balls)) => balls.clone(),
            Some(Actor::Cannon { cannon, .. }) => vec![*cannon],
            None => self.numbered(name).into_iter().collect(),
        }
    }

    /// The ball or piece that `name#number` stands for.
    pub fn numbered(&self, name: &str) -> Option<Entity> {
        let (group, number) = name.split_once('#')?;
        let index = number.parse::<usize>().ok()?.checked_sub(1)?;
        match self.actors.get(group)? {
            Actor::Balls(balls) | Actor::Cannon { balls, .. } => balls.get(index).copied(),
            Actor::Body { body, .. } if index == 0 => Some(*body),
            Actor::Body { pieces, .. } => pieces.get(index - 1).copied(),
            _ => None,
        }
    }

    /// What there is of `names`; of everything that moves by itself, if none is given.
    pub fn parts<'a>(&self, world: &World, names: impl IntoIterator<Item = &'a String>) -> Parts {
        let mut parts = Parts::default();
        let mut names = names.into_iter().peekable();
        if names.peek().is_none() {
            for actor in self.actors.values() {
                add(&mut parts, world, actor);
            }
            parts.obstacles.retain(|&obstacle| world.get::<DynamicObstacle>(obstacle).is_some());
            return parts;
        }
        for name in names {
            match self.actors.get(name) {
                Some(actor) => add(&mut parts, world, actor),
                None => {
                    let numbered = self.numbered(name);
                    parts.bodies.extend(numbered.filter(|&body| is_body(world, body)));
                    parts.balls.extend(numbered.filter(|&ball| is_ball(world, ball)));
                }
            }
        }
        parts
    }

    /// All bodies and balls, in the order of names.
    pub fn moving(&self, world: &World) -> Vec<(String, Entity)> {
        let mut moving = Vec::new();
        for (name, actor) in &self.actors {
            let mut parts = Parts::default();
            add(&mut parts, world, actor);
            let is_whole = parts.bodies.len() == 1;
            let bodies = parts.bodies.into_iter().enumerate();
            moving.extend(bodies.map(|(index, body)| {
                let name = if is_whole { name.clone() } else { format!("{name}#{}", index + 1) };
                (name, body)
            }));
            if let Actor::Balls(balls) | Actor::Cannon { balls, .. } = actor {
                let numbered = balls.iter().enumerate().filter(|&(_, &ball)| is_ball(world, ball));
                moving.extend(numbered.map(|(index, &ball)| (format!("{name}#{}", index + 1), ball)));
            }
        }
        moving
    }

    /// All obstacles that are there.
    pub fn obstacles(&self) -> impl Iterator<Item = (&String, Entity)> {
        self.actors.iter().filter_map(|(name, actor)| match actor {
            Actor::Obstacle(obstacle) => Some((name, *obstacle)),
            _ => None,
        })
    }

    /// The name of an entity: of a ball with its number.
    pub fn name_of(&self, world: &World, entity: Entity) -> Option<String> {
        // The body of a rig is an entity of the plugin's own.
        let particle = world.get::<Rig>(entity).and_then(|rig| rig.particles().first().copied());
        let entity = particle.unwrap_or(entity);
        let numbered = |name: &String, balls: &[Entity]| {
            balls.iter().position(|&ball| ball == entity).map(|index| format!("{name}#{}", index + 1))
        };
        self.actors.iter().find_map(|(name, actor)| match actor {
            Actor::Body { body, pieces } if *body == entity && pieces.is_empty() => Some(name.clone()),
            Actor::Body { body, .. } if *body == entity => Some(format!("{name}#1")),
            Actor::Body { pieces, .. } => {
                pieces.iter().position(|&piece| piece == entity).map(|index| format!("{name}#{}", index + 2))
            }
            Actor::Obstacle(own) | Actor::Wind(own) => (*own == entity).then(|| name.clone()),
            Actor::Rig { particles, .. } => particles.contains(&entity).then(|| name.clone()),
            Actor::Balls(balls) | Actor::Cannon { balls, .. } => numbered(name, balls),
        })
    }

    /// Takes what is called `name` off the stage.
    pub fn exit(&mut self, world: &mut World, name: &str) {
        if let Some(actor) = self.actors.remove(name) {
            let entities = match actor {
                Actor::Body { body, mut pieces } => {
                    pieces.push(body);
                    pieces
                }
                Actor::Obstacle(entity) | Actor::Wind(entity) => vec![entity],
                Actor::Rig { particles, sticks } => sticks.into_iter().chain(particles).collect(),
                Actor::Balls(balls) => balls,
                Actor::Cannon { cannon, mut balls } => {
                    balls.push(cannon);
                    balls
                }
            };
            entities.into_iter().for_each(|entity| despawn(world, entity));
        }
    }

    pub fn clear(&mut self, world: &mut World) {
        for name in self.actors.keys().cloned().collect::<Vec<_>>() {
            self.exit(world, &name);
        }
    }
}

/// Lost balls may be gone already.
fn despawn(world: &mut World, entity: Entity) {
    if let Ok(entity) = world.get_entity_mut(entity) {
        entity.despawn();
    }
}

fn is_body(world: &World, entity: Entity) -> bool {
    world.get::<Particles>(entity).is_some()
}

fn is_ball(world: &World, entity: Entity) -> bool {
    world.get::<ProjectileState>(entity).is_some()
}

fn add(parts: &mut Parts, world: &World, actor: &Actor) {
    match actor {
        Actor::Body { body, pieces } => {
            let all = core::iter::once(body).chain(pieces).copied();
            parts.bodies.extend(all.filter(|&body| is_body(world, body)));
        }
        Actor::Rig { particles, .. } => {
            for body in particles.iter().filter_map(|&particle| world.get::<InRig>(particle)) {
                if !parts.bodies.contains(&body.body) {
                    parts.bodies.push(body.body);
                }
            }
        }
        Actor::Balls(balls) | Actor::Cannon { balls, .. } => {
            parts.balls.extend(balls.iter().copied().filter(|&ball| is_ball(world, ball)));
        }
        Actor::Obstacle(obstacle) => parts.obstacles.push(*obstacle),
        Actor::Wind(_) => {}
    }
}

impl ScenePlay {
    /// The settings of a body, over those of the scene.
    pub(super) fn solver_settings(&self, solver: &Solver) -> SolverSettings {
        solver.over(self.script.settings.solver.over(SolverSettings::default()))
    }

    pub(super) fn spawn_body(&mut self, world: &mut World, name: &str, body: &Body) {
        let actor = match body {
            Body::Cloth(cloth) => self.spawn_described(world, name, body, Cloth::from(cloth)),
            Body::Rope(rope) => self.spawn_described(world, name, body, Rope::from(rope)),
            Body::SoftBall(ball) => self.spawn_described(world, name, body, SoftBall::from(ball)),
            Body::ClothMesh(cloth) => match self.mesh_of(world, name, &cloth.mesh) {
                Some(mesh) => self.spawn_described(world, name, body, (mesh, ClothMesh::from(cloth))),
                None => return,
            },
            Body::SoftBody(solid) => match self.mesh_of(world, name, &solid.mesh) {
                Some(mesh) => self.spawn_described(world, name, body, (mesh, SoftBody::from(solid))),
                None => return,
            },
            Body::Rig(rig) => self.spawn_rig(world, name, rig),
            Body::Balls(balls) => {
                let projectile = Projectile::from(balls);
                let mut entities = Vec::new();
                for (index, offset) in balls.copies.offsets(self.script.settings.seed).enumerate() {
                    let place = Transform::from_translation(balls.at.get() + offset);
                    let entity = world.spawn((projectile, place)).id();
                    mark(
                        world,
                        entity,
                        &format!("{name}#{}", index + 1),
                        balls.layers.as_ref(),
                        balls.contacts,
                    );
                    entities.push(entity);
                }
                Actor::Balls(entities)
            }
        };
        self.stage.enter(name, actor);
    }

    /// Spawns what the plugin builds of a description.
    fn spawn_described(
        &mut self,
        world: &mut World,
        name: &str,
        body: &Body,
        described: impl Bundle,
    ) -> Actor {
        let settings = body.solver().map(|solver| self.solver_settings(solver)).unwrap_or_default();
        let place = body.place().map(|(at, turn)| place(at, turn)).unwrap_or_default();
        let entity = world.spawn((described, place, settings)).id();
        mark(world, entity, name, body.layers(), body.tells_contacts());
        set_tearable(world, entity, body);
        set_pressure(world, entity, body);
        self.order_velocity(name, body.velocity());
        Actor::Body { body: entity, pieces: Vec::new() }
    }

    /// A mesh as an asset. An app without any has them from now on.
    fn mesh_of(&mut self, world: &mut World, name: &str, source: &scene::MeshSource) -> Option<Mesh3d> {
        match source.mesh(&self.script.meshes) {
            Ok(mesh) => {
                if !world.contains_resource::<Assets<Mesh>>() {
                    MessageRegistry::register_message::<AssetEvent<Mesh>>(world);
                    world.init_resource::<Assets<Mesh>>();
                }
                Some(Mesh3d(world.resource_mut::<Assets<Mesh>>().add(mesh)))
            }
            Err(problem) => {
                self.problems.push(format!("{name}: {problem}"));
                None
            }
        }
    }

    fn spawn_rig(&self, world: &mut World, name: &str, rig: &scene::Rig) -> Actor {
        let settings = self.solver_settings(&rig.solver);
        let mut by_name = BTreeMap::new();
        for (particle_name, particle) in rig.particles.iter() {
            let place = Transform::from_translation(rig.at.get() + particle.at.get());
            let entity = world.spawn((Particle::from(particle), place, settings)).id();
            mark(world, entity, &format!("{name}.{particle_name}"), rig.layers.as_ref(), false);
            by_name.insert(particle_name.as_str(), entity);
        }
        let mut sticks = Vec::new();
        for stick in &rig.sticks {
            // The check of the scene has found both ends.
            let (Some(&a), Some(&b)) = (by_name.get(stick.a.as_str()), by_name.get(stick.b.as_str())) else {
                continue;
            };
            let stick = Stick {
                a,
                b,
                rest_length: stick.rest_length.map(scene::Positive::get),
                stiffness: stick.stiffness.get(),
                damping: stick.damping.get(),
                kind: stick.kind.into(),
                bound: stick.bound.into(),
            };
            sticks.push(world.spawn(stick).id());
        }
        Actor::Rig { particles: by_name.into_values().collect(), sticks }
    }

    fn order_velocity(&mut self, name: &str, velocity: scene::Vector) {
        if *velocity != Vec3::ZERO {
            self.orders.push(Order {
                of: name.to_string(),
                particles: Selection::All,
                kind: OrderKind::Velocity(velocity),
            });
        }
    }

    pub(super) fn spawn_obstacle(&mut self, world: &mut World, name: &str, obstacle: &scene::Obstacle) {
        let Some(component) = self.obstacle_component(name, obstacle) else { return };
        let (translation, rotation) =
            obstacle.place_at(0.0).unwrap_or((obstacle.at.get(), obstacle.turn.quaternion()));
        let place = Transform { translation, rotation, scale: Vec3::ONE };
        let entity = world.spawn((component, place)).id();
        set_dynamic(world, entity, obstacle);
        mark(world, entity, name, obstacle.layers.as_ref(), obstacle.contacts);
        self.stage.enter(name, Actor::Obstacle(entity));
    }

    pub(super) fn obstacle_component(&mut self, name: &str, obstacle: &scene::Obstacle) -> Option<Obstacle> {
        match obstacle.shape.build() {
            Ok(shape) => {
                let solid = Obstacle::new(shape)
                    .with_friction(obstacle.friction.get())
                    .with_static_friction(obstacle.static_friction.get())
                    .with_restitution(obstacle.restitution.get());
                Some(if obstacle.sensor { solid.as_sensor() } else { solid })
            }
            Err(error) => {
                self.problems.push(format!("{name}: {error}"));
                None
            }
        }
    }

    pub(super) fn spawn_wind(&mut self, world: &mut World, name: &str, zone: &scene::WindZone) {
        let entity = world.spawn((WindZone::from(zone), zone.place(), Name::new(name.to_string()))).id();
        self.stage.enter(name, Actor::Wind(entity));
    }

    pub(super) fn spawn_cannon(&mut self, world: &mut World, name: &str, cannon: &scene::Cannon) {
        let place =
            Transform { translation: cannon.at.get(), rotation: cannon.turn.quaternion(), scale: Vec3::ONE };
        let component = cannon.component(self.script.settings.gravity);
        let entity = world.spawn((component, place, Name::new(name.to_string()))).id();
        self.stage.enter(name, Actor::Cannon { cannon: entity, balls: Vec::new() });
    }
}

/// Where something of the scene is.
pub(super) fn place(at: scene::Vector, turn: &scene::Turn) -> Transform {
    Transform { translation: at.get(), rotation: turn.quaternion(), scale: Vec3::ONE }
}

/// Has an obstacle fly by itself as the scene says, or no more.
pub(super) fn set_dynamic(world: &mut World, entity: Entity, obstacle: &scene::Obstacle) {
    let mut entity = world.entity_mut(entity);
    match &obstacle.motion {
        Motion::Dynamic(dynamic) => {
            if let Some(dynamic) = dynamic.component(&obstacle.shape) {
                entity.insert(dynamic);
            }
        }
        Motion::Static | Motion::Steady(_) | Motion::Keyframes(_) => {
            entity.remove::<DynamicObstacle>();
        }
    }
}

/// Lets a body tear as the scene says, or no more.
pub(super) fn set_tearable(world: &mut World, entity: Entity, body: &Body) {
    let mut entity = world.entity_mut(entity);
    match body.tearable().map(Tearable::from) {
        Some(tearable) if entity.get() != Some(&tearable) => {
            entity.insert(tearable);
        }
        None if entity.contains::<Tearable>() => {
            entity.remove::<Tearable>();
        }
        _ => {}
    }
}

/// Keeps the volume of a closed body as the scene says, or no more.
pub(super) fn set_pressure(world: &mut World, entity: Entity, body: &Body) {
    let pressure = match body {
        Body::ClothMesh(cloth) => cloth.pressure,
        Body::SoftBody(solid) => Some(solid.pressure),
        _ => return,
    };
    let pressure = pressure.map(|pressure| Pressure(pressure.get()));
    let mut entity = world.entity_mut(entity);
    match pressure {
        Some(pressure) if entity.get() != Some(&pressure) => {
            entity.insert(pressure);
        }
        None if entity.contains::<Pressure>() => {
            entity.remove::<Pressure>();
        }
        _ => {}
    }
}

/// Gives an entity its name, its layers, and the mark of those whose contacts are told.
pub(super) fn mark(
    world: &mut World,
    entity: Entity,
    name: &str,
    layers: Option<&scene::Layers>,
    contacts: bool,
) {
    world.entity_mut(entity).insert(Name::new(name.to_string()));
    set_touch(world, entity, layers, contacts);
}

/// Gives an entity its layers and the mark of those whose contacts are told, or takes them away.
pub(super) fn set_touch(world: &mut World, entity: Entity, layers: Option<&scene::Layers>, contacts: bool) {
    let mut entity = world.entity_mut(entity);
    match layers.map(DrapeLayers::from) {
        Some(layers) => entity.insert(layers),
        None => entity.remove::<DrapeLayers>(),
    };
    if contacts {
        entity.insert(ContactEvents);
    } else {
        entity.remove::<ContactEvents>();
    }
}
