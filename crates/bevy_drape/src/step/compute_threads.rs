//! The worker threads for islands and large bodies.

use bevy::tasks::{ComputeTaskPool, TaskPool};
use drape_solver::Threads;

/// The threads of the compute pool, for the work on a large body.
pub(crate) struct ComputeThreads;

impl Threads for ComputeThreads {
    /// Includes the calling thread, which may be outside the pool.
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
