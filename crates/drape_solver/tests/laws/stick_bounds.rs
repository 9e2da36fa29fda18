//! Sticks with a bound, and joints of shared particles.

use std::sync::Arc;

use drape_solver::glam::Vec3;
use drape_solver::state::measure;
use drape_solver::{
    Body, BodySettings, Isa, Island, Particles, StateHasher, StickBound, StickKind, StickMaterial,
    StickProjection, TopologyBuilder, step,
};

use crate::common::*;

fn bounded(bound: StickBound) -> StickMaterial {
    StickMaterial { bound, ..StickMaterial::rigid(StickKind::Structural) }
}

/// Two particles of 1 and 3 kg after a step without forces. They start `length` metres apart, and a stick of 1 m with `bound`
/// joins them.
fn relaxed(bound: StickBound, length: f32, projection: StickProjection) -> [Vec3; 2] {
    let particles =
        Particles::new(Vec3::ZERO, &[Vec3::ZERO, Vec3::X * length], &[1.0, 1.0 / 3.0]).expect("valid");
    let mut builder = TopologyBuilder::new(&[Vec3::ZERO, Vec3::X]);
    builder.family(bounded(bound), [[0, 1]]).expect("valid");
    let settings = BodySettings { projection, ..bare() };
    let mut island =
        Island::of_body(Body::new(particles, Arc::new(builder.build().expect("valid")), settings));
    step(&mut island, &weightless(FRAME)).expect("valid");
    [0, 1].map(|i| island.bodies[0].particles.position(i))
}

/// S31: a stick with a least length has no effect if it is longer, and acts as a rod if it is shorter. A stick with a
/// greatest length does the reverse.
#[test]
fn a_bound_acts_on_its_side_alone_and_there_as_a_rod_does() {
    for projection in [StickProjection::Exact, StickProjection::SquareRootFree] {
        for length in [0.25_f32, 0.8, 0.999, 1.0, 1.001, 1.3, 2.5] {
            let free = [Vec3::ZERO, Vec3::X * length];
            let rod = relaxed(StickBound::Exact, length, projection);
            let expect = |acts: bool| if acts { rod } else { free };
            assert_eq!(relaxed(StickBound::AtLeast, length, projection), expect(length < 1.0), "{length} m");
            assert_eq!(relaxed(StickBound::AtMost, length, projection), expect(length > 1.0), "{length} m");
        }
    }
}

/// A weight on a cord of 1 m that falls from beside its nail first falls freely, then swings at the cord's length.
#[test]
fn a_cord_is_slack_until_it_is_taut() {
    let ends = [Vec3::ZERO, Vec3::new(0.3, 0.0, 0.0)];
    let particles = Particles::new(Vec3::ZERO, &ends, &[0.0, 1.0]).expect("valid");
    let mut builder = TopologyBuilder::new(&ends);
    builder.family_with_lengths(bounded(StickBound::AtMost), [([0, 1], 1.0)]).expect("valid");
    let settings = BodySettings { substeps: 8, ..bare() };
    let mut island =
        Island::of_body(Body::new(particles, Arc::new(builder.build().expect("valid")), settings));
    let mut longest = 0.0_f32;
    run_with(&mut island, &gravity(FRAME), 3.0, |island, frame| {
        let place = island.bodies[0].particles.position(1);
        longest = longest.max(place.length());
        // The fall of 0.95 m until the cord is taut takes 0.44 s.
        if frame < 25 {
            assert_eq!(place.x, 0.3, "nothing pulls aside in frame {frame}");
        }
    });
    law("longest that a cord of 1 m gets", longest.into(), 1.0, 1e-6);
    let stretch = measure::stretch(&island.bodies[0].particles, &island.bodies[0].topology);
    assert!(stretch.max < 1e-6, "slack is no strain: {stretch:?}");
}

/// The two particles of a hinge and the outer corners of two plates that share them, all in the plane y = 0.
const HINGED: [Vec3; 4] = [Vec3::Z, Vec3::NEG_Z, Vec3::X, Vec3::NEG_X];

/// Two triangles that share the edge from 0 to 1, and a stick with `bound` and `length` between their outer corners.
fn hinge(limit: Option<(StickBound, f32)>) -> Body {
    let particles = Particles::new(Vec3::ZERO, &HINGED, &[1.0; 4]).expect("valid");
    let mut builder = TopologyBuilder::new(&HINGED);
    let sticks = [[0, 1], [0, 2], [1, 2], [0, 3], [1, 3]];
    builder.family(bounded(StickBound::Exact), sticks).expect("valid");
    if let Some((bound, length)) = limit {
        builder.family_with_lengths(bounded(bound), [([2, 3], length)]).expect("valid");
    }
    let settings = BodySettings { substeps: 8, iterations: 4, ..bare() };
    Body::new(particles, Arc::new(builder.build().expect("valid")), settings)
}

