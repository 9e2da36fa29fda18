//! The cells of a soft solid: finds the boxes of a lattice inside a mesh, and the cell of each point.
//!
//! ```text
//!     a line along X through the middles of cells crosses the triangles of the mesh;
//!     the middles between two crossings are inside
//!
//!      o   o---x-- * -- * -- *---x--o      * inside   o outside   x crossing
//! ```
//!
//! Design: docs/design/soft_bodies.md.

use std::collections::BTreeMap;

use glam::{Affine3A, DVec3, IVec3, Vec3};

use crate::build::embedding::{CellWeights, Embedding};
use crate::build::mesh::error::MeshError;

/// The lattice of a soft solid.
#[derive(Clone, Debug, PartialEq)]
pub struct SoftLattice {
    /// Factors from the mesh's coordinates to those of the lattice, which have the lengths of the world.
    scale: Vec3,
    corner: Vec3,
    spacing: Vec3,
    cells: Vec<IVec3>,
    particles_at: BTreeMap<[i32; 3], u32>,
}

/// A mesh in the coordinates of a lattice.
pub(crate) struct LatticeMesh<'a> {
    /// Vertices in metres.
    pub positions: &'a [Vec3],
    /// Triangles, counter-clockwise either from outside or from inside.
    pub faces: &'a [[u32; 3]],
    /// Least and greatest corner of its box.
    pub bounds: (Vec3, Vec3),
}

impl SoftLattice {
    /// The cells with their middle inside a mesh, of `counts` cells along its box.
    pub(crate) fn inside(mesh: &LatticeMesh, counts: IVec3, scale: Vec3) -> Self {
        let (low, high) = mesh.bounds;
        let spacing = (high - low) / counts.as_vec3();
        let mut lattice =
            Self { scale, corner: low, spacing, cells: Vec::new(), particles_at: BTreeMap::new() };
        lattice.cells = lattice.cells_inside(mesh, counts);
        for &cell in &lattice.cells {
            for place in corners_of(cell) {
                lattice.particles_at.insert(place.to_array(), 0);
            }
        }
        lattice.particles_at.values_mut().zip(0..).for_each(|(index, next)| *index = next);
        lattice
    }

    /// The cells around whose middle the mesh winds. By the winding number, parts of the mesh may overlap.
    fn cells_inside(&self, mesh: &LatticeMesh, counts: IVec3) -> Vec<IVec3> {
        let [nx, ny, nz] = counts.to_array().map(|count| count as usize);
        let (low, spacing) = (self.corner.as_dvec3(), self.spacing.as_dvec3());
        let middle = |axis: usize, i: usize| low[axis] + (i as f64 + 0.5) * spacing[axis];
        // The change of the winding number from the cell before.
        let mut changes = vec![0_i32; nx * ny * nz];
        for face in mesh.faces {
            let corners = face.map(|corner| mesh.positions[corner as usize].as_dvec3());
            let (least, most) = corners
                .iter()
                .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
            let columns = |axis: usize, count: usize| {
                // Casts of negative numbers give zero.
                let first = ((least[axis] - low[axis]) / spacing[axis] - 1.0) as usize;
                let end = ((most[axis] - low[axis]) / spacing[axis] + 1.0) as usize;
                first..end.min(count)
            };
            for z in columns(2, nz) {
                for y in columns(1, ny) {
                    let Some((x, sign)) = crossing(corners, middle(1, y), middle(2, z)) else { continue };
                    let first = (0..nx).position(|i| middle(0, i) > x);
                    if let Some(first) = first {
                        changes[(z * ny + y) * nx + first] += sign;
                    }
                }
            }
        }
        let mut cells = Vec::new();
        for (row, changes) in changes.chunks_exact(nx).enumerate() {
            let mut winding = 0;
            for (x, change) in changes.iter().enumerate() {
                winding += change;
                if winding != 0 {
                    cells.push(IVec3::new(x as i32, (row % ny) as i32, (row / ny) as i32));
                }
            }
        }
        cells
    }

    /// The cells in order, by their indices along the three axes.
    pub(crate) fn cells(&self) -> &[IVec3] {
        &self.cells
    }

    /// The number of their corners.
    pub(crate) fn particle_count(&self) -> usize {
        self.particles_at.len()
    }

    /// The number of cells.
    pub fn cell_count(&self) -> usize {
        self.cells.len()
    }

    /// The volume of the cells in cubic metres.
    pub(crate) fn volume(&self) -> f64 {
        self.spacing.as_dvec3().element_product() * self.cells.len() as f64
    }

