//! Columns of sixteen lanes, and the instruction sets that kernels run on.
//!
//! Imports: nothing. Callers: every kernel.

pub(crate) mod columns;
pub mod isa;
pub(crate) mod lanes;
#[cfg(test)]
pub(crate) mod miri;
pub(crate) mod rows;
pub(crate) mod transpose;
