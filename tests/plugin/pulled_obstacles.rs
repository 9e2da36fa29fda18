//! Ropes that pull at the dynamic obstacles that they are tied to.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::common::*;

/// A wrecking ball of 50 kg on a rope of a metre, and the rope.
fn wrecking_ball(at: Vec3) -> (App, Entity, Entity) {
    let mut app = app();
    let ball = (Obstacle::sphere(0.2), DynamicObstacle::sphere(50.0, 0.2), Transform::from_translation(at));
    let ball = app.world_mut().spawn(ball).id();
    let hook = app.world_mut().spawn(Transform::default()).id();
    let rope = (Rope::new(Vec3::ZERO, at, 33), Attachment::first(hook).and(Tie::last(ball)));
    let rope = app.world_mut().spawn(rope).id();
    (app, ball, rope)
}

#[test]
fn a_wrecking_ball_swings_on_its_rope_and_falls_without_it() {
    let (mut app, ball, rope) = wrecking_ball(Vec3::X);
    let mut lowest = 0.0_f32;
    for _ in 0..120 {
        step(&mut app, 1);
        let place = get::<Transform>(&app, ball).translation;
        assert!((place.length() - 1.0).abs() < 5e-3, "{} m from its hook", place.length());
        let end = get::<Particles>(&app, rope).position(32);
        assert!(end.distance(place) < 1e-4, "the rope's end is {} m off", end.distance(place));
        lowest = lowest.min(place.y);
    }
    assert!(lowest < -0.98, "it swings down to {lowest}");
    app.world_mut().entity_mut(rope).remove::<Attachment>();
    run(&mut app, 2.0);
    assert!(get::<Transform>(&app, ball).translation.y < -5.0, "it falls");
}
