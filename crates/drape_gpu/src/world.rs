//! Bodies on the GPU, stepped together.

use std::sync::Arc;

use drape_solver::constants::TETHER_SPEED;
use drape_solver::glam::Vec3;
use drape_solver::state::drag::Drag;
use drape_solver::{
    Body, BodySettings, Environment, Layers, Particles, Reaction, StepError, StickProjection, Topology,
};

use crate::air::step_data;
use crate::buffers::{Buffers, pass_stride};
use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::kernels::{Kernels, spread};
use crate::layout::{BodyData, ObstacleData, PassData, RunData, StatusData};
use crate::model::{Kind, Model};
use crate::obstacle;
use crate::passes::{self, Dispatch, Stage};
use crate::snapshots::Snapshots;
use crate::source::SIZE_CLASSES;
use crate::timer::Timer;

/// The number of a body in its [`GpuWorld`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GpuBodyId(u32);

/// The place of a body in the buffers of its world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyPlace {
    pub origin: Vec3,
    pub first_particle: u32,
    pub particle_count: u32,
    pub first_fan: u32,
}

/// What the GPU finds of a body in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyStatus {
    /// Least corner of the box around the particles (world, metres).
    pub low: Vec3,
    /// Greatest corner.
    pub high: Vec3,
    /// Speed of the fastest particle in m/s.
    pub greatest_speed: f32,
    /// True if a particle would not have been finite. A small body has then not moved at all, and the other figures are of an earlier
    /// step; of a large one, such particles rest where they were before sticks moved them.
    pub is_broken: bool,
}

/// Bytes of the position or displacement of a particle.
const PARTICLE: u64 = 16;

/// Bytes of the sums of an obstacle's reactions: six numbers of 64 bits.
const REACTION: u64 = 48;

/// Units of those sums in a newton second, or a newton metre second.
const IMPULSE_UNITS: f64 = 1_073_741_824.0;

/// Bytes of a pair of words.
const PAIR: u64 = 8;

/// Bodies whose particles live on the GPU.
///
/// ```no_run
/// use drape_gpu::{Gpu, GpuWorld};
/// use drape_solver::{BodySettings, ClothBuilder, Edge, Environment};
///
/// let mut world = GpuWorld::new(&Gpu::open()?);
/// let flag = ClothBuilder::new(1.5, 1.0, 24, 16).pin_edge(Edge::Left).build(BodySettings::default())?;
/// let flags = (0..10_000).map(|_| world.add(&flag)).collect::<Result<Vec<_>, _>>()?;
/// for _ in 0..60 {
///     world.step(&Environment::default())?;
/// }
/// let positions = world.read_positions(flags[0])?;
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct GpuWorld {
    gpu: Gpu,
    kernels: Kernels,
    buffers: Buffers,
    /// Topologies with their pairs of words in the buffer, each with the index of its first pair.
    models: Vec<(Arc<Topology>, Model, u32)>,
    pair_count: u32,
    bodies: Vec<Option<Member>>,
    /// Ranges of particles that no body uses, as (count, first).
    free: Vec<(u32, u32)>,
    particle_count: u32,
    /// Bodies that have been added since the last step, with their particles.
    arriving: Vec<(GpuBodyId, Particles)>,
    /// Targets of pins for the coming step.
    targets: Vec<(GpuBodyId, u32, Vec3)>,
    /// True if the tables of bodies and batches have to be written.
    is_stale: bool,
    dt: f32,
    obstacles: Vec<ObstacleData>,
    /// Those of the last step.
    known_obstacles: Vec<ObstacleData>,
    /// Index of each in the environment.
    obstacle_indices: Vec<u32>,
    /// The number of small bodies of each size class.
    runs: [u32; SIZE_CLASSES.len()],
    dispatches: Vec<Dispatch>,
    /// Ranges of particles that a step leaves in the second buffer of positions, in bytes.
    moved_over: Vec<(u64, u64)>,
    timer: Option<Timer>,
    snapshots: Option<Snapshots>,
}

#[derive(Debug)]
struct Member {
    model: usize,
    settings: BodySettings,
    layers: Layers,
    origin: Vec3,
    first_particle: u32,
    /// Its place in the table of bodies, once it is there.
    number: Option<u32>,
    /// 1 over the mass of all particles in 1/kg; 0 if some are pinned.
    inverse_mass: f32,
    /// Particles that are pinned, in ascending order.
    pins: Vec<u32>,
}

