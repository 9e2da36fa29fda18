//! direct.

pub(crate) mod chain;
pub(crate) mod line;
pub(crate) mod lone_chain;
