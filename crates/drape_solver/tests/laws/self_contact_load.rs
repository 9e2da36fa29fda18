//! What lies on layers: the ground bears all of it, and layers keep their thickness, as the tests measure it themselves.

use drape_solver::glam::{DVec3, Quat, Vec3};
use drape_solver::state::measure;
use drape_solver::{
    Body, BodySettings, ClothBuilder, ClothMaterial, Environment, Island, Obstacle, Other, SelfContact,
};

use crate::common::*;
use crate::layer_gaps;

/// Half the distance that layers keep, in metres.
const THICKNESS: f32 = 0.005;

/// That distance in metres.
const APART: f64 = 2.0 * THICKNESS as f64;

/// Distance in metres up to which layers count as lying on each other.
const NEAR: f64 = 1.05 * APART;

fn settings() -> BodySettings {
    BodySettings { thickness: THICKNESS, self_contact: SelfContact::On, ..BodySettings::default() }
}

/// A level sheet of 0.5 m around the vertical, turned about it.
fn level(height: f32, turn: f32) -> Body {
    let turn = Quat::from_rotation_y(turn);
    let (right, down) = (turn * Vec3::X, turn * Vec3::Z);
    ClothBuilder::new(0.5, 0.5, 13, 13)
        .placed(Vec3::Y * height - 0.25 * (right + down), right, down)
        .material(ClothMaterial { areal_density: 0.2, ..ClothMaterial::default() })
        .build(settings())
        .expect("valid")
}

fn over_ground() -> Environment {
    Environment { obstacles: vec![Obstacle::ground().reporting_reaction()].into(), ..gravity(FRAME) }
}

/// So many sheets on each other, after two seconds on the ground.
fn stack(layers: usize) -> Island {
    let bodies = (0..layers).map(|k| level(THICKNESS * (1.0 + 2.05 * k as f32), 0.0));
    let mut island = Island { bodies: bodies.collect(), ..Island::default() };
    island.bodies.iter_mut().for_each(|body| body.reports_contacts = true);
    run(&mut island, &over_ground(), 2.0);
    island
}

/// Least distance of the neighbours in a stack, in parts of that which they keep, from the lowest pair up.
fn gaps(island: &Island) -> Vec<f64> {
    let neighbours = island.bodies.windows(2);
    neighbours
        .map(|pair| layer_gaps::least(&layer_gaps::between(&pair[0], &pair[1], 2.0 * APART)) / APART)
        .collect()
}

/// Six sheets, which fall on the ground one on another, turned at random.
fn pile() -> Island {
    let mut dice = Dice::new(3);
    let bodies = (0..6).map(|k| level(0.02 + 0.04 * k as f32, 3.0 * dice.unit()));
    let mut island = Island { bodies: bodies.collect(), ..Island::default() };
    run(&mut island, &over_ground(), 2.0);
    island
}

/// A sheet that has fallen on its edge, and its pose before.
fn fold() -> (Island, Vec<DVec3>) {
    let sheet = ClothBuilder::new(0.8, 0.8, 25, 25)
        .placed(Vec3::new(-0.4, 0.85, 0.0), Vec3::X, Vec3::new(0.0, -0.995, 0.0998))
        .build(settings())
        .expect("valid");
    let rest = measure::positions(&sheet.particles).collect();
    let mut island = Island::of_body(sheet);
    run(&mut island, &over_ground(), 4.0);
    (island, rest)
}

/// Least distance of the layers of a fold, in parts of that which they keep.
fn fold_gap((island, rest): &(Island, Vec<DVec3>)) -> f64 {
    layer_gaps::least(&layer_gaps::within(&island.bodies[0], rest, 4.0 * APART, 2.0 * APART)) / APART
}

/// The lowest layer alone touches the ground, and passes on all that it bears: by the reaction on the ground, and by the report of
/// the contact.
#[test]
fn the_ground_bears_all_layers_of_a_stack() {
    for layers in [1, 3, 8] {
        let mut island = stack(layers);
        let mass: f64 = island.bodies.iter().map(|body| measure::mass(&body.particles)).sum();
        let (mut reaction, mut report) = (0.0, 0.0);
        run_with(&mut island, &over_ground(), 0.5, |island, _| {
            reaction -= f64::from(island.reactions.iter().map(|reaction| reaction.impulse.y).sum::<f32>());
            let on_ground = island.contacts.iter().filter(|contact| contact.other == Other::Obstacle(0));
            report += f64::from(on_ground.map(|contact| contact.impulse).sum::<f32>());
        });
        let weight = 0.5 * mass * f64::from(G);
        law(
            &format!("reaction of the ground to {layers} layers in half a second, in N s"),
            reaction,
            weight,
            4e-3,
        );
        law(
            &format!("reported load of the ground under {layers} layers in half a second, in N s"),
            report,
            weight,
            4e-3,
        );
    }
}

/// Up to four layers, thickness holds to 2 % under all that lies above. More are squeezed: see below.
#[test]
fn the_lowest_layers_of_a_low_stack_are_not_squeezed() {
    for layers in [2, 3, 4] {
        let gaps = gaps(&stack(layers));
        println!("law: thickness left in a stack of {layers}: {gaps:.3?}");
        assert!(gaps.iter().all(|&gap| gap > 0.98), "{gaps:?}");
    }
}

/// What is squeezed in a pile is squeezed in few places: on average thickness holds, and nothing crosses.
#[test]
fn most_layers_of_a_pile_at_rest_keep_their_thickness() {
    let island = pile();
    let gaps = layer_gaps::of_bodies(&island, NEAR);
    let mean = gaps.iter().sum::<f64>() / gaps.len() as f64 / APART;
    let squeezed = gaps.iter().filter(|&&gap| gap < 0.9 * APART).count() as f64 / gaps.len() as f64;
    println!(
        "law: thickness left in a pile: {mean:.3} on average of {}, less than 0.9 in {squeezed:.3} of it",
        gaps.len()
    );
    assert!(gaps.len() > 1000, "they lie on each other");
    law("mean thickness left in a pile", mean, 1.0, 0.03);
    assert!(squeezed < 0.12, "{squeezed}");
    assert_eq!(crossings(&island), 0);
}

/// Folds of one sheet that has fallen on its edge.
#[test]
fn folds_at_rest_keep_their_thickness() {
    let gap = fold_gap(&fold());
    println!("law: least thickness left in a fold: {gap:.3}");
    assert!(gap > 0.98, "{gap}");
}

/// A known limit, and the least case of it: from six equal sheets on, the lowest two do not keep their distance to 2 %.
#[test]
#[ignore = "a known limit: the lowest layers of a stack are squeezed"]
fn the_lowest_layers_of_a_stack_are_not_squeezed() {
    let all = [6, 10].map(|layers| gaps(&stack(layers)));
    println!("law: thickness left in stacks: {all:.3?}");
    assert!(all.iter().flatten().all(|&gap| gap > 0.98), "{all:?}");
}

/// The same in heaps: thickness is to hold to 2 % everywhere.
#[test]
#[ignore = "a known limit: layers of a heap are squeezed"]
fn heaps_at_rest_keep_their_thickness_everywhere() {
    let gaps = [layer_gaps::least(&layer_gaps::of_bodies(&pile(), NEAR)) / APART, fold_gap(&fold())];
    println!("law: least thickness left in a pile and in a fold: {gaps:.3?}");
    assert!(gaps.iter().all(|&gap| gap > 0.98), "{gaps:?}");
}
