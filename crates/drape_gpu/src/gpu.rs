//! A device with compute shaders.

use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

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
    /// What went wrong on a device of our own; none if it is shared.
    failure: Option<Arc<Mutex<Option<String>>>>,
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
        let failure = Arc::default();
        let noted = Arc::clone(&failure);
        device.set_device_lost_callback(move |reason, message| note(&noted, format!("{reason:?} {message}")));
        // Else wgpu panics.
        let noted = Arc::clone(&failure);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| note(&noted, error.to_string())));
        Ok(Self { failure: Some(failure), ..Self::sharing(device, queue)? })
    }

    /// Shares a device that is open already, such as that of a renderer. Its owner hears of a loss or an error; here
    /// nothing is ever [lost](GpuError::Lost). Do not wait for a shared device after its loss: wgpu panics.
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
        Ok(Self { device, queue, adapter, failure: None })
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
        let Some(failure) = &self.failure else { return Ok(()) };
        let failure = failure.lock().unwrap_or_else(PoisonError::into_inner);
        failure.as_ref().map_or(Ok(()), |reason| Err(GpuError::Lost(reason.clone())))
    }

    /// Waits until everything that was submitted is done.
    ///
    /// # Errors
    /// [`GpuError::Lost`].
    pub fn wait(&self) -> Result<(), GpuError> {
        self.poll_by(wgpu::PollType::wait_indefinitely())
    }

    /// Notices what has finished, without waiting.
    ///
    /// # Errors
    /// [`GpuError::Lost`].
    pub fn poll(&self) -> Result<(), GpuError> {
        self.poll_by(wgpu::PollType::Poll)
    }

    /// Fails if a device of our own was lost. The owner of a shared one looks after it: wgpu panics if one polls it after its loss.
    pub(crate) fn notice_loss(&self) -> Result<(), GpuError> {
        if self.failure.is_some() { self.poll() } else { Ok(()) }
    }

    fn poll_by(&self, way: wgpu::PollType) -> Result<(), GpuError> {
        self.device.poll(way).map_err(GpuError::lost)?;
        self.check()
    }

    /// Asks for a part of a buffer, after all that was submitted.
    pub(crate) fn request(
        &self,
        buffer: &wgpu::Buffer,
        first: u64,
        bytes: u64,
    ) -> Result<PendingBytes, GpuError> {
        self.check()?;
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: bytes,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(buffer, first, &staging, 0, bytes);
        self.queue.submit([encoder.finish()]);
        let (sender, mapped) = channel();
        staging.slice(..).map_async(wgpu::MapMode::Read, move |result| {
            // Nobody listens any more if the request was dropped.
            let _ = sender.send(result);
        });
        Ok(PendingBytes { staging, mapped: Mutex::new(mapped) })
    }

    /// Reads a part of a buffer, once all that was submitted is done.
    pub(crate) fn read(&self, buffer: &wgpu::Buffer, first: u64, bytes: u64) -> Result<Vec<u8>, GpuError> {
        let pending = self.request(buffer, first, bytes)?;
        self.wait()?;
        // Another thread that waits for the device may be about to send it.
        pending.receiver().recv().map_err(GpuError::lost)?.map_err(GpuError::lost)?;
        pending.bytes()
    }
}

/// A part of a buffer that will come.
#[derive(Debug)]
pub(crate) struct PendingBytes {
    staging: wgpu::Buffer,
    /// In a mutex, so that a request can be kept where several threads see it.
    mapped: Mutex<Receiver<Result<(), wgpu::BufferAsyncError>>>,
}

impl PendingBytes {
    /// The bytes, if they have come and were not taken yet.
    pub fn try_take(&self) -> Result<Option<Vec<u8>>, GpuError> {
        let mapped = self.receiver().try_recv();
        match mapped {
            Err(TryRecvError::Empty) => return Ok(None),
            mapped => mapped.map_err(GpuError::lost)?.map_err(GpuError::lost)?,
        }
        self.bytes().map(Some)
    }

    fn receiver(&self) -> MutexGuard<'_, Receiver<Result<(), wgpu::BufferAsyncError>>> {
        self.mapped.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn bytes(&self) -> Result<Vec<u8>, GpuError> {
        Ok(self.staging.slice(..).get_mapped_range().map_err(GpuError::lost)?.to_vec())
    }
}

/// Notes the first failure.
fn note(failure: &Mutex<Option<String>>, reason: String) {
    failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(reason);
}
