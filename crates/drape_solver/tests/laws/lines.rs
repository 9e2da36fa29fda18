//! Lines: rows and columns of a grid, and ropes, solved as chains.

use drape_solver::glam::{DVec3, Vec3};
use drape_solver::state::measure;
use drape_solver::{
    Ball, BallMaterial, Body, BodySettings, ClothBuilder, ClothMaterial, Edge, Environment, Isa, Island,
    Quality, RopeBuilder, Shape, StructuralSolve, step,
};

use crate::common::*;

/// Default settings with line solves, `substeps` and `iterations`, and without drag.
fn lines(substeps: u32, iterations: u32) -> BodySettings {
    let structural = StructuralSolve::Lines;
    BodySettings { substeps, iterations, structural, drag: 0.0, ..BodySettings::default() }
}

/// All sticks rigid.
fn stiff() -> ClothMaterial {
    ClothMaterial { shear_stiffness: 1.0, bend_stiffness: 1.0, ..ClothMaterial::default() }
}

/// A level rope of 2 m that falls about its pinned start.
#[test]
fn a_swinging_rope_stretches_far_less_than_with_sweeps() {
    for tethers in [false, true] {
        let motion = BOTH.map(|structural| {
            let settings = BodySettings { structural, tethers, ..lines(8, 1) };
            let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X * 2.0, 64).pin_start().build(settings);
            stretch_in_motion(&mut Island::of_body(rope.expect("valid")), 3.0)
        });
        assert!(motion[1] < 0.05 * motion[0], "tethers {tethers}: {motion:?}");
    }
}

/// A straight chain between two pins has one stick more than free particles. It must neither burst nor move, and must not
/// sag under a load by more than with sweeps.
#[test]
fn a_taut_rope_between_two_pins_stays_taut() {
    for (count, columns_of_cells) in [(48, true), (61, true), (9, false)] {
        let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X * 2.0, count).pin_start().pin_end();
        let mut island = Island::of_body(rope.build(lines(8, 1)).expect("valid"));
        run(&mut island, &gravity(FRAME), 3.0);
        let sag = particles(&island).positions().map(|p| -p.y).fold(0.0, f32::max);
        assert!(sag < 0.05, "{count} particles, in cells: {columns_of_cells}: {sag}");
        assert!(greatest_speed(&island) < 0.5);
    }
}

/// With one line solve in a substep, as in high quality, a taut rope once vibrated for ever and never slept: at 0.065 m/s,
/// and at 0.26 m/s with eight substeps.
#[test]
fn a_taut_rope_between_two_pins_comes_to_rest() {
    for (substeps, part) in [(8, 1.0), (8, 0.999), (16, 1.0), (16, 0.999)] {
        let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X * 2.0, 61).pin_start().pin_end();
        let settings = BodySettings { substeps, ..BodySettings::from(Quality::High) };
        let mut rope = rope.build(settings).expect("valid");
        for i in 0..61 {
            rope.particles.set_position(i, rope.particles.position(i) * part);
        }
        let mut island = Island::of_body(rope);
        run(&mut island, &gravity(FRAME), 4.0);
        let still_for = island.bodies[0].still_for();
        assert!(still_for > 1.0, "{substeps} substeps, {part} of its length: still for {still_for} s");
    }
}

/// True for the first and the last of `n`.
fn is_side(i: u32, n: u32) -> bool {
    i == 0 || i + 1 == n
}

/// Fine sheets of high quality hummed at 0.05 to 0.3 m/s for ever and never slept, and stretched by up to 0.7 %: the shortest waves
/// across a taut line saw too much of its pull.
#[test]
fn fine_taut_sheets_come_to_rest() {
    let held: [(&str, fn(bool, bool) -> bool); 3] = [
        ("all round", |column, row| column || row),
        ("at two sides", |column, _| column),
        ("by its corners", |column, row| column && row),
    ];
    for (name, held) in held {
        for n in [33, 65, unless_miri(129, 33)] {
            let sheet = ClothBuilder::new(1.0, 1.0, n, n)
                .placed(Vec3::ZERO, Vec3::X, Vec3::Z)
                .pin_where(move |column, row, _| held(is_side(column, n), is_side(row, n)));
            let mut island = Island::of_body(sheet.build(BodySettings::from(Quality::High)).expect("valid"));
            run(&mut island, &gravity(FRAME), 4.0);
            let still_for = island.bodies[0].still_for();
            assert!(still_for > 1.0, "{n} x {n}, held {name}: still for {still_for} s");
            let stretch = stretch(&island).rms;
            assert!(stretch < 1e-3, "{n} x {n}, held {name}: stretched by {stretch}");
        }
    }
}

