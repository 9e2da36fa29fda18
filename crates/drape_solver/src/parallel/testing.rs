//! Threads for the tests of this floor.

use crate::parallel::threads::Threads;

/// Threads of the standard library, a new one for each call.
pub(crate) struct Fresh(pub usize);

impl Threads for Fresh {
    fn count(&self) -> usize {
        self.0
    }

    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        // It has no threads.
        if cfg!(target_family = "wasm") {
            one();
            other();
            return;
        }
        std::thread::scope(|scope| {
            scope.spawn(other);
            one();
        });
    }
}
