//! Ball joints: particles that are held at points of movers, and pull at them.
//!
//! ```text
//!          stick                      a stick moves the particle by d, which has the inverse mass W of the
//!   o-----------------x--.            mover at the joint: the mover receives the push d / W there, and the
//!                    joint '--.       particle goes back to the joint
//!                        | mover |
//! ```
//!
//! Between two relaxations of sticks the particle is a pin. `n` joints of a body at one mover each have an `n`th of its mass
//! (mass splitting, Tonge, Benevolenski and Voroshilov 2012), as all of them pull before the mover yields to any.
//!
//! Design: `docs/design/joints.md`.

use glam::{DVec3, Vec3};

use crate::constants::{LEAST_JOINT_WEIGHT, TETHER_SPEED};
use crate::contact::mover::{Mover, mover, mover_mut};
use crate::contact::obstacle_push::ObstaclePush;
use crate::geometry::shape::Shape;
use crate::state::body::Body;
use crate::state::obstacles::Obstacles;
use crate::state::particle_stats::MassStats;
use crate::state::substep::Substep;

/// A joint on its way through a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MovingJoint {
    slot: usize,
    pub obstacle: usize,
    /// In the mover's frame.
    anchor: Vec3,
    /// Greatest distance to the next joint in metres: the length of the rope between them.
    reach: f32,
    /// The number of joints of the body at this mover.
    count: f32,
    /// Inverse mass of the particle while sticks are relaxed, in 1/kg.
    inverse_mass: f32,
    /// Direction in which sticks pulled the particle last; zero before they have.
    pull: Vec3,
    /// Sum of the pushes on the particle in this substep, in kg m, and where they act (world).
    given: Vec3,
    begun: DVec3,
}

impl MovingJoint {
    /// Passes a push on the particle (kg m) on to the mover.
    fn push(&mut self, mover: &mut Mover, push: Vec3, substep: f32) {
        self.given += push;
        // A mover receives the opposite of what it gives.
        mover.receive(ObstaclePush::at(self.begun, self.obstacle, -push), substep);
    }
}

/// Lists the joints of a body to obstacles with rigid bodies.
pub(crate) fn detect(joints: &mut Vec<MovingJoint>, body: &Body, obstacles: &Obstacles) {
    let Body { particles, topology, settings, .. } = body;
    joints.clear();
    for joint in &particles.joints {
        let obstacle = joint.obstacle as usize;
        let slot = joint.slot as usize;
        let is_mover = obstacles.get(obstacle).is_some_and(|obstacle| obstacle.rigid_body().is_some());
        if is_mover && particles.inverse_mass[slot] == 0.0 {
            let same =
                || particles.joints.iter().filter(|other| other.obstacle == joint.obstacle).count() as f32;
            let count =
                joints.last().filter(|last| last.obstacle == obstacle).map_or_else(same, |last| last.count);
            joints.push(MovingJoint {
                slot,
                obstacle,
                anchor: joint.anchor,
                reach: f32::INFINITY,
                count,
                inverse_mass: 0.0,
                pull: Vec3::ZERO,
                given: Vec3::ZERO,
                begun: DVec3::ZERO,
            });
        }
    }
    if !settings.tethers {
        return;
    }
    for i in 1..joints.len() {
        let [Some(from), Some(to)] = [i - 1, i].map(|i| particles.layout.index(joints[i].slot)) else {
            continue;
        };
        joints[i - 1].reach = topology.rope_length([from, to]).unwrap_or(f32::INFINITY);
    }
}

/// True if a joint holds the body by a point deep inside the obstacle, which the body cannot touch then.
pub(crate) fn is_held_inside(joints: &[MovingJoint], obstacle: usize, shape: &Shape, thickness: f32) -> bool {
    let mut held = joints.iter().filter(|joint| joint.obstacle == obstacle);
    held.any(|joint| shape.surface(joint.anchor).distance < -thickness)
}

/// Begins a substep: no joint has pulled yet.
pub(crate) fn begin_substep(joints: &mut [MovingJoint], body: &mut Body, movers: &[Mover]) {
    joints.iter_mut().for_each(|joint| joint.given = Vec3::ZERO);
    follow(joints, body, movers);
}

/// Puts the particles where the movers are, with the displacement of that way.
pub(crate) fn follow(joints: &mut [MovingJoint], body: &mut Body, movers: &[Mover]) {
    let origin = body.particles.origin;
    for joint in joints {
        let Some(mover) = mover(movers, joint.obstacle) else { continue };
        let [from, to] = mover.poses(origin).map(|pose| pose.point_to_world(joint.anchor));
        joint.begun = (origin + from).as_dvec3();
        body.particles.position.set(joint.slot, to);
        body.particles.displacement.set(joint.slot, to - from);
        body.context.integrated.set(joint.slot, to);
    }
}

