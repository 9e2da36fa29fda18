//! The volume inside a closed surface: a sixth of the sum of `p . (q x r)` over its faces.
//!
//! Design: `docs/design/soft_bodies.md`.

use std::sync::OnceLock;

use glam::DVec3;

use crate::state::particles::Particles;
use crate::state::topology::Topology;

/// The volume inside the faces of a body in cubic metres: positive if they are counter-clockwise seen from outside.
/// Meaningless if they are not closed.
pub fn volume(particles: &Particles, topology: &Topology) -> f64 {
    let place = |corner: u32| particles.local_position(corner as usize).as_dvec3();
    sum(topology, place)
}

fn sum(topology: &Topology, place: impl Fn(u32) -> DVec3) -> f64 {
    let about = topology.faces.first().map_or(DVec3::ZERO, |face| place(face[0]));
    let of_face = |&[p, q, r]: &[u32; 3]| {
        let [p, q, r] = [p, q, r].map(|corner| place(corner) - about);
        p.dot(q.cross(r))
    };
    topology.faces.iter().map(of_face).sum::<f64>() / 6.0
}

/// The volume at rest, computed at its first use. It follows from the rest data, so any two are equal.
#[derive(Clone, Debug, Default)]
pub(crate) struct RestVolume(OnceLock<Option<f64>>);

impl PartialEq for RestVolume {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Topology {
    /// The volume inside the faces at rest in cubic metres; none if they are not closed. Faces are closed if each edge
    /// has as many of them in one direction as in the other.
    pub fn rest_volume(&self) -> Option<f64> {
        *self.rest_volume.0.get_or_init(|| {
            let edges = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
            let mut there: Vec<[u32; 2]> = self.faces.iter().flat_map(|&face| edges(face)).collect();
            let mut back: Vec<[u32; 2]> = there.iter().map(|&[a, b]| [b, a]).collect();
            there.sort_unstable();
            back.sort_unstable();
            let is_closed = !there.is_empty() && there == back;
            is_closed.then(|| sum(self, |corner| self.rest[corner as usize].as_dvec3()))
        })
    }
}
