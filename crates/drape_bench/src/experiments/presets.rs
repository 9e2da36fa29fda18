//! Measures the named materials: weight, drape and stretch.

use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use drape_solver::drape_test::{drape_coefficient, stretch_by_weight};
use drape_solver::{BodySettings, Preset, StepError};

/// Measures all cases, and prints a table.
///
/// # Errors
/// If a preset is out of range.
pub fn report() -> Result<(), StepError> {
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_header([
        "preset",
        "kg/m^2",
        "stretch stiffness",
        "shear stiffness",
        "bend stiffness",
        "drape coefficient",
        "stretch by its weight, %",
    ]);
    for preset in Preset::ALL {
        let (material, settings) = (preset.material(), preset.settings(BodySettings::default()));
        table.add_row([
            preset.name().to_string(),
            format!("{:.3}", material.areal_density),
            format!("{:.2}", material.stretch_stiffness),
            format!("{:.2}", material.shear_stiffness),
            format!("{:.2}", material.bend_stiffness),
            format!("{:.2}", drape_coefficient(material, settings)?),
            format!("{:.2}", 100.0 * stretch_by_weight(material, settings)?),
        ]);
    }
    println!("{table}");
    Ok(())
}
