//! Movers: obstacles with a [`RigidBody`], on their way through a step.
//!
//! Design: `docs/design/dynamic_obstacles.md`.

use glam::{DVec3, Vec3};

use crate::contact::obstacle_push::ObstaclePush;
use crate::geometry::pose::{Placement, Pose, turned};
use crate::state::friction::Friction;
use crate::state::obstacle::Obstacle;
use crate::state::rigid_body::{Drive, RigidBody};

/// An obstacle with a rigid body, on its way through a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mover {
    pub obstacle: usize,
    /// Placement at the start of the substep.
    from: Placement,
    /// Placement and motion at the end of the substep, without contacts.
    free: (Placement, RigidBody),
    /// Placement at the end of the substep, with the contacts so far.
    pub to: Placement,
    pub end: RigidBody,
    drive: Drive,
    /// Impulse on it in this substep, in newton seconds.
    impulse: DVec3,
    /// Angular impulse about its centre, in newton metre seconds.
    angular_impulse: DVec3,
}

impl Mover {
    pub fn new(obstacle: usize, of: &Obstacle, body: RigidBody, drive: Drive) -> Self {
        let from = of.start();
        Self {
            obstacle,
            from,
            free: (from, body),
            to: from,
            end: body,
            drive,
            impulse: DVec3::ZERO,
            angular_impulse: DVec3::ZERO,
        }
    }

    /// Its poses at the start and the end of the substep, relative to `origin`.
    pub fn poses(&self, origin: Vec3) -> [Pose; 2] {
        [self.from, self.to].map(|placement| Pose::at(&placement, origin))
    }

    /// Its centre at the end of the substep.
    pub fn centre(&self) -> DVec3 {
        self.to.translation.as_dvec3()
    }

    /// Where a point of its frame is in the world at the end of the substep.
    pub fn point(&self, local: Vec3) -> DVec3 {
        self.centre() + (self.to.rotation * local).as_dvec3()
    }

    /// Inverse mass of the point in the world against a push along a unit vector, in 1/kg.
    pub fn inverse_mass_at(&self, point: Vec3, direction: Vec3) -> f32 {
        self.end.inverse_mass_at(self.to, point - self.to.translation, direction)
    }

    /// The greatest inverse mass of the point in the world against a push in any direction, in 1/kg.
    pub fn greatest_inverse_mass_at(&self, point: Vec3) -> f32 {
        self.end.greatest_inverse_mass_at(self.to, point - self.to.translation)
    }

    /// Friction between the mover and a point of inverse mass `inverse_mass` (1/kg) in the world, which has slipped by
    /// `slip` and sunk in by `depth`, its own share (metres). Returns the slip that friction takes from the point in
    /// metres, and the push on the point in kg m.
    pub fn slip_taken(
        &self,
        friction: Friction,
        inverse_mass: f32,
        slip: Vec3,
        normal: Vec3,
        depth: f32,
        point: Vec3,
    ) -> (Vec3, Vec3) {
        let push = self.friction_push(friction, [inverse_mass; 2], slip, normal, depth, point);
        (push * inverse_mass, -push)
    }

    /// The push of friction on the mover in kg m, if the point of inverse mass `inverse_mass` (1/kg) gives way as if its own were
    /// `yields`: 0 if something holds it fast.
    pub fn friction_push(
        &self,
        friction: Friction,
        [inverse_mass, yields]: [f32; 2],
        slip: Vec3,
        normal: Vec3,
        depth: f32,
        point: Vec3,
    ) -> Vec3 {
        let along = (slip - normal * slip.dot(normal)).normalize_or_zero();
        // Both give way, so the same push takes a longer slip than from the point alone.
        let both = yields + self.inverse_mass_at(point, along);
        if both == 0.0 {
            return Vec3::ZERO;
        }
        friction.scaled(both / inverse_mass).slip_taken(slip, normal, depth) / both
    }

    /// Receives the opposite of a push that it has given in this substep of so many seconds.
    pub fn receive(&mut self, given: ObstaclePush, substep: f32) {
        let [push, moment] = [given.push, given.moment].map(|sum| sum.as_dvec3() / f64::from(substep));
        let angular = (given.point - self.from.translation.as_dvec3()).cross(push) + moment;
        // A body that is no longer finite is removed, and its momentum with it.
        if !(push.is_finite() && angular.is_finite()) {
            return;
        }
        self.impulse -= push;
        self.angular_impulse -= angular;
        let (linear, angular) = (self.impulse.as_vec3(), self.angular_impulse.as_vec3());
        let (free, body) = self.free;
        let mut pushed = body;
        pushed.push(linear, angular, free);
        self.to.translation = free.translation + (pushed.velocity - body.velocity) * substep;
        let turn = (pushed.angular_velocity - body.angular_velocity) * substep;
        // A turn by nothing rounds: a body at rest would leave the place where its engine has put it.
        if turn != Vec3::ZERO || matches!(self.drive, Drive::Gravity(_)) {
            self.to.rotation = turned(free.rotation, turn);
        }
        self.end = body;
        self.end.turn_to(free, self.to);
        self.end.push(linear, angular, self.to);
    }

    pub fn begin_substep(&mut self, substep: f32) {
        self.from = self.to;
        (self.impulse, self.angular_impulse) = (DVec3::ZERO, DVec3::ZERO);
        self.to = self.end.advance_under(self.drive, self.from, substep);
        self.free = (self.to, self.end);
    }
}

/// The mover that this obstacle is, if it is one.
pub(crate) fn mover(movers: &[Mover], obstacle: usize) -> Option<&Mover> {
    movers.binary_search_by_key(&obstacle, |mover| mover.obstacle).ok().map(|place| &movers[place])
}

/// The same, to be pushed.
pub(crate) fn mover_mut(movers: &mut [Mover], obstacle: usize) -> Option<&mut Mover> {
    let place = movers.binary_search_by_key(&obstacle, |mover| mover.obstacle).ok()?;
    movers.get_mut(place)
}
