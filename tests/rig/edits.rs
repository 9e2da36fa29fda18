//! Rigs can be edited while they move.

use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;
use bevy_drape::rig::{Particle, Rig, Stick, StickKind};
use bevy_drape::schedule::DrapeSchedule;
use bevy_drape::sleep::ActivityCounts;

use crate::support::{Rigs, STEP, assert_near};

/// A chain of `count` particles that flies with `velocity`, without gravity.
fn flying(rigs: &mut Rigs, count: usize, velocity: Vec3) -> Vec<Entity> {
    let chain = rigs.chain(Vec3::ZERO, Vec3::X * (count - 1) as f32, count, [false, false]);
    for &particle in &chain {
        rigs.edit::<Particle>(particle, |particle| particle.velocity = velocity);
    }
    chain
}

#[test]
fn added_particles_and_sticks_join_without_a_jolt() {
    let mut rigs = Rigs::weightless();
    let velocity = Vec3::new(3.0, 1.0, 0.0);
    let chain = flying(&mut rigs, 3, velocity);
    rigs.steps(30);
    let body = rigs.body(chain[0]);
    let before = rigs.place(chain[2]);
    let added = rigs
        .spawn((Particle { velocity, ..Particle::new(0.1) }, Transform::from_translation(before + Vec3::X)));
    rigs.join(chain[2], added);
    rigs.steps(1);
    assert_eq!(rigs.body(added), body, "the body that was there takes the new particle in");
    assert_eq!(rigs.count::<Rig>(), 1);
    for &particle in chain.iter().chain([&added]) {
        assert_near(rigs.velocity(particle), velocity, 1e-3);
    }
    assert_near(rigs.place(chain[2]), before + velocity * STEP, 1e-4);
    rigs.assert_no_errors();
}

#[test]
fn changes_of_mass_stiffness_and_length_keep_velocities() {
    let mut rigs = Rigs::weightless();
    let velocity = Vec3::new(0.0, 2.0, -1.0);
    let chain = flying(&mut rigs, 3, velocity);
    let brace = rigs.spawn(Stick { kind: StickKind::Bend, ..Stick::new(chain[0], chain[2]) });
    rigs.steps(10);
    rigs.edit::<Particle>(chain[1], |particle| {
        particle.mass = 7.0;
        particle.velocity = Vec3::ZERO;
    });
    rigs.edit::<Stick>(brace, |stick| stick.stiffness = 0.0);
    rigs.steps(1);
    for &particle in &chain {
        assert_near(rigs.velocity(particle), velocity, 1e-3);
    }
    // The light end gives way to the changed length; the middle, which is heavy now, does not.
    let first = rigs.app.world().get::<Rig>(rigs.body(chain[0])).expect("a rig").sticks()[0];
    rigs.edit::<Stick>(first, |stick| stick.rest_length = Some(0.8));
    let middle = rigs.place(chain[1]);
    rigs.steps(1);
    assert_near(rigs.place(chain[1]), middle + velocity * STEP, 0.01);
    assert!((rigs.place(chain[0]).distance(rigs.place(chain[1])) - 0.8).abs() < 0.01);
}

#[test]
fn a_freed_pin_falls_and_a_pinned_particle_stops() {
    let mut rigs = Rigs::new();
    let chain = rigs.chain(Vec3::Y * 5.0, Vec3::Y * 4.0, 2, [true, false]);
    rigs.steps(10);
    rigs.edit::<Particle>(chain[0], |particle| particle.pinned = false);
    rigs.seconds(0.5);
    assert!(rigs.place(chain[0]).y < 4.0 && rigs.place(chain[1]).y < 3.0, "both fall");
    rigs.edit::<Particle>(chain[0], |particle| particle.pinned = true);
    let caught = rigs.place(chain[0]);
    rigs.seconds(0.5);
    assert_near(rigs.place(chain[0]), caught, 1e-5);
    assert!(rigs.place(chain[1]).distance(caught) < 1.02, "the tether holds the other one");
}

#[test]
fn a_moving_pin_that_is_freed_flies_on() {
    let mut rigs = Rigs::weightless();
    let particle = rigs.pin(Vec3::ZERO);
    for step in 1..=10 {
        rigs.edit::<Transform>(particle, |transform| transform.translation.x = step as f32 * 0.05);
        rigs.steps(1);
    }
    rigs.edit::<Particle>(particle, |particle| particle.pinned = false);
    rigs.seconds(1.0);
    assert_near(rigs.place(particle), Vec3::X * 3.5, 0.01);
}

