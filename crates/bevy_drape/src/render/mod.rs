//! Meshes: bodies shown as meshes, and bodies made from meshes.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
//!     // Any mesh is a cloth, and any closed mesh a jelly; a rope is shown as a tube.
//!     let sheet = meshes.add(Plane3d::default().mesh().size(1.0, 1.0).subdivisions(20));
//!     commands.spawn((Mesh3d(sheet), ClothMesh::default(), Transform::from_xyz(0.0, 2.0, 0.0)));
//!     let cube = meshes.add(Cuboid::from_length(0.5));
//!     commands.spawn((Mesh3d(cube), SoftBodyMesh::default(), Transform::from_xyz(0.0, 1.0, 0.0)));
//!     commands.spawn((Rope::default(), RopeMesh::default()));
//! }
//! # App::new().init_resource::<Assets<Mesh>>().add_systems(Startup, setup).update();
//! ```
//!
//! Imports bodies, descriptions and levels of detail below. The mesh plugin runs these systems; `tear/` must know which of the
//! components a piece does not inherit.

pub(crate) mod any_mesh;
pub(crate) mod attributes;
pub(crate) mod build_surfaces;
pub(crate) mod carriers;
pub(crate) mod cut_vertices;
pub(crate) mod detail_mesh;
pub(crate) mod entity_space;
pub(crate) mod from_mesh;
pub(crate) mod mesh_times;
pub(crate) mod normals;
pub(crate) mod plugin;
pub(crate) mod rope_mesh;
pub(crate) mod shown;
pub(crate) mod smoothing;
pub(crate) mod surface;
pub(crate) mod torn_mesh;
pub(crate) mod tube;
pub(crate) mod vertex_map;
pub(crate) mod vertices;
pub(crate) mod views;
pub(crate) mod visibility;
pub(crate) mod write_surfaces;

pub use from_mesh::{
    body_colliders::{
        BodyCollider, BodyColliders, BodyCollidersReport, FittedCapsule, SkinDistances, SkinJoint,
    },
    cloth_mesh::{ClothMesh, ClothWeave, WeldedVertices},
    driven_mesh::DrivenMesh,
    obstacle_hierarchy::ObstacleHierarchy,
    paint::{ClothPaint, PaintChannel},
    pose_paint::{BackstopPaint, PoseDrivePaint},
    reading::MeshFault,
    soft_body::SoftBodyMesh,
};
pub use mesh_times::MeshTimes;
pub use plugin::MeshPlugin;
pub use rope_mesh::RopeMesh;
