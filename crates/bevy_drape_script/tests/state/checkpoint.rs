//! Checkpoints: a world that was saved and restored goes on with the same bits.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_drape::clock::DrapeClock;
use bevy_drape::contact::BallHit;
use bevy_drape::prelude::*;
use bevy_drape::sleep::ActivityCounts;
use bevy_drape::snapshot::{SnapshotError, members};
use bevy_drape_script::checkpoint::{Checkpoint, CheckpointError};

use crate::scenes::{fire, hash, world};

fn run(app: &mut App, steps: usize) {
    (0..steps).for_each(|_| app.update());
}

/// Through bytes, as from a file.
fn reread(checkpoint: &Checkpoint) -> Checkpoint {
    let bytes = checkpoint.to_bytes().expect("small enough");
    let again = Checkpoint::from_bytes(&bytes).expect("just written");
    assert_eq!(&again, checkpoint);
    again
}

fn counts(app: &App) -> ActivityCounts {
    *app.world().resource::<ActivityCounts>()
}

#[test]
fn a_restored_world_goes_on_with_the_same_bits() {
    let mut app = world(true);
    run(&mut app, 30);
    fire(&mut app);
    run(&mut app, 70);
    let saved = Checkpoint::take(app.world_mut(), "all of it");
    assert_eq!(saved.snapshot().steps(), app.world().resource::<DrapeClock>().steps());
    let before = hash(&mut app);
    run(&mut app, 100);
    let expected = hash(&mut app);
    assert_ne!(before, expected, "it stands still");

    // Another app, at another moment, in which nobody has fired.
    let mut other = world(true);
    run(&mut other, 17);
    reread(&saved).restore(other.world_mut()).expect("the same scene");
    assert_eq!(hash(&mut other), before);
    run(&mut other, 100);
    assert_eq!(hash(&mut other), expected);
    assert_eq!(counts(&other), counts(&app));

    // The same app, taken back.
    saved.restore(app.world_mut()).expect("the same world");
    run(&mut app, 100);
    assert_eq!(hash(&mut app), expected);
}

/// Steps until all sleep, then some more.
fn fall_asleep(app: &mut App) {
    for _ in 0..3000 {
        app.update();
        if counts(app).active == 0 {
            return run(app, 10);
        }
    }
    panic!("{:?} after 50 s", counts(app));
}

#[test]
fn what_sleeps_sleeps_on_and_wakes_as_it_would_have() {
    let mut app = world(false);
    fall_asleep(&mut app);
    let saved = reread(&Checkpoint::take(app.world_mut(), "all of it"));
    let asleep = hash(&mut app);
    let mut other = world(false);
    run(&mut other, 5);
    assert!(counts(&other).active > 0);
    saved.restore(other.world_mut()).expect("the same scene");
    run(&mut other, 100);
    assert_eq!(counts(&other).active, 0);
    assert_eq!(hash(&mut other), asleep);

    // A shot wakes both alike.
    run(&mut app, 100);
    for app in [&mut app, &mut other] {
        fire(app);
        run(app, 100);
        assert!(counts(app).active > 0);
    }
    assert_ne!(hash(&mut app), asleep);
    assert_eq!(hash(&mut other), hash(&mut app));
}

/// In the middle of everything: half asleep, just woken, about to be.
#[test]
fn any_moment_will_do() {
    let mut app = world(false);
    let mut saved = Vec::new();
    for step in 0..420 {
        if step == 200 {
            fire(&mut app);
            // What is spawned has to be seen by a step first.
            run(&mut app, 1);
        }
        if step % 60 == 0 {
            saved.push((step, Checkpoint::take(app.world_mut(), "all of it")));
        }
        app.update();
    }
    let expected = hash(&mut app);
    for (step, checkpoint) in saved {
        let mut other = world(false);
        checkpoint.restore(other.world_mut()).expect("the same scene");
        for now in step..420 {
            if now == 200 {
                fire(&mut other);
                run(&mut other, 1);
            }
            other.update();
        }
        assert_eq!(hash(&mut other), expected, "from step {step}");
    }
}

