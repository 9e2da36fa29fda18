//! The surface of a topology for contacts at the level of triangles: its elements in a tree of patches.
//!
//! An *element* is a face, a link of a rope, or a particle that belongs to neither. Elements share corners and edges;
//! one of them alone, the owner, tests each corner and each edge (the representative triangles of Curtis et al. 2008).
//! Pairs of elements then cover each pair of a corner and a face, and each pair of edges, once.
//!
//! The tree is made once for a topology, from the rest positions. A node is a patch of neighbours:
//! `broad_phase/surface_pairs.rs` puts boxes around the patches and finds the pairs that could touch.
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

use crate::constants::ELEMENTS_OF_LEAF;
use crate::state::topology::Topology;

/// A face; or a link, which repeats its last corner; or a particle, which has the same corner three times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfaceElement {
    /// Its corners, by slot and by index.
    pub slots: [u32; 3],
    pub indices: [u32; 3],
    /// Bit masks of the corners and edges that it owns; edge `k` goes from corner `k` to the next.
    pub corners: u8,
    pub edges: u8,
}

impl SurfaceElement {
    /// True if it has three different corners.
    pub fn is_face(&self) -> bool {
        self.slots[1] != self.slots[2]
    }

    /// The places of the ends of its edge `k` among its corners.
    pub fn edge(k: usize) -> [usize; 2] {
        [k, (k + 1) % 3]
    }

    /// Bits of the edges that it has.
    pub fn all_edges(&self) -> u8 {
        if self.is_face() { 0b111 } else { 0b001 }
    }
}

/// A patch: the elements `first..first + count`. The left half follows it in the list of nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub first: u32,
    pub count: u32,
    /// The right half; 0 in a leaf.
    pub right: u32,
    /// True if its elements are connected by shared corners.
    pub is_connected: bool,
}

/// The elements of a body, patch by patch.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceTree {
    pub elements: Vec<SurfaceElement>,
    pub nodes: Vec<Node>,
    /// Length of the longest edge at rest, in metres.
    pub longest_edge: f32,
}

impl SurfaceTree {
    /// The tree of a topology.
    pub fn new(topology: &Topology) -> Self {
        let mut elements = elements(topology);
        let rest = |index: u32| topology.rest.get(index as usize).copied().unwrap_or_default();
        let mut builder = Builder {
            centres: elements
                .iter()
                .map(|e| e.indices.iter().map(|&i| rest(i)).sum::<Vec3>() / 3.0)
                .collect(),
            groups: (0..topology.particle_count() as u32).collect(),
            nodes: Vec::new(),
        };
        let mut order: Vec<u32> = (0..elements.len() as u32).collect();
        if !order.is_empty() {
            builder.split(&mut order, 0, &elements);
        }
        elements = order.iter().map(|&place| elements[place as usize]).collect();
        let edges = elements
            .iter()
            .flat_map(|e| [0, 1, 2].map(|k| SurfaceElement::edge(k).map(|c| rest(e.indices[c]))));
        let longest_edge = edges.map(|[a, b]| a.distance(b)).fold(0.0, f32::max);
        Self { elements, nodes: builder.nodes, longest_edge }
    }
}

/// A box in space, in metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub low: Vec3,
    pub high: Vec3,
}

impl Bounds {
    pub const NOTHING: Self = Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };

    /// The box around some points.
    pub fn of(points: &[Vec3]) -> Self {
        points.iter().fold(Self::NOTHING, |all, &p| Self { low: all.low.min(p), high: all.high.max(p) })
    }

    pub fn and(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The same, wider by `margin` on all sides.
    pub fn grown(self, margin: f32) -> Self {
        Self { low: self.low - margin, high: self.high + margin }
    }

    /// True if the two overlap.
    pub fn meets(&self, other: &Self) -> bool {
        (self.low.cmple(other.high) & self.high.cmpge(other.low)).all()
    }
}

