//! Friction in bending: it holds a cloth up to a moment, and lets a fold keep a curvature.

use drape_solver::glam::Vec3;
use drape_solver::state::measure;
use drape_solver::{
    BendingFriction, BendingRigidity, Body, BodyContext, BodySettings, ClothBuilder, ClothMaterial,
    Environment, Isa, Island, MeshClothBuilder, Quality,
};

use crate::common::*;

const RIGIDITY: f32 = 1e-4;
const AREAL_DENSITY: f32 = 0.2;
const LENGTH: f32 = 0.2;

fn material(friction: f32) -> ClothMaterial {
    ClothMaterial {
        areal_density: AREAL_DENSITY,
        shear_stiffness: 0.3,
        bend_stiffness: 0.0,
        bending_rigidity: BendingRigidity::isotropic(RIGIDITY),
        bending_friction: BendingFriction::isotropic(friction),
        ..ClothMaterial::default()
    }
}

/// Strong drag, so that nothing swings.
fn settings() -> BodySettings {
    BodySettings { drag: 8.0, ..BodySettings::from(Quality::High) }
}

/// A level strip of this number of sticks along its rows. Its start is at the origin, its end at +X.
fn loose_strip(friction: f32, sticks: u32, rows: u32) -> ClothBuilder {
    let spacing = LENGTH / sticks as f32;
    ClothBuilder::new(LENGTH, (rows - 1) as f32 * spacing, sticks + 1, rows)
        .placed(Vec3::ZERO, Vec3::X, Vec3::Z)
        .material(material(friction))
}

/// The same, clamped at its start: its first two columns are pinned.
fn strip(friction: f32, sticks: u32, rows: u32) -> ClothBuilder {
    loose_strip(friction, sticks, rows).pin_where(|column, _, _| column < 2)
}

/// The same along the columns.
fn strip_of_columns(friction: f32, sticks: u32, columns: u32) -> ClothBuilder {
    let spacing = LENGTH / sticks as f32;
    ClothBuilder::new((columns - 1) as f32 * spacing, LENGTH, columns, sticks + 1)
        .placed(Vec3::ZERO, Vec3::Z, Vec3::X)
        .material(material(friction))
        .pin_where(|_, row, _| row < 2)
}

fn built(cloth: ClothBuilder) -> Body {
    cloth.build(settings()).expect("valid")
}

/// The same as a mesh.
fn meshed(cloth: ClothBuilder, friction: f32) -> Body {
    mesh_of(cloth, material(friction), settings())
}

/// Bends a strip of so many sticks to an arc of this curvature in 1/m, all at rest. Its sticks keep their length: each turns by the same
/// angle from the one before, the first of them is level.
fn bend(body: &mut Body, sticks: u32, curvature: f32) {
    let spacing = LENGTH / sticks as f32;
    let mut arc = vec![Vec3::ZERO];
    for stick in 0..sticks {
        let angle = curvature * spacing * stick as f32;
        arc.push(arc[stick as usize] + Vec3::new(angle.cos(), angle.sin(), 0.0) * spacing);
    }
    for i in 0..body.particles.len() {
        let rest = body.topology.rest_position(i);
        let place = arc[(rest.x / spacing).round() as usize];
        body.particles.set_position(i, place + Vec3::Z * rest.z);
        body.particles.set_velocity(i, Vec3::ZERO);
    }
}

/// A strip of so many sticks that was bent to one curvature, and has been opened to another, so that it is not let go at once: it would
/// whip, and bend further on the way (Audoly and Neukirch 2005).
fn opened(mut body: Body, sticks: u32, [bent, left]: [f32; 2]) -> Island {
    bend(&mut body, sticks, bent);
    let mut island = Island::of_body(body);
    run(&mut island, &weightless(1e-3), 1e-3);
    bend(&mut island.bodies[0], sticks, left);
    island
}

/// Has a body turn about its middle, in rad/s.
fn spin(body: &mut Body, spin: Vec3) {
    let centre = centre(body);
    for i in 0..body.particles.len() {
        let arm = body.particles.position(i) - centre;
        body.particles.set_velocity(i, spin.cross(arm));
    }
}

/// The mean curvature of the middle of a strip in 1/m, by the turn between the places at a quarter, at the middle and at three
/// quarters of its length.
fn curvature(body: &Body) -> f32 {
    let middle = |part: f32| {
        let near = |&i: &usize| (body.topology.rest_position(i).x - part * LENGTH).abs() < 1e-3 * LENGTH;
        let all: Vec<Vec3> =
            (0..body.particles.len()).filter(near).map(|i| body.particles.position(i)).collect();
        all.iter().sum::<Vec3>() / all.len() as f32
    };
    let [a, b, c] = [0.25, 0.5, 0.75].map(middle);
    // Menger's curvature of three points.
    let [ab, bc, ca] = [b - a, c - b, a - c];
    2.0 * ab.cross(bc).length() / (ab.length() * bc.length() * ca.length())
}

/// The curvature that is left without a load: friction has slipped on the way there, and perhaps on the way back.
fn expected(bent: f32, friction: f32) -> f32 {
    let slipped = bent - friction / (4.0 * RIGIDITY);
    (0.8 * slipped).min(friction / RIGIDITY)
}

