//! Measures fabrics of known bending rigidity: bending length and drape, beside what a laboratory found.

use std::path::PathBuf;

use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use drape_solver::drape_test::{bending_length, round_drape_coefficient};
use drape_solver::{BendingRigidity, BodySettings, ClothMaterial, Quality};
use serde::Serialize;

use crate::failure::Failure;
use crate::report::table::write_json;

/// Where to write the figures.
#[derive(Args, Clone, Debug)]
pub struct FabricArguments {
    /// Also write them to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// A fabric that a laboratory has measured.
struct Fabric {
    name: &'static str,
    /// kg/m^2.
    areal_density: f32,
    /// N m, the mean of warp and weft.
    rigidity: f32,
    drape: f32,
}

/// Matsudaira, Masuda, Wada and Yokura 2015, "Shape Factor of Flared Skirts Compared with That of Circular Fabrics", Journal of Textile
/// Engineering 61(6), 69-73: tables 1 (KES) and 2 (drape), fabrics A, B, C and F. Read in a transcription.
const SOURCE: &str = "Matsudaira et al. 2015, J. Textile Eng. 61(6), tables 1 and 2";
const FABRICS: [Fabric; 4] = [
    Fabric { name: "polyester faille", areal_density: 0.1043, rigidity: 1.86e-6, drape: 0.283 },
    Fabric { name: "wool tropical", areal_density: 0.1629, rigidity: 6.57e-6, drape: 0.498 },
    Fabric { name: "polyester tropical", areal_density: 0.1165, rigidity: 7.55e-6, drape: 0.507 },
    Fabric { name: "cotton broad", areal_density: 0.1238, rigidity: 11.57e-6, drape: 0.829 },
];

/// Rings of triangles in a specimen, and sticks in an overhang.
const RINGS: [u32; 3] = [12, 16, 24];
const STICKS: [u32; 3] = [8, 16, 32];

/// Standard gravity in m/s^2.
const GRAVITY: f32 = 9.81;

/// What was measured of a fabric.
#[derive(Serialize)]
struct Measured {
    name: &'static str,
    source: &'static str,
    drape_published: f32,
    /// In three finenesses.
    drape: [f32; 3],
    /// Of the published rigidity and weight.
    bending_length_published_m: f32,
    bending_length_m: [f32; 3],
}

impl Fabric {
    fn measure(&self) -> Result<Measured, Failure> {
        let settings = BodySettings::from(Quality::High);
        let material = ClothMaterial {
            areal_density: self.areal_density,
            shear_stiffness: 0.3,
            bend_stiffness: 0.0,
            bending_rigidity: BendingRigidity::isotropic(self.rigidity),
            ..ClothMaterial::default()
        };
        let expected = (self.rigidity / (self.areal_density * GRAVITY)).cbrt();
        let (mut drape, mut lengths) = ([0.0; 3], [0.0; 3]);
        for i in 0..3 {
            drape[i] = round_drape_coefficient(material, settings, RINGS[i])?;
            lengths[i] = bending_length(material, settings, expected, STICKS[i])?;
        }
        Ok(Measured {
            name: self.name,
            source: SOURCE,
            drape_published: self.drape,
            drape,
            bending_length_published_m: expected,
            bending_length_m: lengths,
        })
    }
}

/// Measures all fabrics, prints a table, and writes the figures to a file.
///
/// # Errors
/// If the file cannot be written.
pub fn report(arguments: &FabricArguments) -> Result<(), Box<dyn std::error::Error>> {
    let all = FABRICS.iter().map(Fabric::measure).collect::<Result<Vec<_>, _>>()?;
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_header(["fabric", "drape", "published", "bending length, mm", "of rigidity and weight, mm"]);
    for measured in &all {
        let millimetres = measured.bending_length_m.map(|length| format!("{:.1}", length * 1e3));
        table.add_row([
            measured.name.to_string(),
            measured.drape.map(|drape| format!("{drape:.2}")).join(", "),
            format!("{:.2}", measured.drape_published),
            millimetres.join(", "),
            format!("{:.1}", measured.bending_length_published_m * 1e3),
        ]);
    }
    println!("{table}");
    if let Some(path) = &arguments.json {
        write_json(path, &all)?;
    }
    Ok(())
}
