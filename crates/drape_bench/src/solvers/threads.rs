//! Threads for the solver.

use drape_solver::Threads;
use rayon::ThreadPoolBuilder;

use crate::failure::Failure;

/// Runs `work` in a pool of `threads` threads, which the solver can use.
///
/// # Errors
/// [`Failure`] if they cannot be started.
pub fn on_threads<R: Send>(threads: u32, work: impl FnOnce() -> R + Send) -> Result<R, Failure> {
    if threads < 2 {
        return Ok(work());
    }
    // Each thread is pinned to its own core: a thread that wakes on the core of another waits there for milliseconds.
    let cores = core_affinity::get_core_ids().unwrap_or_default();
    let settle = move |thread: usize| {
        if let Some(&core) = cores.get(thread) {
            core_affinity::set_for_current(core);
        }
    };
    let pool = ThreadPoolBuilder::new().num_threads(threads as usize).start_handler(settle).build();
    pool.map(|pool| pool.install(work)).map_err(|error| Failure::Pool(error.to_string()))
}

/// The threads of the current pool.
pub struct RayonPool;

impl Threads for RayonPool {
    fn count(&self) -> usize {
        rayon::current_num_threads()
    }

    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        rayon::join(one, other);
    }
}