/// A level sheet of high quality and `length` metres, pinned all round, below a square of `across` x `across` balls of `mass` kg. Their
/// centres are `apart` metres apart, and `height` above the sheet.
fn trampoline(length: f32, across: usize, mass: f32, [apart, height]: [f32; 2]) -> Island {
    let n = 33;
    let sheet = ClothBuilder::new(length, length, n, n)
        .placed(Vec3::new(-0.5 * length, 0.0, -0.5 * length), Vec3::X, Vec3::Z)
        .pin_where(move |column, row, _| is_side(column, n) || is_side(row, n));
    let mut island = Island::of_body(sheet.build(BodySettings::from(Quality::High)).expect("valid"));
    let material = BallMaterial { radius: 0.08, mass, ..BallMaterial::default() };
    let middle = 0.5 * (across - 1) as f32 * apart;
    for i in 0..across * across {
        let [x, z] = [i % across, i / across].map(|place| place as f32 * apart - middle);
        island.balls.push(ball(material, Vec3::new(x, height, z), Vec3::ZERO));
    }
    island
}

/// A trampoline with balls on it stayed in motion for ever.
#[test]
fn a_trampoline_under_balls_comes_to_rest() {
    let mut island = trampoline(2.0, 3, 0.2, [0.4, 0.1]);
    run(&mut island, &gravity(FRAME), 8.0);
    let still_for = island.bodies[0].still_for();
    assert!(still_for > 1.0, "still for {still_for} s");
    // The sheet is nearly level, and balls may roll off.
    for place in island.balls.iter().map(Ball::position) {
        assert!(place.y > 0.0 || place.x.abs().max(place.z.abs()) > 1.0, "a ball is below it: {place}");
    }
}

/// Sixteen balls that weigh 32 times as much as the sheet stretched a few of its sticks by a tenth. Their lines then took only a small part
/// of their steps: the sheet sagged by 0.18 m and trembled at 0.4 m/s.
#[test]
fn a_light_sheet_under_heavy_balls_is_calm() {
    let mut island = trampoline(1.0, 4, 0.5, [0.2, 0.2]);
    run(&mut island, &gravity(FRAME), 3.0);
    let mut greatest = 0.0_f32;
    run_with(&mut island, &gravity(FRAME), 1.0, |island, _| {
        greatest = greatest.max(measure::mean_square_speed(particles(island)).sqrt());
    });
    let lowest = positions(&island.bodies[0]).iter().map(|position| position.y).fold(0.0, f32::min);
    println!("law: a light sheet under heavy balls moves at {greatest} m/s and sags by {} m", -lowest);
    assert!(greatest < 0.15, "{greatest} m/s");
    assert!(lowest > -0.1, "{lowest} m");
}

/// A sheet pinned at two corners comes to rest symmetric about its middle, and unstretched.
#[test]
fn a_sheet_hung_by_two_corners_ends_symmetric_and_unstretched() {
    for n in [16_u32, 24, 50] {
        let settings = BodySettings { drag: 2.0, ..lines(16, 1) };
        let sheet = ClothBuilder::new(1.0, 1.0, n, n).material(stiff()).pin(0).pin(n - 1).build(settings);
        let mut island = Island::of_body(sheet.expect("valid"));
        run(&mut island, &gravity(FRAME), 12.0);
        let found = stretch(&island);
        assert!(found.rms < 5e-4 && found.max < 0.02, "{n}: {found:?}");
        let at = |column: u32, row: u32| particles(&island).position((row * n + column) as usize);
        let mut off = 0.0_f64;
        for (column, row) in (0..n / 2).flat_map(|column| (0..n).map(move |row| (column, row))) {
            let (p, q) = (at(column, row), at(n - 1 - column, row));
            let mirrored = Vec3::new(1.0 - q.x, q.y, q.z);
            off += f64::from((p - mirrored).length_squared());
        }
        let off = (off / f64::from(n * n / 2)).sqrt();
        assert!(off < 0.03, "{n}: {off} m from symmetric");
    }
}

