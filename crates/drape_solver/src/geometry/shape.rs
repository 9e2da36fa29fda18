//! Shapes of obstacles, and their distance from points.
//!
//! Common shapes have formulas here, as the solver queries them millions of times a second; other shapes use parry's
//! point query.
//!
//! Design: `docs/design/obstacles.md`.

use std::sync::Arc;

use glam::Vec3;
use parry3d::bounding_volume::Aabb;
use parry3d::math::Pose as ParryPose;
use parry3d::query::{Ray, RayCast};
use parry3d::shape::{Ball, Capsule, Cuboid, SharedShape};

use crate::error::{BuildError, finite_vector, positive};
use crate::geometry::compound::CompoundShape;
use crate::geometry::mesh::MeshShape;
use crate::geometry::parry_surface::{is_meant_to_be_solid, is_upright, parry_surface};
use crate::geometry::pose::Placement;
use crate::geometry::taper::{Taper, scaled_hull};

/// Corners around a round shape that an uneven scale turns into a convex hull.
const SCALED_SUBDIVISIONS: u32 = 24;

const NO_EXTENT: &str = "it has no extent at this scale";

/// The form of an obstacle, in its own coordinates.
#[derive(Clone)]
pub enum Shape {
    /// Everything below the plane through the origin with this outward normal (unit length).
    HalfSpace {
        /// Points out of the solid.
        normal: Vec3,
    },
    /// A ball about the origin.
    Sphere {
        /// Radius in metres.
        radius: f32,
    },
    /// All points within `radius` of a segment on the Y axis.
    Capsule {
        /// Half the length of the segment in metres.
        half_length: f32,
        /// Radius in metres.
        radius: f32,
    },
    /// The convex hull of two spheres on the Y axis, one `half_length` below the origin, the other as far above. Where one
    /// holds the other, it is that sphere.
    TaperedCapsule {
        /// Half the distance of the spheres' centres in metres.
        half_length: f32,
        /// Radius of the lower sphere in metres.
        bottom_radius: f32,
        /// Radius of the upper sphere in metres.
        top_radius: f32,
    },
    /// A box about the origin.
    Cuboid {
        /// Half the sides in metres.
        half_extents: Vec3,
    },
    /// The inside of a box, which keeps everything within it.
    Container {
        /// Half the sides in metres.
        half_extents: Vec3,
    },
    /// Triangles: a mesh, a height field or voxels.
    Mesh(Arc<MeshShape>),
    /// Several shapes as one.
    Compound(Arc<CompoundShape>),
    /// Any other parry shape, by its point query.
    Parry(SharedShape),
}

impl core::fmt::Debug for Shape {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::HalfSpace { normal } => write!(f, "HalfSpace({normal})"),
            Self::Sphere { radius } => write!(f, "Sphere({radius})"),
            Self::Capsule { half_length, radius } => write!(f, "Capsule({half_length}, {radius})"),
            Self::TaperedCapsule { half_length, bottom_radius, top_radius } => {
                write!(f, "TaperedCapsule({half_length}, {bottom_radius}, {top_radius})")
            }
            Self::Cuboid { half_extents } => write!(f, "Cuboid({half_extents})"),
            Self::Container { half_extents } => write!(f, "Container({half_extents})"),
            Self::Mesh(_) => write!(f, "Mesh"),
            Self::Compound(compound) => write!(f, "{compound:?}"),
            Self::Parry(shape) => write!(f, "Parry({:?})", shape.shape_type()),
        }
    }
}

/// The nearest point of a surface, as seen from a point: `distance` is negative inside, `normal` (unit) points
/// out of the solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surface {
    pub distance: f32,
    pub normal: Vec3,
}

impl Surface {
    /// The surface as a plane, at the same `point` for which it was found.
    pub fn plane_at(self, point: Vec3) -> Plane {
        Plane { normal: self.normal, offset: self.normal.dot(point) - self.distance }
    }
}

impl Shape {
    /// The surface next to a point: `plane` if one is given, else that of the shape.
    pub(crate) fn surface_or(&self, plane: Option<Plane>, point: Vec3) -> Surface {
        match plane {
            Some(plane) => plane.surface(point),
            None => self.surface(point),
        }
    }

