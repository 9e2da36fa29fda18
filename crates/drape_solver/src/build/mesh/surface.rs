//! The repaired surface of a mesh: its triangles, their edges and bends, and one winding for all.
//!
//! Design: `docs/design/cloth_from_meshes.md`.

use std::collections::{HashMap, HashSet};

use glam::Vec3;

use crate::build::mesh::error::MeshRepairs;
use crate::union_find::Groups;

/// A triangle whose height is at most this part of its longest edge counts as a line.
const LEAST_HEIGHT: f64 = 1e-5;

/// The surface of a mesh with welded vertices.
pub(crate) struct MeshSurface {
    /// Triangles that have an area, each once.
    pub faces: Vec<[u32; 3]>,
    /// Edges in the order in which triangles name them; those of triangles with an area come first.
    pub edges: Vec<[u32; 2]>,
    /// Pairs of corners that face each other across an edge of two triangles, unless an edge joins them.
    pub bends: Vec<[u32; 2]>,
    /// Triangles without an area, unchanged.
    pub lines: Vec<[u32; 3]>,
    pub repairs: MeshRepairs,
}

/// The triangles at an edge, each with the corner at which the edge begins in the triangle's winding.
type EdgeFaces = Vec<(usize, u32)>;

impl MeshSurface {
    /// The surface of `faces` with welded corners.
    pub fn new(positions: &[Vec3], faces: impl IntoIterator<Item = [u32; 3]>) -> Self {
        let (mut kept, mut lines) = (Vec::new(), Vec::new());
        let mut seen = HashSet::new();
        let mut repairs = MeshRepairs::default();
        for face in faces {
            let mut corners = face;
            corners.sort_unstable();
            if is_empty(face.map(|corner| positions[corner as usize])) {
                repairs.empty_faces += 1;
                lines.push(face);
            } else if seen.insert(corners) {
                kept.push(face);
            } else {
                repairs.repeated_faces += 1;
            }
        }
        let mut surface = Self { faces: kept, edges: Vec::new(), bends: Vec::new(), lines, repairs };
        let joints = surface.join();
        surface.turn(&joints);
        surface.repairs.bow_ties = surface.bow_ties(&joints);
        surface.join_lines();
        surface
    }

    /// The number of edges that an odd number of triangles share: those around holes.
    pub fn open_edges(&self) -> usize {
        let faces = self.faces.iter().chain(&self.lines).copied();
        let edges = faces.flat_map(sides).filter(|[from, to]| from != to).map(unordered);
        let mut edges: Vec<[u32; 2]> = edges.collect();
        edges.sort_unstable();
        edges.chunk_by(|a, b| a == b).filter(|same| same.len() % 2 == 1).count()
    }

    /// Lists edges and bends. Returns the triangles at each edge, in the order of edges.
    fn join(&mut self) -> Vec<EdgeFaces> {
        let mut numbers: HashMap<[u32; 2], usize> = HashMap::new();
        let mut joints: Vec<EdgeFaces> = Vec::new();
        for (number, &face) in self.faces.iter().enumerate() {
            for [from, to] in sides(face) {
                let edge = *numbers.entry(unordered([from, to])).or_insert_with(|| {
                    self.edges.push([from, to]);
                    joints.push(Vec::new());
                    joints.len() - 1
                });
                joints[edge].push((number, from));
            }
        }
        let mut joined: HashSet<[u32; 2]> = HashSet::new();
        for (edge, joint) in self.edges.iter().zip(&joints) {
            match joint[..] {
                [(a, _), (b, _)] => {
                    let across = [a, b].map(|face| opposite(self.faces[face], *edge));
                    if !numbers.contains_key(&unordered(across)) && joined.insert(unordered(across)) {
                        self.bends.push(across);
                    }
                }
                [_] => {}
                _ => self.repairs.crowded_edges += 1,
            }
        }
        joints
    }