/// Buckling: a sheet that is compressed in its plane folds; it neither jams nor bursts, and gains no energy.
#[test]
fn a_cloth_compressed_along_itself_buckles() {
    for n in [20_u32, 64] {
        for (substeps, iterations) in [(1, 1), (4, 2), (16, 1)] {
            let settings = BodySettings { tethers: false, ..lines(substeps, iterations) };
            let sheet = ClothBuilder::new(1.0, 1.0, n, n)
                .placed(Vec3::ZERO, Vec3::X, Vec3::Z)
                .pin_edge(Edge::Left)
                .pin_edge(Edge::Right);
            let mut island = Island::of_body(sheet.build(settings).expect("valid"));
            let environment = weightless(FRAME);
            // In half a second the right edge moves a third of the way to the left one.
            for index in 1..=30 {
                let x = 1.0 - index as f32 / 90.0;
                for row in 0..n {
                    let pin = row * n + n - 1;
                    let z = particles(&island).position(pin as usize).z;
                    island.bodies[0].particles.set_pin_target(pin as usize, Vec3::new(x, 0.0, z));
                }
                step(&mut island, &environment).expect("finite");
            }
            let pushed = kinetic_energy(&island);
            let mass = measure::mass(particles(&island));
            assert!(pushed < mass * 4.0, "{n} {substeps} x {iterations}: {pushed} J for {mass} kg");
            run(&mut island, &environment, 2.0);
            let after = kinetic_energy(&island);
            assert!(
                after <= pushed + 1e-3 * mass,
                "{n} {substeps} x {iterations}: {pushed} J, then {after} J"
            );
            let greatest = particles(&island).positions().map(Vec3::length).fold(0.0, f32::max);
            assert!(greatest < 3.0, "{n} {substeps} x {iterations}: {greatest} m away");
        }
    }
}

/// A straight rope compressed to two thirds of its length has no preferred side to buckle to.
#[test]
fn a_straight_compressed_chain_stays_finite() {
    for count in [48_u32, 100] {
        let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X * 2.0, count).pin_start().pin_end();
        let mut island = Island::of_body(rope.build(lines(8, 1)).expect("valid"));
        for i in 0..count as usize {
            let squeezed = particles(&island).position(i) * (2.0 / 3.0);
            island.bodies[0].particles.set_position(i, squeezed);
        }
        run(&mut island, &gravity(FRAME), 4.0);
        let lowest = particles(&island).positions().map(|p| -p.y).fold(0.0, f32::max);
        assert!((0.3..1.0).contains(&lowest), "{count}: it hangs {lowest} m deep");
        assert!(stretch(&island).rms < 0.02, "{count}: {:?}", stretch(&island));
    }
}

/// The greatest gain of energy since the start, as a part of `m g L`; after a violent start, since step 30.
fn gained(n: u32, corners: bool, settings: BodySettings, violent: bool) -> f64 {
    let mut island = level_sheet(n, corners, stiff(), settings, violent);
    let environment: Environment = gravity(FRAME);
    let energy = |island: &Island| measure::mechanical_energy(&island.bodies[0], environment.gravity);
    let scale = measure::mass(particles(&island)) * f64::from(G);
    let mut start = energy(&island);
    if violent {
        run(&mut island, &environment, 30.0 * FRAME);
        start = energy(&island);
        run(&mut island, &environment, 3.5);
        return (energy(&island) - start) / scale;
    }
    let mut greatest = f64::MIN;
    run_with(&mut island, &environment, 4.0, |island, _| greatest = greatest.max(energy(island)));
    (greatest - start) / scale
}

fn check(sizes: &[u32], substeps: &[u32]) {
    for &n in sizes {
        for (corners, violent) in [(false, false), (false, true), (true, false), (true, true)] {
            for (&substeps, iterations) in substeps.iter().flat_map(|s| [(s, 1), (s, 2)]) {
                for tethers in [true, false] {
                    let settings = BodySettings { tethers, ..lines(substeps, iterations) };
                    let gain = gained(n, corners, settings, violent);
                    println!(
                        "{n} corners {corners} {substeps}x{iterations} tethers {tethers} violent {violent}: {gain}"
                    );
                    assert!(
                        gain <= 1e-3,
                        "gained {gain} m g L: {n} squared, corners {corners}, {substeps} x {iterations}, \
                         tethers {tethers}, violent {violent}"
                    );
                }
            }
        }
    }
}

