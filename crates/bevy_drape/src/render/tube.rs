//! Tubes around polylines.

use bevy::prelude::*;

/// The greatest number of corners of a ring.
pub(crate) const MOST_SIDES: usize = 64;

/// A tube: rings around points, and a cap at each end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tube {
    pub rings: usize,
    /// Number of corners of a ring. The first is duplicated for the seam of the texture.
    pub sides: usize,
    /// Radius in metres.
    pub radius: f32,
}

impl Tube {
    fn ring(self) -> usize {
        self.sides + 1
    }

    /// Number of vertices of the rings and of both caps.
    pub fn vertex_count(self) -> usize {
        (self.rings + 2) * self.ring() + 2
    }

    /// Texture coordinates: from 0 to 1 around and along the tube.
    pub fn texture_coordinates(self) -> Vec<[f32; 2]> {
        let ring = |along: f32| (0..self.ring()).map(move |side| [side as f32 / self.sides as f32, along]);
        let along = |i: usize| i as f32 / (self.rings.max(2) - 1) as f32;
        let mut coordinates: Vec<[f32; 2]> = (0..self.rings).flat_map(|i| ring(along(i))).collect();
        for end in [0.0, 1.0] {
            coordinates.extend(ring(end));
            coordinates.push([0.5, end]);
        }
        coordinates
    }

    /// Triangles, counter-clockwise seen from outside.
    pub fn indices(self) -> Vec<u32> {
        let ring = self.ring() as u32;
        let mut indices = Vec::new();
        for i in 0..self.rings.saturating_sub(1) as u32 {
            for side in 0..self.sides as u32 {
                let (a, b) = (i * ring + side, (i + 1) * ring + side);
                indices.extend([a, a + 1, b, b, a + 1, b + 1]);
            }
        }
        for end in 0..2_u32 {
            let first = self.rings as u32 * ring + end * (ring + 1);
            for side in 0..self.sides as u32 {
                let [a, b] = if end == 0 { [side + 1, side] } else { [side, side + 1] };
                indices.extend([first + ring, first + a, first + b]);
            }
        }
        indices
    }

    /// Writes positions and normals of the vertices around `centres`, and returns the vector across the first link that the
    /// rings start from: the one nearest to `across`. Each ring is the one before, turned only as far as the tube bends
    /// (parallel transport).
    pub fn write(
        self,
        centres: &[Vec3],
        across: Vec3,
        positions: &mut Vec<[f32; 3]>,
        normals: &mut Vec<[f32; 3]>,
    ) -> Vec3 {
        let mut circle = [Vec2::X; MOST_SIDES + 1];
        let circle = &mut circle[..self.ring()];
        for (side, corner) in circle[..self.sides].iter_mut().enumerate() {
            *corner = Vec2::from_angle(core::f32::consts::TAU * side as f32 / self.sides as f32);
        }
        positions.clear();
        normals.clear();
        let mut tangent = tangent_at(centres, 0).unwrap_or(Vec3::Y);
        let first = across.reject_from_normalized(tangent).try_normalize();
        let first = first.unwrap_or_else(|| tangent.any_orthonormal_vector());
        let mut across = first;
        let begin = (tangent, across);
        for (i, &centre) in centres.iter().enumerate() {
            let next = tangent_at(centres, i).unwrap_or(tangent);
            let turned = Quat::from_rotation_arc(tangent, next) * across;
            across = turned.reject_from_normalized(next).try_normalize().unwrap_or(across);
            tangent = next;
            for outward in outwards(circle, tangent, across) {
                positions.push((centre + outward * self.radius).to_array());
                normals.push(outward.to_array());
            }
        }
        let lids = [(0, begin, -1.0), (centres.len() - 1, (tangent, across), 1.0)];
        for (end, (tangent, across), side) in lids {
            let centre = centres[end];
            let corners = outwards(circle, tangent, across);
            positions.extend(corners.map(|outward| (centre + outward * self.radius).to_array()));
            positions.push(centre.to_array());
            normals.extend(core::iter::repeat_n((tangent * side).to_array(), self.ring() + 1));
        }
        first
    }
}

