//! Bending in units: a cloth of some rigidity shows what a textile laboratory measures on a fabric of that rigidity.

use drape_solver::drape_test::{bending_length, bending_length_of, round_drape_coefficient};
use drape_solver::glam::Vec3;
use drape_solver::state::measure;
use drape_solver::{
    BendingRigidity, Body, BodySettings, ClothBuilder, ClothMaterial, Island, MeasuredFabric,
    MeshClothBuilder, Quality,
};

use crate::common::*;

const AREAL_DENSITY: f32 = 0.2;

/// Cloth that resists bending by its rigidity alone.
fn limp(rigidity: BendingRigidity) -> ClothMaterial {
    ClothMaterial {
        areal_density: AREAL_DENSITY,
        shear_stiffness: 0.3,
        bend_stiffness: 0.0,
        bending_rigidity: rigidity,
        ..ClothMaterial::default()
    }
}

/// Strong drag, so that nothing swings.
fn settings(quality: Quality) -> BodySettings {
    BodySettings { drag: 8.0, ..BodySettings::from(quality) }
}

/// A strip of 5 x `2 sticks + 1` particles that lies across a support and hangs down on both sides by `overhang` metres, so that it is
/// level in the middle. Its middle is at the origin, its long side along X.
fn strip(rigidity: f32, overhang: f32, sticks: u32) -> ClothBuilder {
    let spacing = overhang / sticks as f32;
    ClothBuilder::new(2.0 * overhang, 4.0 * spacing, 2 * sticks + 1, 5)
        .placed(Vec3::new(-overhang, 0.0, -2.0 * spacing), Vec3::X, Vec3::Z)
        .material(limp(BendingRigidity { warp: 0.0, weft: rigidity }))
        .pin_where(move |column, _, _| column == sticks)
}

/// Peirce's bending length in metres, of a strip across a support or a mesh of it.
fn length_of(body: Body, overhang: f32) -> f32 {
    let mut island = Island::of_body(body);
    run(&mut island, &gravity(FRAME), 6.0);
    let body = &island.bodies[0];
    let off = |i: &usize| body.topology.rest_position(*i).distance(Vec3::X * overhang);
    let end = (0..body.particles.len()).min_by(|i, j| off(i).total_cmp(&off(j))).expect("it has particles");
    bending_length_of(overhang, body.particles.position(end))
}

/// The bending length that follows from rigidity and weight.
fn expected_length(rigidity: f32) -> f32 {
    (rigidity / (AREAL_DENSITY * G)).cbrt()
}

/// Peirce's cantilever: the bending length is the cube root of rigidity over weight, in all finenesses and at all qualities.
#[test]
fn a_cantilever_has_peirces_bending_length() {
    for rigidity in [1e-5, 1e-4, 1e-3] {
        let expected = expected_length(rigidity);
        for (quality, sticks) in [Quality::Medium, Quality::High].into_iter().zip([[8, 12, 16], [8, 16, 32]])
        {
            for sticks in sticks {
                let material = limp(BendingRigidity { warp: 0.0, weft: rigidity });
                let found = bending_length(material, settings(quality), expected, sticks).expect("valid");
                let subject = format!("bending length at {rigidity} N m, {sticks} sticks, {quality:?}");
                law(&subject, found.into(), expected.into(), 0.05);
            }
        }
    }
}

/// The same of a mesh, where its edges are some centimetres long. Where four and eight triangles meet in turn, as here, a mesh yields
/// a little: its rigidity is 5/6, and its length 0.94.
#[test]
fn a_cantilever_of_a_mesh_has_peirces_bending_length() {
    for (rigidity, finenesses) in [(1e-4, [5, 6, 8]), (1e-3, [6, 8, 12])] {
        let expected = expected_length(rigidity);
        for sticks in finenesses {
            let material = limp(BendingRigidity::isotropic(rigidity));
            let body = mesh_of(strip(rigidity, 2.0 * expected, sticks), material, settings(Quality::High));
            let found = length_of(body, 2.0 * expected);
            law(
                &format!("bending length of a mesh at {rigidity} N m, {sticks} sticks"),
                found.into(),
                expected.into(),
                0.08,
            );
        }
    }
}

