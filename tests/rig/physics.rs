//! Rigs obey the laws that other bodies obey.

use std::f32::consts::TAU;

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::Activity;
use bevy_drape::contact::{BallHit, HitTarget};
use bevy_drape::prelude::*;
use bevy_drape::rig::{Particle, Stick, StickKind};

use crate::support::{Rigs, STEP, assert_near};

const GRAVITY: f32 = 9.81;

#[test]
fn a_lone_particle_falls_freely() {
    let mut rigs = Rigs::new();
    let particle = rigs.free(2.0, Vec3::new(3.0, 10.0, -1.0));
    rigs.seconds(1.0);
    assert_near(rigs.place(particle), Vec3::new(3.0, 10.0 - 0.5 * GRAVITY, -1.0), 0.02);
    assert!((rigs.velocity(particle).y + GRAVITY).abs() < 0.01);
    rigs.assert_no_errors();
}

#[test]
fn a_particle_starts_with_its_velocity() {
    let mut rigs = Rigs::weightless();
    let velocity = Vec3::new(1.0, -2.0, 3.0);
    let particle = rigs.spawn(Particle { velocity, ..Particle::new(1.0) });
    rigs.seconds(2.0);
    assert_near(rigs.place(particle), velocity * 2.0, 1e-3);
}

#[test]
fn a_pendulum_swings_with_its_period() {
    let mut rigs = Rigs::new();
    let (length, amplitude) = (1.0, 0.05f32);
    let pivot = Vec3::new(0.0, 2.0, 0.0);
    let pin = rigs.pin(pivot);
    let bob = rigs.free(0.5, pivot + Vec3::new(amplitude.sin(), -amplitude.cos(), 0.0) * length);
    rigs.join(pin, bob);
    let mut crossings = Vec::new();
    let mut before = rigs.place(bob).x;
    for step in 0..720 {
        rigs.steps(1);
        let now = rigs.place(bob).x;
        if before > 0.0 && now <= 0.0 {
            crossings.push((step as f32 + before / (before - now)) * STEP);
        }
        before = now;
        assert!((rigs.place(bob).distance(pivot) / length - 1.0).abs() < 1e-3);
    }
    assert!(crossings.len() >= 5, "it swings on: {crossings:?}");
    let swings = (crossings.len() - 1) as f32;
    let period = (crossings[crossings.len() - 1] - crossings[0]) / swings;
    let expected = TAU * (length / GRAVITY).sqrt();
    assert!((period / expected - 1.0).abs() < 0.02, "{period} s instead of {expected} s");
    assert_eq!(rigs.place(pin), pivot);
    rigs.assert_no_errors();
}

#[test]
fn a_bridge_hangs_symmetric_and_as_a_catenary() {
    let mut rigs = Rigs::with_drag(2.0);
    let (span, links, link) = (5.0f32, 20, 0.275f32);
    let ends = [Vec3::new(0.0, 4.0, 0.0), Vec3::new(span, 4.0, 0.0)];
    let planks = rigs.chain(ends[0], ends[1], links + 1, [true, true]);
    for stick in rigs.all::<Stick>() {
        rigs.edit::<Stick>(stick, |stick| stick.rest_length = Some(link));
    }
    rigs.seconds(30.0);
    for i in 0..=links {
        let (left, right) = (rigs.place(planks[i]), rigs.place(planks[links - i]));
        // Sweeps that go from one end to the other leave a little of their direction.
        assert_near(left, Vec3::new(span - right.x, right.y, 0.0), 1e-3 * span);
    }
    for pair in planks.windows(2) {
        let length = rigs.place(pair[0]).distance(rigs.place(pair[1]));
        assert!((length / link - 1.0).abs() < 0.005, "{length}");
    }
    // The catenary of that length: 2 a sinh(span / 2a) = length.
    let length = link * links as f32;
    let (mut low, mut high) = (0.1f32, 100.0f32);
    for _ in 0..60 {
        let a = 0.5 * (low + high);
        if 2.0 * a * (span / (2.0 * a)).sinh() > length { low = a } else { high = a }
    }
    let expected = low * ((span / (2.0 * low)).cosh() - 1.0);
    let sag = ends[0].y - rigs.place(planks[links / 2]).y;
    assert!((sag / expected - 1.0).abs() < 0.02, "{sag} m instead of {expected} m");
}

#[test]
fn a_long_chain_with_a_heavy_end_does_not_stretch() {
    let mut rigs = Rigs::with_settings(1.0, SolverSettings { substeps: 4, ..default() });
    let chain = rigs.chain(Vec3::Y * 10.0, Vec3::Y * 4.0, 31, [true, false]);
    rigs.edit::<Particle>(chain[30], |particle| particle.mass = 50.0);
    rigs.seconds(4.0);
    // Relaxation alone leaves such a chain several per cent too long: the tethers hold the weight.
    let length = 10.0 - rigs.place(chain[30]).y;
    assert!((length / 6.0 - 1.0).abs() < 0.005, "{length} m");
}

