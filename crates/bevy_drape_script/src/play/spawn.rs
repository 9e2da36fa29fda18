//! Spawns the bodies, obstacles, winds and cannons of a scene.

use std::collections::BTreeMap;

use bevy::ecs::message::MessageRegistry;
use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::rig::{Particle, Stick};

use super::command::{BodyCommand, CommandKind};
use super::components::{mark, place, set_dynamic, set_pressure, set_tearable};
use super::named_entity::NamedEntity;
use super::scene_play::ScenePlay;
use crate::scene::{self, Body, Selection, Solver, Surface};

impl ScenePlay {
    /// The solver settings of a body, with those of the scene as defaults.
    pub(super) fn solver_settings(&self, solver: &Solver) -> SolverSettings {
        solver.over(self.script.settings.solver.over(SolverSettings::default()))
    }

    /// The surface of a body, with that of the scene as default.
    pub(super) fn body_surface(&self, surface: &Surface) -> BodySurface {
        surface.over(self.script.settings.surface.over(BodySurface::default()))
    }

    pub(super) fn spawn_body(&mut self, world: &mut World, name: &str, body: &Body) {
        let entity = match body {
            Body::Cloth(cloth) => {
                self.spawn_described(world, name, body, (Cloth::from(cloth), Fabric::from(cloth)))
            }
            Body::Rope(rope) => self.spawn_described(world, name, body, Rope::from(rope)),
            Body::SoftBall(ball) => self.spawn_described(world, name, body, SoftBall::from(ball)),
            Body::ClothMesh(cloth) => match self.mesh_of(world, name, &cloth.mesh) {
                Some(mesh) => {
                    let described = (mesh, ClothMesh::from(cloth), Fabric::from(cloth));
                    self.spawn_described(world, name, body, described)
                }
                None => return,
            },
            Body::SoftBody(solid) => match self.mesh_of(world, name, &solid.mesh) {
                Some(mesh) => self.spawn_described(world, name, body, (mesh, SoftBodyMesh::from(solid))),
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
                NamedEntity::Balls(entities)
            }
        };
        self.entities.insert(name, entity);
    }

    /// Spawns a body that the plugin builds of a description.
    fn spawn_described(
        &mut self,
        world: &mut World,
        name: &str,
        body: &Body,
        described: impl Bundle,
    ) -> NamedEntity {
        let settings = body.solver().map(|solver| self.solver_settings(solver)).unwrap_or_default();
        let surface = body.surface().map(|surface| self.body_surface(surface)).unwrap_or_default();
        let place = body.place().map(|(at, turn)| place(at, turn)).unwrap_or_default();
        let entity = world.spawn((described, place, settings, surface)).id();
        mark(world, entity, name, body.layers(), body.reports_contacts());
        set_tearable(world, entity, body);
        set_pressure(world, entity, body);
        self.command_velocity(name, body.velocity());
        NamedEntity::Body { body: entity, pieces: Vec::new() }
    }

    /// Adds a mesh as an asset. Apps without mesh assets get them now.
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

    fn spawn_rig(&self, world: &mut World, name: &str, rig: &scene::Rig) -> NamedEntity {
        let (settings, surface) = (self.solver_settings(&rig.solver), self.body_surface(&rig.surface));
        let mut by_name = BTreeMap::new();
        for (particle_name, particle) in rig.particles.iter() {
            let place = Transform::from_translation(rig.at.get() + particle.at.get());
            let entity = world.spawn((Particle::from(particle), place, settings, surface)).id();
            mark(world, entity, &format!("{name}.{particle_name}"), rig.layers.as_ref(), false);
            by_name.insert(particle_name.as_str(), entity);
        }
        let mut sticks = Vec::new();
        for stick in &rig.sticks {
            // The checks of the scene have found both ends.
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
        NamedEntity::Rig { particles: by_name.into_values().collect(), sticks }
    }

    fn command_velocity(&mut self, name: &str, velocity: scene::Vector) {
        if *velocity != Vec3::ZERO {
            self.commands.push(BodyCommand {
                of: name.to_string(),
                particles: Selection::All,
                kind: CommandKind::Velocity(velocity),
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
        self.entities.insert(name, NamedEntity::Obstacle(entity));
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
        self.entities.insert(name, NamedEntity::Wind(entity));
    }

    pub(super) fn spawn_cannon(&mut self, world: &mut World, name: &str, cannon: &scene::Cannon) {
        let place =
            Transform { translation: cannon.at.get(), rotation: cannon.turn.quaternion(), scale: Vec3::ONE };
        let component = cannon.component(self.script.settings.gravity);
        let entity = world.spawn((component, place, Name::new(name.to_string()))).id();
        self.entities.insert(name, NamedEntity::Cannon { cannon: entity, balls: Vec::new() });
    }
}
