//! Tethers take the sag out of hanging cloth.

use drape_solver::{
    BodySettings, ClothBuilder, ClothMaterial, Edge, Island, MeshClothBuilder, StructuralSolve,
};

use crate::common::*;

/// The distance in metres of the lowest particle of a hanging sheet of 2 m, which is swept, below its rest position, and the stretch.
fn sag(corners: bool, tethers: bool) -> (f32, f64) {
    let structural = StructuralSolve::Sweeps;
    let settings = BodySettings {
        substeps: 4,
        iterations: 1,
        drag: 2.0,
        tethers,
        structural,
        ..BodySettings::default()
    };
    let mut sheet = ClothBuilder::new(2.0, 2.0, 49, 49);
    sheet = if corners { sheet.pin(0).pin(48) } else { sheet.pin_edge(Edge::Top) };
    let mut island = Island::of_body(sheet.build(settings).expect("valid"));
    run(&mut island, &gravity(FRAME), 4.0);
    let lowest = particles(&island).positions().map(|p| -p.y).fold(0.0, f32::max);
    (lowest - 2.0, stretch(&island).rms)
}

/// Tethers lessen the stretch of a sheet that hangs from its top edge several times.
#[test]
fn tethers_take_the_sag_out_of_a_curtain() {
    let ((loose, loose_stretch), (held, held_stretch)) = (sag(false, false), sag(false, true));
    assert!(loose > 0.02, "without tethers it sags: {loose} m");
    assert!(held < 0.1 * loose, "{held} m with, {loose} m without");
    assert!(held < 1e-4, "no particle farther from its pin than at rest, but {held} m");
    assert!(held_stretch < 0.3 * loose_stretch, "{held_stretch} with, {loose_stretch} without");
}

/// The same on two corners.
#[test]
fn tethers_take_the_stretch_out_of_a_sheet_on_two_corners() {
    let ((_, loose), (_, held)) = (sag(true, false), sag(true, true));
    assert!(held < 0.6 * loose, "{held} with, {loose} without");
}

/// A tether only pulls: within its length a particle moves freely.
#[test]
fn a_slack_tether_does_nothing() {
    let fall = |tethers: bool| {
        let settings = BodySettings { tethers, ..BodySettings::default() };
        // Its sticks have no stiffness, and it is compressed to half its length: all tethers are slack.
        let material = ClothMaterial {
            stretch_stiffness: 0.0,
            shear_stiffness: 0.0,
            bend_stiffness: 0.0,
            ..ClothMaterial::default()
        };
        let sheet = ClothBuilder::new(1.0, 1.0, 9, 9).pin_edge(Edge::Top).material(material);
        let mut island = Island::of_body(sheet.build(settings).expect("valid"));
        for i in 9..81 {
            let p = particles(&island).position(i);
            island.bodies[0].particles.set_position(i, p.with_y(0.5 * p.y));
        }
        run(&mut island, &gravity(FRAME), 0.05);
        particles(&island).position(76)
    };
    assert_eq!(fall(true), fall(false));
}

/// A mesh hangs from two shoulders, of five pins each, and each holds every particle. The pins of the nearer one once took all its tethers.
#[test]
fn both_shoulders_of_a_mesh_hold() {
    let settings = BodySettings { drag: 2.0, ..BodySettings::default() };
    let grid = ClothBuilder::new(1.0, 1.0, 25, 25).build(settings).expect("valid");
    let places = grid.particles.positions().collect();
    let mesh = MeshClothBuilder::new(places, grid.topology.faces().to_vec());
    let mesh = (0..5).chain(20..25).fold(mesh, MeshClothBuilder::pin);
    let mut island = Island::of_body(mesh.build(settings).expect("valid"));
    run(&mut island, &gravity(FRAME), 4.0);
    let body = &island.bodies[0].particles;
    let (pins, others): (Vec<u32>, Vec<u32>) = (0..25 * 25).partition(|&i| body.is_pinned(i as usize));
    let place = |i: u32| body.position(i as usize);
    let middle = pins.iter().map(|&pin| place(pin).x).sum::<f32>() / pins.len() as f32;
    let tethers = island.bodies[0].topology.tethers();
    for i in others {
        for is_left in [true, false] {
            let is_own = |&&(p, pin, _): &&(u32, u32, f32)| p == i && (place(pin).x < middle) == is_left;
            let strains =
                tethers.iter().filter(is_own).map(|&(_, pin, length)| place(i).distance(place(pin)) / length);
            let strain = strains.fold(f32::NAN, f32::max) - 1.0;
            assert!(
                strain < 0.002,
                "particle {i} is farther from the left ({is_left}) than at rest by {strain}"
            );
        }
    }
}
