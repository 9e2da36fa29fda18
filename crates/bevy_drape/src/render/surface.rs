//! Surfaces of bodies, and their writing into meshes.

use std::sync::Arc;

use bevy::camera::primitives::Aabb;
use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::Topology;

use crate::detail::resampling::resample;
use crate::render::attributes::position_and_normal;
use crate::render::carriers::Carried;
use crate::render::cut_vertices::{CutVertex, write_cut};
use crate::render::entity_space::EntitySpace;
use crate::render::normals::{write_grid_normals, write_smooth_normals};
use crate::render::vertex_map::VertexMap;
use crate::render::vertices::Vertices;

/// Bounds allow for an overhang that has grown so many times since vertices were written.
const OVERHANG_GROWTH: f32 = 2.0;

/// Positions of the particles after one step.
#[derive(Clone, Debug, PartialEq)]
struct StepPositions {
    /// Origin of positions and bounds, so that they are precise far from the world's origin too.
    origin: Vec3,
    positions: Vec<Vec3>,
    low: Vec3,
    high: Vec3,
}

impl StepPositions {
    fn of(particles: &drape_solver::Particles) -> Self {
        let (origin, positions) = (particles.origin(), Vec::with_capacity(particles.len()));
        let mut of_step = Self { origin, positions, low: Vec3::ZERO, high: Vec3::ZERO };
        of_step.read(particles);
        of_step
    }

    /// Returns the positions of some of the particles.
    fn torn(&self, origins: &[u32]) -> Option<Self> {
        let positions = origins.iter().map(|&origin| self.positions.get(origin as usize).copied());
        Some(Self { positions: positions.collect::<Option<_>>()?, ..*self })
    }

    /// Reads the present positions; false if they are not finite.
    fn read(&mut self, particles: &drape_solver::Particles) -> bool {
        self.origin = particles.origin();
        self.positions.clear();
        let (mut low, mut high, mut odd) = (Vec3::INFINITY, Vec3::NEG_INFINITY, Vec3::ZERO);
        self.positions.extend(particles.local_positions().inspect(|&position| {
            (low, high) = (low.min(position), high.max(position));
            // Zero while every number is finite.
            odd += position * 0.0;
        }));
        (self.low, self.high) = (low, high);
        odd == Vec3::ZERO
    }
}

/// Vertices that have been taken out of a mesh to be written.
#[derive(Clone, Debug)]
struct TakenVertices {
    space: EntitySpace,
    /// The shown time, from 0, before the last step, to 1, after it.
    fraction: f32,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    bounds: Option<Aabb>,
}

/// The surface of a body: its last two states, and the state that its mesh shows.
#[derive(Component, Clone, Debug)]
pub(crate) struct Surface {
    pub topology: Arc<Topology>,
    /// Layout of the vertices that the mesh was made for.
    pub layout: [u32; 2],
    /// Mesh that is written.
    pub mesh: AssetId<Mesh>,
    vertices: Vertices,
    /// The vertices behind those, on the edges of cuts and tears.
    cut: Vec<CutVertex>,
    previous: StepPositions,
    current: StepPositions,
    /// Interpolated particles of embedded vertices, kept to allocate nothing per frame.
    between: Vec<Vec3>,
    /// Normals of these particles.
    normals: Vec<Vec3>,
    /// True if the body did not move in the last step.
    is_settled: bool,
    /// Fraction and entity's transform that the mesh was last written for; none if a step was taken since.
    shown: Option<(f32, Affine3A)>,
    /// True if obstacles displaced the mesh when it was last written.
    is_displaced: bool,
    /// Those of its mesh, while they are written.
    taken: Option<TakenVertices>,
    /// The obstacles that displace it.
    pub carried: Carried,
    /// Metres from a vertex to a particle that carries it, at most, when they were last written; zero if vertices are particles.
    overhang: f32,
}

impl Surface {
    /// The surface of a body as it is now.
    pub fn new(particles: &drape_solver::Particles, topology: &Arc<Topology>, layout: [u32; 2]) -> Self {
        let current = StepPositions::of(particles);
        Self {
            topology: Arc::clone(topology),
            layout,
            mesh: AssetId::default(),
            vertices: Vertices::Particles,
            cut: Vec::new(),
            previous: current.clone(),
            current,
            between: Vec::new(),
            normals: Vec::new(),
            is_settled: true,
            shown: None,
            is_displaced: false,
            taken: None,
            carried: Carried::default(),
            overhang: 0.0,
        }
    }

    /// Makes the place `origin` the origin of the world.
    pub fn shift_origin(&mut self, origin: Vec3) {
        self.previous.origin -= origin;
        self.current.origin -= origin;
        self.shown = None;
    }

    /// The surface of a body as it is now, for a mesh with its own vertices.
    pub fn of_mesh(
        particles: &drape_solver::Particles,
        topology: &Arc<Topology>,
        vertices: Vertices,
    ) -> Self {
        Self { vertices, ..Self::new(particles, topology, [0, 0]) }
    }

