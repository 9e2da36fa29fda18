//! Springs of bones, as the extension `VRMC_springBone` of glTF describes them.

use bevy::ecs::entity::MapEntities;
use bevy::prelude::*;
use drape_solver::BuildError;
use drape_solver::constants::MAX_MAGNITUDE;
use drape_solver::error::in_range;

/// A chain of joints that swings by the equations of VRM's spring bones (`VRMC_springBone` 1.0, Verlet integration of the end of each
/// bone): what avatars bring along. It touches its own [colliders](SpringCollider) only, and is not part of the solver;
/// [`BoneCloth`](crate::bones::bone_cloth::BoneCloth) is, and so touches everything.
///
/// With the feature `gltf`, files that have the extension bring it and its colliders along.
///
/// Where the specification has frames, here are steps: forces and drag count by the step, so tune them at the rate of your fixed steps. Where
/// it has the pose of the file, here is the animated one. A chain that hangs on a joint of another swings after it. Joints show the result
/// as those of a `BoneCloth` do. [`TeleportCloth`](crate::attach::TeleportCloth) and jumps begin the swing anew.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct SpringBones {
    /// The joints from the root on; each must hang on the one before, with others between them or not. The last is only the end of the
    /// bone before it: its numbers do not count.
    #[entities]
    pub joints: Vec<SpringJoint>,
    /// The entities with the [`SpringCollider`]s that the ends of the bones stay out of.
    #[entities]
    pub colliders: Vec<Entity>,
    /// The joint, above the first one, in whose coordinates inertia counts: hair with the hips as its centre does not trail behind a
    /// runner. `None`: the world.
    #[entities]
    pub center: Option<Entity>,
}

/// A joint of [`SpringBones`]. The defaults are those of the specification.
#[derive(Reflect, MapEntities, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct SpringJoint {
    /// The joint.
    #[entities]
    pub joint: Entity,
    /// Radius in metres of the ball at the end of the bone that collides, 0 (the default) or more.
    pub hit_radius: f32,
    /// Pull towards the animated pose, 0 or more; 1 by default. In metres per second and step.
    pub stiffness: f32,
    /// Pull along [`gravity_dir`](Self::gravity_dir), 0 by default. In metres per second and step.
    pub gravity_power: f32,
    /// Direction of the pull in the world; down by default.
    pub gravity_dir: Vec3,
    /// Part of the motion that is lost in each step, 0 to 1; 0.5 by default.
    pub drag_force: f32,
}

impl SpringJoint {
    /// A joint with the default numbers.
    pub fn new(joint: Entity) -> Self {
        Self {
            joint,
            hit_radius: 0.0,
            stiffness: 1.0,
            gravity_power: 0.0,
            gravity_dir: Vec3::NEG_Y,
            drag_force: 0.5,
        }
    }

    /// Checks every number.
    pub(crate) fn validate(&self) -> Result<(), BuildError> {
        in_range("hit_radius", self.hit_radius, 0.0, MAX_MAGNITUDE)?;
        in_range("stiffness", self.stiffness, 0.0, MAX_MAGNITUDE)?;
        in_range("gravity_power", self.gravity_power, -MAX_MAGNITUDE, MAX_MAGNITUDE)?;
        in_range("drag_force", self.drag_force, 0.0, 1.0)?;
        for part in self.gravity_dir.to_array() {
            in_range("gravity_dir", part, -MAX_MAGNITUDE, MAX_MAGNITUDE)?;
        }
        Ok(())
    }
}

/// A ball, or a capsule, that [`SpringBones`] stay out of: from the place of its entity, which is best a child of a joint, to `tail`.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform)]
pub struct SpringCollider {
    /// Radius in metres, 0 or more. Scale does not change it.
    pub radius: f32,
    /// The other end of a capsule's axis in the entity's coordinates, in metres; zero for a ball.
    pub tail: Vec3,
}
