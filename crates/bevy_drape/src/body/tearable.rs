//! Bodies that may tear.

use bevy::prelude::*;
use drape_solver::TearLimits;

/// Lets a body tear where its sticks are stretched too far. Rigs, whose particles are entities, do not tear; solids are refused.
///
/// A [`CutCloth`](crate::tear::messages::CutCloth) message cuts any body:
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// fn spawn(mut commands: Commands) {
///     commands.spawn((Cloth::new(2.0, 1.5), Tearable::default()));
/// }
///
/// fn slash(mut cuts: MessageWriter<CutCloth>) {
///     let (hilt, tip) = (Vec3::new(-2.0, 0.0, 0.0), Vec3::new(-2.0, 0.0, 2.0));
///     cuts.write(CutCloth::sweep([hilt, tip], [hilt + Vec3::X * 4.0, tip + Vec3::X * 4.0]));
/// }
/// ```
///
/// The cloth opens along the edges of its faces: no face is lost or divided, and texture coordinates stay the same on both
/// sides. Each piece that comes off is a new entity: a clone of the torn one, with the same material, settings and components,
/// but with its own particles, sticks and mesh, and without a description such as [`Cloth`](crate::build::cloth::Cloth). The
/// largest piece stays on the torn entity. Observe [`BodySplit`](crate::tear::messages::BodySplit) to remove components that a
/// piece should not have.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tearable {
    /// The strain of a structural stick beyond which it tears: 0.5, the default, means half as long again as at rest. Above
    /// 0. Rigid sticks stretch where more hangs on them than the substeps can carry.
    pub strain: f32,
    /// The most particles that are split in one step; 16 by default. How fast a tear runs.
    pub most_at_once: u32,
    /// Pieces of fewer particles vanish; 4 by default. Such a crumb is no cloth.
    pub least_particles: u32,
}

impl Default for Tearable {
    fn default() -> Self {
        let TearLimits { strain, most } = TearLimits::default();
        Self { strain, most_at_once: most, least_particles: 4 }
    }
}

/// On a body that neither tears nor is cut.
#[derive(Component, Clone, Copy, Debug, Default)]
pub(crate) struct Untearable;

/// How the vertices of a torn body's mesh follow from those of the mesh that it had. Taken off once the mesh is made.
#[derive(Component, Clone, Debug)]
pub(crate) struct TornMesh {
    /// The entity whose mesh it was.
    pub source: Entity,
    /// For each particle the vertex of that mesh.
    pub origins: Vec<u32>,
}
