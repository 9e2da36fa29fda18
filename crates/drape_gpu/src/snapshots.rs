//! Positions before and after the last step, for whoever draws between two steps.
//!
//! A renderer may still draw one frame while the next one is stepped. So there are two pairs, and a frame that steps uses the one that the frame
//! before did not.
//!
//! ```text
//!   frame 1   steps into pair 0       drawn from pair 0
//!   frame 2   steps into pair 1       drawn from pair 1, while frame 3 steps into pair 0
//!   frame 3   no step: still drawn from pair 1, by another fraction
//! ```

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::growing_buffer::GrowingBuffer;

/// Two pairs of buffers of positions.
#[derive(Debug)]
pub(crate) struct Snapshots {
    pairs: [[GrowingBuffer; 2]; 2],
    /// The pair of the last step.
    current: usize,
    /// True until the first step of a frame.
    is_new_frame: bool,
    /// True once there was a step.
    has_step: bool,
}

impl Snapshots {
    pub fn new(gpu: &Gpu) -> Self {
        let pair =
            || ["positions before a step", "positions after it"].map(|label| GrowingBuffer::new(gpu, label));
        Self { pairs: [pair(), pair()], current: 0, is_new_frame: true, has_step: false }
    }

    /// The next step uses the other pair.
    pub fn begin_frame(&mut self) {
        self.is_new_frame = true;
    }

    /// Makes room for so many bytes of positions.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the device has no buffers of that size.
    pub fn reserve(&mut self, gpu: &Gpu, bytes: u64) -> Result<(), GpuError> {
        self.pairs.iter_mut().flatten().try_for_each(|buffer| buffer.reserve(gpu, bytes).map(drop))
    }

    /// Copies `positions` before a step.
    pub fn note_before(&mut self, encoder: &mut wgpu::CommandEncoder, positions: &wgpu::Buffer, bytes: u64) {
        if core::mem::take(&mut self.is_new_frame) {
            self.current = 1 - self.current;
        }
        self.has_step = true;
        encoder.copy_buffer_to_buffer(positions, 0, self.pairs[self.current][0].get(), 0, bytes);
    }

    /// Copies `positions` after it.
    pub fn note_after(&self, encoder: &mut wgpu::CommandEncoder, positions: &wgpu::Buffer, bytes: u64) {
        encoder.copy_buffer_to_buffer(positions, 0, self.pairs[self.current][1].get(), 0, bytes);
    }

    /// Positions before and after the last step; none before the first step.
    pub fn last(&self) -> Option<[&wgpu::Buffer; 2]> {
        self.has_step.then(|| self.pairs[self.current].each_ref().map(GrowingBuffer::get))
    }
}
