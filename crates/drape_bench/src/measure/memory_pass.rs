//! Times one pass over memory, to compare the largest scene with: reading and writing all of its state once.

use std::hint::black_box;
use std::time::{Duration, Instant};

use super::median::median;

/// Floats of state per particle: position, displacement and inverse mass.
const FLOATS: usize = 7;
/// Number of passes. The median counts.
const PASSES: usize = 9;

/// One thread's pass over memory.
#[derive(Clone, Copy, Debug)]
pub struct MemoryPass {
    /// Its duration.
    pub time: Duration,
    /// The number of bytes that it read and wrote.
    pub bytes: usize,
}

impl MemoryPass {
    /// Reads and writes every float of the state of `particles` particles, column by column.
    pub fn measure(particles: usize) -> Self {
        let mut columns = vec![vec![1.0_f32; particles]; FLOATS];
        let mut passes: Vec<Duration> = (0..PASSES).map(|_| pass(&mut columns)).collect();
        Self { time: median(&mut passes), bytes: FLOATS * size_of::<f32>() * particles }
    }
}

fn pass(columns: &mut [Vec<f32>]) -> Duration {
    let start = Instant::now();
    for column in black_box(&mut *columns) {
        for x in column {
            *x += 1.0;
        }
    }
    black_box(&mut *columns);
    start.elapsed()
}
