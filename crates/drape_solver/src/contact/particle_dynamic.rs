//! Particles against movers, one by one: inverse masses split each push between particle and obstacle.
//!
//! This differs from [`particle_obstacle`](crate::contact::particle_obstacle) in the normal push: the particle, of
//! inverse mass `w`, takes the part `w / (w + W)` of the depth and the obstacle the rest, where `W` is the obstacle's
//! inverse mass at the contact point. The next particle sees the obstacle in its new pose. If many particles push, the
//! first push too much; later projections take that back, down to no push at all (projected Gauss-Seidel).
//!
//! A particle that another obstacle holds up gives way by less, or not at all: see [`support`](crate::contact::support).
//!
//! Design: `docs/design/dynamic_obstacles.md`.

use glam::{DVec3, Vec3};

use crate::contact::depenetration::{Correction, InitialOverlap, PushOutRate};
use crate::contact::mover::{Mover, mover_mut};
use crate::contact::obstacle_push::ObstaclePush;
use crate::contact::particle_obstacle::{ObstacleContacts, ObstacleGroup, Pushes};
use crate::simd::columns::{Cell, LANES};
use crate::state::body::Body;
use crate::state::particles::Particles;
use crate::state::substep::Substep;

/// The mover that a group's obstacle is, if it is one.
fn mover_of<'a>(group: &ObstacleGroup, movers: &'a mut [Mover]) -> Option<&'a mut Mover> {
    if group.is_dynamic { mover_mut(movers, group.obstacle) } else { None }
}

/// Moves particles out of movers, and the movers back.
pub(crate) fn project(
    contacts: &mut ObstacleContacts,
    body: &mut Body,
    substep: Substep,
    movers: &mut [Mover],
    is_first: bool,
) {
    if movers.is_empty() {
        return;
    }
    let Body { particles, context, settings, .. } = body;
    let (origin, thickness) = (particles.origin, settings.thickness);
    let rate = PushOutRate::of(substep);
    let ObstacleContacts {
        groups, candidates, pushes: all_pushes, given: all_given, planes, supports, ..
    } = contacts;
    for index in 0..candidates.len() {
        let group = &groups[usize::from(candidates[index].group)];
        let Some(mover) = mover_of(group, movers) else { continue };
        if is_first {
            candidates[index].is_touching = false;
            all_given[index] = Cell::default();
        }
        let candidate = candidates[index];
        let shape = substep.obstacles[group.obstacle].shape();
        let mut poses = mover.poses(origin);
        for lane in candidate.each_lane() {
            let slot = candidate.slot(lane);
            let [before, now] = poses;
            let position = particles.position.get(slot);
            let plane = candidate.planes.map(|place| planes[place as usize].get(lane));
            let surface_at = |local: Vec3| shape.surface_or(plane, local);
            let local = now.to_local(position);
            let surface = surface_at(local);
            let depth = thickness - surface.distance;
            let pushes = &mut all_pushes[index];
            let pushed = if candidates[index].is_touching { pushes.depth[lane] } else { 0.0 };
            if depth <= 0.0 && pushed == 0.0 {
                continue;
            }
            if !candidates[index].is_touching {
                *pushes = Pushes::NONE;
                candidates[index].is_touching = true;
            }
            let normal = now.direction_to_world(surface.normal);
            let travel = particles.displacement.get(slot) + (position - context.integrated.get(slot));
            let outward = (travel - (position - before.point_to_world(local))).dot(normal);
            let push = if depth > 0.0 {
                let start = before.to_local(position - travel);
                let mut overlap =
                    InitialOverlap::with_left((pushes.left[lane] >= 0.0).then_some(pushes.left[lane]));
                let push = overlap.split(depth, outward, || thickness - surface_at(start).distance, rate);
                pushes.left[lane] = overlap.left().unwrap_or(-1.0);
                push
            } else {
                Correction { with_velocity: depth, position_only: 0.0 }
            };
            let inverse_mass = particles.inverse_mass[slot];
            let place = origin + position;
            let inverse_mass_of_mover = mover.inverse_mass_at(place, normal);
            // If neither can give way, the particle does.
            let support =
                supports.of(slot, normal, candidates, all_pushes).filter(|_| inverse_mass_of_mover > 0.0);
            let yields = inverse_mass * support.map_or(1.0, |held| held.left);
            let share = inverse_mass / (yields + inverse_mass_of_mover);
            // Other particles may have pushed the obstacle away since: the excess of earlier pushes is taken back.
            let distance = (push.with_velocity * share).max(-pushed);
            let pushes = &mut all_pushes[index];
            pushes.depth[lane] += distance;
            pushes.normal.set(lane, normal);
            let push_of_mover = normal * distance;
            all_given[index].add(lane, push_of_mover);
            let (mut moved, mut out) = (push_of_mover, normal * (distance + push.position_only));
            if let Some(held) = support {
                let back = held.back * distance;
                moved += back;
                out += back;
                let depth = &mut all_pushes[held.place].depth[lane];
                *depth = (*depth + held.back.length() * distance).max(0.0);
                all_given[held.place].add(lane, back);
            }
            particles.displacement.add(slot, moved);
            particles.position.add(slot, out);
            context.integrated.add(slot, out);
            // A push changes the displacement of the whole substep, so it acts where the displacement began.
            let begun = (place - travel).as_dvec3();
            mover.receive(
                ObstaclePush::at(begun, group.obstacle, push_of_mover / inverse_mass),
                substep.duration,
            );
            poses = mover.poses(origin);
        }
    }
}

