//! Particles against obstacles.
//!
//! Once a step the particles that could reach an obstacle are listed; each projection moves those that lie
//! inside out along the normal, to the nearest point of the surface.
//!
//! ```text
//!      o  particle
//!   ---|----------- thickness
//!   ===|=========== surface     depth = thickness - distance; moved by depth along the normal
//!      x
//! ```

use glam::Vec3;

use crate::body::{Body, BodyContext};
use crate::friction::{combined, slip_taken};
use crate::obstacle::Obstacle;
use crate::overlap::{Overlap, Pace};
use crate::pose::Pose;
use crate::shape::{Plane, Shape, Surface, container_walls};

/// The particles of one body that may touch obstacles in this step.
#[derive(Clone, Debug, Default)]
pub(crate) struct ObstacleContacts {
    groups: Vec<Group>,
    candidates: Vec<Candidate>,
}

/// Candidates of one obstacle, and its pose at the ends of the current substep.
#[derive(Clone, Debug)]
struct Group {
    obstacle: usize,
    first: usize,
    count: usize,
    friction: f32,
    before: Pose,
    now: Pose,
}

#[derive(Clone, Copy, Debug)]
struct Candidate {
    particle: u32,
    /// Depth that motion made, summed over the projections of the substep, in metres.
    depth: f32,
    overlap: Overlap,
    /// World normal of the last projection.
    normal: Vec3,
    /// The surface near the particle as a plane, where asking the shape each time would be slow or wrong.
    plane: Option<Plane>,
}

impl ObstacleContacts {
    pub fn clear(&mut self) {
        self.groups.clear();
        self.candidates.clear();
    }
}

impl BodyContext {
    /// Particles that obstacles pushed out in the last substep: the particle's index, the unit normal of the
    /// surface in the world, and the depth in metres, summed over the projections of the substep.
    pub fn contacts(&self) -> impl Iterator<Item = (usize, Vec3, f32)> + '_ {
        let touching = self.contacts.candidates.iter().filter(|candidate| candidate.depth > 0.0);
        touching.map(|candidate| (candidate.particle as usize, candidate.normal, candidate.depth))
    }
}

/// Lists the particles that could touch each obstacle if nothing moves more than `reach` (metres) on top of
/// the obstacle's own travel.
pub(crate) fn detect(body: &mut Body, obstacles: &[Obstacle], reach: f32) {
    let (low, high) = body.particles.bounds();
    let Body { particles, settings, context, .. } = body;
    context.contacts.clear();
    let ObstacleContacts { groups, candidates } = &mut context.contacts;
    for (index, obstacle) in obstacles.iter().enumerate() {
        let reach = reach + settings.thickness;
        let (obstacle_low, obstacle_high) = obstacle.swept_bounds();
        if !(low - reach).cmple(obstacle_high).all() || !(high + reach).cmpge(obstacle_low).all() {
            continue;
        }
        let reach = reach + obstacle.travel();
        let pose = obstacle.pose_at(0.0, particles.origin);
        let first = candidates.len();
        for (i, position) in particles.position.iter().enumerate() {
            if particles.inverse_mass[i] == 0.0 {
                continue;
            }
            let local = pose.to_local(position);
            let mut add = |plane: Option<Plane>| {
                candidates.push(Candidate {
                    particle: i as u32,
                    depth: 0.0,
                    overlap: Overlap::default(),
                    normal: Vec3::ZERO,
                    plane,
                });
            };
            match obstacle.shape() {
                Shape::Container { half_extents } => container_walls(*half_extents)
                    .into_iter()
                    .filter(|wall| wall.surface(local).distance < reach)
                    .for_each(|wall| add(Some(wall))),
                shape @ Shape::Parry(_) => {
                    let Surface { distance, normal } = shape.surface(local);
                    if distance < reach {
                        let offset = normal.dot(local) - distance;
                        add(Some(Plane { normal, offset }));
                    }
                }
                shape => {
                    if shape.surface(local).distance < reach {
                        add(None);
                    }
                }
            }
        }
        let count = candidates.len() - first;
        if count > 0 {
            groups.push(Group {
                obstacle: index,
                first,
                count,
                friction: combined(settings.friction, obstacle.friction()),
                before: pose,
                now: pose,
            });
        }
    }
}

/// Brings the obstacles to the end of substep `index` of `count` and forgets the last substep's depths.
pub(crate) fn begin_substep(body: &mut Body, obstacles: &[Obstacle], index: u32, count: u32) {
    let origin = body.particles.origin;
    let contacts = &mut body.context.contacts;
    for group in &mut contacts.groups {
        let pose_at = |k: u32| obstacles[group.obstacle].pose_at(k as f32 / count as f32, origin);
        group.before = pose_at(index);
        group.now = pose_at(index + 1);
    }
    for candidate in &mut contacts.candidates {
        candidate.depth = 0.0;
        candidate.overlap = Overlap::default();
    }
}

/// Moves every particle that lies inside an obstacle out to its surface.
pub(crate) fn project(body: &mut Body, obstacles: &[Obstacle], pace: Pace) {
    let Body { particles, settings, context, .. } = body;
    let ObstacleContacts { groups, candidates } = &mut context.contacts;
    for group in groups {
        let shape = obstacles[group.obstacle].shape();
        for candidate in &mut candidates[group.first..group.first + group.count] {
            let i = candidate.particle as usize;
            let position = particles.position.get(i);
            let local = group.now.to_local(position);
            let plane = candidate.plane;
            let surface = |local: Vec3| match plane {
                Some(plane) => plane.surface(local),
                None => shape.surface(local),
            };
            let Surface { distance, normal } = surface(local);
            let depth = settings.thickness - distance;
            if depth > 0.0 {
                let normal = group.now.direction_to_world(normal);
                let travel = particles.displacement.get(i) + (position - context.integrated.get(i));
                let carried = group.now.point_to_world(local) - group.before.point_to_world(local);
                let outward = (travel - carried).dot(normal);
                let at_start =
                    || settings.thickness - surface(group.before.to_local(position - travel)).distance;
                let push = candidate.overlap.split(depth, outward, at_start, pace);
                candidate.normal = normal;
                candidate.depth += push.fresh;
                let out = normal * (push.fresh + push.old);
                particles.displacement.add(i, normal * push.fresh);
                particles.position.add(i, out);
                context.integrated.add(i, out);
            }
        }
    }
}

/// Takes tangential displacement from every particle that was projected. Comes last in the substep, after
/// displacements were brought up to date.
pub(crate) fn apply_friction(body: &mut Body) {
    let Body { particles, context, .. } = body;
    let ObstacleContacts { groups, candidates } = &context.contacts;
    for group in groups {
        for candidate in &candidates[group.first..group.first + group.count] {
            if candidate.depth == 0.0 {
                continue;
            }
            let i = candidate.particle as usize;
            // The surface point under the particle came from where the same local point was before.
            let position = particles.position.get(i);
            let carried = position - group.before.point_to_world(group.now.to_local(position));
            let slip = particles.displacement.get(i) - carried;
            let taken = slip_taken(slip, candidate.normal, group.friction, candidate.depth);
            particles.position.add(i, -taken);
            particles.displacement.add(i, -taken);
        }
    }
}
