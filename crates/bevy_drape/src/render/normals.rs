//! Smooth normals of a surface of triangles.

use bevy::math::Vec3;

/// Squares of lengths below this are not exact.
const LEAST_SQUARE: f32 = 1e-30;

/// Writes the unit normal of every vertex: the sum of the normals of its faces, weighted by area. `orientation` is 1 if
/// faces are counter-clockwise seen from the front, -1 if clockwise, as in a mirrored mesh. Vertices without faces, or
/// with degenerate ones only, get +Z.
pub(crate) fn write_smooth_normals(
    positions: &[[f32; 3]],
    faces: &[[u32; 3]],
    orientation: f32,
    normals: &mut [[f32; 3]],
) {
    normals.fill([0.0; 3]);
    for face in faces {
        let [a, b, c] = face.map(|i| Vec3::from_array(positions[i as usize]));
        // Its length is twice the face's area.
        let normal = (b - a).cross(c - a);
        for &corner in face {
            let sum = &mut normals[corner as usize];
            *sum = (Vec3::from_array(*sum) + normal).to_array();
        }
    }
    for normal in normals {
        *normal = unit(Vec3::from_array(*normal), orientation).to_array();
    }
}

/// The same for a grid whose rows have so many `columns`, from its neighbours along rows and columns:
///
/// ```text
///          up
///           |           the sum of the area vectors of the four triangles at a vertex is
///   left ---+--- right    1/2 (right - left) x (up - down)
///           |           At an edge the vertex itself stands for the neighbour that is missing.
///         down
/// ```
pub(crate) fn write_grid_normals(
    positions: &[[f32; 3]],
    columns: usize,
    orientation: f32,
    normals: &mut [[f32; 3]],
) {
    let rows = positions.len() / columns;
    let row_of = |row: usize| &positions[row * columns..(row + 1) * columns];
    for (row, normals) in normals.chunks_exact_mut(columns).enumerate() {
        let [up, here, down] = [row.saturating_sub(1), row, (row + 1).min(rows - 1)].map(row_of);
        for (column, normal) in normals.iter_mut().enumerate() {
            let [left, right] = [column.saturating_sub(1), (column + 1).min(columns - 1)];
            let along = Vec3::from_array(here[right]) - Vec3::from_array(here[left]);
            let across = Vec3::from_array(up[column]) - Vec3::from_array(down[column]);
            *normal = unit(along.cross(across), orientation).to_array();
        }
    }
}

/// The unit vector along a sum of area vectors.
fn unit(sum: Vec3, orientation: f32) -> Vec3 {
    let squared = sum.length_squared();
    if squared > LEAST_SQUARE && squared < f32::INFINITY {
        return sum * (orientation / squared.sqrt());
    }
    // Relative to its own size, since the square of a tiny face's area underflows.
    let size = sum.abs().max_element();
    if size > 0.0 { (sum / size).normalize() * orientation } else { Vec3::Z }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of three points above three points, bent by 90 degrees along the middle:
    /// the left half faces +Z, the right half, `width` metres wide, faces +X.
    fn bent(width: f32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
        let column = [[-1.0, 0.0], [0.0, 0.0], [0.0, -width]];
        let row = |y: f32| column.map(|[x, z]| [x, y, z]);
        let positions = row(1.0).into_iter().chain(row(0.0)).collect();
        let square = |i: u32| [[i, i + 3, i + 4], [i, i + 4, i + 1]];
        (positions, square(0).into_iter().chain(square(1)).collect())
    }

    fn normals_of(positions: &[[f32; 3]], faces: &[[u32; 3]], orientation: f32) -> Vec<Vec3> {
        let mut normals = vec![[7.0; 3]; positions.len()];
        write_smooth_normals(positions, faces, orientation, &mut normals);
        normals.into_iter().map(Vec3::from_array).collect()
    }

    #[test]
    fn flat_parts_keep_their_normals() {
        let (positions, faces) = bent(1.0);
        let normals = normals_of(&positions, &faces, 1.0);
        assert!((normals[0] - Vec3::Z).length() < 1e-6);
        assert!((normals[5] - Vec3::X).length() < 1e-6);
    }

    #[test]
    fn the_wider_side_of_an_edge_weighs_more() {
        // On the edge three triangles meet at the top (one left, two right) and three below (two left, one right).
        let (positions, faces) = bent(2.0);
        let normals = normals_of(&positions, &faces, 1.0);
        assert!((normals[1] - Vec3::new(4.0, 0.0, 1.0).normalize()).length() < 1e-6);
        assert!((normals[4] - Vec3::new(2.0, 0.0, 2.0).normalize()).length() < 1e-6);
    }

    #[test]
    fn a_mirrored_surface_faces_the_same_way() {
        let (positions, faces) = bent(1.0);
        let flipped: Vec<_> = faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
        assert_eq!(normals_of(&positions, &flipped, -1.0), normals_of(&positions, &faces, 1.0));
    }

    /// A grid has the normals of the four triangles at each vertex, of their own areas, and those of faces where it is flat.
    #[test]
    fn a_grid_has_the_normals_of_its_corners() {
        let (columns, rows) = (5_usize, 4_usize);
        let place = |column: usize, row: usize| {
            let (x, y) = (column as f32, -(row as f32));
            Vec3::new(x + 0.1 * y * y, y, 0.3 * (x * 1.7).sin() + 0.2 * (y * x).cos())
        };
        let points: Vec<Vec3> = (0..rows * columns).map(|i| place(i % columns, i / columns)).collect();
        let positions: Vec<[f32; 3]> = points.iter().map(Vec3::to_array).collect();
        let mut normals = vec![[7.0; 3]; positions.len()];
        write_grid_normals(&positions, columns, 1.0, &mut normals);
        for (i, normal) in normals.iter().enumerate() {
            let (column, row) = (i % columns, i / columns);
            let mut sum = Vec3::ZERO;
            // Counter-clockwise from the right.
            let around = [(1_isize, 0_isize), (0, -1), (-1, 0), (0, 1)].map(|(right, down)| {
                let (column, row) = (column.checked_add_signed(right)?, row.checked_add_signed(down)?);
                (column < columns && row < rows).then(|| points[row * columns + column] - points[i])
            });
            for side in 0..4 {
                if let (Some(p), Some(q)) = (around[side], around[(side + 1) % 4]) {
                    sum += p.cross(q);
                }
            }
            assert!((Vec3::from_array(*normal) - sum.normalize()).length() < 1e-5, "{column}, {row}");
        }
    }

    #[test]
    fn tiny_and_collapsed_faces_give_unit_normals() {
        let tiny = [[0.0, 0.0, 0.0], [1e-12, 0.0, 0.0], [0.0, 1e-12, 0.0]];
        assert_eq!(normals_of(&tiny, &[[0, 1, 2]], 1.0), [Vec3::Z; 3]);
        assert_eq!(normals_of(&[[1.0; 3]; 4], &[[0, 1, 2]], 1.0), [Vec3::Z; 4]);
    }
}
