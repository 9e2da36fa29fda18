//! Splits particles along cracks, so that a mesh opens.
//!
//! ```text
//!   a crack along 3-4-5              4 and 5 are split; 3, where it ends, is not
//!   0---1---2                        0---1---2
//!   |   |   |                        |   |   |
//!   3===4===5   ----------------->   3---4---5
//!   |   |   |                         \--4'--5'
//!   6---7---8                        6---7---8
//! ```
//!
//! Faces around a particle stay together if they share an edge without a crack. Each group of faces gets a particle of its
//! own, so that no face is lost and no two faces join at a corner alone. `Split::joined` decides which sticks stay.
//!
//! Design: `docs/design/tears_and_cuts.md`.

use std::collections::{BTreeMap, BTreeSet};

use glam::Vec3;

use crate::build::adjacency::Adjacency;
use crate::state::face_part::FacePart;
use crate::tearing::elements::{Elements, edge_by};

/// The edges and particles at which a body separates.
#[derive(Default)]
pub(crate) struct Cracks {
    /// Edges of faces, lower index first.
    pub edges: BTreeSet<[u32; 2]>,
    /// Edges that a blade crosses.
    pub crossed: BTreeSet<[u32; 2]>,
    /// Particles at which links separate, and around which faces may.
    pub particles: BTreeSet<u32>,
    /// The way of a blade through faces at rest, in metres.
    pub lines: Vec<[Vec3; 2]>,
    /// True if a face has been divided, or has new marks.
    pub has_changed: bool,
}

impl Cracks {
    pub fn add_edge(&mut self, a: u32, b: u32) {
        self.edges.insert([a.min(b), a.max(b)]);
    }

    /// True if nothing separates, and no face has changed.
    pub fn is_empty(&self) -> bool {
        self.edges.is_empty() && self.particles.is_empty() && !self.has_changed
    }

    /// The particles at the cracks, in order.
    fn touched(&self) -> BTreeSet<u32> {
        self.edges.iter().flatten().chain(&self.particles).copied().collect()
    }
}

/// A body with its cracks open. Particles keep their indices; copies come behind them.
pub(crate) struct Split<'a> {
    pub adjacency: Adjacency<'a>,
    elements: &'a Elements,
    /// The corners of each face; for a link its two ends, the second of them twice.
    corners: Vec<[u32; 3]>,
    /// For each particle its index before the split; for a copy, that of the particle it was split from.
    pub origins: Vec<u32>,
    /// For each particle its share (0 to 1) of the mass before the split.
    pub shares: Vec<f32>,
    /// For each particle true if its place belongs to one of its faces: else it only carries parts of them.
    pub is_real: Vec<bool>,
    /// For each particle true if its sticks may change, and those particles in order.
    is_near: Vec<bool>,
    near: Vec<u32>,
}

impl<'a> Split<'a> {
    /// Opens the cracks; none if no particle is split and no face has changed.
    pub fn new(adjacency: Adjacency<'a>, elements: &'a Elements, cracks: &Cracks) -> Option<Self> {
        let topology = adjacency.topology();
        let count = topology.particle_count();
        let corners = if adjacency.has_faces() {
            elements.corners.clone()
        } else {
            topology.segments.iter().map(|&[a, b]| [a, b, b]).collect()
        };
        let mut split = Self {
            corners,
            origins: (0..count as u32).collect(),
            shares: vec![1.0; count],
            is_real: vec![true; count],
            is_near: vec![false; count],
            near: Vec::new(),
            adjacency,
            elements,
        };
        for particle in cracks.touched() {
            split.part(particle, cracks);
        }
        split.near = (0..count as u32).filter(|&particle| split.is_near[particle as usize]).collect();
        (split.origins.len() > count || cracks.has_changed).then_some(split)
    }

    /// Gives each group of faces around a particle a particle of its own. The largest group keeps the particle.
    fn part(&mut self, particle: u32, cracks: &Cracks) {
        let Self { adjacency, elements, corners, origins, shares, is_real, is_near, .. } = self;
        let mut groups = groups_around(adjacency, elements, particle, cracks);
        for corner in adjacency.around(particle).flat_map(|element| adjacency.corners(element)) {
            is_near[*corner as usize] = true;
        }
        if groups.len() < 2 {
            return;
        }
        let has_faces = adjacency.has_faces();
        let weight = |element: usize| if has_faces { elements.weight(element, particle) } else { 1.0 };
        let size = |group: &Vec<usize>| {
            group.iter().map(|&element| adjacency.size(element) * weight(element)).sum::<f32>()
        };
        let reaches = |group: &Vec<usize>| {
            !has_faces || group.iter().any(|&element| elements.reaches(element, particle))
        };
        let total: f32 = groups.iter().map(size).sum();
        let equal = 1.0 / groups.len() as f32;
        let part = |group: &Vec<usize>| if total > 0.0 { size(group) / total } else { equal };
        // A copy that carries little of its faces would be too light for its neighbours.
        let is_light = groups.iter().any(|group| part(group) < LEAST_SHARE);
        let share = |group: &Vec<usize>| if is_light { part(group).max(LEAST_SHARE) } else { part(group) };
        let all: f32 = if is_light { groups.iter().map(share).sum() } else { 1.0 };
        // The sort is stable: of equal groups, the one with the first face keeps the particle.
        groups.sort_by(|p, q| size(q).total_cmp(&size(p)));
        shares[particle as usize] = share(&groups[0]) / all;
        is_real[particle as usize] = reaches(&groups[0]);
        for group in &groups[1..] {
            let copy = origins.len() as u32;
            origins.push(particle);
            shares.push(share(group) / all);
            is_real.push(reaches(group));
            for &element in group {
                for (corner, &was) in corners[element].iter_mut().zip(adjacency.corners(element)) {
                    if was == particle {
                        *corner = copy;
                    }
                }
                if !has_faces {
                    corners[element][2] = corners[element][1];
                }
            }
        }
    }