#[test]
fn hits_are_told_once() {
    #[derive(Resource, Default)]
    struct Hits(usize);
    let count = |mut hits: MessageReader<BallHit>, mut sum: ResMut<Hits>| sum.0 += hits.read().count();
    let listening = || {
        let mut app = world(true);
        app.init_resource::<Hits>().add_systems(Last, count);
        app
    };
    let mut app = listening();
    run(&mut app, 60);
    let saved = Checkpoint::take(app.world_mut(), "all of it");
    let before = app.world().resource::<Hits>().0;
    run(&mut app, 60);
    let later = app.world().resource::<Hits>().0 - before;
    assert!(before > 0, "nothing was hit at all");
    let mut other = listening();
    run(&mut other, 1);
    let own = other.world().resource::<Hits>().0;
    saved.restore(other.world_mut()).expect("the same scene");
    run(&mut other, 60);
    assert_eq!(other.world().resource::<Hits>().0 - own, later);
}

#[test]
fn gravity_wind_clock_and_settings_come_back() {
    let mut app = world(false);
    app.insert_resource(DrapeGravity(Vec3::new(0.0, -3.7, 0.0)));
    app.world_mut().resource_mut::<Wind>().velocity = Vec3::X * 3.0;
    app.world_mut().resource_mut::<DrapeClock>().time_scale = 0.5;
    let mut bodies = app.world_mut().query_filtered::<Entity, With<Rope>>();
    let rope = bodies.single(app.world()).expect("one rope");
    app.world_mut().entity_mut(rope).insert(SolverSettings { substeps: 11, ..default() });
    run(&mut app, 50);
    let saved = reread(&Checkpoint::take(app.world_mut(), "all of it"));
    run(&mut app, 50);
    let mut other = world(false);
    saved.restore(other.world_mut()).expect("the same scene");
    assert_eq!(*other.world().resource::<DrapeGravity>(), *app.world().resource::<DrapeGravity>());
    run(&mut other, 50);
    assert_eq!(hash(&mut other), hash(&mut app));
    assert_eq!(other.world().resource::<DrapeClock>(), app.world().resource::<DrapeClock>());
}

/// An obstacle that was despawned leaves the others in another order, which contacts are sorted by.
#[test]
fn what_was_despawned_is_gone_again() {
    let crates = |app: &mut App| {
        for i in 0..4 {
            let place = Vec3::new(-0.45 + 0.3 * i as f32, 0.15, 0.0);
            app.world_mut().spawn((Obstacle::cuboid(0.32, 0.3, 0.9), Transform::from_translation(place)));
        }
        run(app, 2);
    };
    let mut app = world(false);
    crates(&mut app);
    let of = |app: &mut App, name: &str| {
        let mut names = app.world_mut().query::<(Entity, &Name)>();
        let found = names.iter(app.world()).find(|(_, known)| known.as_str() == name);
        found.map(|(entity, _)| entity)
    };
    for name in ["ground", "rope"] {
        let entity = of(&mut app, name).expect("in the scene");
        app.world_mut().despawn(entity);
    }
    run(&mut app, 40);
    let saved = Checkpoint::take(app.world_mut(), "all of it");
    run(&mut app, 100);
    let mut other = world(false);
    crates(&mut other);
    saved.restore(other.world_mut()).expect("the same scene");
    assert_eq!((of(&mut other, "ground"), of(&mut other, "rope")), (None, None));
    run(&mut other, 100);
    assert_eq!(hash(&mut other), hash(&mut app));
    assert_eq!(members(other.world_mut()).len(), members(app.world_mut()).len());
}

