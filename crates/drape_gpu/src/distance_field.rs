//! Signed distances of shapes without a formula, sampled once on a lattice.
//!
//! ```text
//!     +---+---+---+---+---+---+
//!     |   |   |   |   |   |   |     Corners keep their distance from the surface, below zero inside. The shaders
//!     +---+--/xxxxxxx\+---+---+     interpolate between the eight corners of a cell, and take the gradient for the normal.
//!     |   | xxxxxxxxxxx   |   |
//!     +---+xxxxxxxxxxxxx--+---+     Cells are as long as the bounds allow along each axis: a plate gets flat ones. Four cells
//!     |   |   |   |   |   |   |     lie around the bounds; beyond them the shaders go on from the lattice's border.
//!     +---+---+---+---+---+---+
//! ```
//!
//! Edges and tips come out blunt, by up to half of a cell; flat and evenly curved surfaces are nearly exact. Solid parts thinner than a cell
//! are lost, and a shape that consists of them is refused.

use std::num::NonZero;
use std::sync::Arc;

use drape_solver::Shape;
use drape_solver::glam::Vec3;

use crate::error::GpuError;

/// Cells along the longest side of a shape's bounds.
const CELLS: f32 = 48.0;

/// Cells along each side at least, so that a plate has an inside.
const LEAST_CELLS: f32 = 8.0;

/// Cells around the bounds on each side. Cloth thicker than they are touches beyond them, where the shaders find the distance less well.
const MARGIN: f32 = 4.0;

/// The part of the surface that a lattice may lose.
const MOST_LOST: f32 = 0.25;

/// The places of a field's distances in a shape's own coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Lattice {
    /// Its least corner.
    pub low: Vec3,
    /// The sides of a cell in metres.
    pub cell: Vec3,
    /// Corners along each axis.
    pub corners: [u32; 3],
}

/// A lattice whose distances are in the buffer of pairs: x the fastest, z the slowest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Field {
    pub lattice: Lattice,
    /// The pair that holds the first two distances.
    pub first_pair: u32,
    /// True if what is true of its lowest corners is true below them.
    pub is_bottomless: bool,
}

/// The fields of all shapes that a world has met. Each is baked once, and stays.
#[derive(Debug, Default)]
pub(crate) struct DistanceFields {
    /// Keeps the shapes, so that no other one can take their addresses; and refusals, which cost as much as fields.
    known: Vec<(Shape, Result<Field, GpuError>)>,
}

impl DistanceFields {
    /// The field of a shape. That of a new one is baked, and given to `store`, which returns the index of its first pair.
    ///
    /// # Errors
    /// [`GpuError::Unsupported`] for a shape without an inside or an end, or one that is too thin; what `store` returns.
    pub fn field(
        &mut self,
        shape: &Shape,
        store: impl FnOnce(&[[u32; 2]]) -> Result<u32, GpuError>,
    ) -> Result<Field, GpuError> {
        if let Some((_, field)) = self.known.iter().find(|(known, _)| is_same(known, shape)) {
            return field.clone();
        }
        let field = bake(shape).and_then(|(lattice, distances)| {
            let pair = |two: &[f32]| [two[0].to_bits(), two.get(1).copied().unwrap_or(0.0).to_bits()];
            let pairs: Vec<[u32; 2]> = distances.chunks(2).map(pair).collect();
            Ok(Field { lattice, first_pair: store(&pairs)?, is_bottomless: shape.is_bottomless() })
        });
        self.known.push((shape.clone(), field.clone()));
        field
    }
}

/// True if both are the same shape in memory.
fn is_same(a: &Shape, b: &Shape) -> bool {
    match (a, b) {
        (Shape::Mesh(a), Shape::Mesh(b)) => Arc::ptr_eq(a, b),
        (Shape::Compound(a), Shape::Compound(b)) => Arc::ptr_eq(a, b),
        // By address alone: one shape may have several tables of functions.
        (Shape::Parry(a), Shape::Parry(b)) => core::ptr::addr_eq(Arc::as_ptr(&a.0), Arc::as_ptr(&b.0)),
        _ => false,
    }
}