    /// Gives all triangles of each piece the same winding, and reverses as few as possible.
    fn turn(&mut self, joints: &[EdgeFaces]) {
        let mut neighbours: Vec<Vec<(usize, bool)>> = vec![Vec::new(); self.faces.len()];
        for joint in joints {
            if let [(a, from), (b, other)] = joint[..] {
                // Two triangles of the same winding traverse their common edge in opposite directions.
                neighbours[a].push((b, from == other));
                neighbours[b].push((a, from == other));
            }
        }
        let mut turns: Vec<Option<bool>> = vec![None; self.faces.len()];
        for first in 0..self.faces.len() {
            if turns[first].is_some() {
                continue;
            }
            turns[first] = Some(false);
            let mut piece = vec![first];
            let mut is_one_sided = false;
            let mut next = 0;
            while let Some(&face) = piece.get(next) {
                next += 1;
                let turn = turns[face] == Some(true);
                for &(other, differs) in &neighbours[face] {
                    match turns[other] {
                        None => {
                            turns[other] = Some(turn != differs);
                            piece.push(other);
                        }
                        Some(known) => is_one_sided |= known != (turn != differs),
                    }
                }
            }
            if is_one_sided {
                self.repairs.one_sided_pieces += 1;
                continue;
            }
            let turned = piece.iter().filter(|&&face| turns[face] == Some(true)).count();
            let fewer = 2 * turned <= piece.len();
            for &face in piece.iter().filter(|&&face| turns[face] == Some(fewer)) {
                self.faces[face].swap(1, 2);
                self.repairs.turned_faces += 1;
            }
        }
    }

    /// The number of vertices whose triangles are not all joined by edges at that vertex.
    fn bow_ties(&self, joints: &[EdgeFaces]) -> usize {
        // Corner `k` of triangle `f` has the number `3 f + k`. Corners that an edge joins form a group.
        let mut groups = Groups::new(3 * self.faces.len());
        let corner = |face: usize, vertex: u32| {
            (3 * face + self.faces[face].iter().position(|&corner| corner == vertex).unwrap_or_default())
                as u32
        };
        for (edge, joint) in self.edges.iter().zip(joints) {
            for pair in joint.windows(2) {
                for &end in edge {
                    groups.join(corner(pair[0].0, end), corner(pair[1].0, end));
                }
            }
        }
        let mut fans: HashMap<u32, u32> = HashMap::new();
        let mut torn = HashSet::new();
        for (face, corners) in self.faces.iter().enumerate() {
            for (k, &vertex) in corners.iter().enumerate() {
                let fan = groups.root((3 * face + k) as u32);
                if *fans.entry(vertex).or_insert(fan) != fan {
                    torn.insert(vertex);
                }
            }
        }
        torn.len()
    }

    /// Adds edges of triangles without an area if they join vertices of other triangles, so that both sides of such a line
    /// stay joined.
    fn join_lines(&mut self) {
        let corners: HashSet<u32> = self.faces.iter().flatten().copied().collect();
        let mut joined: HashSet<[u32; 2]> =
            self.edges.iter().chain(&self.bends).map(|&ends| unordered(ends)).collect();
        for [from, to] in self.lines.iter().copied().flat_map(sides) {
            if from != to
                && corners.contains(&from)
                && corners.contains(&to)
                && joined.insert(unordered([from, to]))
            {
                self.edges.push([from, to]);
            }
        }
    }
}

/// Twice the area of a triangle in m^2, in double precision, as small areas vanish in single precision.
pub(crate) fn double_area(corners: [Vec3; 3]) -> f64 {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    (b - a).cross(c - a).length()
}

fn is_empty(corners: [Vec3; 3]) -> bool {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
    double_area(corners) <= LEAST_HEIGHT * longest
}

pub(crate) fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

pub(crate) fn unordered([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The corner of a triangle opposite to `edge`.
pub(crate) fn opposite(face: [u32; 3], edge: [u32; 2]) -> u32 {
    face.into_iter().find(|corner| !edge.contains(corner)).unwrap_or(face[0])
}
