//! substep.

pub(crate) mod plan;
pub(crate) mod sweep;
pub(crate) mod work;
