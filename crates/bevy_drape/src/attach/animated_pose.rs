//! Poses that an animation gives to pins, and to the limits, backstops and drives of other particles.

use bevy::math::{Affine3A, Mat3A};
use bevy::prelude::*;
use drape_solver::Placement;

#[cfg(feature = "mesh")]
use crate::rigid_motion::ahead;
use crate::rigid_motion::placement;

/// The pose that an animation gives to some particles of a body. Each particle follows a blend of up to four joints.
#[derive(Component, Clone, Debug, Default)]
pub(crate) struct AnimatedPose {
    /// The component that it comes from, for the log.
    pub source: &'static str,
    pub joints: Vec<Entity>,
    /// From the mesh's coordinates into those of each joint.
    pub inverse_bind_poses: Vec<Affine3A>,
    /// Index of the joint with the most weight.
    pub main: usize,
    pub particles: Vec<PosedParticle>,
    /// For each joint, the matrix from the mesh to the world in the last step.
    pub last: Vec<Affine3A>,
    /// The same for the main joint after the last two steps; none before the first step.
    pub shown: [Option<Affine3A>; 2],
}

/// The pose of a body before its first tear.
#[derive(Component, Clone, Debug)]
pub(crate) struct WholePose(pub AnimatedPose);

/// A particle that follows an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PosedParticle {
    pub particle: u32,
    /// Position in the coordinates of the mesh.
    pub local: Vec3,
    /// Outward normal in the coordinates of the mesh, of length one; zero where faces look in opposite directions.
    pub normal: Vec3,
    pub joints: [u16; 4],
    /// Weights of the joints; their sum is one.
    pub weights: [f32; 4],
}

impl PosedParticle {
    /// Returns the position that the animation asks for (linear blend skinning).
    pub fn target(&self, matrices: &[Affine3A]) -> Vec3 {
        let parts = self.joints.iter().zip(self.weights).filter(|&(_, weight)| weight > 0.0);
        parts.fold(Vec3::ZERO, |sum, (&joint, weight)| {
            sum + matrices[usize::from(joint)].transform_point3(self.local) * weight
        })
    }

    /// Returns the outward normal there, of any length.
    pub fn normal(&self, matrices: &[Affine3A]) -> Vec3 {
        let parts = self.joints.iter().zip(self.weights).filter(|&(_, weight)| weight > 0.0);
        let blend = parts
            .fold(Mat3A::ZERO, |sum, (&joint, weight)| sum + matrices[usize::from(joint)].matrix3 * weight);
        turned_normal(&blend, self.normal)
    }
}

/// Returns the normal of a surface after a linear map, of any length: by the inverse transpose, but for a factor.
pub(crate) fn turned_normal(matrix: &Mat3A, normal: Vec3) -> Vec3 {
    let Mat3 { x_axis, y_axis, z_axis } = Mat3::from(*matrix);
    let yz = y_axis.cross(z_axis);
    let turned = yz * normal.x + z_axis.cross(x_axis) * normal.y + x_axis.cross(y_axis) * normal.z;
    if x_axis.dot(yz) < 0.0 { -turned } else { turned }
}

impl AnimatedPose {
    /// Computes the matrices from the mesh to the world now. Fails with the first joint that is despawned or not
    /// finite.
    pub fn matrices<'a>(
        &self,
        place: impl Fn(Entity) -> Option<&'a GlobalTransform>,
        matrices: &mut Vec<Affine3A>,
    ) -> Result<(), Entity> {
        matrices.clear();
        for (&joint, inverse_bind_pose) in self.joints.iter().zip(&self.inverse_bind_poses) {
            let matrix = place(joint).map(|place| place.affine() * *inverse_bind_pose);
            matrices.push(matrix.filter(Affine3A::is_finite).ok_or(joint)?);
        }
        Ok(())
    }

    /// Records the main joint after a step.
    #[cfg(feature = "mesh")]
    pub fn record(&mut self) {
        let [_, before] = self.shown;
        let now = self.last.get(self.main).copied();
        self.shown = [before.or(now), now];
    }

    /// Returns the motion from the main joint as shown at `fraction` of the last step to the joint as it is now. Steps
    /// see an older pose than the one that the rest of the character is drawn in. None if both are the same.
    #[cfg(feature = "mesh")]
    pub fn ahead<'a>(
        &self,
        fraction: f32,
        place: impl Fn(Entity) -> Option<&'a GlobalTransform>,
    ) -> Option<Affine3A> {
        let [Some(before), Some(after)] = self.shown else { return None };
        let place = place(*self.joints.get(self.main)?)?;
        let now = place.affine() * *self.inverse_bind_poses.get(self.main)?;
        ahead([before, after], fraction, now)
    }

    /// Returns the placement of the main joint in the last step.
    pub fn last_place(&self) -> Option<Placement> {
        self.last.get(self.main).and_then(placement)
    }

    /// Returns the pose of a torn body, or of a piece of it, whose particles have these origins.
    pub fn torn(&self, origins: &[u32]) -> Self {
        let find = |origin: &u32| self.particles.iter().find(|posed| posed.particle == *origin);
        let found = (0..).zip(origins).filter_map(|(particle, origin)| Some((particle, *find(origin)?)));
        let particles = found.map(|(particle, posed)| PosedParticle { particle, ..posed }).collect();
        Self { particles, ..self.clone() }
    }
}