    /// The particles' positions in the world (metres), in order. `to_world` takes the mesh's coordinates to the world.
    pub(crate) fn positions(&self, to_world: &Affine3A) -> Vec<Vec3> {
        let place = |place: IVec3| (self.corner + place.as_vec3() * self.spacing) / self.scale;
        self.particles_at.keys().map(|&at| to_world.transform_point3(place(at.into()))).collect()
    }

    pub(crate) fn particle(&self, place: IVec3) -> u32 {
        self.particles_at[&place.to_array()]
    }

    fn has(&self, cell: IVec3) -> bool {
        self.cells.binary_search_by_key(&cell_order(cell), |&other| cell_order(other)).is_ok()
    }

    /// Two triangles for each side of a cell without a neighbour, counter-clockwise seen from outside.
    pub(crate) fn surface(&self) -> Vec<[u32; 3]> {
        let mut faces = Vec::new();
        for &cell in &self.cells {
            for axis in 0..3 {
                for (side, outwards) in [(0, -1), (1, 1)] {
                    let mut offset = IVec3::ZERO;
                    offset[axis] = outwards;
                    if self.has(cell + offset) {
                        continue;
                    }
                    let (mut first, mut second, mut origin) = (IVec3::ZERO, IVec3::ZERO, cell);
                    first[(axis + 1) % 3] = 1;
                    second[(axis + 2) % 3] = 1;
                    origin[axis] += side;
                    let [a, b, c, d] = [origin, origin + first, origin + first + second, origin + second]
                        .map(|place| self.particle(place));
                    let square = if outwards > 0 { [a, b, c, d] } else { [a, d, c, b] };
                    let [a, b, c, d] = square;
                    faces.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
        faces
    }

    /// Embeds `points` (in the mesh's coordinates) into the lattice. Points outside follow their nearest cell. Points in the
    /// same place follow to the same bits.
    ///
    /// # Errors
    /// [`MeshError`] that names a point that is not finite.
    pub fn embed(&self, points: &[Vec3]) -> Result<Embedding, MeshError> {
        Embedding::of_points(points, |point| self.weights(point * self.scale)).map(Embedding::in_cells)
    }

    /// The corners of a point's cell, and their weights.
    fn weights(&self, point: Vec3) -> CellWeights {
        let place = (point - self.corner) / self.spacing;
        let cell = self.nearest(place);
        let part = place - cell.as_vec3();
        let weight = |corner: IVec3| {
            let along = |axis: usize| if corner[axis] > cell[axis] { part[axis] } else { 1.0 - part[axis] };
            along(0) * along(1) * along(2)
        };
        let corners = corners_of(cell);
        CellWeights { particles: corners.map(|place| self.particle(place)), weights: corners.map(weight) }
    }

    /// The cell at a place, or the one with the nearest middle.
    fn nearest(&self, place: Vec3) -> IVec3 {
        let around = place.floor().as_ivec3();
        let off = |cell: &IVec3| (cell.as_vec3() + 0.5).distance_squared(place);
        let by_distance = |p: &IVec3, q: &IVec3| off(p).total_cmp(&off(q));
        for reach in 0..=MOST_AROUND {
            let offsets = -reach..=reach;
            let offsets = offsets.clone().flat_map(|z| {
                let offsets = offsets.clone();
                offsets.clone().flat_map(move |y| offsets.clone().map(move |x| IVec3::new(x, y, z)))
            });
            let near = offsets.map(|offset| around.saturating_add(offset)).filter(|&cell| self.has(cell));
            if let Some(nearest) = near.min_by(by_distance) {
                // Cells beyond `reach` are farther away than this.
                let beyond = reach as f32 + 0.5;
                if reach == 0 || off(&nearest) <= beyond * beyond {
                    return nearest;
                }
            }
        }
        self.cells.iter().copied().min_by(by_distance).unwrap_or(around)
    }
}

/// The distance in cells within which the search for the nearest cell looks first; then it tries all cells.
const MOST_AROUND: i32 = 3;

/// The eight corners of a cell.
pub(crate) fn corners_of(cell: IVec3) -> [IVec3; 8] {
    core::array::from_fn(|i| cell + IVec3::new(i as i32 & 1, i as i32 >> 1 & 1, i as i32 >> 2 & 1))
}

/// The sort key of cells.
fn cell_order(cell: IVec3) -> [i32; 3] {
    [cell.z, cell.y, cell.x]
}

/// The X at which the line along X through (y, z) crosses a triangle, and the change of the winding number there: -1 if the
/// triangle's normal points along the line, 1 if against it.
///
/// A line through an edge or a corner counts as a little beside it, always to the same side, so that all triangles around
/// such a place agree.
fn crossing([a, b, c]: [DVec3; 3], y: f64, z: f64) -> Option<(f64, i32)> {
    let signs = [side(b, c, y, z), side(c, a, y, z), side(a, b, y, z)];
    let sign = signs[0].1;
    if sign == 0 || signs.iter().any(|&(_, other)| other != sign) {
        return None;
    }
    let sum: f64 = signs.iter().map(|(weight, _)| weight).sum();
    let x = if sum == 0.0 {
        (a.x + b.x + c.x) / 3.0
    } else {
        (a.x * signs[0].0 + b.x * signs[1].0 + c.x * signs[2].0) / sum
    };
    Some((x, -sign))
}

/// Twice the signed area of the triangle of an edge and (y, z) seen along X, and the side of the edge on which (y, z) lies;
/// 0 if the edge is a point.
fn side(from: DVec3, to: DVec3, y: f64, z: f64) -> (f64, i32) {
    // Both triangles at an edge compute with the same end first, so that they get the same bits.
    let is_turned = (from.y, from.z) > (to.y, to.z);
    let (a, b) = if is_turned { (to, from) } else { (from, to) };
    let (across, up) = (b.y - a.y, b.z - a.z);
    let area = across * (z - a.z) - up * (y - a.y);
    let beside = [area, -up, across].into_iter().find(|&sign| sign != 0.0).unwrap_or(0.0);
    let sign = if beside > 0.0 { 1 } else { -i32::from(beside < 0.0) };
    if is_turned { (-area, -sign) } else { (area, sign) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube of two metres around the origin, as triangles that face outwards.
    fn cube(shift: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let corners = (0..8_u8).map(|i| {
            Vec3::new(f32::from(i & 1), f32::from(i >> 1 & 1), f32::from(i >> 2)) * 2.0 - 1.0 + shift
        });
        let square = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
        let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        (corners.collect(), squares.into_iter().flat_map(square).collect())
    }

    fn count(positions: &[Vec3], faces: &[[u32; 3]], counts: IVec3) -> usize {
        let bounds = positions
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        SoftLattice::inside(&LatticeMesh { positions, faces, bounds }, counts, Vec3::ONE).cell_count()
    }

    #[test]
    fn lines_through_edges_and_corners_are_counted_once() {
        let (positions, faces) = cube(Vec3::ZERO);
        // Lines through the middles of cells pass through the diagonals of the cube's sides.
        for n in 1..6 {
            assert_eq!(count(&positions, &faces, IVec3::splat(n)), (n * n * n) as usize);
        }
        let inwards: Vec<_> = faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
        assert_eq!(count(&positions, &inwards, IVec3::splat(5)), 125, "whichever way it is turned");
        // An octahedron with its corners on the axes, on which the middles of odd numbers of cells lie.
        let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        let (mut faces, signs) = (Vec::new(), [0_u32, 1]);
        for (x, y, z) in signs.iter().flat_map(|&x| signs.iter().flat_map(move |&y| signs.map(|z| (x, y, z))))
        {
            let face = [x, 2 + y, 4 + z];
            faces.push(if (x + y + z) % 2 == 0 { face } else { [face[0], face[2], face[1]] });
        }
        let expected = |n: i32| {
            let middle = |i: i32| (f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0;
            let all = (0..n).flat_map(|x| (0..n).flat_map(move |y| (0..n).map(move |z| [x, y, z])));
            all.filter(|cell| cell.iter().map(|&i| middle(i).abs()).sum::<f64>() < 1.0 - 1e-9).count()
        };
        for n in [2, 4, 7, 10] {
            let found = count(&axes, &faces, IVec3::splat(n)) as i32;
            assert!((found - expected(n) as i32).abs() <= n, "{n}: {found}, not {}", expected(n));
        }
        assert_eq!(count(&axes, &faces, IVec3::splat(4)), expected(4));
    }

    #[test]
    fn parts_may_overlap_and_hollows_stay_hollow() {
        let (mut positions, mut faces) = cube(Vec3::ZERO);
        let (other, same) = cube(Vec3::X);
        positions.extend(other);
        faces.extend(same.iter().map(|face| face.map(|corner| corner + 8)));
        assert_eq!(count(&positions, &faces, IVec3::new(6, 4, 4)), 96);
        let (mut positions, mut faces) = cube(Vec3::ZERO);
        positions.extend(cube(Vec3::ZERO).0.iter().map(|&place| place * 0.5));
        faces.extend(same.iter().map(|&[a, b, c]| [a + 8, c + 8, b + 8]));
        assert_eq!(count(&positions, &faces, IVec3::splat(4)), 64 - 8);
    }
}
