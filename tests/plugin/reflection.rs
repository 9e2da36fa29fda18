//! Editors, scenes and templates find everything by reflection; and no name gets in the way of another's.

use bevy::prelude::*;
use bevy::reflect::TypePath;
use bevy_drape::prelude::*;

use crate::common::*;

fn assert_component<C: Component + TypePath>(app: &App) {
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let registration = registry.get(core::any::TypeId::of::<C>());
    let registration = registration.unwrap_or_else(|| panic!("{} is not registered", C::type_path()));
    assert!(registration.data::<ReflectComponent>().is_some(), "{} is no component there", C::type_path());
}

fn assert_resource<R: Resource + TypePath>(app: &App) {
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let registration = registry.get(core::any::TypeId::of::<R>());
    let registration = registration.unwrap_or_else(|| panic!("{} is not registered", R::type_path()));
    assert!(registration.data::<ReflectResource>().is_some(), "{} is no resource there", R::type_path());
}

#[test]
fn components_and_resources_are_registered() {
    let app = app();
    assert_component::<Activity>(&app);
    assert_component::<Attachment>(&app);
    assert_component::<Cannon>(&app);
    assert_component::<Cloth>(&app);
    assert_component::<ContactEvents>(&app);
    assert_component::<DrapeLayers>(&app);
    assert_component::<DynamicObstacle>(&app);
    assert_component::<FollowParticle>(&app);
    assert_component::<InRig>(&app);
    assert_component::<Interpolated>(&app);
    assert_component::<LevelOfDetail>(&app);
    assert_component::<CurrentDetail>(&app);
    assert_component::<Obstacle>(&app);
    assert_component::<ObstacleReaction>(&app);
    assert_component::<Particle>(&app);
    assert_component::<Particles>(&app);
    assert_component::<Pressure>(&app);
    assert_component::<Projectile>(&app);
    assert_component::<ProjectileState>(&app);
    assert_component::<Rig>(&app);
    assert_component::<RigidTetrahedron>(&app);
    assert_component::<Rope>(&app);
    assert_component::<SoftBall>(&app);
    assert_component::<SolverSettings>(&app);
    assert_component::<Stick>(&app);
    assert_component::<Sticks>(&app);
    assert_component::<Tearable>(&app);
    assert_component::<TeleportObstacle>(&app);
    assert_component::<Viewer>(&app);
    assert_component::<WindZone>(&app);
    assert_component::<MovedByFrame>(&app);
    assert_component::<TeleportCloth>(&app);
    assert_component::<WorldMotion>(&app);
    assert_resource::<ActivityCounts>(&app);
    assert_resource::<DefaultSolverSettings>(&app);
    assert_resource::<DrapeClock>(&app);
    assert_resource::<DrapeContactCounts>(&app);
    assert_resource::<DrapeContactSettings>(&app);
    assert_resource::<DrapeGravity>(&app);
    assert_resource::<MotionLimitCounts>(&app);
    assert_resource::<Refusals>(&app);
    assert_resource::<SceneManager>(&app);
    assert_resource::<Wind>(&app);
    assert_resource::<bevy_drape::schedule::StepTimes>(&app);
}

#[test]
fn messages_are_registered() {
    let app = app();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let contacts = ["DrapeContactStarted", "DrapeContactHit", "DrapeContactEnded"];
    let tears = ["CutCloth", "StickTorn", "BodySplit"];
    for name in ["FireCannon", "CannonFired", "BallHit"].into_iter().chain(contacts).chain(tears) {
        assert!(registry.get_with_short_type_path(name).is_some(), "{name} is not registered");
    }
}

#[test]
fn a_cloth_is_made_and_changed_by_reflection_alone() {
    let mut app = app();
    let entity = app.world_mut().spawn_empty().id();
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let cloth = registry.get_with_short_type_path("Cloth").expect("registered");
    let component = cloth.data::<ReflectComponent>().expect("a component");
    let mut value = cloth.data::<ReflectDefault>().expect("a default").default();
    let fields = value.reflect_mut().as_struct().expect("a struct");
    fields.field_mut("size").expect("a size").apply(&Vec2::new(2.0, 1.0));
    component.insert(&mut app.world_mut().entity_mut(entity), value.as_partial_reflect(), &registry);
    step(&mut app, 1);
    let (low, high) = get::<Particles>(&app, entity).bounds();
    assert!((high.x - low.x - 2.0).abs() < 1e-4);
}

