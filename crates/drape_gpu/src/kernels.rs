//! The compute pipelines, and what they bind.

use std::sync::OnceLock;

use crate::gpu::Gpu;
use crate::source::{
    Extras, HALO, SIZE_CLASSES, SizeClass, TILE_WORKGROUP, TILES, grid_source, large_source, pin_source,
    small_source, surface_source, tube_source,
};

/// So many bodies of a size class fill a large GPU several times.
const CROWD: u32 = 1024;

/// Bytes of shared memory that a kernel needs besides positions.
const SHARED_BESIDES: u32 = 512;

/// Bytes of a position in shared memory.
const POSITION: u32 = 16;

/// Kernels that are compiled when they are first needed.
#[derive(Debug)]
pub(crate) struct Kernels {
    /// All kernels bind it as group 0.
    pub common: wgpu::BindGroupLayout,
    /// Group 1 of the kernel of small bodies.
    pub small: wgpu::BindGroupLayout,
    /// Group 1 of the kernels of large bodies.
    pub large: wgpu::BindGroupLayout,
    /// Group 1 of the kernel of tiles.
    pub grid: wgpu::BindGroupLayout,
    /// Columns and rows of a tile; none if the shared memory is too small for tiles.
    pub tile: Option<[u32; 2]>,
    /// Threads of a tile's workgroup.
    tile_threads: u32,
    /// Bytes of a workgroup's shared memory.
    shared: u32,
    /// By size class, each alone and in a crowd, without extras and with them.
    small_steps: [[[OnceLock<wgpu::ComputePipeline>; 2]; 2]; SIZE_CLASSES.len()],
    large_steps: [OnceLock<LargeKernels>; 2],
    grid_step: OnceLock<wgpu::ComputePipeline>,
}

/// The kernels of large bodies.
#[derive(Debug)]
pub(crate) struct LargeKernels {
    pub begin: wgpu::ComputePipeline,
    pub advance: wgpu::ComputePipeline,
    pub drift: wgpu::ComputePipeline,
    pub contacts: wgpu::ComputePipeline,
    pub sticks: wgpu::ComputePipeline,
    pub tethers: wgpu::ComputePipeline,
}

impl Kernels {
    pub fn new(gpu: &Gpu) -> Self {
        use BindingKind::{Changed, DynamicUniform, Read, Uniform};
        let limits = gpu.device.limits();
        let shared = limits.max_compute_workgroup_storage_size;
        let tile = TILES.into_iter().find(|[width, height]| width * height * POSITION <= shared);
        let common = [Uniform, Read, Read, Read, Read, Changed, Changed];
        Self {
            common: layout(gpu, "common", &common),
            small: layout(gpu, "small bodies", &[Uniform, Changed, Changed]),
            large: layout(gpu, "large bodies", &[DynamicUniform, Changed, Changed, Changed, Changed]),
            grid: layout(gpu, "grids", &[DynamicUniform, Changed]),
            tile,
            tile_threads: limits
                .max_compute_invocations_per_workgroup
                .min(limits.max_compute_workgroup_size_x)
                .min(TILE_WORKGROUP),
            shared,
            small_steps: Default::default(),
            large_steps: Default::default(),
            grid_step: OnceLock::new(),
        }
    }

    /// Columns and rows that a workgroup of tiles is responsible for.
    pub fn inner(&self) -> [u32; 2] {
        self.tile.unwrap_or(TILES[0]).map(|side| side - 2 * HALO)
    }

    /// The size class of a body of so many particles; none if it is large.
    pub fn size_class(&self, particles: u32) -> Option<usize> {
        let fits = |class: &SizeClass| {
            particles <= class.particles && class.particles * POSITION + SHARED_BESIDES <= self.shared
        };
        SIZE_CLASSES.iter().position(fits)
    }

    /// The kernel that steps so many small bodies of a size class.
    pub fn small_step(&self, gpu: &Gpu, class: usize, bodies: u32, extras: Extras) -> &wgpu::ComputePipeline {
        let SizeClass { particles, threads, threads_in_crowd } = SIZE_CLASSES[class];
        let is_crowd = bodies >= CROWD && threads_in_crowd != threads;
        self.small_steps[class][usize::from(is_crowd)][extras as usize].get_or_init(|| {
            let threads = if is_crowd { threads_in_crowd } else { threads };
            let module = module(gpu, "small bodies", &small_source(particles, threads, extras));
            pipeline(gpu, &module, "step_body", &[&self.common, &self.small])
        })
    }

    /// The kernels that step large bodies.
    pub fn large_steps(&self, gpu: &Gpu, extras: Extras) -> &LargeKernels {
        self.large_steps[extras as usize].get_or_init(|| {
            let module = module(gpu, "large bodies", &large_source(extras));
            let pipeline = |entry| pipeline(gpu, &module, entry, &[&self.common, &self.large]);
            LargeKernels {
                begin: pipeline("begin"),
                advance: pipeline("advance"),
                drift: pipeline("note_drift"),
                contacts: pipeline("project_contacts"),
                sticks: pipeline("project_sticks"),
                tethers: pipeline("project_tethers"),
            }
        })
    }