/// S31: two shared particles make a hinge. The plates fold about the line through them: no outer corner moves along this
/// axis, or nearer to it.
#[test]
fn a_hinge_turns_about_its_two_particles_and_keeps_its_axis() {
    let mut body = hinge(None);
    [2, 3].into_iter().for_each(|wing| body.particles.set_velocity(wing, Vec3::Y * 2.0));
    let mut island = Island::of_body(body);
    let mut folded = f32::MAX;
    run_with(&mut island, &weightless(FRAME), 0.8, |island, _| {
        let places: Vec<Vec3> = island.bodies[0].particles.positions().collect();
        let [a, b] = [places[0], places[1]];
        let axis = (a - b).normalize();
        assert!(axis.dot(Vec3::Z) > 1.0 - 1e-5, "the axis turns: {axis}");
        for wing in [places[2], places[3]] {
            let arm = wing - (a + b) * 0.5;
            assert!(arm.dot(axis).abs() < 1e-3, "a wing slides along the axis by {} m", arm.dot(axis));
            assert!((arm.length() - 1.0).abs() < 0.01, "a wing is {} m from the axis", arm.length());
        }
        folded = folded.min(places[2].distance(places[3]));
    });
    assert!(folded < 0.8, "the hinge folds: {folded} m");
}

/// S31: a stick with a least length between the outer corners stops a hinge at an angle.
#[test]
fn a_least_length_between_its_wings_stops_a_hinge() {
    for least in [1.0_f32, 1.6] {
        let mut body = hinge(Some((StickBound::AtLeast, least)));
        [2, 3].into_iter().for_each(|wing| body.particles.set_velocity(wing, Vec3::Y * 2.0));
        let mut island = Island::of_body(body);
        let mut nearest = f32::MAX;
        run_with(&mut island, &weightless(FRAME), 1.5, |island, _| {
            let particles = &island.bodies[0].particles;
            nearest = nearest.min(particles.position(2).distance(particles.position(3)));
        });
        law(
            &format!("nearest that wings get with a least length of {least} m"),
            nearest.into(),
            least.into(),
            0.01,
        );
    }
}

/// S31: one shared particle makes a ball joint: the arms can rotate about it in all directions, and it never opens.
#[test]
fn a_pin_lets_all_directions_turn() {
    for way in [Vec3::Y, Vec3::Z, Vec3::new(0.0, 1.0, -1.0).normalize()] {
        let mut body =
            joined(&[Vec3::NEG_X, Vec3::ZERO, Vec3::X], &[1.0, 0.0, 1.0], &[[0, 1], [1, 2]], bare());
        body.settings = BodySettings { substeps: 8, iterations: 4, ..bare() };
        body.particles.set_velocity(2, way * 2.0);
        let mut island = Island::of_body(body);
        run(&mut island, &weightless(FRAME), 0.5);
        let particles = &island.bodies[0].particles;
        // 2 m/s for half a second: an arc of one radian.
        let expected = Vec3::X * 1.0_f32.cos() + way * 1.0_f32.sin();
        assert!(
            particles.position(2).distance(expected) < 0.01,
            "{} is not {expected}",
            particles.position(2)
        );
        assert_eq!(particles.position(0), Vec3::NEG_X, "the other arm feels nothing of it");
    }
}

/// A heap of cords and rods falls to the same bits on every instruction set.
#[test]
fn bounds_give_the_same_bits_on_every_instruction_set() {
    let count = 400_u32;
    let places: Vec<Vec3> = (0..count)
        .map(|i| Vec3::new((i % 20) as f32, (i * 7 % 11) as f32 * 0.1, (i / 20) as f32) * 0.1)
        .collect();
    let run_on = |isa: Isa| {
        let masses: Vec<f32> = (0..count).map(|i| if i < 3 { 0.0 } else { 1.0 + (i % 3) as f32 }).collect();
        let particles = Particles::new(Vec3::ZERO, &places, &masses).expect("valid");
        let mut builder = TopologyBuilder::new(&places);
        for (bound, way) in [(StickBound::Exact, 1), (StickBound::AtMost, 20), (StickBound::AtLeast, 2)] {
            builder.family(bounded(bound), (0..count - way).map(|i| [i, i + way])).expect("valid");
        }
        let settings = BodySettings { substeps: 4, iterations: 3, ..bare() };
        let body = Body::new(particles, Arc::new(builder.build().expect("valid")), settings);
        let mut island = Island { isa, ..Island::of_body(body) };
        run(&mut island, &gravity(FRAME), 0.5);
        StateHasher::new().particles(&island.bodies[0].particles).finish()
    };
    let mut hashes: Vec<u64> = Isa::available().into_iter().map(run_on).collect();
    hashes.dedup();
    assert_eq!(hashes.len(), 1);
}
