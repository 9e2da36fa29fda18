//! Bodies that touch each other share an island: layers of cloth rest, sleep and wake as one.

use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::prelude::*;

use crate::common::*;

const THICKNESS: f32 = 0.02;

fn settings(self_contact: SelfContact) -> SolverSettings {
    SolverSettings { self_contact, ..default() }
}

/// A sheet of 0.6 m that lies level at this place.
fn sheet(app: &mut App, at: Vec3, settings: SolverSettings) -> Entity {
    let level = Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2);
    let place = Transform::from_translation(at).with_rotation(level);
    let cloth = Cloth::new(0.6, 0.6).with_particles(13, 13).with_pins(ClothPins::None);
    let fabric = Fabric { thickness: THICKNESS, drag: 2.0, ..default() };
    app.world_mut().spawn((cloth, fabric, settings, place)).id()
}

fn least_distance(app: &App, a: Entity, b: Entity) -> f32 {
    let (a, b) = (get::<Particles>(app, a), get::<Particles>(app, b));
    let pairs = a.positions().flat_map(|p| b.positions().map(move |q| p.distance(q)));
    pairs.fold(f32::INFINITY, f32::min)
}

/// A cape over a shirt: two sheets on a ball, one on the other.
fn layers(self_contact: SelfContact) -> (App, [Entity; 2]) {
    let mut app = app();
    app.world_mut().spawn(Obstacle::ground());
    app.world_mut().spawn((Obstacle::sphere(0.25), Transform::from_xyz(0.0, 0.3, 0.0)));
    let under = sheet(&mut app, Vec3::Y * 0.6, settings(self_contact));
    let over = sheet(&mut app, Vec3::Y * (0.6 + 2.0 * THICKNESS), settings(self_contact));
    step(&mut app, 1);
    (app, [under, over])
}

#[test]
fn layers_on_a_ball_fall_asleep_together_and_wake_together() {
    let (mut app, [under, over]) = layers(SelfContact::On);
    let mut steps = 0;
    while activity(&app, under) != Activity::Resting {
        assert_eq!(activity(&app, over), Activity::Active, "one island, one sleep");
        step(&mut app, 1);
        steps += 1;
        assert!(steps < 1200, "they never fell asleep: {} and {} m/s", speed(&app, under), speed(&app, over));
    }
    assert_eq!(activity(&app, over), Activity::Resting);
    let least = least_distance(&app, under, over);
    println!("asleep after {steps} steps, {least} m apart");
    assert!(least > 0.9 * 2.0 * THICKNESS, "{least} m");
    // A body that touches neither wakes neither.
    let far = sheet(&mut app, Vec3::X * 5.0 + Vec3::Y, settings(SelfContact::On));
    step(&mut app, 10);
    assert_eq!(
        [under, over, far].map(|body| activity(&app, body)),
        [Activity::Resting, Activity::Resting, Activity::Active]
    );
    // Whoever pulls at one wakes both.
    get_mut::<Particles>(&mut app, over).apply_impulse(0, Vec3::Y * 0.01);
    step(&mut app, 1);
    assert_eq!([under, over].map(|body| activity(&app, body)), [Activity::Active; 2]);
}

#[test]
fn a_cloth_that_falls_on_a_sleeping_one_wakes_it_if_both_touch_cloth() {
    for (self_contact, wakes) in [(SelfContact::On, true), (SelfContact::Off, false)] {
        let mut app = app();
        app.world_mut().spawn(Obstacle::ground());
        let lower = sheet(&mut app, Vec3::Y * THICKNESS, settings(self_contact));
        step(&mut app, 1);
        let mut steps = 0;
        while activity(&app, lower) != Activity::Resting {
            step(&mut app, 1);
            steps += 1;
            assert!(steps < 900, "it never fell asleep");
        }
        let upper = sheet(&mut app, Vec3::Y * 0.5, settings(self_contact));
        run(&mut app, 0.2);
        assert_eq!(activity(&app, lower), Activity::Resting, "not touched yet");
        run(&mut app, 0.25);
        assert_eq!(activity(&app, lower) == Activity::Active, wakes, "{self_contact:?}");
        run(&mut app, 1.0);
        let gap = centre(&app, upper).y - centre(&app, lower).y;
        assert_eq!(gap > THICKNESS, wakes, "{self_contact:?}: {gap} m");
    }
}
