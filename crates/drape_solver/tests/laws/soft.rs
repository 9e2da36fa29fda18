//! Soft balls, soft solids and balloons (S26; pressure) keep their volume, and return to their shape.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use drape_solver::glam::{Affine3A, Mat3, Vec3};
use drape_solver::state::measure;
use drape_solver::volume;
use drape_solver::{
    Body, BodySettings, Embedding, Environment, Island, Obstacle, SoftBallBuilder, SoftBodyBuilder,
    StickKind, StickMaterial, TopologyBuilder,
};

use crate::common::*;

/// A balloon of 0.3 m in radius: a skin of 0.2 kg/m^2 with some air in it.
fn balloon(height: f32, pressure: f32) -> Body {
    let (places, faces) = sphere(Vec3::Y * height, 0.3, 20, 12);
    let mass = 0.2 * 4.0 * PI * 0.09 / places.len() as f32;
    let settings = BodySettings { drag: 0.2, ..BodySettings::default() };
    let mut body = joined(&places, &vec![1.0 / mass; places.len()], &[], settings);
    let mut builder = TopologyBuilder::new(&places);
    let material =
        StickMaterial { stiffness: 0.8, damping: 2.0, ..StickMaterial::rigid(StickKind::Structural) };
    builder.family(material, edges(&faces)).expect("valid").faces(faces).expect("valid");
    body.topology = Arc::new(builder.build().expect("valid"));
    body.pressure = pressure;
    body
}

/// A solid ball of 0.3 m in radius.
fn solid(height: f32) -> Body {
    let (places, faces) = sphere(Vec3::Y * height, 0.3, 24, 16);
    let builder = SoftBodyBuilder::new(&places, &faces, 0.1).stiffness(0.95).damping(3.0);
    builder.build(BodySettings { drag: 0.2, substeps: 16, ..BodySettings::default() }).expect("valid").0
}

fn ground() -> Environment {
    Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) }
}

fn own_volume(body: &Body) -> f64 {
    volume(&body.particles, &body.topology)
}

/// Deformation from the rest shape, apart from motion as a whole: root mean square of the differences of all distances
/// between particles, as a part of the size.
fn deformation(body: &Body, size: f32) -> f32 {
    let at_rest = SolidRest::of(body);
    let particles = &body.particles;
    let (mut sum, mut count) = (0.0_f64, 0.0_f64);
    for i in 0..particles.len() {
        for j in 0..i {
            let now = particles.local_position(i).distance(particles.local_position(j));
            let off = f64::from(now - at_rest.0[i].distance(at_rest.0[j]));
            sum += off * off;
            count += 1.0;
        }
    }
    (sum / count).sqrt() as f32 / size
}

/// Rest positions of the built body in metres.
struct SolidRest(Vec<Vec3>);

impl SolidRest {
    fn of(body: &Body) -> Self {
        Self((0..body.particles.len()).map(|i| body.topology.rest_position(i)).collect())
    }
}

/// The volume of a mesh of a sphere, and of an open mesh.
#[test]
fn the_volume_of_a_closed_mesh_is_that_inside() {
    let body = balloon(1.0, 0.0);
    let exact = 4.0 / 3.0 * std::f64::consts::PI * 0.027;
    let found = own_volume(&body);
    println!("law: volume of a sphere's mesh {found} m^3, of the sphere {exact} m^3");
    assert!(found < exact && found > 0.9 * exact);
    assert!((body.topology.rest_volume().expect("closed") - found).abs() < 1e-6);
    let sheet = drape_solver::ClothBuilder::new(1.0, 1.0, 9, 9).build(bare()).expect("valid");
    assert_eq!(sheet.topology.rest_volume(), None);
}

