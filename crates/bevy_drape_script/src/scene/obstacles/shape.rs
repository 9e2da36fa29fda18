//! Shapes of obstacles.

use bevy::prelude::*;
use bevy_drape::drape_solver::parry3d::math::IVector;
use bevy_drape::drape_solver::parry3d::shape::{SharedShape, TriMeshFlags};
use bevy_drape::drape_solver::parry3d::utils::Array2;
use bevy_drape::drape_solver::{self, BuildError, Placement};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::bracketed;
use crate::scene::{Number, Positive, Turn, Vector};

/// The greatest number of voxel cubes, and their greatest distance from the origin, in cubes.
const MOST_CUBES: usize = 65_536;
const FARTHEST_CUBE: u32 = 10_000;

/// The shape of an obstacle, about its own origin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Shape {
    /// Everything below the obstacle's XZ plane.
    Ground,
    /// Everything behind a plane.
    HalfSpace {
        /// Points out of the solid, of any length but zero.
        normal: Vector,
    },
    /// A sphere.
    Sphere {
        /// Radius in metres.
        radius: Positive,
    },
    /// All points within a radius of a segment on the Y axis.
    Capsule {
        /// Radius in metres.
        radius: Positive,
        /// Length of the segment in metres.
        length: Positive,
    },
    /// The convex hull of two balls on the Y axis.
    TaperedCapsule {
        /// Radius of the lower ball in metres.
        bottom_radius: Positive,
        /// Radius of the upper ball in metres.
        top_radius: Positive,
        /// Distance of their centres in metres.
        length: Positive,
    },
    /// A box.
    Cuboid {
        /// Its sides in metres.
        #[serde(deserialize_with = "bracketed")]
        size: (Positive, Positive, Positive),
    },
    /// The inside of a box, which keeps everything in.
    Container {
        /// Its sides in metres.
        #[serde(deserialize_with = "bracketed")]
        size: (Positive, Positive, Positive),
    },
    /// A cylinder along the Y axis.
    Cylinder {
        /// Radius in metres.
        radius: Positive,
        /// Height in metres.
        height: Positive,
    },
    /// A cone along the Y axis, its tip up.
    Cone {
        /// Radius of its base in metres.
        radius: Positive,
        /// Height in metres.
        height: Positive,
    },
    /// A box with round edges.
    RoundCuboid {
        /// Its sides in metres, edges included.
        #[serde(deserialize_with = "bracketed")]
        size: (Positive, Positive, Positive),
        /// Radius of its edges in metres.
        radius: Positive,
    },
    /// The convex hull of some points.
    ConvexHull {
        /// At least 4 points in metres.
        points: Vec<Vector>,
    },
    /// Triangles. A closed mesh is solid inside; any other is a thin sheet.
    Mesh {
        /// Corners in metres.
        vertices: Vec<Vector>,
        /// The numbers of their three corners, counted from 0.
        triangles: Vec<[u32; 3]>,
    },
    /// Terrain with heights on a centred grid, solid below.
    HeightField {
        /// Size along X and Z in metres.
        #[serde(deserialize_with = "bracketed")]
        size: (Positive, Positive),
        /// Rows of heights in metres, the first at least Z; each row from least to greatest X. All rows are equally long.
        heights: Vec<Vec<Number>>,
    },
    /// Equal cubes on a grid, as one solid.
    Voxels {
        /// Side of a cube in metres.
        side: Positive,
        /// Coordinates of the cubes. The cube (0, 0, 0) has its least corner at the obstacle's origin.
        cubes: Vec<[i32; 3]>,
    },
    /// Several shapes as one.
    Compound {
        /// The parts.
        parts: Vec<Part>,
    },
}

/// A part of a compound.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Its shape.
    pub shape: Shape,
    /// Position relative to the compound's origin in metres; (0, 0, 0) by default.
    #[serde(default)]
    pub at: Vector,
    /// Rotation; none by default.
    #[serde(default)]
    pub turn: Turn,
}