#[test]
fn removing_a_particle_splits_a_rig_whose_parts_hang_apart() {
    let mut rigs = Rigs::with_drag(2.0);
    let chain = rigs.chain(Vec3::new(-2.0, 5.0, 0.0), Vec3::new(2.0, 5.0, 0.0), 5, [true, true]);
    rigs.steps(5);
    assert_eq!(rigs.count::<Rig>(), 1);
    rigs.despawn(chain[2]);
    rigs.seconds(20.0);
    assert_eq!(rigs.count::<Rig>(), 2);
    assert_ne!(rigs.body(chain[1]), rigs.body(chain[3]));
    assert_near(rigs.place(chain[1]), Vec3::new(-2.0, 4.0, 0.0), 0.02);
    assert_near(rigs.place(chain[3]), Vec3::new(2.0, 4.0, 0.0), 0.02);
}

#[test]
fn removing_a_stick_splits_a_rig_in_flight_and_both_parts_fly_on() {
    let mut rigs = Rigs::weightless();
    let velocity = Vec3::new(0.0, 4.0, 2.0);
    let chain = flying(&mut rigs, 4, velocity);
    rigs.steps(20);
    let before: Vec<Vec3> = chain.iter().map(|&particle| rigs.place(particle)).collect();
    let middle = rigs.app.world().get::<Rig>(rigs.body(chain[0])).expect("a rig").sticks()[1];
    rigs.app.world_mut().entity_mut(middle).remove::<Stick>();
    rigs.steps(30);
    assert_eq!(rigs.count::<Rig>(), 2);
    for (&particle, before) in chain.iter().zip(before) {
        assert_near(rigs.velocity(particle), velocity, 1e-3);
        assert_near(rigs.place(particle), before + velocity * 0.5, 1e-3);
    }
    rigs.assert_no_errors();
}

#[test]
fn a_new_stick_joins_two_rigs_into_the_older() {
    let mut rigs = Rigs::new();
    let left = rigs.chain(Vec3::new(0.0, 5.0, 0.0), Vec3::new(0.0, 4.0, 0.0), 3, [true, false]);
    let right = rigs.chain(Vec3::new(1.0, 5.0, 0.0), Vec3::new(1.0, 4.0, 0.0), 3, [false, false]);
    rigs.steps(5);
    let body = rigs.body(left[0]);
    assert_ne!(rigs.body(right[0]), body);
    rigs.join(left[2], right[2]);
    rigs.steps(1);
    assert_eq!(rigs.body(right[0]), body);
    assert_eq!(rigs.count::<Rig>(), 1);
    rigs.seconds(2.0);
    assert!(rigs.place(right[0]).y > 0.0, "the free chain hangs from the pinned one");
}

#[test]
fn an_unrelated_edit_does_not_touch_a_rig() {
    let run = |edit: bool| {
        let mut rigs = Rigs::new();
        let chain = rigs.chain(Vec3::new(0.0, 5.0, 0.0), Vec3::new(2.0, 5.0, 0.0), 8, [true, false]);
        rigs.steps(40);
        if edit {
            rigs.free(1.0, Vec3::new(50.0, 0.0, 0.0));
        }
        rigs.steps(40);
        chain.iter().map(|&particle| rigs.place(particle)).collect::<Vec<_>>()
    };
    assert_eq!(run(false), run(true));
}

#[test]
fn a_measured_rest_length_stays_through_edits() {
    let mut rigs = Rigs::with_drag(4.0);
    let pin = rigs.pin(Vec3::Y * 5.0);
    let bob = rigs.free(1.0, Vec3::Y * 4.0);
    let stick = rigs.spawn(Stick { stiffness: 0.005, ..Stick::new(pin, bob) });
    rigs.seconds(2.0);
    assert!(rigs.place(bob).y < 3.7, "the load stretches the stick: {}", rigs.place(bob));
    rigs.edit::<Stick>(stick, |stick| stick.stiffness = 1.0);
    rigs.seconds(2.0);
    assert!((rigs.place(bob).y - 4.0).abs() < 0.01, "{}", rigs.place(bob));
}