/// Balloon and solid keep their volume within 5 % in a drop from 2 m.
#[test]
fn what_is_dropped_keeps_its_volume_and_comes_back_to_its_shape() {
    for (name, body) in [("balloon", balloon(2.3, 1.0)), ("solid", solid(2.3))] {
        let rest = body.topology.rest_volume().expect("closed");
        let mut island = Island::of_body(body);
        let (mut least, mut most, mut squeezed) = (f64::INFINITY, 0.0_f64, 0.0_f32);
        run_with(&mut island, &ground(), 6.0, |island, _| {
            let part = own_volume(&island.bodies[0]) / rest;
            (least, most) = (least.min(part), most.max(part));
            squeezed = squeezed.max(deformation(&island.bodies[0], 0.6));
        });
        // A balloon on the ground is flat below; when released it is a ball again.
        run(&mut island, &weightless(FRAME), 3.0);
        let left = deformation(&island.bodies[0], 0.6);
        println!(
            "law: {name}: volume from {least:.4} to {most:.4}, deformed by {squeezed} at most and {left} in the end"
        );
        assert!(least > 0.95 && most < 1.05, "{name}: {least} to {most}");
        assert!(left < 0.01, "{name}: {left}");
        assert!(squeezed > 2.0 * left, "it was squeezed");
    }
}

/// A dropped balloon without air does not keep its volume.
#[test]
fn a_balloon_without_air_collapses() {
    let mut island = Island::of_body(balloon(0.35, 0.0));
    run(&mut island, &ground(), 3.0);
    let part = own_volume(&island.bodies[0]) / island.bodies[0].topology.rest_volume().expect("closed");
    assert!(part < 0.8, "{part} of the volume");
}

/// Pressure keeps momentum and angular momentum while the volume grows by half. (Spin always fades with the substep:
/// `tetrahedron_spin.rs`.)
#[test]
fn pressure_keeps_momentum() {
    let mut body = balloon(0.0, 1.0);
    body.settings = BodySettings { substeps: 32, ..bare() };
    for i in 0..body.particles.len() {
        let place = body.particles.position(i);
        body.particles.set_velocity(i, Vec3::X * 2.0 + Vec3::new(0.0, 3.0, 1.0).cross(place));
    }
    let mut island = Island::of_body(body);
    let before = (momentum(&island), angular_momentum(&island));
    for step in 1..=60 {
        island.bodies[0].pressure = 1.0 + step as f32 / 120.0;
        run(&mut island, &weightless(FRAME), FRAME);
    }
    let after = (momentum(&island), angular_momentum(&island));
    let grown = own_volume(&island.bodies[0]) / island.bodies[0].topology.rest_volume().expect("closed");
    println!("law: blown up to {grown} of its volume, momentum {} and was {}", after.0, before.0);
    assert!(grown > 1.1, "{grown}");
    assert!((after.0 - before.0).length() < 1e-5 * before.0.length());
    assert!((after.1 - before.1).length() < 3e-2 * before.1.length(), "{} and was {}", after.1, before.1);
}

/// S26: ring k of n has radius R (k + 1) / n and 10 (k + 1) particles; triangles cover the area exactly once.
#[test]
fn a_soft_ball_has_its_rings_and_its_area() {
    for rings in [1, 2, 5] {
        let body = SoftBallBuilder::new(Vec3::ZERO, 0.5, rings).build(bare()).expect("valid");
        assert_eq!(body.particles.len() as u32, 5 * rings * (rings + 1));
        let mut next = 0;
        for ring in 0..rings {
            let radius = 0.5 * (ring + 1) as f32 / rings as f32;
            for _ in 0..10 * (ring + 1) {
                assert!((body.particles.position(next).length() - radius).abs() < 1e-6);
                next += 1;
            }
        }
        let corners = 10.0 * rings as f32;
        let polygon = 0.5 * corners * 0.25 * (TAU / corners).sin();
        assert!((area(&body) - polygon).abs() < 1e-5, "{}, expected {polygon}", area(&body));
        let mass = measure::mass(&body.particles);
        assert!((mass - 10.0 * 0.25 * std::f64::consts::PI).abs() < 1e-4, "{mass} kg");
        let pinned = SoftBallBuilder::new(Vec3::ZERO, 0.5, rings).pin_rim().build(bare()).expect("valid");
        let pins = (0..pinned.particles.len()).filter(|&i| pinned.particles.is_pinned(i)).count();
        assert_eq!(pins as u32, 10 * rings);
    }
}

