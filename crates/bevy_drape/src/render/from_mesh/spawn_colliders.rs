//! Spawns the capsules of bodies.

use bevy::ecs::system::SystemParam;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;

use crate::change_detection::collect_changed;
use crate::environment::obstacle::Obstacle;
use crate::refusal::{Cause, Refusals};
use crate::render::from_mesh::body_colliders::{
    BodyCollider, BodyColliders, BodyCollidersReport, FittedCapsule, SkinJoint,
};
use crate::render::from_mesh::source::FaultyMesh;

/// Skinned bodies, their meshes and joints.
#[derive(SystemParam)]
pub(crate) struct SkinnedBodies<'w, 's> {
    bodies: Query<'w, 's, (&'static BodyColliders, Option<&'static Mesh3d>, Option<&'static SkinnedMesh>)>,
    meshes: Res<'w, Assets<Mesh>>,
    bind_poses: Res<'w, Assets<SkinnedMeshInverseBindposes>>,
    places: Query<'w, 's, (), With<Transform>>,
    parents: Query<'w, 's, &'static ChildOf>,
    names: Query<'w, 's, &'static Name>,
}

/// A fitted body, with the entities of its joints.
type Fitted = (Vec<(Entity, FittedCapsule)>, BodyCollidersReport, f32);

impl SkinnedBodies<'_, '_> {
    /// None while something has not loaded yet.
    fn fit(&self, body: Entity) -> Option<Result<Fitted, Cause>> {
        let (colliders, mesh, skin) = self.bodies.get(body).ok()?;
        let (Some(mesh), Some(skin)) = (mesh, skin) else {
            return Some(Err("it has no `Mesh3d` or no `SkinnedMesh`".into()));
        };
        let (asset, bind_poses) = (self.meshes.get(mesh)?, self.bind_poses.get(&skin.inverse_bindposes)?);
        if !skin.joints.iter().all(|&joint| self.places.contains(joint)) {
            return None;
        }
        let index = |entity: Entity| skin.joints.iter().position(|&joint| joint == entity);
        let joint = |(&joint, &inverse_bind_pose): (&Entity, &Mat4)| SkinJoint {
            name: self.names.get(joint).map(ToString::to_string).unwrap_or_default(),
            parent: self.parents.iter_ancestors(joint).find_map(index),
            inverse_bind_pose,
        };
        let joints: Vec<SkinJoint> = skin.joints.iter().zip(bind_poses.iter()).map(joint).collect();
        Some(match colliders.fit(asset, &joints) {
            Ok((capsules, report)) => {
                let of_joints = capsules.into_iter().map(|capsule| (skin.joints[capsule.joint], capsule));
                Ok((of_joints.collect(), report, colliders.friction))
            }
            Err(fault) => Err(FaultyMesh::new(mesh, fault).into()),
        })
    }
}

/// Fits and spawns the capsules of bodies whose [`BodyColliders`] were inserted or changed, and of those that waited for mesh or
/// joints.
pub(crate) fn spawn_body_colliders(
    mut commands: Commands,
    changed: Query<(Entity, Ref<BodyColliders>)>,
    bodies: SkinnedBodies,
    made: Query<(Entity, &BodyCollider)>,
    mut refusals: ResMut<Refusals>,
    mut to_fit: Local<Vec<Entity>>,
) {
    collect_changed(&changed, &mut to_fit);
    to_fit.sort_unstable();
    to_fit.dedup();
    to_fit.retain(|&body| {
        if !changed.contains(body) {
            return false;
        }
        let Some(fitted) = bodies.fit(body) else { return true };
        despawn(&mut commands, &made, body);
        refusals.forget_component(body, "BodyColliders");
        match fitted {
            Ok((capsules, report, friction)) => {
                for (joint, FittedCapsule { shape, transform, .. }) in capsules {
                    let name = bodies.names.get(joint).map_or("joint", Name::as_str);
                    let name = Name::new(format!("{name} collider"));
                    let obstacle = Obstacle::new(shape).with_friction(friction);
                    commands.spawn((obstacle, BodyCollider { body }, name, transform, ChildOf(joint)));
                }
                commands.entity(body).try_insert(report);
            }
            Err(reason) => {
                commands.entity(body).try_remove::<BodyCollidersReport>();
                refusals.entity(body, "BodyColliders", reason);
            }
        }
        false
    });
}

fn despawn(commands: &mut Commands, made: &Query<(Entity, &BodyCollider)>, body: Entity) {
    for (entity, _) in made.iter().filter(|(_, made)| made.body == body) {
        commands.entity(entity).try_despawn();
    }
}

/// Despawns the capsules of a body that loses its [`BodyColliders`].
pub(crate) fn remove_body_colliders(
    removed: On<Remove<BodyColliders>>,
    made: Query<(Entity, &BodyCollider)>,
    mut commands: Commands,
) {
    despawn(&mut commands, &made, removed.entity);
    commands.entity(removed.entity).try_remove::<BodyCollidersReport>();
}
