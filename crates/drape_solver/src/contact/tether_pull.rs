//! Tethers of cloth that a mover presses: they pull at the mover.
//!
//! ```text
//!  pin o--.__            __.--o pin     A tether moves the light particle p into the mover, and contact moves p out again: the
//!            `--.____.--'               mover would feel the mass of p alone, and a light net could not stop a heavy crate.
//!            |   p    |                 So the mover gives way to the pull, by its own mass, and p goes with it.
//!            | mover  |
//! ```
//!
//! A tether stops a mover and does not throw it back: it takes at most the way that the mover has come in this substep, and what is left of
//! the stretch goes away slowly. Friction holds the mover to the pin along the part of the tether that runs along its surface.
//!
//! Design: `docs/design/dynamic_obstacles.md`.

use glam::{DVec3, Vec3};

use crate::constants::{TETHER_PULL_ROUNDS, TETHER_RECOVERY};
use crate::contact::body_contacts::BodyContacts;
use crate::contact::mover::{Mover, mover, mover_mut};
use crate::contact::obstacle_push::ObstaclePush;
use crate::geometry::nearest_triangle::weighted;
use crate::geometry::pose::Pose;
use crate::simd::columns::LANES;
use crate::state::body::Body;
use crate::state::substep::Substep;

/// A point of the body that a mover has pressed in this substep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PressedPoint {
    contact: PressingContact,
    obstacle: usize,
    carriers: [usize; 3],
    weights: [f32; 3],
    /// Unit normal of the mover's surface, in the world.
    normal: Vec3,
    /// Coefficient of static friction.
    friction: f32,
    /// Its place before the tethers, relative to the body's origin.
    place: Vec3,
    /// The same in the mover's coordinates.
    local: Vec3,
    /// The start of its displacement in this substep, in the world.
    begun: DVec3,
    /// Metres by which tethers have moved it into the mover.
    depth: f32,
    normal_pull: Pull,
    tangential_pull: Pull,
}

/// The place of a contact in its list.
#[derive(Clone, Copy, Debug)]
enum PressingContact {
    Particle { candidate: usize, lane: usize },
    Face(usize),
}

/// The demand of tethers on a mover in one direction.
#[derive(Clone, Copy, Debug, Default)]
struct Pull {
    /// A unit vector, or zero if they want nothing.
    direction: Vec3,
    /// Metres by which the mover should give way.
    wanted: f32,
    /// The push on the mover so far, in kg m.
    push: f32,
}

/// Notes what movers press, before tethers are projected.
pub(crate) fn note(contacts: &mut BodyContacts, body: &Body, movers: &[Mover]) {
    let BodyContacts { obstacles, faces, pressed, .. } = contacts;
    pressed.clear();
    if movers.is_empty() || body.topology.tethers.is_empty() || !body.settings.tethers {
        return;
    }
    // For all that may be pressed at once, so that particles that are pressed one by one do not allocate one by one.
    pressed.reserve(LANES * obstacles.candidates.len() + faces.points().len());
    let mut note = |contact, obstacle, (carriers, weights): ([usize; 3], _), normal, friction| {
        let place = weighted(weights, carriers.map(|slot| body.particles.position.get(slot)));
        let travel = weighted(weights, carriers.map(|slot| body.travel(slot)));
        pressed.push(PressedPoint {
            contact,
            obstacle,
            carriers,
            weights,
            normal,
            friction,
            place,
            local: Vec3::ZERO,
            begun: (body.particles.origin + place - travel).as_dvec3(),
            depth: 0.0,
            normal_pull: Pull::default(),
            tangential_pull: Pull::default(),
        });
    };
    for (index, candidate) in obstacles.candidates.iter().enumerate() {
        let group = &obstacles.groups[usize::from(candidate.group)];
        if !(group.is_dynamic && candidate.is_touching) {
            continue;
        }
        let pushes = &obstacles.pushes[index];
        for lane in (0..LANES).filter(|&lane| pushes.depth[lane] > 0.0) {
            let contact = PressingContact::Particle { candidate: index, lane };
            let carriers = ([candidate.slot(lane); 3], [1.0, 0.0, 0.0]);
            note(contact, group.obstacle, carriers, pushes.normal.get(lane), group.friction.sticking);
        }
    }
    for (index, point) in faces.points().enumerate() {
        if point.depth > 0.0 && mover(movers, point.obstacle).is_some() {
            let carriers = (point.carriers, point.weights);
            let contact = PressingContact::Face(index);
            note(contact, point.obstacle, carriers, point.normal, point.friction.sticking);
        }
    }
}

