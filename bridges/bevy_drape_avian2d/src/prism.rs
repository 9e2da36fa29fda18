//! Shapes of two dimensions as solids: each becomes a prism along Z.
//!
//! ```text
//!    Y             +------+ ---+    z = HALF_LENGTH
//!    |            /|     /|
//!    |  +------+ / |    / |         an edge becomes a wall,
//!    |  |      |   +---/--+ ---+    and an area also has two ends
//!    |  +------+  /      /
//!    +------- X             z = -HALF_LENGTH
//! ```

use core::f32::consts::TAU;
use std::collections::BTreeSet;

use avian2d::parry::shape::{Shape as FlatShape, SupportMap, TypedShape};
use avian2d::prelude::Collider;
use bevy::math::ops;
use bevy::prelude::*;
use bevy_drape::drape_solver::parry3d::shape::{HeightField, HeightFieldCellStatus, SharedShape};
use bevy_drape::drape_solver::parry3d::utils::Array2;
use bevy_drape::drape_solver::{BuildError, Placement, Shape};

/// Distance in metres from a collider's Z to either end of its prism: Z may order sprites, and nothing in the plane is pushed out
/// through an end.
const HALF_LENGTH: f32 = 10.0;

/// Sides of a round shape. They are within 0.12 % of its radius.
const SIDES: u32 = 64;

/// Corners that are nearer to each other than this part of the outline's size are one.
const LEAST_SIDE: f32 = 1e-4;

/// The solid for a collider, without the scale of its transform.
pub(crate) fn prism(collider: &Collider) -> Result<Shape, BuildError> {
    // Avian scales in its own way: a round shape keeps its border, and no scale mirrors. Cloth scales by the transform.
    solid(&*collider.shape_scaled().0, collider.scale().abs())
}

/// The solid for a shape that is scaled already, without that scale.
fn solid(shape: &dyn FlatShape, scale: Vec2) -> Result<Shape, BuildError> {
    let unscaled = |points: &[Vec2]| points.iter().map(|&point| point / scale).collect::<Vec<_>>();
    match shape.as_typed_shape() {
        TypedShape::HalfSpace(plane) => {
            Ok(Shape::HalfSpace { normal: (plane.normal * scale).normalize_or_zero().extend(0.0) })
        }
        TypedShape::Cuboid(cuboid) => {
            Ok(Shape::Cuboid { half_extents: (cuboid.half_extents / scale).extend(HALF_LENGTH) })
        }
        TypedShape::Segment(segment) => extruded(&unscaled(&[segment.a, segment.b]), &[], &[[0, 1]]),
        TypedShape::Polyline(line) => extruded(&unscaled(line.vertices()), &[], line.indices()),
        TypedShape::Triangle(triangle) => area(&unscaled(triangle.vertices()), &[[0, 1, 2]]),
        TypedShape::ConvexPolygon(polygon) => convex(&unscaled(polygon.points())),
        TypedShape::TriMesh(mesh) => area(&unscaled(mesh.vertices()), mesh.indices()),
        TypedShape::HeightField(field) => {
            let heights = field.heights().iter().flat_map(|&height| [height; 2]).collect();
            let size = (field.scale() / scale).extend(2.0 * HALF_LENGTH);
            let mut solid = HeightField::new(Array2::new(2, field.heights().len(), heights), size);
            for cell in (0..field.num_cells()).filter(|&cell| field.is_segment_removed(cell)) {
                solid.set_cell_status(0, cell, HeightFieldCellStatus::CELL_REMOVED);
            }
            Shape::from_parry(SharedShape::new(solid))
        }
        TypedShape::Voxels(voxels) => {
            let [low, high] = voxels.domain();
            let corners =
                [Vec2::new(-0.5, -0.5), Vec2::new(0.5, -0.5), Vec2::splat(0.5), Vec2::new(-0.5, 0.5)];
            let (mut points, mut triangles) = (Vec::new(), Vec::new());
            for voxel in voxels.voxels_in_range(low, high) {
                let first = points.len() as u32;
                // Corners that voxels share are the same to the last bit.
                let corner =
                    |corner: Vec2| (voxel.grid_coords.as_vec2() + 0.5 + corner) * voxels.voxel_size();
                points.extend(corners.map(corner));
                triangles.extend([[0, 1, 2], [0, 2, 3]].map(|triangle| triangle.map(|i| first + i)));
            }
            area(&unscaled(&points), &triangles)
        }
        TypedShape::Compound(compound) => {
            let parts = compound.shapes().iter().map(|(pose, part)| {
                let translation = (pose.translation / scale).extend(0.0);
                let rotation = Quat::from_rotation_z(pose.rotation.angle());
                Ok((solid(&*part.0, scale)?, Placement { translation, rotation }))
            });
            Shape::compound(parts.collect::<Result<_, BuildError>>()?)
        }
        _ => match shape.as_support_map() {
            Some(map) => convex(&unscaled(&outline(map))),
            None => Err(BuildError::BadShape { reason: "its outline is not known" }),
        },
    }
}