    /// The surface of a cloth that has just changed its particles, shown as before the change.
    pub fn resampled(
        &self,
        particles: &drape_solver::Particles,
        topology: &Arc<Topology>,
        layout: [u32; 2],
    ) -> Self {
        let positions = resample(&self.current.positions, self.layout, layout);
        let current = StepPositions { positions, ..self.current };
        Self { current, ..Self::new(particles, topology, layout) }
    }

    /// Returns the map from welded vertices to particles, if vertices are welded.
    pub fn welded(&self) -> Option<&VertexMap> {
        match &self.vertices {
            Vertices::Welded(map) => Some(map),
            Vertices::Particles | Vertices::Embedded(_) => None,
        }
    }

    /// Returns the surface of a torn body or piece, whose particles have these `origins`, with these welded vertices if
    /// there are any, and `cut` vertices; none if an origin does not exist.
    pub fn torn(
        &self,
        origins: &[u32],
        topology: &Arc<Topology>,
        vertices: Option<VertexMap>,
        cut: Vec<CutVertex>,
    ) -> Option<Self> {
        Some(Self {
            topology: Arc::clone(topology),
            vertices: vertices.map_or(Vertices::Particles, Vertices::Welded),
            cut,
            previous: self.previous.torn(origins)?,
            current: self.current.torn(origins)?,
            shown: None,
            ..self.clone()
        })
    }

    /// Records the particles after a step. States that are not finite are not shown.
    pub fn record(&mut self, particles: &drape_solver::Particles) {
        if particles.len() != self.current.positions.len() {
            return;
        }
        core::mem::swap(&mut self.previous, &mut self.current);
        if !self.current.read(particles) {
            self.current.clone_from(&self.previous);
        }
        self.is_settled = self.current == self.previous;
        if !self.is_settled {
            self.shown = None;
        }
    }

    /// Shows the particles as they are now, after they went ways that were not recorded.
    pub fn restart(&mut self, particles: &drape_solver::Particles) {
        if self.current.read(particles) {
            self.previous.clone_from(&self.current);
        } else {
            self.current.clone_from(&self.previous);
        }
        (self.is_settled, self.shown) = (true, None);
    }

    /// Notes that the body did not move.
    pub fn settle(&mut self) {
        self.is_settled = true;
    }

    /// True if the mesh must be written to show `fraction` of the last step in `space`.
    pub fn must_be_written(&self, space: &EntitySpace, fraction: f32) -> bool {
        self.is_displaced || self.shown != Some((self.fraction(fraction), space.to_world))
    }

    /// Bounds of what would be written, for every fraction of the last step and displaced by up to `carried` metres.
    pub fn bounds(&self, space: &EntitySpace, fraction: f32, carried: f32) -> Aabb {
        let (previous, current) = (&self.previous, &self.current);
        let from = previous.origin - space.translation;
        let to = current.origin - space.translation;
        let (mut low, mut high) = (to + current.low, to + current.high);
        if self.fraction(fraction) < 1.0 {
            (low, high) = (low.min(from + previous.low), high.max(from + previous.high));
        }
        let margin = carried + OVERHANG_GROWTH * self.overhang;
        space.bounds(low - margin, high + margin)
    }

    /// Takes positions and normals out of `mesh`, for [`write_taken`](Self::write_taken). False if it lacks the right attributes, or if
    /// another surface has taken them.
    pub fn take_vertices(&mut self, mesh: &mut Mesh, space: EntitySpace, fraction: f32) -> bool {
        let Some((positions, normals)) = position_and_normal(mesh) else { return false };
        let fits = self.fits(positions, normals);
        if fits {
            let [positions, normals] = [positions, normals].map(core::mem::take);
            self.taken = Some(TakenVertices { space, fraction, positions, normals, bounds: None });
        }
        fits
    }

    /// Writes the vertices that were taken.
    pub fn write_taken(&mut self) {
        let Some(mut taken) = self.taken.take() else { return };
        let TakenVertices { space, fraction, positions, normals, .. } = &mut taken;
        let carried = core::mem::take(&mut self.carried);
        taken.bounds = Some(self.write_into(positions, normals, space, *fraction, &carried));
        (self.carried, self.taken) = (carried, Some(taken));
    }

    /// True if vertices were taken.
    pub fn has_taken(&self) -> bool {
        self.taken.is_some()
    }

    /// Puts the vertices back that were taken, and returns their bounds.
    pub fn put_back(&mut self, mesh: &mut Mesh) -> Option<Aabb> {
        let TakenVertices { positions, normals, bounds, .. } = self.taken.take()?;
        let (own_positions, own_normals) = position_and_normal(mesh)?;
        (*own_positions, *own_normals) = (positions, normals);
        bounds
    }

    /// True if there are as many positions and normals as vertices.
    fn fits(&self, positions: &[[f32; 3]], normals: &[[f32; 3]]) -> bool {
        let count = self.vertex_count();
        positions.len() == count && normals.len() == count
    }

