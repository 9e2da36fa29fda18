//! Medians of times.

use std::time::{Duration, Instant};

use drape_solver::{Environment, Island, StepError, step};

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

/// The times of `repeat` steps of each island, taken in turns.
///
/// # Errors
/// As [`step()`].
pub fn in_turns(
    islands: &mut [Island],
    environment: &Environment,
    repeat: u32,
) -> Result<Vec<Vec<Duration>>, StepError> {
    let mut times = vec![Vec::new(); islands.len()];
    for _ in 0..repeat {
        for (times, island) in times.iter_mut().zip(&mut *islands) {
            let began = Instant::now();
            step(island, environment)?;
            times.push(began.elapsed());
        }
    }
    Ok(times)
}

/// A time in milliseconds.
pub fn in_ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
