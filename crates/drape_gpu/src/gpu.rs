//! A device with compute shaders.

use std::sync::{Arc, Mutex, PoisonError};

use crate::error::GpuError;

/// Storage buffers that the kernels of large bodies bind at once. WebGPU allows 8 everywhere and 10 almost everywhere.
const STORAGE_BUFFERS: u32 = 10;

/// Threads of the largest workgroup that every device has to have.
const THREADS: u32 = 256;

/// A device and its queue. Clones share them.
#[derive(Clone, Debug)]
pub struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    adapter: String,
    failure: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Opens the fastest adapter there is, software included. Not in a browser, where nothing may wait: there, [share](Self::sharing) the device of a
    /// renderer.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] or [`GpuError::NoDevice`].
    pub fn open() -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter =
            pollster::block_on(instance.request_adapter(&options)).map_err(|_| GpuError::NoAdapter)?;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("drape_gpu"),
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: adapter.limits(),
            memory_hints: wgpu::MemoryHints::Performance,
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| GpuError::NoDevice(error.to_string()))?;
        let gpu = Self::sharing(device, queue)?;
        let failure = Arc::clone(&gpu.failure);
        gpu.device
            .set_device_lost_callback(move |reason, message| note(&failure, format!("{reason:?} {message}")));
        // Else wgpu panics.
        let failure = Arc::clone(&gpu.failure);
        gpu.device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| note(&failure, error.to_string())));
        Ok(gpu)
    }

    /// Shares a device that is open already, such as that of a renderer. Its owner hears of a loss or an error; here
    /// nothing is ever [lost](GpuError::Lost).
    ///
    /// # Errors
    /// [`GpuError::Limit`] if it allows too few storage buffers or threads.
    pub fn sharing(device: wgpu::Device, queue: wgpu::Queue) -> Result<Self, GpuError> {
        let limits = device.limits();
        for (needed, limit, name) in [
            (STORAGE_BUFFERS, limits.max_storage_buffers_per_shader_stage, "maxStorageBuffersPerShaderStage"),
            (THREADS, limits.max_compute_invocations_per_workgroup, "maxComputeInvocationsPerWorkgroup"),
            (THREADS, limits.max_compute_workgroup_size_x, "maxComputeWorkgroupSizeX"),
        ] {
            if limit < needed {
                return Err(GpuError::Limit {
                    what: "a kernel",
                    needed: needed.into(),
                    limit: limit.into(),
                    name,
                });
            }
        }
        let adapter = device.adapter_info().name;
        Ok(Self { device, queue, adapter, failure: Arc::default() })
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// Its queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// Name of the adapter.
    pub fn adapter_name(&self) -> &str {
        &self.adapter
    }

    /// Fails if the device was lost.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        let failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        failure.as_ref().map_or(Ok(()), |reason| Err(GpuError::Lost(reason.clone())))
    }

    /// Waits until everything that was submitted is done.
    ///
    /// # Errors
    /// [`GpuError::Lost`].
    pub fn wait(&self) -> Result<(), GpuError> {
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        polled.map_err(|error| GpuError::Lost(error.to_string()))?;
        self.check()
    }

    /// Notices what has finished, without waiting.
    ///
    /// # Errors
    /// [`GpuError::Lost`].
    pub fn poll(&self) -> Result<(), GpuError> {
        let polled = self.device.poll(wgpu::PollType::Poll);
        polled.map_err(|error| GpuError::Lost(error.to_string()))?;
        self.check()
    }

    /// Copies a part of a buffer to one that can be mapped.
    pub(crate) fn copy_to_staging(&self, buffer: &wgpu::Buffer, first: u64, bytes: u64) -> wgpu::Buffer {
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: bytes,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(buffer, first, &staging, 0, bytes);
        self.queue.submit([encoder.finish()]);
        staging
    }

    /// Reads a part of a buffer, once all that was submitted is done.
    pub(crate) fn read(&self, buffer: &wgpu::Buffer, first: u64, bytes: u64) -> Result<Vec<u8>, GpuError> {
        self.check()?;
        let staging = self.copy_to_staging(buffer, first, bytes);
        let (sender, receiver) = std::sync::mpsc::channel();
        staging.slice(..).map_async(wgpu::MapMode::Read, move |result| {
            // Nobody listens any more if waiting has failed.
            let _ = sender.send(result);
        });
        self.wait()?;
        let lost = |reason: String| GpuError::Lost(reason);
        receiver.recv().map_err(|error| lost(error.to_string()))?.map_err(|error| lost(error.to_string()))?;
        let view = staging.slice(..).get_mapped_range().map_err(|error| lost(error.to_string()))?;
        Ok(view.to_vec())
    }
}

/// Notes the first failure.
fn note(failure: &Mutex<Option<String>>, reason: String) {
    failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(reason);
}
