//! Threads that the work on a large body is shared out to. The solver starts none: it is lent those of its host.

/// Something that can run two things at once.
///
/// The result of a step does not depend on it: no particle ever meets its neighbours in another order.
pub trait Threads: Sync {
    /// How many there are, with the one that calls.
    fn count(&self) -> usize;

    /// Runs both, and returns when both are through: `one` at once, on the thread that calls; `other` on another at the
    /// same time, or after `one`. Never the other way round, as `other` may wait for what `one` does.
    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send));
}

/// The thread that calls, and no other.
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
