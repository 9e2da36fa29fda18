//! The results of `run` and `compare`: one outcome per job, as table, CSV, JSON, plot and remarks.
//!
//! Imports the measurements of `measure`. Called by the program.

pub mod outcome;
pub mod plot;
pub mod remarks;
pub mod table;