/// A strip that was bent and is let go slowly keeps the curvature that friction can hold against its rigidity, in all finenesses.
#[test]
fn a_fold_keeps_the_curvature_that_friction_holds() {
    // Much friction, which keeps what has slipped, and little, which slips back.
    for (bent, friction) in [(10.0, 2e-3), (12.0, 2e-4)] {
        let expected = expected(bent, friction);
        for sticks in [8, 16, 32] {
            let bodies = [
                ("rows", built(strip(friction, sticks, 5)), 0.03),
                ("columns", built(strip_of_columns(friction, sticks, 5)), 0.03),
                ("patches", built(strip(friction, sticks, 16)), 0.03),
                ("patches of columns", built(strip_of_columns(friction, sticks, 48)), 0.03),
                ("a mesh", meshed(strip(friction, sticks, 5), friction), 0.2),
            ];
            for (name, body, tolerance) in bodies {
                let mut island = opened(body, sticks, [bent, 1.1 * expected]);
                run(&mut island, &weightless(FRAME), 8.0);
                let found = curvature(&island.bodies[0]);
                let subject = format!("curvature kept of {bent}/m, {friction} N, {sticks} sticks, {name}");
                law(&subject, found.into(), expected.into(), tolerance);
            }
        }
    }
}

/// Until friction slips, a cantilever droops as one of five times the rigidity: by `w L^4 / (8 B)`, where its slopes are small.
#[test]
fn friction_holds_a_cantilever_until_it_slips() {
    let gravity = 0.1;
    let droop = |rigidity: f32, friction: f32, sticks: u32| {
        let material =
            ClothMaterial { bending_rigidity: BendingRigidity::isotropic(rigidity), ..material(friction) };
        let mut island = Island::of_body(built(strip(friction, sticks, 5).material(material)));
        run(&mut island, &Environment { gravity: Vec3::NEG_Y * gravity, ..weightless(FRAME) }, 12.0);
        -particles(&island).position(3 * (sticks as usize + 1) - 1).y
    };
    for sticks in [8, 16, 32] {
        // The moment at the clamp is `w L^2 / 2`.
        let enough = AREAL_DENSITY * gravity * LENGTH * LENGTH;
        let [expected, found] = [droop(5.0 * RIGIDITY, 0.0, sticks), droop(RIGIDITY, enough, sticks)];
        law(&format!("droop with friction, {sticks} sticks"), found.into(), expected.into(), 0.01);
        let slack = droop(RIGIDITY, 0.0, sticks);
        assert!(slack > 4.0 * found, "it droops by {slack} m without friction, and by {found} m with it");
    }
}

/// The state of friction turns with the body: a folded strip that floats through half a turn keeps its fold.
#[test]
fn a_fold_turns_with_the_body() {
    let friction = 2e-3;
    for (is_mesh, tolerance) in [(false, 0.03), (true, 0.2)] {
        let cloth = loose_strip(friction, 16, 16);
        let mut body = if is_mesh { meshed(cloth, friction) } else { built(cloth) };
        body.settings.drag = 0.0;
        let mut island = opened(body, 16, [10.0, 4.0]);
        // So slow that nothing of the fold is drawn out of it.
        spin(&mut island.bodies[0], Vec3::new(0.2, 0.2, 0.1));
        run(&mut island, &weightless(FRAME), 10.0);
        let found = curvature(&island.bodies[0]);
        law("curvature kept through half a turn", found.into(), 4.0, tolerance);
    }
}

/// Friction slips in each substep: a strip that falls droops as far in long steps as in short ones of the same substeps.
#[test]
fn friction_slips_alike_in_steps_of_any_length() {
    let friction = 1e-2;
    for is_mesh in [false, true] {
        let droop = |dt: f32, substeps: u32| {
            let cloth = strip(friction, 16, 16);
            let mut body = if is_mesh { meshed(cloth, friction) } else { built(cloth) };
            body.settings = BodySettings { drag: 2.0, substeps, ..body.settings };
            let mut island = Island::of_body(body);
            run(&mut island, &gravity(dt), 3.0);
            let particles = particles(&island);
            let lowest = particles.positions().map(|place| -place.y).fold(0.0, f32::max);
            f64::from(lowest)
        };
        let [short, long] = [droop(FRAME, 16), droop(8.0 * FRAME, 128)];
        law(&format!("droop in long steps, a mesh: {is_mesh}"), long, short, 5e-3);
    }
}