/// Corners around a convex shape.
fn outline(shape: &dyn SupportMap) -> Vec<Vec2> {
    let corner = |side: u32| {
        let (sine, cosine) = ops::sin_cos(TAU * side as f32 / SIDES as f32);
        shape.local_support_point_toward(Vec2::new(cosine, sine))
    };
    let mut corners: Vec<_> = (0..SIDES).map(corner).collect();
    let size = corners.iter().fold(0.0, |size: f32, corner| size.max(corner.distance(corners[0])));
    let are_one = |a: Vec2, b: Vec2| a.distance(b) < LEAST_SIDE * size;
    corners.dedup_by(|a, b| are_one(*a, *b));
    if corners.len() > 1 && are_one(corners[0], corners[corners.len() - 1]) {
        corners.pop();
    }
    corners
}

/// The prism over a convex polygon.
fn convex(corners: &[Vec2]) -> Result<Shape, BuildError> {
    let fan: Vec<_> = (2..corners.len() as u32).map(|corner| [0, corner - 1, corner]).collect();
    area(corners, &fan)
}

/// The solid over triangles: where two share an edge, there is no wall.
fn area(points: &[Vec2], triangles: &[[u32; 3]]) -> Result<Shape, BuildError> {
    let at = |corner: u32| points.get(corner as usize).copied().unwrap_or(Vec2::NAN);
    let is_clockwise = |[a, b, c]: [u32; 3]| (at(b) - at(a)).perp_dot(at(c) - at(a)) < 0.0;
    let turn = |triangle: [u32; 3]| {
        let [a, b, c] = triangle;
        if is_clockwise(triangle) { [a, c, b] } else { triangle }
    };
    let triangles: Vec<_> = triangles.iter().copied().map(turn).collect();
    let edges = || triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    // By place, as triangles may have corners of their own there. Adding zero makes one of both zeros.
    let places = |edge: [u32; 2]| edge.map(|corner| (at(corner) + Vec2::ZERO).to_array().map(f32::to_bits));
    let known: BTreeSet<_> = edges().map(places).collect();
    let border: Vec<_> = edges().filter(|&[a, b]| !known.contains(&places([b, a]))).collect();
    extruded(points, &triangles, &border)
}

/// Walls over edges and ends over triangles, which are wound counterclockwise. An edge has the inside on its left.
fn extruded(points: &[Vec2], triangles: &[[u32; 3]], edges: &[[u32; 2]]) -> Result<Shape, BuildError> {
    let back = points.len() as u32;
    let side = |z: f32| points.iter().map(move |point| point.extend(z));
    let ends = triangles.iter().flat_map(|&[a, b, c]| [[a, b, c], [a + back, c + back, b + back]]);
    let walls = edges.iter().flat_map(|&[a, b]| [[a, a + back, b], [b, a + back, b + back]]);
    let mesh = SharedShape::trimesh(
        side(HALF_LENGTH).chain(side(-HALF_LENGTH)).collect(),
        ends.chain(walls).collect(),
    );
    Shape::from_parry(mesh.map_err(|_| BuildError::BadShape { reason: "it has neither edge nor area" })?)
}
