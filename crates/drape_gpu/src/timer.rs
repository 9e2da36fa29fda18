//! Times a step on the GPU's own clock.

use std::time::Duration;

use crate::error::GpuError;
use crate::gpu::Gpu;

/// Two times of the GPU's clock: when a step began, and when it ended.
#[derive(Debug)]
pub(crate) struct Timer {
    times: wgpu::QuerySet,
    buffer: wgpu::Buffer,
    /// Seconds.
    tick: f64,
}

impl Timer {
    /// A timer; none if the device has no clock.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        if !gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        let times = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("times"),
            ty: wgpu::QueryType::Timestamp,
            count: 2,
        });
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("times"),
            size: 16,
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        Some(Self { times, buffer, tick: f64::from(gpu.queue.get_timestamp_period()) * 1e-9 })
    }

    /// Has a pass write both times.
    pub fn writes(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.times,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Copies the times to where they can be read.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.times, 0..2, &self.buffer, 0);
    }

    /// The time between the two.
    pub fn read(&self, gpu: &Gpu) -> Result<Duration, GpuError> {
        let bytes = gpu.read(&self.buffer, 0, 16)?;
        let [begin, end]: [u64; 2] = bytemuck::pod_read_unaligned(&bytes);
        Ok(Duration::from_secs_f64(end.saturating_sub(begin) as f64 * self.tick))
    }
}
