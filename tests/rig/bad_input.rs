//! Bad input is reported once, with the entity and the field, and everything else runs.

use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::prelude::*;
use bevy_drape::rig::{Particle, Stick};

use crate::support::{Rigs, assert_near};

/// Runs what `build` makes beside a pendulum that must go on. Expects one error that names the entity at fault
/// and all of `words`.
#[track_caller]
fn refused(words: &[&str], build: impl FnOnce(&mut Rigs, [Entity; 2]) -> Entity) {
    let mut rigs = Rigs::new();
    let pin = rigs.pin(Vec3::Y * 2.0);
    let bob = rigs.free(1.0, Vec3::new(1.0, 2.0, 0.0));
    rigs.join(pin, bob);
    let culprit = build(&mut rigs, [pin, bob]);
    rigs.steps(15);
    let errors = rigs.logged(&["ERROR"]);
    assert_eq!(errors.len(), 1, "said once: {errors:#?}");
    let name = format!("entity {culprit} ");
    for word in words.iter().copied().chain([name.as_str()]) {
        assert!(errors[0].contains(word), "{word:?} is missing in: {}", errors[0]);
    }
    let place = rigs.place(bob);
    assert!(place.y < 1.9 && (place.distance(Vec3::Y * 2.0) - 1.0).abs() < 0.01, "the rest runs: {place}");
}

#[test]
fn particles_of_impossible_mass_are_left_out() {
    for mass in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-30, 1e30] {
        refused(&["Particle", "mass"], |rigs, [_, bob]| {
            let culprit = rigs.free(mass, Vec3::X * 3.0);
            rigs.steps(1);
            assert_eq!(rigs.in_rig(culprit), None);
            assert!(rigs.in_rig(bob).is_some());
            culprit
        });
    }
}

#[test]
fn a_particle_with_a_velocity_that_is_not_finite_is_left_out() {
    refused(&["Particle", "velocity"], |rigs, _| {
        rigs.spawn(Particle { velocity: Vec3::new(0.0, f32::NAN, 0.0), ..default() })
    });
}

#[test]
fn a_particle_with_a_transform_that_is_not_finite_is_left_out() {
    for x in [f32::NAN, f32::INFINITY, 1e9] {
        refused(&["Particle", "Transform"], |rigs, _| rigs.free(1.0, Vec3::X * x));
    }
}

#[test]
fn sticks_with_ends_that_cannot_be_are_left_out() {
    refused(&["Stick", "`b`", "does not exist"], |rigs, [_, bob]| {
        let gone = rigs.spawn_empty();
        rigs.despawn(gone);
        rigs.join(bob, gone)
    });
    refused(&["Stick", "`a`", "no Particle"], |rigs, [_, bob]| {
        let bare = rigs.spawn(Transform::default());
        rigs.join(bare, bob)
    });
    refused(&["Stick", "same"], |rigs, [_, bob]| rigs.join(bob, bob));
    refused(&["Stick", "`a`"], |rigs, _| rigs.spawn(Stick::default()));
}

#[test]
fn the_second_of_two_sticks_between_the_same_particles_is_left_out() {
    refused(&["Stick", "`a`", "`b`", "already"], |rigs, [pin, bob]| rigs.join(bob, pin));
}

#[test]
fn sticks_of_impossible_length_stiffness_or_damping_are_left_out() {
    let stick = |field: &str, change: &dyn Fn(&mut Stick)| {
        refused(&["Stick", field], |rigs, [_, bob]| {
            let other = rigs.pin(Vec3::new(0.0, 9.0, 0.0));
            let mut stick = Stick::new(bob, other);
            change(&mut stick);
            rigs.spawn(stick)
        });
    };
    for value in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        stick("rest_length", &|stick| stick.rest_length = Some(value));
    }
    for value in [-0.1, 1.5, f32::NAN] {
        stick("stiffness", &|stick| stick.stiffness = value);
    }
    for value in [-1.0, f32::NAN, f32::INFINITY] {
        stick("damping", &|stick| stick.damping = value);
    }
}

#[test]
fn a_stick_between_coinciding_particles_is_left_out_for_good() {
    let mut rigs = Rigs::new();
    let (a, b) = (rigs.pin(Vec3::Y), rigs.free(1.0, Vec3::Y));
    let stick = rigs.join(a, b);
    rigs.steps(20);
    assert_eq!(rigs.logged(&["ERROR", "Stick", "rest_length", &format!("entity {stick} ")]).len(), 1);
    let fallen = rigs.place(b).y;
    assert!(fallen < 0.7, "{fallen}");
    // Another edit must not bring the stick to life at the length that its ends happen to be apart now.
    rigs.edit::<Particle>(b, |particle| particle.mass = 2.0);
    rigs.steps(20);
    assert!(rigs.place(b).y < fallen - 1.0);
    assert_eq!(rigs.logged(&["ERROR"]).len(), 1);
    rigs.edit::<Stick>(stick, |stick| stick.rest_length = Some(0.5));
    rigs.seconds(1.0);
    assert!((rigs.place(b).distance(Vec3::Y) - 0.5).abs() < 0.01, "a given length mends it");
}

