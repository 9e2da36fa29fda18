//! Cloths from any mesh.

use std::sync::Arc;

use bevy::prelude::*;
use drape_solver::{ClothMaterial, MeshCloth, MeshClothBuilder, MeshRepairs, Weave};

use crate::render::from_mesh::body::{MeshBody, MeshDescription};
use crate::render::from_mesh::paint::{ClothPaint, paint, painted_above};
use crate::render::from_mesh::reading::{MeshFault, faces, positions, texture_coordinates};
use crate::render::from_mesh::skin::ClothSkin;
use crate::render::from_mesh::source::MeshParts;
use crate::render::vertex_map::VertexMap;
use crate::render::vertices::Vertices;

/// Makes a cloth of the entity's [`Mesh3d`]: cape, skirt, tent, balloon; from a modelling tool, or made in code.
///
/// It is built in the first step after the mesh has loaded, and anew when the component, the mesh or its asset changes.
/// Vertices in the same place are one particle, so that the cloth does not open along seams of texture coordinates and
/// normals; vertices, indices and texture coordinates stay the mesh's own, and positions and normals are written back into
/// a copy of it. Edges become structural sticks, which resist skewing too, and the corners across an edge are joined by a bend stick.
/// A mesh that is no cloth is refused with the reason in the log and in [`Refusals`](crate::refusal::Refusals); one that is odd is
/// put right, with a warning.
///
/// Particles that are painted are pinned: by default those with a vertex colour of more red than a half. Pins stay fixed to the
/// entity. How far the others may go can be painted as well: see [`ClothPaint::max_distance`].
///
/// Where the entity has a [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh), pins and limits follow its joints. The pose is worked out in each
/// step, by the joints' transforms of that step, and the mesh that is shown is the simulated one: it has no skin any more, and the cloth takes
/// the `SkinnedMesh` off its entity. Insert another to have it follow that.
/// Joints get a [`MovedByFrame`](crate::transform::moved_by_frame::MovedByFrame).
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// # fn setup(mut commands: Commands, assets: Res<AssetServer>) {
/// let mesh = assets.load("cape.gltf#Mesh0/Primitive0");
/// commands.spawn((Mesh3d(mesh), ClothMesh::default(), Transform::from_xyz(0.0, 2.0, 0.0)));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform)]
pub struct ClothMesh {
    /// Mass per area in kg/m^2.
    pub areal_density: f32,
    /// Stiffness of the edges, 0 (slack) to 1 (rigid): resists stretching and skewing.
    pub stretch_stiffness: f32,
    /// Stiffness across the edges, 0 to 1: resists folding.
    pub bend_stiffness: f32,
    /// Damping along all sticks in 1/s.
    pub damping: f32,
    /// How near vertices have to be in the world to become one particle, in metres; 0 for the very same place. None: a
    /// hundred-thousandth of the mesh's length.
    pub weld_distance: Option<f32>,
    /// Vertices that are pinned besides those that are painted, by their index in the mesh.
    pub pins: Vec<u32>,
    /// What colours and other attributes of vertices mean.
    pub paint: ClothPaint,
    /// Stiffness by direction, for a mesh with texture coordinates; none by default.
    pub weave: Option<ClothWeave>,
}

/// Stiffness by direction: the threads of the warp run along V of the mesh's first texture coordinates, and have
/// [`ClothMesh::stretch_stiffness`]; those of the weft run along U. In between it changes as in an orthotropic plate
/// ([`drape_solver::Weave`]).
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct ClothWeave {
    /// Stiffness of edges along U, above 0 (slack) to 1 (rigid); 0.999 by default.
    pub weft_stiffness: f32,
    /// Stiffness of edges at 45 degrees, likewise; 0.98 by default: cloth of threads gives way on the bias.
    pub bias_stiffness: f32,
}

impl Default for ClothWeave {
    fn default() -> Self {
        Self { weft_stiffness: 0.999, bias_stiffness: 0.98 }
    }
}

impl Default for ClothMesh {
    fn default() -> Self {
        let ClothMaterial { areal_density, stretch_stiffness, bend_stiffness, damping, .. } =
            ClothMaterial::default();
        Self {
            areal_density,
            stretch_stiffness,
            bend_stiffness,
            damping,
            weld_distance: None,
            pins: Vec::new(),
            paint: ClothPaint::default(),
            weave: None,
        }
    }
}

impl ClothMesh {
    /// Pins these vertices too.
    pub fn with_pins(mut self, pins: impl IntoIterator<Item = u32>) -> Self {
        self.pins.extend(pins);
        self
    }

