//! Pins are fixed to their entity, and to what carries it.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::common::*;

/// Places of the curtain's pins in its own coordinates.
fn local_pins() -> [Vec3; 9] {
    core::array::from_fn(|column| Vec3::new(column as f32 / 8.0 - 0.5, 0.5, 0.0))
}

fn assert_pinned_to(app: &App, curtain: Entity, transform: Transform) {
    for (i, local) in local_pins().into_iter().enumerate() {
        let (pin, expected) = (get::<Particles>(app, curtain).position(i), transform.transform_point(local));
        assert!(pin.distance(expected) < 1e-4, "pin {i} is at {pin}, and its place at {expected}");
    }
}

#[test]
fn pins_follow_their_entity_in_every_step() {
    let mut app = app();
    let curtain = app.world_mut().spawn(curtain()).id();
    step(&mut app, 1);
    for count in 0..90 {
        let angle = count as f32 * 0.02;
        let transform = Transform::from_xyz(angle, 1.0, libm::sinf(angle)).with_rotation(Quat::from_euler(
            EulerRot::XYZ,
            angle * 0.3,
            angle,
            0.0,
        ));
        *get_mut::<Transform>(&mut app, curtain) = transform;
        step(&mut app, 1);
        assert_pinned_to(&app, curtain, transform);
    }
    let place = get::<Transform>(&app, curtain).translation;
    assert!(centre(&app, curtain).distance(place) < 1.0, "the cloth is pulled along");
}

#[test]
fn pins_follow_the_parent_of_their_entity() {
    let mut app = app();
    let ship = app.world_mut().spawn(Transform::default()).id();
    let sail = app.world_mut().spawn((curtain(), Transform::from_xyz(0.0, 5.0, 0.0), ChildOf(ship))).id();
    step(&mut app, 1);
    assert_pinned_to(&app, sail, Transform::from_xyz(0.0, 5.0, 0.0));
    for _ in 0..60 {
        let mut transform = get_mut::<Transform>(&mut app, ship);
        transform.translation.x += 0.02;
        transform.rotate_y(0.01);
        let expected = transform.mul_transform(Transform::from_xyz(0.0, 5.0, 0.0));
        step(&mut app, 1);
        assert_pinned_to(&app, sail, expected);
    }
}

#[test]
fn a_moved_rail_gives_the_cloth_its_velocity() {
    let mut app = app();
    weightless(&mut app);
    let curtain = app.world_mut().spawn((curtain(), dragless())).id();
    for _ in 0..240 {
        get_mut::<Transform>(&mut app, curtain).translation.y += 1.0 * STEP;
        step(&mut app, 1);
    }
    // Pulled straight up for four seconds, the cloth goes along at 1 m/s.
    let velocities = get::<Particles>(&app, curtain).velocities();
    let mean = velocities.sum::<Vec3>() / 81.0;
    assert!((mean.y - 1.0).abs() < 0.05, "{mean}");
}

#[test]
fn a_particle_that_is_let_go_does_not_follow() {
    let mut app = app();
    let curtain = app.world_mut().spawn(curtain()).id();
    step(&mut app, 1);
    let mut particles = get_mut::<Particles>(&mut app, curtain);
    for i in 0..9 {
        particles.set_inverse_mass(i, 100.0);
    }
    get_mut::<Transform>(&mut app, curtain).translation.y = 3.0;
    run(&mut app, 1.0);
    assert!(centre(&app, curtain).y < -2.0, "it fell");
}

#[test]
fn the_last_of_two_targets_for_a_pin_counts() {
    let mut app = app();
    let rope = app.world_mut().spawn(Rope::default()).id();
    step(&mut app, 1);
    let mut particles = get_mut::<Particles>(&mut app, rope);
    particles.set_pin_target(0, Vec3::new(0.3, 0.0, 0.0));
    particles.set_pin_target(0, Vec3::new(0.1, 0.2, 0.0));
    step(&mut app, 1);
    assert!(get::<Particles>(&app, rope).position(0).distance(Vec3::new(0.1, 0.2, 0.0)) < 1e-6);
}
