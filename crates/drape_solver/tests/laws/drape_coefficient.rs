//! The drape coefficient, a measure of stiffness from textile laboratories, for all presets.

use drape_solver::drape_test::{drape_coefficient, stretch_by_weight};
use drape_solver::{BodySettings, ClothMaterial, Preset};

/// The drape coefficient rises with bend stiffness, from limp cloth to a board (Cusick 1968; here of a square).
#[test]
fn the_drape_coefficient_rises_with_the_stiffness_in_bending() {
    let stiffnesses = [0.0, 0.3, 0.9, 1.0];
    let found = stiffnesses.map(|bend_stiffness| {
        let material = ClothMaterial { bend_stiffness, ..ClothMaterial::default() };
        let settings = BodySettings { substeps: 16, ..BodySettings::default() };
        drape_coefficient(material, settings).expect("valid")
    });
    println!(
        "law: drape coefficients at bend stiffness {stiffnesses:?}: measured {found:.3?}, expected to rise"
    );
    assert!(found.windows(2).all(|pair| pair[1] > pair[0] + 0.01), "{found:?}");
}

fn measured(preset: Preset) -> [f32; 2] {
    let settings = preset.settings(BodySettings::default());
    let drape = drape_coefficient(preset.material(), settings).expect("valid");
    let stretch = stretch_by_weight(preset.material(), settings).expect("valid");
    println!(
        "law: {}: drape coefficient {drape:.3}, stretch by its weight {:.3} %",
        preset.name(),
        stretch * 100.0
    );
    [drape, stretch]
}

/// Silk is limper than cotton, cotton than denim, denim than leather. Only rubber stretches under its own weight.
#[test]
fn presets_drape_in_the_order_of_the_trade_and_only_rubber_stretches() {
    let [silk, cotton, denim, leather] =
        [Preset::Silk, Preset::Cotton, Preset::Denim, Preset::Leather].map(measured);
    let drapes = [silk, cotton, denim, leather].map(|[drape, _]| drape);
    assert!(drapes.windows(2).all(|pair| pair[1] > pair[0] + 0.03), "{drapes:?}");
    let [rubber, net, chain] = [Preset::Rubber, Preset::Net, Preset::Chain].map(measured);
    for [drape, stretch] in [silk, cotton, denim, leather, net, chain] {
        assert!(stretch.abs() < 0.01, "{stretch}");
        assert!((0.0..1.0).contains(&drape), "{drape}");
    }
    assert!(rubber[1] > 0.02 && rubber[1] < 0.3, "{rubber:?}");
    assert!(net[0] < cotton[0] && chain[0] < cotton[0], "rings and meshes are limp: {net:?}, {chain:?}");
}

#[test]
fn presets_are_in_range_and_weigh_what_the_trade_says() {
    for preset in Preset::ALL {
        assert_eq!(preset.settings(BodySettings::default()).validate(), Ok(()), "{}", preset.name());
    }
    let weight = |preset: Preset| preset.material().areal_density;
    assert!((weight(Preset::Silk) - 16.0 * 0.00434).abs() < 1e-3);
    assert!((weight(Preset::Denim) - 14.0 * 0.0339057).abs() < 1e-3);
    assert!((weight(Preset::Leather) - 0.0012 * 860.0).abs() < 5e-3);
}