/// A sheet that is cut in two keeps the rigidity of what is left.
#[test]
fn a_cut_strip_droops_as_before() {
    let (rigidity, sticks) = (1e-4, 8);
    let overhang = 2.0 * expected_length(rigidity);
    let build = || {
        let spacing = overhang / sticks as f32;
        ClothBuilder::new(2.0 * overhang, 15.0 * spacing, 2 * sticks + 1, 16)
            .placed(Vec3::new(-overhang, 0.0, -2.0 * spacing), Vec3::X, Vec3::Z)
            .material(limp(BendingRigidity::isotropic(rigidity)))
            .pin_where(move |column, _, _| column == sticks)
            .build(settings(Quality::High))
            .expect("valid")
    };
    let whole = length_of(build(), overhang);
    let mut cut = build();
    // Along the strip, beyond its middle.
    let [from, to] = [Vec3::new(-1.0, 0.0, 0.05), Vec3::new(1.0, 0.0, 0.05)];
    let blade = wide_blade(from, to, Vec3::Y);
    assert!(cut.cut(&blade).expect("can be cut").is_some(), "the blade must meet the cloth");
    let cut = length_of(cut, overhang);
    law("bending length of a cut cloth", cut.into(), whole.into(), 0.05);
}

/// A crumpled board flies on with its momentum, turns with its angular momentum, and gains no energy.
#[test]
fn a_free_stiff_sheet_keeps_its_momentum_and_gains_no_energy() {
    let sheet = |rigidity: f32| {
        ClothBuilder::new(0.5, 0.4, 26, 21)
            .material(limp(BendingRigidity::isotropic(rigidity)))
            .build(BodySettings { drag: 0.0, ..BodySettings::from(Quality::High) })
            .expect("valid")
    };
    for rigidity in [0.0, 1e-5, 1e-3, 0.1] {
        let grid = sheet(rigidity);
        let strip = ClothBuilder::new(0.5, 0.4, 26, 21);
        let mesh = mesh_of(strip, limp(BendingRigidity::isotropic(rigidity)), grid.settings);
        for mut body in [grid, mesh] {
            for i in 0..body.particles.len() {
                let p = body.particles.position(i);
                body.particles.set_velocity(i, Vec3::new(0.3, p.x * 4.0, (p.x * p.y * 40.0).min(3.0)));
            }
            let kinetic = |body: &Body| measure::kinetic_energy(&body.particles);
            let (momentum, energy) = (measure::momentum(&body.particles), kinetic(&body));
            let angular = measure::angular_momentum(&body.particles);
            let mut island = Island::of_body(body);
            run_with(&mut island, &weightless(FRAME), 2.0, |island, index| {
                let body = &island.bodies[0];
                let lost = (measure::momentum(&body.particles) - momentum).length() / momentum.length();
                assert!(lost < 1e-4, "{rigidity}: {lost} of the momentum at step {index}");
                let turned = measure::angular_momentum(&body.particles) - angular;
                let turned = turned.length() / angular.length();
                // Limp cloth that turns loses 4 % in these two seconds.
                assert!(turned < 6e-2, "{rigidity}: {turned} of the angular momentum at step {index}");
                assert!(kinetic(body) < energy * 1.001, "{rigidity}: step {index}");
            });
        }
    }
}

