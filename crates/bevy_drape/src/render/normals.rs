//! Smooth normals of a surface of triangles.

use bevy::math::Vec3;

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
        let sum = Vec3::from_array(*normal);
        // Relative to its own size, since the square of a tiny face's area underflows.
        let size = sum.abs().max_element();
        let unit = if size > 0.0 { (sum / size).normalize() * orientation } else { Vec3::Z };
        *normal = unit.to_array();
    }
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

    #[test]
    fn tiny_and_collapsed_faces_give_unit_normals() {
        let tiny = [[0.0, 0.0, 0.0], [1e-12, 0.0, 0.0], [0.0, 1e-12, 0.0]];
        assert_eq!(normals_of(&tiny, &[[0, 1, 2]], 1.0), [Vec3::Z; 3]);
        assert_eq!(normals_of(&[[1.0; 3]; 4], &[[0, 1, 2]], 1.0), [Vec3::Z; 4]);
    }
}
