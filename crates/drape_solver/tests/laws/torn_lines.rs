//! Lines of torn cloth: they have gaps, and copies of particles are in lines of their own.

use drape_solver::glam::Vec3;
use drape_solver::state::measure;
use drape_solver::{
    Body, BodySettings, ClothBuilder, Edge, Environment, Isa, Island, Quality, RopeBuilder, StickBatch,
    StickKind, StructuralSolve, TearLimits, step, step_on,
};

use crate::common::*;
use crate::determinism::Fresh;
use crate::lines::assert_tangle_keeps_momentum;

/// Sheets whose rows and columns lie in the lanes in all ways: patches side by side, in a square and below each other, few lines.
const SIZES: [(u32, u32); 5] = [(64, 64), (40, 33), (20, 24), (3, 60), (60, 3)];

/// A sheet that hangs by its upper edge.
fn hanging(columns: u32, rows: u32, settings: BodySettings) -> Body {
    ClothBuilder::new(1.0, 1.0, columns, rows)
        .placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y)
        .pin_edge(Edge::Top)
        .build(settings)
        .expect("valid")
}

/// The same with a slit across the columns and one across the rows, and without a corner.
fn torn(columns: u32, rows: u32, settings: BodySettings) -> Body {
    let mut body = hanging(columns, rows, settings);
    let slits = [[(-0.3, 0.21), (0.2, 0.21)], [(0.17, 0.1), (0.17, -0.3)], [(0.3, -0.9), (0.9, -0.1)]];
    for [from, to] in slits.map(|ends| ends.map(|(x, y)| Vec3::new(x, y, 0.0))) {
        // Where particles are far apart a slit may be too short to open anything.
        body.cut(&blade(from, to)).expect("can be cut");
    }
    assert_ne!(body.particles.len() as u32, columns * rows, "it is torn");
    body
}

fn lines(quality: Quality) -> BodySettings {
    BodySettings { structural: StructuralSolve::Lines, drag: 0.0, ..quality.into() }
}

/// The strains of the structural sticks in the batches that pass a test, the least first.
fn strains(body: &Body, is_one: impl Fn(&StickBatch) -> bool) -> Vec<f32> {
    let Body { particles, topology, .. } = body;
    let structural = topology.batches().iter().filter(|batch| batch.material.kind == StickKind::Structural);
    let strain = |i: usize| {
        let [a, b] = topology.stick(i).map(|end| particles.position(end as usize));
        (a.distance(b) / topology.rest_length(i) - 1.0).abs()
    };
    let chosen = structural.filter(|batch| is_one(batch)).flat_map(StickBatch::range);
    let mut strains: Vec<f32> = chosen.map(strain).collect();
    strains.sort_unstable_by(f32::total_cmp);
    strains
}

/// The strain that a tenth of the structural sticks exceed. Those at the ends of a slit carry all that hangs below it.
fn exceeded_by_one_in_ten(body: &Body) -> f32 {
    let strains = strains(body, |_| true);
    strains[strains.len() * 9 / 10]
}

/// Torn cloth with lines stretches by less than a tenth of what sweeps leave.
#[test]
fn lines_of_torn_cloth_still_carry_its_pull() {
    for (columns, rows) in SIZES {
        for quality in [Quality::Medium, Quality::High] {
            let mean = |structural: StructuralSolve| {
                let settings = BodySettings { structural, ..lines(quality) };
                let mut island = Island::of_body(torn(columns, rows, settings));
                let mut sum = 0.0;
                run_with(&mut island, &gravity(FRAME), 1.0, |island, _| {
                    sum += exceeded_by_one_in_ten(&island.bodies[0]);
                });
                sum / 60.0
            };
            let [solved, swept] = [StructuralSolve::Lines, StructuralSolve::Sweeps].map(mean);
            println!(
                "law: stretch of a torn sheet, {columns} x {rows}, {quality:?}: {solved}, swept {swept}"
            );
            assert!(solved < 0.1 * swept, "{columns} x {rows}, {quality:?}: {solved}, swept {swept}");
        }
    }
}

