//! The splitting of particles along cracks, so that a mesh opens.
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
//! Faces that meet at a particle stay together if they share an edge that is not cracked. Each group of them gets a
//! particle of its own, so that no face is lost and none hangs on another by a corner alone.

use std::collections::BTreeSet;

use crate::build::adjacency::Fabric;

/// Where a body comes apart.
#[derive(Default)]
pub(crate) struct Cracks {
    /// Edges of faces, lower index first.
    pub edges: BTreeSet<[u32; 2]>,
    /// Particles at which links part.
    pub particles: BTreeSet<u32>,
}

impl Cracks {
    pub fn add_edge(&mut self, a: u32, b: u32) {
        self.edges.insert([a.min(b), a.max(b)]);
    }

    fn has_edge(&self, a: u32, b: u32) -> bool {
        self.edges.contains(&[a.min(b), a.max(b)])
    }

    /// The particles that may be split, in order.
    fn touched(&self) -> BTreeSet<u32> {
        self.edges.iter().flatten().chain(&self.particles).copied().collect()
    }
}

/// A body's fabric with its cracks open. Particles keep their indices; copies come behind them.
pub(crate) struct Split<'a> {
    pub fabric: Fabric<'a>,
    /// The corners of each face, or the ends of each link and the second of them again.
    corners: Vec<[u32; 3]>,
    /// For each particle which it was.
    pub origins: Vec<u32>,
    /// The part that each has of the mass of the particle that it was.
    pub shares: Vec<f32>,
    /// Whether sticks may have to be joined anew that begin or end at a particle.
    is_near: Vec<bool>,
}

impl<'a> Split<'a> {
    /// Opens the cracks; none if nothing parts.
    pub fn new(fabric: Fabric<'a>, cracks: &Cracks) -> Option<Self> {
        let count = fabric.topology().particle_count();
        let all = |element: usize| match *fabric.corners(element) {
            [a, b, c] => [a, b, c],
            [a, b] => [a, b, b],
            _ => [0; 3],
        };
        let mut split = Self {
            corners: (0..fabric.len()).map(all).collect(),
            origins: (0..count as u32).collect(),
            shares: vec![1.0; count],
            is_near: vec![false; count],
            fabric,
        };
        for particle in cracks.touched() {
            split.part(particle, cracks);
        }
        (split.origins.len() > count).then_some(split)
    }

    /// Gives each group of faces around a particle a particle of its own; the largest group keeps the one there is.
    fn part(&mut self, particle: u32, cracks: &Cracks) {
        let Self { fabric, corners, origins, shares, is_near } = self;
        let mut groups = groups_around(fabric, particle, cracks);
        for corner in fabric.around(particle).flat_map(|element| fabric.corners(element)) {
            is_near[*corner as usize] = true;
        }
        if groups.len() < 2 {
            return;
        }
        let size = |group: &Vec<usize>| group.iter().map(|&element| fabric.size(element)).sum::<f32>();
        let total: f32 = groups.iter().map(size).sum();
        let equal = 1.0 / groups.len() as f32;
        let share = |group: &Vec<usize>| if total > 0.0 { size(group) / total } else { equal };
        // Stable: of equal ones, the group with the first face stays.
        groups.sort_by(|p, q| size(q).total_cmp(&size(p)));
        shares[particle as usize] = share(&groups[0]);
        for group in &groups[1..] {
            let copy = origins.len() as u32;
            origins.push(particle);
            shares.push(share(group));
            for &element in group {
                for (corner, &was) in corners[element].iter_mut().zip(fabric.corners(element)) {
                    if was == particle {
                        *corner = copy;
                    }
                }
                if !fabric.has_faces() {
                    corners[element][2] = corners[element][1];
                }
            }
        }
    }

    /// The corners of each face.
    pub fn faces(&self) -> &[[u32; 3]] {
        if self.fabric.has_faces() { &self.corners } else { &[] }
    }

    /// The ends of each link.
    pub fn segments(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let links = if self.fabric.has_faces() { &[] } else { &*self.corners };
        links.iter().map(|&[a, b, _]| [a, b])
    }

