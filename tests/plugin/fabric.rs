//! Fabrics and surfaces.

use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::build::Preset;
use bevy_drape::prelude::*;
use bevy_drape::snapshot::Snapshot;

use crate::common::*;

#[test]
fn fabrics_by_name_are_the_presets() {
    let named = [
        Fabric::SILK,
        Fabric::COTTON,
        Fabric::DENIM,
        Fabric::LEATHER,
        Fabric::RUBBER,
        Fabric::NET,
        Fabric::CHAIN,
    ];
    assert_eq!(named.map(Some), Preset::ALL.map(|preset| Some(Fabric::from(preset))));
    assert!(named.iter().all(|fabric| fabric.extensible == (*fabric == Fabric::RUBBER)));
}

/// Falls freely for a second with this drag: `g (1 / k - (1 - e^-k) / k^2)` metres.
fn fall(drag: f32) -> f32 {
    GRAVITY * (1.0 / drag - (1.0 - (-drag).exp()) / (drag * drag))
}

#[test]
fn a_surface_of_its_own_counts_before_that_of_the_fabric() {
    let mut app = app();
    let fabric = Fabric { drag: 2.0, ..default() };
    let woven = app.world_mut().spawn((free_cloth(), fabric)).id();
    let own = BodySurface { drag: 8.0, ..default() };
    let place = Transform::from_xyz(5.0, 0.0, 0.0);
    let covered = app.world_mut().spawn((free_cloth(), fabric, own, place)).id();
    run(&mut app, 1.0);
    let fallen = |app: &App, cloth| -centre(app, cloth).y;
    assert!((fallen(&app, woven) - fall(2.0)).abs() < 0.05, "{}", fallen(&app, woven));
    assert!((fallen(&app, covered) - fall(8.0)).abs() < 0.05, "{}", fallen(&app, covered));
    // Without it, the fabric's drag: the terminal velocity is g / k.
    app.world_mut().entity_mut(covered).remove::<BodySurface>();
    run(&mut app, 4.0);
    let speed = get::<Particles>(&app, covered).velocity(40).length();
    assert!((speed - GRAVITY / 2.0).abs() < 0.02, "{speed} m/s");
}

#[test]
fn another_drag_acts_on_the_cloth_as_it_is_and_another_density_builds_it_anew() {
    let mut app = app();
    let cloth = app.world_mut().spawn((free_cloth(), Fabric::default())).id();
    run(&mut app, 0.5);
    let (height, mass) = (centre(&app, cloth).y, mass(&app, cloth));
    get_mut::<Fabric>(&mut app, cloth).friction = 0.9;
    step(&mut app, 1);
    assert!(centre(&app, cloth).y < height, "it falls on");
    get_mut::<Fabric>(&mut app, cloth).areal_density *= 3.0;
    step(&mut app, 1);
    assert!(centre(&app, cloth).y > -0.01, "it is where it was spawned");
    assert!((self::mass(&app, cloth) / mass - 3.0).abs() < 1e-4);
}

fn mass(app: &App, cloth: Entity) -> f64 {
    drape_solver::state::measure::mass(get::<Particles>(app, cloth))
}

#[test]
fn another_drag_wakes() {
    let mut app = app();
    let curtain = app.world_mut().spawn((curtain(), Fabric { drag: 3.0, ..default() })).id();
    settle(&mut app, curtain);
    get_mut::<Fabric>(&mut app, curtain).drag = 2.0;
    step(&mut app, 1);
    assert_eq!(activity(&app, curtain), Activity::Active);
}

/// Tethers would hold it at its rest length from the pins.
#[test]
fn an_extensible_fabric_has_no_tethers() {
    let hang = |extensible| {
        let mut app = app();
        let slack = Fabric { stretch_stiffness: 0.2, drag: 3.0, extensible, ..default() };
        let cloth = app.world_mut().spawn((curtain(), slack)).id();
        run(&mut app, 4.0);
        0.5 - get::<Particles>(&app, cloth).bounds().0.y
    };
    let (held, stretched) = (hang(false), hang(true));
    assert!(held < 1.01, "{held} m");
    assert!(stretched > 1.1, "{stretched} m");
}

#[test]
fn a_snapshot_has_the_surface_of_the_fabric_and_the_cloth_keeps_its_sticks() {
    let mut app = app();
    let cloth = app.world_mut().spawn((free_cloth(), Fabric { drag: 2.0, ..default() })).id();
    run(&mut app, 0.2);
    let snapshot = Snapshot::take(app.world_mut());
    let height = centre(&app, cloth).y;
    get_mut::<Fabric>(&mut app, cloth).drag = 9.0;
    run(&mut app, 0.2);
    snapshot.restore(app.world_mut()).expect("the same bodies");
    assert_eq!(get::<Fabric>(&app, cloth).drag, 2.0);
    step(&mut app, 1);
    let fallen = height - centre(&app, cloth).y;
    assert!(fallen > 0.0 && fallen < 0.1, "it goes on from there, not from its start: {fallen} m");
}
