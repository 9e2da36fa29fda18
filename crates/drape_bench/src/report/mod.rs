//! The results of `run` and `compare`: one outcome per job, as table, CSV, JSON, plot and remarks; those of `quality`; the progress bar.
//!
//! Imports the measurements of `measure`. Called by the program and, for JSON, plots and the bar, by experiments.

pub mod outcome;
pub mod plot;
pub mod progress;
pub mod quality;
pub mod remarks;
pub mod table;
