//! Layers, sensors, and reports of contacts.

use drape_solver::glam::Vec3;
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::state::measure;
use drape_solver::{
    Ball, BallMaterial, Body, BodySettings, ClothBuilder, Contact, Edge, Environment, Feature, Island,
    Layers, Obstacle, Other, Party, Placement, RopeBuilder, SelfContact, Shape, StateHasher, step,
};

use crate::common::*;

const MINE: Layers = Layers::new(1, 1);
const THEIRS: Layers = Layers::new(2, 2);

/// A free, level cloth of one metre by one at this height.
fn sheet(height: f32) -> Body {
    let settings = BodySettings { drag: 1.0, ..BodySettings::default() };
    let at = Vec3::new(-0.5, height, 0.5);
    ClothBuilder::new(1.0, 1.0, 12, 12).placed(at, Vec3::X, Vec3::NEG_Z).build(settings).expect("valid")
}

fn ball(at: Vec3, velocity: Vec3) -> Ball {
    Ball::new(BallMaterial::default(), at, velocity).expect("valid")
}

fn ground() -> Environment {
    Environment { obstacles: [Obstacle::ground()].into(), ..gravity(FRAME) }
}

fn lowest(body: &Body) -> f32 {
    body.particles.bounds().0.y
}

/// All contacts of `steps` steps.
fn contacts(island: &mut Island, environment: &Environment, steps: usize) -> Vec<Contact> {
    let mut all = Vec::new();
    for _ in 0..steps {
        step(island, environment).expect("a good step");
        all.extend_from_slice(&island.contacts);
    }
    all
}

#[test]
fn a_resting_cloth_presses_with_its_weight() {
    for thickness in [0.01, 0.05] {
        let mut body = sheet(thickness + 0.001);
        body.settings.thickness = thickness;
        body.reports_contacts = true;
        let weight = measure::mass(&body.particles) as f32 * 9.81;
        let mut island = Island::of_body(body);
        run(&mut island, &ground(), 2.0);
        assert_eq!(island.contacts.len(), 1, "one contact for each two");
        let mut sum = 0.0;
        for contact in contacts(&mut island, &ground(), 30) {
            assert_eq!((contact.party, contact.other), (Party::Body(0), Other::Obstacle(0)));
            assert!((contact.normal - Vec3::Y).length() < 1e-5);
            assert!(contact.point.y.abs() < 2e-3, "on the ground: {}", contact.point);
            assert!(matches!(contact.feature, Some(Feature::Particle(index)) if index < 144));
            sum += contact.impulse;
        }
        let expected = weight * 30.0 * FRAME;
        assert!((sum / expected - 1.0).abs() < 0.03, "{sum} N s instead of {expected}");
    }
}

#[test]
fn who_asks_for_no_report_gets_none() {
    let mut island = Island::of_body(sheet(0.1));
    island.balls.push(ball(Vec3::Y, Vec3::ZERO));
    assert!(contacts(&mut island, &ground(), 60).is_empty());
    assert!(!island.touches.is_empty());
}

#[test]
fn reports_change_no_bits() {
    let of = |reports: bool| {
        let mut body = sheet(0.3);
        body.reports_contacts = reports;
        let mut island = Island::of_body(body);
        let mut large = ClothBuilder::new(2.0, 2.0, 72, 72)
            .placed(Vec3::new(-1.0, 0.1, 1.0), Vec3::X, Vec3::NEG_Z)
            .build(BodySettings::default())
            .expect("valid");
        large.reports_contacts = reports;
        island.bodies.push(large);
        let reported = contacts(&mut island, &ground(), 60).len();
        assert_eq!(reports, reported > 60);
        let mut hasher = StateHasher::new();
        for body in &island.bodies {
            hasher.particles(&body.particles);
        }
        hasher.finish()
    };
    assert_eq!(of(true), of(false));
}

#[test]
fn a_ball_tells_the_face_that_it_hits() {
    let mut curtain = ClothBuilder::new(1.0, 1.0, 11, 11)
        .placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y)
        .pin_edge(Edge::Top)
        .build(BodySettings::default())
        .expect("valid");
    curtain.reports_contacts = true;
    let mut island = Island::of_body(curtain);
    let at = Vec3::new(0.17, 0.03, 0.4);
    island.balls.push(ball(at, Vec3::NEG_Z * 4.0));
    let all = contacts(&mut island, &weightless(FRAME), 20);
    let first = all.first().expect("a contact");
    assert_eq!((first.party, first.other), (Party::Ball(0), Other::Body(0)));
    assert!((first.normal - Vec3::Z).length() < 0.2);
    let Some(Feature::Face(face)) = first.feature else { panic!("a face, not {:?}", first.feature) };
    // Rows and columns are a tenth of a metre apart.
    let corners = island.bodies[0].topology.faces()[face];
    for corner in corners {
        let (row, column) = (corner / 11, corner % 11);
        let place = Vec3::new(column as f32 * 0.1 - 0.5, 0.5 - row as f32 * 0.1, 0.0);
        assert!((place - at).truncate().length() < 0.15, "{place} is far from {at}");
    }
    let touches: f32 = all.iter().map(|contact| contact.impulse).sum();
    assert!(touches > 0.5, "{touches} N s");
}

