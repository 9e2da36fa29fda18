//! Measures the named materials: weight, drape, stretch and cost.

use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use drape_solver::drape_test::{drape_coefficient, stretch_by_weight};
use drape_solver::glam::Vec3;
use drape_solver::{BodySettings, ClothBuilder, ClothMaterial, Edge, Environment, Island, Preset};

use crate::failure::Failure;
use crate::measure::median::{in_turns, median_us};

/// Steps of the sheet whose cost is measured.
const STEPS: u32 = 300;

/// Measures all cases, and prints a table.
///
/// # Errors
/// If a preset is out of range.
pub fn report() -> Result<(), Failure> {
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
        "step, times one of plain cloth",
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
            format!("{:.2}", cost(material)?),
        ]);
    }
    println!("{table}");
    Ok(())
}

/// Time of a step of a falling curtain of 64 x 64 particles, over that of one of the default material.
fn cost(material: ClothMaterial) -> Result<f64, Failure> {
    let curtain = |material| {
        let cloth = ClothBuilder::new(1.0, 1.0, 64, 64).placed(Vec3::Y, Vec3::X, Vec3::Z).pin_edge(Edge::Top);
        Ok::<_, Failure>(Island::of_body(cloth.material(material).build(BodySettings::default())?))
    };
    let mut islands = [curtain(material)?, curtain(ClothMaterial::default())?];
    let times = in_turns(&mut islands, &Environment::default(), STEPS)?;
    let [own, plain] = [0, 1].map(|place| median_us(times[place].clone()));
    Ok(own / plain)
}
