//! Joints by shared particles, and sticks with a bound.

use bevy::prelude::*;
use bevy_drape::rig::{Particle, Stick};

use crate::support::*;

/// A weight hangs from a cord that is longer than the drop at first, and a prop keeps two particles apart.
#[test]
fn a_cord_holds_from_its_length_on_and_a_prop_down_to_it() {
    let mut rigs = Rigs::with_drag(1.0);
    let nail = rigs.pin(Vec3::Y * 5.0);
    let bob = rigs.free(1.0, Vec3::Y * 4.8);
    rigs.spawn(Stick::at_most(nail, bob, 1.5));
    rigs.seconds(0.3);
    let fallen = 4.8 - rigs.place(bob).y;
    assert!(fallen > 0.3, "slack, it falls freely: {fallen} m");
    rigs.seconds(4.0);
    assert_near(rigs.place(bob), Vec3::Y * 3.5, 0.01);

    let [left, right] = [-1.0, 1.0].map(|x| {
        let velocity = Vec3::X * (-4.0 * x);
        rigs.spawn((Particle { velocity, ..Particle::new(1.0) }, Transform::from_xyz(x, 50.0, 0.0)))
    });
    rigs.spawn(Stick::at_least(left, right, 0.8));
    rigs.seconds(1.0);
    let apart = rigs.place(left).distance(rigs.place(right));
    assert!((apart - 0.8).abs() < 0.01, "they meet the prop: {apart} m");
    rigs.assert_no_errors();
}

/// A door of two triangles on two pinned particles: it swings about the line through them.
#[test]
fn two_shared_particles_make_a_hinge_that_keeps_its_axis() {
    let mut rigs = Rigs::weightless();
    let hinge = [Vec3::ZERO, Vec3::Y * 2.0].map(|place| rigs.pin(place));
    let velocity = Vec3::Z;
    let edge = [Vec3::X, Vec3::new(1.0, 2.0, 0.0)].map(|place| {
        rigs.spawn((Particle { velocity, ..Particle::new(5.0) }, Transform::from_translation(place)))
    });
    for (a, b) in [
        (edge[0], edge[1]),
        (hinge[0], edge[0]),
        (hinge[1], edge[1]),
        (hinge[0], edge[1]),
        (hinge[1], edge[0]),
    ] {
        rigs.join(a, b);
    }
    for second in 1..=6 {
        rigs.seconds(1.0);
        let places = edge.map(|corner| rigs.place(corner));
        for (place, height) in places.into_iter().zip([0.0, 2.0]) {
            assert!(
                (place.y - height).abs() < 5e-3,
                "nothing slides along the axis: {place} after {second} s"
            );
            assert!((place.xz().length() - 1.0).abs() < 5e-3, "nothing leaves it: {place} after {second} s");
        }
    }
    assert!(rigs.place(edge[0]).distance(Vec3::X) > 0.2, "it has turned");
}

/// A stick between the wings of a hinge that sets a least length stops them; one that sets a greatest length, too.
#[test]
fn bounds_limit_the_angle_of_a_joint() {
    let mut rigs = Rigs::new();
    let elbow = rigs.pin(Vec3::Y * 3.0);
    let shoulder = rigs.pin(Vec3::new(0.0, 4.0, 0.0));
    let hand = rigs.free(1.0, Vec3::new(1.0, 3.0, 0.0));
    rigs.join(elbow, shoulder);
    rigs.join(elbow, hand);
    // Hanging straight down, the hand would be 2 m from the shoulder.
    rigs.spawn(Stick::at_most(shoulder, hand, 1.8));
    let mut farthest = 0.0_f32;
    for _ in 0..240 {
        rigs.steps(1);
        farthest = farthest.max(rigs.place(hand).distance(rigs.place(shoulder)));
    }
    assert!((farthest - 1.8).abs() < 0.01, "the elbow opens to {farthest} m");
}
