//! The whole bodies that torn ones come from.

use std::sync::Arc;

use drape_solver::Topology;

/// A body before its first tear, of which all its pieces know.
#[derive(Debug)]
pub(crate) struct WholeBody {
    /// Its order of creation, which the largest piece keeps.
    pub order: u64,
    pub topology: Arc<Topology>,
}

/// The past of a torn body, or of a piece of one.
#[derive(Clone, Debug)]
pub(crate) struct TornFrom {
    pub whole: Arc<WholeBody>,
    /// For each particle, that of the whole body.
    pub origins: Arc<[u32]>,
}

impl TornFrom {
    /// A body that is still whole.
    pub fn of_whole(order: u64, topology: &Arc<Topology>) -> Self {
        let origins = (0..topology.particle_count() as u32).collect();
        Self { whole: Arc::new(WholeBody { order, topology: Arc::clone(topology) }), origins }
    }

    /// The body, or a piece of it, after another tear, whose particles have these origins in the body before it.
    pub fn torn(&self, origins: &[u32]) -> Self {
        let origins = origins.iter().map(|&origin| self.origins[origin as usize]).collect();
        Self { whole: Arc::clone(&self.whole), origins }
    }
}
