//! Parts of faces: what blades have left of a face.
//!
//! ```text
//!        c                   a stroke has divided the face; both parts keep all three corners, and those
//!       / \                  that lie beyond the stroke are virtual: copies that carry the part
//!    p +---+ q  - - stroke
//!     /     \                a-b-q-p is one part, with the virtual corner c; p-q-c is the other
//!    a-------b
//! ```
//!
//! Design: `docs/design/tears_and_cuts.md`.

use glam::Vec3;

/// A convex part of a face (Molino, Bao and Fedkiw 2004, "A virtual node algorithm for changing mesh topology during
/// simulation").
#[derive(Clone, Debug, PartialEq)]
pub struct FacePart {
    /// Index of the face. Several parts of a face whose particles still hang together may have the same.
    pub face: u32,
    /// The corners of the part, in the sense of the face: each as the weights of the three particles of the face, which sum to 1.
    pub corners: Box<[Vec3]>,
    pub(crate) marks: Marks,
}

/// Cuts in a face that have not divided it, as points by the weights of its particles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Marks {
    /// Blades that have ended inside.
    pub entries: Vec<Entry>,
    /// Stretches of its edges at which it does not hang together with the face beside it.
    pub open: Vec<[Vec3; 2]>,
}

/// The way of a blade that has ended inside a face, so that the next stroke can go on from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    /// The point of the outline at which it came in.
    pub from: Vec3,
    /// The point that it has reached.
    pub tip: Vec3,
}

impl FacePart {
    /// Its part of the area of the face at rest, 0 to 1.
    pub fn share(&self) -> f32 {
        integral(&self.corners).element_sum()
    }

    /// Three corners each, as places in [`corners`](Self::corners), of the triangles that it consists of.
    pub fn triangles(&self) -> impl Iterator<Item = [usize; 3]> {
        (2..self.corners.len()).map(|last| [0, last - 1, last])
    }
}

/// The mean of each of the three weights over a polygon, times its part of the area of the face.
pub(crate) fn integral(corners: &[Vec3]) -> Vec3 {
    let Some((&first, rest)) = corners.split_first() else { return Vec3::ZERO };
    let of_triangle = |pair: &[Vec3]| {
        let share = first.dot(pair[0].cross(pair[1]));
        (first + pair[0] + pair[1]) * (share / 3.0)
    };
    rest.windows(2).map(of_triangle).sum()
}

/// The corner of a face that does not bound the edge on which all `points` lie; none unless they lie on one.
pub(crate) fn beside_edge(points: &[Vec3]) -> Option<usize> {
    (0..3).find(|&corner| points.iter().all(|point| point[corner] == 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_face_have_its_area_and_weights_together() {
        let [a, b, c] = [Vec3::X, Vec3::Y, Vec3::Z];
        let (p, q) = (a.lerp(c, 0.3), b.lerp(c, 0.6));
        let whole = integral(&[a, b, c]);
        assert!((whole - Vec3::splat(1.0 / 3.0)).length() < 1e-6, "{whole}");
        let [below, above] = [&[a, b, q, p][..], &[p, q, c]].map(integral);
        assert!((below + above - whole).length() < 1e-6, "{below} and {above}");
        assert!((above.element_sum() - 0.7 * 0.4).abs() < 1e-6, "{above}");
        assert!(above.z > above.x.max(above.y), "most of it is near its own corner: {above}");
    }
}