/// Distance of a point from a shape. What is below a height field gets walls at its sides, where its own distance leaps.
fn distance_of(shape: &Shape, point: Vec3) -> f32 {
    let distance = shape.distance(point);
    if !shape.is_bottomless() {
        return distance;
    }
    let (low, high) = shape.local_bounds();
    let at_side = Vec3 { y: point.y, ..point.clamp(low, high) };
    if at_side != point {
        let wall = if shape.distance(at_side) < 0.0 { point.distance(at_side) } else { f32::INFINITY };
        return distance.min(wall);
    }
    let to_sides = (point - low).min(high - point);
    distance.max(-to_sides.x.min(to_sides.z))
}

/// The lattice of a shape, with the distances at its corners.
fn bake(shape: &Shape) -> Result<(Lattice, Vec<f32>), GpuError> {
    if !shape.is_solid() {
        return Err(GpuError::Unsupported("an obstacle without an inside, such as an open mesh,"));
    }
    let (low, high) = shape.local_bounds();
    if !(low.is_finite() && high.is_finite()) {
        return Err(GpuError::Unsupported("an obstacle that has neither a formula nor an end"));
    }
    if shape.is_bottomless() && matches!(shape, Shape::Compound(_)) {
        return Err(GpuError::Unsupported("a compound that holds a height field"));
    }
    let lattice = Lattice::around(low, high);
    let distances = lattice.sample(shape);
    if !distances.iter().all(|distance| distance.is_finite()) {
        return Err(GpuError::Unsupported("an obstacle whose distances are not finite"));
    }
    if lattice.lost_part(shape, &distances) > MOST_LOST {
        return Err(GpuError::Unsupported("an obstacle with walls thinner than a 48th of its length"));
    }
    Ok((lattice, distances))
}

impl Lattice {
    fn around(low: Vec3, high: Vec3) -> Self {
        let extents = high - low;
        let finest = extents.max_element() / CELLS;
        let cells = (extents / finest).ceil().clamp(Vec3::splat(LEAST_CELLS), Vec3::splat(CELLS));
        let cell = extents.max(Vec3::splat(finest)) / cells;
        Self {
            low: (low + high) * 0.5 - cell * (cells * 0.5 + MARGIN),
            cell,
            corners: (cells + 2.0 * MARGIN).to_array().map(|count| count as u32 + 1),
        }
    }

    /// The place of a corner. Halves are the middles of cells.
    fn place(&self, [x, y, z]: [f32; 3]) -> Vec3 {
        self.low + self.cell * Vec3::new(x, y, z)
    }

    fn sample(&self, shape: &Shape) -> Vec<f32> {
        let [width, height, depth] = self.corners.map(|count| count as usize);
        let mut distances = vec![0.0; width * height * depth];
        let mut rows: Vec<&mut [f32]> = distances.chunks_mut(width).collect();
        share_out(&mut rows, |row, distances| {
            let (y, z) = (row % height, row / height);
            for (x, distance) in distances.iter_mut().enumerate() {
                *distance = distance_of(shape, self.place([x as f32, y as f32, z as f32]));
            }
        });
        distances
    }

    /// The part of the surface that the lattice does not show: of the cells through whose middle it passes, those that have all corners
    /// outside. A wall may be so thin that it lies between corners, and cloth would fall through.
    fn lost_part(&self, shape: &Shape, distances: &[f32]) -> f32 {
        let [width, height, depth] = self.corners.map(|count| count as usize);
        let near = 0.25 * self.cell.min_element();
        let reach = 0.5 * self.cell.length() + near;
        let mut found = vec![[0_u32; 2]; depth - 1];
        share_out(&mut found, |z, [lost, all]| {
            for (x, y) in (0..height - 1).flat_map(|y| (0..width - 1).map(move |x| (x, y))) {
                let corners = self.cell_corners(distances, [x, y, z]);
                let least = corners.into_iter().fold(f32::INFINITY, f32::min);
                let mean = corners.iter().sum::<f32>() / 8.0;
                let middle = [x, y, z].map(|corner| corner as f32 + 0.5);
                // Distances change by no more than the way.
                if mean.abs() < reach && distance_of(shape, self.place(middle)).abs() < near {
                    *all += 1;
                    *lost += u32::from(least > 0.0);
                }
            }
        });
        let [lost, all] = found.iter().fold([0, 0], |sum, part| [sum[0] + part[0], sum[1] + part[1]]);
        lost as f32 / all.max(1) as f32
    }