/// Gives the particles the masses of their movers, for a relaxation of sticks.
pub(crate) fn release(joints: &mut [MovingJoint], body: &mut Body, movers: &[Mover]) {
    let particles = &mut body.particles;
    let MassStats { free_count, free_mass, .. } = particles.masses;
    let mean = (free_count as f64 / free_mass.max(f64::MIN_POSITIVE)) as f32;
    for joint in joints {
        let Some(mover) = mover(movers, joint.obstacle) else { continue };
        let point = particles.origin + particles.position.get(joint.slot);
        let inverse_mass = if joint.pull == Vec3::ZERO {
            mover.greatest_inverse_mass_at(point)
        } else {
            mover.inverse_mass_at(point, joint.pull)
        };
        let is_held = inverse_mass <= mean * LEAST_JOINT_WEIGHT;
        joint.inverse_mass = if is_held { 0.0 } else { joint.count * inverse_mass };
        particles.inverse_mass[joint.slot] = joint.inverse_mass;
    }
}

/// Passes the pull of the sticks on to the movers, and makes the particles pins again.
pub(crate) fn pull(joints: &mut [MovingJoint], body: &mut Body, movers: &mut [Mover], substep: Substep) {
    for joint in &mut *joints {
        let particles = &mut body.particles;
        particles.inverse_mass[joint.slot] = 0.0;
        let Some(mover) = mover_mut(movers, joint.obstacle) else { continue };
        let moved = particles.position.get(joint.slot) - body.context.integrated.get(joint.slot);
        if moved == Vec3::ZERO {
            continue;
        }
        joint.pull = moved.normalize_or_zero();
        joint.push(mover, moved / joint.inverse_mass, substep.duration);
    }
    let length_ratio = body.particles.length_ratio(substep);
    for next in 1..joints.len() {
        tauten(&mut joints[next - 1..=next], length_ratio, movers, substep.duration);
    }
    follow(joints, body, movers);
}

/// Pulls two movers together that are farther from each other than the rope between them is long: a tether with two ends that
/// move. Links alone would carry the pull from one to the other only slowly.
fn tauten(joints: &mut [MovingJoint], length_ratio: f32, movers: &mut [Mover], substep: f32) {
    let [from, to] = joints else { return };
    let reach = f64::from(from.reach * length_ratio);
    let (Some(a), Some(b)) = (mover(movers, from.obstacle), mover(movers, to.obstacle)) else { return };
    let [start, end] = [a.point(from.anchor), b.point(to.anchor)];
    let (way, distance) = (end - start, end.distance(start));
    if !(distance > reach && from.obstacle != to.obstacle) {
        return;
    }
    let along = (way / distance).as_vec3();
    let both = a.inverse_mass_at(start.as_vec3(), along) + b.inverse_mass_at(end.as_vec3(), along);
    let excess = ((distance - reach) as f32).min(TETHER_SPEED * substep);
    if both > 0.0 {
        for (joint, push) in [(from, along), (to, -along)] {
            if let Some(mover) = mover_mut(movers, joint.obstacle) {
                joint.push(mover, push * (excess / both), substep);
            }
        }
    }
}

/// Hands to the movers what rounding has kept of the pull of sticks. Sticks pull at particles and movers alike, so that
/// both together keep their momentum, if joints are the only pins.
pub(crate) fn balance(joints: &mut [MovingJoint], body: &Body, movers: &mut [Mover], substep: f32) {
    let Body { particles, context, .. } = body;
    let is_free = |joint: &MovingJoint| joint.inverse_mass > 0.0;
    if joints.is_empty()
        || !joints.iter().all(is_free)
        || particles.masses.free_count + joints.len() < particles.len()
    {
        return;
    }
    let pulled = |slot: usize| {
        let inverse_mass = particles.inverse_mass[slot];
        let moved = particles.position.get(slot) - context.integrated.get(slot);
        if inverse_mass > 0.0 { moved.as_dvec3() / f64::from(inverse_mass) } else { DVec3::ZERO }
    };
    let on_particles = particles.layout.slots().map(pulled).sum::<DVec3>();
    let on_movers = joints.iter().map(|joint| joint.given.as_dvec3()).sum::<DVec3>();
    let mass = joints.iter().map(|joint| joint.inverse_mass.recip()).sum::<f32>();
    let left = -(on_particles + on_movers).as_vec3() / mass;
    for joint in joints {
        if let Some(mover) = mover_mut(movers, joint.obstacle) {
            joint.push(mover, left / joint.inverse_mass, substep);
        }
    }
}

/// The pushes of movers on the particles that they hold, in this substep.
pub(crate) fn given(joints: &[MovingJoint]) -> impl Iterator<Item = ObstaclePush> + '_ {
    joints.iter().map(|joint| ObstaclePush::at(joint.begun, joint.obstacle, -joint.given))
}
