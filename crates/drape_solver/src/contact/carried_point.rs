//! A point that `N` particles carry, against an obstacle: the push and the friction of faces and of embedded points.
//!
//! ```text
//!     x1 o------p------o x2      p = sum b_i x_i;  C = n . (p - q) - t
//!         \     |n    /          if C < 0:  x_i -= b_i w_i C n / sum(b_i^2 w_i)
//!   ============q==========      q, n: the nearest point of the surface, and its normal
//! ```
//!
//! Design: `docs/design/obstacles.md`.

use glam::Vec3;

use crate::contact::depenetration::{InitialOverlap, PushOutRate};
use crate::contact::effective_mass::effective_inverse_mass;
use crate::contact::mover::{Mover, mover_mut};
use crate::contact::obstacle_push::ObstaclePush;
use crate::geometry::nearest_triangle::weighted;
use crate::geometry::pose::Pose;
use crate::geometry::shape::Surface;
use crate::state::body::Body;
use crate::state::friction::Friction;
use crate::state::particles::Particles;
use crate::state::substep::Substep;

/// A point of a body that may touch an obstacle in this step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CarriedPoint<const N: usize> {
    /// Slots of the carriers.
    pub carriers: [usize; N],
    /// Weights of the carriers; their sum is 1.
    pub weights: [f32; N],
    /// By index in the environment.
    pub obstacle: usize,
    pub friction: Friction,
    /// Penetration depth that motion made, summed over the projections of the substep, in metres.
    pub depth: f32,
    overlap: InitialOverlap,
    /// Unit normal of the last projection, in the world.
    pub normal: Vec3,
    /// The point's mass times the distance that the obstacle moved it with velocity in this substep, in kg m.
    pub given: Vec3,
}

/// The poses of an obstacle at the start and the end of a substep.
pub(crate) struct Poses {
    obstacle: usize,
    pub before: Pose,
    pub now: Pose,
}

impl Poses {
    fn of(obstacle: usize, substep: Substep, origin: Vec3) -> Self {
        let pose_at = |k: u32| substep.obstacles[obstacle].pose_at(k as f32 / substep.count as f32, origin);
        Self { obstacle, before: pose_at(substep.index), now: pose_at(substep.index + 1) }
    }

    fn of_mover(obstacle: usize, mover: &Mover, origin: Vec3) -> Self {
        let [before, now] = mover.poses(origin);
        Self { obstacle, before, now }
    }

    /// The way that the obstacle has carried a point of its surface within the substep.
    fn carried(&self, point: Vec3) -> Vec3 {
        point - self.before.point_to_world(self.now.to_local(point))
    }
}

/// The poses of the last obstacle that was asked for: contacts are in the order of their obstacles.
#[derive(Default)]
pub(crate) struct PoseCache {
    last: Option<Poses>,
}

impl PoseCache {
    /// The poses of an obstacle, in coordinates relative to `origin`. A mover's are worked out anew in each call, as any
    /// contact may have moved it.
    pub fn of(&mut self, obstacle: usize, mover: Option<&Mover>, substep: Substep, origin: Vec3) -> &Poses {
        if let Some(mover) = mover {
            return self.last.insert(Poses::of_mover(obstacle, mover, origin));
        }
        if self.last.as_ref().is_none_or(|known| known.obstacle != obstacle) {
            self.last = None;
        }
        self.last.get_or_insert_with(|| Poses::of(obstacle, substep, origin))
    }

    /// The mover that the obstacle is, if it is one, and the obstacle's poses.
    pub fn with_mover<'m>(
        &mut self,
        obstacle: usize,
        movers: &'m mut [Mover],
        substep: Substep,
        origin: Vec3,
    ) -> (Option<&'m mut Mover>, &Poses) {
        let mover = mover_mut(movers, obstacle);
        let poses = self.of(obstacle, mover.as_deref(), substep, origin);
        (mover, poses)
    }
}

/// The surface above a point that lies below it.
pub(crate) struct SurfaceBelow<F> {
    /// In the obstacle's coordinates.
    pub surface: Surface,
    /// Metres that the point keeps from the surface.
    pub thickness: f32,
    /// Returns the surface next to a place in the obstacle's coordinates.
    pub surface_at: F,
}

impl<const N: usize> CarriedPoint<N> {
    pub fn new(carriers: [usize; N], weights: [f32; N], obstacle: usize, friction: Friction) -> Self {
        Self {
            carriers,
            weights,
            obstacle,
            friction,
            depth: 0.0,
            overlap: InitialOverlap::default(),
            normal: Vec3::ZERO,
            given: Vec3::ZERO,
        }
    }

