//! Tubes around ropes.

use bevy::asset::RenderAssetUsages;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::NoAutoAabb;
use bevy::mesh::PrimitiveTopology;
use bevy::prelude::*;
use drape_solver::Topology;

use crate::body::on_gpu::AnyParts;
use crate::body::particles::Particles;
use crate::render::attributes::{can_be_written, indices, position_and_normal};
use crate::render::tube::{MOST_SIDES, Tube};
use crate::render::views::Views;

/// Shows a rope, or a piece of one, as a tube: gives the entity a [`Mesh3d`] and updates it with the simulation. Add a
/// `MeshMaterial3d` to see it. Texture coordinates go from 0 to 1 around the tube, and from 0 at the rope's start to 1
/// at its end.
///
/// The tube does not twist from link to link or from frame to frame. Does nothing in an app without `Assets<Mesh>`, or
/// on a body with faces.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform)]
pub struct RopeMesh {
    /// Radius in metres; 0.01 by default.
    pub radius: f32,
    /// Number of corners of a ring, from 3 to 64; 8 by default.
    pub sides: u32,
}

impl Default for RopeMesh {
    fn default() -> Self {
        Self { radius: 0.01, sides: 8 }
    }
}

impl RopeMesh {
    /// A tube of this radius in metres.
    pub fn new(radius: f32) -> Self {
        Self { radius, ..Self::default() }
    }
}

/// State of a rope's tube between two frames.
#[derive(Component, Clone, Debug)]
pub(crate) struct RopeSurface {
    pub made_for: RopeMesh,
    /// Mesh that is written.
    pub mesh: AssetId<Mesh>,
    /// Its particles from one end to the other.
    pub order: Vec<u32>,
    previous: Vec<Vec3>,
    current: Vec<Vec3>,
    /// Centres of the rings in the entity's coordinates, kept to allocate nothing per frame.
    centres: Vec<Vec3>,
    /// A vector across the first link, from which the rings start.
    across: Vec3,
    /// True if it did not move in the last step.
    is_settled: bool,
    /// Fraction and transform that the mesh was last written for; none if a step was taken since.
    shown: Option<(f32, GlobalTransform)>,
}

impl RopeSurface {
    /// Makes the place `origin` the origin of the world.
    pub fn shift_origin(&mut self, origin: Vec3) {
        self.previous.iter_mut().chain(&mut self.current).for_each(|place| *place -= origin);
        self.shown = None;
    }

    /// Shows the particles as they are now, after they went ways that were not recorded.
    pub fn restart(&mut self, particles: &drape_solver::Particles) {
        if particles.len() == self.order.len() && particles.is_finite() {
            self.read(particles);
            self.previous.clone_from(&self.current);
        }
        (self.is_settled, self.shown) = (true, None);
    }

    /// Reads the present positions.
    fn read(&mut self, particles: &drape_solver::Particles) {
        self.current.clear();
        self.current.extend(self.order.iter().map(|&i| particles.position(i as usize)));
    }
}

/// Returns the particles of a chain from one end to the other; none if it is not a chain.
fn order_of(topology: &Topology) -> Option<Vec<u32>> {
    let count = topology.particle_count();
    if !topology.faces().is_empty() || topology.segments().len() + 1 != count || count < 2 {
        return None;
    }
    let mut joined = vec![[u32::MAX; 2]; count];
    for &[a, b] in topology.segments() {
        for (from, to) in [(a, b), (b, a)] {
            let free = joined[from as usize].iter().position(|&other| other == u32::MAX)?;
            joined[from as usize][free] = to;
        }
    }
    let first = joined.iter().position(|others| others[1] == u32::MAX)? as u32;
    let mut order = vec![first];
    let mut before = u32::MAX;
    let mut here = first;
    while let Some(&next) = joined[here as usize].iter().find(|&&next| next != before && next != u32::MAX) {
        order.push(next);
        (before, here) = (here, next);
        if order.len() > count {
            return None;
        }
    }
    (order.len() == count).then_some(order)
}

