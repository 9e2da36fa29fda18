//! A hanging sheet stretches less with every substep.

use drape_solver::{BodySettings, ClothBuilder, Edge, Island};

use crate::common::*;

/// Stretch (root mean square) of a sheet of 25 x 25 that has come to rest on its upper edge.
fn hanging(substeps: u32) -> f64 {
    let settings = BodySettings { substeps, drag: 4.0, ..bare() };
    let sheet = ClothBuilder::new(1.0, 1.0, 25, 25).pin_edge(Edge::Top);
    let mut island = Island::of_body(sheet.build(settings).expect("valid"));
    run(&mut island, &gravity(FRAME), 6.0);
    stretch(&island).rms
}

/// Without tethers and lines, a stick holds a load like a spring of stiffness `m / h^2` (one iteration). So stretch falls
/// with the square of the substep, to a quarter as substeps double (Macklin et al. 2019, Small Steps in Physics Simulation,
/// section 4). The test asks for half.
#[test]
fn the_stretch_of_a_hanging_sheet_falls_as_substeps_double() {
    let mut before: Option<f64> = None;
    for (substeps, tolerance) in [(1, 0.0), (2, 0.45), (4, 0.3), (8, 0.12), (16, 0.033), (32, 0.01)] {
        let now = hanging(substeps);
        println!("stretch of a hanging sheet with {substeps} substeps: {now:.3e}");
        if let Some(before) = before {
            let order = (before / now).log2();
            law(&format!("order of convergence, {substeps} substeps"), order, 2.0, tolerance);
            assert!(now < 0.5 * before, "{before} to {now} with {substeps} substeps");
        }
        before = Some(now);
    }
}
