//! What a body that flies past a shape runs into first: parry's shape cast, for every shape.

use glam::Vec3;
use parry3d::math::Pose as ParryPose;
use parry3d::query::{ShapeCastHit, ShapeCastOptions, cast_shapes};
use parry3d::shape::{Ball, Capsule, Cuboid, Segment, Shape as ParryShape, Triangle};

use crate::geometry::nearest::FaceOrEdge;
use crate::geometry::shape::{Plane, Shape};

/// Where two bodies meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SweepHit {
    /// The part of the way until then, above 0 and at most 1.
    pub fraction: f32,
    /// On the surface of the shape.
    pub point: Vec3,
    /// The surface there.
    pub plane: Plane,
}

impl Shape {
    /// Where a ball that flies from `start` by `way` first meets the shape. Not for a ball that is inside.
    pub(crate) fn sweep_ball(&self, radius: f32, start: Vec3, way: Vec3) -> Option<SweepHit> {
        match self {
            Self::Compound(compound) => compound.sweep_ball(radius, start, way),
            _ => self.sweep(&Ball::new(radius), start, way),
        }
    }

    /// Where a triangle or a segment that flies by `way` first meets the shape.
    pub(crate) fn sweep_piece(&self, piece: FaceOrEdge, way: Vec3) -> Option<SweepHit> {
        match (self, piece) {
            (Self::Compound(compound), _) => compound.sweep_piece(piece, way),
            (_, FaceOrEdge::Triangle([a, b, c])) => {
                self.sweep(&Triangle::new(Vec3::ZERO, b - a, c - a), a, way)
            }
            (_, FaceOrEdge::Segment([a, b])) => self.sweep(&Segment::new(Vec3::ZERO, b - a), a, way),
        }
    }

    /// `moving` is relative to `start`. Shapes without end have no other side to get to, and are met without this.
    fn sweep(&self, moving: &dyn ParryShape, start: Vec3, way: Vec3) -> Option<SweepHit> {
        match self {
            Self::HalfSpace { .. } | Self::Container { .. } | Self::Compound(_) => None,
            Self::Sphere { radius } => cast(&Ball::new(*radius), moving, start, way),
            Self::Capsule { half_length, radius } => {
                cast(&Capsule::new_y(*half_length, *radius), moving, start, way)
            }
            Self::Cuboid { half_extents } => cast(&Cuboid::new(*half_extents), moving, start, way),
            Self::Mesh(mesh) => cast(mesh.triangles(), moving, start, way),
            Self::Parry(shape) => cast(&*shape.0, moving, start, way),
        }
    }
}

fn cast(shape: &dyn ParryShape, moving: &dyn ParryShape, start: Vec3, way: Vec3) -> Option<SweepHit> {
    let options = ShapeCastOptions {
        max_time_of_impact: 1.0,
        stop_at_penetration: false,
        // What touches already is met without this; and to know its depth costs memory.
        compute_impact_geometry_on_penetration: false,
        ..ShapeCastOptions::default()
    };
    let at = ParryPose::from_translation(start);
    let hit = cast_shapes(&ParryPose::IDENTITY, Vec3::ZERO, shape, &at, way, moving, options).ok()??;
    let ShapeCastHit { time_of_impact: fraction, witness1: point, normal1: normal, .. } = hit;
    let is_hit = fraction > 0.0 && point.is_finite() && normal.dot(way) < 0.0;
    is_hit.then(|| SweepHit { fraction, point, plane: Plane { normal, offset: normal.dot(point) } })
}