    /// Converts a parry shape; common ones become shapes with a formula.
    ///
    /// The inside of a closed triangle mesh is solid, however its triangles are wound; an open one is a thin sheet.
    /// Everything below a height field is solid.
    ///
    /// # Errors
    /// [`BuildError`] if a size is not above zero or not finite, or if the shape has no surface.
    pub fn from_parry(shape: SharedShape) -> Result<Self, BuildError> {
        let own = if let Some(ball) = shape.as_ball() {
            Self::Sphere { radius: ball.radius }
        } else if let Some(cuboid) = shape.as_cuboid() {
            Self::Cuboid { half_extents: Vec3::from(cuboid.half_extents.to_array()) }
        } else if let Some(half_space) = shape.as_halfspace() {
            Self::HalfSpace { normal: half_space.normal }
        } else if let Some(capsule) = shape.as_capsule().filter(|capsule| is_upright(capsule)) {
            Self::Capsule { half_length: capsule.half_height(), radius: capsule.radius }
        } else if let Some(mesh) = shape.as_trimesh() {
            Self::Mesh(MeshShape::of_mesh(mesh)?.into())
        } else if let Some(hull) = shape.as_convex_polyhedron() {
            Self::Mesh(MeshShape::of_hull(hull)?.into())
        } else if let Some(field) = shape.as_heightfield() {
            Self::Mesh(MeshShape::of_height_field(field)?.into())
        } else if let Some(voxels) = shape.as_voxels() {
            Self::Mesh(MeshShape::of_voxels(voxels)?.into())
        } else if let Some(compound) = shape.as_compound() {
            Self::Compound(CompoundShape::of_compound(compound)?.into())
        } else {
            Self::Parry(shape)
        };
        own.validate()?;
        Ok(own)
    }

    /// Several shapes as one, each at its place. A single shape at the origin stays as it is.
    ///
    /// # Errors
    /// [`BuildError`] if there is none, or one without end, such as a half-space.
    pub fn compound(parts: Vec<(Self, Placement)>) -> Result<Self, BuildError> {
        match &parts[..] {
            [(only, place)] if *place == Placement::default() => Ok(only.clone()),
            _ => Ok(Self::Compound(CompoundShape::of_parts(parts)?.into())),
        }
    }

    /// The shape scaled by `scale` along its axes, and checked as by [`from_parry`](Self::from_parry). A round shape
    /// that would become an ellipsoid becomes a convex hull of one.
    ///
    /// # Errors
    /// [`BuildError`] if the result cannot be used.
    pub fn scaled(&self, scale: Vec3) -> Result<Self, BuildError> {
        for factor in scale.to_array() {
            positive("scale", factor)?;
        }
        self.validate()?;
        let shape = match self {
            Self::Parry(shape) if scale == Vec3::ONE => return Self::from_parry(shape.clone()),
            _ if scale == Vec3::ONE => return Ok(self.clone()),
            // A plane through the origin changes only its slope.
            Self::HalfSpace { normal } => {
                let normal = (*normal / scale).try_normalize().unwrap_or(*normal);
                return Ok(Self::HalfSpace { normal });
            }
            Self::Container { half_extents } => {
                return Ok(Self::Container { half_extents: *half_extents * scale });
            }
            Self::Cuboid { half_extents } => {
                return Ok(Self::Cuboid { half_extents: *half_extents * scale });
            }
            Self::Sphere { radius } if scale == Vec3::splat(scale.x) => {
                return Ok(Self::Sphere { radius: radius * scale.x });
            }
            Self::Capsule { half_length, radius } if scale.x == scale.z && scale.x == scale.y => {
                return Ok(Self::Capsule { half_length: half_length * scale.x, radius: radius * scale.x });
            }
            &Self::TaperedCapsule { half_length, bottom_radius, top_radius } => {
                if scale == Vec3::splat(scale.x) {
                    let [half_length, bottom_radius, top_radius] =
                        [half_length, bottom_radius, top_radius].map(|length| length * scale.x);
                    return Ok(Self::TaperedCapsule { half_length, bottom_radius, top_radius });
                }
                let balls = [(-half_length, bottom_radius), (half_length, top_radius)];
                let hull = scaled_hull(balls, scale, SCALED_SUBDIVISIONS);
                return Self::from_parry(hull.ok_or(BuildError::BadShape { reason: NO_EXTENT })?);
            }
            Self::Mesh(mesh) => {
                let scaled = Self::Mesh(mesh.scaled(scale).into());
                scaled.validate()?;
                return Ok(scaled);
            }
            Self::Compound(compound) => return Ok(Self::Compound(compound.scaled(scale)?.into())),
            Self::Sphere { radius } => SharedShape::ball(*radius),
            Self::Capsule { half_length, radius } => SharedShape::capsule_y(*half_length, *radius),
            Self::Parry(shape) => shape.clone(),
        };
        let scaled = shape.scale_dyn(scale, SCALED_SUBDIVISIONS);
        let scaled = scaled.ok_or(BuildError::BadShape { reason: NO_EXTENT })?;
        Self::from_parry(SharedShape(scaled.into()))
    }

