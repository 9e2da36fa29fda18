//! Cloth comes out of its folds.

use bevy_drape::prelude::*;
use bevy_drape_script::play::ScenePlay;
use bevy_drape_script::{Override, SceneRunner, SceneScript};

/// Particles of the demo's curtain between whose neighbours in a row or a column is less than half of what is there at rest, once
/// it has been shot at and has come to rest.
fn folded(particles: [usize; 2], substeps: u32) -> usize {
    let [columns, rows] = particles;
    let overrides = [
        format!("particles=[{columns},{rows}]"),
        format!("substeps={substeps}"),
        "settings.duration=25".into(),
    ]
    .map(|text| text.parse::<Override>().expect("an override"));
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/scenes/cannon.scene.ron");
    let mut runner = SceneRunner::headless(SceneScript::load_with(scene, &overrides).expect("the scene"));
    while runner.step() {}
    let world = runner.world();
    let curtain = world.resource::<ScenePlay>().entities("curtain")[0];
    let curtain = world.get::<Particles>(curtain).expect("a curtain");
    let (across, down) = (4.0 / (columns - 1) as f32, 3.0 / (rows - 1) as f32);
    let at = |column: usize, row: usize| curtain.position(row * columns + column);
    let is_folded = |&(column, row): &(usize, usize)| {
        at(column - 1, row).distance(at(column + 1, row)) < across
            || at(column, row - 1).distance(at(column, row + 1)) < down
    };
    let inside = (1..rows - 1).flat_map(|row| (1..columns - 1).map(move |column| (column, row)));
    inside.filter(is_folded).count()
}

/// Stiff shear sticks held sharp folds fast that shots had left: with 0.7, which the demo had, 15 of 24 curtains kept one for good,
/// with 0.5 five of them, with 0.4 and below none. It has 0.3 now.
#[test]
fn a_curtain_that_was_shot_at_keeps_no_sharp_fold() {
    for (particles, substeps) in [([64, 48], 8), ([64, 48], 16), ([60, 45], 16), ([48, 36], 16)] {
        assert_eq!(folded(particles, substeps), 0, "{particles:?}, {substeps} substeps");
    }
}