impl Shape {
    /// The solver's shape.
    ///
    /// # Errors
    /// [`BuildError`] with the reason.
    pub fn build(&self) -> Result<drape_solver::Shape, BuildError> {
        use drape_solver::Shape as Solid;
        let half = |(x, y, z): &(Positive, Positive, Positive)| Vec3::new(x.get(), y.get(), z.get()) * 0.5;
        let shape = match self {
            Self::Ground => Solid::HalfSpace { normal: Vec3::Y },
            Self::HalfSpace { normal } => {
                let normal = normal.try_normalize().ok_or(bad("the normal of a half-space has no length"))?;
                Solid::HalfSpace { normal }
            }
            Self::Sphere { radius } => Solid::Sphere { radius: radius.get() },
            Self::Capsule { radius, length } => {
                Solid::Capsule { half_length: length.get() * 0.5, radius: radius.get() }
            }
            Self::TaperedCapsule { bottom_radius, top_radius, length } => Solid::TaperedCapsule {
                half_length: length.get() * 0.5,
                bottom_radius: bottom_radius.get(),
                top_radius: top_radius.get(),
            },
            Self::Cuboid { size } => Solid::Cuboid { half_extents: half(size) },
            Self::Container { size } => Solid::Container { half_extents: half(size) },
            Self::Compound { parts } if parts.is_empty() => return Err(bad("a compound has no parts")),
            Self::Compound { parts } => {
                Solid::compound(parts.iter().map(Part::build).collect::<Result<_, _>>()?)?
            }
            Self::Cylinder { radius, height } => {
                Solid::from_parry(SharedShape::cylinder(height.get() * 0.5, radius.get()))?
            }
            Self::Cone { radius, height } => {
                Solid::from_parry(SharedShape::cone(height.get() * 0.5, radius.get()))?
            }
            Self::RoundCuboid { size, radius } => {
                let core = half(size) - radius.get();
                if core.min_element() <= 0.0 {
                    return Err(bad("the edges of a round cuboid are rounder than it is wide"));
                }
                Solid::from_parry(SharedShape::round_cuboid(core.x, core.y, core.z, radius.get()))?
            }
            Self::ConvexHull { points: corners } => {
                let hull = SharedShape::convex_hull(&points(corners));
                Solid::from_parry(hull.ok_or(bad("the points of a convex hull enclose no space"))?)?
            }
            Self::Mesh { vertices, triangles } => Solid::from_parry(triangle_mesh(vertices, triangles)?)?,
            Self::HeightField { size, heights } => Solid::from_parry(height_field(size, heights)?)?,
            Self::Voxels { side, cubes } => Solid::from_parry(voxels(*side, cubes)?)?,
        };
        shape.validate()?;
        Ok(shape)
    }
}

impl Part {
    /// Its solid, and where that is.
    fn build(&self) -> Result<(drape_solver::Shape, Placement), BuildError> {
        if matches!(
            self.shape,
            Shape::Mesh { .. } | Shape::HeightField { .. } | Shape::Voxels { .. } | Shape::Compound { .. }
        ) {
            return Err(bad("a part of a compound is one solid: no mesh, height field, voxels or compound"));
        }
        if matches!(self.shape, Shape::Ground | Shape::HalfSpace { .. } | Shape::Container { .. }) {
            return Err(bad("a shape without end cannot be a part of a compound"));
        }
        let placement = Placement { translation: self.at.get(), rotation: self.turn.quaternion() };
        Ok((self.shape.build()?, placement))
    }
}

fn bad(reason: &'static str) -> BuildError {
    BuildError::BadShape { reason }
}

fn points(vectors: &[Vector]) -> Vec<Vec3> {
    vectors.iter().map(|vector| vector.get()).collect()
}

fn triangle_mesh(vertices: &[Vector], triangles: &[[u32; 3]]) -> Result<SharedShape, BuildError> {
    let count = vertices.len();
    if triangles.iter().flatten().any(|&corner| corner as usize >= count) {
        return Err(bad("a triangle of a mesh names a corner that does not exist"));
    }
    SharedShape::trimesh_with_flags(points(vertices), triangles.to_vec(), TriMeshFlags::ORIENTED)
        .or_else(|_| SharedShape::trimesh(points(vertices), triangles.to_vec()))
        .map_err(|_| bad("a mesh has no triangles, or none with an area"))
}

fn height_field((x, z): &(Positive, Positive), heights: &[Vec<Number>]) -> Result<SharedShape, BuildError> {
    let columns = heights.first().map_or(0, Vec::len);
    if heights.len() < 2 || columns < 2 || heights.iter().any(|row| row.len() != columns) {
        return Err(bad("a height field has two rows at least, and all of them are equally long"));
    }
    // parry's arrays are column-major.
    let data = (0..columns).flat_map(|column| heights.iter().map(move |row| row[column].get())).collect();
    let scale = Vec3::new(x.get(), 1.0, z.get());
    Ok(SharedShape::heightfield(Array2::new(heights.len(), columns, data), scale))
}

fn voxels(side: Positive, cubes: &[[i32; 3]]) -> Result<SharedShape, BuildError> {
    if cubes.is_empty() {
        return Err(bad("voxels without a cube"));
    }
    // The solver turns them into triangles, and counts cubes in 32 bits.
    if cubes.len() > MOST_CUBES || cubes.iter().flatten().any(|cube| cube.unsigned_abs() > FARTHEST_CUBE) {
        return Err(bad("voxels are 65536 cubes at most, none farther than 10000 from the origin"));
    }
    let cubes: Vec<IVector> = cubes.iter().map(|&[x, y, z]| IVector::new(x, y, z)).collect();
    Ok(SharedShape::voxels(Vec3::splat(side.get()), &cubes))
}