    /// The cloth of `mesh` at `transform`.
    ///
    /// # Errors
    /// [`MeshFault`] naming what cannot be used.
    pub fn build(&self, mesh: &Mesh, transform: &GlobalTransform) -> Result<MeshCloth, MeshFault> {
        let positions: Vec<Vec3> =
            positions(mesh)?.iter().map(|&position| transform.transform_point(position.into())).collect();
        let vertices = positions.len();
        let mut faces = faces(mesh, vertices)?;
        if transform.affine().matrix3.determinant() < 0.0 {
            // In a mirror they turn the other way.
            faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        let painted = painted_above(mesh, self.paint.pins.as_ref(), self.paint.threshold, vertices)?;
        let mut builder = MeshClothBuilder::new(positions, faces).material(ClothMaterial {
            areal_density: self.areal_density,
            stretch_stiffness: self.stretch_stiffness,
            bend_stiffness: self.bend_stiffness,
            damping: self.damping,
            ..ClothMaterial::default()
        });
        if let Some(channel) = &self.paint.stiffness {
            builder = builder.painted_stiffness(paint(mesh, channel, vertices)?);
        }
        if let Some(ClothWeave { weft_stiffness, bias_stiffness }) = self.weave {
            builder = builder.weave(Weave {
                coordinates: texture_coordinates(mesh)?,
                weft_stiffness,
                bias_stiffness,
            });
        }
        if let Some(distance) = self.weld_distance {
            builder = builder.weld_distance(distance);
        }
        let builder = painted.chain(self.pins.iter().copied()).fold(builder, MeshClothBuilder::pin);
        let mut cloth = builder.build_parts()?;
        self.limit(&mut cloth, mesh)?;
        Ok(cloth)
    }

    /// Gives free particles the limits that are painted: of several vertices in one place the least.
    fn limit(&self, cloth: &mut MeshCloth, mesh: &Mesh) -> Result<(), MeshFault> {
        let Some(channel) = &self.paint.max_distance else { return Ok(()) };
        if !(self.paint.full_distance >= 0.0 && self.paint.full_distance.is_finite()) {
            return Err(MeshFault::BadFullDistance(self.paint.full_distance));
        }
        let painted = paint(mesh, channel, cloth.particle_of_vertex.len())?;
        for (value, particle) in painted.into_iter().zip(&cloth.particle_of_vertex) {
            let Some(i) = particle.map(|particle| particle as usize) else { continue };
            let distance = value.clamp(0.0, 1.0) * self.paint.full_distance;
            let known = cloth.particles.motion_limit(i).map_or(f32::INFINITY, |(_, known)| known);
            if !cloth.particles.is_pinned(i) && distance < known {
                let place = cloth.particles.position(i);
                cloth.particles.set_motion_limit(i, place, distance);
            }
        }
        Ok(())
    }
}

impl MeshDescription for ClothMesh {
    const NAME: &'static str = "ClothMesh";
    type Parts = WeldedVertices;

    fn takes_colours(&self) -> bool {
        self.paint.takes_colours()
    }

    fn build(
        &self,
        mesh: &Mesh,
        parts: &MeshParts,
        transform: &GlobalTransform,
        skin: ClothSkin,
    ) -> Result<MeshBody<WeldedVertices>, MeshFault> {
        let rest = skin.rest(transform);
        let (MeshCloth { particles, topology, particle_of_vertex, repairs }, pose) =
            skin.build(mesh, transform, |place| self.build(mesh, place))?;
        let MeshParts { positions, normals, faces } = parts;
        let vertices = VertexMap::new(particle_of_vertex, positions, *normals, faces.clone());
        Ok(MeshBody {
            particles,
            topology: topology.into(),
            rest,
            pose,
            parts: WeldedVertices::new(vertices.particles.clone(), repairs),
            vertices: Vertices::Welded(vertices),
            repairs: (!repairs.is_empty()).then(|| repairs.to_string()),
        })
    }
}

/// Which particle each vertex of the mesh belongs to that a [`ClothMesh`] shows. Comes with its
/// [`Particles`](crate::body::particles::Particles).
#[derive(Component, Reflect, Clone, Debug, Default)]
#[reflect(opaque)]
#[reflect(Component, Default, Debug, Clone)]
pub struct WeldedVertices {
    particles: Arc<[Option<u32>]>,
    repairs: MeshRepairs,
}

impl WeldedVertices {
    pub(crate) fn new(particles: Arc<[Option<u32>]>, repairs: MeshRepairs) -> Self {
        Self { particles, repairs }
    }

    /// Of a piece of a cloth that was torn.
    pub(crate) fn torn(particles: Arc<[Option<u32>]>) -> Self {
        Self::new(particles, MeshRepairs::default())
    }

    /// The particle of a vertex; none if no triangle with an area has it for a corner.
    pub fn particle(&self, vertex: usize) -> Option<usize> {
        self.particles.get(vertex).copied().flatten().map(|particle| particle as usize)
    }

    /// The number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.particles.len()
    }

    /// What was put right in the mesh.
    pub fn repairs(&self) -> MeshRepairs {
        self.repairs
    }
}
