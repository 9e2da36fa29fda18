//! Cloth against itself and against other cloth.

use drape_solver::glam::Vec3;
use drape_solver::{
    Body, BodySettings, ClothBuilder, ClothMaterial, Environment, Isa, Island, Obstacle, SelfContact,
    StructuralSolve, step, step_on,
};

use crate::common::*;
use crate::determinism::Fresh;
use SelfContact::{Off, On};

/// Distance in metres between the middles of two layers in these tests.
const APART: f32 = 0.04;

fn settings(self_contact: SelfContact) -> BodySettings {
    BodySettings { thickness: 0.5 * APART, self_contact, ..BodySettings::default() }
}

/// A cloth soft enough to fold.
fn silk() -> ClothMaterial {
    ClothMaterial { bend_stiffness: 0.05, ..ClothMaterial::default() }
}

/// A sheet of 0.9 m and `size` x `size` particles on edge above the ground, leaning a little.
fn on_edge(size: u32, settings: BodySettings) -> Body {
    ClothBuilder::new(0.9, 0.9, size, size)
        .placed(Vec3::new(-0.45, 1.0, 0.0), Vec3::X, Vec3::new(0.0, -0.995, 0.0998))
        .material(silk())
        .build(settings)
        .expect("valid")
}

fn over_ground() -> Environment {
    Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) }
}

/// Least distance of two particles of the island's first body that are far enough apart at rest to keep all of it, in metres.
fn least_distance(island: &Island, rest: &[Vec3]) -> f32 {
    let now: Vec<Vec3> = particles(island).positions().collect();
    let mut least = f32::INFINITY;
    for b in 0..now.len() {
        for a in 0..b {
            if rest[a].distance(rest[b]) > 2.0 * APART {
                least = least.min(now[a].distance(now[b]));
            }
        }
    }
    least
}

/// Found by random edits of a world. Pairs that an island keeps from step to step name bodies by their index. If a body
/// without self-contact came before those with it, pairs named its particles, and the solver read beyond the last.
#[test]
fn a_body_that_comes_before_others_does_not_get_their_contacts() {
    let mut island = Island::of_body(on_edge(13, settings(On)));
    // Runs until it hardly moves, so that its pairs stay valid for long.
    run(&mut island, &over_ground(), 4.0);
    assert!(island.self_contact_counts().pairs > 0);
    // The same without pairs from earlier steps.
    let mut fresh = Island::of_body(island.bodies[0].clone());
    for island in [&mut island, &mut fresh] {
        island.bodies.insert(0, loose(&[Vec3::X * 50.0], bare()));
        run(island, &over_ground(), 0.2);
    }
    assert_eq!(hash(&island), hash(&fresh));
}

/// A cloth dropped on its edge lies down in folds whose layers keep their distance.
#[test]
fn a_cloth_dropped_on_its_edge_folds_in_layers() {
    let folded = |self_contact| {
        let mut island = Island::of_body(on_edge(31, settings(self_contact)));
        let rest: Vec<Vec3> = particles(&island).positions().collect();
        let mut fastest = 0.0_f32;
        run_with(&mut island, &over_ground(), 8.0, |island, _| fastest = fastest.max(greatest_speed(island)));
        let high = particles(&island).positions().map(|p| p.y).fold(0.0, f32::max);
        println!(
            "{self_contact:?}: at most {fastest} m/s, at last {} m/s, {high} m high",
            greatest_speed(&island)
        );
        assert!(fastest < 8.0, "{fastest} m/s");
        least_distance(&island, &rest) / APART
    };
    let [with, without] = [On, Off].map(folded);
    println!("least distance {with} with and {without} without self-contact");
    assert!(with > 0.9, "{with} of the distance is left between layers");
    assert!(without < 0.5, "the cloth must have folded onto itself, but {without}");
}

/// Particles are displaced at random by some spacings. Sticks pull the tangle straight, and contacts never add more energy
/// than the sticks had.
#[test]
fn a_random_tangle_never_explodes() {
    for seed in 0..3 {
        let most = |self_contact| {
            let settings = BodySettings { drag: 0.0, ..settings(self_contact) };
            let mut sheet = on_edge(13, settings);
            let mut dice = Dice::new(seed);
            for i in 0..sheet.particles.len() {
                sheet.particles.set_position(i, sheet.particles.position(i) + dice.vector(0.15));
            }
            let mut island = Island::of_body(sheet);
            let (mut most, mut last) = (0.0_f64, 0.0);
            run_with(&mut island, &weightless(FRAME), 4.0, |island, _| {
                last = kinetic_energy(island);
                most = most.max(last);
            });
            println!("seed {seed}, {self_contact:?}: at most {most} J, at last {last} J");
            (most, last)
        };
        let (without, _) = most(Off);
        let (with, last) = most(On);
        assert!(with < 2.0 * without, "seed {seed}: {with} J, and {without} J without self-contact");
        assert!(last < 0.5 * with, "seed {seed}: {last} J are left of {with} J");
    }
}