#[test]
fn an_elastic_stick_stretches_under_its_load() {
    let mut rigs = Rigs::with_drag(3.0);
    let pin = rigs.pin(Vec3::Y * 5.0);
    let bob = rigs.free(1.0, Vec3::Y * 4.0);
    rigs.spawn(Stick { stiffness: 0.01, ..Stick::new(pin, bob) });
    rigs.seconds(8.0);
    // Stiffness s settles at g (1 - s) / s in units of the reference step of 1/60 s squared.
    let expected = GRAVITY * 99.0 / 3600.0;
    let stretch = 4.0 - rigs.place(bob).y;
    assert!((stretch / expected - 1.0).abs() < 0.05, "{stretch} m instead of {expected} m");
}

#[test]
fn damping_takes_the_speed_along_a_stick() {
    let speed_after = |damping: f32| {
        let mut rigs = Rigs::weightless();
        let pin = rigs.pin(Vec3::ZERO);
        let bob = rigs.spawn((
            Particle { velocity: Vec3::X, ..Particle::new(1.0) },
            Transform::from_translation(Vec3::X),
        ));
        rigs.spawn(Stick { stiffness: 0.0, damping, ..Stick::new(pin, bob) });
        rigs.seconds(1.0);
        rigs.velocity(bob).x
    };
    assert!((speed_after(0.0) - 1.0).abs() < 1e-3);
    assert!((speed_after(2.0) - (-2.0f32).exp()).abs() < 0.01);
}

fn drop_ball(rigs: &mut Rigs, place: Vec3) -> Entity {
    let projectile = Projectile { radius: 0.15, mass: 2.0, velocity: Vec3::NEG_Y * 6.0, ..default() };
    rigs.spawn((projectile, Transform::from_translation(place)))
}

fn hits(rigs: &Rigs) -> Vec<BallHit> {
    rigs.app.world().resource::<Messages<BallHit>>().iter_current_update_messages().copied().collect()
}

#[test]
fn a_ball_hits_a_stick_between_its_particles() {
    let mut rigs = Rigs::new();
    let ends = [rigs.pin(Vec3::new(-1.0, 1.0, 0.0)), rigs.pin(Vec3::new(1.0, 1.0, 0.0))];
    rigs.join(ends[0], ends[1]);
    let ball = drop_ball(&mut rigs, Vec3::new(0.3, 2.0, 0.0));
    let mut targets = Vec::new();
    for _ in 0..60 {
        rigs.steps(1);
        targets.extend(hits(&rigs).iter().map(|hit| (hit.kind, hit.target)));
        assert!(rigs.place(ball).y > 1.1, "the ball went through the stick: {}", rigs.place(ball));
    }
    assert_eq!(targets, [(HitTarget::Body, rigs.body(ends[0]))]);
}

#[test]
fn a_ball_pushes_a_free_rig_and_loses_momentum_to_it() {
    let mut rigs = Rigs::weightless();
    let ends = [rigs.free(0.5, Vec3::new(-0.5, 0.0, 0.0)), rigs.free(0.5, Vec3::new(0.5, 0.0, 0.0))];
    rigs.join(ends[0], ends[1]);
    let ball = drop_ball(&mut rigs, Vec3::Y);
    rigs.seconds(0.5);
    let speed_of_ball = rigs.app.world().get::<ProjectileState>(ball).expect("a ball").velocity().y;
    let rig = rigs.velocity(ends[0]).y + rigs.velocity(ends[1]).y;
    let momentum = 2.0 * speed_of_ball + 0.5 * rig;
    assert!(rig < -1.0, "the rig was pushed: {rig}");
    assert!((momentum / -12.0 - 1.0).abs() < 1e-3, "{momentum} kg m/s instead of -12");
}

#[test]
fn a_ball_hits_a_lone_particle() {
    let mut rigs = Rigs::weightless();
    let particle = rigs.free(1.0, Vec3::ZERO);
    drop_ball(&mut rigs, Vec3::Y);
    rigs.seconds(0.5);
    assert!(rigs.velocity(particle).y < -3.0, "{}", rigs.velocity(particle));
}

#[test]
fn a_ball_passes_a_bend_stick_but_not_the_particles_at_its_ends() {
    let mut rigs = Rigs::weightless();
    let ends = [rigs.pin(Vec3::new(-1.0, 0.0, 0.0)), rigs.pin(Vec3::new(1.0, 0.0, 0.0))];
    rigs.spawn(Stick { kind: StickKind::Bend, ..Stick::new(ends[0], ends[1]) });
    let middle = drop_ball(&mut rigs, Vec3::new(0.0, 1.0, 0.0));
    let side = drop_ball(&mut rigs, Vec3::new(1.0, 1.0, 0.0));
    rigs.seconds(0.5);
    assert!(rigs.place(middle).y < -1.5);
    assert!(rigs.place(side).y > 0.1);
}

#[test]
fn a_rig_lies_on_an_obstacle() {
    let mut rigs = Rigs::new();
    rigs.spawn((Obstacle::ground(), Transform::default()));
    let a = rigs.free(1.0, Vec3::new(0.0, 0.5, 0.0));
    let b = rigs.free(1.0, Vec3::new(1.0, 1.0, 0.0));
    rigs.join(a, b);
    rigs.seconds(5.0);
    for particle in [a, b] {
        assert!(rigs.place(particle).y.abs() < 0.02, "{}", rigs.place(particle));
    }
    assert_eq!(rigs.activity(a), Activity::Resting);
}