    /// The number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.vertices.count(self.current.positions.len()) + self.cut.len()
    }

    /// Writes positions and normals, displaced by `carried`, and returns their bounds.
    fn write_into(
        &mut self,
        positions: &mut [[f32; 3]],
        normals: &mut [[f32; 3]],
        space: &EntitySpace,
        fraction: f32,
        carried: &Carried,
    ) -> Aabb {
        let fraction = self.fraction(fraction);
        let (previous, current) = (&self.previous, &self.current);
        let from = previous.origin - space.translation;
        let to = current.origin - space.translation;
        let ends = previous.positions.iter().zip(&current.positions);
        let between = |(&a, &b): (&Vec3, &Vec3)| {
            let (a, b) = (from + a, to + b);
            space.direction(carried.place(a + (b - a) * fraction)).to_array()
        };
        let after = |b: &Vec3| space.direction(carried.place(to + *b)).to_array();
        self.shown = Some((fraction, space.to_world));
        self.is_displaced = !carried.is_empty();
        let count = positions.len() - self.cut.len();
        let (cut_positions, cut_normals) = (&mut *positions, &mut *normals);
        let (positions, normals) = (&mut cut_positions[..count], &mut cut_normals[..count]);
        match &self.vertices {
            Vertices::Particles => {
                if fraction < 1.0 {
                    positions.iter_mut().zip(ends).for_each(|(vertex, ends)| *vertex = between(ends));
                } else {
                    positions.iter_mut().zip(&current.positions).for_each(|(vertex, b)| *vertex = after(b));
                }
                match self.columns() {
                    Some(columns) => write_grid_normals(positions, columns, space.orientation, normals),
                    None => {
                        write_smooth_normals(positions, self.topology.faces(), space.orientation, normals);
                    }
                }
            }
            Vertices::Welded(vertices) => {
                for (vertex, particle) in positions.iter_mut().zip(&*vertices.particles) {
                    let Some(i) = particle.map(|particle| particle as usize) else { continue };
                    let ends = (&previous.positions[i], &current.positions[i]);
                    *vertex = if fraction < 1.0 { between(ends) } else { after(ends.1) };
                }
                vertices.groups().write_normals(positions, normals);
            }
            Vertices::Embedded(vertices) => {
                // Each particle carries several vertices. World directions keep offsets at right angles to triangles.
                self.between.clear();
                self.between.extend(ends.map(|(&a, &b)| {
                    let (a, b) = (from + a, to + b);
                    carried.place(if fraction < 1.0 { a + (b - a) * fraction } else { b })
                }));
                let (mut low, mut high, mut overhang) = (Vec3::INFINITY, Vec3::NEG_INFINITY, 0.0_f32);
                vertices.embedding.write_normals(&self.topology, |i| self.between[i], &mut self.normals);
                let places = vertices.embedding.places(|i| self.between[i], &self.normals);
                for (i, (vertex, place)) in positions.iter_mut().zip(places).enumerate() {
                    let carrier = self.between[vertices.embedding.carrier(i) as usize];
                    overhang = overhang.max(place.distance_squared(carrier));
                    let place = space.direction(place);
                    (low, high) = (low.min(place), high.max(place));
                    *vertex = place.to_array();
                }
                vertices.groups.write_normals(positions, normals);
                // Vertices may lie outside the particles that carry them.
                self.overhang = overhang.sqrt();
                return Aabb::from_min_max(low, high);
            }
        }
        self.overhang = write_cut(&self.cut, space, cut_positions, cut_normals);
        self.bounds(space, fraction, carried.greatest)
    }

    /// Writes the last state into a new mesh, and returns its bounds; none if either is not possible.
    pub fn write_now(&mut self, mesh: &mut Mesh, transform: &GlobalTransform) -> Option<Aabb> {
        let space = EntitySpace::new(transform)?;
        let (positions, normals) = position_and_normal(mesh)?;
        self.fits(positions, normals).then(|| self.write_into(positions, normals, &space, 1.0, &default()))
    }

    /// The corners of a box around the last two states, in the world.
    pub fn corners(&self) -> [Vec3; 2] {
        let [a, b] = [&self.previous, &self.current]
            .map(|state| [state.origin + state.low, state.origin + state.high]);
        [a[0].min(b[0]), a[1].max(b[1])]
    }

    /// True if the body moved in the last step.
    pub fn is_moving(&self) -> bool {
        !self.is_settled
    }

    /// The number of columns, if it is a whole grid: tears add particles, pieces have fewer faces, and cuts leave parts of faces.
    fn columns(&self) -> Option<usize> {
        let [columns, rows] = self.layout.map(|count| count as usize);
        let squares = columns.saturating_sub(1) * rows.saturating_sub(1);
        let is_whole = self.topology.particle_count() == columns * rows
            && squares > 0
            && self.topology.faces().len() == 2 * squares
            && self.topology.face_parts().is_empty();
        is_whole.then_some(columns)
    }

    fn fraction(&self, fraction: f32) -> f32 {
        if self.is_settled { 1.0 } else { fraction }
    }
}
