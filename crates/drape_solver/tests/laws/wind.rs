//! Air: drag, lift, gusts, zones and lee.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::motion::force::wind_force;
use drape_solver::state::measure;
use drape_solver::{
    Body, BodySettings, ClothBuilder, Edge, Environment, Island, Placement, Shape, StructuralSolve,
    Turbulence, Wind, WindFlow, WindRegion, WindZone,
};

use crate::common::*;

/// A plate of 1 m x 1 m around the origin, normal to Z, pinned at every particle.
fn plate() -> Body {
    let cloth = ClothBuilder::new(1.0, 1.0, 11, 11).placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y);
    cloth.pin_where(|_, _, _| true).build(bare()).expect("valid")
}

fn air(wind: Wind) -> Environment {
    Environment { wind, ..weightless(FRAME) }
}

/// F = 1/2 rho c A u^2 (Newton's law of resistance) on a plate normal to the wind, for any lift coefficient.
#[test]
fn the_drag_of_a_plate_grows_with_the_square_of_the_speed() {
    for (speed, lift_coefficient) in [(1.0, 0.0), (5.0, 0.0), (20.0, 0.0), (5.0, 1.5)] {
        let wind = Wind { drag_coefficient: 1.1, lift_coefficient, ..Wind::new(Vec3::Z * speed) };
        let force = wind_force(&plate(), &air(wind));
        let expected = 0.5 * 1.2 * 1.1 * speed * speed;
        println!("law: drag at {speed} m/s {} N, expected {expected} N", force.z);
        assert!((force - Vec3::Z * expected).length() < 1e-4 * expected, "{force}");
    }
}

/// Lift is at right angles to the wind, F = 1/2 rho c A u^2 sin(a) cos(a), and points to the side to which the plate leans.
#[test]
fn lift_is_at_right_angles_to_the_wind() {
    for degrees in [0.0_f32, 5.0, 20.0, 45.0, 70.0, 90.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let wind = Vec3::new(0.0, cos, sin) * 10.0;
        let force = |lift_coefficient| {
            wind_force(&plate(), &air(Wind { drag_coefficient: 0.0, lift_coefficient, ..Wind::new(wind) }))
        };
        assert_eq!(force(0.0), Vec3::ZERO);
        let lift = force(0.9);
        let expected = 0.5 * 1.2 * 0.9 * 100.0 * sin * cos;
        println!("law: lift at {degrees} degrees {} N, expected {expected} N", lift.length());
        assert!((lift.length() - expected).abs() < 1e-3 * 54.0, "{lift} at {degrees} degrees");
        assert!(lift.dot(wind).abs() < 1e-3 * 540.0);
        assert!(lift.z >= 0.0 && lift.y <= 1e-3, "it lifts the plate: {lift}");
    }
}

/// A flag at its pole, 1.5 m x 1 m.
fn flag(structural: StructuralSolve) -> Body {
    let cloth = ClothBuilder::new(1.5, 1.0, 31, 21).placed(Vec3::new(0.0, 0.5, 0.0), Vec3::X, Vec3::NEG_Y);
    let settings = BodySettings { structural, drag: 0.0, ..BodySettings::default() };
    cloth.pin_edge(Edge::Left).build(settings).expect("valid")
}

/// Root mean square speed of the free particles in m/s.
fn speed(island: &Island) -> f32 {
    measure::mean_square_speed(particles(island)).sqrt()
}

/// A flag flutters in a steady wind as long as it blows, and comes to rest in still air.
#[test]
fn a_flag_flutters_in_the_wind_and_not_without() {
    for lift_coefficient in [0.0, 1.0] {
        let mut island = Island::of_body(flag(StructuralSolve::default()));
        let windy = Environment {
            wind: Wind { lift_coefficient, ..Wind::new(Vec3::new(12.0, 0.0, 1.0)) },
            ..gravity(FRAME)
        };
        run(&mut island, &windy, 8.0);
        let mut flutter = 0.0;
        run_with(&mut island, &windy, 2.0, |island, _| flutter += speed(island) / 120.0);
        assert!(flutter > 0.3, "{flutter} m/s with lift {lift_coefficient}");
    }
}