#[test]
fn a_rope_tells_the_particle() {
    let rope = || {
        RopeBuilder::new(Vec3::new(-0.5, 0.01, 0.0), Vec3::new(0.5, 0.01, 0.0), 21)
            .build(BodySettings::default())
            .expect("valid")
    };
    let mut island = Island::of_body(Body { reports_contacts: true, ..rope() });
    let all = contacts(&mut island, &ground(), 60);
    assert!(all.iter().all(|contact| matches!(contact.feature, Some(Feature::Particle(0..21)))));
    assert!(all.len() > 30);
    // A ball falls on it, a sixth of the way along.
    island.balls.push(ball(Vec3::new(-0.33, 0.3, 0.0), Vec3::ZERO));
    let all = contacts(&mut island, &ground(), 30);
    let hit = all.iter().find(|contact| contact.other == Other::Body(0)).expect("a hit");
    assert!(matches!(hit.feature, Some(Feature::Particle(2..=4))), "{:?}", hit.feature);
}

#[test]
fn two_balls_have_one_contact() {
    let mut island = Island::of_ball(ball(Vec3::X * 0.41, Vec3::NEG_X));
    island.balls.push(ball(Vec3::NEG_X * 0.41, Vec3::X));
    island.balls[1].set_reports_contacts(true);
    let all = contacts(&mut island, &weightless(FRAME), 30);
    let is_theirs = |c: &Contact| (c.party, c.other) == (Party::Ball(0), Other::Ball(1));
    assert!(!all.is_empty() && all.iter().all(is_theirs), "{all:?}");
    // Each ball of 2 kg loses its 1 m/s.
    let impulse: f32 = all.iter().map(|contact| contact.impulse).sum();
    assert!((impulse - 2.0).abs() < 1e-3, "{impulse} N s");
    assert!((all[0].time - (0.26 % FRAME)).abs() < 1e-3, "it took 0.26 s to meet: {}", all[0].time);
}

#[test]
fn an_obstacle_may_ask() {
    let environment =
        Environment { obstacles: [Obstacle::ground().reporting_contacts()].into(), ..gravity(FRAME) };
    let mut island = Island::of_body(sheet(0.05));
    island.balls.push(ball(Vec3::new(3.0, 0.2, 0.0), Vec3::ZERO));
    let all = contacts(&mut island, &environment, 60);
    for party in [Party::Body(0), Party::Ball(0)] {
        assert!(all.iter().any(|contact| contact.party == party), "{party:?} lies on the ground");
    }
}

#[test]
fn a_sensor_moves_nothing_and_tells() {
    for shape in [
        Shape::Cuboid { half_extents: Vec3::new(2.0, 0.05, 2.0) },
        Shape::Sphere { radius: 0.1 },
        Shape::Capsule { half_length: 0.2, radius: 0.05 },
        Shape::TaperedCapsule { half_length: 0.2, bottom_radius: 0.1, top_radius: 0.05 },
        Shape::Parry(SharedShape::cylinder(0.1, 0.2)),
    ] {
        let mut end = Vec::new();
        for with_sensor in [true, false] {
            let sensor =
                Obstacle::new(shape.clone(), Placement::at(Vec3::Y), 0.5).expect("valid").as_sensor();
            let mut environment = ground();
            if with_sensor {
                environment.obstacles.push(sensor);
            }
            let mut island = Island::of_body(Body { reports_contacts: true, ..sheet(1.5) });
            // So fast that it crosses the sensor within a few substeps.
            island.balls.push(ball(Vec3::new(0.02, 21.0, 0.03), Vec3::NEG_Y * 60.0));
            island.balls[0].set_reports_contacts(true);
            let all = contacts(&mut island, &environment, 60);
            for party in [Party::Body(0), Party::Ball(0)] {
                let told = all.iter().filter(|c| (c.party, c.other) == (party, Other::Obstacle(1))).count();
                assert_eq!(told > 0, with_sensor, "{party:?} in {shape:?}");
                assert!(told < 30, "it has left: {told}");
            }
            assert!(all.iter().filter(|c| c.other == Other::Obstacle(1)).all(|c| c.impulse == 0.0));
            let mut hasher = StateHasher::new();
            hasher.particles(&island.bodies[0].particles);
            hasher.ball(&island.balls[0]);
            end.push(hasher.finish());
        }
        assert_eq!(end[0], end[1], "{shape:?} moved something");
    }
}

