//! Soft solids from closed meshes: jelly, rubber, fruit.

use bevy::prelude::*;
use drape_solver::{Embedding, MeshError, SoftBodyBuilder, SoftLattice, SoftSolid};

use crate::body::fabric::Fabric;
use crate::body::pressure::Pressure;
use crate::body::tearable::Untearable;
use crate::render::from_mesh::body::{MeshBody, MeshDescription};
use crate::render::from_mesh::paint::{PaintChannel, painted_above};
use crate::render::from_mesh::reading::{MeshFault, faces, positions};
use crate::render::from_mesh::skin::ClothSkin;
use crate::render::from_mesh::source::MeshParts;
use crate::render::vertices::{EmbeddedVertices, Vertices};

/// Makes a soft solid from the entity's [`Mesh3d`], which must be closed: jelly, rubber, fruit.
///
/// The box around the mesh is divided into cells along the axes of the mesh. Cells with their centre inside form the
/// body: particles at their corners, sticks along their edges and diagonals. The cells carry the mesh, so it may have
/// any detail. Contacts are with the cells: use smaller ones if it must lie on the ground exactly. [`Pressure`] keeps
/// its volume; more pressure inflates it.
///
/// The first step after the mesh has loaded builds the solid; a change of the component, the mesh or its asset rebuilds
/// it. Vertices in the same place move together, so that seams of texture coordinates and normals stay closed.
/// Positions and normals are written to a copy of the mesh. A mesh with a hole is refused with the reason in the log
/// and in [`Refusals`](crate::refusal::Refusals). Solids do not tear, and blades pass through them.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// # fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
/// let cube = meshes.add(Cuboid::from_length(0.5));
/// commands.spawn((Mesh3d(cube), SoftBodyMesh::default(), Transform::from_xyz(0.0, 2.0, 0.0)));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform, Pressure)]
pub struct SoftBodyMesh {
    /// Greatest width of a cell in the world in metres; at most 128 cells lie along an axis. None, the default: a sixth
    /// of the longest side of the mesh.
    pub spacing: Option<f32>,
    /// Mass per volume in kg/m^3, above 0; 100 by default. Water has 1000.
    pub density: f32,
    /// Stiffness of all sticks, 0 (slack) to 1 (rigid); 0.95 by default. Large and heavy solids need more, or they sag.
    pub stiffness: f32,
    /// Damping along all sticks in 1/s, 0 or more; 3 by default. More stops quivering sooner.
    pub damping: f32,
    /// Pinned vertices by their index in the mesh. Their cells stay fixed to the entity.
    pub pins: Vec<u32>,
    /// Pins vertices with a value above a half. None, the default: no painted pins. Vertex colours that are read are
    /// removed from the shown mesh.
    pub painted_pins: Option<PaintChannel>,
}

impl Default for SoftBodyMesh {
    fn default() -> Self {
        Self {
            spacing: None,
            density: 100.0,
            stiffness: 0.95,
            damping: 3.0,
            pins: Vec::new(),
            painted_pins: None,
        }
    }
}

/// Default number of cells along the longest side of a mesh.
const CELLS: f32 = 6.0;
/// Value above which a painted vertex is pinned.
const PINNED: f32 = 0.5;

impl SoftBodyMesh {
    /// A solid of cells at most `spacing` metres wide.
    pub fn new(spacing: f32) -> Self {
        Self { spacing: Some(spacing), ..Self::default() }
    }

    /// Sets the pinned vertices.
    pub fn with_pins(mut self, pins: impl IntoIterator<Item = u32>) -> Self {
        self.pins = pins.into_iter().collect();
        self
    }

    /// Builds the solid of `mesh` at `transform`.
    ///
    /// # Errors
    /// [`MeshFault`] naming the invalid part.
    pub fn build(&self, mesh: &Mesh, transform: &GlobalTransform) -> Result<SoftSolid, MeshFault> {
        let vertices: Vec<Vec3> = positions(mesh)?.iter().copied().map(Vec3::from_array).collect();
        let faces = faces(mesh, vertices.len())?;
        let painted = painted_above(mesh, self.painted_pins.as_ref(), PINNED, vertices.len())?;
        let to_world = transform.affine();
        let spacing = self.spacing.unwrap_or_else(|| longest_side(&vertices, transform) / CELLS);
        let builder = SoftBodyBuilder::new(&vertices, &faces, spacing)
            .transform(to_world)
            .density(self.density)
            .stiffness(self.stiffness)
            .damping(self.damping);
        let builder = painted.chain(self.pins.iter().copied()).fold(builder, SoftBodyBuilder::pin);
        Ok(builder.build_parts()?)
    }
}

/// Returns the longest side, in the world, of the box around a mesh along its own axes. Empty or invalid meshes give 1
/// and are refused later.
fn longest_side(vertices: &[Vec3], transform: &GlobalTransform) -> f32 {
    let low = vertices.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = vertices.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    let axes = transform.affine().matrix3.to_cols_array_2d().map(|axis| Vec3::from(axis).length());
    let longest = ((high - low) * Vec3::from(axes)).max_element();
    if longest > 0.0 && longest.is_finite() { longest } else { 1.0 }
}

/// The cells of a [`SoftBodyMesh`], which other meshes can be bound to. Comes with its [`Particles`](crate::body::particles::Particles).
#[derive(Component, Clone, Debug)]
pub(crate) struct SolidCells(SoftLattice);

impl SolidCells {
    /// Binds points in the mesh's coordinates to the cells.
    pub fn embed(&self, points: &[Vec3]) -> Result<Embedding, MeshError> {
        self.0.embed(points)
    }
}

impl MeshDescription for SoftBodyMesh {
    const NAME: &'static str = "SoftBodyMesh";
    type Parts = (SolidCells, Untearable);

    fn takes_colours(&self) -> bool {
        self.painted_pins.as_ref().is_some_and(PaintChannel::is_colour)
    }

    fn build(
        &self,
        _: &Fabric,
        mesh: &Mesh,
        parts: &MeshParts,
        transform: &GlobalTransform,
        skin: ClothSkin,
    ) -> Result<MeshBody<Self::Parts>, MeshFault> {
        if skin.is_skinned() {
            return Err(MeshFault::SkinnedSolid);
        }
        let SoftSolid { particles, topology, lattice, embedding } = self.build(mesh, transform)?;
        let MeshParts { positions, normals, faces } = parts;
        Ok(MeshBody {
            particles,
            topology: topology.into(),
            vertices: Vertices::Embedded(EmbeddedVertices::new(embedding, positions, *normals, faces)),
            rest: transform.affine(),
            pose: None,
            parts: (SolidCells(lattice), Untearable),
            repairs: None,
        })
    }
}
