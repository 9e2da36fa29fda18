//! Threads that the work on a large body is shared out to. The solver starts none: it is lent those of its host.

/// Something that can run two things at once.
///
/// The result of a step does not depend on it: no particle ever meets its neighbours in another order.
pub trait Threads: Sync {
    /// How many there are, with the one that calls.
    fn count(&self) -> usize;

    /// Runs both, at the same time if it can, and returns when both are through. Must not allocate where a step shall
    /// not.
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
