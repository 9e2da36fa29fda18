//! The threads that islands and large bodies are spread over.

use bevy::tasks::{ComputeTaskPool, TaskPool};
use drape_solver::Threads;

/// The threads of the compute pool, for the sharing out of a large body.
pub(crate) struct ComputeThreads;

impl Threads for ComputeThreads {
    /// With the one that calls, which need not be the pool's.
    fn count(&self) -> usize {
        1 + pool().thread_num()
    }

    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        pool().scope(|scope| {
            scope.spawn(async move { other() });
            one();
        });
    }
}

pub(super) fn pool() -> &'static TaskPool {
    ComputeTaskPool::get_or_init(TaskPool::default)
}
