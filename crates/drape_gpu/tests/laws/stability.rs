//! No choice of settings gains energy.

use drape_solver::glam::Vec3;
use drape_solver::{BodySettings, ClothBuilder, Edge, StickProjection};

use crate::common::*;

/// A hanging sheet that was torn out of shape by a violent start never rises above it, whatever the settings.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn no_settings_gain_energy() {
    for n in [12, 40] {
        for (substeps, iterations) in [(1, 1), (1, 8), (2, 3), (4, 1), (8, 2), (16, 1)] {
            for projection in [StickProjection::Exact, StickProjection::SquareRootFree] {
                for tethers in [false, true] {
                    let settings = BodySettings {
                        substeps,
                        iterations,
                        projection,
                        tethers,
                        drag: 0.0,
                        ..BodySettings::default()
                    };
                    let cloth = ClothBuilder::new(1.0, 1.0, n, n).pin_edge(Edge::Top);
                    let mut body = cloth.build(settings).expect("valid");
                    for i in 0..body.particles.len() {
                        let way = if i % 2 == 0 { 3.0 } else { -3.0 };
                        body.particles.set_velocity(i, Vec3::new(way, 0.5 * way, 2.0));
                    }
                    let (mut world, id) = world_of(&body);
                    run(&mut world, &gravity(), 240);
                    let status = world.read_status(id).expect("a body").expect("stepped");
                    let ways = format!("{n}: {substeps} x {iterations}, {projection:?}, tethers {tethers}");
                    assert!(!status.is_broken && status.greatest_speed < 12.0, "{ways}: {status:?}");
                    assert!(centre(&positions(&world, id)).y < 0.0, "{ways}: it has risen");
                }
            }
        }
    }
}