    /// Checks sizes and normals.
    ///
    /// # Errors
    /// [`BuildError`] naming the field at fault.
    pub fn validate(&self) -> Result<(), BuildError> {
        match self {
            Self::HalfSpace { normal } => {
                finite_vector("normal", *normal)?;
                if (normal.length_squared() - 1.0).abs() > 1e-3 {
                    return Err(BuildError::BadShape { reason: "the normal is not of unit length" });
                }
            }
            Self::Sphere { radius } => {
                positive("radius", *radius)?;
            }
            Self::Capsule { half_length, radius } => {
                positive("half_length", *half_length)?;
                positive("radius", *radius)?;
            }
            Self::TaperedCapsule { half_length, bottom_radius, top_radius } => {
                positive("half_length", *half_length)?;
                positive("bottom_radius", *bottom_radius)?;
                positive("top_radius", *top_radius)?;
            }
            Self::Cuboid { half_extents } | Self::Container { half_extents } => {
                for side in half_extents.to_array() {
                    positive("half_extents", side)?;
                }
            }
            Self::Mesh(_) | Self::Compound(_) | Self::Parry(_) => {
                let (low, high) = self.local_bounds();
                if !(low.is_finite() && high.is_finite()) {
                    return Err(BuildError::BadShape { reason: "its bounds are not finite" });
                }
                if low == high {
                    return Err(BuildError::BadShape { reason: "it has no extent" });
                }
                let is_flat = !low.cmplt(high).all();
                if is_flat && matches!(self, Self::Parry(shape) if is_meant_to_be_solid(shape)) {
                    return Err(BuildError::BadShape { reason: "it is flat" });
                }
            }
        }
        Ok(())
    }

    /// Distance in metres of `point`, in the shape's own coordinates, from its surface; negative inside.
    pub fn distance(&self, point: Vec3) -> f32 {
        self.surface(point).distance
    }

    /// The surface nearest to `point`, in the shape's own coordinates. [`Shape::Container`] has six: see
    /// [`container_walls`].
    pub(crate) fn surface(&self, point: Vec3) -> Surface {
        match self {
            Self::HalfSpace { normal } => Surface { distance: normal.dot(point), normal: *normal },
            Self::Sphere { radius } => from_core(point, *radius),
            Self::Capsule { half_length, radius } => {
                let on_axis = Vec3::Y * point.y.clamp(-half_length, *half_length);
                from_core(point - on_axis, *radius)
            }
            Self::TaperedCapsule { half_length, bottom_radius, top_radius } => {
                let (from_axis, radius) = Taper::new(*half_length, *bottom_radius, *top_radius).core(point);
                from_core(from_axis, radius)
            }
            Self::Cuboid { half_extents } => cuboid_surface(point, *half_extents),
            Self::Container { half_extents } => {
                let walls = container_walls(*half_extents).map(|wall| wall.surface(point));
                let nearest = walls.into_iter().min_by(|a, b| a.distance.total_cmp(&b.distance));
                nearest.unwrap_or(walls[0])
            }
            Self::Mesh(mesh) => mesh.surface(point),
            Self::Compound(compound) => compound.surface(point),
            Self::Parry(shape) => parry_surface(shape, point),
        }
    }

    /// Half the least thickness in metres that a particle must cross to pass through the shape.
    pub(crate) fn least_half_extent(&self) -> f32 {
        match self {
            Self::HalfSpace { .. } | Self::Container { .. } => f32::INFINITY,
            Self::Sphere { radius } | Self::Capsule { radius, .. } => *radius,
            Self::TaperedCapsule { half_length, bottom_radius, top_radius } => {
                Taper::new(*half_length, *bottom_radius, *top_radius).least_radius()
            }
            Self::Cuboid { half_extents } => half_extents.min_element(),
            Self::Mesh(_) | Self::Compound(_) | Self::Parry(_) => 0.0,
        }
    }

