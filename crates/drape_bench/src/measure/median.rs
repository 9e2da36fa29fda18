//! Medians of times.

use std::time::Duration;

/// The median of `times`, which are sorted then.
///
/// # Panics
/// If there are none.
pub fn median(times: &mut [Duration]) -> Duration {
    times.sort_unstable();
    times[times.len() / 2]
}

/// The median of `times` in microseconds.
///
/// # Panics
/// If there are none.
pub fn median_us(mut times: Vec<Duration>) -> f64 {
    median(&mut times).as_secs_f64() * 1e6
}

/// A time in milliseconds.
pub fn in_ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