impl GpuWorld {
    /// A world without bodies.
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            gpu: gpu.clone(),
            kernels: Kernels::new(gpu),
            buffers: Buffers::new(gpu),
            models: Vec::new(),
            pair_count: 0,
            bodies: Vec::new(),
            free: Vec::new(),
            particle_count: 0,
            arriving: Vec::new(),
            targets: Vec::new(),
            is_stale: true,
            dt: 0.0,
            obstacles: Vec::new(),
            known_obstacles: Vec::new(),
            obstacle_indices: Vec::new(),
            runs: [0; SIZE_CLASSES.len()],
            dispatches: Vec::new(),
            moved_over: Vec::new(),
            timer: Timer::new(gpu),
            snapshots: None,
        }
    }

    /// Adds a copy of a body. Bodies that share a topology share its memory here too.
    ///
    /// [Lines](drape_solver::StructuralSolve::Lines) are swept, early stops by tolerance ignored.
    ///
    /// # Errors
    /// [`GpuError::Unsupported`] if it has what the GPU does not solve: self-contact, a rigidity, pressure, damped sticks, rigid parts.
    /// [`GpuError::Settings`] if its settings are invalid. [`GpuError::Limit`] if the device has no room.
    pub fn add(&mut self, body: &Body) -> Result<GpuBodyId, GpuError> {
        body.settings.validate()?;
        if body.settings.has_self_contact() {
            return Err(GpuError::Unsupported("self-contact"));
        }
        if body.pressure != 0.0 {
            return Err(GpuError::Unsupported("pressure"));
        }
        let count = body.particles.len() as u32;
        let model = self.model(&body.topology)?;
        let first_particle = match self.free.iter().position(|&(size, _)| size == count) {
            Some(place) => self.free.swap_remove(place).1,
            None => {
                self.particle_count += count;
                self.particle_count - count
            }
        };
        let id = GpuBodyId(self.bodies.len() as u32);
        self.bodies.push(Some(Member {
            model,
            settings: body.settings,
            layers: body.layers,
            origin: body.particles.origin(),
            first_particle,
            number: None,
            inverse_mass: inverse_mass(&body.particles),
            pins: (0..count).filter(|&i| body.particles.is_pinned(i as usize)).collect(),
        }));
        self.arriving.push((id, body.particles.clone()));
        self.is_stale = true;
        Ok(id)
    }

    /// Removes a body.
    ///
    /// # Errors
    /// [`GpuError::NoSuchBody`].
    pub fn remove(&mut self, id: GpuBodyId) -> Result<(), GpuError> {
        let slot = self.bodies.get_mut(id.0 as usize).ok_or(GpuError::NoSuchBody)?;
        let member = slot.take().ok_or(GpuError::NoSuchBody)?;
        self.free.push((self.models[member.model].1.particle_count, member.first_particle));
        self.arriving.retain(|(other, _)| *other != id);
        self.targets.retain(|(other, ..)| *other != id);
        self.is_stale = true;
        Ok(())
    }

    /// The number of bodies.
    pub fn len(&self) -> usize {
        self.bodies.iter().flatten().count()
    }

    /// True if there are no bodies.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Moves a pinned particle to `target` (world, metres) in the coming step, in equal parts over the substeps.
    ///
    /// # Errors
    /// [`GpuError::NoSuchBody`]; [`GpuError::Unsupported`] if the particle is not pinned or the target not finite.
    pub fn set_pin_target(&mut self, id: GpuBodyId, particle: u32, target: Vec3) -> Result<(), GpuError> {
        let member = self.member(id)?;
        if !target.is_finite() || member.pins.binary_search(&particle).is_err() {
            return Err(GpuError::Unsupported(
                "a target of a particle that is not pinned, or that is not finite,",
            ));
        }
        self.targets.push((id, particle, target));
        Ok(())
    }

    /// From the next step on, keeps the positions before and after each step, for a [`SurfaceWriter`](crate::SurfaceWriter): 64 bytes a
    /// particle, and two copies of all positions a step.
    pub fn keep_snapshots(&mut self) {
        self.snapshots.get_or_insert_with(|| Snapshots::new(&self.gpu));
        self.is_stale = true;
    }

    /// Begins a frame that is drawn: its steps leave alone what the frame before draws from.
    pub fn begin_frame(&mut self) {
        if let Some(snapshots) = &mut self.snapshots {
            snapshots.begin_frame();
        }
    }

    /// Pairs of words, and positions before and after the last step; none without snapshots.
    pub(crate) fn shown(&self) -> Option<[&wgpu::Buffer; 3]> {
        let [before, after] = self.snapshots.as_ref()?.last();
        Some([self.buffers.pairs.get(), before, after])
    }

    /// The place of a body in the buffers; none if it has not been stepped.
    pub(crate) fn place_of(&self, id: GpuBodyId) -> Result<Option<BodyPlace>, GpuError> {
        let member = self.member(id)?;
        let (_, model, first_pair) = &self.models[member.model];
        Ok(member.number.map(|_| BodyPlace {
            origin: member.origin,
            first_particle: member.first_particle,
            particle_count: model.particle_count,
            first_fan: first_pair + model.first_fan,
        }))
    }

    /// Starts a step of all bodies, and returns before it is done. The environment's shelter and wind zones are not heeded.
    ///
    /// # Errors
    /// [`GpuError::Step`] if the environment is invalid; [`GpuError::Unsupported`] if an obstacle has a shape without a formula;
    /// [`GpuError::Limit`] if something does not fit; [`GpuError::Lost`]. Nothing has moved then.
    pub fn step(&mut self, environment: &Environment) -> Result<(), GpuError> {
        // Learns of a loss of the device.
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        self.gpu.check()?;
        let dt = environment.dt;
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(StepError::BadTimestep(dt).into());
        }
        if !environment.gravity.is_finite() {
            return Err(StepError::BadEnvironment("gravity").into());
        }
        environment.wind.validate()?;
        obstacle::list(&environment.obstacles, &mut self.obstacles, &mut self.obstacle_indices)?;
        let mut step = step_data(environment);
        step.obstacle_count = self.obstacles.len() as u32;
        if dt != self.dt {
            step.rescale = if self.dt > 0.0 { dt / self.dt } else { 1.0 };
            self.dt = dt;
            self.is_stale = true;
        }
        if self.is_stale {
            self.write_tables()?;
            self.is_stale = false;
        }
        self.write_arriving(step.rescale);
        self.write_targets();
        if self.obstacles != self.known_obstacles {
            let data: &[u8] = bytemuck::cast_slice(&self.obstacles);
            self.buffers.reserve(&self.gpu, data.len() as u64, |buffers| &mut buffers.obstacles)?;
            self.buffers.obstacles.write(&self.gpu, 0, data);
            let sums = self.obstacles.len() as u64 * REACTION;
            self.buffers.reserve(&self.gpu, sums, |buffers| &mut buffers.reactions)?;
            self.known_obstacles.clone_from(&self.obstacles);
        }
        self.gpu.queue.write_buffer(&self.buffers.step, 0, bytemuck::bytes_of(&step));
        self.submit();
        Ok(())
    }

    /// Positions of a body's particles (world, metres), after all steps that were started. Waits for them.
    ///
    /// # Errors
    /// [`GpuError::NoSuchBody`], [`GpuError::Lost`].
    pub fn read_positions(&self, id: GpuBodyId) -> Result<Vec<Vec3>, GpuError> {
        let member = self.member(id)?;
        if let Some((_, particles)) = self.arriving.iter().find(|(other, _)| *other == id) {
            return Ok(particles.positions().collect());
        }
        let count = self.models[member.model].1.particle_count;
        let first = u64::from(member.first_particle) * PARTICLE;
        let bytes = self.gpu.read(self.buffers.positions[0].get(), first, u64::from(count) * PARTICLE)?;
        let place = |place: [f32; 4]| member.origin + Vec3::new(place[0], place[1], place[2]);
        Ok(bytemuck::pod_collect_to_vec::<u8, [f32; 4]>(&bytes).into_iter().map(place).collect())
    }

    /// What the GPU has found of a body in the last step that was started. None if it has not been stepped. Waits for the step.
    ///
    /// # Errors
    /// [`GpuError::NoSuchBody`], [`GpuError::Lost`].
    pub fn read_status(&self, id: GpuBodyId) -> Result<Option<BodyStatus>, GpuError> {
        let member = self.member(id)?;
        let Some(number) = member.number else { return Ok(None) };
        let size = size_of::<StatusData>() as u64;
        let bytes = self.gpu.read(self.buffers.statuses.get(), u64::from(number) * size, size)?;
        let status: StatusData = bytemuck::pod_read_unaligned(&bytes);
        let corner = |keys: [u32; 3]| member.origin + Vec3::from(keys.map(StatusData::coordinate));
        let substep = self.dt / member.settings.substeps as f32;
        Ok(Some(BodyStatus {
            low: corner(status.low),
            high: corner(status.high),
            greatest_speed: f32::from_bits(status.fastest).sqrt() / substep,
            is_broken: status.is_broken != 0,
        }))
    }

    /// The opposite of all impulses that each obstacle which [asks for them](drape_solver::Obstacle::reporting_reaction) has given to bodies in
    /// the last step that was started; obstacles that touched nothing are left out. Waits for the step.
    ///
    /// The coupling is explicit: the caller moves the obstacle by them before the next step. Momentum is kept.
    ///
    /// # Errors
    /// [`GpuError::Lost`].
    pub fn read_reactions(&self) -> Result<Vec<Reaction>, GpuError> {
        if self.known_obstacles.iter().all(|obstacle| obstacle.is_asking == 0) {
            return Ok(Vec::new());
        }
        let bytes = self.known_obstacles.len() as u64 * REACTION;
        let sums = self.gpu.read(self.buffers.reactions.get(), 0, bytes)?;
        let sums: Vec<[i64; 6]> = bytemuck::pod_collect_to_vec(&sums);
        let vector =
            |sum: &[i64]| Vec3::from_array([0, 1, 2].map(|k| (sum[k] as f64 / IMPULSE_UNITS) as f32));
        let touched = sums.iter().zip(&self.obstacle_indices).filter(|(sum, _)| **sum != [0; 6]);
        let reaction = |(sum, &index): (&[i64; 6], &u32)| Reaction {
            obstacle: index as usize,
            impulse: vector(&sum[..3]),
            angular_impulse: vector(&sum[3..]),
        };
        Ok(touched.map(reaction).collect())
    }

    /// Seconds that the GPU took for the last step, once it is done; none if the device has no clock. Waits for the step.
    ///
    /// # Errors
    /// [`GpuError::Lost`].
    pub fn read_seconds(&self) -> Result<Option<f64>, GpuError> {
        self.timer.as_ref().map(|timer| timer.read_seconds(&self.gpu)).transpose()
    }

    fn member(&self, id: GpuBodyId) -> Result<&Member, GpuError> {
        self.bodies.get(id.0 as usize).and_then(Option::as_ref).ok_or(GpuError::NoSuchBody)
    }

    /// The place of a topology among the models, to which it is added if it is new.
    fn model(&mut self, topology: &Arc<Topology>) -> Result<usize, GpuError> {
        let known = self.models.iter().position(|(known, ..)| Arc::ptr_eq(known, topology));
        if let Some(place) = known {
            return Ok(place);
        }
        let kind = match self.kernels.size_class(&self.gpu, topology.particle_count() as u32) {
            Some(_) => Kind::Small,
            None if self.kernels.tile.is_some() => Kind::Tiled,
            None => Kind::Listed,
        };
        let model = Model::new(topology, kind)?;
        let first = self.pair_count;
        self.pair_count += model.pairs.len() as u32;
        self.buffers.reserve(&self.gpu, PAIR * u64::from(self.pair_count), |buffers| &mut buffers.pairs)?;
        self.buffers.pairs.write(&self.gpu, PAIR * u64::from(first), bytemuck::cast_slice(&model.pairs));
        self.models.push((Arc::clone(topology), Model { pairs: Vec::new(), ..model }, first));
        Ok(self.models.len() - 1)
    }

    /// Writes the tables of bodies and batches, and lists the dispatches of large bodies.
    fn write_tables(&mut self) -> Result<(), GpuError> {
        let Self { gpu, kernels, models, bodies: members, .. } = self;
        let mut batches = Vec::new();
        // Bodies of one topology with equal settings share their batches.
        let mut known: Vec<(usize, BodySettings, u32)> = Vec::new();
        let mut by_class: [Vec<(usize, BodyData)>; SIZE_CLASSES.len() + 1] = Default::default();
        for (place, member) in members.iter().enumerate() {
            let Some(member) = member else { continue };
            let (_, model, first_pair) = &models[member.model];
            let is_same = |(model, settings, _): &&(usize, BodySettings, u32)| {
                *model == member.model && settings.has_same_bits(&member.settings)
            };
            let first_batch = match known.iter().find(is_same) {
                Some(&(.., first)) => first,
                None => {
                    let first = batches.len() as u32;
                    batches.extend(model.batches(&member.settings, self.dt, *first_pair));
                    known.push((member.model, member.settings, first));
                    first
                }
            };
            let data = body_data(member, model, self.dt, *first_pair, first_batch);
            let class = kernels.size_class(gpu, model.particle_count).unwrap_or(SIZE_CLASSES.len());
            by_class[class].push((place, data));
        }
        let mut table = Vec::new();
        self.dispatches.clear();
        self.moved_over.clear();
        for (class, list) in by_class.iter().enumerate() {
            if let Some(run) = self.runs.get_mut(class) {
                *run = list.len() as u32;
                let data = RunData { first_body: table.len() as u32, body_count: *run, unused: [0; 2] };
                gpu.queue.write_buffer(&self.buffers.runs[class], 0, bytemuck::bytes_of(&data));
            }
            for (place, data) in list {
                let number = table.len() as u32;
                table.push(*data);
                let Some(member) = &mut members[*place] else { continue };
                member.number = Some(number);
                if class == SIZE_CLASSES.len() {
                    let model = &models[member.model].1;
                    if passes::push(&mut self.dispatches, number, data, model, kernels.inner()) == 1 {
                        let range = [data.first_particle, data.particle_count].map(u64::from);
                        self.moved_over.push((range[0] * PARTICLE, range[1] * PARTICLE));
                    }
                }
            }
        }
        self.write_buffers(bytemuck::cast_slice(&table), bytemuck::cast_slice(&batches), table.len() as u64)
    }

    fn write_buffers(&mut self, bodies: &[u8], batches: &[u8], body_count: u64) -> Result<(), GpuError> {
        let Self { gpu, buffers, models, bodies: members, .. } = self;
        let particles = u64::from(self.particle_count) * PARTICLE;
        buffers.reserve(gpu, bodies.len() as u64, |buffers| &mut buffers.bodies)?;
        buffers.reserve(gpu, batches.len() as u64, |buffers| &mut buffers.batches)?;
        buffers.reserve(gpu, body_count * size_of::<StatusData>() as u64, |buffers| &mut buffers.statuses)?;
        buffers.reserve(gpu, particles, |buffers| &mut buffers.positions[0])?;
        buffers.reserve(gpu, particles, |buffers| &mut buffers.displacements)?;
        if let Some(snapshots) = &mut self.snapshots {
            snapshots.reserve(gpu, particles)?;
        }
        if !self.dispatches.is_empty() {
            let is_tiled = members.iter().flatten().any(|member| models[member.model].1.is_tiled);
            let of_grids = if is_tiled { particles } else { 0 };
            buffers.reserve(gpu, of_grids, |buffers| &mut buffers.positions[1])?;
            buffers.reserve(gpu, 2 * particles, |buffers| &mut buffers.flights)?;
            buffers.reserve(gpu, particles, |buffers| &mut buffers.accelerations)?;
        }
        buffers.bodies.write(gpu, 0, bodies);
        buffers.batches.write(gpu, 0, batches);
        let stride = pass_stride(gpu) as usize;
        let mut data = vec![0; stride * self.dispatches.len()];
        for (slot, dispatch) in data.chunks_mut(stride.max(1)).zip(&self.dispatches) {
            slot[..size_of::<PassData>()].copy_from_slice(bytemuck::bytes_of(&dispatch.data));
        }
        buffers.write_passes(gpu, &data);
        Ok(())
    }

    /// Writes the particles of bodies that are new. The shaders multiply all displacements by `rescale` in this step.
    fn write_arriving(&mut self, rescale: f32) {
        for (id, particles) in core::mem::take(&mut self.arriving) {
            let Some(Some(member)) = self.bodies.get(id.0 as usize) else { continue };
            let substep = self.dt / member.settings.substeps as f32;
            let count = particles.len();
            let position = |i: usize| {
                let place = particles.local_position(i);
                [place.x, place.y, place.z, particles.inverse_mass(i)]
            };
            let displacement = |i: usize| {
                let moved = particles.velocity(i) * (substep / rescale);
                if particles.is_pinned(i) { [0.0; 4] } else { [moved.x, moved.y, moved.z, 0.0] }
            };
            let positions: Vec<[f32; 4]> = (0..count).map(position).collect();
            let displacements: Vec<[f32; 4]> = (0..count).map(displacement).collect();
            let first = u64::from(member.first_particle) * PARTICLE;
            self.buffers.positions[0].write(&self.gpu, first, bytemuck::cast_slice(&positions));
            self.buffers.displacements.write(&self.gpu, first, bytemuck::cast_slice(&displacements));
        }
    }

    fn write_targets(&mut self) {
        for (id, particle, target) in self.targets.drain(..) {
            let Some(Some(member)) = self.bodies.get(id.0 as usize) else { continue };
            let local = target - member.origin;
            let data = [local.x, local.y, local.z, 1.0];
            let first = u64::from(member.first_particle + particle) * PARTICLE;
            self.buffers.displacements.write(&self.gpu, first, bytemuck::bytes_of(&data));
        }
    }

    fn submit(&mut self) {
        let Self { gpu, kernels, buffers, .. } = self;
        let stride = pass_stride(gpu) as u32;
        let has_obstacles = !self.obstacles.is_empty();
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if self.obstacles.iter().any(|obstacle| obstacle.is_asking != 0) {
            encoder.clear_buffer(buffers.reactions.get(), 0, None);
        }
        let particles = u64::from(self.particle_count) * PARTICLE;
        if let Some(snapshots) = &mut self.snapshots {
            snapshots.note_before(&mut encoder, buffers.positions[0].get(), particles);
        }
        let groups = buffers.groups(gpu, kernels);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("step"),
            timestamp_writes: self.timer.as_ref().map(Timer::writes),
        });
        for (class, &count) in self.runs.iter().enumerate().filter(|(_, count)| **count > 0) {
            pass.set_pipeline(kernels.small_step(gpu, class));
            pass.set_bind_group(0, &groups.common[0], &[]);
            pass.set_bind_group(1, &groups.small[class], &[]);
            let [across, down] = spread(count);
            pass.dispatch_workgroups(across, down, 1);
        }
        for (index, dispatch) in self.dispatches.iter().enumerate() {
            let &Dispatch { stage, groups: [across, down], side, .. } = dispatch;
            if stage == Stage::Contacts && !has_obstacles {
                continue;
            }
            let offset = [index as u32 * stride];
            pass.set_pipeline(match stage {
                Stage::Begin => &kernels.large_steps(gpu).begin,
                Stage::Drift => &kernels.large_steps(gpu).drift,
                Stage::Advance => &kernels.large_steps(gpu).advance,
                Stage::Contacts => &kernels.large_steps(gpu).contacts,
                Stage::Sticks => &kernels.large_steps(gpu).sticks,
                Stage::Tethers => &kernels.large_steps(gpu).tethers,
                Stage::Grid => kernels.grid_step(gpu),
            });
            pass.set_bind_group(0, &groups.common[side], &[]);
            let own = if stage == Stage::Grid { &groups.grid[side] } else { &groups.large };
            pass.set_bind_group(1, own, &offset);
            pass.dispatch_workgroups(across, down, 1);
        }
        drop(pass);
        for &(first, size) in &self.moved_over {
            let [to, from] = &buffers.positions;
            encoder.copy_buffer_to_buffer(from.get(), first, to.get(), first, size);
        }
        if let Some(snapshots) = &self.snapshots {
            snapshots.note_after(&mut encoder, buffers.positions[0].get(), particles);
        }
        if let Some(timer) = &self.timer {
            timer.resolve(&mut encoder);
        }
        gpu.queue.submit([encoder.finish()]);
    }
}

