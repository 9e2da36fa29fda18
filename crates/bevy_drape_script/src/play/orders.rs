//! Orders to particles: pin, let go, push. They are carried out as soon as the body has been built.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::ScenePlay;
use super::points;
use super::stage::Actor;
use crate::scene::{self, Body, Selection, Vector, whole};
use serde::{Deserialize, Serialize};

/// Something that a body is to do.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Order {
    pub of: String,
    pub particles: Selection,
    pub kind: OrderKind,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) enum OrderKind {
    Pin,
    Unpin,
    /// An impulse in newton seconds.
    Push(Vector),
    /// A velocity in m/s.
    Velocity(Vector),
}

/// Carries out what was to be done to bodies that have now been built.
pub(super) fn on_built_bodies(world: &mut World) {
    world.try_resource_scope(|world, mut play: Mut<ScenePlay>| {
        if !play.orders.is_empty() {
            play.carry_out_orders(world);
        }
    });
}

impl ScenePlay {
    /// Carries out the orders that can be; the others wait for their bodies to be built.
    pub(super) fn carry_out_orders(&mut self, world: &mut World) {
        let orders = core::mem::take(&mut self.orders);
        for order in orders {
            if !self.carry_out(world, &order) {
                self.orders.push(order);
            }
        }
    }

    fn carry_out(&self, world: &mut World, order: &Order) -> bool {
        match self.stage.get(&order.of) {
            // It is gone.
            None if !order.of.contains('#') => true,
            Some(Actor::Body { .. } | Actor::Rig { .. }) => self.order_particles(world, order).is_some(),
            None if self.names_piece(&order.of) => self.order_particles(world, order).is_some(),
            _ => self.order_solids(world, order),
        }
    }

    /// Whether it is the piece of a body, be it there yet or not.
    fn names_piece(&self, name: &str) -> bool {
        name.split_once('#')
            .is_some_and(|(whole, _)| matches!(self.stage.get(whole), Some(Actor::Body { .. })))
    }

    fn order_particles(&self, world: &mut World, order: &Order) -> Option<()> {
        let all = points::particles(world, &self.stage, &order.of)?;
        let is_pinned = |&(body, index): &(Entity, usize)| {
            world.get::<Particles>(body).is_some_and(|body| body.is_pinned(index))
        };
        let indices: Vec<usize> = match &order.particles {
            Selection::All => (0..all.len()).collect(),
            Selection::Pinned => (0..all.len()).filter(|&i| is_pinned(&all[i])).collect(),
            Selection::Particles(indices) => {
                indices.iter().map(|&index| index as usize).filter(|&index| index < all.len()).collect()
            }
        };
        match order.kind {
            OrderKind::Pin | OrderKind::Unpin => {
                let is_pin = matches!(order.kind, OrderKind::Pin);
                if let Some(Actor::Rig { particles, .. }) = self.stage.get(&order.of) {
                    for &index in &indices {
                        if let Some(mut particle) = world.get_mut::<Particle>(particles[index]) {
                            particle.pinned = is_pin;
                        }
                    }
                } else {
                    let free = if is_pin { Vec::new() } else { self.free_inverse_masses(&order.of)? };
                    let body = all.first().and_then(|&(body, _)| world.get::<Particles>(body))?;
                    // What has torn has other particles than were built: those that are let go weigh what others do.
                    let usual = if is_pin || free.len() == body.len() {
                        None
                    } else {
                        (0..body.len())
                            .map(|i| body.inverse_mass(i))
                            .find(|&inverse| inverse > 0.0)
                            .or(free.first().copied())
                    };
                    for &index in &indices {
                        let (body, index) = all[index];
                        let inverse_mass = usual.or(free.get(index).copied()).unwrap_or(0.0);
                        world.get_mut::<Particles>(body)?.set_inverse_mass(index, inverse_mass);
                    }
                }
            }
            OrderKind::Velocity(velocity) => {
                for &index in &indices {
                    let (body, index) = all[index];
                    let mut body = world.get_mut::<Particles>(body)?;
                    if !body.is_pinned(index) {
                        body.set_velocity(index, velocity.get());
                    }
                }
            }
            OrderKind::Push(impulse) => {
                let mass_of = |&index: &usize| {
                    let (body, index) = all[index];
                    let inverse = world.get::<Particles>(body).map_or(0.0, |body| body.inverse_mass(index));
                    if inverse > 0.0 { 1.0 / f64::from(inverse) } else { 0.0 }
                };
                let mass: f64 = indices.iter().map(mass_of).sum();
                let change = if mass > 0.0 { (impulse.as_dvec3() / mass).as_vec3() } else { Vec3::ZERO };
                for &index in &indices {
                    let (body, index) = all[index];
                    let mut body = world.get_mut::<Particles>(body)?;
                    if !body.is_pinned(index) {
                        let velocity = body.velocity(index);
                        body.set_velocity(index, velocity + change);
                    }
                }
            }
        }
        Some(())
    }

    /// The inverse masses of a body as it was built, none of whose particles are pinned.
    fn free_inverse_masses(&self, name: &str) -> Option<Vec<f32>> {
        let files = &self.script.meshes;
        let built = match self.script.bodies.get(whole(name))? {
            Body::Cloth(cloth) => {
                Cloth::from(cloth).with_pins(ClothPins::None).build(&GlobalTransform::IDENTITY)
            }
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

    /// Pushes balls and dynamic obstacles.
    fn order_solids(&self, world: &mut World, order: &Order) -> bool {
        let parts = self.stage.parts(world, [&order.of]);
        let OrderKind::Push(impulse) = order.kind else { return true };
        let share = impulse.get() / parts.balls.len().max(1) as f32;
        for &ball in &parts.balls {
            if let Some(mut ball) = world.get_mut::<ProjectileState>(ball) {
                ball.apply_impulse(share);
            }
        }
        for &obstacle in &parts.obstacles {
            if let Some(mut dynamic) = world.get_mut::<DynamicObstacle>(obstacle) {
                let change = impulse.get() / dynamic.mass;
                dynamic.velocity += change;
            }
        }
        !parts.is_empty()
    }
}