/// Friction against the slip of particles on movers in this substep.
pub(crate) fn apply_friction(
    contacts: &mut ObstacleContacts,
    body: &mut Body,
    substep: Substep,
    movers: &mut [Mover],
) {
    if movers.is_empty() {
        return;
    }
    let particles = &mut body.particles;
    let ObstacleContacts { groups, candidates, pushes, given, supports, .. } = contacts;
    for (index, candidate) in candidates.iter().enumerate().filter(|(_, candidate)| candidate.is_touching) {
        let group = &groups[usize::from(candidate.group)];
        let Some(mover) = mover_of(group, movers) else { continue };
        for lane in (0..LANES).filter(|&lane| pushes[index].depth[lane] > 0.0) {
            let slot = candidate.slot(lane);
            let (normal, depth) = (pushes[index].normal.get(lane), pushes[index].depth[lane]);
            let inverse_mass = particles.inverse_mass[slot];
            let mut friction = group.friction;
            // The support holds the particle fast, too, as far as its own friction allows.
            if let Some(held) = supports.of(slot, normal, candidates, pushes) {
                let slip = Slip::of(slot, particles, mover);
                let push =
                    mover.friction_push(friction, [inverse_mass, 0.0], slip.slip, normal, depth, slip.place);
                let support = &groups[usize::from(candidates[held.place].group)];
                let borne =
                    support.friction.share_of(push.length(), pushes[held.place].depth[lane] / inverse_mass);
                let push = push * borne;
                given[index].add(lane, -push * inverse_mass);
                given[held.place].add(lane, push * inverse_mass);
                mover.receive(ObstaclePush::at(slip.begun, group.obstacle, -push), substep.duration);
                friction = friction.scaled(1.0 - borne);
            }
            let slip = Slip::of(slot, particles, mover);
            let (taken, push) =
                mover.slip_taken(friction, inverse_mass, slip.slip, normal, depth, slip.place);
            given[index].add(lane, -taken);
            particles.position.add(slot, -taken);
            particles.displacement.add(slot, -taken);
            mover.receive(ObstaclePush::at(slip.begun, group.obstacle, push), substep.duration);
        }
    }
}

/// The slip of a particle on a mover in this substep.
struct Slip {
    /// In metres.
    slip: Vec3,
    /// The particle's place in the world at the end of the substep.
    place: Vec3,
    /// Its place at the start.
    begun: DVec3,
}

impl Slip {
    fn of(slot: usize, particles: &Particles, mover: &Mover) -> Self {
        let [before, now] = mover.poses(particles.origin);
        let (position, displacement) = (particles.position.get(slot), particles.displacement.get(slot));
        let place = particles.origin + position;
        Self {
            slip: displacement - (position - before.point_to_world(now.to_local(position))),
            place,
            begun: (place - displacement).as_dvec3(),
        }
    }
}
