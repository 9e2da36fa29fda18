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
/// use bevy_drape::tear::CutCloth;
///
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
/// A tear runs along the edges of faces and is drawn with frayed edges; a cut follows the blade and divides faces. Nothing is lost,
/// and texture coordinates stay the same on both sides. Each piece that comes off is a new entity: a clone of the torn one, with
/// the same material, settings and components, but with its own particles, sticks and mesh, and without a description such as
/// [`Cloth`](crate::build::cloth::Cloth). The largest piece stays on the torn entity. Observe
/// [`BodySplit`](crate::tear::messages::BodySplit) to remove components that a
/// piece should not have.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tearable {
    /// Strain beyond which a structural stick tears, above 0; 0.5, the default, is one and a half times the rest
    /// length. Even rigid sticks stretch under more load than the substeps can carry.
    ///
    /// With more than one iteration, the body is [swept](crate::body::StructuralSolve::Sweeps), as lines leave next to no
    /// strain. With one, as in `Quality::High`, lines stay and little tears: choose sweeps.
    pub strain: f32,
    /// The most particles that are split in one step; 16 by default. It limits the speed of a tear.
    pub most_at_once: u32,
    /// Pieces of fewer particles vanish; 4 by default.
    pub least_particles: u32,
}

impl Default for Tearable {
    fn default() -> Self {
        let TearLimits { strain, most } = TearLimits::default();
        Self { strain, most_at_once: most, least_particles: 4 }
    }
}

/// Marks a body that neither tears nor is cut.
#[derive(Component, Clone, Copy, Debug, Default)]
pub(crate) struct Untearable;

/// Marks a body that has become whole, or torn otherwise, other than by a tear: its mesh is made anew. Removed then.
#[derive(Component, Clone, Copy, Debug)]
pub(crate) struct RestoredMesh;

/// Origin of the vertices of a torn body's mesh. Removed once the new mesh is made.
#[derive(Component, Clone, Debug)]
pub(crate) struct TornMesh {
    /// The entity with the mesh from before the tear.
    pub source: Entity,
    /// For each particle, the vertex of that mesh.
    pub origins: Vec<u32>,
}
