//! Time of the processor: what a process has computed, without the time for which it waited for a core.

use std::fs;
use std::time::Duration;

/// Time that the present threads of this process have run so far, as Linux counts it: late by up to a tick of the scheduler,
/// so it is for seconds rather than for single steps. `None` where the system does not tell.
pub fn cpu_time() -> Option<Duration> {
    let threads = fs::read_dir("/proc/self/task").ok()?;
    let mut sum = Duration::ZERO;
    for thread in threads {
        // A thread that ends meanwhile is left out.
        if let Ok(text) = fs::read_to_string(thread.ok()?.path().join("schedstat")) {
            sum += Duration::from_nanos(text.split_whitespace().next()?.parse().ok()?);
        }
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_that_computes_is_seen_to() {
        let Some(before) = cpu_time() else { return };
        let passes = || {
            core::hint::black_box((0..1_000_000_u64).fold(0, |sum, i| sum ^ i.wrapping_mul(i)));
            cpu_time() > Some(before)
        };
        assert!((0..1000).any(|_| passes()), "{before:?}, and no more");
    }
}