/// S11: from rest and from a violent start, on both kinds of pins, at any number of substeps.
#[test]
fn a_hanging_sheet_with_lines_gains_no_energy() {
    check(&[16, 32], &[1, 2, 4, 8, 16]);
}

/// The same for larger sheets and more substeps; takes minutes.
#[test]
#[ignore = "takes minutes"]
fn a_large_hanging_sheet_with_lines_gains_no_energy() {
    check(&[64, 128], &[1, 2, 4, 8, 16, 64]);
    check(&[256], &[1, 4, 16]);
}

/// Sticks pull both ends alike: a free, tangled cloth keeps its momentum.
#[test]
fn a_free_cloth_keeps_its_momentum() {
    for (columns, rows) in [(20, 17), (50, 9)] {
        let body = ClothBuilder::new(1.5, 1.0, columns, rows).build(lines(8, 1)).expect("valid");
        assert_tangle_keeps_momentum(body, &format!("{columns} x {rows}"));
    }
}

/// Gives the particles of a free body velocities all over the place, and asserts that it keeps its momentum.
pub fn assert_tangle_keeps_momentum(mut body: Body, what: &str) {
    let mut dice = Dice::new(7);
    for i in 0..body.particles.len() {
        body.particles.set_velocity(i, dice.vector(1.0) + Vec3::X);
    }
    let mut island = Island::of_body(body);
    let (linear, angular) = (momentum(&island), angular_momentum(&island));
    run(&mut island, &weightless(FRAME), 2.0);
    let (after, turned) = (momentum(&island), angular_momentum(&island));
    assert!((after - linear).length() < 1e-4 * linear.length(), "{what}: {linear} -> {after}");
    let about = DVec3::splat(measure::mass(particles(&island)));
    assert!((turned - angular).length() < 0.02 * about.length(), "{what}: {angular} -> {turned}");
}

/// A sheet pinned all round throws a cannon ball back. The ball gets nowhere deeper than with sweeps (which let it through
/// the finer of the two sheets), and nothing bursts.
#[test]
fn a_cannon_ball_is_stopped_by_a_pinned_sheet() {
    for (cells, speed) in [(16_u32, 8.0), (16, 25.0), (24, 8.0), (24, 25.0_f32)] {
        let last = cells;
        let spacing = 1.0 / cells as f32;
        let sheet = ClothBuilder::new(1.0, 1.0, cells + 1, cells + 1)
            .placed(Vec3::new(-0.5, 0.0, -0.5), Vec3::X, Vec3::Z)
            .pin_where(|column, row, _| column == 0 || row == 0 || column == last || row == last);
        for (u, v) in [(0.0, 0.0), (0.5, 0.0), (0.33, 0.67)] {
            let depths = BOTH.map(|structural| {
                let settings = BodySettings { structural, ..lines(8, 2) };
                let mut island = Island::of_body(sheet.clone().build(settings).expect("valid"));
                let start = Vec3::new(u * spacing, 0.6, v * spacing);
                island.balls.push(ball(BallMaterial::default(), start, Vec3::NEG_Y * speed));
                let mut depth = 0.0_f32;
                run_with(&mut island, &weightless(FRAME), 1.0, |island, _| {
                    depth = depth.max(-island.balls[0].position().y);
                });
                let velocity = island.balls[0].velocity();
                let is_back = velocity.y > -0.5 || structural == StructuralSolve::Sweeps;
                assert!(is_back, "{cells} {speed} m/s ({u}, {v}): {velocity}");
                let brought = 0.5 * f64::from(speed * speed * BallMaterial::default().mass);
                assert!(kinetic_energy(&island) < brought, "no energy is made");
                depth
            });
            assert!(depths[1] < depths[0] + 0.02, "{cells} {speed} m/s ({u}, {v}): {depths:?} m deep");
        }
    }
}

