//! Sheets that lie over edges and bars come to rest.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::{
    Body, BodySettings, ClothBuilder, Environment, Island, Obstacle, Placement, Preset, Quality, Shape, step,
};

use crate::common::*;

/// Seconds below the speed of rest after which bodies fall asleep.
const STILL: f32 = 1.0;

/// A level sheet of a material whose first row lies along X when `turn` is zero.
fn sheet((preset, quality): (Preset, Quality), side: f32, n: u32, middle: Vec3, turn: f32) -> Body {
    let settings = BodySettings { friction: 0.5, ..BodySettings::default().with_preset(preset) };
    let turn = Quat::from_rotation_y(turn);
    let (right, down) = (turn * Vec3::X, turn * Vec3::Z);
    ClothBuilder::new(side, side, n, n)
        .material(preset.material())
        .placed(middle - 0.5 * side * (right + down), right, down)
        .build(settings.with_quality(quality))
        .expect("valid")
}

/// Seconds until the body has been still for long enough to fall asleep, at most `limit`.
fn seconds_to_sleep(body: Body, obstacle: Obstacle, limit: f32) -> f32 {
    let mut island = Island::of_body(body);
    let obstacles = vec![Obstacle::ground(), obstacle].into();
    let environment = Environment { obstacles, ..gravity(FRAME) };
    let mut steps = 0;
    while (steps as f32) * FRAME < limit && island.bodies[0].still_for() < STILL {
        step(&mut island, &environment).expect("valid");
        steps += 1;
    }
    steps as f32 * FRAME
}

/// A face that lay along an edge of the box was held at one point of it, any of which was as deep. It turned about that point, the
/// next step found another, and its corners trembled at 0.1 to 0.5 m/s for ever.
#[test]
#[cfg_attr(miri, ignore = "many steps")]
fn a_sheet_over_the_edge_of_a_box_falls_asleep() {
    let cube = obstacle(Shape::Cuboid { half_extents: Vec3::splat(0.5) }, Vec3::Y * 0.5, 0.5);
    for of in [(Preset::Denim, Quality::Low), (Preset::Rubber, Quality::High), (Preset::Silk, Quality::Low)] {
        let sheet = sheet(of, 1.0, 25, Vec3::new(0.3, 1.05, 0.05), 0.0);
        let slept = seconds_to_sleep(sheet, cube.clone(), 7.0);
        println!("{of:?} over an edge sleeps after {slept} s");
        assert!(slept < 7.0, "{of:?} is awake after {slept} s");
    }
}

/// The same on a thin bar along the rows or across the squares of the sheet.
#[test]
#[cfg_attr(miri, ignore = "many steps")]
fn a_sheet_over_a_bar_falls_asleep() {
    for (preset, radius, turn) in [
        (Preset::Cotton, 0.01, 0.0),
        (Preset::Rubber, 0.01, 0.0),
        (Preset::Net, 0.01, 0.0),
        (Preset::Silk, 0.015, 0.5),
    ] {
        let placement =
            Placement { translation: Vec3::Y, rotation: Quat::from_rotation_z(core::f32::consts::FRAC_PI_2) };
        let bar = Obstacle::new(Shape::Capsule { radius, half_length: 0.6 }, placement, 0.5).expect("valid");
        let mut sheet = sheet((preset, Quality::Medium), 0.6, 17, Vec3::new(0.0, 1.05, 0.02), turn);
        sheet.settings.drag = 2.0;
        let slept = seconds_to_sleep(sheet, bar, 7.0);
        println!("{preset:?} over a bar sleeps after {slept} s");
        assert!(slept < 7.0, "{preset:?} is awake after {slept} s");
    }
}

/// A sheet on an incline that is a hundredth steeper than the one on which friction holds it moves, and never counts as still; on one
/// that is a hundredth less steep it falls asleep.
#[test]
#[cfg_attr(miri, ignore = "many steps")]
fn a_sheet_that_slides_stays_awake() {
    for (slope, holds) in [(0.51_f32, false), (0.49, true)] {
        let normal = Vec3::new(slope, 1.0, 0.0).normalize();
        let right = Vec3::new(normal.y, -normal.x, 0.0);
        let settings = BodySettings { drag: 0.0, thickness: 0.005, ..BodySettings::default() };
        let cloth = ClothBuilder::new(0.5, 0.5, 9, 9).placed(normal * 0.005, right, Vec3::Z);
        let mut island = Island::of_body(cloth.build(settings).expect("valid"));
        let incline = obstacle(Shape::HalfSpace { normal }, Vec3::ZERO, 0.5);
        let environment = Environment { obstacles: vec![incline].into(), ..gravity(FRAME) };
        let mut longest = 0.0_f32;
        run_with(&mut island, &environment, 3.0, |island, _| {
            longest = longest.max(island.bodies[0].still_for());
        });
        println!("slope {slope}: still for {longest} s");
        assert_eq!(longest > STILL, holds, "slope {slope}: still for {longest} s");
    }
}
