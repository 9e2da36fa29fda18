//! Editors, scenes and templates find everything by reflection; and no name gets in the way of another's.

use bevy::prelude::*;
use bevy::reflect::TypePath;
use bevy_drape::attach::TeleportCloth;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::{Activity, DefaultBodySurface, DefaultSolverSettings, Pressure, Sticks};
use bevy_drape::build::RigidTetrahedron;
use bevy_drape::cannon::Cannon;
use bevy_drape::clock::DrapeClock;
use bevy_drape::contact::{DrapeContactCounts, DrapeContactSettings};
use bevy_drape::detail::{CurrentDetail, LevelOfDetail};
use bevy_drape::environment::{MovedByObstacle, ObstacleReaction, TeleportObstacle};
use bevy_drape::prelude::*;
use bevy_drape::render::DrivenMesh;
use bevy_drape::rig::{InRig, Particle, Rig, Stick};
use bevy_drape::sleep::{ActivityCounts, SceneManager};
use bevy_drape::step::MotionLimitCounts;
use bevy_drape::transform::MovedByFrame;
use bevy_drape::viewer::Viewer;

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
    assert_component::<Fabric>(&app);
    assert_component::<BodySurface>(&app);
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
    assert_resource::<DefaultBodySurface>(&app);
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
    let told = ["FireCannon", "CannonFired", "BallHit", "BodyBuilt", "BodySlept", "BodyWoken"];
    for name in told.into_iter().chain(contacts).chain(tears) {
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

/// Components that can be made without code: by a default that editors find, or by a template that `bsn!` fills with entities.
#[test]
fn components_that_describe_something_have_defaults_or_templates() {
    fn assert_template<C: Component + FromTemplate>() {}
    assert_template::<DrivenMesh>();
    assert_template::<FollowParticle>();
    assert_template::<MovedByObstacle>();
    let app = app();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    // The plugin itself inserts these, or they have a template.
    let others = [
        "BodyCollider",
        "DrivenMesh",
        "FollowParticle",
        "InRig",
        "MovedByObstacle",
        "ProjectileState",
        "ShapeFromMesh",
    ];
    let mut count = 0;
    for registration in
        registry.iter().filter(|registration| registration.data::<ReflectComponent>().is_some())
    {
        let path = registration.type_info().type_path_table();
        let is_ours = path.crate_name().is_some_and(|name| name == "bevy_drape" || name == "drape_solver");
        if is_ours && !others.contains(&path.short_path()) {
            count += 1;
            assert!(registration.data::<ReflectDefault>().is_some(), "{}", path.short_path());
        }
    }
    assert!(count > 35, "{count} components");
}

/// The names in the source of the prelude, those of optional features included.
fn names_of_the_prelude() -> Vec<&'static str> {
    let source = include_str!("../../crates/bevy_drape/src/lib.rs");
    let (_, prelude) = source.split_once("pub mod prelude {").expect("a prelude");
    let words = prelude.split(|c: char| !c.is_alphanumeric() && c != '_');
    words.filter(|word| word.starts_with(char::is_uppercase)).collect()
}

#[test]
fn the_prelude_is_what_a_first_app_needs() {
    let names = names_of_the_prelude();
    assert!(names.contains(&"DrapePlugins") && names.contains(&"Cloth"), "{names:?}");
    assert!(names.len() <= 37, "{} names", names.len());
}

/// `preludes.txt` lists the preludes that an app may import beside ours; `.ci/preludes` asks the compiler for them. The crates
/// themselves would be heavy dependencies of a test.
#[test]
fn the_prelude_has_no_name_of_another_prelude() {
    let preludes = include_str!("preludes.txt").split("# ").skip(1).map(|prelude| {
        let (title, names) = prelude.split_once('\n').expect("a title and names");
        (title, names.split_whitespace().collect::<Vec<_>>())
    });
    let preludes: Vec<_> = preludes.collect();
    let known = [("bevy,", "Transform"), ("avian2d,", "Gravity"), ("avian3d,", "SubstepCount")];
    let rapiers = [("bevy_rapier2d,", "RapierContext"), ("bevy_rapier3d,", "SoftBody")];
    for (title, name) in known.into_iter().chain(rapiers) {
        let prelude = preludes.iter().find(|prelude| prelude.0.starts_with(title)).expect(title);
        assert!(prelude.1.contains(&name), "{title} {name}");
    }
    for name in names_of_the_prelude() {
        for (title, names) in &preludes {
            assert!(!names.contains(&name), "{name} is in the prelude of {title}, too");
        }
    }
}
