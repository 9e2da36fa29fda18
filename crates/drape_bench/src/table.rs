//! The table: on screen, as CSV and as JSON.

use std::path::{Path, PathBuf};
use std::{fs, io};

use comfy_table::{CellAlignment, Table, presets};
use thiserror::Error;

use crate::contender::Solver;
use crate::run::Outcome;

/// A table that could not be written.
#[derive(Debug, Error)]
#[error("cannot write {path}: {source}")]
pub struct TableError {
    path: PathBuf,
    source: io::Error,
}

/// Fills in how many times faster than the naive loop each solver is at its size.
pub fn fill_ratios(outcomes: &mut [Outcome]) {
    let naive: Vec<(u32, f64)> = outcomes
        .iter()
        .filter(|outcome| outcome.solver == Solver::Naive.name())
        .map(|outcome| (outcome.n, outcome.ms_median))
        .collect();
    for outcome in outcomes {
        let same_size = naive.iter().find(|(n, _)| *n == outcome.n);
        outcome.ratio_to_naive = same_size.map(|(_, ms)| ms / outcome.ms_median);
    }
}

/// Prints the table.
pub fn print(outcomes: &[Outcome]) {
    let mut table = Table::new();
    table.load_preset(presets::UTF8_HORIZONTAL_ONLY).set_header([
        "solver",
        "n",
        "isa",
        "ms median",
        "ms min",
        "ns/stick",
        "x naive",
        "rms motion %",
        "max motion %",
        "rms end %",
        "max end %",
        "energy",
    ]);
    for o in outcomes {
        table.add_row([
            o.solver.to_owned(),
            o.n.to_string(),
            o.isa.to_owned(),
            format!("{:.3}", o.ms_median),
            format!("{:.3}", o.ms_min),
            format!("{:.2}", o.ns_per_stick_sweep),
            o.ratio_to_naive.map_or(String::new(), |ratio| format!("{ratio:.2}")),
            format!("{:.3}", o.stretch_rms_motion * 100.0),
            format!("{:.2}", o.stretch_max_motion * 100.0),
            format!("{:.3}", o.stretch_rms_end * 100.0),
            format!("{:.2}", o.stretch_max_end * 100.0),
            format!("{:.3}", o.energy_end_over_start),
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
    let write = || -> Result<(), io::Error> {
        let mut writer = csv::Writer::from_path(path)?;
        for outcome in outcomes {
            writer.serialize(outcome)?;
        }
        writer.flush()
    };
    write().map_err(|source| TableError { path: path.to_path_buf(), source })
}

/// Writes all columns as JSON.
///
/// # Errors
/// [`TableError`] naming the file.
pub fn write_json(path: &Path, outcomes: &[Outcome]) -> Result<(), TableError> {
    let text = serde_json::to_string_pretty(outcomes).map_err(io::Error::from);
    text.and_then(|text| fs::write(path, text))
        .map_err(|source| TableError { path: path.to_path_buf(), source })
}
