//! Threads and numbers for tests.

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

/// Numbers from -1 to 1 that look random.
pub(crate) fn dice(seed: u64) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 23) as f32 - 1.0
    }
}