    /// Forgets the last substep.
    pub fn begin_substep(&mut self) {
        *self = Self::new(self.carriers, self.weights, self.obstacle, self.friction);
    }

    /// The weighted mean of one vector of each carrier.
    pub fn mean(&self, of: impl Fn(usize) -> Vec3) -> Vec3 {
        weighted(self.weights, self.carriers.map(of))
    }

    /// Inverse mass of the point in 1/kg.
    fn inverse_mass(&self, particles: &Particles) -> f32 {
        effective_inverse_mass(self.weights, self.carriers.map(|slot| particles.inverse_mass[slot]))
    }

    /// Moves the point out to the surface. A mover takes its share of the push: `reaction` returns the obstacle's push,
    /// given the place in the world where the point's displacement of this substep began and the push on the point in
    /// kg m.
    pub fn project(
        &mut self,
        body: &mut Body,
        found: SurfaceBelow<impl Fn(Vec3) -> Surface>,
        poses: &Poses,
        mover: Option<&mut Mover>,
        rate: PushOutRate,
        reaction: impl Fn(&Self, &Particles, Vec3, Vec3) -> ObstaclePush,
    ) {
        let SurfaceBelow { surface, thickness, surface_at } = found;
        let inverse_mass = self.inverse_mass(&body.particles);
        if inverse_mass == 0.0 {
            return;
        }
        let point = self.mean(|slot| body.particles.position.get(slot));
        let normal = poses.now.direction_to_world(surface.normal);
        let travel = self.mean(|slot| body.travel(slot));
        let start = poses.before.to_local(point - travel);
        let at_start = || thickness - surface_at(start).distance;
        let outward = (travel - poses.carried(point)).dot(normal);
        let mut push = self.overlap.split(thickness - surface.distance, outward, at_start, rate);
        if let Some(mover) = mover {
            let contact = body.particles.origin + point;
            push.with_velocity *= inverse_mass / (inverse_mass + mover.inverse_mass_at(contact, normal));
            let given = normal * (push.with_velocity / inverse_mass);
            mover.receive(reaction(self, &body.particles, contact - travel, given), rate.substep());
        }
        self.depth += push.with_velocity;
        self.normal = normal;
        self.given += normal * (push.with_velocity / inverse_mass);
        for (slot, weight) in self.carriers.into_iter().zip(self.weights) {
            let share = weight * body.particles.inverse_mass[slot] / inverse_mass;
            let (with_velocity, all) = (
                normal * (push.with_velocity * share),
                normal * ((push.with_velocity + push.position_only) * share),
            );
            body.particles.displacement.add(slot, with_velocity);
            body.particles.position.add(slot, all);
            body.context.integrated.add(slot, all);
        }
    }

    /// Adds a push (kg m) to the account, and its part along the normal to the depth.
    pub fn add_push(&mut self, push: Vec3, normal_push: f32, particles: &Particles) {
        self.depth += normal_push * self.inverse_mass(particles);
        self.given += push;
    }

    /// Friction against the slip of the point in this substep, for a summed penetration `depth` in metres.
    pub fn apply_friction(
        &mut self,
        particles: &mut Particles,
        depth: f32,
        poses: &Poses,
        mover: Option<&mut Mover>,
        substep: Substep,
        reaction: impl Fn(&Self, &Particles, Vec3, Vec3) -> ObstaclePush,
    ) {
        let point = self.mean(|slot| particles.position.get(slot));
        let moved = self.mean(|slot| particles.displacement.get(slot));
        let slip = moved - poses.carried(point);
        let inverse_mass = self.inverse_mass(particles);
        let taken = match mover {
            Some(mover) => {
                let place = particles.origin + point;
                let (taken, push) =
                    mover.slip_taken(self.friction, inverse_mass, slip, self.normal, depth, place);
                mover.receive(reaction(self, particles, place - moved, push), substep.duration);
                taken
            }
            None => self.friction.slip_taken(slip, self.normal, depth),
        };
        self.given -= taken / inverse_mass;
        for (slot, weight) in self.carriers.into_iter().zip(self.weights) {
            let shift = taken * (-weight * particles.inverse_mass[slot] / inverse_mass);
            particles.position.add(slot, shift);
            particles.displacement.add(slot, shift);
        }
    }
}