#[test]
fn entity_ids_do_not_matter_to_the_result() {
    let run = |shuffle: bool| {
        let mut rigs = Rigs::new();
        if shuffle {
            // Freed ids come back in another order than they were handed out in.
            let junk: Vec<Entity> = (0..20).map(|_| rigs.spawn_empty()).collect();
            for i in [3, 17, 5, 0, 11, 8, 19, 1, 14, 6] {
                rigs.despawn(junk[i]);
            }
        }
        let mut chain = rigs.chain(Vec3::new(0.0, 5.0, 0.0), Vec3::new(2.0, 5.5, 0.3), 9, [true, false]);
        let other = rigs.chain(Vec3::new(0.0, 5.0, 1.0), Vec3::new(2.0, 5.0, 1.0), 4, [true, false]);
        rigs.steps(10);
        rigs.join(chain[4], other[3]);
        rigs.steps(10);
        rigs.despawn(chain.remove(6));
        rigs.steps(40);
        let places = chain.iter().chain(&other).map(|&particle| rigs.place(particle).to_array());
        (chain.clone(), places.map(|place| place.map(f32::to_bits)).collect::<Vec<_>>())
    };
    let (plain, shuffled) = (run(false), run(true));
    assert_ne!(plain.0, shuffled.0, "the entities differ");
    assert_eq!(plain.1, shuffled.1);
}

#[test]
fn the_surface_of_the_first_particle_that_has_one_serves_the_rig() {
    let mut rigs = Rigs::weightless();
    let chain = flying(&mut rigs, 3, Vec3::Y);
    let other = flying(&mut rigs, 2, Vec3::Y);
    let surface = |drag| BodySurface { drag, ..default() };
    let world = rigs.app.world_mut();
    world.entity_mut(chain[2]).insert(surface(5.0));
    world.entity_mut(chain[1]).insert(surface(1.0));
    rigs.seconds(1.0);
    assert_near(rigs.velocity(chain[0]), Vec3::Y * (-1.0f32).exp(), 0.01);
    assert_near(rigs.velocity(other[0]), Vec3::Y, 1e-3);

    rigs.edit::<BodySurface>(chain[1], |surface| surface.drag = 2.0);
    rigs.seconds(0.5);
    assert_near(rigs.velocity(chain[0]), Vec3::Y * (-2.0f32).exp(), 0.01);

    rigs.app.world_mut().entity_mut(chain[1]).remove::<BodySurface>();
    rigs.seconds(0.2);
    assert_near(rigs.velocity(chain[0]), Vec3::Y * (-3.0f32).exp(), 0.01);

    rigs.app.world_mut().entity_mut(chain[2]).remove::<BodySurface>();
    rigs.seconds(1.0);
    assert_near(rigs.velocity(chain[0]), Vec3::Y * (-3.0f32).exp(), 0.01);
}

#[test]
fn a_rig_at_rest_sleeps_and_an_edit_wakes_it() {
    let mut rigs = Rigs::with_drag(2.0);
    let chain = rigs.chain(Vec3::Y * 5.0, Vec3::Y * 4.0, 4, [true, false]);
    rigs.seconds(5.0);
    assert_eq!(rigs.activity(chain[0]), Activity::Resting);
    assert_eq!(*rigs.app.world().resource::<ActivityCounts>(), ActivityCounts { resting: 1, ..default() });
    rigs.free(0.1, Vec3::X * 9.0);
    rigs.steps(1);
    assert_eq!(rigs.activity(chain[0]), Activity::Resting, "the edit of another rig does not wake it");
    let added = rigs.free(0.1, Vec3::new(0.5, 4.0, 0.0));
    rigs.join(chain[3], added);
    rigs.steps(1);
    assert_eq!(rigs.activity(chain[0]), Activity::Active);
    rigs.seconds(0.5);
    assert!(rigs.place(added).y < 3.9, "the added particle swings down");
}

#[test]
fn despawning_everything_leaves_nothing_behind() {
    let mut rigs = Rigs::new();
    rigs.steps(1);
    let count = |rigs: &Rigs| rigs.app.world().entities().count_spawned();
    let before = count(&rigs);
    for round in 0..3 {
        let chain = rigs.chain(Vec3::new(0.0, 5.0, 0.0), Vec3::new(2.0, 5.0, 0.0), 6, [true, round == 1]);
        rigs.free(1.0, Vec3::Z);
        rigs.steps(20);
        assert_eq!(rigs.count::<Rig>(), 2);
        if round == 2 {
            rigs.despawn(chain[3]);
            rigs.steps(3);
        }
        for entity in rigs.all::<Particle>().into_iter().chain(rigs.all::<Stick>()) {
            rigs.despawn(entity);
        }
        rigs.steps(1);
        assert_eq!(count(&rigs), before, "round {round}");
    }
    rigs.steps(5);
}