/// Faces, links, and particles that have neither; each owns the corners and edges that none before it has.
fn elements(topology: &Topology) -> Vec<SurfaceElement> {
    let links = topology.segments.iter().map(|&[a, b]| [a, b, b]);
    let mut all: Vec<[u32; 3]> = topology.faces.iter().copied().chain(links).collect();
    let mut has_owner = vec![false; topology.particle_count()];
    all.iter().flatten().for_each(|&corner| has_owner[corner as usize] = true);
    all.extend((0..).zip(&has_owner).filter(|(_, has)| !**has).map(|(corner, _)| [corner; 3]));
    has_owner.fill(false);
    // Edges, each with the element that has it: sorted, so that those of one edge follow each other.
    let mut edges: Vec<([u32; 2], u32, u8)> = Vec::new();
    let mut elements: Vec<SurfaceElement> = Vec::with_capacity(all.len());
    for (place, indices) in (0..).zip(all) {
        let slots = indices.map(|index| topology.layout.slot(index as usize) as u32);
        let mut element = SurfaceElement { slots, indices, corners: 0, edges: 0 };
        for (k, corner) in indices.into_iter().enumerate() {
            let owner = &mut has_owner[corner as usize];
            element.corners |= u8::from(!*owner) << k;
            *owner = true;
        }
        for k in (0..3).filter(|k| element.all_edges() & (1 << k) != 0) {
            let [a, b] = SurfaceElement::edge(k).map(|c| indices[c]);
            edges.push(([a.min(b), a.max(b)], place, k as u8));
        }
        elements.push(element);
    }
    edges.sort_unstable();
    for (i, &(edge, element, k)) in edges.iter().enumerate() {
        if i == 0 || edges[i - 1].0 != edge {
            elements[element as usize].edges |= 1 << k;
        }
    }
    elements
}

struct Builder {
    /// Centres of the elements at rest, in metres.
    centres: Vec<Vec3>,
    /// Union-find: for each particle, its parent in its group.
    groups: Vec<u32>,
    nodes: Vec<Node>,
}

impl Builder {
    /// Makes the node of these elements, which begin at number `first`, and the nodes below it.
    fn split(&mut self, order: &mut [u32], first: usize, elements: &[SurfaceElement]) {
        let place = self.nodes.len();
        let is_connected = self.is_connected(order, elements);
        let (first_element, count) = (first as u32, order.len() as u32);
        self.nodes.push(Node { first: first_element, count, right: 0, is_connected });
        if order.len() <= ELEMENTS_OF_LEAF {
            return;
        }
        let centres = &self.centres;
        let around = order.iter().fold(Bounds::NOTHING, |all, &e| {
            let centre = centres[e as usize];
            all.and(Bounds { low: centre, high: centre })
        });
        let size = (around.high - around.low).to_array();
        let axis = (1..3).fold(0, |longest, axis| if size[axis] > size[longest] { axis } else { longest });
        let middle = order.len() / 2;
        order.select_nth_unstable_by(middle, |&a, &b| {
            centres[a as usize][axis].total_cmp(&centres[b as usize][axis]).then(a.cmp(&b))
        });
        let (left, right) = order.split_at_mut(middle);
        self.split(left, first, elements);
        self.nodes[place].right = self.nodes.len() as u32;
        self.split(right, first + middle, elements);
    }

    /// True if these elements are connected by shared corners.
    fn is_connected(&mut self, order: &[u32], elements: &[SurfaceElement]) -> bool {
        let groups = &mut self.groups;
        let corners = || order.iter().flat_map(|&e| elements[e as usize].indices);
        corners().for_each(|corner| groups[corner as usize] = corner);
        for &element in order {
            let [a, b, c] = elements[element as usize].indices.map(|corner| root(groups, corner));
            let least = a.min(b).min(c);
            [a, b, c].into_iter().for_each(|group| groups[group as usize] = least);
        }
        let mut roots = corners().map(|corner| root(groups, corner));
        let first = roots.next();
        roots.all(|group| Some(group) == first)
    }
}

fn root(groups: &mut [u32], mut particle: u32) -> u32 {
    while groups[particle as usize] != particle {
        let parent = groups[particle as usize];
        groups[particle as usize] = groups[parent as usize];
        particle = groups[particle as usize];
    }
    particle
}
