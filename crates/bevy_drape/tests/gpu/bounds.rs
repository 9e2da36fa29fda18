//! Bounds follow what the GPU reports.

use bevy::camera::primitives::Aabb;
use bevy_drape::body::Activity;

use crate::*;

/// Bounds of a body in the world.
fn bounds(app: &App, body: Entity) -> [Vec3; 2] {
    let entity = app.world().entity(body);
    let place = entity.get::<GlobalTransform>().expect("a place");
    assert_eq!(place.to_scale_rotation_translation().1, Quat::IDENTITY);
    let bounds = entity.get::<Aabb>().expect("bounds");
    [bounds.min(), bounds.max()].map(|corner| place.transform_point(corner.into()))
}

/// The box around the particles of a body.
fn around(app: &App, body: Entity) -> [Vec3; 2] {
    let places = positions(app, body);
    [places.iter().copied().reduce(Vec3::min), places.into_iter().reduce(Vec3::max)]
        .map(|corner| corner.expect("particles"))
}

fn assert_within(app: &App, body: Entity) {
    let ([low, high], [least, greatest]) = (bounds(app, body), around(app, body));
    assert!(
        low.cmple(least).all() && high.cmpge(greatest).all(),
        "{low} to {high} lack {least} to {greatest}"
    );
}

/// Once a body on the GPU had bounds around everything, and before that those from when it went there.
#[test]
fn bounds_hold_the_body_all_the_time_and_little_more() {
    let mut app = app();
    app.world_mut().spawn(Obstacle::ground());
    let place = Transform::from_xyz(2.0, 3.0, 1.0);
    let falling = spawn(&mut app, (swinging().with_pins(ClothPins::None), place));
    let swinging = spawn(&mut app, (swinging(), place.with_scale(Vec3::new(2.0, 1.0, 1.0))));
    run(&mut app, 2);
    for _ in 0..160 {
        run(&mut app, 1);
        assert_within(&app, falling);
        assert_within(&app, swinging);
    }
    let [low, high] = bounds(&app, falling);
    let [least, greatest] = around(&app, falling);
    assert!(greatest.y < 1.1, "it stands on the ground: {greatest}");
    let margin = (high - low) - (greatest - least);
    assert!(margin.max_element() < 1.0, "{margin} too much");
}

#[test]
fn bounds_stay_while_they_are_good_enough() {
    let mut app = app();
    let curtain = spawn(&mut app, Cloth::new(1.0, 1.0).with_particles(9, 9));
    run(&mut app, 60);
    let before = bounds(&app, curtain);
    app.insert_resource(Wind { velocity: Vec3::new(0.0, 0.0, 0.5), ..default() });
    let start = positions(&app, curtain)[80];
    run(&mut app, 20);
    assert!(positions(&app, curtain)[80].distance(start) > 1e-4, "it moves");
    assert_eq!(bounds(&app, curtain), before);
}

/// Bounds are in the coordinates of the entity, which may go away from a body without pins.
#[test]
fn bounds_follow_the_body_not_its_entity() {
    let mut app = app();
    let sheet = spawn(&mut app, swinging().with_pins(ClothPins::None));
    app.insert_resource(DrapeGravity(Vec3::ZERO));
    run(&mut app, 8);
    app.world_mut().entity_mut(sheet).insert(Transform::from_xyz(0.0, 40.0, 0.0));
    run(&mut app, 4);
    assert_within(&app, sheet);
    assert!(is_on_gpu(&app, sheet));

    // Nothing is reported of a body that rests.
    run(&mut app, 120);
    assert_eq!(app.world().get::<Activity>(sheet), Some(&Activity::Resting));
    app.world_mut().entity_mut(sheet).insert(Transform::from_xyz(30.0, 0.0, 0.0));
    run(&mut app, 1);
    assert_within(&app, sheet);
}

#[test]
fn a_body_that_is_nowhere_is_reported() {
    let mut app = app();
    let [sick, sound] = [spawn(&mut app, swinging()), spawn(&mut app, swinging())];
    run(&mut app, 1);
    app.world_mut().entity_mut(sick).remove::<SolveOnGpu>();
    let mut particles = app.world_mut().get_mut::<Particles>(sick).expect("it came back");
    particles.set_velocity(3, Vec3::splat(3e38));
    app.world_mut().entity_mut(sick).insert(SolveOnGpu);
    run(&mut app, 6);
    let refusals = app.world().resource::<Refusals>();
    assert!(refusals.of(sick).any(|refusal| refusal.component == "SolveOnGpu"));
    assert_eq!(refusals.of(sound).count(), 0);
}
