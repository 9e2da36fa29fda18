//! Cutting: a blade severs the edges that it crosses (S25).
//!
//! A cut runs along the edges of faces. Where the blade crosses an edge, the end nearer to it is split, and the cloth opens
//! between one such end and the next. No face is divided, so their number stays; the cut is at most half an edge off the
//! blade.
//!
//! ```text
//!   o-----o-----o         o-----o-----o
//!   |   / |   / |         |   / |   / |
//!   - - - - - - - blade   o=====o=====o   the cut
//!   | /   | /   |         | /   | /   |
//!   o-----o-----o         o-----o-----o
//! ```
//!
//! Design: docs/design/tears_and_cuts.md.

use glam::Vec3;

use crate::build::adjacency::Adjacency;
use crate::error::BuildError;
use crate::state::body::Body;
use crate::tearing::pieces;
use crate::tearing::split::Cracks;
use crate::tearing::tear::Torn;

impl Body {
    /// Cuts the body with the triangles of a blade (world, metres), such as the surface that a sword has swept. None if nothing
    /// separates: a cut inside a cloth must be two edges long to open.
    ///
    /// [`Torn::sticks`] are those that no longer join anything. In contrast to [`tear`](Self::tear), a cut splits pinned
    /// particles, and both sides stay pinned.
    ///
    /// # Errors
    /// [`BuildError`] if a piece cannot be built; the body is then unchanged.
    pub fn cut(&mut self, blade: &[[Vec3; 3]]) -> Result<Option<Torn>, BuildError> {
        let mut cracks = Cracks::default();
        let adjacency = Adjacency::new(&self.topology);
        for element in 0..adjacency.len() {
            match *adjacency.corners(element) {
                [a, b, c] => {
                    let mut ends =
                        [[a, b], [b, c], [c, a]].map(|edge| self.end_at(edge, blade)).into_iter().flatten();
                    // A blade that ends in the face crosses only one of its edges.
                    if let (Some(from), Some(to)) = (ends.next(), ends.next())
                        && from != to
                    {
                        cracks.add_edge(from, to);
                    }
                }
                [a, b] => cracks.particles.extend(self.end_at([a, b], blade)),
                _ => {}
            }
        }
        let parted = pieces::part(self, &cracks)?;
        Ok(parted.map(|parted| Torn {
            origins: parted.origins,
            sticks: parted.severed,
            pieces: parted.pieces,
        }))
    }

    /// The end of an edge nearer to the blade's crossing; none if the blade does not cross the edge.
    fn end_at(&self, [a, b]: [u32; 2], blade: &[[Vec3; 3]]) -> Option<u32> {
        // Orders the ends, so that both faces at the edge get the same result.
        let (a, b) = (a.min(b), a.max(b));
        let [from, to] = [a, b].map(|end| self.particles.position(end as usize));
        let part = blade.iter().find_map(|&triangle| crossing(from, to, triangle))?;
        Some(if part < 0.5 { a } else { b })
    }
}

/// The part (0 to 1) of the segment between two points at which it crosses a triangle, if it does (Möller and Trumbore
/// 1997, "Fast, minimum storage ray/triangle intersection").
fn crossing(from: Vec3, to: Vec3, [p, q, r]: [Vec3; 3]) -> Option<f32> {
    let (direction, first, second) = (to - from, q - p, r - p);
    let normal = direction.cross(second);
    let volume = first.dot(normal);
    if volume == 0.0 {
        return None;
    }
    let offset = from - p;
    let u = offset.dot(normal) / volume;
    let across = offset.cross(first);
    let v = direction.dot(across) / volume;
    let part = second.dot(across) / volume;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&part)).then_some(part)
}
