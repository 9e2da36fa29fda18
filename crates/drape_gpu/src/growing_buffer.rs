//! A buffer on the GPU that grows.

use crate::error::GpuError;
use crate::gpu::Gpu;

/// A storage buffer with room to grow. Growing moves it: bind groups have to be made anew.
#[derive(Debug)]
pub(crate) struct GrowingBuffer {
    label: &'static str,
    buffer: wgpu::Buffer,
}

impl GrowingBuffer {
    const USAGES: wgpu::BufferUsages =
        wgpu::BufferUsages::STORAGE.union(wgpu::BufferUsages::COPY_DST).union(wgpu::BufferUsages::COPY_SRC);

    /// A buffer of a few bytes: bindings may not be empty.
    pub fn new(gpu: &Gpu, label: &'static str) -> Self {
        Self { label, buffer: Self::allocate(gpu, label, 256) }
    }

    fn allocate(gpu: &Gpu, label: &'static str, size: u64) -> wgpu::Buffer {
        let usage = Self::USAGES;
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage,
            mapped_at_creation: false,
        })
    }

    pub fn get(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// Makes room for so many bytes, and keeps the contents. Returns true if the buffer has moved.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the device has no buffers of that size.
    pub fn reserve(&mut self, gpu: &Gpu, bytes: u64) -> Result<bool, GpuError> {
        let old = self.buffer.size();
        if bytes <= old {
            return Ok(false);
        }
        let limits = gpu.device.limits();
        let (limit, name) = if limits.max_storage_buffer_binding_size < limits.max_buffer_size {
            (limits.max_storage_buffer_binding_size, "maxStorageBufferBindingSize")
        } else {
            (limits.max_buffer_size, "maxBufferSize")
        };
        let limit = limit - limit % 16;
        if bytes > limit {
            return Err(GpuError::Limit { what: self.label, needed: bytes, limit, name });
        }
        let size = bytes.max(old.saturating_mul(3) / 2).min(limit).next_multiple_of(16);
        let larger = Self::allocate(gpu, self.label, size);
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&self.buffer, 0, &larger, 0, old);
        gpu.queue.submit([encoder.finish()]);
        self.buffer = larger;
        Ok(true)
    }

    /// Writes `data` from byte `first` on. There has to be room.
    pub fn write(&self, gpu: &Gpu, first: u64, data: &[u8]) {
        gpu.queue.write_buffer(&self.buffer, first, data);
    }
}
