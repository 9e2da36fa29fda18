//! Cloths from any mesh.

use std::sync::Arc;

use bevy::prelude::*;
use drape_solver::{MeshCloth, MeshClothBuilder, MeshRepairs, Weave};

use crate::body::fabric::Fabric;
use crate::render::from_mesh::body::{MeshBody, MeshDescription};
use crate::render::from_mesh::paint::{ClothPaint, paint, painted_above};
use crate::render::from_mesh::reading::{MeshFault, faces, positions, texture_coordinates};
use crate::render::from_mesh::skin::ClothSkin;
use crate::render::from_mesh::source::MeshParts;
use crate::render::vertex_map::VertexMap;
use crate::render::vertices::Vertices;

/// Makes a cloth from the entity's [`Mesh3d`]: a cape, skirt, tent or balloon, modelled or made in code. Its [`Fabric`] says what it is made
/// of.
///
/// The first step after the mesh has loaded builds the cloth; a change of the component, the mesh or its asset rebuilds
/// it. Vertices in the same place are one particle, so that the cloth does not open along seams of texture coordinates
/// and normals. Vertices, indices and texture coordinates stay as they are; positions and normals are written to a copy
/// of the mesh. Edges become structural sticks, which resist skewing too; bend sticks join the corners across each
/// edge. Invalid meshes are refused with the reason in the log and in [`Refusals`](crate::refusal::Refusals). Small
/// faults are repaired with a warning.
///
/// Painted particles are pinned: by default those whose vertex colour has more than half of red. Pins stay fixed to the
/// entity. For the other particles, paint motion limits with [`ClothPaint::max_distance`], backstops with
/// [`ClothPaint::backstop`], and drives towards the animated pose with [`ClothPaint::pose_drive`].
///
/// With a [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh), pins, limits, backstops and drives follow its joints. Each step computes the
/// pose from the joints' transforms. The simulated mesh is drawn without a skin, so the cloth removes the `SkinnedMesh`
/// from its entity; insert another one to follow that. Joints get a
/// [`MovedByFrame`](crate::transform::moved_by_frame::MovedByFrame).
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// # fn setup(mut commands: Commands, assets: Res<AssetServer>) {
/// let mesh = assets.load("cape.gltf#Mesh0/Primitive0");
/// commands.spawn((Mesh3d(mesh), ClothMesh::default(), Transform::from_xyz(0.0, 2.0, 0.0)));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform, Fabric)]
pub struct ClothMesh {
    /// Distance in metres, in the world, within which vertices become one particle; 0 for equal positions only. None: a
    /// hundred-thousandth of the mesh's length.
    pub weld_distance: Option<f32>,
    /// Pinned vertices, in addition to painted ones, by their index in the mesh.
    pub pins: Vec<u32>,
    /// Meaning of vertex colours and other attributes.
    pub paint: ClothPaint,
    /// Stiffness by direction, for a mesh with texture coordinates; none by default.
    pub weave: Option<ClothWeave>,
}

/// Stiffness by direction. The warp runs along V of the mesh's first texture coordinates and has
/// [`Fabric::stretch_stiffness`]; the weft runs along U. In between, stiffness changes as in an orthotropic plate
/// ([`drape_solver::Weave`]).
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct ClothWeave {
    /// Stiffness of edges along U, above 0 (slack) to 1 (rigid); 0.999 by default.
    pub weft_stiffness: f32,
    /// Stiffness of edges at 45 degrees, above 0 (slack) to 1 (rigid); 0.98 by default: woven cloth stretches on the
    /// bias.
    pub bias_stiffness: f32,
}

impl Default for ClothWeave {
    fn default() -> Self {
        Self { weft_stiffness: 0.999, bias_stiffness: 0.98 }
    }
}

impl ClothMesh {
    /// Sets the pinned vertices.
    pub fn with_pins(mut self, pins: impl IntoIterator<Item = u32>) -> Self {
        self.pins = pins.into_iter().collect();
        self
    }

    /// Builds the cloth of `mesh`, made of `fabric`, at `transform`.
    ///
    /// # Errors
    /// [`MeshFault`] naming the invalid part.
    pub fn build(
        &self,
        fabric: &Fabric,
        mesh: &Mesh,
        transform: &GlobalTransform,
    ) -> Result<MeshCloth, MeshFault> {
        let positions: Vec<Vec3> =
            positions(mesh)?.iter().map(|&position| transform.transform_point(position.into())).collect();
        let vertices = positions.len();
        let mut faces = faces(mesh, vertices)?;
        if transform.affine().matrix3.determinant() < 0.0 {
            // A mirrored mesh has reversed faces.
            faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        let painted = painted_above(mesh, self.paint.pins.as_ref(), self.paint.threshold, vertices)?;
        let mut builder = MeshClothBuilder::new(positions, faces).material(fabric.material());
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
        self.paint.follow_pose(&mut cloth, mesh, transform)?;
        Ok(cloth)
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
        fabric: &Fabric,
        mesh: &Mesh,
        parts: &MeshParts,
        transform: &GlobalTransform,
        skin: ClothSkin,
    ) -> Result<MeshBody<WeldedVertices>, MeshFault> {
        let rest = skin.rest(transform);
        let (MeshCloth { particles, topology, particle_of_vertex, repairs }, pose) =
            skin.build(mesh, transform, |place| self.build(fabric, mesh, place))?;
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

/// The particle of each vertex of a [`ClothMesh`]'s mesh. Comes with its
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

    /// The vertices of a piece of a torn cloth.
    pub(crate) fn torn(particles: Arc<[Option<u32>]>) -> Self {
        Self::new(particles, MeshRepairs::default())
    }

    /// Returns the particle of a vertex; none if it is not a corner of any triangle with an area, or lies on the edge of a cut or a tear.
    pub fn particle(&self, vertex: usize) -> Option<usize> {
        self.particles.get(vertex).copied().flatten().map(|particle| particle as usize)
    }

    /// Returns the number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.particles.len()
    }

    /// Returns the repairs to the mesh.
    pub fn repairs(&self) -> MeshRepairs {
        self.repairs
    }
}
