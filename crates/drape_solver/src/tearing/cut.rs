//! Cutting: a blade severs what it passes through (S25).
//!
//! A cut runs along the edges of faces: where the blade crosses an edge, the end nearer to it is split, and
//! the cloth opens between one such end and the next. So no face is cut in two and their number stays; the cut is off the
//! blade by half an edge at most.
//!
//! ```text
//!   o-----o-----o         o-----o-----o
//!   |   / |   / |         |   / |   / |
//!   - - - - - - - blade   o=====o=====o   the cut
//!   | /   | /   |         | /   | /   |
//!   o-----o-----o         o-----o-----o
//! ```

use glam::Vec3;

use crate::build::adjacency::Fabric;
use crate::error::BuildError;
use crate::state::body::Body;
use crate::tearing::pieces;
use crate::tearing::split::Cracks;
use crate::tearing::tear::Torn;

impl Body {
    /// Cuts the body with the triangles of a blade (world, metres): what a sword has swept, or a pointer between two rays.
    /// None where nothing parts: a cut inside a cloth must be two edges long to open.
    ///
    /// [`Torn::sticks`] are those that no longer join anything. The rest is as for [`tear`](Self::tear), but a pinned
    /// particle is split if the cut runs through it, and both sides stay pinned.
    ///
    /// # Errors
    /// [`BuildError`] if a piece cannot be built; the body is as it was then.
    pub fn cut(&mut self, blade: &[[Vec3; 3]]) -> Result<Option<Torn>, BuildError> {
        let mut cracks = Cracks::default();
        let fabric = Fabric::new(&self.topology);
        for element in 0..fabric.len() {
            match *fabric.corners(element) {
                [a, b, c] => {
                    let mut ends =
                        [[a, b], [b, c], [c, a]].map(|edge| self.end_at(edge, blade)).into_iter().flatten();
                    // A blade that ends in the face crosses one of its edges only.
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

    /// The end of an edge nearer to where a blade crosses it, if one does.
    fn end_at(&self, [a, b]: [u32; 2], blade: &[[Vec3; 3]]) -> Option<u32> {
        // The same for both faces at the edge.
        let (a, b) = (a.min(b), a.max(b));
        let [from, to] = [a, b].map(|end| self.particles.position(end as usize));
        let part = blade.iter().find_map(|&triangle| crossing(from, to, triangle))?;
        Some(if part < 0.5 { a } else { b })
    }
}

/// At which part of the way from one point to another a triangle is crossed (Möller and Trumbore 1997, "Fast, minimum
/// storage ray/triangle intersection").
fn crossing(from: Vec3, to: Vec3, [p, q, r]: [Vec3; 3]) -> Option<f32> {
    let (way, first, second) = (to - from, q - p, r - p);
    let normal = way.cross(second);
    let volume = first.dot(normal);
    if volume == 0.0 {
        return None;
    }
    let offset = from - p;
    let u = offset.dot(normal) / volume;
    let across = offset.cross(first);
    let v = way.dot(across) / volume;
    let part = second.dot(across) / volume;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&part)).then_some(part)
}