/// Bends do not turn the body: a ring of a stiff mesh, curved at rest, and a fold that friction holds in a stiff strip keep their angular
/// momentum. Rests are those of a substep before, and brake a body unless they are turned with it.
#[test]
fn stiff_curves_spin_on() {
    let stiff = ClothMaterial {
        bending_rigidity: BendingRigidity::isotropic(2e-3),
        bending_friction: BendingFriction::isotropic(0.0),
        ..material(0.0)
    };
    let (around, radius) = (24, 0.05_f32);
    let vertex = |i: u32| {
        let angle = (i % around) as f32 / around as f32 * core::f32::consts::TAU;
        Vec3::new(angle.cos() * radius, angle.sin() * radius, (i / around) as f32 * 0.013)
    };
    let faces = (0..4 * around).flat_map(|i| {
        let [a, b] = [i, i / around * around + (i + 1) % around];
        [[a, b, a + around], [b, b + around, a + around]]
    });
    let ring = MeshClothBuilder::new((0..5 * around).map(vertex).collect(), faces.collect());
    let ring = ring.material(stiff).build(BodySettings::default()).expect("valid");

    let held = ClothMaterial { bending_friction: BendingFriction::isotropic(3e-2), ..stiff };
    let mut fold = built(loose_strip(0.0, 16, 16).material(held));
    bend(&mut fold, 16, 15.0);
    for (name, mut body) in [("a ring", ring), ("a fold", fold)] {
        body.settings = BodySettings { drag: 0.0, ..BodySettings::default() };
        let mut island = Island::of_body(body);
        // The fold finds its shape.
        run(&mut island, &weightless(FRAME), 0.5);
        spin(&mut island.bodies[0], Vec3::Z * core::f32::consts::TAU);
        let start = measure::angular_momentum(particles(&island)).length();
        run(&mut island, &weightless(FRAME), 1.0);
        let end = measure::angular_momentum(particles(&island)).length();
        law(&format!("angular momentum of {name}"), end, start, 0.15);
    }
}

/// A cut leaves folds as they are on both of its sides.
#[test]
fn a_cut_strip_keeps_its_fold() {
    let friction = 2e-3;
    for (is_mesh, tolerance) in [(false, 0.05), (true, 0.2)] {
        let cloth = strip(friction, 16, 16);
        let body = if is_mesh { meshed(cloth, friction) } else { built(cloth) };
        let mut island = opened(body, 16, [10.0, 4.0]);
        run(&mut island, &weightless(FRAME), 0.5);
        // Along the strip, near one of its sides, and not through the end.
        let [from, to] = [Vec3::new(-1.0, 0.0, 0.056), Vec3::new(1.0, 0.0, 0.056)];
        let blade = wide_blade(from, to, Vec3::Y);
        let cut = island.bodies[0].cut(&blade).expect("can be cut");
        let pieces = cut.expect("the blade must meet the cloth").pieces;
        island.bodies.extend(pieces.into_iter().map(|piece| piece.body));
        run(&mut island, &weightless(FRAME), 6.0);
        for body in &island.bodies {
            let found = curvature(body);
            law(
                &format!("curvature kept of {} particles", body.particles.len()),
                found.into(),
                4.0,
                tolerance,
            );
        }
    }
}

/// The hash of a cut grid and of a mesh in which friction has slipped.
pub fn hash_of_folds(isa: Isa) -> u64 {
    let cloth = ClothBuilder::new(0.5, 0.4, 40, 33)
        .placed(Vec3::ZERO, Vec3::X, Vec3::Z)
        .material(material(1e-4))
        .pin(0);
    let mut cut = built(cloth.clone());
    let [from, to] = [Vec3::new(0.1, 0.0, 0.17), Vec3::new(0.33, 0.0, 0.18)];
    let blade = wide_blade(from, to, Vec3::Y);
    assert!(cut.cut(&blade).expect("can be cut").is_some(), "the blade must meet the cloth");
    let mut island = Island { isa, ..Island::of_body(cut) };
    island.bodies.push(meshed(cloth, 1e-4));
    run(&mut island, &gravity(FRAME), 0.5);
    hash(&island)
}

/// Steps of cloths with friction have the same bits on all instruction sets, at once and stage by stage, and from a snapshot on.
#[test]
fn friction_has_the_same_bits_on_all() {
    assert_same_on_all(|isa, step| {
        let mut hashes = Vec::new();
        // In patches side by side, in a square and above each other, too small for patches, renumbered, and of more than a block.
        for (columns, rows) in [(33, 9), (17, 16), (6, 5), (3, 48), (32, 8), (40, 33)] {
            let grid = ClothBuilder::new(0.5, 0.4, columns, rows)
                .placed(Vec3::ZERO, Vec3::X, Vec3::Z)
                .material(material(1e-4))
                .pin(0);
            for body in [built(grid.clone()), meshed(grid.clone(), 1e-4)] {
                let mut island = Island::of_body(body);
                island.isa = isa;
                (0..20).for_each(|_| step(&mut island, &gravity(FRAME)));
                let mut other = island.clone();
                other.bodies[0].particles = built(grid.clone()).particles;
                other.bodies[0].context = BodyContext::default();
                let snapshot = island.bodies[0].particles.snapshot();
                other.bodies[0].particles.restore(&snapshot).expect("of the same cloth");
                for island in [&mut island, &mut other] {
                    (0..10).for_each(|_| step(island, &gravity(FRAME)));
                }
                assert_eq!(hash(&other), hash(&island), "{columns} x {rows}: it goes on from a snapshot");
                hashes.push(hash(&island));
            }
        }
        hashes
    });
}
