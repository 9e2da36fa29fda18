//! Twisted ribbons and ropes against the geometry of the helix.

use core::f64::consts::TAU;

use drape_solver::glam::{DVec3, Quat, Vec3};
use drape_solver::state::measure;
use drape_solver::{
    Body, BodySettings, ClothBuilder, ClothMaterial, Edge, Island, RopeBuilder, SelfContact, StructuralSolve,
};

use crate::common::*;

fn settings(thickness: f32, self_contact: SelfContact) -> BodySettings {
    // Tethers would keep what is stretched from twisting.
    BodySettings {
        thickness,
        self_contact,
        friction: 0.0,
        static_friction: 0.0,
        tethers: false,
        ..BodySettings::default()
    }
}

/// Moves the pins of a body along with its ends, which lie at 0 and at `length` on the Z axis: the far end turns by `angle`
/// (radians) and moves away by `pull` metres.
fn turn_end(body: &mut Body, start: &[Vec3], length: f32, angle: f32, pull: f32) {
    for (i, &from) in start.iter().enumerate() {
        if body.particles.is_pinned(i) && from.z > 0.5 * length {
            body.particles.set_pin_target(i, Quat::from_rotation_z(angle) * from + Vec3::Z * pull);
        }
    }
}

/// A ribbon whose ends are turned against each other and held lies on a helicoid: its rims are helices at half its width from the axis,
/// and strained by `sqrt((1 + pull)^2 + (twist width / 2)^2) - 1`, with chords for arcs. It touches itself nowhere, so self-contact
/// changes nothing. A row of more than two particles would buckle under the rims, which draw inwards.
#[test]
fn rims_of_a_twisted_ribbon_are_strained_like_helices() {
    const ROWS: usize = 17;
    let (width, length, pull) = (0.1_f32, 0.4_f32, 0.05_f32);
    let material = ClothMaterial {
        stretch_stiffness: 0.9,
        shear_stiffness: 0.01,
        bend_stiffness: 0.0,
        ..ClothMaterial::default()
    };
    let strain = |turns: f32, self_contact| {
        let ribbon = ClothBuilder::new(width, length, 2, ROWS as u32)
            .placed(Vec3::NEG_X * 0.5 * width, Vec3::X, Vec3::Z)
            .material(material)
            .pin_edge(Edge::Top)
            .pin_edge(Edge::Bottom)
            .build(BodySettings { iterations: 8, ..settings(0.003, self_contact) })
            .expect("valid");
        let start: Vec<Vec3> = ribbon.particles.positions().collect();
        let mut island = Island::of_body(ribbon);
        for index in 1..=300 {
            let part = (index as f32 / 120.0).min(1.0);
            turn_end(&mut island.bodies[0], &start, length, part * turns * TAU as f32, part * pull * length);
            run(&mut island, &weightless(FRAME), FRAME);
        }
        let places: Vec<DVec3> = measure::positions(particles(&island)).collect();
        let rims = places.windows(3).map(|three| three[0].distance(three[2]));
        0.5 * rims.sum::<f64>() / f64::from(length) - 1.0
    };
    for turns in [0.25_f32, 0.5, 0.75] {
        let segments = (ROWS - 1) as f64;
        let across = f64::from(width) * (0.5 * TAU * f64::from(turns) / segments).sin();
        let expected = segments * f64::from((1.0 + pull) * length / segments as f32).hypot(across)
            / f64::from(length)
            - 1.0;
        for self_contact in [SelfContact::On, SelfContact::Off] {
            law(
                &format!("strain of rims, {turns} turns, {self_contact:?}"),
                strain(turns, self_contact),
                expected,
                0.015,
            );
        }
    }
}

/// Two ropes that are twisted about each other and drawn taut are helices around a common axis, at half the distance that they keep:
/// on the height H, turned by an angle, each is `sqrt(H^2 + (angle radius)^2)` long, as in a cord that shortens when it is twisted.
/// Thickness holds under the tension that presses the ropes together.
#[test]
fn ropes_twisted_about_each_other_keep_their_thickness() {
    const COUNT: usize = 161;
    let (radius, length, angle) = (0.01_f32, 1.0_f32, 4.0 * TAU as f32);
    // Lines pull harder than contacts push, and would squeeze them: ropes with self-contact are swept all the same.
    let settings = BodySettings { structural: StructuralSolve::Lines, ..settings(radius, SelfContact::On) };
    let rope = |side: f32| {
        let at = Vec3::X * (side * radius);
        RopeBuilder::new(at, at + Vec3::Z * length, COUNT as u32)
            .damping(2.0)
            .pin_start()
            .pin_end()
            .build(settings)
            .expect("valid")
    };
    let bodies = vec![rope(1.0), rope(-1.0)];
    let starts = [0, 1].map(|k: usize| bodies[k].particles.positions().collect::<Vec<_>>());
    let mut island = Island { bodies, ..Island::default() };
    // As the ropes are wound, their far ends come nearer; at last ropes are stretched by a part in a thousand.
    let height = |angle: f32| (length * length - (angle * radius).powi(2)).sqrt();
    let steps = 240;
    for index in 1..=steps + 90 {
        let part = (index as f32 / steps as f32).min(1.0);
        let pull = 1.001 * height(part * angle) - length;
        for (body, start) in island.bodies.iter_mut().zip(&starts) {
            turn_end(body, start, length, part * angle, pull);
        }
        run(&mut island, &weightless(FRAME), FRAME);
    }
    for (k, body) in island.bodies.iter().enumerate() {
        let places: Vec<DVec3> = measure::positions(&body.particles).collect();
        let long: f64 = places.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let high = places[COUNT - 1].z - places[0].z;
        let helix = high.hypot(f64::from(angle * radius));
        law(&format!("length of twisted rope {k} in m"), long, helix, 4e-3);
        let radii: Vec<f64> = places.iter().map(|place| place.truncate().length()).collect();
        let mean = radii.iter().sum::<f64>() / COUNT as f64;
        law(&format!("distance of twisted rope {k} from the axis in m"), mean, radius.into(), 0.02);
        let least = radii.into_iter().fold(f64::INFINITY, f64::min);
        assert!(least > 0.98 * f64::from(radius), "rope {k} comes to {least} m from the axis");
    }
}