/// Obstacles that are disabled keep their numbers. One that was disabled after the checkpoint was taken was not found any more, and one that
/// was enabled after it was despawned.
#[test]
fn disabled_obstacles_come_back_as_they_were() {
    let crates = |app: &mut App| {
        let spawn = |i: u16| {
            let place = Vec3::new(-0.3 + 0.3 * f32::from(i), 0.15, 0.0);
            (Obstacle::cuboid(0.32, 0.3, 0.9), Transform::from_translation(place))
        };
        let crates = [0, 1, 2].map(|i| app.world_mut().spawn(spawn(i)).id());
        run(app, 2);
        crates
    };
    let set_enabled = |app: &mut App, entity: Entity, is_enabled: bool| {
        let mut entity = app.world_mut().entity_mut(entity);
        if is_enabled {
            entity.remove::<Disabled>();
        } else {
            entity.insert(Disabled);
        }
    };
    let enabled = |app: &App, crates: [Entity; 3]| {
        crates.map(|entity| !app.world().entity(entity).contains::<Disabled>())
    };

    let mut app = world(false);
    let [one, two, three] = crates(&mut app);
    set_enabled(&mut app, one, false);
    run(&mut app, 30);
    for has_taken_a_step in [true, false] {
        if !has_taken_a_step {
            // These two changes are pending in the checkpoint.
            set_enabled(&mut app, one, true);
            set_enabled(&mut app, three, false);
        }
        let saved = reread(&Checkpoint::take(app.world_mut(), "all of it"));
        let before = enabled(&app, [one, two, three]);
        run(&mut app, 100);
        let expected = hash(&mut app);
        for (entity, is_enabled) in [(one, before[2]), (two, false), (three, before[0])] {
            set_enabled(&mut app, entity, is_enabled);
            app.world_mut().get_mut::<Transform>(entity).expect("it is there").translation.y += 0.1;
        }
        run(&mut app, 10);
        saved.restore(app.world_mut()).expect("the same world");
        assert_eq!(enabled(&app, [one, two, three]), before);
        run(&mut app, 100);
        assert_eq!(hash(&mut app), expected);

        let mut other = world(false);
        let same = crates(&mut other);
        saved.restore(other.world_mut()).expect("the same scene");
        assert_eq!(enabled(&other, same), before);
        run(&mut other, 100);
        assert_eq!(hash(&mut other), expected);
    }
    let count = members(app.world_mut()).len();
    app.world_mut().despawn(three);
    let saved = Checkpoint::take(app.world_mut(), "all of it");
    run(&mut app, 1);
    saved.restore(app.world_mut()).expect("it has nothing that is gone");
    assert_eq!(members(app.world_mut()).len(), count - 1, "one that goes while it is disabled is forgotten");
}

#[test]
fn another_scene_is_refused_and_left_alone() {
    let mut app = world(false);
    let saved = Checkpoint::take(app.world_mut(), "all of it");
    let mut empty = App::new();
    empty.add_plugins((MinimalPlugins, DrapePlugins::default()));
    let refused = saved.restore(empty.world_mut()).expect_err("nothing there");
    let is_early = matches!(refused, CheckpointError::AnotherWorld { source: SnapshotError::NotStepped, .. });
    assert!(is_early, "{refused}");

    let mut other = world(false);
    let mut bodies = other.world_mut().query_filtered::<Entity, With<Rope>>();
    let rope = bodies.single(other.world()).expect("one rope");
    other.world_mut().despawn(rope);
    run(&mut other, 3);
    let before = hash(&mut other);
    let refused = saved.restore(other.world_mut()).expect_err("another scene");
    let is_missing =
        matches!(refused, CheckpointError::AnotherWorld { source: SnapshotError::Missing(_), .. });
    assert!(is_missing, "{refused}");
    assert!(refused.to_string().contains("all of it"), "{refused}");
    assert_eq!(hash(&mut other), before);
}

#[test]
fn every_truncation_and_every_flipped_byte_is_refused() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()));
    app.world_mut().spawn((Projectile::default(), Transform::default()));
    app.world_mut().run_schedule(FixedPostUpdate);
    let bytes = Checkpoint::take(app.world_mut(), "a ball").to_bytes().expect("small");
    assert!(Checkpoint::from_bytes(&bytes).is_ok());
    for length in 0..bytes.len() {
        assert!(Checkpoint::from_bytes(&bytes[..length]).is_err(), "cut off at {length}");
    }
    for place in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[place] ^= 0x10;
        assert!(Checkpoint::from_bytes(&changed).is_err(), "byte {place}");
    }
}

/// The format had changed, and the fuzzer went on with files that were refused at their head.
#[test]
fn the_seeds_of_the_fuzzer_are_of_this_format() {
    let seeds = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/seeds/checkpoint");
    for name in ["start", "cut", "hit"] {
        let bytes = std::fs::read(format!("{seeds}/{name}")).expect("a seed");
        let read = Checkpoint::from_bytes(&bytes).map(|_| ());
        assert_eq!(
            read.map_err(|error| error.to_string()),
            Ok(()),
            "{name}: write the seeds anew, see fuzz/README.md"
        );
    }
}
