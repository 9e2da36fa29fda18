//! The compute pipelines, and what they bind.

use std::sync::OnceLock;

use drape_solver::constants::{CONTACT_MARGIN, MAX_MAGNITUDE, PUSH_OUT_SPEED};

use crate::gpu::Gpu;
use crate::model::HALO;
use crate::obstacle::MAX_OBSTACLES;

/// Threads of a workgroup, and particles for each of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SizeClass {
    pub threads: u32,
    pub per_thread: u32,
}

impl SizeClass {
    /// The greatest number of particles.
    pub fn capacity(self) -> u32 {
        self.threads * self.per_thread
    }
}

/// Sizes of bodies that one workgroup steps, the smallest first.
pub(crate) const SIZE_CLASSES: [SizeClass; 5] = [
    SizeClass { threads: 64, per_thread: 1 },
    SizeClass { threads: 64, per_thread: 2 },
    SizeClass { threads: 128, per_thread: 2 },
    SizeClass { threads: 256, per_thread: 2 },
    SizeClass { threads: 256, per_thread: 4 },
];

/// Threads of a workgroup that steps a part of a large body.
pub(crate) const LARGE_WORKGROUP: u32 = 256;

/// Columns and rows of tiles of a grid, the largest first: the shared memory of a device decides. Without their halo they have a multiple of
/// four.
const TILES: [[u32; 2]; 2] = [[64, 44], [64, 32]];

/// Bytes of shared memory that a kernel needs besides positions.
const SHARED_BESIDES: u32 = 512;

/// Bytes of a position in shared memory.
const POSITION: u32 = 16;

const STRUCTURES: &str = include_str!("shaders/structures.wgsl");
const STICK: &str = include_str!("shaders/stick.wgsl");
const AIR: &str = include_str!("shaders/air.wgsl");
const OBSTACLE: &str = include_str!("shaders/obstacle.wgsl");
const NEARBY: &str = include_str!("shaders/nearby.wgsl");
const TETHER: &str = include_str!("shaders/tether.wgsl");
const REACTION: &str = include_str!("shaders/reaction.wgsl");
const SMALL: &str = include_str!("shaders/small_bodies.wgsl");
const LARGE: &str = include_str!("shaders/large_bodies.wgsl");
const GRID: &str = include_str!("shaders/grid_sticks.wgsl");

/// Kernels that are compiled when they are first needed.
#[derive(Debug)]
pub(crate) struct Kernels {
    /// What all kernels bind as group 0.
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
    small_steps: [OnceLock<wgpu::ComputePipeline>; SIZE_CLASSES.len()],
    large_steps: OnceLock<LargeKernels>,
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
            tile_threads: limits.max_compute_invocations_per_workgroup.min(TILE_WORKGROUP),
            small_steps: Default::default(),
            large_steps: OnceLock::new(),
            grid_step: OnceLock::new(),
        }
    }

    /// Columns and rows that a workgroup of tiles is responsible for.
    pub fn inner(&self) -> [u32; 2] {
        self.tile.unwrap_or(TILES[0]).map(|side| side - 2 * HALO)
    }

    /// The size class of a body of so many particles; none if it is large.
    pub fn size_class(&self, gpu: &Gpu, particles: u32) -> Option<usize> {
        let shared = gpu.device.limits().max_compute_workgroup_storage_size;
        let fits = |class: &SizeClass| {
            particles <= class.capacity() && class.capacity() * POSITION + SHARED_BESIDES <= shared
        };
        SIZE_CLASSES.iter().position(fits)
    }

    /// The kernel that steps small bodies of a size class.
    pub fn small_step(&self, gpu: &Gpu, class: usize) -> &wgpu::ComputePipeline {
        self.small_steps[class].get_or_init(|| {
            let module = module(gpu, "small bodies", &small_source(SIZE_CLASSES[class]));
            pipeline(gpu, &module, "step_body", &[&self.common, &self.small])
        })
    }

    /// The kernels that step large bodies.
    pub fn large_steps(&self, gpu: &Gpu) -> &LargeKernels {
        self.large_steps.get_or_init(|| {
            let module = module(gpu, "large bodies", &large_source());
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

/// Threads of a tile's workgroup, where the device allows as many.
const TILE_WORKGROUP: u32 = 1024;

/// The whole source of the kernel of small bodies.
pub(crate) fn small_source(class: SizeClass) -> String {
    let SizeClass { threads, per_thread } = class;
    let sizes = format!("const WORKGROUP: u32 = {threads}u;\nconst PER_THREAD: u32 = {per_thread}u;\n");
    with_constants(&[&sizes, STRUCTURES, STICK, AIR, REACTION, OBSTACLE, NEARBY, SMALL])
}

/// The whole source of the kernels of large bodies.
pub(crate) fn large_source() -> String {
    let sizes = format!("const WORKGROUP: u32 = {LARGE_WORKGROUP}u;\n");
    with_constants(&[&sizes, STRUCTURES, STICK, TETHER, AIR, REACTION, OBSTACLE, NEARBY, LARGE])
}

/// The whole source of the kernel of tiles.
pub(crate) fn grid_source([width, height]: [u32; 2], threads: u32) -> String {
    let sizes = format!(
        "const WORKGROUP: u32 = {threads}u;\nconst TILE_WIDTH: u32 = {width}u;\nconst TILE_HEIGHT: u32 = {height}u;\n"
    );
    with_constants(&[&sizes, STRUCTURES, STICK, TETHER, GRID])
}

/// Joins parts of a source, and fills in the constants that the solver has too.
fn with_constants(parts: &[&str]) -> String {
    let words = MAX_OBSTACLES.div_ceil(32);
    parts
        .concat()
        .replace("{MAX_MAGNITUDE}", &format!("{MAX_MAGNITUDE:?}"))
        .replace("{PUSH_OUT_SPEED}", &format!("{PUSH_OUT_SPEED:?}"))
        .replace("{CONTACT_MARGIN}", &format!("{CONTACT_MARGIN:?}"))
        .replace("{OBSTACLE_WORDS}", &format!("{words}u"))
        .replace("{HALO}", &HALO.to_string())
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

#[cfg(test)]
mod tests {
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    use super::*;

    /// All sources are valid WGSL within WebGPU: nothing here needs an adapter.
    #[test]
    fn every_kernel_is_valid() {
        let small = SIZE_CLASSES.map(small_source);
        let grids = TILES.map(|tile| grid_source(tile, TILE_WORKGROUP));
        for source in small.into_iter().chain(grids).chain([large_source()]) {
            let module = naga::front::wgsl::parse_str(&source)
                .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)));
            let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
            validator.validate(&module).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)));
        }
    }

    /// A tile without its halo has a multiple of four columns and rows, as the families of sticks repeat after four places.
    #[test]
    fn tiles_begin_where_families_repeat() {
        for [width, height] in TILES {
            assert!((width - 2 * HALO).is_multiple_of(4) && (height - 2 * HALO).is_multiple_of(4));
            assert!(width.is_multiple_of(4) && height.is_multiple_of(4));
        }
    }
}