/// Sum of the faces' signed areas in the XY plane in m^2.
fn area(body: &Body) -> f32 {
    let of_face = |face: &[u32; 3]| {
        let [p, q, r] = face.map(|corner| body.particles.local_position(corner as usize));
        0.5 * (q - p).cross(r - p).z
    };
    body.topology.faces().iter().map(of_face).sum()
}

/// A soft ball dropped from 2 m keeps its area within 5 %, and is round again at rest.
#[test]
fn a_soft_ball_that_is_dropped_is_round_again() {
    let builder = SoftBallBuilder::new(Vec3::Y * 2.3, 0.3, 4).stiffness(0.9999).damping(3.0);
    let settings = BodySettings { substeps: 16, drag: 0.2, ..BodySettings::default() };
    let mut island = Island::of_body(builder.build(settings).expect("valid"));
    let rest = area(&island.bodies[0]);
    let (mut least, mut most) = (f32::INFINITY, 0.0_f32);
    run_with(&mut island, &ground(), 6.0, |island, _| {
        let part = area(&island.bodies[0]) / rest;
        (least, most) = (least.min(part), most.max(part));
    });
    let left = deformation(&island.bodies[0], 0.6);
    println!("law: soft ball: area from {least} to {most}, deformed by {left} in the end");
    assert!(particles(&island).positions().all(|place| place.z.abs() < 1e-4), "it stays in its plane");
    assert!(least > 0.95 && most < 1.05, "{least} to {most}");
    assert!(left < 0.01, "{left}");
}

/// The mesh that a solid carries starts at its own place, and follows the motion and rotation of the solid.
#[test]
fn the_mesh_of_a_solid_follows_it() {
    let (places, faces) = sphere(Vec3::new(5.0, 1.0, -2.0), 0.3, 24, 16);
    let (mut body, embedding) =
        SoftBodyBuilder::new(&places, &faces, 0.1).build(BodySettings::default()).expect("valid");
    let shown =
        |body: &Body| -> Vec<Vec3> { embedding.places(|i| body.particles.position(i), &[]).collect() };
    for (place, expected) in shown(&body).into_iter().zip(&places) {
        assert!(place.distance(*expected) < 1e-5, "{place}, expected {expected}");
    }
    let turn = |place: Vec3| Vec3::new(-place.y, place.x, place.z) * 1.1 + Vec3::ONE;
    for i in 0..body.particles.len() {
        let place = body.particles.position(i);
        body.particles.set_position(i, turn(place));
    }
    for (place, before) in shown(&body).into_iter().zip(&places) {
        assert!(place.distance(turn(*before)) < 1e-4);
    }
    let mass = measure::mass(&body.particles);
    let ball = 4.0 / 3.0 * std::f64::consts::PI * 0.027 * 100.0;
    assert!(mass < ball && mass > 0.95 * ball, "{mass} kg of a mesh inside a ball of {ball} kg");
}

