//! Bodies far from cloth, whose obstacles are disabled, and bodies that come near.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::engine::*;
use crate::scene::*;

fn is_enabled(app: &App, body: Entity) -> bool {
    let obstacle = app.world().get::<BodyObstacle>(body).expect("it has an obstacle");
    !app.world().entity(obstacle.entity()).contains::<Disabled>()
}

fn weightless() -> App {
    let mut app = app();
    set_gravity(&mut app, Vec3::ZERO);
    app.insert_resource(DrapeGravity(Vec3::ZERO)).insert_resource(Wind::default());
    app
}

#[test]
fn a_crate_that_comes_from_far_carries_a_free_sheet_along() {
    for distance in [1.0, 25.0] {
        let mut app = weightless();
        let cloth = Cloth::new(0.8, 0.8).with_particles(17, 17).with_pins(ClothPins::None);
        let sheet = app.world_mut().spawn((cloth, BodySurface { drag: 0.0, ..default() })).id();
        let motion = moving(Vec3::Z * 50.0, Vec3::ZERO);
        let at = Transform::from_xyz(0.0, 0.0, -distance);
        let crate_ = app.world_mut().spawn((box_of(0.6, 10.0), motion, at)).id();
        run(&mut app, 0.05);
        // Within its margin and twice its way in a step of 0.78 m.
        assert_eq!(is_enabled(&app, crate_), distance < 2.0);
        let mut face = 0.0;
        while face < 1.0 {
            app.update();
            face = place(&app, crate_).z + 0.3;
        }
        let particles = app.world().get::<Particles>(sheet).expect("it is built");
        let middle = particles.position(8 * 17 + 8);
        assert!(
            middle.z > face - 0.01,
            "from {distance} m: it has passed the sheet, its face at {face}, at {middle}"
        );
    }
}

/// The ball is there only once the step has begun, and passes the crate within it unless the crate is found then.
#[test]
fn a_ball_that_is_fired_beside_a_crate_hits_it() {
    let mut app = weightless();
    let crate_ = app.world_mut().spawn((box_of(0.2, 1.0), Transform::default())).id();
    run(&mut app, 0.1);
    assert!(!is_enabled(&app, crate_), "nothing is near");
    let ball = Projectile { velocity: Vec3::X * 80.0, radius: 0.05, mass: 1.0, ..default() };
    app.world_mut().spawn((ball, Transform::from_xyz(-0.4, 0.0, 0.0)));
    run(&mut app, 0.1);
    let velocity = velocities(&app, crate_)[0].x;
    assert!(velocity > 20.0, "it moves at {velocity} m/s");
}

#[test]
fn a_crate_that_sleeps_in_a_net_falls_when_the_net_is_elsewhere() {
    let mut app = app();
    let net = net(&mut app, 2.0);
    let crate_ = app.world_mut().spawn((box_of(0.3, 1.0), Transform::from_xyz(0.0, 2.3, 0.0))).id();
    run(&mut app, 6.0);
    assert!(is_asleep(&app, crate_), "it sleeps in the net");
    app.world_mut().get_mut::<Transform>(net).expect("it is there").translation.x = 50.0;
    run(&mut app, 1.0);
    assert!(place(&app, crate_).y < -1.0, "it has fallen, to {}", place(&app, crate_));
    assert!(!is_enabled(&app, crate_), "nothing is near");
}

/// A body is found by its ties, too, however far they are from it.
#[test]
fn a_crate_that_hangs_far_below_its_rope_is_held() {
    let mut app = app();
    let crate_ = spawn_crate(&mut app, 1.0, Vec3::Y * 0.4);
    hang(&mut app, Vec3::Y * 3.0, crate_, Vec3::Y * 2.0);
    run(&mut app, 2.0);
    assert!((place(&app, crate_).y - 0.4).abs() < 0.01, "it is at {}", place(&app, crate_));
}

#[test]
fn a_collider_that_swings_out_of_a_body_far_away_is_found() {
    let mut app = weightless();
    app.world_mut().spawn(Cloth::new(0.8, 0.8).with_particles(9, 9));
    let still = moving(Vec3::ZERO, Vec3::ZERO);
    let crane = (box_of(0.5, 10.0), still, sleepless(), Transform::from_xyz(9.0, 0.0, 0.0));
    let crane = app.world_mut().spawn(crane).id();
    let jib = (cuboid(Vec3::splat(0.1)), density(1.0), Transform::default(), ChildOf(crane));
    let jib = app.world_mut().spawn(jib).id();
    run(&mut app, 0.1);
    assert!(!is_enabled(&app, crane), "nothing is near");
    app.world_mut().get_mut::<Transform>(jib).expect("it is there").translation.x = -9.0;
    run(&mut app, 0.1);
    assert!(is_enabled(&app, crane), "its jib is in the cloth");
}
