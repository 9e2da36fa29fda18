//! Scenes of self-contact and tight contact: what a step costs, and how many edges pass through triangles.
//!
//! Imports the solver, threads of `solvers` and times of `measure`. The program calls `report`.

pub mod cloths;
pub mod narrows;
pub mod report;
pub mod ropes;
pub mod scene;
pub mod setup;
pub mod trial;