/// Energy in joules stored in soft sticks. A stiffness `s` is a spring of `s / (1 - s)`, divided by the sum of the ends'
/// inverse masses and by the square of 1/60 s. Rigid sticks store nothing.
fn elastic_energy(island: &Island) -> f64 {
    let (particles, topology) = (particles(island), &island.bodies[0].topology);
    let mut energy = 0.0;
    for batch in topology.batches() {
        let stiffness = f64::from(batch.material.stiffness);
        if stiffness == 1.0 {
            continue;
        }
        for i in batch.range() {
            let [a, b] = topology.stick(i).map(|end| end as usize);
            let inverse_mass = f64::from(particles.inverse_mass(a) + particles.inverse_mass(b));
            if inverse_mass > 0.0 {
                let way =
                    particles.local_position(a).as_dvec3().distance(particles.local_position(b).as_dvec3());
                let spring = stiffness / (1.0 - stiffness) * 3600.0 / inverse_mass;
                energy += 0.5 * spring * (way - f64::from(topology.rest_length(i))).powi(2);
            }
        }
    }
    energy
}

/// In still air a flag gains no energy: released level, its energy with that of its soft sticks only falls. The tolerance is
/// for rigid sticks that a sweep leaves stretched, or that lines pull straight at once.
#[test]
fn the_energy_of_a_flag_in_still_air_only_falls() {
    for (structural, most) in [(StructuralSolve::Sweeps, 0.016), (StructuralSolve::Lines, 0.03)] {
        let mut island = Island::of_body(flag(structural));
        let still = gravity(FRAME);
        let energy = |island: &Island| {
            let particles = particles(island);
            let moving =
                measure::kinetic_energy(particles) + measure::potential_energy(particles, still.gravity);
            moving + elastic_energy(island)
        };
        let start = energy(&island);
        let (mut least, mut rise, mut highest) = (start, 0.0_f64, [f64::NEG_INFINITY; 2]);
        run_with(&mut island, &still, 10.0, |island, index| {
            let now = energy(island);
            highest[index / 300] = highest[index / 300].max(now);
            rise = rise.max(now - least);
            least = least.min(now);
        });
        println!(
            "law: {structural:?}: in still air a flag's energy falls by {} J, and rises by {rise} J at most",
            start - least
        );
        assert!(rise < most * (start - least), "{rise} J of {} J", start - least);
        assert!(highest[0] <= start && highest[1] < 0.5 * (highest[0] + least), "{highest:?}");
    }
}

/// The drag of a flag that flies in the wind, and of the same cloth spread out normal to it: the flag has far less. Prints
/// the curve.
#[test]
fn the_drag_of_a_flag_by_the_speed_of_the_wind() {
    let mut parts = Vec::new();
    for speed in [3.0, 6.0, 12.0, 24.0_f32] {
        let mut island = Island::of_body(flag(StructuralSolve::default()));
        // At a small angle, as wind exactly along the flag would leave it flat.
        let windy = Environment { wind: Wind::new(Vec3::new(1.0, 0.0, 0.08) * speed), ..gravity(FRAME) };
        run(&mut island, &windy, 4.0);
        let mut force = Vec3::ZERO;
        run_with(&mut island, &windy, 2.0, |island, _| {
            force += wind_force(&island.bodies[0], &windy) / 120.0;
        });
        let of_plate = 0.5 * windy.wind.air_density * windy.wind.drag_coefficient * 1.5 * speed * speed;
        println!(
            "law: drag of a flag at {speed} m/s: {:.3} N, {:.4} of a plate's",
            force.x,
            force.x / of_plate
        );
        parts.push(force.x / of_plate);
    }
    assert!(parts.iter().all(|&part| part > 0.0 && part < 0.5), "{parts:?}");
}