    /// Distances at the corners of a cell.
    fn cell_corners(&self, distances: &[f32], [x, y, z]: [usize; 3]) -> [f32; 8] {
        let [width, height, _] = self.corners.map(|count| count as usize);
        core::array::from_fn(|corner| {
            let [right, up, back] = [corner & 1, corner >> 1 & 1, corner >> 2];
            distances[((z + back) * height + y + up) * width + x + right]
        })
    }
}

/// Does the work on each slot, of which it is told the number, on all cores of the processor.
fn share_out<T: Send>(slots: &mut [T], work: impl Fn(usize, &mut T) + Sync) {
    let threads = std::thread::available_parallelism().map_or(1, NonZero::get);
    let share = slots.len().div_ceil(threads).max(1);
    let work = &work;
    let do_share = move |first: usize, part: &mut [T]| {
        for (place, slot) in part.iter_mut().enumerate() {
            work(first + place, slot);
        }
    };
    if threads == 1 {
        return do_share(0, slots);
    }
    std::thread::scope(|scope| {
        for (number, part) in slots.chunks_mut(share).enumerate() {
            scope.spawn(move || do_share(number * share, part));
        }
    });
}

#[cfg(test)]
mod tests {
    use drape_solver::Placement;
    use drape_solver::parry3d::shape::{Ball, SharedShape};
    use drape_solver::parry3d::utils::Array2;

    use super::*;

    /// A ball as a compound: it has no formula, but its distances do.
    fn ball(radius: f32, place: Vec3) -> Shape {
        Shape::compound(vec![(Shape::Sphere { radius }, Placement::at(place))]).expect("a shape")
    }

