//! Commands to bodies: pin, unpin, push. They wait until the body has been built.

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::prelude::*;
use bevy_drape::rig::Particle;
use serde::{Deserialize, Serialize};

use super::named_entity::NamedEntity;
use super::points;
use super::scene_entities::SceneEntities;
use crate::scene::{self, Body, SceneScript, Selection, Vector, whole};

/// A command to some particles of a body.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct BodyCommand {
    pub of: String,
    pub particles: Selection,
    pub kind: CommandKind,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) enum CommandKind {
    Pin,
    Unpin,
    /// An impulse in newton seconds.
    Push(Vector),
    /// A velocity in m/s.
    Velocity(Vector),
}

impl BodyCommand {
    /// Carries the command out. False if its body has not been built yet.
    pub fn carry_out(&self, world: &mut World, script: &SceneScript, entities: &SceneEntities) -> bool {
        match entities.get(&self.of) {
            // The body was despawned.
            None if !self.of.contains('#') => true,
            Some(NamedEntity::Body { .. } | NamedEntity::Rig { .. }) => {
                self.command_particles(world, script, entities).is_some()
            }
            None if self.is_for_a_piece(entities) => {
                self.command_particles(world, script, entities).is_some()
            }
            _ => self.push_solids(world, entities),
        }
    }

    /// True if it is for a piece of a body, even one that has not come off yet.
    fn is_for_a_piece(&self, entities: &SceneEntities) -> bool {
        let whole = self.of.split_once('#').and_then(|(whole, _)| entities.get(whole));
        matches!(whole, Some(NamedEntity::Body { .. }))
    }

    fn command_particles(
        &self,
        world: &mut World,
        script: &SceneScript,
        entities: &SceneEntities,
    ) -> Option<()> {
        let all = points::particles(world, entities, &self.of)?;
        let selected = self.selected(world, &all);
        match self.kind {
            CommandKind::Pin | CommandKind::Unpin => {
                let is_pin = matches!(self.kind, CommandKind::Pin);
                if let Some(NamedEntity::Rig { particles, .. }) = entities.get(&self.of) {
                    for &index in &selected {
                        if let Some(mut particle) = world.get_mut::<Particle>(particles[index]) {
                            particle.pinned = is_pin;
                        }
                    }
                    return Some(());
                }
                self.pin(world, script, &all, &selected, is_pin)
            }
            CommandKind::Velocity(velocity) => change_velocities(world, &all, &selected, |_| velocity.get()),
            CommandKind::Push(impulse) => {
                let mass_of = |&index: &usize| {
                    let (body, index) = all[index];
                    let inverse = world.get::<Particles>(body).map_or(0.0, |body| body.inverse_mass(index));
                    if inverse > 0.0 { 1.0 / f64::from(inverse) } else { 0.0 }
                };
                let mass: f64 = selected.iter().map(mass_of).sum();
                let change = if mass > 0.0 { (impulse.as_dvec3() / mass).as_vec3() } else { Vec3::ZERO };
                change_velocities(world, &all, &selected, |velocity| velocity + change)
            }
        }
    }

    /// The indices of the selected particles among `all` of the body.
    fn selected(&self, world: &World, all: &[(Entity, usize)]) -> Vec<usize> {
        let is_pinned = |&(body, index): &(Entity, usize)| {
            world.get::<Particles>(body).is_some_and(|body| body.is_pinned(index))
        };
        match &self.particles {
            Selection::All => (0..all.len()).collect(),
            Selection::Pinned => (0..all.len()).filter(|&i| is_pinned(&all[i])).collect(),
            Selection::Particles(indices) => {
                indices.iter().map(|&index| index as usize).filter(|&index| index < all.len()).collect()
            }
        }
    }

    /// Pins the selected particles, or gives them back the masses that they were built with.
    fn pin(
        &self,
        world: &mut World,
        script: &SceneScript,
        all: &[(Entity, usize)],
        selected: &[usize],
        is_pin: bool,
    ) -> Option<()> {
        let free = if is_pin { Vec::new() } else { free_inverse_masses(script, &self.of)? };
        let body = all.first().and_then(|&(body, _)| world.get::<Particles>(body))?;
        // A torn body has other particles than were built: those that are unpinned get the mass of one that is free.
        let usual = if is_pin || free.len() == body.len() {
            None
        } else {
            (0..body.len())
                .map(|i| body.inverse_mass(i))
                .find(|&inverse| inverse > 0.0)
                .or(free.first().copied())
        };
        for &index in selected {
            let (body, index) = all[index];
            let inverse_mass = usual.or(free.get(index).copied()).unwrap_or(0.0);
            world.get_mut::<Particles>(body)?.set_inverse_mass(index, inverse_mass);
        }
        Some(())
    }

    /// Pushes balls and dynamic obstacles. False if there are none yet.
    fn push_solids(&self, world: &mut World, entities: &SceneEntities) -> bool {
        let solids = entities.simulated(world, [&self.of]);
        let CommandKind::Push(impulse) = self.kind else { return true };
        let share = impulse.get() / solids.balls.len().max(1) as f32;
        for &ball in &solids.balls {
            if let Some(mut ball) = world.get_mut::<ProjectileState>(ball) {
                ball.apply_impulse(share);
            }
        }
        for &obstacle in &solids.obstacles {
            if let Some(mut dynamic) = world.get_mut::<DynamicObstacle>(obstacle) {
                let change = impulse.get() / dynamic.mass;
                dynamic.velocity += change;
            }
        }
        !solids.is_empty()
    }
}

/// Changes the velocities of the selected particles that are not pinned.
fn change_velocities(
    world: &mut World,
    all: &[(Entity, usize)],
    selected: &[usize],
    change: impl Fn(Vec3) -> Vec3,
) -> Option<()> {
    for &index in selected {
        let (body, index) = all[index];
        let mut body = world.get_mut::<Particles>(body)?;
        if !body.is_pinned(index) {
            let velocity = body.velocity(index);
            body.set_velocity(index, change(velocity));
        }
    }
    Some(())
}

/// The inverse masses of a body as it was built, but without pins.
fn free_inverse_masses(script: &SceneScript, name: &str) -> Option<Vec<f32>> {
    let files = &script.meshes;
    let built = match script.bodies.get(whole(name))? {
        Body::Cloth(cloth) => Cloth::from(cloth)
            .with_pins(ClothPins::None)
            .build(&Fabric::from(cloth), &GlobalTransform::IDENTITY),
        Body::Rope(rope) => {
            let rope = Rope { pin_start: false, pin_end: false, ..Rope::from(rope) };
            rope.build(&GlobalTransform::IDENTITY)
        }
        Body::SoftBall(ball) => {
            let ball = SoftBall { pin_rim: false, ..SoftBall::from(ball) };
            ball.build(&GlobalTransform::IDENTITY)
        }
        Body::ClothMesh(cloth) => {
            let cloth = scene::ClothMesh { pins: Vec::new(), painted_pins: None, ..cloth.clone() };
            let built = cloth.build(files).ok()?;
            Ok((built.particles, built.topology.into()))
        }
        Body::SoftBody(solid) => {
            let solid = scene::SoftBody { pins: Vec::new(), painted_pins: None, ..solid.clone() };
            let built = solid.build(files).ok()?;
            Ok((built.particles, built.topology.into()))
        }
        Body::Rig(_) | Body::Balls(_) => return None,
    };
    let (particles, _) = built.ok()?;
    Some((0..particles.len()).map(|index| particles.inverse_mass(index)).collect())
}
