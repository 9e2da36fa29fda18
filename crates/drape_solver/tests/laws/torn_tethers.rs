//! Tethers of torn bodies: a cut releases those that it crosses, and no others.

use std::collections::BTreeMap;

use drape_solver::glam::Vec3;
use drape_solver::{Body, BodySettings, ClothBuilder, Edge};

use crate::common::*;

/// A slit releases the tethers that run through it to the pins above, and no others.
#[test]
fn a_slit_releases_the_tethers_that_it_crosses() {
    let mut curtain = ClothBuilder::new(1.0, 1.0, 21, 21)
        .placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y)
        .pin_edge(Edge::Top)
        .build(BodySettings::default())
        .expect("valid");
    let held = |body: &Body, x: core::ops::Range<f32>| {
        let tethers = body.topology.tethers();
        let at = |i: u32| body.topology.rest_position(i as usize);
        tethers.iter().filter(|&&(i, ..)| at(i).y < -0.06 && x.contains(&at(i).x)).count()
    };
    let before = [-0.17..0.17, 0.27..0.51].map(|x| held(&curtain, x));
    assert!(before.iter().all(|&count| count > 20), "{before:?}");
    let stroke = blade(Vec3::new(-0.23, 0.013, 0.0), Vec3::new(0.23, 0.013, 0.0));
    curtain.cut(&stroke).expect("can be cut").expect("opens");
    assert_eq!([-0.17..0.17, 0.27..0.51].map(|x| held(&curtain, x)), [0, before[1]]);
}

/// Of the tethers of a cut sheet those stay that are far from the stroke, with their pins and lengths, and those go that it crosses.
/// Pieces of a smaller grid had lost the tethers of its last cells.
#[test]
fn tethers_stay_but_for_those_that_a_stroke_crosses() {
    let (mut dice, mut kept, mut gone) = (Dice::new(5), 0, 0);
    for (columns, rows) in [(40, 33), (20, 17), (4, 60), (32, 32), (21, 21)] {
        for round in 0..30 {
            let mut body = ClothBuilder::new(1.0, 1.0, columns, rows)
                .placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y)
                .pin_edge(Edge::Top)
                .pin(columns * rows - 1)
                .build(BodySettings::default())
                .expect("valid");
            let whole = body.topology.clone();
            let mut place = |along: f32| Vec3::new(dice.about(along), dice.about(along), 0.0);
            // Every third goes right through.
            let (from, to) = match round % 3 {
                0 => (Vec3::new(-1.0, place(0.4).y, 0.0), Vec3::new(1.0, place(0.4).y, 0.0)),
                1 => (Vec3::new(place(0.4).x, -1.0, 0.0), Vec3::new(place(0.4).x, 1.0, 0.0)),
                _ => (place(0.6), place(0.6)),
            };
            let Some(torn) = body.cut(&blade(from, to)).expect("can be cut") else { continue };
            let pieces = torn.pieces.iter().map(|piece| (&piece.body.topology, &piece.origins));
            let (mut left, mut is_grid) = (BTreeMap::new(), vec![false; whole.particle_count()]);
            for (topology, origins) in pieces.chain([(&body.topology, &torn.origins)]) {
                // Pieces that are no grid any more have tethers along their own sticks.
                let has_families = topology.batches().iter().any(|batch| batch.family().is_some());
                origins.iter().for_each(|&origin| is_grid[origin as usize] |= has_families);
                for (particle, pin, length) in topology.tethers() {
                    let ends = [particle, pin].map(|end| origins[end as usize]);
                    left.entry(ends).or_insert_with(Vec::new).push(length);
                }
            }
            let spacing = 1.0 / (columns.min(rows) - 1) as f32;
            let tethers = whole.tethers().into_iter();
            for (particle, pin, length) in tethers.filter(|&(particle, ..)| is_grid[particle as usize]) {
                let [p, q] = [particle, pin].map(|end| whole.rest_position(end as usize));
                let now = left.get(&[particle, pin]);
                match clearance([p, q], [from, to]) {
                    gap if gap > 1.5 * spacing => {
                        assert_eq!(now, Some(&vec![length]), "{particle} to {pin}, {gap} m off the stroke");
                        kept += 1;
                    }
                    gap if gap < -1.5 * spacing => {
                        assert_eq!(now, None, "{particle} to {pin} across the stroke");
                        gone += 1;
                    }
                    _ => {}
                }
            }
        }
    }
    println!("law: {kept} tethers kept, {gone} gone");
    assert!(kept > 10_000 && gone > 2_000);
}

/// Metres between two segments in the XY plane. Below zero where they cross: how far the nearest of their ends is from the crossing.
fn clearance([a, b]: [Vec3; 2], [p, q]: [Vec3; 2]) -> f32 {
    let side = |from: Vec3, to: Vec3, point: Vec3| (to - from).cross(point - from).z;
    let to_segment = |point: Vec3, [from, to]: [Vec3; 2]| {
        let way = to - from;
        let part = ((point - from).dot(way) / way.length_squared().max(1e-12)).clamp(0.0, 1.0);
        point.distance(from + way * part)
    };
    let gap = to_segment(a, [p, q])
        .min(to_segment(b, [p, q]))
        .min(to_segment(p, [a, b]))
        .min(to_segment(q, [a, b]));
    let crosses = side(a, b, p) * side(a, b, q) < 0.0 && side(p, q, a) * side(p, q, b) < 0.0;
    if crosses { -gap } else { gap }
}
