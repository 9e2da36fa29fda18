//! Obstacles from whole scenes.

use std::collections::BTreeMap;

use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use crate::body::particles::Particles;
use crate::build::cloth::Cloth;
use crate::build::soft_ball::SoftBall;
use crate::environment::obstacle::Obstacle;
use crate::render::from_mesh::cloth_mesh::ClothMesh;
use crate::render::from_mesh::driven_mesh::DrivenMesh;
use crate::render::from_mesh::soft_body::SoftBodyMesh;

/// Makes obstacles of the entity's meshes and of all meshes below it, also of those that load or spawn later: put it on the
/// root of a glTF scene, and cloth lies on whatever an artist has modelled.
///
/// Meshes that have an [`Obstacle`] already keep it. Cloths, soft bodies and skinned meshes are left out. Removing the
/// component removes the obstacles that it has made.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// # fn setup(mut commands: Commands, assets: Res<AssetServer>) {
/// let obstacles = ObstacleHierarchy::new(Obstacle::trimesh())
///     .and_named("Boulder", Obstacle::convex_hull().with_friction(0.9))
///     .except_named("Grass");
/// commands.spawn((WorldAssetRoot(assets.load("garden.gltf#Scene0")), obstacles));
/// # }
/// # #[derive(Component)] struct WorldAssetRoot(Handle<Mesh>);
/// ```
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default, Debug, Clone)]
#[require(Transform)]
pub struct ObstacleHierarchy {
    /// The obstacle that a mesh becomes, unless it is named below; none to take named ones only.
    pub obstacle: Option<Obstacle>,
    /// The obstacle that the mesh of this [`Name`] becomes, and each below an entity of this name; none to leave them out. The
    /// nearest name counts.
    pub named: BTreeMap<String, Option<Obstacle>>,
}

impl Default for ObstacleHierarchy {
    /// Each mesh as it is, by its triangles.
    fn default() -> Self {
        Self::new(Obstacle::trimesh())
    }
}

impl ObstacleHierarchy {
    /// Makes an `obstacle` of each mesh.
    pub fn new(obstacle: Obstacle) -> Self {
        Self { obstacle: Some(obstacle), named: BTreeMap::new() }
    }

    /// Makes obstacles of named meshes only.
    pub fn only_named() -> Self {
        Self { obstacle: None, named: BTreeMap::new() }
    }

    /// Makes an `obstacle` of the mesh with this name, and of each below an entity with this name.
    pub fn and_named(mut self, name: impl Into<String>, obstacle: Obstacle) -> Self {
        self.named.insert(name.into(), Some(obstacle));
        self
    }

    /// Leaves out the mesh with this name, and all below an entity with this name.
    pub fn except_named(mut self, name: impl Into<String>) -> Self {
        self.named.insert(name.into(), None);
        self
    }
}

/// Marks an obstacle that an [`ObstacleHierarchy`] made: that of this entity.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MadeByHierarchy(Entity);

/// Meshes that may become obstacles.
type Solid = (With<Mesh3d>, Without<SkinnedMesh>, NoBody, Or<(Without<Obstacle>, With<MadeByHierarchy>)>);

/// Neither simulated nor about to be.
type NoBody = (
    Without<Particles>,
    Without<Cloth>,
    Without<SoftBall>,
    Without<ClothMesh>,
    Without<SoftBodyMesh>,
    Without<DrivenMesh>,
);

/// Makes obstacles of meshes that appeared below an [`ObstacleHierarchy`], or of all below one that has changed.
pub(crate) fn make_obstacles(
    mut commands: Commands,
    hierarchies: Query<&ObstacleHierarchy>,
    changed: Query<Entity, Changed<ObstacleHierarchy>>,
    new: Query<Entity, (Added<Mesh3d>, Solid)>,
    solids: Query<(), Solid>,
    parents: Query<&ChildOf>,
    children: Query<&Children>,
    names: Query<&Name>,
) {
    let below = |root| core::iter::once(root).chain(children.iter_descendants(root));
    let of_changed = changed.iter().flat_map(below).filter(|&entity| solids.contains(entity));
    for entity in new.iter().chain(of_changed) {
        let ancestors = || core::iter::once(entity).chain(parents.iter_ancestors(entity));
        let mut found = ancestors().filter_map(|ancestor| Some((ancestor, hierarchies.get(ancestor).ok()?)));
        let Some((root, hierarchy)) = found.next() else { continue };
        let above_or_root = ancestors().take_while(|&ancestor| ancestor != root).chain([root]);
        let named = above_or_root
            .filter_map(|ancestor| names.get(ancestor).ok())
            .find_map(|name| hierarchy.named.get(name.as_str()));
        let mut entity = commands.entity(entity);
        match named.unwrap_or(&hierarchy.obstacle) {
            Some(obstacle) => entity.insert((obstacle.clone(), MadeByHierarchy(root))),
            None => entity.remove::<(Obstacle, MadeByHierarchy)>(),
        };
    }
}

/// Removes the obstacles that a removed [`ObstacleHierarchy`] has made.
pub(crate) fn remove_made_obstacles(
    removed: On<Remove<ObstacleHierarchy>>,
    made: Query<(Entity, &MadeByHierarchy)>,
    mut commands: Commands,
) {
    for (entity, _) in made.iter().filter(|(_, made)| made.0 == removed.entity) {
        commands.entity(entity).try_remove::<(Obstacle, MadeByHierarchy)>();
    }
}