/// At the demo's speeds the ball does not go through the demo's curtain: all cloth in its path is in front of it, and has
/// slowed it.
#[test]
fn a_cannon_ball_does_not_go_through_a_curtain() {
    for (speed, x, y) in [(12.0, 0.0, 1.8), (25.0, 0.03, 2.1), (18.0, -1.0, 1.7), (25.0, 1.2, 2.6)] {
        let settings = BodySettings { drag: 2.0, ..lines(8, 1) };
        let curtain = ClothBuilder::new(4.0, 3.0, 64, 48)
            .placed(Vec3::new(-2.0, 3.3, 0.0), Vec3::X, Vec3::NEG_Y)
            .pin_edge(Edge::Top);
        let mut island = Island::of_body(curtain.build(settings).expect("valid"));
        let material = BallMaterial::default();
        island.balls.push(ball(material, Vec3::new(x, y, 0.5), Vec3::NEG_Z * speed));
        let mut since_touch = 0;
        run_with(&mut island, &gravity(FRAME), 0.2, |island, _| {
            since_touch += i32::from(since_touch > 0 || !island.touches.is_empty());
            if (1..=4).contains(&since_touch) {
                let centre = island.balls[0].position();
                for position in particles(island).positions() {
                    let away = position - centre;
                    let beside = away.truncate().length() > 0.8 * material.radius;
                    assert!(beside || away.z < 0.0, "{speed} m/s at ({x}, {y}): {away} behind the ball");
                }
            }
        });
        assert!(since_touch > 5, "it must have hit");
        let after = island.balls[0].velocity().length();
        assert!(after < 0.9 * speed, "{after} m/s of {speed} m/s at ({x}, {y})");
        assert!(stretch(&island).max < 1.5, "{:?}", stretch(&island));
    }
}

/// A falling sheet over a sphere, with half masses along its border and one loose pin: all cases of the line kernels.
fn sheet(columns: u32, rows: u32, isa: Isa) -> (Island, Environment) {
    let sheet = ClothBuilder::new(2.0, 2.0, columns, rows)
        .placed(Vec3::new(-1.0, 1.0, -1.0), Vec3::X, Vec3::Z)
        .pin(0)
        .pin(columns - 1)
        .build(lines(4, 2))
        .expect("valid");
    let sphere = obstacle(Shape::Sphere { radius: 0.5 }, Vec3::new(0.0, 0.3, 0.0), 0.5);
    let environment = Environment { obstacles: vec![sphere].into(), ..gravity(FRAME) };
    (Island { isa, ..Island::of_body(sheet) }, environment)
}

/// The hash of a sheet after a second.
pub fn hash_of_sheet(columns: u32, rows: u32, isa: Isa) -> u64 {
    let (mut island, environment) = sheet(columns, rows, isa);
    run(&mut island, &environment, 60.0 * FRAME);
    hash(&island)
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    for (columns, rows) in [(30, 21), (5, 49), (100, 90)] {
        let hashes: Vec<u64> =
            Isa::available().into_iter().map(|isa| hash_of_sheet(columns, rows, isa)).collect();
        assert!(hashes.windows(2).all(|pair| pair[0] == pair[1]), "{columns} x {rows}: {hashes:x?}");
    }
}

#[test]
fn stage_by_stage_gives_the_bits_of_whole_substeps() {
    let (mut whole, environment) = sheet(100, 90, Isa::detected());
    let (mut staged, _) = sheet(100, 90, Isa::detected());
    for _ in 0..60 {
        step(&mut whole, &environment).expect("finite");
        step_staged(&mut staged, &environment);
    }
    assert_eq!(hash(&whole), hash(&staged));
}

/// Soft structural sticks, and bodies without a grid of cells, get the same bits as with sweeps.
#[test]
fn what_lines_do_not_apply_to_is_swept() {
    let soft = ClothMaterial { stretch_stiffness: 0.9, ..ClothMaterial::default() };
    let soft_sheet = |settings| ClothBuilder::new(1.0, 1.0, 20, 20).material(soft).pin(0).build(settings);
    let small_sheet = |settings| ClothBuilder::new(1.0, 1.0, 6, 6).pin(0).build(settings);
    let short_rope = |settings| RopeBuilder::new(Vec3::ZERO, Vec3::X, 12).pin_start().build(settings);
    let build: [&dyn Fn(BodySettings) -> _; 3] = [&soft_sheet, &small_sheet, &short_rope];
    for build in build {
        let [swept, lined] = BOTH.map(|structural| {
            let mut island =
                Island::of_body(build(BodySettings { structural, ..lines(8, 1) }).expect("valid"));
            run(&mut island, &gravity(FRAME), 1.0);
            hash(&island)
        });
        assert_eq!(swept, lined);
    }
}

