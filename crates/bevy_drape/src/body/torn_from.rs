//! The whole bodies that torn ones come from.

use std::collections::BTreeSet;
use std::sync::Arc;

use drape_solver::Topology;
#[cfg(feature = "mesh")]
use drape_solver::TornPast;

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
    /// The edges along which the whole body has torn so far, by its particles, the lower index first, tear by tear.
    pub torn_edges: Arc<[[u32; 2]]>,
}

impl TornFrom {
    /// The same for the solver.
    #[cfg(feature = "mesh")]
    pub fn past(&self) -> TornPast<'_> {
        let Self { whole, origins, torn_edges } = self;
        TornPast { whole: &whole.topology, origins, edges: torn_edges, seed: whole.order }
    }

    /// A body that is still whole.
    pub fn of_whole(order: u64, topology: &Arc<Topology>) -> Self {
        let origins = (0..topology.particle_count() as u32).collect();
        let whole = Arc::new(WholeBody { order, topology: Arc::clone(topology) });
        Self { whole, origins, torn_edges: [].into() }
    }

    /// The body, or a piece of it, after another tear, whose particles have these origins in the body before it.
    pub fn torn(&self, origins: &[u32]) -> Self {
        let origins = origins.iter().map(|&origin| self.origins[origin as usize]).collect();
        Self { origins, ..self.clone() }
    }

    /// The same, torn along more edges, by its own particles.
    pub fn torn_along(self, edges: &[[u32; 2]]) -> Self {
        if edges.is_empty() {
            return self;
        }
        let of_whole = |&[a, b]: &[u32; 2]| {
            let [p, q] = [a, b].map(|end| self.origins[end as usize]);
            [p.min(q), p.max(q)]
        };
        let mut known: BTreeSet<[u32; 2]> = self.torn_edges.iter().copied().collect();
        let added = edges.iter().map(of_whole).filter(|&edge| known.insert(edge));
        Self { torn_edges: self.torn_edges.iter().copied().chain(added).collect(), ..self }
    }
}
