//! First hit of a moving ball, triangle or segment on a shape: parry's shape cast, for every shape but
//! the tapered capsule.
//!
//! Design: `docs/design/obstacles.md`.

use glam::Vec3;
use parry3d::math::Pose as ParryPose;
use parry3d::query::{ShapeCastHit, ShapeCastOptions, cast_shapes};
use parry3d::shape::{Ball, Capsule, Cuboid, Segment, Shape as ParryShape, Triangle};

use crate::constants::SURFACE_NOISE;
use crate::geometry::approach::first_touch;
use crate::geometry::nearest::{FaceOrEdge, Nearest};
use crate::geometry::shape::{Plane, Shape};

/// The first hit of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SweepHit {
    /// Fraction of the path before the hit, above 0 and at most 1.
    pub fraction: f32,
    /// Point of the hit, on the surface of the shape.
    pub point: Vec3,
    /// The surface there.
    pub plane: Plane,
}

impl Shape {
    /// First hit of a ball that moves from `start` by `path`. Not for a ball that is inside.
    pub(crate) fn sweep_ball(&self, radius: f32, start: Vec3, path: Vec3) -> Option<SweepHit> {
        match self {
            Self::Compound(compound) => compound.sweep_ball(radius, start, path),
            Self::TaperedCapsule { .. } => {
                let (fraction, normal) = self.approach_of_ball(radius, start, path)?;
                SweepHit::on_surface(fraction, start + path * fraction - normal * radius, normal)
            }
            _ => self.sweep(&Ball::new(radius), start, path),
        }
    }

    /// First hit of a triangle or segment that moves by `path`.
    pub(crate) fn sweep_piece(&self, piece: FaceOrEdge, path: Vec3) -> Option<SweepHit> {
        match (self, piece) {
            (Self::Compound(compound), _) => compound.sweep_piece(piece, path),
            (Self::TaperedCapsule { .. }, _) => {
                let nearest = |fraction: f32| {
                    let there = piece.map(|corner| corner + path * fraction);
                    let Nearest::At(_, point) = self.nearest_on(there, path.length()) else { return None };
                    Some((point, self.surface(point)))
                };
                let gap = |fraction| nearest(fraction).map(|(_, surface)| (surface.distance, surface.normal));
                let (fraction, normal) = first_touch(path, self.noise(path), gap)?;
                let (point, _) = nearest(fraction)?;
                SweepHit::on_surface(fraction, point, normal)
            }
            (_, FaceOrEdge::Triangle([a, b, c])) => {
                self.sweep(&Triangle::new(Vec3::ZERO, b - a, c - a), a, path)
            }
            (_, FaceOrEdge::Segment([a, b])) => self.sweep(&Segment::new(Vec3::ZERO, b - a), a, path),
        }
    }

    /// First touch of a ball, of a convex shape with a formula: fraction of the path, and unit normal.
    pub(crate) fn approach_of_ball(&self, radius: f32, start: Vec3, path: Vec3) -> Option<(f32, Vec3)> {
        let gap = |fraction: f32| {
            let surface = self.surface(start + path * fraction);
            Some((surface.distance - radius, surface.normal))
        };
        first_touch(path, self.noise(path), gap)
    }

    /// Distance in metres that may be rounding, on this path.
    fn noise(&self, path: Vec3) -> f32 {
        let (low, high) = self.local_bounds();
        SURFACE_NOISE * (high - low).max_element().max(path.length())
    }

    /// `moving` is relative to `start`. None for unbounded shapes, which have no other side to get to.
    fn sweep(&self, moving: &dyn ParryShape, start: Vec3, path: Vec3) -> Option<SweepHit> {
        match self {
            Self::HalfSpace { .. }
            | Self::Container { .. }
            | Self::Compound(_)
            | Self::TaperedCapsule { .. } => None,
            Self::Sphere { radius } => cast(&Ball::new(*radius), moving, start, path),
            Self::Capsule { half_length, radius } => {
                cast(&Capsule::new_y(*half_length, *radius), moving, start, path)
            }
            Self::Cuboid { half_extents } => cast(&Cuboid::new(*half_extents), moving, start, path),
            Self::Mesh(mesh) => cast(mesh.triangles(), moving, start, path),
            Self::Parry(shape) => cast(&*shape.0, moving, start, path),
        }
    }
}

impl SweepHit {
    /// A hit after the start of the path.
    fn on_surface(fraction: f32, point: Vec3, normal: Vec3) -> Option<Self> {
        let plane = Plane { normal, offset: normal.dot(point) };
        (fraction > 0.0).then_some(Self { fraction, point, plane })
    }
}

fn cast(shape: &dyn ParryShape, moving: &dyn ParryShape, start: Vec3, path: Vec3) -> Option<SweepHit> {
    let options = ShapeCastOptions {
        max_time_of_impact: 1.0,
        stop_at_penetration: false,
        // Contacts at the start are found without a sweep, and their depth would cost memory.
        compute_impact_geometry_on_penetration: false,
        ..ShapeCastOptions::default()
    };
    let at = ParryPose::from_translation(start);
    let hit = cast_shapes(&ParryPose::IDENTITY, Vec3::ZERO, shape, &at, path, moving, options).ok()??;
    let ShapeCastHit { time_of_impact: fraction, witness1: point, normal1: normal, .. } = hit;
    let is_hit = fraction > 0.0 && point.is_finite() && normal.dot(path) < 0.0;
    is_hit.then(|| SweepHit { fraction, point, plane: Plane { normal, offset: normal.dot(point) } })
}
