//! Layers in free flight: they collide without bouncing, and nothing that they do to each other moves their centre of mass.

use drape_solver::glam::{DVec3, Quat, Vec3};
use drape_solver::state::measure;
use drape_solver::{
    Body, BodySettings, ClothBuilder, ClothMaterial, Environment, Island, Placement, SelfContact, Shape,
};

use crate::common::*;

/// Particles of a sheet.
const COUNT: usize = 169;

fn settings(friction: f32) -> BodySettings {
    BodySettings {
        thickness: 0.005,
        friction,
        static_friction: friction,
        drag: 0.0,
        self_contact: SelfContact::On,
        ..BodySettings::default()
    }
}

/// A sheet of 0.4 m around this place.
fn sheet(at: Vec3, turn: Quat, areal_density: f32, friction: f32) -> Body {
    let (right, down) = (turn * Vec3::X, turn * Vec3::Z);
    ClothBuilder::new(0.4, 0.4, 13, 13)
        .placed(at - 0.2 * (right + down), right, down)
        .material(ClothMaterial { areal_density, damping: 0.0, ..ClothMaterial::default() })
        .build(settings(friction))
        .expect("valid")
}

/// Two level sheets, the upper out of line by `aside`, that fly at each other with this velocity of the upper against the lower.
fn colliding(aside: f32, densities: [f32; 2], friction: f32, velocity: Vec3) -> Island {
    let places = [Vec3::ZERO, Vec3::new(aside, 0.06, 1.2 * aside)];
    let bodies = [0, 1].map(|k| {
        let mut body = sheet(places[k], Quat::IDENTITY, densities[k], friction);
        let own = velocity * [-0.5, 0.5][k];
        (0..COUNT).for_each(|i| body.particles.set_velocity(i, own));
        body
    });
    Island { bodies: bodies.into(), ..Island::default() }
}

/// Velocity of the second body against the first, of their centres of mass.
fn relative_velocity(island: &Island) -> DVec3 {
    let [a, b] = [0, 1].map(|k| &island.bodies[k].particles).map(|p| measure::momentum(p) / measure::mass(p));
    b - a
}

/// Kinetic energy in joules in the frame of the common centre of mass.
fn inner_energy(island: &Island) -> f64 {
    let mass: f64 = island.bodies.iter().map(|body| measure::mass(&body.particles)).sum();
    kinetic_energy(island) - momentum(island).length_squared() / (2.0 * mass)
}

/// Restitution is 0: sheets stop each other at once, whether particles meet particles or the insides of faces. There a third of the speed
/// came back: each push added to what others gave the same corners, and none gave it back. Momentum is kept, and energy never gained.
#[test]
fn two_sheets_that_collide_keep_momentum_and_do_not_bounce() {
    for (aside, most_restitution) in [(0.0, 0.01), (0.011, 0.03)] {
        for densities in [[0.2, 0.2], [0.1, 0.3], [0.3, 0.1]] {
            for speed in [1.0, 2.0, 5.0, 20.0] {
                let mut island = colliding(aside, densities, 0.0, Vec3::NEG_Y * speed);
                let (momentum_before, energy_before) = (momentum(&island), kinetic_energy(&island));
                let scale = f64::from(speed) * 0.16 * f64::from(densities[0] + densities[1]);
                run_with(&mut island, &weightless(FRAME), 0.15, |island, index| {
                    let lost = (momentum(island) - momentum_before).length() / scale;
                    assert!(lost < 1e-5, "{lost} of the momentum is lost in step {index}");
                    let energy = kinetic_energy(island);
                    assert!(
                        energy < 1.0001 * energy_before,
                        "{energy} J of {energy_before} J in step {index}"
                    );
                });
                let restitution = relative_velocity(&island).y / f64::from(speed);
                let case =
                    format!("restitution of sheets at {speed} m/s, {densities:?} kg/m^2, {aside} m aside");
                law_of_error(&case, restitution, most_restitution);
                assert_eq!(crossings(&island), 0);
            }
        }
    }
}

/// A hit is over in an instant, and friction takes from the speed aside what Coulomb lets it: the coefficient times the speed that the
/// hit took along the normal. Gravity plays no part.
#[test]
fn friction_takes_from_a_glancing_hit_its_part_of_the_normal_speed() {
    for friction in [0.0, 0.1, 0.3] {
        for densities in [[0.2, 0.2], [0.1, 0.3]] {
            let (aside, normal) = (3.0, 2.0);
            let mut island = colliding(0.0, densities, friction, Vec3::new(aside, -normal, 0.0));
            run(&mut island, &weightless(FRAME), 0.1);
            let after = relative_velocity(&island);
            let taken = f64::from(aside) - after.x;
            let expected = f64::from(friction) * (f64::from(normal) + after.y);
            let case = format!("speed that friction of {friction} takes, {densities:?} kg/m^2, off in m/s");
            law_of_error(&case, taken - expected, 0.03 * f64::from(aside));
        }
    }
}

/// Three sheets that shrink onto each other while they fly.
fn flying(velocity: Vec3, closing: f32) -> Island {
    let start = -0.25 * velocity;
    let bodies = (0..3).map(|k| {
        let turn = Quat::from_scaled_axis(Vec3::new(0.3, 0.5, -0.2) * k as f32);
        let mut body = sheet(start + Vec3::Y * 0.25 * (k as f32 - 1.0), turn, 0.25, 0.3);
        for i in 0..COUNT {
            let inwards = closing * (start - body.particles.position(i));
            body.particles.set_velocity(i, velocity + inwards);
        }
        body
    });
    Island { bodies: bodies.collect(), ..Island::default() }
}