/// Two halves of a free cloth fly at each other: contacts and friction keep momentum.
#[test]
fn a_free_cloth_that_folds_onto_itself_keeps_its_momentum() {
    let mut sheet = ClothBuilder::new(0.9, 0.9, 31, 31)
        .material(silk())
        .build(BodySettings { drag: 0.0, ..settings(On) })
        .expect("valid");
    for i in 0..sheet.particles.len() {
        let side = sheet.particles.position(i).x - 0.45;
        // The halves fold about the middle, and the whole drifts, so that momentum is not zero.
        sheet.particles.set_velocity(i, Vec3::new(0.5, 0.0, 1.0 + 8.0 * side.abs()));
    }
    let mut island = Island::of_body(sheet);
    let rest: Vec<Vec3> = particles(&island).positions().collect();
    let before = momentum(&island);
    let mut least = f32::INFINITY;
    run_with(&mut island, &weightless(FRAME), 1.5, |island, index| {
        let error = (momentum(island) - before).length() / before.length();
        assert!(error < 1e-5, "{error} of the momentum is lost at step {index}");
        least = least.min(least_distance(island, &rest));
    });
    assert!(least < 1.05 * APART, "the wings must have met, but kept {least} m");
}

/// A sheet slides on a pinned one in the same island, and stops if there is friction.
#[test]
fn friction_holds_one_layer_on_another() {
    let slid = |friction| {
        let settings = BodySettings { friction, drag: 0.0, ..settings(On) };
        let sheet = |size: f32, count, height| {
            ClothBuilder::new(size, size, count, count).placed(
                Vec3::new(-0.5 * size, height, -0.5 * size),
                Vec3::X,
                Vec3::Z,
            )
        };
        let lower = sheet(1.2, 41, 0.0).pin_where(|_, _, _| true).build(settings).expect("valid");
        let mut upper = sheet(0.4, 12, 1.02 * APART).build(settings).expect("valid");
        for i in 0..upper.particles.len() {
            upper.particles.set_velocity(i, Vec3::new(0.3, 0.0, 0.05));
        }
        let mut island = Island { bodies: vec![lower, upper], ..Island::default() };
        let x = |island: &Island| {
            let particles = &island.bodies[1].particles;
            particles.positions().map(|p| p.x).sum::<f32>() / particles.len() as f32
        };
        let before = x(&island);
        run(&mut island, &gravity(FRAME), 1.0);
        let height = island.bodies[1].particles.positions().map(|p| p.y).fold(f32::INFINITY, f32::min);
        assert!(height > 0.8 * APART, "it must lie on the other, but is at {height} m");
        x(&island) - before
    };
    let (rough, smooth) = (slid(0.8), slid(0.0));
    println!("{rough} m with friction, {smooth} m without");
    assert!(rough.abs() < 0.05, "{rough} m");
    assert!(smooth.abs() > 2.0 * rough.abs(), "{smooth} m without friction, {rough} m with");
}

/// Self-contact changes no bit of a cloth that never touches itself, nor of one without thickness that does.
#[test]
fn where_nothing_meets_nothing_changes() {
    let hang = |self_contact, thickness| {
        let settings = BodySettings { thickness, ..settings(self_contact) };
        let sheet = ClothBuilder::new(0.9, 0.9, 31, 31).pin(0).pin(30).build(settings).expect("valid");
        let mut island = Island::of_body(sheet);
        run(&mut island, &gravity(FRAME), 0.3);
        hash(&island)
    };
    let without = hang(Off, 0.01);
    assert_eq!(hang(On, 0.01), without);
    let fold = |self_contact| {
        let sheet = on_edge(21, BodySettings { thickness: 0.0, ..settings(self_contact) });
        let mut island = Island::of_body(sheet);
        run(&mut island, &over_ground(), 1.5);
        hash(&island)
    };
    let without = fold(Off);
    assert_eq!(fold(On), without);
}

