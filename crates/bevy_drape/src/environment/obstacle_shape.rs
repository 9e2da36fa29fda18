//! Shapes of obstacles.

use bevy::prelude::*;
use drape_solver::error::positive;
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::{BuildError, Shape};

/// Shape of an [`Obstacle`](crate::environment::obstacle::Obstacle) about the entity's origin, scaled by its [`Transform`].
/// Lengths are in metres and above 0.
#[derive(Reflect, Clone, Debug)]
#[reflect(Default, Debug, Clone)]
#[non_exhaustive]
pub enum ObstacleShape {
    /// Everything below the plane through the origin.
    HalfSpace {
        /// Outward normal, of unit length.
        normal: Vec3,
    },
    /// A ball.
    Sphere {
        /// Radius.
        radius: f32,
    },
    /// All points within `radius` of a segment on the Y axis.
    Capsule {
        /// Radius.
        radius: f32,
        /// Length of the segment.
        length: f32,
    },
    /// The convex hull of two balls on the Y axis, with their middle at the origin. Where one holds the other, it is that ball.
    TaperedCapsule {
        /// Radius of the lower ball.
        bottom_radius: f32,
        /// Radius of the upper ball.
        top_radius: f32,
        /// Distance of their centres.
        length: f32,
    },
    /// A box.
    Cuboid {
        /// Sides.
        size: Vec3,
    },
    /// A cylinder along the Y axis.
    Cylinder {
        /// Radius.
        radius: f32,
        /// Distance of its ends.
        height: f32,
    },
    /// A cone along the Y axis, with its tip up. The origin is halfway up.
    Cone {
        /// Radius of its base.
        radius: f32,
        /// Distance of its tip from its base.
        height: f32,
    },
    /// The inside of a box. Nothing leaves it.
    Container {
        /// Sides.
        size: Vec3,
    },
    /// The triangles of the entity's [`Mesh3d`], once it has loaded. The inside of a closed mesh is solid; an open mesh is a
    /// thin sheet. Needs the feature `mesh`, without which no mesh is looked at.
    TriMesh,
    /// The convex hull of the entity's [`Mesh3d`], once it has loaded. Needs the feature `mesh`, too.
    ConvexHull,
    /// Any other shape, such as one of parry's.
    Custom(CustomShape),
}

/// A shape made in code.
#[derive(Reflect, Clone, Debug, Deref)]
#[reflect(opaque)]
#[reflect(Debug, Clone)]
pub struct CustomShape(pub Shape);

/// The shape that an obstacle has got from its [`Mesh3d`], without the scale of its [`Transform`]. Present once the mesh has
/// loaded.
#[derive(Component, Reflect, Clone, Debug, Deref)]
#[reflect(opaque)]
#[reflect(Component, Debug, Clone)]
pub struct ShapeFromMesh(pub(crate) Shape);

impl Default for ObstacleShape {
    /// A box with sides of one metre, as is Bevy's [`Cuboid`].
    fn default() -> Self {
        Self::Cuboid { size: Vec3::ONE }
    }
}

impl From<Shape> for ObstacleShape {
    fn from(shape: Shape) -> Self {
        match shape {
            Shape::HalfSpace { normal } => Self::HalfSpace { normal },
            Shape::Sphere { radius } => Self::Sphere { radius },
            Shape::Capsule { half_length, radius } => Self::Capsule { radius, length: 2.0 * half_length },
            Shape::TaperedCapsule { half_length, bottom_radius, top_radius } => {
                Self::TaperedCapsule { bottom_radius, top_radius, length: 2.0 * half_length }
            }
            Shape::Cuboid { half_extents } => Self::Cuboid { size: 2.0 * half_extents },
            Shape::Container { half_extents } => Self::Container { size: 2.0 * half_extents },
            other => Self::Custom(CustomShape(other)),
        }
    }
}

impl From<SharedShape> for ObstacleShape {
    fn from(shape: SharedShape) -> Self {
        Self::Custom(CustomShape(Shape::Parry(shape)))
    }
}

impl ObstacleShape {
    /// True if the entity's mesh gives the shape.
    pub fn is_from_mesh(&self) -> bool {
        matches!(self, Self::TriMesh | Self::ConvexHull)
    }

    /// The solver's shape, without the scale of the [`Transform`]; none while its mesh has not loaded.
    ///
    /// # Errors
    /// [`BuildError`] naming the field that is not above 0 or not finite.
    pub fn solid(&self, from_mesh: Option<&ShapeFromMesh>) -> Result<Option<Shape>, BuildError> {
        Ok(Some(match *self {
            Self::HalfSpace { normal } => Shape::HalfSpace { normal },
            Self::Sphere { radius } => Shape::Sphere { radius: positive("radius", radius)? },
            Self::Capsule { radius, length: segment } => Shape::Capsule {
                half_length: 0.5 * positive("length", segment)?,
                radius: positive("radius", radius)?,
            },
            Self::TaperedCapsule { bottom_radius, top_radius, length: segment } => Shape::TaperedCapsule {
                half_length: 0.5 * positive("length", segment)?,
                bottom_radius: positive("bottom_radius", bottom_radius)?,
                top_radius: positive("top_radius", top_radius)?,
            },
            Self::Cuboid { size } => Shape::Cuboid { half_extents: half_extents(size)? },
            Self::Container { size } => Shape::Container { half_extents: half_extents(size)? },
            Self::Cylinder { radius, height } => {
                let (radius, height) = (positive("radius", radius)?, positive("height", height)?);
                Shape::Parry(SharedShape::cylinder(0.5 * height, radius))
            }
            Self::Cone { radius, height } => {
                let (radius, height) = (positive("radius", radius)?, positive("height", height)?);
                Shape::Parry(SharedShape::cone(0.5 * height, radius))
            }
            Self::TriMesh | Self::ConvexHull => return Ok(from_mesh.map(|shape| shape.0.clone())),
            Self::Custom(CustomShape(ref shape)) => shape.clone(),
        }))
    }
}

fn half_extents(size: Vec3) -> Result<Vec3, BuildError> {
    for side in size.to_array() {
        positive("size", side)?;
    }
    Ok(0.5 * size)
}