    /// The middle one of the half sides of its bounding box, in metres: small for a ball or a needle, not for a plate.
    pub(crate) fn middle_half_extent(&self) -> f32 {
        let (low, high) = self.local_bounds();
        let half = (high - low) * 0.5;
        half.element_sum() - half.max_element() - half.min_element()
    }

    /// True if it is known to be convex.
    pub(crate) fn is_convex(&self) -> bool {
        match self {
            Self::HalfSpace { .. }
            | Self::Sphere { .. }
            | Self::Capsule { .. }
            | Self::TaperedCapsule { .. }
            | Self::Cuboid { .. } => true,
            Self::Container { .. } | Self::Compound(_) => false,
            Self::Mesh(mesh) => mesh.is_convex(),
            Self::Parry(shape) => shape.is_convex(),
        }
    }

    /// True if a formula gives the surface, cheaply enough for every projection.
    pub(crate) fn has_formula(&self) -> bool {
        !matches!(self, Self::Mesh(_) | Self::Compound(_) | Self::Parry(_))
    }

    /// First hit on the surface on the `path` from `start` (outside): the fraction of the path, 0 to 1, and the unit
    /// normal there. None for unbounded shapes, which have no other side to get to.
    pub(crate) fn cast(&self, start: Vec3, path: Vec3) -> Option<(f32, Vec3)> {
        let ray = Ray::new(start, path);
        let hit = match self {
            Self::HalfSpace { .. } | Self::Container { .. } => None,
            Self::Sphere { radius } => Ball::new(*radius).cast_local_ray_and_get_normal(&ray, 1.0, false),
            Self::Capsule { half_length, radius } => {
                Capsule::new_y(*half_length, *radius).cast_local_ray_and_get_normal(&ray, 1.0, false)
            }
            Self::TaperedCapsule { .. } => return self.approach_of_ball(0.0, start, path),
            Self::Cuboid { half_extents } => {
                Cuboid::new(*half_extents).cast_local_ray_and_get_normal(&ray, 1.0, false)
            }
            Self::Mesh(mesh) => return mesh.cast(start, path),
            Self::Compound(compound) => return compound.cast(start, path),
            Self::Parry(shape) => shape.cast_local_ray_and_get_normal(&ray, 1.0, false),
        };
        hit.filter(|hit| hit.normal.dot(path) < 0.0).map(|hit| (hit.time_of_impact, hit.normal))
    }

    /// Bounding box of the shape, as (least, greatest) corner in its own coordinates; infinite for unbounded shapes.
    pub fn local_bounds(&self) -> (Vec3, Vec3) {
        match self {
            Self::HalfSpace { .. } | Self::Container { .. } => {
                (Vec3::splat(f32::NEG_INFINITY), Vec3::splat(f32::INFINITY))
            }
            Self::Sphere { radius } => (Vec3::splat(-radius), Vec3::splat(*radius)),
            Self::Capsule { half_length, radius } => {
                let half = Vec3::new(*radius, half_length + radius, *radius);
                (-half, half)
            }
            &Self::TaperedCapsule { half_length, bottom_radius, top_radius } => {
                let across = bottom_radius.max(top_radius);
                let low = (-half_length - bottom_radius).min(half_length - top_radius);
                let high = (half_length + top_radius).max(bottom_radius - half_length);
                (Vec3::new(-across, low, -across), Vec3::new(across, high, across))
            }
            Self::Cuboid { half_extents } => (-*half_extents, *half_extents),
            Self::Mesh(mesh) => mesh.bounds(),
            Self::Compound(compound) => compound.bounds(),
            Self::Parry(shape) => {
                let Aabb { mins, maxs } = shape.compute_aabb(&ParryPose::IDENTITY);
                (mins, maxs)
            }
        }
    }
}

/// A plane in an obstacle's own coordinates: points with `normal . p < offset` are inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plane {
    pub normal: Vec3,
    pub offset: f32,
}

impl Plane {
    pub fn surface(self, point: Vec3) -> Surface {
        Surface { distance: self.normal.dot(point) - self.offset, normal: self.normal }
    }
}

/// The six walls of a container, each a plane that faces inwards.
pub(crate) fn container_walls(half_extents: Vec3) -> [Plane; 6] {
    let wall = |normal: Vec3, half: f32| Plane { normal, offset: -half };
    [
        wall(Vec3::X, half_extents.x),
        wall(Vec3::NEG_X, half_extents.x),
        wall(Vec3::Y, half_extents.y),
        wall(Vec3::NEG_Y, half_extents.y),
        wall(Vec3::Z, half_extents.z),
        wall(Vec3::NEG_Z, half_extents.z),
    ]
}

