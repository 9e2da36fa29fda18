//! Threads that share the work on large bodies and islands. The solver starts none; its host lends them.
//!
//! Design: `docs/design/sweeps_and_threads.md`.

/// A thread pool that can run two closures at once.
///
/// The result of a step does not depend on it: every particle meets its neighbours in the same order.
pub trait Threads: Sync {
    /// The number of threads, including the calling one.
    fn count(&self) -> usize;

    /// Runs both closures and returns when both have ended: `one` at once on the calling thread, `other` on another
    /// thread at the same time, or after `one`. Never run `other` first, as it may wait for the results of `one`.
    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send));
}

/// The calling thread alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Threads for Alone {
    fn count(&self) -> usize {
        1
    }

    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        one();
        other();
    }
}
