//! Stretch and shear in newtons per metre: a cloth gives way as a laboratory measures it.

use std::sync::Arc;

use drape_solver::glam::{Vec2, Vec3};
use drape_solver::state::measure;
use drape_solver::{
    BendingRigidity, Body, BodySettings, ClothBuilder, ClothMaterial, Environment, Isa, Island,
    MembraneStiffness, Particles, Quality, Shape, StickKind, StickMaterial, TopologyBuilder,
};

use crate::common::*;

const AREAL_DENSITY: f32 = 0.2;

/// Cloth that resists in its plane by this stiffness alone.
fn cloth(stiffness: MembraneStiffness) -> ClothMaterial {
    ClothMaterial {
        areal_density: AREAL_DENSITY,
        shear_stiffness: 0.0,
        bend_stiffness: 0.0,
        membrane_stiffness: stiffness,
        ..ClothMaterial::default()
    }
}

/// Strong drag, so that nothing swings.
fn settings(quality: Quality) -> BodySettings {
    BodySettings { drag: 20.0, ..BodySettings::from(quality) }
}

/// A specimen of `width` x `height` metres that is held by its first row. A weight is fixed to its last row, which gravity pulls by a
/// force for each metre of width (N/m).
struct Specimen {
    size: [f32; 2],
    particles: [u32; 2],
    load: Vec3,
}

impl Specimen {
    fn build(&self, material: ClothMaterial, settings: BodySettings) -> Body {
        let ([width, height], [columns, rows]) = (self.size, self.particles);
        let cloth = ClothBuilder::new(width, height, columns, rows).material(material);
        let mut body = cloth.pin_where(|_, row, _| row == 0).build(settings).expect("valid");
        for column in 0..columns {
            let share = if column == 0 || column + 1 == columns { 0.5 } else { 1.0 };
            let mass = self.load.length() * width / G * share / (columns - 1) as f32;
            body.particles.set_inverse_mass(self.index(column, rows - 1), mass.recip());
        }
        body
    }

    fn index(&self, column: u32, row: u32) -> usize {
        (row * self.particles[0] + column) as usize
    }

    /// The specimen after ten seconds under the load: at rest.
    fn at_rest(&self, body: Body) -> Island {
        let mut island = Island::of_body(body);
        let gravity = self.load.normalize() * G;
        run(&mut island, &Environment { dt: FRAME, gravity, ..Environment::default() }, 10.0);
        island
    }

    /// The mean place of each row, when all is at rest.
    fn rows(&self, material: ClothMaterial, settings: BodySettings) -> Vec<Vec3> {
        let island = self.at_rest(self.build(material, settings));
        let [columns, rows] = self.particles;
        let place = |column: u32, row: u32| island.bodies[0].particles.position(self.index(column, row));
        let mean = |row| (0..columns).map(|column| place(column, row)).sum::<Vec3>() / columns as f32;
        (0..rows).map(mean).collect()
    }

    /// The shear (sine of the angle) of the last squares at rest. The sides are held as bars that lean by the given sine, the last
    /// row is a bar between them that starts upright below the row before, and that the load pulls along.
    fn shear_in_frame(&self, material: ClothMaterial, settings: BodySettings, lean: f32) -> f32 {
        let [columns, rows] = self.particles;
        let mut body = self.build(material, settings);
        let down = Vec3::new(lean, -(1.0 - lean * lean).sqrt(), 0.0);
        for i in 0..self.index(0, rows - 1) {
            let at = body.particles.position(i);
            body.particles.set_position(i, at.with_y(0.0) - at.y * down);
        }
        for column in 0..columns {
            let above = body.particles.position(self.index(column, rows - 2));
            let upright = above + Vec3::NEG_Y * self.size[1] / (rows - 1) as f32;
            body.particles.set_position(self.index(column, rows - 1), upright);
        }
        for i in (0..rows - 1).flat_map(|row| [self.index(0, row), self.index(columns - 1, row)]) {
            body.particles.set_inverse_mass(i, 0.0);
        }
        let island = self.at_rest(body);
        let place = |row| island.bodies[0].particles.position(self.index(columns / 2, row));
        (place(rows - 1) - place(rows - 2)).normalize().x
    }

    /// The mean force for each metre that its own weight adds to the load.
    fn own_load(&self) -> f32 {
        let rows = self.particles[1];
        // The first row is held, and the last one has the mass of the load.
        let of_row = AREAL_DENSITY * G * self.size[1] / (rows - 1) as f32;
        0.5 * of_row * (rows - 2) as f32
    }
}

/// The strain of a strip of 20 cm with these rows.
fn strain(rows: &[Vec3]) -> f32 {
    (rows[0].y - rows[rows.len() - 1].y) / 0.2 - 1.0
}