/// The directions from the centre of a ring to its corners, which lie on `circle`.
fn outwards(circle: &[Vec2], tangent: Vec3, across: Vec3) -> impl Iterator<Item = Vec3> {
    let up = tangent.cross(across);
    circle.iter().map(move |around| across * around.x + up * around.y)
}

/// Returns the direction of the line at a point: the mean of both links.
fn tangent_at(centres: &[Vec3], i: usize) -> Option<Vec3> {
    let before =
        i.checked_sub(1).map_or(Vec3::ZERO, |before| (centres[i] - centres[before]).normalize_or_zero());
    let after = centres.get(i + 1).map_or(Vec3::ZERO, |&after| (after - centres[i]).normalize_or_zero());
    (before + after).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertices(tube: Tube, centres: &[Vec3], across: Vec3) -> [Vec<[f32; 3]>; 2] {
        let [mut positions, mut normals] = [Vec::new(), Vec::new()];
        tube.write(centres, across, &mut positions, &mut normals);
        [positions, normals]
    }

    fn helix(turns: f32) -> Vec<Vec3> {
        (0..100)
            .map(|i| {
                let angle = core::f32::consts::TAU * turns * i as f32 / 99.0;
                Vec3::new(libm_cos(angle), 0.02 * i as f32, libm_cos(angle - core::f32::consts::FRAC_PI_2))
            })
            .collect()
    }

    fn libm_cos(angle: f32) -> f32 {
        Vec2::from_angle(angle).x
    }

    #[test]
    fn rings_lie_around_their_points_and_are_never_twisted() {
        let tube = Tube { rings: 100, sides: 8, radius: 0.05 };
        let centres = helix(3.0);
        let [positions, normals] = vertices(tube, &centres, Vec3::ZERO);
        assert_eq!((positions.len(), normals.len()), (tube.vertex_count(), tube.vertex_count()));
        for (i, &centre) in centres.iter().enumerate() {
            let tangent = tangent_at(&centres, i).expect("a line");
            for side in 0..=8 {
                let vertex = Vec3::from(positions[i * 9 + side]) - centre;
                assert!((vertex.length() - 0.05).abs() < 1e-5 && vertex.dot(tangent).abs() < 1e-5);
            }
            if i > 0 {
                // From one ring to the next the frame does not turn about the tangent.
                let before = tangent_at(&centres, i - 1).expect("a line");
                let [from, to] = [i - 1, i].map(|ring| Vec3::from(normals[ring * 9]));
                let carried = Quat::from_rotation_arc(before, tangent) * from;
                assert!(carried.distance(to) < 1e-4, "ring {i} is twisted");
            }
        }
    }

    #[test]
    fn all_triangles_look_outwards_and_close_the_tube() {
        let tube = Tube { rings: 5, sides: 6, radius: 0.1 };
        let centres: Vec<Vec3> = (0..5).map(|i| Vec3::Y * -0.3 * i as f32).collect();
        let [positions, normals] = vertices(tube, &centres, Vec3::X);
        let mut volume = 0.0;
        for triangle in tube.indices().chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|corner| Vec3::from(positions[triangle[corner] as usize]));
            let normal = (b - a).cross(c - a);
            assert!(normal.dot(Vec3::from(normals[triangle[0] as usize])) > 0.0, "{triangle:?}");
            volume += a.dot(b.cross(c)) / 6.0;
        }
        // Of a prism with six sides, 1.2 m high.
        let area = 6.0 * 0.5 * 0.1 * 0.1 * 0.866_025_4;
        assert!((volume - area * 1.2).abs() < 1e-5, "{volume}");
        assert_eq!(tube.texture_coordinates().len(), tube.vertex_count());
    }
}
