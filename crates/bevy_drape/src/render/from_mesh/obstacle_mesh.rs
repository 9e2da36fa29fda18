//! Obstacles that have the shapes of their meshes.

use bevy::prelude::*;
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::{BuildError, MeshError, Shape};

use crate::environment::obstacle::Obstacle;
use crate::environment::obstacle_shape::{ObstacleShape, ShapeFromMesh};
use crate::refusal::{Cause, Refusals};
use crate::render::from_mesh::reading::MeshFault;
use crate::render::from_mesh::source::{ChangedMeshes, FaultyMesh, MeshParts, MeshSource};

/// Gives obstacles the shapes of their meshes: those that were inserted or changed since the last step, or whose mesh was, and
/// those that waited for it.
pub(crate) fn shape_obstacles(
    mut commands: Commands,
    mut changed: ChangedMeshes<Obstacle>,
    obstacles: Query<(&Obstacle, Option<&Mesh3d>)>,
    meshes: Res<Assets<Mesh>>,
    mut refusals: ResMut<Refusals>,
    mut to_shape: Local<Vec<Entity>>,
) {
    // The list still has the obstacles that wait for their mesh.
    changed.collect(&mut to_shape);
    to_shape.sort_unstable();
    to_shape.dedup();
    to_shape.retain(|&entity| {
        let Ok((obstacle, mesh)) = obstacles.get(entity) else { return false };
        if !obstacle.shape.is_from_mesh() {
            return false;
        }
        let mut commands = commands.entity(entity);
        let shaped = match mesh {
            Some(mesh) => {
                let Some(asset) = meshes.get(mesh) else { return true };
                commands.insert(MeshSource { source: mesh.0.clone(), shown: None });
                solid_of(&obstacle.shape, asset).map_err(|fault| FaultyMesh::new(mesh, fault).into())
            }
            None => Err(Cause::from("its shape is that of its mesh, but it has no `Mesh3d`")),
        };
        match shaped {
            Ok(shape) => _ = commands.insert(ShapeFromMesh(shape)),
            Err(reason) => {
                refusals.entity(entity, "Obstacle", reason);
                commands.remove::<ShapeFromMesh>();
            }
        }
        false
    });
}

fn solid_of(shape: &ObstacleShape, mesh: &Mesh) -> Result<Shape, MeshFault> {
    let parts = MeshParts::of(mesh)?;
    parts.check_faces()?;
    let MeshParts { positions, faces, .. } = parts;
    let corners: Vec<Vec3> = positions.iter().map(|&position| position.into()).collect();
    // Parry panics on these, and on corners that do not exist.
    if let Some(vertex) = corners.iter().position(|corner| !corner.is_finite()) {
        let position = corners[vertex];
        return Err(MeshError::NotFinite { vertex: vertex as u32, position }.into());
    }
    if faces.is_empty() {
        return Err(MeshError::NoFaces { vertices: corners.len() }.into());
    }
    let bad = |reason| MeshError::from(BuildError::BadShape { reason });
    let shape = match shape {
        ObstacleShape::ConvexHull => {
            SharedShape::convex_hull(&corners).ok_or(bad("its hull has no volume"))?
        }
        _ => SharedShape::trimesh(corners, faces).map_err(|_| bad("its triangles do not form a surface"))?,
    };
    Ok(Shape::from_parry(shape).map_err(MeshError::from)?)
}

/// Removes the shape from an entity that loses its [`Obstacle`].
pub(crate) fn remove_obstacle_mesh(removed: On<Remove<Obstacle>>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<ShapeFromMesh>();
}
