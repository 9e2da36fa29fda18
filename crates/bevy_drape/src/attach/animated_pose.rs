//! Cloth that an animation poses: where it has its pins, and the middles of its limits on motion.

use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::Placement;

#[cfg(feature = "mesh")]
use crate::rigid_motion::between;
use crate::rigid_motion::placement;

#[cfg(feature = "mesh")]

/// The pose that an animation gives to some particles of a body: each goes with a blend of up to four joints.
#[derive(Component, Clone, Debug, Default)]
pub(crate) struct AnimatedPose {
    pub joints: Vec<Entity>,
    /// From the mesh's coordinates into those of each joint.
    pub inverse_bind_poses: Vec<Affine3A>,
    /// The joint that most of the cloth hangs on.
    pub main: usize,
    pub particles: Vec<PosedParticle>,
    /// What took the mesh's coordinates to the world in the last step, joint by joint.
    pub last: Vec<Affine3A>,
    /// The same of the main joint, after the last two steps; none before the first.
    #[cfg_attr(not(feature = "mesh"), expect(dead_code, reason = "for what shows meshes"))]
    pub shown: [Option<Affine3A>; 2],
}

/// A particle with a place in an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PosedParticle {
    pub particle: u32,
    /// In the coordinates of the mesh.
    pub local: Vec3,
    pub joints: [u16; 4],
    /// They sum up to one.
    pub weights: [f32; 4],
}

impl PosedParticle {
    /// Where it belongs (linear blend skinning).
    pub fn target(&self, matrices: &[Affine3A]) -> Vec3 {
        let parts = self.joints.iter().zip(self.weights).filter(|&(_, weight)| weight > 0.0);
        parts.fold(Vec3::ZERO, |sum, (&joint, weight)| {
            sum + matrices[usize::from(joint)].transform_point3(self.local) * weight
        })
    }
}

impl AnimatedPose {
    /// What takes the mesh's coordinates to the world now; none if a joint is gone, or nowhere.
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

    /// Notes where a step has left the main joint.
    #[cfg(feature = "mesh")]
    pub fn record(&mut self) {
        let [_, before] = self.shown;
        let now = self.last.get(self.main).copied();
        self.shown = [before.or(now), now];
    }

    /// How far the main joint is ahead of what is shown at `fraction` of the last step: steps see it as it was, and the rest of the
    /// character is drawn as it is. None if it is there.
    #[cfg(feature = "mesh")]
    pub fn ahead<'a>(
        &self,
        fraction: f32,
        place: impl Fn(Entity) -> Option<&'a GlobalTransform>,
    ) -> Option<Affine3A> {
        let [Some(before), Some(after)] = self.shown else { return None };
        let place = place(*self.joints.get(self.main)?)?;
        let now = place.affine() * *self.inverse_bind_poses.get(self.main)?;
        let [from, to] = [before, after].map(|pose| GlobalTransform::from(pose).compute_transform());
        let shown = if before == after { after } else { between(&from, &to, fraction).compute_affine() };
        let ahead = now * shown.inverse();
        (now != shown && ahead.is_finite()).then_some(ahead)
    }

    /// Where the main joint was in the last step.
    pub fn last_place(&self) -> Option<Placement> {
        self.last.get(self.main).and_then(placement)
    }

    /// The same pose of a body, or of a piece of it, whose particles have these origins after a tear.
    pub fn torn(&self, origins: &[u32]) -> Self {
        let find = |origin: &u32| self.particles.iter().find(|posed| posed.particle == *origin);
        let found = (0..).zip(origins).filter_map(|(particle, origin)| Some((particle, *find(origin)?)));
        let particles = found.map(|(particle, posed)| PosedParticle { particle, ..posed }).collect();
        Self { particles, ..self.clone() }
    }
}
