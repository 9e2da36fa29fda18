//! Surfaces of bodies, and their writing into meshes.

use std::borrow::Cow;
use std::sync::Arc;

use bevy::camera::primitives::Aabb;
use bevy::math::{Affine3A, Mat3A, Vec3A};
use bevy::mesh::{Indices, VertexAttributeValues};
use bevy::prelude::*;
use drape_solver::Topology;

use crate::build::cloth::Cloth;
use crate::build::soft_ball::SoftBall;
use crate::detail::level::CurrentDetail;
use crate::detail::resampling::resample;
use crate::render::carriers::Carried;
use crate::render::normals::{write_grid_normals, write_smooth_normals};
use crate::render::vertex_map::VertexMap;
use crate::render::vertices::Vertices;

/// Bounds allow for an overhang that has grown so many times since vertices were last written.
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

/// The surface of a body: its last two states, and the state that its mesh shows.
#[derive(Component, Clone, Debug)]
pub(crate) struct Surface {
    pub topology: Arc<Topology>,
    /// Layout of the vertices that the mesh was made for.
    pub layout: [u32; 2],
    /// Mesh that is written.
    pub mesh: AssetId<Mesh>,
    vertices: Vertices,
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
    /// Metres by which vertices lay outside the box around the particles that carry them, when they were last written.
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
            previous: current.clone(),
            current,
            between: Vec::new(),
            normals: Vec::new(),
            is_settled: true,
            shown: None,
            is_displaced: false,
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
    /// there are any; none if an origin does not exist.
    pub fn torn(
        &self,
        origins: &[u32],
        topology: &Arc<Topology>,
        vertices: Option<VertexMap>,
    ) -> Option<Self> {
        Some(Self {
            topology: Arc::clone(topology),
            vertices: vertices.map_or(Vertices::Particles, Vertices::Welded),
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
    #[cfg(feature = "gpu")]
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

    /// Bounds of what [`write`](Self::write) would write, for every fraction of the last step, displaced by up to `carried` metres.
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

    /// Writes positions and normals into `mesh`, displaced by `carried`, and returns bounds that hold for every fraction of the last step;
    /// none if the mesh lacks the right attributes.
    pub fn write(
        &mut self,
        mesh: &mut Mesh,
        space: &EntitySpace,
        fraction: f32,
        carried: &Carried,
    ) -> Option<Aabb> {
        let (positions, normals) = position_and_normal(mesh)?;
        let count = self.vertices.count(self.current.positions.len());
        if positions.len() != count || normals.len() != count {
            return None;
        }
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
        match &self.vertices {
            Vertices::Particles => {
                if fraction < 1.0 {
                    positions.iter_mut().zip(ends).for_each(|(vertex, ends)| *vertex = between(ends));
                } else {
                    positions.iter_mut().zip(&current.positions).for_each(|(vertex, b)| *vertex = after(b));
                }
                match self.topology.grid_size() {
                    Some([columns, _]) => write_grid_normals(positions, columns, space.orientation, normals),
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
                let nothing = [Vec3::INFINITY, Vec3::NEG_INFINITY];
                let ([mut low, mut high], [mut local_low, mut local_high]) = (nothing, nothing);
                vertices.embedding.write_normals(&self.topology, |i| self.between[i], &mut self.normals);
                let places = vertices.embedding.places(|i| self.between[i], &self.normals);
                for (vertex, place) in positions.iter_mut().zip(places) {
                    (low, high) = (low.min(place), high.max(place));
                    let place = space.direction(place);
                    (local_low, local_high) = (local_low.min(place), local_high.max(place));
                    *vertex = place.to_array();
                }
                vertices.groups.write_normals(positions, normals);
                // Vertices may lie outside the particles that carry them.
                let carriers = self.between.iter().copied();
                let inside = [carriers.clone().fold(high, Vec3::min), carriers.fold(low, Vec3::max)];
                self.overhang = (inside[0] - low).max(high - inside[1]).max_element().max(0.0);
                return Some(Aabb::from_min_max(local_low, local_high));
            }
        }
        Some(self.bounds(space, fraction, carried.greatest))
    }

    /// Writes the last state into a new mesh, and returns its bounds; none if either is not possible.
    pub fn write_now(&mut self, mesh: &mut Mesh, transform: &GlobalTransform) -> Option<Aabb> {
        let space = EntitySpace::new(transform)?;
        self.write(mesh, &space, 1.0, &default())
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

    fn fraction(&self, fraction: f32) -> f32 {
        if self.is_settled { 1.0 } else { fraction }
    }
}

/// The transform from the world into an entity's coordinates.
pub(crate) struct EntitySpace {
    to_world: Affine3A,
    pub translation: Vec3,
    /// Inverse of rotation and scale; none for the identity, so that numbers are copied exactly.
    to_local: Option<Mat3A>,
    /// -1 for a mirroring transform, which reverses faces, else 1.
    orientation: f32,
}

impl EntitySpace {
    /// None if the transform cannot be inverted: a scale of zero, or values that are not finite.
    pub fn new(transform: &GlobalTransform) -> Option<Self> {
        let to_world = transform.affine();
        let matrix = to_world.matrix3;
        let to_local = (matrix != Mat3A::IDENTITY).then(|| matrix.inverse());
        let is_usable = to_world.is_finite() && to_local.is_none_or(|inverse| inverse.is_finite());
        is_usable.then(|| Self {
            to_world,
            translation: to_world.translation.into(),
            to_local,
            orientation: matrix.determinant().signum(),
        })
    }

    /// The inverse of rotation and scale.
    #[cfg(feature = "gpu")]
    pub fn to_local(&self) -> Mat3 {
        self.to_local.map_or(Mat3::IDENTITY, Mat3::from)
    }

    /// Transforms a world offset from the entity into its coordinates.
    fn direction(&self, offset: Vec3) -> Vec3 {
        self.to_local.map_or(offset, |to_local| to_local * offset)
    }

    /// Returns the box in the entity's coordinates around a box between two world offsets.
    pub fn bounds(&self, low: Vec3, high: Vec3) -> Aabb {
        let (centre, half) = (Vec3A::from(low + high) * 0.5, Vec3A::from(high - low) * 0.5);
        let largest = centre.abs() + half;
        let (center, half_extents, largest) = match self.to_local {
            None => (centre, half, largest),
            Some(to_local) => {
                let size = to_local.abs();
                (to_local * centre, size * half, size * largest)
            }
        };
        // A margin for the rounding of vertices.
        Aabb { center, half_extents: half_extents + largest * (8.0 * f32::EPSILON) }
    }
}

/// A description of a body that has one vertex for each particle.
pub(crate) trait Shown: Component + Clone {
    /// Layout of the vertices: columns and rows, or rings.
    fn layout(&self) -> [u32; 2];

    /// The number of vertices.
    fn vertex_count(&self) -> u64;

    /// Texture coordinates from (0, 0) at the top left to (1, 1).
    fn texture_coordinates(&self) -> Vec<[f32; 2]>;

    /// Returns the description at a level of detail.
    fn at(&self, _detail: Option<&CurrentDetail>) -> Cow<'_, Self> {
        Cow::Borrowed(self)
    }
}

impl Shown for Cloth {
    fn layout(&self) -> [u32; 2] {
        self.particles.to_array()
    }

    fn vertex_count(&self) -> u64 {
        u64::from(self.particles.x) * u64::from(self.particles.y)
    }

    fn texture_coordinates(&self) -> Vec<[f32; 2]> {
        let [columns, rows] = self.layout();
        let part = |i: u32, n: u32| i as f32 / (n.max(2) - 1) as f32;
        let row = |r: u32| (0..columns).map(move |c| [part(c, columns), part(r, rows)]);
        (0..rows).flat_map(row).collect()
    }

    fn at(&self, detail: Option<&CurrentDetail>) -> Cow<'_, Self> {
        let coarseness = detail.map_or(1, CurrentDetail::coarseness);
        if coarseness == 1 { Cow::Borrowed(self) } else { Cow::Owned(self.coarsened(coarseness)) }
    }
}

impl Shown for SoftBall {
    fn layout(&self) -> [u32; 2] {
        [self.rings, 0]
    }

    fn vertex_count(&self) -> u64 {
        5 * u64::from(self.rings) * (u64::from(self.rings) + 1)
    }

    fn texture_coordinates(&self) -> Vec<[f32; 2]> {
        let ring = |ring: u32| {
            let (count, radius) = (10 * (ring + 1), (ring + 1) as f32 / self.rings as f32);
            (0..count).map(move |i| {
                let around = Vec2::from_angle(core::f32::consts::TAU * i as f32 / count as f32) * radius;
                [0.5 + 0.5 * around.x, 0.5 - 0.5 * around.y]
            })
        };
        (0..self.rings).flat_map(ring).collect()
    }
}

/// Adds missing normals, texture coordinates and indices to `mesh`. False if it does not have one position for each
/// particle.
pub(crate) fn complete(mesh: &mut Mesh, shown: &impl Shown, topology: &Topology) -> bool {
    let count = topology.particle_count();
    let has = |mesh: &Mesh, id| mesh.try_attribute_option(id).ok().flatten().map(VertexAttributeValues::len);
    let positions = mesh.try_attribute_option(Mesh::ATTRIBUTE_POSITION).ok().flatten();
    let Some(VertexAttributeValues::Float32x3(positions)) = positions else {
        return false;
    };
    if positions.len() != count {
        return false;
    }
    if has(mesh, Mesh::ATTRIBUTE_NORMAL) != Some(count) {
        mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0_f32; 3]; count]);
    }
    if has(mesh, Mesh::ATTRIBUTE_UV_0) != Some(count) {
        mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, shown.texture_coordinates());
    }
    if mesh.try_indices_option().is_ok_and(|indices| indices.is_none()) {
        mesh.insert_indices(indices(count, topology.faces().as_flattened()));
    }
    true
}