/// Warp and weft resist each by itself: a strip along the columns has the bending length of the warp.
#[test]
fn warp_and_weft_have_their_own_rigidity() {
    let expected = expected_length(1e-4);
    let (overhang, sticks) = (2.0 * expected, 8);
    let along_rows = |warp: f32, weft: f32| {
        let strip = strip(weft, overhang, sticks).material(limp(BendingRigidity { warp, weft }));
        length_of(strip.build(settings(Quality::High)).expect("valid"), overhang)
    };
    // In patches side by side, so that columns are solved in place, and in lanes gathered from them.
    for columns in [48, 5] {
        let spacing = overhang / sticks as f32;
        let width = spacing * (columns - 1) as f32;
        let strip = ClothBuilder::new(width, 2.0 * overhang, columns, 2 * sticks + 1)
            .placed(Vec3::new(-overhang, 0.0, 0.5 * width), Vec3::NEG_Z, Vec3::X)
            .material(limp(BendingRigidity { warp: 1e-4, weft: 0.0 }))
            .pin_where(move |_, row, _| row == sticks);
        let found = length_of(strip.build(settings(Quality::High)).expect("valid"), overhang);
        law(&format!("bending length along {columns} columns"), found.into(), expected.into(), 0.05);
    }
    let [weft, warp] = [along_rows(0.0, 1e-4), along_rows(1e-4, 0.0)];
    assert!(warp < 0.3 * weft, "rows run along the strip: {warp} m without weft, {weft} m with it");
}

/// The grid of 32 x 8 is too small for patches, and its particles are renumbered: it had no bends at all.
#[test]
fn a_renumbered_grid_resists_bending() {
    let end = |rigidity: f32| {
        let cloth = ClothBuilder::new(0.31, 0.07, 32, 8)
            .placed(Vec3::ZERO, Vec3::X, Vec3::Z)
            .material(limp(BendingRigidity::isotropic(rigidity)))
            .pin_where(|column, _, _| column < 2);
        let mut island = Island::of_body(cloth.build(settings(Quality::High)).expect("valid"));
        run(&mut island, &gravity(FRAME), 4.0);
        island.bodies[0].particles.position(31).y
    };
    let [limp, stiff] = [end(0.0), end(1e-2)];
    assert!(limp < -0.25 && stiff > -0.2, "{limp} m without rigidity, {stiff} m with it");
}

/// A tolerance ends the iterations of a quiet cloth at once, and it is bent in the last of them: it went limp.
#[test]
fn a_tolerance_leaves_rigidity_as_it_is() {
    let expected = expected_length(1e-4);
    let settings = BodySettings { iterations: 8, tolerance: 0.05, ..settings(Quality::Medium) };
    let material = limp(BendingRigidity::isotropic(1e-4));
    let found = bending_length(material, settings, expected, 8).expect("valid");
    law("bending length with a tolerance", found.into(), expected.into(), 0.05);
}

/// A curved mesh that is pressed flat is pushed out of the plane, and not about in it: where a bend is nearly flat, the direction of
/// its weighted sum is noise.
#[test]
fn a_curved_mesh_pressed_flat_stays_where_it_is() {
    let side = 9;
    let place = |i: u32| Vec3::new((i % side) as f32 * 0.05, 0.0, (i / side) as f32 * 0.05);
    let curved: Vec<Vec3> =
        (0..side * side).map(|i| place(i).with_y(2.0 * (place(i).x - 0.2).powi(2))).collect();
    let faces = (0..side - 1).flat_map(|row| (0..side - 1).map(move |column| row * side + column));
    let faces = faces.flat_map(|a| [[a, a + side, a + 1], [a + 1, a + side, a + side + 1]]).collect();
    // Slack sticks, so that only bends act.
    let material = ClothMaterial { stretch_stiffness: 0.0, ..limp(BendingRigidity::isotropic(1e-3)) };
    let mesh = MeshClothBuilder::new(curved, faces).material(material);
    let mut body = mesh.build(settings(Quality::High)).expect("valid");
    let mut dice = Dice::new(5);
    for i in 0..body.particles.len() {
        let flat = body.particles.position(i) * Vec3::new(1.0, 0.0, 1.0);
        body.particles.set_position(i, flat + Vec3::Y * dice.about(1e-7));
    }
    let start = positions(&body);
    let mut island = Island::of_body(body);
    step_whole(&mut island, &weightless(FRAME));
    let moved = positions(&island.bodies[0]).into_iter().zip(start).map(|(now, then)| now - then);
    let (aside, out) = moved
        .fold((0.0_f32, 0.0_f32), |(aside, out), way| (aside.max(way.x.hypot(way.z)), out.max(way.y.abs())));
    assert!(out > 1.5 * aside, "{aside} m in the plane, {out} m out of it");
}