    /// The kernel that relaxes the sticks of a grid, tile by tile.
    pub fn grid_step(&self, gpu: &Gpu) -> &wgpu::ComputePipeline {
        self.grid_step.get_or_init(|| {
            let source = grid_source(self.tile.unwrap_or(TILES[0]), self.tile_threads);
            let module = module(gpu, "grids", &source);
            pipeline(gpu, &module, "project_grid", &[&self.common, &self.grid])
        })
    }
}

/// A kernel of its own, which works through a list.
#[derive(Debug)]
pub(crate) struct ListKernel<const BUFFERS: usize> {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl ListKernel<6> {
    /// Writes the vertices of surfaces.
    pub fn of_surfaces(gpu: &Gpu) -> Self {
        Self::new(gpu, "surfaces", &surface_source(), "write_surface", Self::VERTEX_KINDS)
    }

    /// Writes the vertices of tubes.
    pub fn of_tubes(gpu: &Gpu) -> Self {
        Self::new(gpu, "tubes", &tube_source(), "write_tube", Self::VERTEX_KINDS)
    }

    const VERTEX_KINDS: [BindingKind; 6] = {
        use BindingKind::{Changed, Read};
        [Read, Read, Read, Read, Read, Changed]
    };
}

impl ListKernel<2> {
    /// Hands targets to pins.
    pub fn of_pins(gpu: &Gpu) -> Self {
        Self::new(gpu, "pins", &pin_source(), "set_targets", [BindingKind::Read, BindingKind::Changed])
    }
}

impl<const BUFFERS: usize> ListKernel<BUFFERS> {
    fn new(gpu: &Gpu, label: &str, source: &str, entry: &str, kinds: [BindingKind; BUFFERS]) -> Self {
        let layout = layout(gpu, label, &kinds);
        let pipeline = pipeline(gpu, &module(gpu, label, source), entry, &[&layout]);
        Self { layout, pipeline }
    }

    /// Runs so many workgroups on these buffers.
    pub fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        bound: [&wgpu::Buffer; BUFFERS],
        groups: u32,
    ) {
        let group = bind(gpu, &self.layout, bound.map(wgpu::Buffer::as_entire_binding));
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        let [across, down] = spread(groups);
        pass.dispatch_workgroups(across, down, 1);
    }
}

/// So many workgroups along two axes: WebGPU allows 65,535 along one.
pub(crate) fn spread(groups: u32) -> [u32; 2] {
    let down = groups.div_ceil(65_535).max(1);
    [groups.div_ceil(down).max(1), down]
}

/// Binds resources in the order of a layout.
pub(crate) fn bind<const N: usize>(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    resources: [wgpu::BindingResource<'_>; N],
) -> wgpu::BindGroup {
    let mut binding = 0..;
    let entries = resources
        .map(|resource| wgpu::BindGroupEntry { binding: binding.next().unwrap_or_default(), resource });
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

/// The kinds of things that kernels bind.
#[derive(Clone, Copy)]
enum BindingKind {
    Uniform,
    /// A uniform at an offset that the dispatch chooses.
    DynamicUniform,
    /// A buffer that is read.
    Read,
    /// A buffer that is read and written.
    Changed,
}

fn layout(gpu: &Gpu, label: &str, kinds: &[BindingKind]) -> wgpu::BindGroupLayout {
    let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
    let entries: Vec<_> = kinds
        .iter()
        .enumerate()
        .map(|(binding, kind)| {
            let ty = match kind {
                BindingKind::Uniform | BindingKind::DynamicUniform => wgpu::BufferBindingType::Uniform,
                BindingKind::Read => storage(true),
                BindingKind::Changed => storage(false),
            };
            wgpu::BindGroupLayoutEntry {
                binding: binding as u32,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer {
                    ty,
                    has_dynamic_offset: matches!(kind, BindingKind::DynamicUniform),
                    min_binding_size: None,
                },
                count: None,
            }
        })
        .collect();
    gpu.device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

fn module(gpu: &Gpu, label: &str, source: &str) -> wgpu::ShaderModule {
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}

fn pipeline(
    gpu: &Gpu,
    module: &wgpu::ShaderModule,
    entry: &str,
    groups: &[&wgpu::BindGroupLayout],
) -> wgpu::ComputePipeline {
    let groups: Vec<_> = groups.iter().map(|&group| Some(group)).collect();
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(entry),
        bind_group_layouts: &groups,
        ..Default::default()
    });
    gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry),
        layout: Some(&layout),
        module,
        entry_point: Some(entry),
        compilation_options: wgpu::PipelineCompilationOptions {
            // Kernels write all shared memory that they read.
            zero_initialize_workgroup_memory: false,
            ..Default::default()
        },
        cache: None,
    })
}