/// 1 over the mass of all particles in 1/kg; 0 if some are pinned.
fn inverse_mass(particles: &Particles) -> f32 {
    let mass = (0..particles.len()).map(|i| 1.0 / f64::from(particles.inverse_mass(i))).sum::<f64>();
    (1.0 / mass) as f32
}

fn body_data(member: &Member, model: &Model, dt: f32, first_pair: u32, first_batch: u32) -> BodyData {
    let settings = &member.settings;
    let substep = dt / settings.substeps as f32;
    let drag = Drag::new(settings.drag, substep);
    let [columns, rows] = model.grid.unwrap_or_default();
    BodyData {
        origin: member.origin.to_array(),
        first_particle: member.first_particle,
        particle_count: model.particle_count,
        substeps: settings.substeps,
        iterations: settings.iterations,
        is_square_root_free: u32::from(settings.projection == StickProjection::SquareRootFree),
        first_batch,
        batch_count: model.batches.len() as u32,
        first_tether: first_pair + model.first_tether,
        tethers_per_particle: if settings.tethers { model.tethers_per_particle } else { 0 },
        first_fan: first_pair + model.first_fan,
        memberships: member.layers.memberships,
        filters: member.layers.filters,
        thickness: settings.thickness,
        friction: settings.friction,
        static_friction: settings.static_friction.max(settings.friction),
        substep,
        decay: drag.decay(),
        gain: drag.gain() * substep * substep,
        tether_pull: TETHER_SPEED * substep,
        columns,
        rows,
        inverse_mass: member.inverse_mass,
        unused: [0; 3],
    }
}