/// Steps of cloths that bend have the same bits on all instruction sets, at once and stage by stage.
#[test]
fn bending_has_the_same_bits_on_all() {
    assert_same_on_all(|isa, step| {
        // The last has more than one block of rows.
        let sizes = [(33, 9), (17, 16), (6, 5), (3, 40), (32, 8), (40, 33)];
        let grid = |(columns, rows): (u32, u32)| {
            ClothBuilder::new(0.5, 0.4, columns, rows)
                .placed(Vec3::ZERO, Vec3::X, Vec3::Z)
                .material(limp(BendingRigidity { warp: 1e-4, weft: 3e-5 }))
                .pin(0)
        };
        let settings = BodySettings::default();
        let mut hashes = Vec::new();
        for size in sizes {
            let mesh = mesh_of(grid(size), limp(BendingRigidity::isotropic(1e-4)), settings);
            let whole = grid(size).build(settings).expect("valid");
            let mut cut = whole.clone();
            let [from, to] = [Vec3::new(0.1, 0.0, 0.17), Vec3::new(0.33, 0.0, 0.18)];
            let blade = wide_blade(from, to, Vec3::Y);
            assert!(cut.cut(&blade).expect("can be cut").is_some(), "the blade must meet the cloth");
            for body in [whole, cut, mesh] {
                let mut island = Island::of_body(body);
                island.isa = isa;
                (0..20).for_each(|_| step(&mut island, &gravity(FRAME)));
                hashes.push(hash(&island));
            }
        }
        hashes
    });
}

/// Measured fabrics drape as they did in the laboratory (Cusick 1968), in three finenesses.
#[test]
fn measured_fabrics_drape_as_in_a_laboratory() {
    for fabric in MeasuredFabric::ALL {
        let published = fabric.published_drape();
        let drape = |iterations: u32, rings: u32| {
            let settings = BodySettings { iterations, ..BodySettings::from(Quality::High) };
            round_drape_coefficient(fabric.material(), settings, rings).expect("valid")
        };
        let found = [12, 16, 24].map(|rings| drape(4, rings));
        let name = fabric.name();
        println!("law: drape of {name}: measured {found:.3?}, published {published}");
        let tolerance = match fabric {
            // The drape of its finer meshes is 0.40 give or take 0.01, by the way on which it settles.
            MeasuredFabric::WoolTropical => [0.1, 0.12, 0.12],
            // The finest mesh of the stiffest is further off.
            MeasuredFabric::CottonBroadcloth => [0.1, 0.1, 0.15],
            _ => [0.1; 3],
        };
        for (drape, tolerance) in found.into_iter().zip(tolerance) {
            assert!((drape - published).abs() < tolerance, "{name}: {found:?}");
        }
        if published < 0.3 {
            // Limp ones do not depend on the fineness, nor on more iterations than users have.
            assert!((found[0] - found[2]).abs() < 0.06, "{name} in three finenesses: {found:?}");
            let plain = drape(1, 12);
            assert!((plain - published).abs() < 0.1, "{name} with one iteration: {plain}");
        }
    }
}

/// From silk to a board: the drape rises with rigidity, far beyond what bend sticks reach.
#[test]
fn rigidity_reaches_from_limp_to_a_board() {
    let found = [1e-6, 1e-5, 1e-4, 1e-3].map(|rigidity| {
        let material = limp(BendingRigidity::isotropic(rigidity));
        round_drape_coefficient(material, settings(Quality::High), 12).expect("valid")
    });
    println!("law: drape of rigidities from 1e-6 to 1e-3 N m: measured {found:.3?}, expected to rise");
    assert!(found.windows(2).all(|pair| pair[1] > pair[0] + 0.05), "{found:?}");
    assert!(found[0] < 0.25 && found[3] > 0.9, "{found:?}");
}