#[test]
fn a_particle_that_is_a_particle_no_more_is_left_alone() {
    let mut rigs = Rigs::new();
    let chain = rigs.chain(Vec3::Y * 5.0, Vec3::Y * 4.0, 3, [false, false]);
    rigs.steps(10);
    rigs.app.world_mut().entity_mut(chain[1]).remove::<Particle>();
    rigs.steps(1);
    let left = rigs.place(chain[1]);
    assert_eq!(rigs.in_rig(chain[1]), None);
    rigs.steps(20);
    assert_eq!(rigs.place(chain[1]), left);
    assert!(rigs.place(chain[0]).y < left.y);
    // Taken up again, it starts from rest where it is.
    for stick in rigs.all::<Stick>() {
        rigs.despawn(stick);
    }
    rigs.app.world_mut().entity_mut(chain[1]).insert(Particle::new(1.0));
    rigs.steps(1);
    assert!(rigs.velocity(chain[1]).length() < 0.2);
}

#[test]
fn a_particle_that_is_removed_and_inserted_between_two_steps_starts_anew() {
    let mut rigs = Rigs::weightless();
    let chain = flying(&mut rigs, 2, Vec3::Y * 3.0);
    rigs.steps(10);
    for &particle in &chain {
        let velocity = Vec3::Z;
        let mut entity = rigs.app.world_mut().entity_mut(particle);
        entity.remove::<Particle>().insert(Particle { velocity, ..Particle::new(0.1) });
    }
    rigs.steps(1);
    for &particle in &chain {
        assert_near(rigs.velocity(particle), Vec3::Z, 1e-3);
    }
    assert_eq!(rigs.count::<Rig>(), 1);
}

#[test]
fn removal_is_seen_after_a_long_pause() {
    let mut rigs = Rigs::new();
    let chain = rigs.chain(Vec3::Y * 5.0, Vec3::Y * 4.0, 3, [true, false]);
    rigs.steps(5);
    rigs.app.world_mut().resource_mut::<DrapeClock>().paused = true;
    rigs.despawn(chain[1]);
    rigs.steps(10);
    rigs.app.world_mut().resource_mut::<DrapeClock>().paused = false;
    rigs.seconds(1.0);
    assert_eq!(rigs.count::<Rig>(), 2);
    assert!(rigs.place(chain[2]).y < 1.0, "the part without a pin falls");
}

#[test]
fn a_despawned_body_is_built_anew_from_the_transforms() {
    let mut rigs = Rigs::new();
    let chain = rigs.chain(Vec3::Y * 5.0, Vec3::Y * 4.0, 3, [true, false]);
    rigs.steps(5);
    let body = rigs.body(chain[0]);
    rigs.despawn(body);
    rigs.steps(2);
    assert_ne!(rigs.body(chain[0]), body);
    assert_eq!(rigs.count::<Rig>(), 1);
    assert_near(rigs.place(chain[2]), Vec3::Y * 4.0, 0.05);
}

/// Despawns what [`Doomed`] names, from within the step.
fn despawn_doomed(mut commands: Commands, mut doomed: ResMut<Doomed>) {
    for entity in doomed.0.drain(..) {
        commands.entity(entity).despawn();
    }
}

#[derive(Resource, Default)]
struct Doomed(Vec<Entity>);

#[test]
fn despawning_within_a_step_is_safe() {
    for set in [
        DrapeSystems::ManageScene,
        DrapeSystems::AccumulateForces,
        DrapeSystems::DetectCollisions,
        DrapeSystems::Finish,
    ] {
        let mut rigs = Rigs::new();
        rigs.app.init_resource::<Doomed>().add_systems(DrapeSchedule, despawn_doomed.in_set(set));
        let chain = rigs.chain(Vec3::Y * 5.0, Vec3::Y * 4.0, 5, [true, false]);
        rigs.steps(5);
        let doomed = [chain[2], rigs.body(chain[0])];
        for entity in doomed {
            rigs.app.world_mut().resource_mut::<Doomed>().0.push(entity);
            rigs.steps(3);
        }
        assert_eq!(rigs.count::<Rig>(), 2);
        rigs.seconds(1.0);
        assert!(rigs.place(chain[4]).y < 0.5, "the part without a pin falls: {}", rigs.place(chain[4]));
        assert_near(rigs.place(chain[0]), Vec3::Y * 5.0, 0.0);
    }
}
