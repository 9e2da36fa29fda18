//! Maps welded vertices to particles.

use std::collections::HashMap;
use std::sync::Arc;

use drape_solver::Topology;

use crate::render::smoothing::SmoothingGroups;

/// The particles of a mesh's vertices. Several vertices may be one particle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct VertexMap {
    /// The particle of each vertex; vertices without one stay in place.
    pub particles: Arc<[Option<u32>]>,
    /// The triangles of the mesh whose corners have particles.
    triangles: Vec<[u32; 3]>,
    /// Vertices of a particle that share a normal.
    groups: SmoothingGroups,
}

/// Vertices of a torn body or piece, but for those on the edges of cuts and tears.
pub(crate) struct TornVertices {
    pub map: VertexMap,
    /// For each vertex, the vertex that it came from.
    pub origins: Vec<u32>,
}

impl VertexMap {
    /// Maps a mesh with these triangles of vertices at `positions`, and with normals if it has any.
    pub fn new(
        particles: Vec<Option<u32>>,
        positions: &[[f32; 3]],
        normals: Option<&[[f32; 3]]>,
        mut triangles: Vec<[u32; 3]>,
    ) -> Self {
        triangles.retain(|triangle| triangle.iter().all(|&corner| particles[corner as usize].is_some()));
        let groups = SmoothingGroups::new(particles.iter().copied(), positions, normals, &triangles);
        Self { particles: particles.into(), triangles, groups }
    }

    /// Returns the vertices of a piece with particles from `origins` and the faces of `topology`. A vertex of a split
    /// particle is duplicated for each part.
    pub fn torn(&self, origins: &[u32], topology: &Topology) -> TornVertices {
        // Remaining faces: from the sorted original particles of the corners to the present ones, of which a face that was cut
        // has several.
        let was = |corner: u32| (origins[corner as usize], corner);
        let mut left: HashMap<[u32; 3], Vec<[u32; 3]>> = HashMap::new();
        for face in topology.faces() {
            let mut corners = face.map(was);
            corners.sort_unstable();
            left.entry(corners.map(|(was, _)| was)).or_default().push(corners.map(|(_, is)| is));
        }
        let (mut vertices, mut firsts) = (Numbers::default(), Numbers::default());
        let (mut triangles, mut faces) = (Vec::new(), Vec::new());
        for (triangle, face) in self.triangles.iter().zip(&self.groups.faces) {
            let Some(mut was) = self.corners(triangle) else { continue };
            was.sort_unstable();
            for is in left.get(&was).into_iter().flatten() {
                let now = |vertex: u32| {
                    let particle = self.particles[vertex as usize];
                    let place = was.iter().position(|&was| Some(was) == particle).unwrap_or_default();
                    (vertex, is[place])
                };
                triangles.push(triangle.map(|vertex| vertices.number(now(vertex))));
                faces.push(face.map(now));
            }
        }
        // The first vertex of a group may be gone; then the first remaining one takes its place.
        let first: Vec<u32> = vertices
            .known
            .iter()
            .map(|&(vertex, particle)| firsts.number((self.groups.first[vertex as usize], particle)))
            .collect();
        let mut leaders = vec![u32::MAX; firsts.known.len()];
        for (vertex, &group) in (0..).zip(&first) {
            let leader = &mut leaders[group as usize];
            *leader = vertex.min(*leader);
        }
        let leader = |group: u32| leaders[group as usize];
        let faces = faces.into_iter().map(|face| face.map(|corner| leader(firsts.number(corner)))).collect();
        let groups = SmoothingGroups { first: first.into_iter().map(leader).collect(), faces };
        let map = Self {
            particles: vertices.known.iter().map(|&(_, particle)| Some(particle)).collect(),
            triangles,
            groups,
        };
        TornVertices { map, origins: vertices.known.iter().map(|&(vertex, _)| vertex).collect() }
    }

    fn corners(&self, triangle: &[u32; 3]) -> Option<[u32; 3]> {
        let [a, b, c] = triangle.map(|vertex| self.particles[vertex as usize]);
        Some([a?, b?, c?])
    }

    /// The triangles of the mesh.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Vertices that share a normal.
    pub fn groups(&self) -> &SmoothingGroups {
        &self.groups
    }
}

/// Numbers pairs in the order of first use.
#[derive(Default)]
struct Numbers {
    known: Vec<(u32, u32)>,
    numbers: HashMap<(u32, u32), u32>,
}

impl Numbers {
    fn number(&mut self, pair: (u32, u32)) -> u32 {
        *self.numbers.entry(pair).or_insert_with(|| {
            self.known.push(pair);
            self.known.len() as u32 - 1
        })
    }
}