/// A strip stretches by load over stiffness and width, whatever its fineness and the number of substeps, by loads of up to 5 kg on 4 g.
#[test]
fn a_hanging_strip_stretches_by_its_load() {
    for particles in [[5, 9], [11, 21], [33, 65]] {
        for quality in [Quality::Low, Quality::Medium, Quality::High] {
            for stiffness in [100.0, 1e3, 1e4] {
                let strip = Specimen { size: [0.1, 0.2], particles, load: Vec3::NEG_Y * (0.05 * stiffness) };
                let membrane = MembraneStiffness { warp: stiffness, weft: 2.0 * stiffness, shear: 0.0 };
                let rows = strip.rows(cloth(membrane), settings(quality));
                let expected = 0.05 + strip.own_load() / stiffness;
                let subject = format!("stretch at {stiffness} N/m, {particles:?}, {quality:?}");
                law(&subject, strain(&rows).into(), expected.into(), 0.02);
            }
        }
    }
}

/// The diagonals that resist shear resist tension too, and make a strip narrower: its stretch is that of the tension all the same.
#[test]
fn a_strip_that_resists_shear_stretches_by_its_load() {
    let strip = Specimen { size: [0.08, 0.4], particles: [9, 41], load: Vec3::NEG_Y * 5.0 };
    let membrane = MembraneStiffness { warp: 100.0, weft: 80.0, shear: 30.0 };
    let rows = strip.rows(cloth(membrane), BodySettings { substeps: 32, ..settings(Quality::High) });
    // Away from both ends, which hold the width.
    let [from, to] = [rows.len() / 4, rows.len() * 3 / 4];
    let strain = (rows[from].y - rows[to].y) / 0.2 - 1.0;
    law("stretch with a shear stiffness", strain.into(), 0.05 + f64::from(strip.own_load()) / 100.0, 0.03);
}

/// The shear tester of the KES system: a strip of 20 cm x 5 cm is sheared along its long sides.
#[test]
fn a_sheared_strip_turns_by_its_load() {
    let many = BodySettings { substeps: 64, ..settings(Quality::High) };
    for (shear, settings) in [(5.0, settings(Quality::High)), (50.0, many)] {
        for particles in [[9, 3], [17, 5], [33, 9]] {
            let strip = Specimen { size: [0.2, 0.05], particles, load: Vec3::X * (0.05 * shear) };
            let membrane = MembraneStiffness { warp: 1e5, weft: 1e5, shear };
            let rows = strip.rows(cloth(membrane), settings);
            let way = rows[rows.len() - 1] - rows[0];
            let expected = 0.05 + strip.own_load() / shear;
            let subject = format!("shear at {shear} N/m, {particles:?}");
            law(&subject, (way.x / -way.y).into(), expected.into(), 0.05);
        }
    }
}

/// The picture frame: bars clamp all edges of a square. Two of them are held as they lean under a load, and the shear of the cloth
/// holds the bar between them, which the load pulls, where the frame would have it.
#[test]
fn a_sheared_frame_leans_by_its_load() {
    for lean in [0.05, 0.1] {
        for shear in [5.0, 50.0, 500.0] {
            for particles in [[9, 9], [17, 17], [33, 33]] {
                let frame = Specimen { size: [0.2, 0.2], particles, load: Vec3::X * (lean * shear) };
                let membrane = MembraneStiffness { warp: 1e5, weft: 1e5, shear };
                let measured = frame.shear_in_frame(cloth(membrane), settings(Quality::High), lean);
                let subject = format!("shear in a frame at {shear} N/m, {particles:?}");
                law(&subject, measured.into(), lean.into(), 0.03);
            }
        }
    }
}

/// A sheet that was thrown with a shear and a stretch in it keeps its momentum and gains no energy.
#[test]
fn a_free_elastic_sheet_keeps_its_momentum_and_gains_no_energy() {
    let kinds = [([26, 21], false), ([26, 21], true), ([6, 5], true), ([50, 5], true)];
    for (([columns, rows], is_slit), stiffness) in each_with(kinds, [20.0, 2e3, 2e5]) {
        for quality in [Quality::Low, Quality::Medium, Quality::High] {
            let sheet = ClothBuilder::new(0.5, 0.4, columns, rows)
                .material(cloth(MembraneStiffness::balanced(stiffness, 0.1 * stiffness)));
            let mut body = sheet.build(BodySettings { drag: 0.0, ..settings(quality) }).expect("valid");
            if is_slit {
                let [from, to] = [Vec3::new(-1.0, -0.11, 0.0), Vec3::new(0.24, -0.2, 0.0)];
                body.cut(&wide_blade(from, to, Vec3::Z)).expect("can be cut").expect("is slit");
            }
            for i in 0..body.particles.len() {
                let p = body.particles.position(i);
                body.particles.set_velocity(i, Vec3::new(0.3 + p.y, p.x * 4.0, (p.x * p.y * 40.0).min(3.0)));
            }
            let kinetic = |body: &Body| measure::kinetic_energy(&body.particles);
            let (momentum, energy) = (measure::momentum(&body.particles), kinetic(&body));
            let mut island = Island::of_body(body);
            run_with(&mut island, &weightless(FRAME), 2.0, |island, index| {
                let body = &island.bodies[0];
                let lost = (measure::momentum(&body.particles) - momentum).length() / momentum.length();
                assert!(lost < 1e-4, "{stiffness}: {lost} of the momentum at step {index}");
                assert!(kinetic(body) < energy * 1.001, "{stiffness} {quality:?}: step {index}");
            });
        }
    }
}

