//! Time of the processor: what a process has computed, without the time for which it waited for a core.

use std::fs;
use std::path::Path;
use std::time::Duration;

/// Time that the present threads of this process have run so far, as Linux counts it: late by up to a tick of the scheduler,
/// so it is for seconds rather than for single steps. `None` where the system does not tell.
pub fn cpu_time() -> Option<Duration> {
    let threads = fs::read_dir("/proc/self/task").ok()?;
    // A thread that ends meanwhile is left out.
    let sum: Duration = threads.filter_map(|thread| of_thread(&thread.ok()?.path())).sum();
    (!sum.is_zero()).then_some(sum)
}

/// Time that the thread of this folder has run.
fn of_thread(folder: &Path) -> Option<Duration> {
    let text = fs::read_to_string(folder.join("schedstat")).ok()?;
    Some(Duration::from_nanos(text.split_whitespace().next()?.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// It looks at its own thread alone: tests that end beside it take their time out of the sum.
    #[test]
    fn a_thread_that_computes_is_seen_to() {
        let this = Path::new("/proc/thread-self");
        let Some(before) = of_thread(this) else { return };
        let passes = || {
            core::hint::black_box((0..1_000_000_u64).fold(0, |sum, i| sum ^ i.wrapping_mul(i)));
            of_thread(this) > Some(before)
        };
        assert!((0..1000).any(|_| passes()), "{before:?}, and no more");
        assert!(cpu_time().is_some_and(|all| all > before));
    }
}
