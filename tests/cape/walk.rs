//! A skinned character walks, runs, jumps and turns about for half a minute, at all frame rates, and is teleported.

use bevy::prelude::*;
use bevy_drape::attach::TeleportCloth;
use bevy_drape::prelude::*;
use bevy_drape::step::MotionLimitCounts;

use crate::measure::{Skin, Worst, measure};
use crate::*;
use drape_examples::character::{self, Character};

/// Length of the walk in seconds.
const WALK: f64 = 30.0;

fn surface() -> BodySurface {
    BodySurface { drag: 1.0, thickness: 0.01, ..default() }
}

/// An app with a character in a cape, `fps` frames a second.
fn dressed(fps: f64, motion: impl Fn(Entity) -> WorldMotion) -> App {
    let mut app = app();
    app.finish();
    app.cleanup();
    frames(&mut app, 1.0 / fps);
    app.update();
    let character = character::spawn(app.world_mut(), surface());
    let motion = motion(character.root);
    app.world_mut().entity_mut(character.cape).insert(motion);
    app.insert_resource(character).init_resource::<Skin>().init_resource::<Worst>();
    app.add_systems(FixedLast, measure);
    app
}

/// One frame of the animation, and the steps that fall into the next.
fn frame(app: &mut App, time: f64) {
    let mut character = app.world().resource::<Character>().clone();
    character.advance(time as f32);
    character.write(app.world_mut());
    app.insert_resource(character);
    app.update();
}

fn walk(app: &mut App, fps: f64) -> Worst {
    for count in 0..(WALK * fps) as usize {
        frame(app, count as f64 / fps);
    }
    *app.world().resource::<Worst>()
}

fn assert_worn(name: &str, worst: &Worst) {
    println!("cape: {name}: {worst:?}");
    assert!(worst.steps > 1700, "{name}: {} steps", worst.steps);
    assert!(worst.depth < 2e-3, "{name}: {} m deep", worst.depth);
    assert!(worst.excess < 1e-3, "{name}: {} m beyond a limit", worst.excess);
    assert!(worst.pin_error < 1e-3, "{name}: a pin is {} m off", worst.pin_error);
    assert_eq!(worst.uncounted, 0, "{name}");
    // Ten frames a second see an about-turn in four straight pieces.
    assert!(worst.speed < 35.0, "{name}: {} m/s", worst.speed);
    // An arm pushes a hem that is held back.
    assert!(worst.rms_stretch < 0.15, "{name}: stretched by {}", worst.rms_stretch);
    assert!(worst.away < 2.0, "{name}: {} m away", worst.away);
}

#[test]
fn a_cape_is_worn_at_sixty_frames() {
    let mut app = dressed(60.0, WorldMotion::of);
    let worst = walk(&mut app, 60.0);
    assert_worn("60 fps", &worst);
    assert!(worst.away > 0.9, "it flies: {}", worst.away);
}

#[test]
fn a_cape_is_worn_at_ten_thirty_and_144_frames() {
    for fps in [10.0, 30.0, 144.0] {
        let mut app = dressed(fps, WorldMotion::of);
        assert_worn(&format!("{fps} fps"), &walk(&mut app, fps));
    }
}

#[test]
fn a_cape_that_inherits_little_is_calm() {
    let calm = {
        let mut app = dressed(60.0, |root| WorldMotion::of(root).with_scale(0.2, 0.2));
        walk(&mut app, 60.0)
    };
    assert_worn("60 fps, a fifth of the motion", &calm);
}

#[test]
fn a_teleported_character_takes_its_cape_along() {
    for fps in [10.0, 60.0, 144.0] {
        for is_marked in [false, true] {
            let mut app = dressed(fps, |root| {
                let motion = WorldMotion::of(root);
                if is_marked { WorldMotion { teleport_distance: f32::INFINITY, ..motion } } else { motion }
            });
            for count in 0..(6.0 * fps) as usize {
                if count as f64 == (3.0 * fps).floor() {
                    let mut character = app.world_mut().resource_mut::<Character>();
                    // Marked, it may be nearer than what tells by itself.
                    character.place += Vec3::new(if is_marked { 1.5 } else { 40.0 }, 0.0, 0.3);
                    character.heading += 1.2;
                    let cape = character.cape;
                    if is_marked {
                        app.world_mut().entity_mut(cape).insert(TeleportCloth);
                    }
                }
                frame(&mut app, count as f64 / fps);
            }
            let worst = *app.world().resource::<Worst>();
            println!("cape: teleport at {fps} fps, marked {is_marked}: {worst:?}");
            assert!(worst.speed < 10.0, "{fps} fps, {is_marked}: {} m/s", worst.speed);
            assert!(worst.rms_stretch < 0.05, "{fps} fps, {is_marked}: {}", worst.rms_stretch);
            assert!(worst.depth < 2e-3, "{fps} fps, {is_marked}: {} m deep", worst.depth);
            assert!(worst.excess < 1e-3, "{fps} fps, {is_marked}: {} m", worst.excess);
            assert!(app.world().resource::<Refusals>().is_empty());
        }
    }
}

#[test]
fn where_a_limit_and_a_capsule_cannot_both_hold_the_limit_does_and_it_is_counted() {
    let mut app = dressed(60.0, WorldMotion::of);
    let cape = app.world().resource::<Character>().cape;
    (0..60).for_each(|count| frame(&mut app, f64::from(count) / 60.0));
    assert_eq!(app.world().resource::<MotionLimitCounts>().total_conflicts, 0);
    // A pillow on the back, thicker than the limits of the cape's upper half are long.
    let chest = app.world().resource::<Character>().joints[2];
    let pillow = Obstacle::sphere(0.45);
    app.world_mut().spawn((pillow, Transform::default(), ChildOf(chest)));
    (60..120).for_each(|count| frame(&mut app, f64::from(count) / 60.0));
    let counts = *app.world().resource::<MotionLimitCounts>();
    assert!(counts.conflicts > 20, "{counts:?}");
    assert!(counts.total_conflicts >= counts.conflicts as u64);
    let worst = *app.world().resource::<Worst>();
    assert!(worst.excess < 1e-3, "{} m beyond a limit", worst.excess);
    assert!(particles(&app, cape).is_finite());
}