    /// The corners of all faces or links.
    pub fn corners(&self) -> &[[u32; 3]] {
        &self.corners
    }

    /// The particles near cracks, in order.
    pub fn near(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.is_near.len() as u32).filter(|&particle| self.is_near[particle as usize])
    }

    /// Whether a stick between these particles may have been severed.
    pub fn may_concern(&self, [a, b]: [u32; 2]) -> bool {
        self.is_near[a as usize] || self.is_near[b as usize]
    }

    /// Which particles the stick that joined `a` and `b` joins now: none if it is severed, and several where each side of
    /// a crack has one of its own.
    ///
    /// A stick along an edge goes with the faces at that edge. One across an edge, between the far corners of its two
    /// faces, is severed with it. One that skips a particle goes on where both of its halves meet in one.
    pub fn joined(&self, [a, b]: [u32; 2], joined: &mut Vec<[u32; 2]>) {
        joined.clear();
        let fabric = &self.fabric;
        let has = |element: usize, particle: u32| fabric.corners(element).contains(&particle);
        for element in fabric.around(a).filter(|&element| has(element, b)) {
            joined.push([self.copy(element, a), self.copy(element, b)]);
        }
        if joined.is_empty() {
            let pairs = || fabric.around(a).flat_map(|f| fabric.around(b).map(move |g| (f, g)));
            let common = |[f, g]: [&[u32]; 2]| f.iter().filter(|corner| g.contains(corner)).count();
            let mut across =
                pairs().filter(|&(f, g)| common([f, g].map(|e| fabric.corners(e))) >= 2).peekable();
            if across.peek().is_some() {
                let is_whole = |&(f, g): &(usize, usize)| common([f, g].map(|e| &self.corners[e][..])) >= 2;
                joined.extend(across.filter(is_whole).map(|(f, g)| [self.copy(f, a), self.copy(g, b)]));
            } else if let Some(middle) = self.middle([a, b]) {
                let meet = pairs().filter(|&(f, g)| has(f, middle) && has(g, middle));
                let is_whole = |&(f, g): &(usize, usize)| self.copy(f, middle) == self.copy(g, middle);
                joined.extend(meet.filter(is_whole).map(|(f, g)| [self.copy(f, a), self.copy(g, b)]));
            } else {
                // No fabric carries it.
                joined.push([a, b]);
            }
        }
        joined.sort_unstable();
        joined.dedup();
    }

    /// The common neighbour of two particles that lies nearest to the middle between them at rest.
    fn middle(&self, [a, b]: [u32; 2]) -> Option<u32> {
        let (fabric, rest) = (&self.fabric, &self.fabric.topology().rest);
        let middle = (rest[a as usize] + rest[b as usize]) * 0.5;
        let neighbours = |of: u32| {
            fabric.around(of).flat_map(|element| fabric.corners(element)).copied().filter(move |&c| c != of)
        };
        let common = neighbours(a).filter(|&m| neighbours(b).any(|other| other == m));
        let off = |&m: &u32| rest[m as usize].distance_squared(middle);
        common.min_by(|p, q| off(p).total_cmp(&off(q)).then(p.cmp(q)))
    }

    /// What particle `was` has become in a face or link.
    fn copy(&self, element: usize, was: u32) -> u32 {
        let place = self.fabric.corners(element).iter().position(|&corner| corner == was);
        place.map_or(was, |place| self.corners[element][place])
    }
}

/// The faces or links around a particle, in groups that stay together.
fn groups_around(fabric: &Fabric, particle: u32, cracks: &Cracks) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let is_common_edge = |f: usize, g: usize| {
        let others = fabric.corners(f).iter().filter(|&&corner| corner != particle);
        let mut common = others.filter(|corner| fabric.corners(g).contains(corner));
        common.any(|&corner| !cracks.has_edge(particle, corner))
    };
    let hangs_together = |f: usize, g: usize| {
        if fabric.has_faces() { is_common_edge(f, g) } else { !cracks.particles.contains(&particle) }
    };
    for element in fabric.around(particle) {
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
