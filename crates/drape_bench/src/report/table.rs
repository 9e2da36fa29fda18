//! The table: on screen, as CSV and as JSON.

use std::path::{Path, PathBuf};
use std::{fs, io};

use clap::ValueEnum;
use comfy_table::{CellAlignment, Table, presets};
use serde::Serialize;
use thiserror::Error;

use crate::report::outcome::Outcome;

/// A file that could not be written.
#[derive(Debug, Error)]
#[error("cannot write {path}: {source}")]
pub struct TableError {
    path: PathBuf,
    source: io::Error,
}

/// Prints the table.
pub fn print(outcomes: &[Outcome]) {
    let mut table = Table::new();
    table.load_preset(presets::UTF8_HORIZONTAL_ONLY).set_header([
        "scene",
        "n",
        "solver",
        "threads",
        "isa",
        "ms median",
        "ms min",
        "ns/stick",
        "x naive",
        "rms motion %",
        "p99 motion %",
        "max motion %",
        "rms end %",
        "max end %",
        "bytes",
        "energy",
    ]);
    let percent = |x: f64| format!("{:.3}", x * 100.0);
    for o in outcomes {
        table.add_row([
            o.scene.to_owned(),
            o.n.to_string(),
            o.solver.to_owned(),
            o.threads.to_string(),
            o.isa.to_owned(),
            format!("{:.3}", o.ms_median),
            format!("{:.3}", o.ms_min),
            format!("{:.2}", o.ns_per_stick_sweep),
            o.ratio_to_naive.map_or(String::new(), |ratio| format!("{ratio:.2}")),
            percent(o.stretch_rms_motion),
            percent(o.stretch_p99_motion),
            percent(o.stretch_max_motion),
            percent(o.stretch_rms_end),
            percent(o.stretch_max_end),
            o.bytes_per_particle.map_or(String::new(), |bytes| format!("{bytes:.0}")),
            o.energy_end_over_start.map_or(String::new(), |energy| format!("{energy:.3}")),
        ]);
    }
    for column in table.column_iter_mut() {
        column.set_cell_alignment(CellAlignment::Right);
    }
    println!("{table}");
}

/// Writes all columns as comma-separated values.
///
/// # Errors
/// [`TableError`] naming the file.
pub fn write_csv(path: &Path, outcomes: &[Outcome]) -> Result<(), TableError> {
    let write = || -> Result<(), io::Error> { rows(csv::Writer::from_path(path)?, outcomes) };
    write().map_err(|source| TableError { path: path.to_path_buf(), source })
}

fn rows(mut writer: csv::Writer<impl io::Write>, outcomes: &[Outcome]) -> Result<(), io::Error> {
    for outcome in outcomes {
        writer.serialize(outcome)?;
    }
    writer.flush()
}

/// The name of a value on the command line.
pub fn name_of(value: &impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// Writes results as JSON.
///
/// # Errors
/// [`TableError`] naming the file.
pub fn write_json(path: &Path, results: &impl Serialize) -> Result<(), TableError> {
    let text = serde_json::to_string_pretty(results).map_err(io::Error::from);
    text.and_then(|text| fs::write(path, text))
        .map_err(|source| TableError { path: path.to_path_buf(), source })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::model::Pins;

    #[test]
    fn the_columns_are_the_ones_that_were_promised() {
        let outcome = Outcome {
            scene: "sheet",
            solver: "drape",
            n: 8,
            substeps: 1,
            sweeps: 1,
            pins: Pins::Edge,
            threads: 1,
            isa: "scalar",
            sticks: 1,
            ms_median: 1.0,
            ms_min: 1.0,
            ns_per_stick_sweep: 1.0,
            ratio_to_naive: None,
            stretch_rms_end: 0.0,
            stretch_max_end: 0.0,
            stretch_rms_motion: 0.0,
            stretch_p99_motion: 0.0,
            stretch_max_motion: 0.0,
            bytes_per_particle: None,
            energy_end_over_start: None,
            state_hash: String::new(),
            is_repeatable: true,
            memory_pass: None,
        };
        let mut text = Vec::new();
        rows(csv::Writer::from_writer(&mut text), &[outcome]).expect("memory can be written");
        let text = String::from_utf8(text).expect("text");
        assert_eq!(
            text.lines().next(),
            Some(
                "scene,solver,n,substeps,sweeps,pins,threads,isa,sticks,ms_median,ms_min,ns_per_stick_sweep,\
                 ratio_to_naive,stretch_rms_end,stretch_max_end,stretch_rms_motion,stretch_p99_motion,\
                 stretch_max_motion,bytes_per_particle,energy_end_over_start,state_hash"
            )
        );
    }
}