/// Gives new ropes and pieces of ropes their tubes.
pub(crate) fn build_rope_meshes(
    mut commands: Commands,
    ropes: Query<(Entity, &RopeMesh, AnyParts, Option<&RopeSurface>, Option<&Mesh3d>)>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    for (entity, rope, parts, surface, mesh) in &ropes {
        let Some((particles, topology)) = parts.get() else { continue };
        let is_known = surface.zip(mesh).is_some_and(|(surface, mesh)| {
            surface.made_for == *rope && surface.current.len() == particles.len() && surface.mesh == mesh.id()
        });
        let is_usable =
            rope.radius > 0.0 && rope.radius.is_finite() && (3..=MOST_SIDES as u32).contains(&rope.sides);
        if is_known || !is_usable || particles.len() != topology.particle_count() {
            continue;
        }
        let Some(order) = order_of(topology) else { continue };
        let tube = Tube { rings: order.len(), sides: rope.sides as usize, radius: rope.radius };
        let mut made = Mesh::new(
            PrimitiveTopology::TriangleList,
            RenderAssetUsages::MAIN_WORLD | RenderAssetUsages::RENDER_WORLD,
        );
        made.insert_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0_f32; 3]; tube.vertex_count()]);
        made.insert_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0_f32; 3]; tube.vertex_count()]);
        made.insert_attribute(Mesh::ATTRIBUTE_UV_0, tube.texture_coordinates());
        made.insert_indices(indices(tube.vertex_count(), &tube.indices()));
        let handle = meshes.add(made);
        let current: Vec<Vec3> = order.iter().map(|&i| particles.position(i as usize)).collect();
        let surface = RopeSurface {
            made_for: *rope,
            mesh: handle.id(),
            order,
            previous: current.clone(),
            current,
            centres: Vec::new(),
            across: Vec3::ZERO,
            is_settled: true,
            shown: None,
        };
        commands.entity(entity).insert((Mesh3d(handle), surface, NoAutoAabb, Aabb::default()));
    }
}

/// Records the ropes after a step.
pub(crate) fn record_ropes(mut ropes: Query<(Ref<Particles>, &mut RopeSurface)>) {
    for (particles, mut surface) in &mut ropes {
        let surface = &mut *surface;
        surface.is_settled |= !particles.is_changed();
        if particles.is_changed() && particles.len() == surface.order.len() && particles.is_finite() {
            core::mem::swap(&mut surface.previous, &mut surface.current);
            surface.read(&particles);
            surface.is_settled = surface.previous == surface.current;
            if !surface.is_settled {
                surface.shown = None;
            }
        }
    }
}

/// Writes the tubes at `fraction` of the last step, where they are seen.
pub(crate) fn write_ropes(
    ropes: &mut Query<(Entity, &mut RopeSurface, &Mesh3d, &GlobalTransform, &mut Aabb), With<Particles>>,
    meshes: &mut Assets<Mesh>,
    views: &Views,
    fraction: f32,
) {
    for (entity, mut surface, handle, transform, mut bounds) in ropes {
        let RopeSurface { made_for, mesh, previous, current, centres, across, is_settled, shown, .. } =
            &mut *surface;
        let fraction = if *is_settled { 1.0 } else { fraction };
        let to_local = transform.affine().inverse();
        if *shown == Some((fraction, *transform)) || handle.id() != *mesh || !to_local.is_finite() {
            continue;
        }
        let between = |(&a, &b): (&Vec3, &Vec3)| to_local.transform_point3(a + (b - a) * fraction);
        centres.clear();
        centres.extend(previous.iter().zip(current.iter()).map(between));
        if let Some(around) = Aabb::enclosing(centres.iter()) {
            let half_extents = around.half_extents + made_for.radius;
            bounds.set_if_neq(Aabb { half_extents, ..around });
        }
        if !views.may_see(entity, &bounds, transform) {
            continue;
        }
        if !meshes.get(*mesh).is_some_and(|asset| can_be_written(asset, asset.count_vertices())) {
            continue;
        }
        let Some(mut asset) = meshes.get_mut(*mesh) else { continue };
        let Some((positions, normals)) = position_and_normal(&mut asset) else { continue };
        let tube = Tube { rings: centres.len(), sides: made_for.sides as usize, radius: made_for.radius };
        *across = tube.write(centres, *across, positions, normals);
        *shown = Some((fraction, *transform));
    }
}