    /// The faces, of which `own` gives the particles in a piece, and the parts of them; those without stay away. Parts of a face
    /// whose particles still hang together are one face.
    pub fn faces_of(&self, own: impl Fn([u32; 3]) -> Option<[u32; 3]>) -> (Vec<[u32; 3]>, Vec<FacePart>) {
        let (mut faces, mut parts): (Vec<[u32; 3]>, Vec<FacePart>) = Default::default();
        if !self.adjacency.has_faces() {
            return (faces, parts);
        }
        let shared = self.shared_edges();
        let mut divided: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (element, &corners) in self.corners.iter().enumerate() {
            let Some(corners) = own(corners) else { continue };
            if self.elements.is_whole(element) {
                faces.push(corners);
                continue;
            }
            let is_shared = |side: [Vec3; 2]| {
                edge_by(self.corners[element], side).is_some_and(|edge| shared.get(&edge) > Some(&1))
            };
            let part = self.elements.face_part(element, 0, is_shared);
            let known = part.as_ref().and_then(|_| {
                let known = divided.entry(self.elements.face(element)).or_default();
                known.iter().copied().find(|&face| faces[face as usize] == corners)
            });
            let face = known.unwrap_or(faces.len() as u32);
            if known.is_none() {
                faces.push(corners);
            }
            if let Some(part) = part {
                divided.entry(self.elements.face(element)).or_default().push(face);
                parts.push(FacePart { face, ..part });
            }
        }
        parts.sort_by_key(|part| part.face);
        (faces, parts)
    }

    /// The number of elements at each edge that has an open stretch.
    fn shared_edges(&self) -> BTreeMap<[u32; 2], u32> {
        let mut count = BTreeMap::new();
        for (element, sides) in self.elements.open() {
            let edges = sides.iter().filter_map(|&side| edge_by(self.corners[element], side));
            count.extend(edges.map(|edge| (edge, 0)));
        }
        let mut is_end = vec![false; self.origins.len()];
        count.keys().flatten().for_each(|&end| is_end[end as usize] = true);
        for &[a, b, c] in if count.is_empty() { &[] } else { &*self.corners } {
            for [p, q] in [[a, b], [b, c], [c, a]] {
                if is_end[p as usize]
                    && let Some(count) = count.get_mut(&[p.min(q), p.max(q)])
                {
                    *count += 1;
                }
            }
        }
        count
    }

    /// The ends of each link.
    pub fn segments(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let links = if self.adjacency.has_faces() { &[] } else { &*self.corners };
        links.iter().map(|&[a, b, _]| [a, b])
    }

    /// The corners of all faces or links.
    pub fn corners(&self) -> &[[u32; 3]] {
        &self.corners
    }

    /// The particles near cracks, in order.
    pub fn near(&self) -> &[u32] {
        &self.near
    }

    /// True if the split may change a stick between these particles.
    pub fn may_concern(&self, [a, b]: [u32; 2]) -> bool {
        self.is_near[a as usize] || self.is_near[b as usize]
    }

    /// Replaces `joined` by the ends of the sticks that follow from the stick between `a` and `b`: none if it is severed,
    /// several if each side of a crack gets one.
    ///
    /// A stick along an edge stays with the faces at that edge. A stick across an edge, between the far corners of its two
    /// faces, is severed with the edge. A stick that skips a particle stays if its two halves still share that particle.
    pub fn joined(&self, [a, b]: [u32; 2], joined: &mut Vec<[u32; 2]>) {
        joined.clear();
        let adjacency = &self.adjacency;
        let has = |element: usize, particle: u32| adjacency.corners(element).contains(&particle);
        for element in adjacency.around(a).filter(|&element| has(element, b)) {
            joined.push([self.copy(element, a), self.copy(element, b)]);
        }
        if joined.is_empty() {
            let pairs = || adjacency.around(a).flat_map(|f| adjacency.around(b).map(move |g| (f, g)));
            let common = |[f, g]: [&[u32]; 2]| f.iter().filter(|corner| g.contains(corner)).count();
            let mut across =
                pairs().filter(|&(f, g)| common([f, g].map(|e| adjacency.corners(e))) >= 2).peekable();
            if across.peek().is_some() {
                let is_whole = |&(f, g): &(usize, usize)| common([f, g].map(|e| &self.corners[e][..])) >= 2;
                joined.extend(across.filter(is_whole).map(|(f, g)| [self.copy(f, a), self.copy(g, b)]));
            } else if let Some(middle) = self.middle([a, b]) {
                let meet = pairs().filter(|&(f, g)| has(f, middle) && has(g, middle));
                let is_whole = |&(f, g): &(usize, usize)| self.copy(f, middle) == self.copy(g, middle);
                joined.extend(meet.filter(is_whole).map(|(f, g)| [self.copy(f, a), self.copy(g, b)]));
            } else {
                // No faces or links are along the stick.
                joined.push([a, b]);
            }
        }
        joined.sort_unstable();
        joined.dedup();
    }

