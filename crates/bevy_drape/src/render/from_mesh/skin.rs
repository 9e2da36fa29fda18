//! The animation of a cloth's mesh: its skin, or only its entity.

use bevy::math::Affine3A;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use drape_solver::{Backstop, MeshCloth};

use crate::attach::animated_pose::{AnimatedPose, PosedParticle};
use crate::render::from_mesh::pose_paint::particle_normals;
use crate::render::from_mesh::reading::{MeshFault, VertexSkin, positions, skin};

/// The skin of a cloth's mesh, or its entity, as joints.
pub(crate) struct ClothSkin {
    vertices: Vec<VertexSkin>,
    is_skinned: bool,
    pose: AnimatedPose,
    matrices: Vec<Affine3A>,
}

impl ClothSkin {
    /// Reads the skin of `mesh`. A mesh without a skin follows its entity. None while something has not loaded yet.
    ///
    /// # Errors
    /// [`MeshFault`] naming the fault of the skin.
    pub fn read<'a>(
        entity: Entity,
        mesh: &Mesh,
        skinned: Option<&SkinnedMesh>,
        bind_poses: Option<&Assets<SkinnedMeshInverseBindposes>>,
        place: impl Fn(Entity) -> Option<&'a GlobalTransform>,
    ) -> Result<Option<Self>, MeshFault> {
        let vertices = skin(mesh)?;
        let (Some(skinned), Some(vertices)) = (skinned, vertices) else {
            let mut pose =
                AnimatedPose { source: "SkinnedMesh", joints: vec![entity], ..AnimatedPose::default() };
            pose.inverse_bind_poses.push(Affine3A::IDENTITY);
            let matrices = place(entity).map(GlobalTransform::affine).into_iter().collect();
            return Ok(Some(Self { vertices: Vec::new(), is_skinned: false, pose, matrices }));
        };
        let Some(bind_poses) = bind_poses.and_then(|poses| poses.get(&skinned.inverse_bindposes)) else {
            return Ok(None);
        };
        let count = skinned.joints.len().min(bind_poses.len());
        let used = vertices.iter().flat_map(VertexSkin::used).map(|(joint, _)| usize::from(joint));
        if let Some(joint) = used.max().filter(|&joint| joint >= count) {
            return Err(MeshFault::NoSuchJoint { joint, count });
        }
        let mut pose = AnimatedPose {
            source: "SkinnedMesh",
            joints: skinned.joints[..count].to_vec(),
            inverse_bind_poses: bind_poses[..count].iter().map(|&pose| Affine3A::from_mat4(pose)).collect(),
            ..AnimatedPose::default()
        };
        let mut matrices = Vec::new();
        if pose.matrices(place, &mut matrices).is_err() {
            return Ok(None);
        }
        let mut shares = vec![0.0_f32; count];
        for (joint, weight) in vertices.iter().flat_map(VertexSkin::used) {
            shares[usize::from(joint)] += weight;
        }
        // The first of equals.
        let most = shares.iter().copied().fold(0.0, f32::max);
        pose.main = shares.iter().position(|&share| share == most).unwrap_or_default();
        Ok(Some(Self { vertices, is_skinned: true, pose, matrices }))
    }

    /// True if joints move it.
    pub fn is_skinned(&self) -> bool {
        self.is_skinned
    }

    /// Returns the transform of the mesh at rest: that of its main joint, or of its entity.
    pub fn rest(&self, transform: &GlobalTransform) -> Affine3A {
        let main = self.matrices.get(self.pose.main).filter(|_| self.is_skinned);
        main.copied().unwrap_or(transform.affine())
    }

    /// Builds the cloth, at rest as in the mesh, posed by the joints. Returns its pose too if a part of it follows the
    /// animation.
    pub fn build(
        mut self,
        mesh: &Mesh,
        transform: &GlobalTransform,
        build: impl Fn(&GlobalTransform) -> Result<MeshCloth, MeshFault>,
    ) -> Result<(MeshCloth, Option<AnimatedPose>), MeshFault> {
        if !self.is_skinned {
            let built = build(transform)?;
            let pose = built.particles.follows_pose().then(|| self.pose_of(&built, mesh)).transpose()?;
            return Ok((built, pose));
        }
        // Undeformed, but at its scale in the world.
        let main = self.matrices.get(self.pose.main).copied().unwrap_or_default();
        let mut built = build(&main.into())?;
        let pose = self.pose_of(&built, mesh)?;
        for place in &pose.particles {
            let (i, target) = (place.particle as usize, place.target(&self.matrices));
            built.particles.set_position(i, target);
            if let Some((_, distance)) = built.particles.motion_limit(i) {
                built.particles.set_motion_limit(i, target, distance);
            }
            if let Some((_, backstop)) = built.particles.backstop(i) {
                // Joints that turn against each other may leave no normal, and so no place for a sphere.
                let normal = place.normal(&self.matrices).try_normalize();
                let backstop = normal.map_or(Backstop::default(), |_| backstop);
                let normal = normal.unwrap_or(Vec3::Y);
                built.particles.set_backstop(i, target, normal, backstop).map_err(MeshFault::BadPaint)?;
            }
            if let Some((_, drive)) = built.particles.pose_drive(i) {
                built.particles.set_pose_drive(i, target, drive).map_err(MeshFault::BadPaint)?;
            }
        }
        Ok((built, Some(pose)))
    }

    fn pose_of(&mut self, built: &MeshCloth, mesh: &Mesh) -> Result<AnimatedPose, MeshFault> {
        let mut pose = core::mem::take(&mut self.pose);
        let normals = particle_normals(built, mesh)?;
        let mut known = vec![false; built.particles.len()];
        for (vertex, place) in positions(mesh)?.iter().enumerate() {
            let Some(particle) = built.particle_of_vertex[vertex] else { continue };
            if core::mem::replace(&mut known[particle as usize], true) {
                continue;
            }
            let VertexSkin { joints, weights } = self.vertices.get(vertex).copied().unwrap_or_default();
            let (local, normal) = ((*place).into(), normals[particle as usize]);
            pose.particles.push(PosedParticle { particle, local, normal, joints, weights });
        }
        pose.last.clone_from(&self.matrices);
        Ok(pose)
    }
}