/// A tolerance ends the iterations of a quiet cloth at once. A membrane is solved in the last of them.
#[test]
fn a_tolerance_leaves_a_membrane_as_it_is() {
    let settings = BodySettings { iterations: 8, tolerance: 0.2, ..settings(Quality::Medium) };
    let strip = Specimen { size: [0.1, 0.2], particles: [11, 21], load: Vec3::NEG_Y * 5.0 };
    let rows = strip.rows(cloth(MembraneStiffness::balanced(100.0, 0.0)), settings);
    law("stretch with a tolerance", strain(&rows).into(), 0.05 + f64::from(strip.own_load()) / 100.0, 0.02);
}

/// Steps of elastic cloths that also bend and lie on things have the same bits on all instruction sets, at once and stage by stage. Stage
/// by stage, lines of a membrane were solved in the first iteration in place of the last.
#[test]
fn a_membrane_has_the_same_bits_on_all() {
    assert_same_on_all(|isa, step| {
        let mut hashes = Vec::new();
        let ground = obstacle(Shape::HalfSpace { normal: Vec3::Y }, Vec3::NEG_Y * 0.01, 0.5);
        let environment = Environment { obstacles: vec![ground].into(), ..gravity(FRAME) };
        for (columns, rows) in [(33, 9), (17, 16), (6, 5), (3, 40), (32, 8), (48, 33), (2, 2), (2, 9), (9, 2)]
        {
            for (tension, shear) in [(30.0, 5.0), (3e4, 5.0), (0.0, 5.0)] {
                let material = ClothMaterial {
                    bend_stiffness: 0.1,
                    bending_rigidity: BendingRigidity::isotropic(1e-5),
                    ..cloth(MembraneStiffness::balanced(tension, shear))
                };
                let cloth = ClothBuilder::new(0.02 * columns as f32, 0.02 * rows as f32, columns, rows)
                    .placed(Vec3::ZERO, Vec3::X, Vec3::Z)
                    .material(material)
                    .pin(0)
                    .pin(columns - 1);
                let settings = BodySettings { iterations: 3, ..BodySettings::default() };
                let mut island = Island::of_body(cloth.build(settings).expect("valid"));
                island.isa = isa;
                (0..20).for_each(|_| step(&mut island, &environment));
                hashes.push(hash(&island));
            }
        }
        hashes.push(hash_of_elastic_sheet(isa));
        hashes
    });
}

/// The end of a level elastic sheet that is held by its first column and a corner, and is slit after a while: its lines are taut.
pub fn hash_of_elastic_sheet(isa: Isa) -> u64 {
    let sheet = ClothBuilder::new(0.5, 0.4, 48, 33)
        .placed(Vec3::ZERO, Vec3::X, Vec3::Z)
        .material(cloth(MembraneStiffness::balanced(3e4, 5.0)))
        .pin_where(|column, row, _| column == 0 || (column, row) == (47, 32));
    let mut island = Island::of_body(sheet.build(BodySettings::from(Quality::High)).expect("valid"));
    island.isa = isa;
    run(&mut island, &gravity(FRAME), 0.1);
    let way = [Vec3::new(0.6, 0.0, 0.2), Vec3::new(0.25, 0.0, 0.13)];
    let parted = island.bodies[0].cut(&wide_blade(way[0], way[1], Vec3::Y)).expect("can be cut");
    assert!(parted.is_some_and(|parted| parted.pieces.is_empty()));
    run(&mut island, &gravity(FRAME), 0.9);
    hash(&island)
}

/// A cut gave an elastic cloth tethers, which pulled it back to its length at rest.
#[test]
fn a_cut_strip_stays_stretched() {
    let strip = Specimen { size: [0.1, 0.2], particles: [17, 33], load: Vec3::NEG_Y * 10.0 };
    let body = strip.build(cloth(MembraneStiffness::balanced(50.0, 0.0)), settings(Quality::High));
    let mut island = Island::of_body(body);
    run(&mut island, &gravity(FRAME), 6.0);
    let lowest = |island: &Island| island.bodies[0].particles.positions().map(|p| p.y).fold(0.0, f32::min);
    let before = lowest(&island);
    assert!(before < -0.23, "{before} m");
    // A stroke from one side to a quarter of the width.
    let [from, to] = [Vec3::new(-1.0, -0.1, 0.0), Vec3::new(0.025, -0.1, 0.0)];
    island.bodies[0].cut(&wide_blade(from, to, Vec3::Z)).expect("can be cut");
    run(&mut island, &gravity(FRAME), 2.0);
    assert!(lowest(&island) < before + 1e-3, "from {before} m to {} m", lowest(&island));
}