/// The lattice of a rotated, mirrored or scaled mesh lies along the mesh's own axes, fits its box, and has the right mass.
#[test]
fn a_solid_is_built_along_the_axes_of_its_mesh() {
    let corners = (0..8_u8).map(|i| Vec3::new(f32::from(i & 1), f32::from(i >> 1 & 1), f32::from(i >> 2)));
    let places: Vec<Vec3> = corners.map(|corner| corner - 0.5).collect();
    let square = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces: Vec<[u32; 3]> = squares.into_iter().flat_map(square).collect();
    let turned = Mat3::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 0.7);
    for size in [Vec3::ONE, Vec3::new(-0.6, 0.3, 0.45)] {
        let to_world =
            Affine3A::from_mat3_translation(turned * Mat3::from_diagonal(size), Vec3::new(3.0, 2.0, 1.0));
        let solid =
            SoftBodyBuilder::new(&places, &faces, 0.15).transform(to_world).build_parts().expect("valid");
        let counts = (size.abs() / 0.15 - 0.01).ceil();
        assert_eq!(
            solid.particles.len(),
            (counts + 1.0).element_product() as usize,
            "cells of 0.15 m at most"
        );
        let volume = f64::from(size.abs().element_product());
        assert!((measure::mass(&solid.particles) - 100.0 * volume).abs() < 1e-4);
        assert!(
            (solid.topology.rest_volume().expect("closed") - volume).abs() < 1e-5,
            "its faces look outwards"
        );
        for (place, corner) in solid.embedding.places(|i| solid.particles.position(i), &[]).zip(&places) {
            assert!(place.distance(to_world.transform_point3(*corner)) < 1e-6);
        }
        for i in 0..solid.particles.len() {
            let local = to_world.inverse().transform_point3(solid.particles.position(i));
            assert!(local.abs().max_element() < 0.5 + 1e-5, "{local} is outside of the cube");
        }
        // A point of another mesh follows the same cells.
        let middle = solid.lattice.embed(&[Vec3::new(0.1, 0.2, -0.3)]).expect("a place");
        let middle = middle.places(|i| solid.particles.position(i), &[]).next().expect("one");
        assert!(middle.distance(to_world.transform_point3(Vec3::new(0.1, 0.2, -0.3))) < 1e-6);
    }
}

/// Points follow the nearest triangle, and keep their distance to it as it moves and rotates.
#[test]
fn points_hang_on_the_nearest_triangle() {
    let mut body = drape_solver::ClothBuilder::new(1.0, 1.0, 5, 5).build(bare()).expect("valid");
    let points: Vec<Vec3> = (0..40)
        .map(|i| i as f32)
        .map(|i| {
            body.particles.position(12) + Vec3::new(0.03 * i - 0.6, 0.02 * i - 0.4, 0.05 * (i * 0.7).sin())
        })
        .collect();
    let embedding = Embedding::on_faces(&points, &body.topology).expect("bound");
    let motion = |place: Vec3| {
        Mat3::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 2.0) * place + Vec3::new(0.3, -4.0, 2.0)
    };
    let shown = |body: &Body| -> Vec<Vec3> {
        let mut normals = Vec::new();
        embedding.write_normals(&body.topology, |i| body.particles.position(i), &mut normals);
        embedding.places(|i| body.particles.position(i), &normals).collect()
    };
    for (place, point) in shown(&body).into_iter().zip(&points) {
        assert!(place.distance(*point) < 1e-6);
    }
    for i in 0..body.particles.len() {
        let place = body.particles.position(i);
        body.particles.set_position(i, motion(place));
    }
    for (place, point) in shown(&body).into_iter().zip(&points) {
        assert!(place.distance(motion(*point)) < 1e-5, "{place}, expected {}", motion(*point));
    }
    // The cloth is bent to a quarter of a pipe: its points are nearer to the pipe than the edges of its triangles are.
    let radius = 2.0 / PI;
    for i in 0..body.particles.len() {
        let rest = body.topology.rest_position(i);
        let (sine, cosine) = (rest.x / radius).sin_cos();
        body.particles.set_position(i, Vec3::new(radius * sine, rest.y, radius * cosine));
    }
    let corner = body.topology.rest_position(0);
    let fine: Vec<Vec3> =
        (0..=64_u8).map(|i| Vec3::new(corner.x + f32::from(i) / 64.0, corner.y - 0.3, 0.0)).collect();
    let on_it = Embedding::on_faces(&fine, &body.topology).expect("bound");
    let mut normals = Vec::new();
    on_it.write_normals(&body.topology, |i| body.particles.position(i), &mut normals);
    let off = on_it
        .places(|i| body.particles.position(i), &normals)
        .map(|place| (Vec3::new(place.x, 0.0, place.z).length() - radius).abs());
    let (off, sagitta) = (off.fold(0.0, f32::max), radius * (1.0 - (0.125 / radius).cos()));
    println!("law: a line on a cloth bent round a pipe is up to {off} m off the pipe, triangles {sagitta} m");
    assert!(off < 0.6 * sagitta, "{off} m off, and the triangles {sagitta} m");
    let nowhere = Embedding::on_faces(&[Vec3::ZERO, Vec3::NAN], &body.topology);
    assert!(nowhere.expect_err("nowhere").to_string().contains("vertex 1"));
    let rope = drape_solver::RopeBuilder::new(Vec3::ZERO, Vec3::X, 5).build_parts().expect("valid").1;
    assert!(Embedding::on_faces(&points, &rope).is_err(), "a rope has no triangles");
}