/// The surface at `radius` from a core point, given the vector from that core. At the core itself every direction is as
/// near, and up is taken.
fn from_core(from_core: Vec3, radius: f32) -> Surface {
    let length = from_core.length();
    Surface { distance: length - radius, normal: if length > 0.0 { from_core / length } else { Vec3::Y } }
}

/// ```text
///          outside: to the nearest point of the box
///      x----->+-----------+
///             |   inside: |
///             |       x-->|  out of the nearest face
///             +-----------+
/// ```
fn cuboid_surface(point: Vec3, half: Vec3) -> Surface {
    let beyond = point.abs() - half;
    let outside = beyond.max(Vec3::ZERO);
    let side = |value: f32| if value < 0.0 { -1.0 } else { 1.0 };
    let sign = Vec3::new(side(point.x), side(point.y), side(point.z));
    if outside != Vec3::ZERO {
        let distance = outside.length();
        return Surface { distance, normal: outside * sign / distance };
    }
    if beyond.x >= beyond.y && beyond.x >= beyond.z {
        Surface { distance: beyond.x, normal: Vec3::X * sign.x }
    } else if beyond.y >= beyond.z {
        Surface { distance: beyond.y, normal: Vec3::Y * sign.y }
    } else {
        Surface { distance: beyond.z, normal: Vec3::Z * sign.z }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::miri::unless_miri;

    /// The shapes by hand must agree with parry's, inside and outside. Step 0, the centre, has no one answer.
    #[test]
    fn hand_written_shapes_agree_with_parry() {
        let half = Vec3::new(0.5, 1.0, 2.0);
        let pairs = [
            (Shape::Sphere { radius: 0.7 }, SharedShape::ball(0.7)),
            (Shape::Cuboid { half_extents: half }, SharedShape::cuboid(half.x, half.y, half.z)),
            (Shape::Capsule { half_length: 0.8, radius: 0.3 }, SharedShape::capsule_y(0.8, 0.3)),
            (Shape::HalfSpace { normal: Vec3::Y }, SharedShape::halfspace(Vec3::Y)),
        ];
        for (ours, parrys) in pairs {
            for step in 1..unless_miri(10_000, 30) {
                let spread = |k: f32| libm::sinf(step as f32 * k) * 2.5;
                let point = Vec3::new(spread(0.7), spread(1.3), spread(2.9));
                let (a, b) = (ours.surface(point), parry_surface(&parrys, point));
                assert!((a.distance - b.distance).abs() < 3e-4, "{ours:?} at {point}");
                assert!(a.normal.dot(b.normal) > 0.999, "{ours:?} at {point}");
            }
        }
    }

    #[test]
    fn the_centre_of_a_parry_ball_knows_a_way_out() {
        let shape = Shape::Parry(SharedShape::ball(0.7));
        let surface = shape.surface(Vec3::ZERO);
        assert!((surface.distance + 0.7).abs() < 2e-3);
        assert!((surface.normal.length() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn on_the_surface_itself_the_normal_is_that_of_the_face() {
        let (vertices, indices) = Cuboid::new(Vec3::ONE).to_trimesh();
        let mesh = SharedShape::trimesh(vertices.clone(), indices).expect("a box");
        let hull = SharedShape::convex_hull(&vertices).expect("a box");
        let cylinder = SharedShape::cylinder(1.0, 1.0);
        for shape in [mesh, hull, cylinder] {
            let shape = Shape::from_parry(shape).expect("valid");
            let surface = shape.surface(Vec3::new(0.6, 1.0, 0.3));
            assert!(surface.distance.abs() < 1e-5);
            assert!(surface.normal.dot(Vec3::Y) > 0.999, "{shape:?}: {}", surface.normal);
        }
    }

    #[test]
    fn bad_sizes_are_refused() {
        for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(Shape::Sphere { radius }.validate().is_err());
            assert!(Shape::from_parry(SharedShape::ball(radius)).is_err());
        }
        assert!(Shape::HalfSpace { normal: Vec3::ZERO }.validate().is_err());
        assert!(Shape::Cuboid { half_extents: Vec3::X }.validate().is_err());
    }
}
