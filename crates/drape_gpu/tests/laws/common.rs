//! Worlds and measures that the tests share.

use std::sync::{Arc, OnceLock};

use drape_gpu::{BodyVertices, Gpu, GpuBodyId, GpuError, GpuWorld, SurfaceWriter, wgpu};
use drape_solver::glam::{DVec3, Vec3};
use drape_solver::{
    Body, BodySettings, ClothBuilder, Environment, Obstacle, Particles, Placement, Shape, StickKind,
    StickMaterial, StructuralSolve, TopologyBuilder,
};

/// Standard gravity of the tests in m/s^2.
pub const G: f32 = 9.81;

/// A frame of a 60 Hz game in seconds.
pub const FRAME: f32 = 1.0 / 60.0;

/// The adapter that all tests share.
pub fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| Gpu::open().expect("an adapter: install mesa-vulkan-drivers"))
}

/// The same adapter with limits that `lower` has lowered.
pub fn limited(lower: impl FnOnce(&mut wgpu::Limits)) -> Result<Gpu, GpuError> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    let adapter = adapter.expect("an adapter: install mesa-vulkan-drivers");
    let mut required_limits = adapter.limits();
    lower(&mut required_limits);
    let descriptor = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).expect("a device");
    Gpu::sharing(device, queue)
}

/// A world with one body.
pub fn world_of(body: &Body) -> (GpuWorld, GpuBodyId) {
    let mut world = GpuWorld::new(gpu());
    let id = world.add(body).expect("a body for the GPU");
    (world, id)
}

/// Settings with every feature off, for tests to switch on.
pub fn bare() -> BodySettings {
    BodySettings {
        substeps: 1,
        iterations: 1,
        drag: 0.0,
        friction: 0.0,
        thickness: 0.0,
        tethers: false,
        ..BodySettings::default()
    }
}

/// The default settings, but swept, as on the GPU: for tests that compare it with the processor.
pub fn swept() -> BodySettings {
    BodySettings { structural: StructuralSolve::Sweeps, ..BodySettings::default() }
}

/// Gravity and nothing else, in frames.
pub fn gravity() -> Environment {
    Environment { dt: FRAME, gravity: Vec3::NEG_Y * G, ..Environment::default() }
}

/// Particles with these inverse masses, joined by rigid sticks at their distances.
pub fn joined(
    positions: &[Vec3],
    inverse_masses: &[f32],
    sticks: &[[u32; 2]],
    settings: BodySettings,
) -> Body {
    let particles = Particles::new(Vec3::ZERO, positions, inverse_masses).expect("valid particles");
    let mut builder = TopologyBuilder::new(positions);
    if !sticks.is_empty() {
        builder
            .family(StickMaterial::rigid(StickKind::Structural), sticks.iter().copied())
            .expect("valid sticks");
    }
    Body::new(particles, Arc::new(builder.build().expect("valid topology")), settings)
}

/// A level cloth of 1 m with its corner at `origin`.
pub fn level(n: u32, origin: Vec3, settings: BodySettings) -> Body {
    ClothBuilder::new(1.0, 1.0, n, n).placed(origin, Vec3::X, Vec3::Z).build(settings).expect("valid")
}

/// An obstacle at rest.
pub fn obstacle(shape: Shape, place: Vec3, friction: f32) -> Obstacle {
    Obstacle::new(shape, Placement::at(place), friction).expect("valid")
}

/// Takes `steps` steps.
pub fn run(world: &mut GpuWorld, environment: &Environment, steps: usize) {
    let mut environment = environment.clone();
    for _ in 0..steps {
        world.step(&environment).expect("a good step");
        environment.time += f64::from(environment.dt);
    }
}

/// Positions of a body.
pub fn positions(world: &GpuWorld, id: GpuBodyId) -> Vec<Vec3> {
    world.read_positions(id).expect("a body")
}

/// Mean of positions.
pub fn centre(positions: &[Vec3]) -> DVec3 {
    positions.iter().map(|position| position.as_dvec3()).sum::<DVec3>() / positions.len() as f64
}

/// Root mean square of the strain of a body's structural sticks.
pub fn stretch(body: &Body, positions: &[Vec3]) -> f64 {
    let topology = &body.topology;
    let structural = topology.batches().iter().filter(|batch| batch.material.kind == StickKind::Structural);
    let strains: Vec<f64> = structural
        .flat_map(drape_solver::StickBatch::range)
        .map(|stick| {
            let [a, b] = topology.stick(stick).map(|end| positions[end as usize].as_dvec3());
            a.distance(b) / f64::from(topology.rest_length(stick)) - 1.0
        })
        .collect();
    (strains.iter().map(|strain| strain * strain).sum::<f64>() / strains.len() as f64).sqrt()
}

/// The greatest distance between two lists of positions, in metres.
pub fn farthest_apart(one: &[Vec3], other: &[Vec3]) -> f32 {
    one.iter().zip(other).map(|(one, other)| one.distance(*other)).fold(0.0, f32::max)
}

/// A buffer for vertices, of so many bytes.
pub fn vertex_buffer(size: u64) -> wgpu::Buffer {
    gpu().device().create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Writes bodies as they were at a fraction of the last step into a buffer, and returns its words.
pub fn write_bodies(
    world: &GpuWorld,
    bodies: &[BodyVertices],
    fraction: f32,
    target: &wgpu::Buffer,
) -> Vec<f32> {
    let mut writer = SurfaceWriter::new(gpu());
    let step = world.last_step().expect("a world that keeps positions");
    writer.set_bodies(&step, bodies).expect("room");
    assert!(writer.set_step(&step, fraction));
    write(&writer, target)
}

/// Writes vertices into a buffer, and returns its words.
pub fn write(writer: &SurfaceWriter, target: &wgpu::Buffer) -> Vec<f32> {
    let device = gpu().device();
    let staging = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: target.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    writer.encode(&mut encoder, target);
    encoder.copy_buffer_to_buffer(target, 0, &staging, 0, target.size());
    gpu().queue().submit([encoder.finish()]);
    let (sender, mapped) = std::sync::mpsc::channel();
    staging.slice(..).map_async(wgpu::MapMode::Read, move |result| sender.send(result).expect("heard"));
    gpu().wait().expect("a device");
    mapped.recv().expect("sent").expect("mapped");
    let view = staging.slice(..).get_mapped_range().expect("mapped");
    view.chunks_exact(4).map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect()
}
