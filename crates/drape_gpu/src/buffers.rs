//! The buffers of a world, and the bind groups made of them.

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::growing_buffer::GrowingBuffer;
use crate::kernels::{Kernels, bind};
use crate::layout::{SizeClassData, StepData};
use crate::source::SIZE_CLASSES;

/// Bytes of a pair of words.
const PAIR: u64 = 8;

/// Buffers that shaders read and write.
#[derive(Debug)]
pub(crate) struct Buffers {
    pub step: wgpu::Buffer,
    pub obstacles: GrowingBuffer,
    pub bodies: GrowingBuffer,
    pub batches: GrowingBuffer,
    pub pairs: GrowingBuffer,
    /// The number of pairs that are in use.
    pair_count: u32,
    /// Positions of all bodies. Tiles of grids write to the second buffer what they have read from the first, and the other
    /// way round.
    pub positions: [GrowingBuffer; 2],
    pub displacements: GrowingBuffer,
    /// Targets of pins in a step.
    pub pin_targets: GrowingBuffer,
    pub statuses: GrowingBuffer,
    /// Large bodies keep these of each particle within a substep.
    pub flights: GrowingBuffer,
    pub accelerations: GrowingBuffer,
    /// Sums of pushes on obstacles.
    pub reactions: GrowingBuffer,
    /// The bodies of each size class.
    pub size_classes: [wgpu::Buffer; SIZE_CLASSES.len()],
    /// Each dispatch of a large body reads its own part.
    pub dispatches: wgpu::Buffer,
    groups: Option<Groups>,
}

/// Bind groups, until a buffer moves.
#[derive(Debug)]
pub(crate) struct Groups {
    /// Group 0, by the buffer of positions.
    pub common: [wgpu::BindGroup; 2],
    pub small: [wgpu::BindGroup; SIZE_CLASSES.len()],
    pub large: wgpu::BindGroup,
    /// By the buffer of positions that is read.
    pub grid: [wgpu::BindGroup; 2],
}

impl Buffers {
    pub fn new(gpu: &Gpu) -> Self {
        let growing = |label| GrowingBuffer::new(gpu, label);
        Self {
            step: uniform(gpu, "step", size_of::<StepData>() as u64),
            obstacles: growing("obstacles"),
            bodies: growing("bodies"),
            batches: growing("batches of sticks"),
            pairs: growing("sticks, tethers, faces and distances"),
            pair_count: 0,
            positions: [growing("positions"), growing("positions of grids")],
            displacements: growing("displacements"),
            pin_targets: growing("targets of pins"),
            statuses: growing("statuses"),
            flights: growing("flights"),
            accelerations: growing("accelerations"),
            reactions: growing("reactions"),
            size_classes: core::array::from_fn(|_| {
                uniform(gpu, "size class", size_of::<SizeClassData>() as u64)
            }),
            dispatches: uniform(gpu, "dispatches", 256),
            groups: None,
        }
    }

    /// Makes room for so many bytes in a buffer that `choose` names.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the device has no buffers of that size.
    pub fn reserve(
        &mut self,
        gpu: &Gpu,
        bytes: u64,
        choose: impl FnOnce(&mut Self) -> &mut GrowingBuffer,
    ) -> Result<(), GpuError> {
        if choose(self).reserve(gpu, bytes)? {
            self.groups = None;
        }
        Ok(())
    }

    /// Appends pairs of words, which stay. Returns the index of the first.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the device has no buffers of that size.
    pub fn push_pairs(&mut self, gpu: &Gpu, pairs: &[[u32; 2]]) -> Result<u32, GpuError> {
        let first = self.pair_count;
        let end = u64::from(first) + pairs.len() as u64;
        self.reserve(gpu, PAIR * end, |buffers| &mut buffers.pairs)?;
        self.pairs.write(gpu, PAIR * u64::from(first), bytemuck::cast_slice(pairs));
        self.pair_count = end as u32;
        Ok(first)
    }

    /// Makes room for what the dispatches of large bodies read, each at a multiple of [`dispatch_stride`].
    ///
    /// # Errors
    /// [`GpuError::Limit`] if there are too many.
    pub fn reserve_dispatches(&mut self, gpu: &Gpu, bytes: u64) -> Result<(), GpuError> {
        // Offsets have 32 bits.
        let limit = gpu.device.limits().max_buffer_size.min(u64::from(u32::MAX));
        if bytes > limit {
            let what = "the list of dispatches: substeps times iterations of large bodies";
            return Err(GpuError::Limit { what, needed: bytes, limit, name: "maxBufferSize" });
        }
        if bytes > self.dispatches.size() {
            self.dispatches = uniform(gpu, "dispatches", bytes);
            self.groups = None;
        }
        Ok(())
    }

    /// The bind groups, made anew if a buffer has moved.
    pub fn groups(&mut self, gpu: &Gpu, kernels: &Kernels) -> &Groups {
        let groups = self.groups.take().unwrap_or_else(|| self.make_groups(gpu, kernels));
        self.groups.insert(groups)
    }

    fn make_groups(&self, gpu: &Gpu, kernels: &Kernels) -> Groups {
        let common = |side: usize| {
            let bound = [
                &self.step,
                self.obstacles.get(),
                self.bodies.get(),
                self.batches.get(),
                self.pairs.get(),
                self.positions[side].get(),
                self.displacements.get(),
            ];
            bind(gpu, &kernels.common, bound.map(whole))
        };
        let dispatch = || {
            wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &self.dispatches,
                offset: 0,
                size: wgpu::BufferSize::new(size_of::<crate::layout::DispatchData>() as u64),
            })
        };
        let grid =
            |side: usize| bind(gpu, &kernels.grid, [dispatch(), whole(self.positions[1 - side].get())]);
        Groups {
            common: [common(0), common(1)],
            small: core::array::from_fn(|class| {
                bind(
                    gpu,
                    &kernels.small,
                    [&self.size_classes[class], self.statuses.get(), self.reactions.get()].map(whole),
                )
            }),
            large: {
                let flights = [&self.flights, &self.accelerations, &self.statuses, &self.reactions];
                let [a, b, c, d] = flights.map(|buffer| whole(buffer.get()));
                bind(gpu, &kernels.large, [dispatch(), a, b, c, d])
            },
            grid: [grid(0), grid(1)],
        }
    }
}

/// Bytes from one dispatch's data to that of the next.
pub(crate) fn dispatch_stride(gpu: &Gpu) -> u64 {
    let aligned = u64::from(gpu.device.limits().min_uniform_buffer_offset_alignment);
    (size_of::<crate::layout::DispatchData>() as u64).next_multiple_of(aligned)
}

fn uniform(gpu: &Gpu, label: &str, size: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: false,
    })
}

fn whole(buffer: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    buffer.as_entire_binding()
}