/// Passes what tethers have done to these points on to the movers.
pub(crate) fn pull(contacts: &mut BodyContacts, body: &mut Body, substep: Substep, movers: &mut [Mover]) {
    let BodyContacts { obstacles, faces, pressed, .. } = contacts;
    pressed.retain_mut(|point| {
        mover(movers, point.obstacle).is_some_and(|mover| point.is_pulled(body, mover, substep.duration))
    });
    let origin = body.particles.origin;
    for _ in 0..TETHER_PULL_ROUNDS {
        for point in &mut *pressed {
            if let Some(mover) = mover_mut(movers, point.obstacle) {
                point.pull(mover, origin, substep.duration);
            }
        }
    }
    for point in pressed {
        let push = -(point.normal_pull.direction * point.normal_pull.push
            + point.tangential_pull.direction * point.tangential_pull.push);
        match point.contact {
            PressingContact::Particle { candidate, lane } => {
                let Some(mover) = mover(movers, point.obstacle) else { continue };
                let slot = point.carriers[0];
                let given = (point.on(mover, origin) - point.place).dot(point.normal_pull.direction);
                body.particles.position.add(slot, point.normal * (point.depth - given).max(0.0));
                let inverse_mass = body.particles.inverse_mass[slot];
                obstacles.pushes[candidate].depth[lane] += point.normal_pull.push * inverse_mass;
                obstacles.given[candidate].add(lane, push * inverse_mass);
            }
            PressingContact::Face(index) => {
                faces.add_push(index, push, point.normal_pull.push, &body.particles);
            }
        }
    }
}

impl PressedPoint {
    /// Finds out what the tethers want of the mover. False if they do not pull into it.
    fn is_pulled(&mut self, body: &Body, mover: &Mover, substep: f32) -> bool {
        let Body { particles, topology, .. } = body;
        let mean = |of: &dyn Fn(usize) -> Vec3| weighted(self.weights, self.carriers.map(of));
        let moved = mean(&|slot| particles.position.get(slot)) - self.place;
        self.depth = -moved.dot(self.normal);
        if self.depth.is_nan() || self.depth <= 0.0 {
            return false;
        }
        let [before, now] = mover.poses(particles.origin);
        self.local = now.to_local(self.place);
        let way = self.place
            - before.point_to_world(self.local)
            - mean(&|slot| topology.tethers.anchor_travel(slot, particles));
        let recovered = self.depth * (substep / TETHER_RECOVERY);
        let wanted = self.depth.min(way.dot(self.normal) + recovered);
        self.normal_pull = Pull { direction: -self.normal, wanted, push: 0.0 };
        let tangential = moved + self.normal * self.depth;
        let direction = tangential.normalize_or_zero();
        self.tangential_pull = Pull { direction, wanted: -way.dot(direction), push: 0.0 };
        true
    }

    /// The place to which the mover has brought the point, relative to the body's origin.
    fn on(&self, mover: &Mover, origin: Vec3) -> Vec3 {
        Pose::at(&mover.to, origin).point_to_world(self.local)
    }

    /// One round of pulls at the mover.
    fn pull(&mut self, mover: &mut Mover, origin: Vec3, substep: f32) {
        self.normal_pull.push = self.apply(self.normal_pull, [0.0, f32::INFINITY], mover, origin, substep);
        let most = self.friction * self.normal_pull.push;
        self.tangential_pull.push = self.apply(self.tangential_pull, [-most, most], mover, origin, substep);
    }

    /// Makes the mover give way in one direction. Returns the push so far, from `least` to `most`.
    fn apply(
        &self,
        pull: Pull,
        [least, most]: [f32; 2],
        mover: &mut Mover,
        origin: Vec3,
        substep: f32,
    ) -> f32 {
        let place = self.on(mover, origin);
        let given = (place - self.place).dot(pull.direction);
        let inverse_mass = mover.inverse_mass_at(origin + place, pull.direction);
        if inverse_mass == 0.0 {
            return pull.push;
        }
        let push = (pull.push + (pull.wanted - given) / inverse_mass).min(most).max(least);
        // A mover receives the opposite of what it gives.
        let change = pull.direction * (pull.push - push);
        mover.receive(ObstaclePush::at(self.begun, self.obstacle, change), substep);
        push
    }
}
