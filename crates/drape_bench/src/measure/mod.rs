//! Runs solvers on scenes, and measures time, stretch and memory.
//!
//! Imports `solvers` and `scenes`. Called by the program, by `report` and, for medians and times of the processor, by experiments.

pub mod cpu_time;
pub mod job;
pub mod median;
pub mod memory_pass;
pub mod stretch;
