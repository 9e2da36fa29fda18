//! Spheres.

use bevy::prelude::*;

use super::triangle_mesh::triangle_mesh;

/// A sphere of `radius` metres: an icosahedron whose triangles were divided by four, `divisions` times.
///
/// Bevy's own icosphere needs sines, which differ from machine to machine; this one needs square roots only.
pub(crate) fn icosphere(radius: f32, divisions: u32) -> Mesh {
    // Three golden rectangles, each through the other two.
    let (a, b) = (1.0, (1.0 + 5.0_f32.sqrt()) / 2.0);
    let mut corners: Vec<Vec3> = [[-a, b, 0.0], [a, b, 0.0], [-a, -b, 0.0], [a, -b, 0.0]]
        .into_iter()
        .flat_map(|[x, y, z]| [Vec3::new(x, y, z), Vec3::new(z, x, y), Vec3::new(y, z, x)])
        .map(Vec3::normalize)
        .collect();
    // Corners of the icosahedron are neighbours if they are as near as two can be.
    let edge =
        corners.iter().map(|corner| corner.distance(corners[0])).filter(|&d| d > 0.1).fold(9.0, f32::min);
    let near = |i: usize, j: usize| corners[i].distance(corners[j]) < 1.1 * edge;
    let mut triangles = Vec::new();
    for (i, j, k) in (0..12).flat_map(|i| (i + 1..12).flat_map(move |j| (j + 1..12).map(move |k| (i, j, k))))
    {
        if near(i, j) && near(j, k) && near(k, i) {
            let outwards = (corners[j] - corners[i]).cross(corners[k] - corners[i]).dot(corners[i]) > 0.0;
            let [j, k] = if outwards { [j, k] } else { [k, j] };
            triangles.push([i, j, k].map(|corner| corner as u32));
        }
    }
    for _ in 0..divisions {
        let mut middles: Vec<([u32; 2], u32)> = Vec::new();
        for &[i, j, k] in &triangles {
            middles.extend([[i, j], [j, k], [k, i]].map(|[p, q]| ([p.min(q), p.max(q)], 0)));
        }
        middles.sort_unstable();
        middles.dedup();
        for ([p, q], middle) in &mut middles {
            *middle = corners.len() as u32;
            corners.push((corners[*p as usize] + corners[*q as usize]).normalize());
        }
        let middle = |p: u32, q: u32| {
            let at = middles.binary_search_by_key(&[p.min(q), p.max(q)], |&(ends, _)| ends);
            at.map_or(p, |at| middles[at].1)
        };
        let quarters = |&[i, j, k]: &[u32; 3]| {
            let (ij, jk, ki) = (middle(i, j), middle(j, k), middle(k, i));
            [[i, ij, ki], [ij, j, jk], [ki, jk, k], [ij, jk, ki]]
        };
        triangles = triangles.iter().flat_map(quarters).collect();
    }
    let corners: Vec<Vec3> = corners.into_iter().map(|corner| corner * radius).collect();
    triangle_mesh(corners, &triangles)
}
