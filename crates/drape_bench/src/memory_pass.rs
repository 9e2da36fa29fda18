//! The yardstick of the largest scene: reading and writing all of its state once.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Floats of state per particle: position, displacement and inverse mass.
const FLOATS: usize = 7;
/// Passes, of which the median counts.
const PASSES: usize = 9;

/// One thread's pass over memory.
#[derive(Clone, Copy, Debug)]
pub struct MemoryPass {
    /// How long it took.
    pub time: Duration,
    /// What it read and wrote, in bytes.
    pub bytes: usize,
}

impl MemoryPass {
    /// Reads and writes every float of the state of `particles` particles, column by column.
    pub fn measure(particles: usize) -> Self {
        let mut columns = vec![vec![1.0_f32; particles]; FLOATS];
        let mut passes: Vec<Duration> = (0..PASSES).map(|_| pass(&mut columns)).collect();
        passes.sort_unstable();
        Self { time: passes[PASSES / 2], bytes: FLOATS * size_of::<f32>() * particles }
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
