//! The surfaces of parry's shapes, by its point query.
//!
//! Design: `docs/design/obstacles.md`.

use glam::Vec3;
use parry3d::query::PointProjection;
use parry3d::shape::{Capsule, ShapeType, SharedShape};

use crate::constants::SURFACE_NOISE;
use crate::geometry::shape::{Shape, Surface};

/// Distance in metres at which parry is asked again beside a point that it cannot project well: too small to be seen.
const BESIDE: f32 = 1.0e-3;

pub(crate) fn parry_surface(shape: &SharedShape, point: Vec3) -> Surface {
    let mut projection = parry_projection(shape, point);
    if !projection.point.is_finite() {
        // At its centre a parry ball divides zero by zero; any point beside it has a direction.
        projection = parry_projection(shape, point + Vec3::Y * BESIDE);
    }
    let out = if projection.is_inside { projection.point - point } else { point - projection.point };
    let length = out.length();
    let distance = if projection.is_inside { -length } else { length };
    let normal =
        if length > SURFACE_NOISE * point.length() { out / length } else { normal_on_surface(shape, point) };
    Surface { distance, normal }
}

/// The normal at a `point` on the surface itself, where the direction to the surface is lost in rounding.
fn normal_on_surface(shape: &SharedShape, point: Vec3) -> Vec3 {
    // A point a little farther out has a direction again.
    let outwards = (point - shape.compute_local_aabb().center()).try_normalize().unwrap_or(Vec3::Y);
    let farther = point + outwards * BESIDE;
    let projection = parry_projection(shape, farther);
    let out = if projection.is_inside { projection.point - farther } else { farther - projection.point };
    out.try_normalize().unwrap_or(outwards)
}

fn parry_projection(shape: &SharedShape, point: Vec3) -> PointProjection {
    shape.project_local_point(point, false)
}

/// True if the capsule is on the Y axis, with its middle at the origin, like that of [`Shape`](crate::Shape).
pub(crate) fn is_upright(capsule: &Capsule) -> bool {
    let (a, b) = (capsule.segment.a, capsule.segment.b);
    a == -b && a.x == 0.0 && a.z == 0.0 && a.y != 0.0
}

impl Shape {
    /// True if it has an inside, where its [`distance`](Self::distance) is negative: if it is no open mesh, triangle or line, and holds none.
    pub fn is_solid(&self) -> bool {
        use ShapeType as T;
        match self {
            Self::Mesh(mesh) => mesh.is_solid(),
            Self::Compound(compound) => compound.is_solid(),
            Self::Parry(shape) => !matches!(shape.shape_type(), T::Segment | T::Triangle | T::Polyline),
            _ => true,
        }
    }

    /// True if it is a height field, or holds one: all below is solid within the field's sides, however deep.
    pub fn is_bottomless(&self) -> bool {
        match self {
            Self::Mesh(mesh) => mesh.is_bottomless(),
            Self::Compound(compound) => compound.parts().any(|(part, _)| part.is_bottomless()),
            _ => false,
        }
    }
}

/// True if the shape must have a thickness.
pub(crate) fn is_meant_to_be_solid(shape: &SharedShape) -> bool {
    use ShapeType as T;
    matches!(shape.shape_type(), T::Capsule | T::Cylinder | T::Cone | T::ConvexPolyhedron)
}
