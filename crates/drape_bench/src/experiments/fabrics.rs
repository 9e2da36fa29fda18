//! Measures the fabrics that a laboratory has measured: bending length and drape, beside what it found.

use std::error::Error;
use std::path::PathBuf;

use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use drape_solver::drape_test::{bending_length, round_drape_coefficient};
use drape_solver::glam::Vec3;
use drape_solver::{
    BendingFriction, BendingRigidity, Body, BodySettings, ClothBuilder, ClothMaterial, Edge, Environment,
    Island, MeasuredFabric, MembraneStiffness, MeshClothBuilder, Quality,
};
use serde::Serialize;

use crate::failure::Failure;
use crate::measure::median::{in_ms, in_turns, median};
use crate::report::table::write_json;

/// Where to write the figures.
#[derive(Args, Clone, Debug)]
pub struct FabricArguments {
    /// Also write them to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Rings of triangles in a specimen, and sticks in an overhang.
const RINGS: [u32; 3] = [12, 16, 24];
const STICKS: [u32; 3] = [8, 16, 32];

/// Steps whose times count.
const STEPS: u32 = 120;

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

fn measure(fabric: MeasuredFabric) -> Result<Measured, Failure> {
    let settings = BodySettings { iterations: 4, ..BodySettings::from(Quality::High) };
    let material = fabric.material();
    // Peirce's length is that of rigidity and weight, along the threads of a strip that does not stretch.
    let elastic = ClothMaterial {
        bending_friction: BendingFriction::default(),
        membrane_stiffness: MembraneStiffness::default(),
        ..material
    };
    let expected = (material.bending_rigidity.weft / (material.areal_density * GRAVITY)).cbrt();
    let (mut drape, mut lengths) = ([0.0; 3], [0.0; 3]);
    for i in 0..3 {
        drape[i] = round_drape_coefficient(material, settings, RINGS[i])?;
        lengths[i] = bending_length(elastic, settings, expected, STICKS[i])?;
    }
    Ok(Measured {
        name: fabric.name(),
        source: fabric.source(),
        drape_published: fabric.published_drape(),
        drape,
        bending_length_published_m: expected,
        bending_length_m: lengths,
    })
}

/// Measures all fabrics and what bending costs, prints tables, and writes the figures to a file.
///
/// # Errors
/// If the file cannot be written.
pub fn report(arguments: &FabricArguments) -> Result<(), Box<dyn Error>> {
    let all = MeasuredFabric::ALL.into_iter().map(measure).collect::<Result<Vec<_>, _>>()?;
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
    println!("{}", costs()?);
    if let Some(path) = &arguments.json {
        write_json(path, &all)?;
    }
    Ok(())
}

/// The time of a step with bend sticks, with rigidity, and with friction besides: grids and meshes under slanted gravity, taken in turns.
fn costs() -> Result<Table, Box<dyn Error>> {
    let of = |bend_stiffness, rigidity, friction| ClothMaterial {
        bend_stiffness,
        bending_rigidity: BendingRigidity::isotropic(rigidity),
        bending_friction: BendingFriction::isotropic(friction),
        ..ClothMaterial::default()
    };
    let materials = [of(0.1, 0.0, 0.0), of(0.0, 1e-5, 0.0), of(0.0, 1e-5, 1e-4)];
    let environment = Environment { gravity: Vec3::new(2.0, -GRAVITY, 3.0), ..Environment::default() };
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_header(["step in ms: median (least)", "bend sticks", "rigidity", "and friction"]);
    for (kind, side) in [("grid", 32), ("grid", 64), ("mesh", 32), ("mesh", 64)] {
        let mut islands = Vec::with_capacity(materials.len());
        for material in materials {
            islands.push(Island::of_body(sheet(kind, side, material)?));
        }
        let mut row = vec![format!("{kind} of {side} x {side}")];
        for mut times in in_turns(&mut islands, &environment, STEPS)? {
            let median = in_ms(median(&mut times));
            // They are in order now.
            row.push(format!("{median:.3} ({:.3})", in_ms(times[0])));
        }
        table.add_row(row);
    }
    Ok(table)
}

/// A sheet of 1 m x 1 m that hangs from its upper edge.
fn sheet(kind: &str, side: u32, material: ClothMaterial) -> Result<Body, Box<dyn Error>> {
    let grid = ClothBuilder::new(1.0, 1.0, side, side).material(material).pin_edge(Edge::Top);
    let grid = grid.build(BodySettings::default())?;
    if kind == "grid" {
        return Ok(grid);
    }
    let places = grid.particles.positions().collect();
    let mesh = MeshClothBuilder::new(places, grid.topology.faces().to_vec()).material(material);
    let mesh = (0..side).fold(mesh, MeshClothBuilder::pin);
    Ok(mesh.build(BodySettings::default())?)
}
