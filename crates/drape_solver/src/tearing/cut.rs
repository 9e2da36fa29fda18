//! Cutting: a blade severs the edges that it crosses (S25).
//!
//! Cloth parts along the stroke itself (`stroke.rs`): each face that it crosses is there on both sides, of which each has a
//! part of it, so that a grid stays a grid ([`FacePart`](crate::FacePart)). A rope parts at the particle nearest to the blade.
//!
//! Design: `docs/design/tears_and_cuts.md`.

use glam::Vec3;

use crate::error::BuildError;
use crate::state::body::Body;
use crate::tearing::elements::Elements;
use crate::tearing::pieces;
use crate::tearing::split::Cracks;
use crate::tearing::stroke::Stroke;
use crate::tearing::tear::Torn;

impl Body {
    /// Cuts the body with the triangles of a blade (world, metres), such as the surface that a sword has swept. None if it
    /// does not pass through any face or link.
    ///
    /// Each face is cut straight from where the blade enters to where it leaves. Where it ends inside a face, the cut ends before that
    /// face, until another stroke goes on from there.
    ///
    /// [`Torn::sticks`] are the structural ones that it has cut, and those that no longer join anything. In contrast to
    /// [`tear`](Self::tear), a cut splits pinned particles, and both sides stay pinned if the blade goes through the particle.
    ///
    /// # Errors
    /// [`BuildError`] if a piece cannot be built; the body is then unchanged.
    pub fn cut(&mut self, blade: &[[Vec3; 3]]) -> Result<Option<Torn>, BuildError> {
        let (mut elements, mut cracks) = (Elements::of(&self.topology), Cracks::default());
        let places: Vec<Vec3> = self.particles.positions().collect();
        let rest = |particle: u32| self.topology.rest[particle as usize];
        Stroke::new(blade, self.topology.longest_edge).divide(&mut elements, &places, rest, &mut cracks);
        if self.topology.faces.is_empty() {
            let links = self.topology.segments.iter();
            cracks.particles.extend(links.filter_map(|&link| self.end_at(link, blade)));
        }
        let parted = pieces::part(self, &elements, &cracks, None)?;
        Ok(parted.map(|parted| Torn {
            origins: parted.origins,
            sticks: parted.severed,
            edges: Vec::new(),
            pieces: parted.pieces,
        }))
    }

    /// The end of a link nearer to the blade's crossing; none if the blade does not cross the link.
    fn end_at(&self, [a, b]: [u32; 2], blade: &[[Vec3; 3]]) -> Option<u32> {
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