/// Switching lines on and off does not make a hanging cloth jump.
#[test]
fn lines_may_come_and_go() {
    let sheet = ClothBuilder::new(1.0, 1.0, 20, 20).pin_edge(Edge::Top).build(lines(8, 1)).expect("valid");
    let mut island = Island::of_body(sheet);
    island.bodies[0].settings.drag = 2.0;
    run(&mut island, &gravity(FRAME), 6.0);
    for (index, structural) in BOTH.into_iter().cycle().take(8).enumerate() {
        island.bodies[0].settings.structural = structural;
        run(&mut island, &gravity(FRAME), 0.5);
        assert!(greatest_speed(&island) < 0.3, "change {index}: {} m/s", greatest_speed(&island));
    }
}

/// One cloth with random pins, and with masses a million times apart.
#[test]
fn pins_and_masses_of_all_kinds_stay_finite() {
    for (columns, rows) in [(20_u32, 20), (52, 30)] {
        let mut dice = Dice::new(u64::from(columns));
        let mut body = ClothBuilder::new(1.0, 1.0, columns, rows).pin(0).build(lines(4, 1)).expect("valid");
        for i in 0..body.particles.len() {
            let kind = dice.unit();
            let inverse = if kind < 0.2 { 0.0 } else { 1e-3 * 1e6_f32.powf(dice.unit()) };
            body.particles.set_inverse_mass(i, inverse);
        }
        // Some particles in one place.
        for i in 5..8 {
            let same = body.particles.position(4);
            body.particles.set_position(i, same);
        }
        let mut island = Island::of_body(body);
        run(&mut island, &gravity(FRAME), 2.0);
        let greatest = particles(&island).positions().map(Vec3::length).fold(0.0, f32::max);
        assert!(greatest < 5.0, "{greatest}");
    }
}

/// A tolerance ends the iterations of a quiet cloth at once. Lines are solved in the last of them: the cloth and the rope sagged by the
/// tolerance, and sprang back.
#[test]
fn a_tolerance_leaves_lines_as_they_are() {
    let after_half_a_second = |tolerance| {
        let settings = BodySettings {
            structural: StructuralSolve::Lines,
            iterations: 8,
            tolerance,
            ..BodySettings::default()
        };
        let sheet =
            ClothBuilder::new(1.0, 1.0, 17, 17).placed(Vec3::ZERO, Vec3::X, Vec3::NEG_Y).pin_edge(Edge::Top);
        let rope = RopeBuilder::new(Vec3::Z, Vec3::Z + Vec3::X, 40).pin_start();
        let bodies = vec![sheet.build(settings).expect("valid"), rope.build(settings).expect("valid")];
        let mut island = Island { bodies, ..Island::default() };
        run(&mut island, &gravity(FRAME), 0.5);
        hash(&island)
    };
    assert_eq!(after_half_a_second(0.05), after_half_a_second(0.0));
}

/// The stretch in motion of a falling sheet with `n` particles to a side, held by two corners.
fn stretch_of_sheet(n: u32, settings: BodySettings) -> f64 {
    stretch_in_motion(&mut level_sheet(n, true, stiff(), settings, false), 2.0)
}

/// Iterations before that of the lines once swept the other sticks, which put the lines out of place again.
#[test]
fn iterations_do_not_stretch_what_touches_nothing() {
    let motion = [2, 4, 8].map(|iterations| stretch_of_sheet(33, lines(12, iterations)));
    assert_eq!(motion, [motion[0]; 3]);
    let one = stretch_of_sheet(33, lines(12, 1));
    assert!(motion[0] < 1.5 * one, "{} with more iterations, {one} with one", motion[0]);
}

/// Up to 12 substeps columns are solved once more after the rows.
#[test]
fn a_second_solve_of_columns_takes_much_of_what_the_rows_leave() {
    let [with, without] = [12, 13].map(|substeps| stretch_of_sheet(64, lines(substeps, 1)));
    println!("law: stretch in motion {with} with 12 substeps, {without} with 13");
    assert!(with < 0.8 * without, "{with} with 12 substeps, {without} with 13");
}
