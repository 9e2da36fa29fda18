//! Ropes that are tied to dynamic bodies, and sleep and wake with them.

use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::prelude::*;

use crate::engine::*;
use crate::scene::*;

/// A crate of 20 kg at the end of a rope of 0.1 kg falls asleep with it. Without the rope it wakes and falls.
#[test]
fn a_crate_hangs_on_a_rope_until_the_rope_lets_go() {
    for lets_go in ["despawned", "untied"] {
        let mut app = app();
        ground(&mut app);
        let crate_ = spawn_crate(&mut app, 20.0, Vec3::Y * (2.0 - HALF));
        let rope = hang(&mut app, Vec3::Y * 3.0, crate_, Vec3::Y * 2.0);
        run(&mut app, 6.0);
        let at = place(&app, crate_);
        assert!(at.distance(Vec3::Y * (2.0 - HALF)) < 0.02, "{lets_go}: it hangs at {at}");
        assert!(is_asleep(&app, crate_), "{lets_go}: it is awake");
        assert_eq!(app.world().get::<Activity>(rope), Some(&Activity::Resting), "{lets_go}");
        run(&mut app, 2.0);
        assert!(place(&app, crate_).distance(at) < 1e-4, "{lets_go}: it has moved in its sleep");
        match lets_go {
            "despawned" => _ = app.world_mut().despawn(rope),
            _ => _ = app.world_mut().entity_mut(rope).remove::<Attachment>(),
        }
        run(&mut app, 2.0);
        assert!(
            place(&app, crate_).y < HALF + 0.02,
            "{lets_go}: it hangs in the air, {}",
            place(&app, crate_)
        );
    }
}

/// A crate that sleeps on its rope wakes if a ball hits the rope.
#[test]
fn a_crate_that_sleeps_on_its_rope_wakes_with_the_rope() {
    let mut app = app();
    let crate_ = spawn_crate(&mut app, 1.0, Vec3::Y * (2.0 - HALF));
    let rope = hang(&mut app, Vec3::Y * 3.0, crate_, Vec3::Y * 2.0);
    run(&mut app, 6.0);
    assert!(is_asleep(&app, crate_), "it sleeps");
    let ball = Projectile { velocity: Vec3::X * 10.0, mass: 2.0, ..Projectile::default() };
    app.world_mut().spawn((ball, Transform::from_xyz(-1.0, 2.5, 0.0)));
    run(&mut app, 1.0);
    assert!(!is_asleep(&app, crate_), "it is awake");
    assert!(place(&app, crate_).distance(Vec3::Y * (2.0 - HALF)) > 0.05, "it swings");
    assert_eq!(app.world().get::<Activity>(rope), Some(&Activity::Active));
}

/// Each of two crates that are tied together falls asleep, and neither wakes the other.
#[test]
fn two_crates_on_one_rope_fall_asleep() {
    let mut app = app();
    ground(&mut app);
    let one = spawn_crate(&mut app, 1.0, Vec3::new(-0.6, 0.2, 0.0));
    let other = spawn_crate(&mut app, 3.0, Vec3::new(0.6, HALF, 0.0));
    let ends = [Vec3::new(-0.45, 0.2, 0.0), Vec3::new(0.45, HALF, 0.0)];
    let tied = Attachment::first(one).and(Tie::last(other));
    app.world_mut().spawn((Rope::new(ends[0], ends[1], 20), tied));
    run(&mut app, 8.0);
    for body in [one, other] {
        assert!(is_asleep(&app, body), "it is awake, at {:?}", velocities(&app, body));
    }
}