/// Both preludes as globs, as every app has them: a name that both have would not compile where it is used.
mod both {
    use bevy::prelude::*;
    use bevy_drape::prelude::*;

    macro_rules! full_names {
        ($($name:ident)*) => { [$((stringify!($name), core::any::type_name::<$name>())),*] };
    }

    /// Every name of the prelude, and the full one that it stands for.
    pub fn names() -> impl Iterator<Item = (&'static str, &'static str)> {
        full_names! {
            Activity ActivityCounts Attachment BallHit BodySplit Cannon CannonFired Cloth ClothPins ContactEvents
            ContactFeature CurrentDetail CutCloth DefaultSolverSettings DetailLevel DrapeClock DrapeContact DrapeContactCounts
            DrapeContactEnded DrapeContactHit DrapeContactSettings DrapeContactStarted DrapeDiagnosticsPlugin
            DrapeGravity DrapeLayers DrapePlugins DrapeSchedule DrapeSubsteps DrapeSystems DynamicObstacle FireCannon
            FollowParticle FollowedParticle Grab Gusts Hand HitTarget InRig Interpolated LevelOfDetail MotionLimitCounts
            MovedByFrame Obstacle ObstacleReaction ObstacleShape Particle Particles PlaneLock Preset Pressure
            Projectile ProjectileState Quality Ragdoll RagdollEntities Refusals Rig RigidTetrahedron Rope
            SceneManager SelfContact SoftBall SolverSettings Stick StickBound StickKind StickProjection StickTorn
            Sticks StructuralSolve Tearable TeleportCloth TeleportObstacle Tie TiedParticles Viewer Winch Wind
            WindFlow WindRegion WindZone WorldMotion
        }
        .into_iter()
    }

    /// A name of Bevy's, so that its prelude is in use.
    pub type Bevys = Transform;
}

#[test]
fn the_prelude_has_no_name_of_bevys() {
    for (name, full) in both::names() {
        let is_ours =
            ["bevy_drape::", "drape_solver::"].iter().any(|crate_name| full.starts_with(crate_name));
        assert!(is_ours, "{name} is {full}");
    }
    assert!(core::any::type_name::<both::Bevys>().starts_with("bevy_transform::"));
}

/// The names in the source of the prelude, those of optional features included.
fn names_in_source() -> Vec<&'static str> {
    let source = include_str!("../../crates/bevy_drape/src/lib.rs");
    let (_, prelude) = source.split_once("pub mod prelude {").expect("a prelude");
    let words = prelude.split(|c: char| !c.is_alphanumeric() && c != '_');
    words.filter(|word| word.starts_with(char::is_uppercase)).collect()
}

#[test]
fn the_test_above_knows_every_name() {
    /// Those that exist only with some feature.
    const OPTIONAL: [&str; 10] = [
        "ClothMesh",
        "ClothPaint",
        "ClothWeave",
        "Draggable",
        "DrapeGizmos",
        "DrivenMesh",
        "PaintChannel",
        "RopeMesh",
        "SoftBody",
        "WeldedVertices",
    ];
    const TRAITS: [&str; 1] = ["Gestures"];
    for name in names_in_source() {
        let is_known = OPTIONAL.contains(&name)
            || TRAITS.contains(&name)
            || both::names().any(|(known, _)| known == name);
        assert!(is_known, "add {name} to the list of `both`");
    }
}

/// `avian_prelude.txt` lists what `avian3d` 0.7.0 has in its prelude, all features on. The crate itself would be a
/// heavy dependency for a test.
#[test]
fn the_prelude_has_no_name_of_avians() {
    let avians: Vec<&str> = include_str!("avian_prelude.txt").split_whitespace().collect();
    assert!(avians.contains(&"Gravity") && avians.contains(&"SubstepCount"));
    for name in names_in_source() {
        assert!(!avians.contains(&name), "{name} is Avian's, too");
    }
}
