//! A contact between particles of cloths and ropes: the push and the friction of particles, faces and edges alike.
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

use crate::contact::depenetration::{InitialOverlap, PushOutRate};
use crate::contact::effective_mass::effective_inverse_mass;
use crate::state::body::Body;
use crate::state::settings::SelfContact;

/// True if the body touches by its triangles, where the other body does so too.
pub(crate) fn has_triangles(body: &Body) -> bool {
    body.has_self_contact() && body.settings.self_contact == SelfContact::Triangles
}

/// A particle of an island: its body, and its slot there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Corner {
    pub body: u32,
    pub slot: u32,
}

impl Corner {
    /// Its position relative to `origin`.
    #[inline]
    pub fn position(self, bodies: &[Body], origin: Vec3) -> Vec3 {
        let particles = &bodies[self.body as usize].particles;
        particles.position.get(self.slot as usize) + (particles.origin - origin)
    }

    /// Its position relative to `origin` when the substep began.
    #[inline]
    pub fn start(self, bodies: &[Body], origin: Vec3) -> Vec3 {
        let (body, slot) = (&bodies[self.body as usize], self.slot as usize);
        let start = body.context.integrated.get(slot) - body.particles.displacement.get(slot);
        start + (body.particles.origin - origin)
    }

    #[inline]
    pub fn inverse_mass(self, bodies: &[Body]) -> f32 {
        bodies[self.body as usize].particles.inverse_mass[self.slot as usize]
    }

    /// Moves it in position only, without a velocity.
    #[inline]
    pub fn shift(self, bodies: &mut [Body], way: Vec3) {
        let (body, slot) = (&mut bodies[self.body as usize], self.slot as usize);
        body.particles.position.add(slot, way);
        body.context.integrated.add(slot, way);
    }
}

/// A contact of `N` particles: the normal points from those of negative weight to those of positive.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClothContact<const N: usize> {
    pub corners: [Corner; N],
    /// Weights of the two nearest points, those of the second negative: they sum to zero.
    weights: [f32; N],
    /// Sum of the two thicknesses, in metres.
    pub apart: f32,
    normal: Vec3,
    /// Depth that motion made, summed over the projections, in metres.
    depth: f32,
    overlap: InitialOverlap,
}

/// The geometry of two parts that are nearer than they may be.
pub(crate) struct Penetration<const N: usize> {
    pub weights: [f32; N],
    pub normal: Vec3,
    /// Penetration depth in metres, above zero.
    pub depth: f32,
    /// Metres that the two have moved apart along the normal in this substep so far.
    pub outward: f32,
    /// The overlap at the start of the substep in metres, negative if there was none.
    pub at_start: f32,
}

impl<const N: usize> ClothContact<N> {
    pub fn new(corners: [Corner; N], apart: f32) -> Self {
        Self {
            corners,
            weights: [0.0; N],
            apart,
            normal: Vec3::ZERO,
            depth: 0.0,
            overlap: InitialOverlap::default(),
        }
    }

    /// The two bodies, if there are two and they were pushed apart.
    pub fn pushed_bodies(&self) -> Option<([(usize, usize); 2], Vec3, f32)> {
        let by_weight = |a: &usize, b: &usize| self.weights[*a].total_cmp(&self.weights[*b]);
        let ends = [(0..N).max_by(by_weight)?, (0..N).min_by(by_weight)?];
        let [first, second] = ends.map(|k| (self.corners[k].body as usize, self.corners[k].slot as usize));
        (self.depth > 0.0 && first.0 != second.0).then_some(([first, second], self.normal, self.depth))
    }

    /// Moves the corners apart: each by its weight and inverse mass, so that momentum is kept.
    pub fn push(&mut self, bodies: &mut [Body], rate: PushOutRate, found: Penetration<N>) {
        let Penetration { weights, normal, depth, outward, at_start } = found;
        let masses = self.corners.map(|corner| corner.inverse_mass(bodies));
        let total = effective_inverse_mass(weights, masses);
        if total == 0.0 {
            return;
        }
        let push = self.overlap.split(depth, outward, || at_start, rate);
        (self.weights, self.normal) = (weights, normal);
        self.depth += push.with_velocity;
        let [with_velocity, position_only] =
            [push.with_velocity, push.position_only].map(|way| normal * (way / total));
        for ((corner, weight), mass) in self.corners.into_iter().zip(weights).zip(masses) {
            let share = weight * mass;
            // The displacement resolves finer steps than the position, so the push is added to both: momentum is kept.
            let (body, slot) = (&mut bodies[corner.body as usize], corner.slot as usize);
            body.particles.displacement.add(slot, with_velocity * share);
            corner.shift(bodies, (with_velocity + position_only) * share);
        }
    }

    /// Friction: shortens the slip of this substep.
    pub fn apply_friction(&self, bodies: &mut [Body]) {
        if self.depth == 0.0 {
            return;
        }
        let rough = |corner: Corner| bodies[corner.body as usize].settings.surface_friction();
        let friction = rough(self.corners[0]).with(rough(self.corners[N - 1]));
        let mut slip = Vec3::ZERO;
        for (corner, weight) in self.corners.into_iter().zip(self.weights) {
            let particles = &bodies[corner.body as usize].particles;
            slip += particles.displacement.get(corner.slot as usize) * weight;
        }
        let masses = self.corners.map(|corner| corner.inverse_mass(bodies));
        let push =
            friction.slip_taken(slip, self.normal, self.depth) / effective_inverse_mass(self.weights, masses);
        for (corner, weight) in self.corners.into_iter().zip(self.weights) {
            let particles = &mut bodies[corner.body as usize].particles;
            let share = -weight * particles.inverse_mass[corner.slot as usize];
            particles.displacement.add(corner.slot as usize, push * share);
            particles.position.add(corner.slot as usize, push * share);
        }
    }
}
