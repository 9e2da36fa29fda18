//! Impact zones stop balls that contacts cannot stop: no ball's centre gets to the other side of a cloth.

use drape_solver::glam::Vec3;
use drape_solver::{BodySettings, ClothBuilder, Island};

use crate::common::*;

/// A sheet of 2 m by 2 m in the XY plane, pinned all round.
fn sheet(count: u32, settings: BodySettings) -> Island {
    let last = count - 1;
    let is_rim = move |column: u32, row: u32| column == 0 || row == 0 || column == last || row == last;
    let sheet = ClothBuilder::new(2.0, 2.0, count, count)
        .placed(Vec3::new(-1.0, 1.0, 0.0), Vec3::X, Vec3::NEG_Y)
        .pin_where(move |column, row, _| is_rim(column, row));
    Island::of_body(sheet.build(BodySettings { drag: 0.0, ..settings }).expect("valid"))
}

/// True if the ball's centre is in front (+Z) of the sheet: a straight way from it to the front passes through an even number
/// of faces, as the sheet hangs over in folds around a ball that has pushed it far. A ball that is thrown back may leave to the side.
fn is_in_front(island: &Island) -> bool {
    let (centre, body) = (island.balls[0].position(), &island.bodies[0]);
    let heights = body.topology.faces().iter().filter_map(|face| {
        let [a, b, c] = face.map(|i| body.particles.position(i as usize));
        let area = |p: Vec3, q: Vec3, r: Vec3| (q - p).truncate().perp_dot((r - p).truncate());
        let whole = area(a, b, c);
        let weights = [area(centre, b, c), area(a, centre, c), area(a, b, centre)].map(|part| part / whole);
        let is_over = weights.into_iter().all(|weight| weight >= 0.0);
        is_over.then(|| centre.z - (a.z * weights[0] + b.z * weights[1] + c.z * weights[2]))
    });
    let heights: Vec<f32> = heights.collect();
    let faces_before = heights.iter().filter(|height| **height <= 0.0).count();
    if heights.is_empty() { centre.z > 0.0 } else { faces_before % 2 == 0 }
}

/// Contacts and sticks alone let the heaviest ball through.
#[test]
fn no_ball_passes_a_sheet_that_is_pinned_all_round() {
    let shots = [(16, 20.0, 25.0), (32, 2.0, 40.0), (32, 20.0, 25.0), (32, 200.0, 100.0)];
    for (settings, (count, mass, speed)) in each_with(settings_of_both(), shots) {
        let mut island = sheet(count, settings);
        let start = Vec3::new(0.13, 0.07, 0.3);
        island.balls.push(ball(smooth(0.1, mass), start, Vec3::new(0.1, -0.05, -1.0).normalize() * speed));
        run_with(&mut island, &gravity(FRAME), 1.0, |island, index| {
            assert!(is_in_front(island), "{settings:?}, {mass} kg at {speed} m/s: behind at step {index}");
            let now = island.balls[0].velocity().length();
            assert!(now < 1.05 * speed + G, "{now} m/s at step {index}");
        });
        assert!(island.balls[0].velocity().z > 0.0, "the sheet has thrown the ball back");
    }
}