/// The gusts have the given root mean square, and the wind as their mean. A seed repeats them.
#[test]
fn gusts_are_as_strong_as_asked_for_and_the_same_in_every_run() {
    let wind = |seed| Wind {
        turbulence: Turbulence { speed: 2.0, length: 3.0, seed },
        drag_coefficient: 1.0,
        air_density: 2.0,
        ..Wind::new(Vec3::Z * 20.0)
    };
    // The force on a plate goes with (20 + w)^2, about 400 + 40 w for gusts w that are weak against the wind.
    let small = || {
        let cloth = ClothBuilder::new(0.1, 0.1, 2, 2).placed(Vec3::ZERO, Vec3::X, Vec3::NEG_Y);
        cloth.pin_where(|_, _, _| true).build(bare()).expect("valid")
    };
    let gust = |seed, time| wind_force(&small(), &Environment { time, ..air(wind(seed)) }).z / 0.01;
    let (mut sum, mut squares, mut count) = (0.0_f64, 0.0_f64, 0.0_f64);
    for seed in 0..40 {
        for time in 0..50 {
            let along = f64::from(gust(seed, f64::from(time) * 0.37)).sqrt() - 20.0;
            sum += along;
            squares += along * along;
            count += 1.0;
        }
    }
    // One of three axes of the gusts.
    let (mean, strength) = (sum / count, (3.0 * squares / count).sqrt());
    println!("law: gusts of {strength} m/s, expected 2 m/s, about a mean of {mean} m/s");
    assert!((strength - 2.0).abs() < 0.2 && mean.abs() < 0.2);
    assert_eq!(gust(7, 12.5), gust(7, 12.5));
    assert_ne!(gust(7, 12.5), gust(8, 12.5));
    assert!((gust(7, 12.5) - gust(7, 12.6)).abs() < 0.3 * gust(7, 12.5), "they come and go smoothly");
}

/// A zone's wind blows only inside it, falls off towards its rim, and rotates with it.
#[test]
fn a_zone_blows_within_its_region() {
    let quarter = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let fan = WindZone {
        region: WindRegion::Cuboid(Vec3::new(2.0, 1.0, 1.0)),
        placement: Placement { translation: Vec3::Y * 3.0, rotation: quarter },
        flow: WindFlow::Along(Vec3::X * 4.0),
        falloff: 0.5,
    };
    let cases = [
        (Vec3::new(0.0, 3.0, 0.0), 4.0),
        (Vec3::new(0.0, 3.0, 0.9), 4.0),
        (Vec3::new(0.0, 3.0, 1.5), 2.0),
        (Vec3::new(0.0, 3.75, 0.0), 2.0),
        (Vec3::new(0.0, 3.0, 2.1), 0.0),
        (Vec3::new(1.1, 3.0, 0.0), 0.0),
    ];
    for (place, expected) in cases {
        // X along the fan is -Z in the world.
        let velocity = fan.velocity_at(place);
        assert!((velocity - Vec3::NEG_Z * expected).length() < 1e-4, "{velocity} at {place}");
    }
    let blast = WindZone { region: WindRegion::Sphere(2.0), flow: WindFlow::Outwards(10.0), ..fan };
    assert!((blast.velocity_at(Vec3::new(0.5, 3.0, 0.0)) - Vec3::X * 10.0).length() < 1e-4);
    assert_eq!(blast.velocity_at(Vec3::new(0.0, 5.1, 0.0)), Vec3::ZERO);

    let zones = |zone| Environment { wind_zones: vec![zone], ..weightless(FRAME) };
    let here = WindZone {
        placement: Placement::at(Vec3::ZERO),
        falloff: 0.0,
        flow: WindFlow::Along(Vec3::Z * 4.0),
        ..blast
    };
    let force = wind_force(&plate(), &zones(here));
    assert!((force.z - 0.5 * 1.2 * 1.2 * 16.0).abs() < 1e-3, "{force}");
    let there = WindZone { placement: Placement::at(Vec3::X * 20.0), ..here };
    assert_eq!(wind_force(&plate(), &zones(there)), Vec3::ZERO);
}

/// Cloth behind a wall gets only the part of the wind that the shelter leaves.
#[test]
fn a_wall_shelters() {
    let wall = obstacle(Shape::Cuboid { half_extents: Vec3::new(3.0, 3.0, 0.1) }, Vec3::NEG_Z * 2.0, 0.0);
    let force = |shelter, walls: Vec<drape_solver::Obstacle>| {
        let wind = Wind { shelter, ..Wind::new(Vec3::Z * 10.0) };
        wind_force(&plate(), &Environment { obstacles: walls.into(), ..air(wind) }).z
    };
    let open = force(0.8, vec![]);
    let lee = force(0.8, vec![wall.clone()]);
    assert!((lee - 0.04 * open).abs() < 1e-3 * open, "{lee} N of {open} N");
    assert_eq!(force(0.0, vec![wall]), force(0.0, vec![]));
    let behind = obstacle(Shape::Sphere { radius: 1.0 }, Vec3::Z * 3.0, 0.0);
    assert_eq!(force(0.8, vec![behind]), open, "what stands downwind does not shelter");
}
