//! Figures of the simulation in Bevy's diagnostics.

use bevy::diagnostic::{DiagnosticPath, DiagnosticsStore};
use bevy::prelude::*;
use bevy_drape::diagnostics::DrapeDiagnosticsPlugin;
use bevy_drape::prelude::*;

use crate::common::*;

type Told = DrapeDiagnosticsPlugin;

fn value(app: &App, path: &DiagnosticPath) -> f64 {
    let store = app.world().resource::<DiagnosticsStore>();
    store.get_measurement(path).expect("a measurement").value
}

#[test]
fn diagnostics_tell_times_and_counts() {
    let mut app = app();
    app.add_plugins(DrapeDiagnosticsPlugin);
    app.world_mut().spawn(Cloth::new(1.0, 1.0).with_particles(20, 10));
    app.world_mut().spawn(Projectile::default());
    step(&mut app, 2);
    assert_eq!(value(&app, &Told::PARTICLES), 200.0);
    assert_eq!([Told::ACTIVE, Told::RESTING, Told::CULLED].map(|path| value(&app, &path)), [2.0, 0.0, 0.0]);
    let [step_time, relax] = [Told::STEP, Told::RELAX].map(|path| value(&app, &path));
    assert!(relax > 0.0 && step_time > 0.0, "{relax} and {step_time} ms");
}

/// Two cloths, side by side or through each other.
#[test]
fn crossings_of_simulated_cloths_are_counted() {
    for (shift, do_cross) in [(0.0, true), (0.5, false)] {
        let mut app = app();
        app.add_plugins(DrapeDiagnosticsPlugin);
        let settings = SolverSettings { self_contact: SelfContact::On, ..default() };
        let cloth = || (Cloth::new(0.6, 0.6).with_particles(12, 12), settings);
        app.world_mut().spawn(cloth());
        let aslant = Transform::from_xyz(0.0, 0.0, shift).with_rotation(Quat::from_rotation_x(0.3));
        app.world_mut().spawn((cloth(), aslant));
        step(&mut app, 2);
        assert_eq!(value(&app, &Told::CROSSINGS) > 10.0, do_cross);
    }
}