/// Heavy loads made a strip that resists shear shake, and it gave way: diagonals and columns, which move the same particles to and fro, gained
/// energy from each other.
#[test]
fn a_strip_that_resists_shear_bears_heavy_loads() {
    for (particles, shear) in each_with([[6, 9], [11, 21]], [20.0, 200.0]) {
        for load in [100.0, 200.0, 500.0] {
            let strip = Specimen { size: [0.1, 0.2], particles, load: Vec3::NEG_Y * load };
            let membrane = MembraneStiffness { warp: 1e4, weft: 2e4, shear };
            let rows = strip.rows(cloth(membrane), settings(Quality::Medium));
            let expected = (load + strip.own_load()) / 1e4;
            law(
                &format!("stretch by {load} N/m, {particles:?}"),
                strain(&rows).into(),
                expected.into(),
                0.05,
            );
        }
    }
}

/// Slits along a strip take none of its strength, so it stretches as it did, and so does each part if it is cut in two. Torn cloth forgot its
/// constants, and hung on sticks that sweeps relax: soft ones.
#[test]
fn a_strip_that_is_slit_lengthwise_stretches_by_its_load() {
    for (particles, quality) in each_with([[6, 9], [11, 21], [33, 65]], [Quality::Medium, Quality::High]) {
        // Slits along a column and between two; then two cuts through the whole strip.
        let spacing = 0.1 / (particles[0] - 1) as f32;
        let column = (0.02 / spacing).round();
        for (from, columns) in [(-0.05, column), (-0.05, column + 0.15), (0.01, column), (0.01, column + 0.4)]
        {
            let at = columns * spacing;
            let strip = Specimen { size: [0.1, 0.2], particles, load: Vec3::NEG_Y * 2.5 };
            let membrane = MembraneStiffness { warp: 50.0, weft: 100.0, shear: 1.0 };
            let mut body = strip.build(cloth(membrane), settings(quality));
            let blade = wide_blade(Vec3::new(at, from, 0.0), Vec3::new(at, -1.0, 0.0), Vec3::Z);
            let parted = body.cut(&blade).expect("can be cut").expect("is cut");
            assert_eq!(parted.pieces.len(), usize::from(from > 0.0));
            for body in core::iter::once(body).chain(parted.pieces.into_iter().map(|piece| piece.body)) {
                let island = strip.at_rest(body);
                let strain = -mean_height_of_last_row(&island.bodies[0], 0.2) / 0.2 - 1.0;
                let expected = (2.5 + strip.own_load()) / 50.0;
                let subject =
                    format!("stretch with a slit from {from} m at {columns}, {particles:?}, {quality:?}");
                // A piece of one and a half squares is pulled askew.
                let tolerance = if particles[0] == 6 { 0.1 } else { 0.015 };
                law(&subject, strain.into(), expected.into(), tolerance);
            }
        }
    }
}

/// The mean height of the particles that are so far below at rest, by their masses.
fn mean_height_of_last_row(body: &Body, below: f32) -> f32 {
    let last = (0..body.particles.len()).filter(|&i| body.topology.rest_position(i).y < 1e-4 - below);
    let moments = last.map(|i| Vec2::new(body.particles.position(i).y, 1.0) / body.particles.inverse_mass(i));
    let sum: Vec2 = moments.sum();
    sum.x / sum.y
}

/// Diagonals that are structural sticks are swept, as ever: lines had no room for them, and panicked.
#[test]
fn structural_diagonals_are_swept() {
    let places: Vec<Vec3> =
        (0..256).map(|i| Vec3::new((i % 16) as f32, (i / 16) as f32, 0.0) * 0.1).collect();
    let mut builder = TopologyBuilder::grid(&places, 16, 16).expect("a grid");
    for way in [[1, 0], [0, 1], [1, 1]] {
        builder.grid_family(StickMaterial::rigid(StickKind::Structural), way).expect("valid");
    }
    let particles = Particles::new(Vec3::ZERO, &places, &[1.0; 256]).expect("valid");
    let topology = Arc::new(builder.build().expect("valid"));
    let mut island = Island::of_body(Body::new(particles, topology, BodySettings::from(Quality::High)));
    run(&mut island, &gravity(FRAME), 0.1);
    assert!(stretch(&island).rms < 1e-3);
}