#[test]
fn a_stick_whose_end_is_despawned_is_left_out_and_said_so() {
    let mut rigs = Rigs::new();
    let chain = rigs.chain(Vec3::Y * 5.0, Vec3::Y * 3.0, 3, [true, false]);
    rigs.steps(5);
    rigs.assert_no_errors();
    rigs.despawn(chain[1]);
    rigs.steps(30);
    let errors = rigs.logged(&["ERROR", "Stick", "does not exist"]);
    assert_eq!(errors.len(), 2, "one for each of the two sticks: {errors:#?}");
    assert!(rigs.place(chain[2]).y < 2.9, "the rest falls");
    assert_near(rigs.place(chain[0]), Vec3::Y * 5.0, 0.0);
}

#[test]
fn what_is_mended_runs_and_what_breaks_again_is_said_again() {
    let mut rigs = Rigs::new();
    let particle = rigs.free(-1.0, Vec3::ZERO);
    let pin = rigs.pin(Vec3::X);
    let stick = rigs.join(pin, particle);
    rigs.steps(5);
    assert_eq!(rigs.place(particle), Vec3::ZERO);
    assert_eq!(rigs.logged(&["ERROR", "mass"]).len(), 1);
    assert_eq!(rigs.logged(&["ERROR", "Stick", &format!("entity {stick} "), "left out itself"]).len(), 1);
    rigs.edit::<Particle>(particle, |particle| particle.mass = 1.0);
    rigs.steps(5);
    assert!(rigs.place(particle).y < 0.0);
    assert_eq!(rigs.body(particle), rigs.body(pin));
    rigs.edit::<Particle>(particle, |particle| particle.mass = -1.0);
    rigs.steps(5);
    assert_eq!(rigs.in_rig(particle), None);
    assert_eq!(rigs.logged(&["ERROR", "mass"]).len(), 2);
}

#[test]
fn a_particle_is_taken_in_when_its_transform_becomes_finite() {
    let mut rigs = Rigs::new();
    let particle = rigs.free(1.0, Vec3::NAN);
    rigs.steps(5);
    rigs.edit::<Transform>(particle, |transform| transform.translation = Vec3::Y);
    rigs.steps(10);
    assert!((0.5..1.0).contains(&rigs.place(particle).y), "{}", rigs.place(particle));
}

#[test]
fn a_transform_that_stops_being_finite_is_refused_and_the_particle_goes_on() {
    for pinned in [false, true] {
        let mut rigs = Rigs::new();
        let chain = rigs.chain(Vec3::Y * 5.0, Vec3::new(1.0, 5.0, 0.0), 2, [true, false]);
        rigs.steps(5);
        let culprit = if pinned { chain[0] } else { chain[1] };
        rigs.edit::<Transform>(culprit, |transform| transform.translation.y = f32::NAN);
        rigs.steps(20);
        let errors = rigs.logged(&["ERROR"]);
        assert_eq!(errors.len(), 1, "{errors:#?}");
        assert!(errors[0].contains("Transform") && errors[0].contains(&format!("entity {culprit} ")));
        let bob = rigs.place(chain[1]);
        assert!(bob.y < 4.9 && (bob.distance(Vec3::Y * 5.0) - 1.0).abs() < 0.01, "{bob}");
    }
}

#[test]
fn settings_out_of_range_leave_the_rig_out_until_they_are_mended() {
    let mut rigs = Rigs::new();
    let particle = rigs.free(1.0, Vec3::ZERO);
    rigs.app.world_mut().entity_mut(particle).insert(SolverSettings { substeps: 0, ..default() });
    rigs.steps(5);
    assert_eq!(rigs.logged(&["ERROR", "substeps"]).len(), 1);
    assert_eq!(rigs.place(particle), Vec3::ZERO);
    assert_eq!(rigs.activity(particle), Activity::Culled);
    rigs.edit::<SolverSettings>(particle, |settings| settings.substeps = 8);
    rigs.steps(10);
    assert!(rigs.place(particle).y < -0.05);
}

#[test]
fn a_state_that_is_not_finite_is_refused_and_an_edit_starts_it_anew() {
    let mut rigs = Rigs::new();
    let particle = rigs.free(1.0, Vec3::ZERO);
    rigs.steps(5);
    let body = rigs.body(particle);
    rigs.edit::<Particles>(body, |particles| particles.set_velocity(0, Vec3::NAN));
    rigs.steps(5);
    assert_eq!(rigs.logged(&["ERROR"]).len(), 1);
    assert_eq!(rigs.activity(particle), Activity::Culled);
    let left = rigs.place(particle);
    assert!(left.is_finite());
    rigs.edit::<Particle>(particle, |particle| particle.mass = 2.0);
    rigs.steps(10);
    assert_eq!(rigs.activity(particle), Activity::Active);
    assert!(rigs.place(particle).y < left.y);
}
