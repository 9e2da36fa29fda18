//! Scenes in Bevy's notation: fields that are left out have their defaults, and entities refer to each other by name.

use bevy::asset::AssetPlugin;
use bevy::prelude::*;
use bevy::scene::ScenePlugin;
use bevy_drape::attach::ParticleFollowers;
use bevy_drape::prelude::*;

use crate::common::*;

fn scene_app() -> App {
    let mut app = app();
    app.add_plugins((AssetPlugin::default(), ScenePlugin));
    app
}

#[test]
fn fields_that_a_scene_leaves_out_have_their_defaults() {
    fn flag() -> impl Scene {
        bsn! { Cloth { size: Vec2 { x: 3.0, y: 2.0 }, particles: UVec2 { x: 7, y: 5 } } }
    }
    let mut app = scene_app();
    let scene = bsn! { @flag() Cloth { pins: ClothPins::Left } Fabric { drag: 2.0 } };
    let flag = app.world_mut().spawn_scene(scene).expect("nothing to load").id();
    let expected = Cloth { size: Vec2::new(3.0, 2.0), particles: UVec2::new(7, 5), pins: ClothPins::Left };
    assert_eq!(*get::<Cloth>(&app, flag), expected);
    assert_eq!(*get::<Fabric>(&app, flag), Fabric { drag: 2.0, ..default() });
    step(&mut app, 2);
    assert_eq!(get::<Particles>(&app, flag).len(), 35);
}

#[test]
fn what_hangs_on_a_rope_is_listed_with_it_or_names_it() {
    let mut app = scene_app();
    let listed = bsn! {
        Rope { particles: 9 }
        ParticleFollowers [ #Lamp ]
    };
    let rope = app.world_mut().spawn_scene(listed).expect("nothing to load").id();
    let lamp = get::<ParticleFollowers>(&app, rope).iter().next().expect("a lamp");
    assert_eq!(*get::<FollowParticle>(&app, lamp), FollowParticle::last(rope));
    let named = bsn_list! {
        #Cable
        Rope { particles: 9 }
        --
        FollowParticle { body: #Cable, offset: { Vec3::X } }
    };
    let named = app.world_mut().spawn_scene_list(named).expect("nothing to load");
    let [cable, basket] = named[..] else { panic!("two entities: {named:?}") };
    step(&mut app, 3);
    let end = |rope| get::<Particles>(&app, rope).position(8);
    assert_eq!(get::<Transform>(&app, lamp).translation, end(rope));
    assert_eq!(get::<Transform>(&app, basket).translation, end(cable) + Vec3::X);
    // One that is despawned is no longer listed, and followers outlive what they followed.
    app.world_mut().despawn(basket);
    app.world_mut().despawn(rope);
    assert!(app.world().get::<ParticleFollowers>(cable).is_none());
    assert!(app.world().get::<FollowParticle>(lamp).is_none());
    step(&mut app, 1);
}