/// Indices among `count` vertices, as short as they may be: they are copied whenever the vertices have changed.
pub(crate) fn indices(count: usize, corners: &[u32]) -> Indices {
    // The greatest number is left free: in a strip it would begin a new one.
    if count <= usize::from(u16::MAX) {
        Indices::U16(corners.iter().map(|&corner| corner as u16).collect())
    } else {
        Indices::U32(corners.to_vec())
    }
}

/// True if `mesh` has a position and a normal for each of `count` particles.
pub(crate) fn can_be_written(mesh: &Mesh, count: usize) -> bool {
    [Mesh::ATTRIBUTE_POSITION, Mesh::ATTRIBUTE_NORMAL].into_iter().all(|attribute| {
        let values = mesh.try_attribute_option(attribute).ok().flatten();
        matches!(values, Some(VertexAttributeValues::Float32x3(values)) if values.len() == count)
    })
}

/// Returns both buffers at once.
pub(crate) fn position_and_normal(mesh: &mut Mesh) -> Option<(&mut Vec<[f32; 3]>, &mut Vec<[f32; 3]>)> {
    let (mut positions, mut normals) = (None, None);
    for (attribute, values) in mesh.try_attributes_mut().ok()? {
        let VertexAttributeValues::Float32x3(values) = values else {
            continue;
        };
        if attribute.id == Mesh::ATTRIBUTE_POSITION.id {
            positions = Some(values);
        } else if attribute.id == Mesh::ATTRIBUTE_NORMAL.id {
            normals = Some(values);
        }
    }
    positions.zip(normals)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_does_not_leave_a_corner_outside_the_bounds() {
        let turned = Transform::from_rotation(Quat::from_euler(EulerRot::XYZ, 0.3, 1.0, -0.4));
        for transform in [Transform::IDENTITY, turned.with_scale(Vec3::new(0.3, 2.0, 1.7))] {
            let space = EntitySpace::new(&transform.into()).expect("a place of its own");
            for i in 1..1000 {
                let i = i as f32;
                let low = Vec3::new(0.1 * i, -0.7 / i, 1.3 - i);
                let high = low + Vec3::new(1.0 / i, 0.3 * i, 0.01);
                let bounds = space.bounds(low, high);
                for corner in 0..8 {
                    let pick =
                        |bit: u32, low: f32, high: f32| if corner >> bit & 1 == 0 { low } else { high };
                    let corner =
                        Vec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z));
                    let seen = Vec3A::from(space.direction(corner));
                    assert!(seen.cmpge(bounds.min()).all() && seen.cmple(bounds.max()).all(), "{corner}");
                }
            }
        }
    }

    #[test]
    fn an_entity_without_extent_or_place_has_no_space() {
        assert!(EntitySpace::new(&Transform::from_scale(Vec3::new(1.0, 0.0, 1.0)).into()).is_none());
        assert!(EntitySpace::new(&Transform::from_xyz(f32::NAN, 0.0, 0.0).into()).is_none());
    }
}