fn common_centre(island: &Island) -> DVec3 {
    let parts = island.bodies.iter().map(|body| {
        let mass = measure::mass(&body.particles);
        (mass, centre_of_mass(&body.particles) * mass)
    });
    let (mass, moment) = parts.fold((0.0, DVec3::ZERO), |(m, s), (mass, moment)| (m + mass, s + moment));
    moment / mass
}

/// Pushes, friction and truncation act between layers, and so are no drag: at any speed their common centre of mass falls freely,
/// to 1e-5 of the way that it and its parts fly. Seen from there, energy is never gained.
#[test]
fn what_layers_do_to_each_other_is_no_drag_at_any_speed() {
    // What crashes into itself at 20 m/s is moved back hundreds of times, each of which rounds.
    let cases = [
        (0.0, 10.0, 1e-5),
        (30.0, 10.0, 1e-5),
        (300.0, 10.0, 1e-5),
        (0.0, 80.0, 2.5e-5),
        (30.0, 80.0, 1e-5),
        (300.0, 80.0, 1e-5),
    ];
    for (speed, closing, tolerance) in cases {
        let velocity = Vec3::new(0.6, 0.0, 0.8) * speed;
        let mut island = flying(velocity, closing);
        let mass: f64 = island.bodies.iter().map(|body| measure::mass(&body.particles)).sum();
        let (start, energy) = (common_centre(&island), inner_energy(&island));
        let own = momentum(&island) / mass;
        // Root mean square speed against the centre.
        let inner_speed = (2.0 * energy / mass).sqrt();
        let (mut off, mut most, mut truncated) = (0.0_f64, 0.0_f64, 0);
        run_with(&mut island, &gravity(FRAME), 0.5, |island, index| {
            let time = f64::from(FRAME) * (index + 1) as f64;
            // Under constant acceleration n substeps of h cover g h^2 n (n + 1) / 2.
            let fallen = 0.5 * f64::from(G) * time * (time + f64::from(FRAME) / f64::from(island.substeps()));
            let expected = start + own * time - DVec3::Y * fallen;
            off = off.max(common_centre(island).distance(expected) / ((own.length() + inner_speed) * 0.5));
            most = most.max(inner_energy(island) / energy);
            truncated += island.self_contact_counts().truncated;
        });
        let case = format!(
            "drift of layers at {speed} m/s that close by {closing}/s, {truncated} truncated, in ways"
        );
        law_of_error(&case, off, tolerance);
        assert!(most < 1.0001, "{most} of the energy");
        assert!(closing < 50.0 || truncated > 0, "something is to be moved back");
    }
}

/// Galilei 1632: layers that collide at 300 m/s take the shape of those that collide in place. Rounding is all that differs: at 30 m
/// from the origin, and with ways of 0.6 m in a substep.
#[test]
fn layers_collide_alike_at_rest_and_at_300_metres_a_second() {
    let after = |velocity: Vec3| {
        let mut island = colliding(0.011, [0.1, 0.3], 0.3, Vec3::new(0.5, -2.0, 0.0));
        for body in &mut island.bodies {
            body.particles.translate(-0.1 * velocity);
            for i in 0..COUNT {
                let own = body.particles.velocity(i);
                body.particles.set_velocity(i, own + velocity);
            }
        }
        run(&mut island, &weightless(FRAME), 0.1);
        assert!(island.self_contact_counts().pairs > 0, "they touch");
        let middle = common_centre(&island);
        let places = island.bodies.iter().flat_map(|body| measure::positions(&body.particles));
        places.map(|place| place - middle).collect::<Vec<_>>()
    };
    let home = after(Vec3::ZERO);
    for speed in [3.0, 30.0, 300.0] {
        let there = after(Vec3::new(0.6, 0.0, 0.8) * speed);
        let off = home.iter().zip(&there).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        law_of_error(&format!("colliding layers at {speed} m/s, off in m"), off, 1e-4);
    }
}

/// Layers that fall on the ground lie there alike, if all of it rides at 300 m/s.
#[test]
fn a_heap_lies_alike_at_rest_and_on_ground_that_moves_at_300_metres_a_second() {
    let after = |speed: f32| {
        let velocity = Vec3::X * speed;
        let start = -0.75 * velocity;
        let bodies = (0..3).map(|k| {
            let turn = Quat::from_rotation_y(0.4 * k as f32);
            let mut body = sheet(start + Vec3::Y * (0.02 + 0.02 * k as f32), turn, 0.25, 0.5);
            (0..COUNT).for_each(|i| body.particles.set_velocity(i, velocity));
            body
        });
        let mut island = Island { bodies: bodies.collect(), ..Island::default() };
        let ground = obstacle(Shape::HalfSpace { normal: Vec3::Y }, start, 0.5);
        let mut environment = Environment { obstacles: vec![ground].into(), ..gravity(FRAME) };
        for index in 1..=90 {
            let place = start + velocity * (index as f32 * FRAME);
            environment.obstacles[0].move_to(Placement::at(place), FRAME);
            run(&mut island, &environment, FRAME);
        }
        let end = (start + velocity * (90.0 * FRAME)).as_dvec3();
        [0, 1, 2].map(|k| centre_of_mass(&island.bodies[k].particles) - end)
    };
    let home = after(0.0);
    for speed in [30.0, 300.0] {
        for (k, (home, there)) in home.into_iter().zip(after(speed)).enumerate() {
            let case = format!("layer {k} at {speed} m/s, off in m");
            law_of_error(&format!("{case}, height"), there.y - home.y, 2e-4);
            law_of_error(&format!("{case}, aside"), (there - home).truncate().length(), 5e-3);
        }
    }
}
