//! The worker threads for islands and large bodies.

use std::num::NonZero;
use std::sync::LazyLock;
use std::thread::available_parallelism;

use bevy::tasks::{ComputeTaskPool, TaskPool};
use drape_solver::Threads;

/// The threads of the compute pool, for the work on a large body.
pub(crate) struct ComputeThreads;

impl Threads for ComputeThreads {
    /// Includes the calling thread, which may be outside the pool; but no more threads than cores. A pool has a thread even on a
    /// single core, where it would take the leader's time to wait for work.
    fn count(&self) -> usize {
        (1 + pool().thread_num()).min(*CORES)
    }

    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        pool().scope(|scope| {
            scope.spawn(async move { other() });
            one();
        });
    }
}

static CORES: LazyLock<usize> = LazyLock::new(|| available_parallelism().map_or(1, NonZero::get));

pub(super) fn pool() -> &'static TaskPool {
    ComputeTaskPool::get_or_init(TaskPool::default)
}