/// A ring of 1 m; the middle of its box is in the hole.
fn torus() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (around, across) = (16_u32, 8_u32);
    let place = |i: u32, j: u32| {
        let [a, b] = [TAU * i as f32 / around as f32, TAU * j as f32 / across as f32];
        let radius = 0.4 + 0.1 * b.cos();
        Vec3::new(radius * a.cos(), 0.1 * b.sin(), radius * a.sin())
    };
    let places = (0..around).flat_map(|i| (0..across).map(move |j| place(i, j))).collect();
    let number = |i: u32, j: u32| i % around * across + j % across;
    let squares = (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    let triangles = squares.flat_map(|(i, j)| {
        let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    (places, triangles.collect())
}

/// A mesh that cannot become a solid is rejected with the reason.
#[test]
fn a_solid_that_cannot_be_is_refused() {
    let (places, faces) = sphere(Vec3::ZERO, 0.3, 24, 16);
    let build = |places: &[Vec3], faces: &[[u32; 3]], spacing| {
        let outcome = SoftBodyBuilder::new(places, faces, spacing).build(BodySettings::default());
        outcome.map(|_| ()).map_err(|error| error.to_string())
    };
    let half: Vec<[u32; 3]> = faces[..faces.len() / 2].to_vec();
    let mut far = places.clone();
    far[3] = Vec3::NAN;
    let torus = torus();
    for (outcome, needle) in [
        (build(&places, &faces, 0.0), "spacing"),
        (build(&places, &faces, f32::NAN), "spacing"),
        (build(&places, &faces, 1e-4), "too small"),
        (build(&places, &half, 0.1), "not closed"),
        (build(&places, &[], 0.1), "no triangles"),
        (build(&torus.0, &torus.1, 1.0), "smaller spacing"),
        (build(&places, &[[0, 1, 9999]; 4], 0.1), "9999"),
        (build(&far, &faces, 0.1), "vertex"),
    ] {
        let message = outcome.expect_err(needle);
        assert!(message.contains(needle), "{message}, not {needle}");
    }
}

/// A balloon with more air than its rigid skin can hold does not spin by itself. The alternating pulls of skin and air once
/// spun it up to 6 m/s and drove it over the ground.
#[test]
fn a_balloon_that_is_blown_up_too_far_does_not_spin() {
    let mut body = balloon(1.0, 1.5);
    let faces = body.topology.faces().to_vec();
    let places: Vec<Vec3> = (0..body.particles.len()).map(|i| body.particles.position(i)).collect();
    let mut builder = TopologyBuilder::new(&places);
    let rigid = StickMaterial::rigid(StickKind::Structural);
    builder.family(rigid, edges(&faces)).expect("valid").faces(faces).expect("valid");
    body.topology = Arc::new(builder.build().expect("valid"));
    let mut island = Island::of_body(body);
    run(&mut island, &weightless(FRAME), 2.0);
    let body = &island.bodies[0];
    let (mut spin, mut inertia) = (Vec3::ZERO, 0.0);
    for i in 0..body.particles.len() {
        let mass = 1.0 / body.particles.inverse_mass(i);
        let arm = body.particles.position(i) - Vec3::Y;
        spin += arm.cross(body.particles.velocity(i)) * mass;
        inertia += mass * arm.length_squared() * (2.0 / 3.0);
    }
    let rate = spin.length() / inertia;
    println!("law: a balloon blown up to 1.5 of its volume turns at {rate} rad/s after 2 s, expected 0");
    assert!(rate < 0.01, "it turns at {rate} rad/s");
}