/// A rope torn in the middle hardly stretches.
#[test]
fn both_halves_of_a_torn_rope_are_lines() {
    let rope = RopeBuilder::new(Vec3::ZERO, Vec3::NEG_Y * 2.0, 121).pin_start().pin_end();
    let mut body = rope.build(BodySettings { tethers: false, ..lines(Quality::High) }).expect("valid");
    body.particles.set_position(60, Vec3::new(0.1, -1.0, 0.0));
    let parted = body.tear(&TearLimits::default()).expect("can tear").expect("tears");
    let bodies = parted.pieces.into_iter().map(|piece| piece.body).chain([body]).collect();
    let mut island = Island { bodies, ..Island::default() };
    let mut greatest = 0.0;
    let environment = Environment { gravity: Vec3::X * G, ..gravity(FRAME) };
    run(&mut island, &environment, 0.2);
    run_with(&mut island, &environment, 2.0, |island, _| {
        for body in &island.bodies {
            greatest = measure::stretch(&body.particles, &body.topology).rms.max(greatest);
        }
    });
    assert!(island.bodies.len() > 1 && greatest < 4e-3, "{} pieces, {greatest}", island.bodies.len());
}

/// Loose sticks, of copies along a slit, are solved as lines, and take particles of the grid's lines along.
#[test]
fn sticks_along_a_slit_do_not_stretch() {
    let mut island = Island::of_body(torn(64, 64, lines(Quality::High)));
    let (mut sum, mut count) = (0.0, 0);
    run_with(&mut island, &gravity(FRAME), 1.0, |island, _| {
        let loose = strains(&island.bodies[0], |batch| batch.family().is_none());
        count = loose.len();
        sum += loose[count / 2];
    });
    let median = sum / 60.0;
    println!("law: median strain of {count} loose sticks: {median}");
    assert!(count > 100 && median < 0.003, "{median}");
}

/// Sticks pull both ends alike, also where lines share particles: a free, torn and tangled cloth keeps its momentum.
#[test]
fn torn_cloth_with_lines_keeps_its_momentum() {
    for (columns, rows) in SIZES {
        let mut body = torn(columns, rows, lines(Quality::High));
        for i in (0..body.particles.len()).filter(|&i| body.particles.is_pinned(i)).collect::<Vec<_>>() {
            body.particles.set_inverse_mass(i, 1000.0);
        }
        assert_tangle_keeps_momentum(body, &format!("{columns} x {rows}"));
    }
}

/// A torn sheet that swings gains no energy, whatever the number of substeps.
#[test]
fn torn_cloth_with_lines_gains_no_energy() {
    for (columns, rows) in [(40, 33), (20, 24)] {
        for substeps in [1, 2, 4, 8, 16] {
            for iterations in [1, 2] {
                let settings = BodySettings { substeps, iterations, ..lines(Quality::Medium) };
                let mut island = Island::of_body(torn(columns, rows, settings));
                let environment = Environment { gravity: Vec3::new(0.0, -5.0, 8.0), ..gravity(FRAME) };
                let energy =
                    |island: &Island| measure::mechanical_energy(&island.bodies[0], environment.gravity);
                let scale = measure::mass(particles(&island)) * f64::from(G);
                let start = energy(&island);
                run_with(&mut island, &environment, 3.0, |island, index| {
                    let gain = (energy(island) - start) / scale;
                    assert!(
                        gain < 1e-3,
                        "{columns}, {substeps} x {iterations}: {gain} m g L in step {index}"
                    );
                });
            }
        }
    }
}

/// The hash of a torn sheet that has swung for half a second.
pub fn hash_of_torn_sheet(columns: u32, rows: u32, isa: Isa) -> u64 {
    swung(columns, rows, isa, &|island, environment| step(island, environment).expect("a good step"))
}

fn swung(columns: u32, rows: u32, isa: Isa, take: &dyn Fn(&mut Island, &Environment)) -> u64 {
    let mut island = Island { isa, ..Island::of_body(torn(columns, rows, lines(Quality::Medium))) };
    let environment = Environment { gravity: Vec3::new(1.0, -5.0, 8.0), ..gravity(FRAME) };
    (0..30).for_each(|_| take(&mut island, &environment));
    hash(&island)
}

#[test]
fn torn_lines_move_to_the_same_bits_everywhere() {
    // Threads share the last one, which has more than 800 cells.
    for (columns, rows) in SIZES.into_iter().chain([(200, 70)]) {
        let expected = hash_of_torn_sheet(columns, rows, Isa::detected());
        for isa in Isa::available() {
            assert_eq!(hash_of_torn_sheet(columns, rows, isa), expected, "{columns} x {rows} on {isa:?}");
        }
        let shared = |island: &mut Island, environment: &Environment| {
            step_on(island, environment, &Fresh(3)).expect("a good step");
        };
        assert_eq!(swung(columns, rows, Isa::detected(), &shared), expected, "{columns} x {rows}");
        assert_eq!(swung(columns, rows, Isa::detected(), &step_staged), expected, "{columns} x {rows}");
    }
}