/// Whole steps and single stages give the same bits on every instruction set.
#[test]
fn every_way_of_stepping_gives_the_same_bits() {
    let folded = |isa, take: &dyn Fn(&mut Island, &Environment)| {
        let mut island = Island { isa, ..Island::of_body(on_edge(13, settings(On))) };
        for _ in 0..90 {
            take(&mut island, &over_ground());
        }
        hash(&island)
    };
    let whole = |island: &mut Island, environment: &Environment| {
        step(island, environment).expect("a good step");
    };
    let staged = |island: &mut Island, environment: &Environment| {
        step::begin(island, environment).expect("a good step");
        step::accumulate_forces(island, environment);
        step::detect_collisions(island, environment);
        (0..island.substeps()).for_each(|_| step::substep(island, environment));
        step::finish(island).expect("a good step");
    };
    let cold = |island: &mut Island, environment: &Environment| {
        island.context = Default::default();
        whole(island, environment);
    };
    let expected = folded(Isa::detected(), &whole);
    for isa in Isa::available() {
        assert_eq!(folded(isa, &whole), expected, "{isa:?}");
    }
    assert_eq!(folded(Isa::detected(), &staged), expected, "stage by stage");
    assert_eq!(folded(Isa::detected(), &cold), expected, "without memory of the step before");
}

/// Threads share long lists of pairs, and may come at any time.
#[test]
fn layers_give_the_same_bits_on_any_number_of_threads() {
    let folded = |take: &dyn Fn(&mut Island, &Environment)| {
        let mut island = Island::of_body(on_edge(37, settings(On)));
        for _ in 0..40 {
            take(&mut island, &over_ground());
        }
        assert!(island.self_contact_counts().pairs > 20_000, "there is something to share");
        hash(&island)
    };
    let alone = folded(&|island, environment| step(island, environment).expect("a good step"));
    for threads in [2, 3] {
        let shared = folded(&|island, environment| {
            step_on(island, environment, &Fresh(threads)).expect("a good step");
        });
        assert_eq!(shared, alone, "{threads} threads");
    }
}

/// Threads share the bodies of an island, unless a ball takes part.
#[test]
fn bodies_that_touch_give_the_same_bits_on_any_number_of_threads() {
    let layered = |has_ball: bool, take: &dyn Fn(&mut Island, &Environment)| {
        let sheet = |k: u32| {
            let corner = Vec3::new(-0.3 - 0.02 * k as f32, 0.05 + 0.03 * k as f32, -0.3);
            let cloth = ClothBuilder::new(0.6, 0.6, 18 + 3 * k, 20).placed(corner, Vec3::X, Vec3::Z);
            cloth.build(settings(On)).expect("valid")
        };
        let mut island = Island { bodies: (0..3).map(sheet).collect(), ..Island::default() };
        if has_ball {
            island.balls.push(ball(smooth(0.1, 1.0), Vec3::Y * 0.4, Vec3::ZERO));
        }
        for _ in 0..30 {
            take(&mut island, &over_ground());
        }
        assert!(island.self_contact_counts().pairs > 100, "they touch");
        hash(&island)
    };
    for has_ball in [false, true] {
        let alone = layered(has_ball, &|island, environment| step(island, environment).expect("a good step"));
        for threads in [2, 3] {
            let shared = layered(has_ball, &|island, environment| {
                step_on(island, environment, &Fresh(threads)).expect("a good step");
            });
            assert_eq!(shared, alone, "{threads} threads, ball: {has_ball}");
        }
    }
}

/// A folded cloth refined together with its thickness has as many pairs per particle as before: the cost is linear. With lines coarser
/// cloth folds less.
#[test]
fn pairs_per_particle_do_not_grow_with_the_cloth() {
    let pairs = |size: u32, structural| {
        let spacing = 0.9 / (size - 1) as f32;
        let settings = BodySettings { thickness: 0.2 * spacing, structural, ..settings(On) };
        let mut island = Island::of_body(on_edge(size, settings));
        let mut most = 0.0_f32;
        run_with(&mut island, &over_ground(), 1.5, |island, _| {
            most = most.max(island.self_contact_counts().pairs as f32 / (size * size) as f32);
        });
        most
    };
    for (structural, sizes) in [(StructuralSolve::Sweeps, [14, 27]), (StructuralSolve::Lines, [27, 54])] {
        let counts = sizes.map(|size| pairs(size, structural));
        println!("pairs per particle: {counts:?}");
        assert!(counts.iter().all(|&count| count < 100.0), "{counts:?}");
        assert!(counts[1] < 1.5 * counts[0], "{counts:?}");
    }
}
