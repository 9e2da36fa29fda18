//! The command line, and the program that runs it.
//!
//! Imports all other floors. `main` of this crate and of the peers call [`main_with`](program::main_with).

pub mod arguments;
pub mod program;