#[test]
fn layers_keep_apart_who_shall_not_touch() {
    for (one, other, is_stopped) in [(MINE, THEIRS, false), (MINE, MINE, true), (Layers::ALL, THEIRS, true)] {
        // Cloth and ball on the ground.
        let ground = Obstacle::ground().with_layers(other);
        let environment = Environment { obstacles: [ground].into(), ..gravity(FRAME) };
        let mut island = Island::of_body(Body { layers: one, ..sheet(0.5) });
        island.balls.push(ball(Vec3::new(5.0, 0.5, 0.0), Vec3::ZERO));
        island.balls[0].set_layers(one);
        run(&mut island, &environment, 1.0);
        assert_eq!(lowest(&island.bodies[0]) > -0.1, is_stopped, "cloth and obstacle");
        assert_eq!(island.balls[0].position().y > 0.0, is_stopped, "ball and obstacle");
        // Ball and ball.
        let mut island = Island::of_ball(ball(Vec3::X * 0.4, Vec3::NEG_X));
        island.balls.push(ball(Vec3::NEG_X * 0.4, Vec3::X));
        island.balls[0].set_layers(one);
        island.balls[1].set_layers(other);
        run(&mut island, &weightless(FRAME), 1.0);
        assert_eq!(island.balls[0].position().x > 0.0, is_stopped, "ball and ball");
        // Ball and cloth.
        let mut island = Island::of_body(Body { layers: one, ..sheet(0.0) });
        island.balls.push(ball(Vec3::Y, Vec3::NEG_Y * 4.0));
        island.balls[0].set_layers(other);
        run(&mut island, &weightless(FRAME), 0.5);
        let is_moved = measure::mean_square_speed(&island.bodies[0].particles) > 1e-4;
        assert_eq!(is_moved, is_stopped, "ball and cloth");
    }
}

#[test]
fn what_is_taken_out_of_the_island_is_in_no_contact() {
    let mut island = Island::of_body(Body { reports_contacts: true, ..sheet(0.01) });
    island.bodies.push(Body { reports_contacts: true, ..sheet(0.01) });
    let environment = ground();
    run(&mut island, &environment, 0.5);
    step::begin(&mut island, &environment).expect("good");
    step::detect_collisions(&mut island, &environment);
    step::substep(&mut island, &environment);
    island.bodies.remove(0);
    island.forget(Other::Body(0));
    step::finish(&mut island).expect("good");
    let parties: Vec<Party> = island.contacts.iter().map(|contact| contact.party).collect();
    assert_eq!(parties, [Party::Body(0)]);
}

#[test]
fn two_cloths_have_one_contact_unless_layers_part_them() {
    for (other, is_stopped) in [(Layers::ALL, true), (THEIRS, false)] {
        let settings =
            BodySettings { thickness: 0.03, self_contact: SelfContact::On, ..BodySettings::default() };
        let with = |height: f32, layers: Layers| Body { settings, layers, ..sheet(height) };
        let upper = Body { reports_contacts: true, ..with(0.3, MINE) };
        let weight = measure::mass(&upper.particles) as f32 * 9.81;
        let mut island = Island::of_body(upper);
        island.bodies.push(with(0.05, other));
        run(&mut island, &ground(), 2.0);
        let all = contacts(&mut island, &ground(), 30);
        let of_both: Vec<&Contact> = all.iter().filter(|contact| contact.other == Other::Body(1)).collect();
        assert_eq!(!of_both.is_empty(), is_stopped);
        assert!(of_both.iter().all(|contact| contact.party == Party::Body(0) && contact.normal.y > 0.2));
        // The rest of the weight is on the ground.
        let impulse: f32 = all.iter().map(|contact| contact.impulse * contact.normal.y).sum();
        let expected = weight * 30.0 * FRAME;
        assert!((impulse / expected - 1.0).abs() < 0.15, "{impulse} N s instead of {expected}");
    }
}

#[test]
fn a_pole_between_particles_tells_the_face() {
    // Rows are 0.25 m apart, the pole is half as thick and between them.
    let settings = BodySettings { thickness: 0.01, ..BodySettings::default() };
    let cloth = ClothBuilder::new(1.0, 1.0, 5, 5)
        .placed(Vec3::new(-0.5, 0.1, 0.5), Vec3::X, Vec3::NEG_Z)
        .build(settings)
        .expect("valid");
    let mut island = Island::of_body(Body { reports_contacts: true, ..cloth });
    let pole = Shape::Cuboid { half_extents: Vec3::new(0.03, 0.05, 3.0) };
    let place = |x: f32| Obstacle::new(pole.clone(), Placement::at(Vec3::X * x), 1.0).expect("valid");
    let environment = Environment { obstacles: [place(-0.37), place(0.37)].into(), ..gravity(FRAME) };
    let all = contacts(&mut island, &environment, 30);
    for pole in [0, 1] {
        let mut told = all.iter().filter(|contact| contact.other == Other::Obstacle(pole));
        let is_face = |contact: &Contact| matches!(contact.feature, Some(Feature::Face(0..32)));
        assert!(told.any(|contact| is_face(contact) && contact.impulse > 0.0 && contact.normal.y > 0.5));
    }
}