    /// The common neighbour of two particles nearest to the middle between them at rest.
    fn middle(&self, [a, b]: [u32; 2]) -> Option<u32> {
        let (adjacency, rest) = (&self.adjacency, &self.adjacency.topology().rest);
        let middle = (rest[a as usize] + rest[b as usize]) * 0.5;
        let neighbours = |of: u32| {
            adjacency
                .around(of)
                .flat_map(|element| adjacency.corners(element))
                .copied()
                .filter(move |&c| c != of)
        };
        let common = neighbours(a).filter(|&m| neighbours(b).any(|other| other == m));
        let off = |&m: &u32| rest[m as usize].distance_squared(middle);
        common.min_by(|p, q| off(p).total_cmp(&off(q)).then(p.cmp(q)))
    }

    /// The elements around a particle.
    fn elements_of(&self, member: u32) -> impl Iterator<Item = usize> + '_ {
        let around = self.adjacency.around(self.origins[member as usize]);
        around.filter(move |&element| self.corners[element].contains(&member))
    }

    /// The mean place of the corners of the elements around a particle at rest.
    pub fn middle_of(&self, member: u32) -> Vec3 {
        let rest = &self.adjacency.topology().rest;
        let at = |corner: u32| rest[corner as usize];
        let mut corners = Vec::new();
        for element in self.elements_of(member) {
            if self.adjacency.has_faces() {
                let polygon = self.elements.polygon(element).iter();
                corners.extend(polygon.map(|&point| self.elements.place(element, point, at).as_vec3()));
            } else {
                corners.extend(self.adjacency.corners(element).iter().map(|&corner| at(corner)));
            }
        }
        let sum: Vec3 = corners.iter().sum();
        if corners.is_empty() { at(self.origins[member as usize]) } else { sum / corners.len() as f32 }
    }

    /// The mean inverse mass in 1/kg of the particles beside a copy that are not pinned; 0 if all are.
    pub fn inverse_mass_beside(&self, member: u32, inverse_mass: impl Fn(u32) -> f32) -> f32 {
        let corners = self.elements_of(member).flat_map(|element| self.adjacency.corners(element));
        let beside = corners.map(|&corner| inverse_mass(corner));
        let (count, sum) = beside
            .filter(|&inverse| inverse > 0.0)
            .fold((0.0, 0.0), |(n, sum), inverse| (n + 1.0, sum + inverse));
        if count > 0.0 { sum / count } else { 0.0 }
    }

    /// The particle that has replaced particle `was` in a face or link.
    fn copy(&self, element: usize, was: u32) -> u32 {
        let place = self.adjacency.corners(element).iter().position(|&corner| corner == was);
        place.map_or(was, |place| self.corners[element][place])
    }
}

/// The faces or links around a particle, in groups that stay together.
fn groups_around(
    adjacency: &Adjacency,
    elements: &Elements,
    particle: u32,
    cracks: &Cracks,
) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let is_common_edge = |f: usize, g: usize| {
        let others = adjacency.corners(f).iter().filter(|&&corner| corner != particle);
        let mut common = others.filter(|corner| adjacency.corners(g).contains(corner));
        common.any(|&corner| {
            let edge = [particle.min(corner), particle.max(corner)];
            !cracks.edges.contains(&edge) && elements.hang_together([f, g], particle, corner)
        })
    };
    let hangs_together = |f: usize, g: usize| {
        if adjacency.has_faces() { is_common_edge(f, g) } else { !cracks.particles.contains(&particle) }
    };
    for element in adjacency.around(particle) {
        let (mut together, apart): (Vec<_>, Vec<_>) =
            groups.into_iter().partition(|group| group.iter().any(|&other| hangs_together(element, other)));
        groups = apart;
        let mut group = if together.is_empty() { Vec::new() } else { together.remove(0) };
        group.extend(together.into_iter().flatten());
        group.push(element);
        groups.push(group);
    }
    groups.iter_mut().for_each(|group| group.sort_unstable());
    groups.sort_unstable();
    groups
}

/// The least share of a particle's mass that a copy gets, but for what all shares are above one together.
const LEAST_SHARE: f32 = 0.1;