    fn closed(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Shape {
        Shape::from_parry(SharedShape::trimesh(vertices, triangles).expect("triangles")).expect("a shape")
    }

    /// The interpolated distance errs most in the middle of a cell: by an eighth of the square of its side times the sum of the curvatures
    /// of the distance, which is `2 / r` at `r` metres from the centre.
    #[test]
    fn the_field_of_a_ball_is_within_its_error_of_the_formula() {
        let (radius, centre) = (0.5, Vec3::new(0.3, -0.2, 0.1));
        let (lattice, distances) = bake(&ball(radius, centre)).expect("a field");
        let side = 2.0 * radius / CELLS;
        assert!((lattice.cell - side).abs().max_element() < 1e-4 * side, "{lattice:?}");
        let [width, height, depth] = lattice.corners.map(|count| count as usize);
        assert_eq!(distances.len(), width * height * depth);
        let (mut cells, mut worst) = (0, 0.0_f32);
        for (z, y) in (0..depth - 1).flat_map(|z| (0..height - 1).map(move |y| (z, y))) {
            for x in 0..width - 1 {
                let corner = lattice.place([x, y, z].map(|corner| corner as f32));
                let kept = distances[(z * height + y) * width + x];
                assert!((kept - (corner.distance(centre) - radius)).abs() < 1e-5, "at corner {corner}");
                let middle = lattice.place([x, y, z].map(|corner| corner as f32 + 0.5)).distance(centre);
                if middle < 4.0 * side {
                    continue;
                }
                let mean = lattice.cell_corners(&distances, [x, y, z]).iter().sum::<f32>() / 8.0;
                let error = (mean - (middle - radius)).abs();
                assert!(error < 1.1 * side * side / (4.0 * middle) + 1e-6, "{error} m at {middle} m");
                worst = worst.max(if (middle - radius).abs() < side { error / side } else { 0.0 });
                cells += 1;
            }
        }
        assert!(cells > 100_000 && worst < 0.012, "{worst} of a cell at the surface of {cells} cells");
    }

    /// A slab has other counts along each axis.
    #[test]
    fn corners_keep_the_distances_of_their_places() {
        let slab = Shape::Cuboid { half_extents: Vec3::new(0.3, 0.1, 0.5) };
        let slab = Shape::compound(vec![(slab, Placement::at(Vec3::Y))]).expect("a shape");
        let (lattice, distances) = bake(&slab).expect("a field");
        let [width, height, depth] = lattice.corners.map(|count| count as usize);
        assert_eq!([width, height, depth], [29, 10, 48].map(|cells| cells + 9));
        for (i, kept) in distances.iter().enumerate() {
            let corner = [i % width, i / width % height, i / (width * height)].map(|corner| corner as f32);
            assert_eq!(*kept, slab.distance(lattice.place(corner)), "corner {corner:?}");
        }
    }

    #[test]
    fn a_shape_is_baked_once_and_by_its_identity() {
        let mut fields = DistanceFields::default();
        let mut stored = 0;
        let mut field_of = |shape: &Shape| {
            let store = |pairs: &[[u32; 2]]| {
                stored += pairs.len() as u32;
                Ok(stored - pairs.len() as u32)
            };
            fields.field(shape, store).map(|field| field.first_pair)
        };
        let cone = Shape::from_parry(SharedShape::cone(0.5, 0.5)).expect("a shape");
        let (vertices, triangles) = Ball::new(0.5).to_trimesh(8, 6);
        let shapes = [cone, ball(0.5, Vec3::X), closed(vertices, triangles), ball(0.5, Vec3::X)];
        let firsts = shapes.each_ref().map(|shape| field_of(shape).expect("a field"));
        assert!(firsts.is_sorted_by(|a, b| a < b), "{firsts:?}");
        assert_eq!(shapes.each_ref().map(|shape| field_of(&shape.clone()).expect("a field")), firsts);
    }

    /// A plate has flat cells and an inside; a bowl with a thin wall would let cloth through.
    #[test]
    fn walls_thinner_than_a_cell_are_refused() {
        let (vertices, triangles) = Ball::new(0.5).to_trimesh(24, 16);
        let bowl = |thickness: f32| {
            let count = vertices.len() as u32;
            let inner = vertices.iter().map(|place| *place * (1.0 - 2.0 * thickness));
            let turned = triangles.iter().map(|&[a, b, c]| [a + count, c + count, b + count]);
            closed(
                vertices.iter().copied().chain(inner).collect(),
                triangles.iter().copied().chain(turned).collect(),
            )
        };
        let cell = 1.0 / CELLS;
        let plate = Shape::Cuboid { half_extents: Vec3::new(0.5, 0.004, 0.5) };
        let plate = Shape::compound(vec![(plate, Placement::at(Vec3::X))]).expect("a shape");
        for (shape, is_kept) in [(plate, true), (bowl(2.0 * cell), true), (bowl(0.2 * cell), false)] {
            let baked = bake(&shape);
            assert_eq!(baked.is_ok(), is_kept, "{:?}", baked.err());
        }
        let error = bake(&bowl(0.2 * cell)).expect_err("too thin").to_string();
        assert!(error.contains("thinner"), "{error}");
    }

    /// Cloth beside a height field meets walls below its sides, and its own surface above; in a compound it has none.
    #[test]
    fn a_height_field_has_sides() {
        let flat = SharedShape::heightfield(Array2::new(3, 3, vec![0.0; 9]), Vec3::new(2.0, 1.0, 2.0));
        let flat = Shape::from_parry(flat).expect("a shape");
        for (point, distance) in [
            (Vec3::new(0.3, 0.2, -0.4), 0.2),
            (Vec3::new(0.3, -0.2, -0.4), -0.2),
            (Vec3::new(0.3, -5.0, -0.4), -0.6),
            (Vec3::new(0.9, -0.2, 0.4), -0.1),
            (Vec3::new(1.1, -0.2, 0.4), 0.1),
            (Vec3::new(1.3, -5.0, 1.4), 0.5),
            (Vec3::new(1.3, 0.4, 0.4), 0.5),
        ] {
            let found = distance_of(&flat, point);
            assert!((found - distance).abs() < 1e-5, "{found} m instead of {distance} m at {point}");
        }
        assert!(bake(&flat).is_ok());
        let compound = Shape::compound(vec![(flat, Placement::at(Vec3::Y))]).expect("a shape");
        let error = bake(&compound).expect_err("no sides").to_string();
        assert!(error.contains("height field"), "{error}");
    }
}
