//! Bodies on the GPU, stepped together.

use std::collections::BTreeMap;
use std::sync::Arc;

use drape_solver::glam::Vec3;
use drape_solver::{Body, Environment, Particles, Shape, Topology};

use crate::air::step_data;
use crate::buffers::{Buffers, dispatch_stride};
use crate::distance_field::DistanceFields;
use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::kernels::{Kernels, ListKernel, spread};
use crate::layout::{ObstacleData, PinData};
use crate::model::Model;
use crate::obstacle;
use crate::snapshots::Snapshots;
use crate::source::{Extras, LIST_WORKGROUP, SIZE_CLASSES};
use crate::timer::Timer;
use crate::world::body_record::{BodyPlace, BodyRecord, GpuBodyId};
use crate::world::dispatches::{Dispatch, Stage};
use crate::world::last_step::Places;
use crate::world::read_back::REACTION;
use crate::world::statuses::Stepped;

/// Bytes of the position or displacement of a particle.
pub(super) const PARTICLE: u64 = 16;

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
    pub(super) gpu: Gpu,
    pub(super) kernels: Kernels,
    pin_kernel: ListKernel<2>,
    pub(super) buffers: Buffers,
    /// Topologies with their pairs of words in the buffer, each with the index of its first pair.
    pub(super) models: Vec<(Arc<Topology>, Model, u32)>,
    /// Lists of vertices and rings that meshes share, each with the index of its first pair in the buffer.
    pub(super) shared_pairs: Vec<(Box<[[u32; 2]]>, u32)>,
    /// Of shapes without a formula.
    pub(super) fields: DistanceFields,
    /// By the numbers of their ids.
    pub(super) bodies: BTreeMap<u32, BodyRecord>,
    pub(super) next_id: u32,
    /// Ranges of particles that no body uses, as (count, first).
    pub(super) free: Vec<(u32, u32)>,
    pub(super) particle_count: u32,
    /// Bodies that have been added since the last step, with their particles.
    pub(super) arriving: Vec<(GpuBodyId, Particles)>,
    /// Bodies that have been woken since the last step.
    pub(super) woken: Vec<GpuBodyId>,
    /// Targets of pins for the coming step.
    pub(super) targets: BTreeMap<(GpuBodyId, u32), Vec3>,
    /// True if the tables of bodies and batches have to be written.
    pub(super) is_stale: bool,
    pub(super) dt: f32,
    /// Obstacles of the last step.
    pub(super) obstacles: Vec<ObstacleData>,
    /// Index of each in the environment.
    pub(super) obstacle_indices: Vec<u32>,
    /// The number of small bodies of each size class.
    pub(super) class_counts: [u32; SIZE_CLASSES.len()],
    pub(super) dispatches: Vec<Dispatch>,
    /// Ranges of particles that a step leaves in the second buffer of positions, in bytes.
    pub(super) moved_over: Vec<(u64, u64)>,
    pub(super) timer: Option<Timer>,
    pub(super) snapshots: Option<Snapshots>,
    /// Places of the bodies in the last step.
    pub(super) places: Places,
    /// The bodies that the last step moved.
    pub(super) stepped: Stepped,
    /// Indices of obstacles that the last step left out.
    pub(super) left_out: Vec<(usize, GpuError)>,
}

impl GpuWorld {
    /// A world without bodies.
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            gpu: gpu.clone(),
            kernels: Kernels::new(gpu),
            pin_kernel: ListKernel::of_pins(gpu),
            buffers: Buffers::new(gpu),
            models: Vec::new(),
            shared_pairs: Vec::new(),
            fields: DistanceFields::default(),
            bodies: BTreeMap::new(),
            next_id: 0,
            free: Vec::new(),
            particle_count: 0,
            arriving: Vec::new(),
            woken: Vec::new(),
            targets: BTreeMap::new(),
            is_stale: true,
            dt: 0.0,
            obstacles: Vec::new(),
            obstacle_indices: Vec::new(),
            class_counts: [0; SIZE_CLASSES.len()],
            dispatches: Vec::new(),
            moved_over: Vec::new(),
            timer: Timer::new(gpu),
            snapshots: None,
            places: Arc::default(),
            stepped: Arc::default(),
            left_out: Vec::new(),
        }
    }

    /// Adds a copy of a body. Bodies of equal topologies share their memory here.
    ///
    /// [Lines](drape_solver::StructuralSolve::Lines) are swept. Not heeded are the damping of sticks, early stops by tolerance, forces and targets of pins that the particles have
    /// been given, limits on motion, backstops, drives, joints, moving frames, and the report of contacts.
    ///
    /// # Errors
    /// [`GpuError::Unsupported`] if it has what the GPU does not solve: self-contact, a rigidity, pressure, rigid parts.
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
        if count as usize != body.topology.particle_count() {
            return Err(GpuError::Unsupported("a body with more or fewer particles than its topology"));
        }
        let model = self.model(&body.topology)?;
        let first_particle = match self.free.iter().position(|&(size, _)| size == count) {
            Some(place) => {
                // A large body needs buffers that a small one has not.
                self.reserve_particles(self.particle_count)?;
                self.free.swap_remove(place).1
            }
            None => {
                self.reserve_particles(self.particle_count + count)?;
                self.particle_count += count;
                self.particle_count - count
            }
        };
        let id = GpuBodyId(self.next_id);
        self.next_id += 1;
        self.bodies.insert(id.0, BodyRecord::new(body, model, first_particle));
        self.arriving.push((id, body.particles.clone()));
        self.is_stale = true;
        Ok(id)
    }

    /// Removes a body. Its memory is used again for bodies of as many particles; that of its topology is kept as long as the world.
    ///
    /// # Errors
    /// [`GpuError::NoSuchBody`].
    pub fn remove(&mut self, id: GpuBodyId) -> Result<(), GpuError> {
        let record = self.bodies.remove(&id.0).ok_or(GpuError::NoSuchBody)?;
        self.free.push((self.models[record.model].1.particle_count, record.first_particle));
        self.arriving.retain(|(other, _)| *other != id);
        self.targets.retain(|(other, _), _| *other != id);
        self.is_stale = true;
        Ok(())
    }

    /// The topology of a body, which all bodies share that have an equal one.
    ///
    /// # Errors
    /// [`GpuError::NoSuchBody`].
    pub fn topology(&self, id: GpuBodyId) -> Result<&Arc<Topology>, GpuError> {
        Ok(&self.models[self.record(id)?.model].0)
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// The number of bodies.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// True if there are no bodies.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Moves a pinned particle to `target` (world, metres) in the coming step, in equal parts over the substeps. The last of several targets counts.
    ///
    /// # Errors
    /// [`GpuError::NoSuchBody`], [`GpuError::NotPinned`], [`GpuError::NotFinite`].
    pub fn set_pin_target(&mut self, id: GpuBodyId, particle: u32, target: Vec3) -> Result<(), GpuError> {
        let record = self.record(id)?;
        if !target.is_finite() {
            return Err(GpuError::NotFinite("the target of a pin"));
        }
        if record.pins.binary_search(&particle).is_err() {
            return Err(GpuError::NotPinned(particle));
        }
        self.targets.insert((id, particle), target);
        self.set_resting(id, false)
    }

    /// Has steps leave a body alone, or take it along again, from where it is and without speed. A target for a pin wakes it too. A body that rests
    /// takes no time on the GPU, but a change writes the tables of all bodies anew.
    ///
    /// # Errors
    /// [`GpuError::NoSuchBody`].
    pub fn set_resting(&mut self, id: GpuBodyId, is_resting: bool) -> Result<(), GpuError> {
        let record = self.bodies.get_mut(&id.0).ok_or(GpuError::NoSuchBody)?;
        if record.is_resting != is_resting {
            record.is_resting = is_resting;
            self.is_stale = true;
            // It has moved on the GPU; what arrives keeps its speed.
            if !is_resting && record.has_arrived {
                self.woken.push(id);
            }
        }
        Ok(())
    }

    /// Sets the number of substeps of a body, 1 to [`MAX_SUBSTEPS`](drape_solver::constants::MAX_SUBSTEPS), from the coming step on. Its velocities stay. A
    /// change writes the tables of all bodies anew, in the coming step and in the one after it.
    ///
    /// # Errors
    /// [`GpuError::NoSuchBody`]; [`GpuError::Settings`] if the number is out of range.
    pub fn set_substeps(&mut self, id: GpuBodyId, substeps: u32) -> Result<(), GpuError> {
        let record = self.bodies.get_mut(&id.0).ok_or(GpuError::NoSuchBody)?;
        let before = core::mem::replace(&mut record.settings.substeps, substeps);
        if let Err(error) = record.settings.validate() {
            record.settings.substeps = before;
            return Err(error.into());
        }
        if substeps != before {
            // What arrives has a velocity, and no displacement yet.
            if record.has_arrived {
                record.rescale *= before as f32 / substeps as f32;
            }
            self.is_stale = true;
        }
        Ok(())
    }

    /// Makes the place `origin` (metres) the origin of the world from the coming step on: every body is where it was, in other coordinates.
    pub fn shift_origin(&mut self, origin: Vec3) {
        self.bodies.values_mut().for_each(|record| record.origin -= origin);
        self.targets.values_mut().for_each(|target| *target -= origin);
        self.arriving.iter_mut().for_each(|(_, particles)| particles.shift_origin(origin));
        self.places = self.list_places();
        self.is_stale = true;
    }

    /// True if steps move nothing, because there are no bodies, or all of them rest.
    pub fn is_resting(&self) -> bool {
        self.bodies.values().all(|record| record.is_resting)
    }

    /// From the next step on, keeps the positions before and after each step, for a [`SurfaceWriter`](crate::SurfaceWriter): 64 bytes a
    /// particle, and two copies of all positions a step.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the device has no room.
    pub fn keep_last_positions(&mut self) -> Result<(), GpuError> {
        self.snapshots.get_or_insert_with(|| Snapshots::new(&self.gpu));
        self.reserve_particles(self.particle_count)
    }

    /// Begins a frame that is drawn: its steps leave alone what the frame before draws from.
    pub fn begin_frame(&mut self) {
        if let Some(snapshots) = &mut self.snapshots {
            snapshots.begin_frame();
        }
    }

    /// The place of a body in the buffers; none if it has not been stepped.
    pub(crate) fn place_of(&self, id: GpuBodyId) -> Result<Option<BodyPlace>, GpuError> {
        let record = self.record(id)?;
        let (_, model, first_pair) = &self.models[record.model];
        Ok(record.has_arrived.then(|| BodyPlace {
            origin: record.origin,
            first_particle: record.first_particle,
            particle_count: model.particle_count,
            first_fan: first_pair + model.first_fan,
        }))
    }

    /// Starts a step of all bodies, and returns before it is done. The environment's shelter and wind zones are not heeded.
    ///
    /// The first step with an obstacle of a shape without a formula (a mesh, a compound, another shape of parry's) waits until its distances
    /// are sampled on a lattice of 48 cells along its longest side: some tenths of a second, and up to 0.75 MB that stay while the world
    /// lives. Keep such a shape and clone it: one that is made anew counts as another.
    /// Obstacles that have neither a formula nor an inside, are too thin for the lattice, or too many, are [left out](Self::left_out).
    ///
    /// # Errors
    /// [`GpuError::Step`] if the environment is invalid; [`GpuError::Limit`] if something does not fit; [`GpuError::Lost`]. Nothing has moved then.
    pub fn step(&mut self, environment: &Environment) -> Result<(), GpuError> {
        self.gpu.notice_loss()?;
        environment.validate()?;
        let dt = environment.dt;
        let Self { gpu, buffers, fields, .. } = self;
        let field_of = |shape: &Shape| fields.field(shape, |pairs| buffers.push_pairs(gpu, pairs));
        let obstacle::List { obstacles, indices, left_out } =
            obstacle::list(&environment.obstacles, field_of)?;
        let mut step = step_data(environment);
        step.obstacle_count = obstacles.len() as u32;
        let tables = (self.is_stale || dt != self.dt).then(|| self.make_tables(dt));
        if let Some(tables) = &tables {
            self.reserve_tables(tables)?;
        }
        let are_new = obstacles != self.obstacles;
        let data: &[u8] = bytemuck::cast_slice(&obstacles);
        self.buffers.reserve(&self.gpu, data.len() as u64, |buffers| &mut buffers.obstacles)?;
        let sums = obstacles.len() as u64 * REACTION;
        self.buffers.reserve(&self.gpu, sums, |buffers| &mut buffers.reactions)?;
        let pins = (self.targets.len() as u64 + 1) * size_of::<PinData>() as u64;
        self.buffers.pin_targets.reserve(&self.gpu, pins)?;

        // Nothing fails from here on.
        if let Some(tables) = tables {
            self.write_tables(tables);
            self.stepped = self.list_stepped();
            let places = self.list_places();
            if *places != *self.places {
                self.places = places;
            }
        }
        if are_new {
            self.buffers.obstacles.write(&self.gpu, 0, data);
        }
        self.dt = dt;
        (self.obstacles, self.obstacle_indices, self.left_out) = (obstacles, indices, left_out);
        let moves_nothing = self.dispatches.is_empty() && self.class_counts.iter().all(|&count| count == 0);
        if moves_nothing && self.arriving.is_empty() {
            // Nothing was touched either.
            (self.obstacles, self.obstacle_indices) = (Vec::new(), Vec::new());
            return Ok(());
        }
        self.write_arriving();
        self.gpu.queue.write_buffer(&self.buffers.step, 0, bytemuck::bytes_of(&step));
        self.submit();
        Ok(())
    }

    /// Obstacles of the last step's environment that bodies pass through, by their indices, and why: their shapes cannot be sampled
    /// ([`GpuError::Unsupported`]), or they are too many ([`GpuError::Limit`]).
    pub fn left_out(&self) -> &[(usize, GpuError)] {
        &self.left_out
    }

    pub(super) fn record(&self, id: GpuBodyId) -> Result<&BodyRecord, GpuError> {
        self.bodies.get(&id.0).ok_or(GpuError::NoSuchBody)
    }

    /// The place of a topology among the models, to which it is added if it is new.
    fn model(&mut self, topology: &Arc<Topology>) -> Result<usize, GpuError> {
        let known =
            self.models.iter().position(|(known, ..)| Arc::ptr_eq(known, topology) || known == topology);
        if let Some(place) = known {
            return Ok(place);
        }
        let size_class = self.kernels.size_class(topology.particle_count() as u32);
        let model = Model::new(topology, size_class, self.kernels.tile.is_some())?;
        let first = self.buffers.push_pairs(&self.gpu, &model.pairs)?;
        self.models.push((Arc::clone(topology), Model { pairs: Vec::new(), ..model }, first));
        Ok(self.models.len() - 1)
    }

    /// Writes the particles of bodies that are new.
    fn write_arriving(&mut self) {
        for (id, particles) in core::mem::take(&mut self.arriving) {
            let Some(record) = self.bodies.get(&id.0) else { continue };
            let substep = self.dt / record.settings.substeps as f32;
            let count = particles.len();
            let position = |i: usize| {
                let place = particles.local_position(i);
                [place.x, place.y, place.z, particles.inverse_mass(i)]
            };
            let displacement = |i: usize| {
                let moved = particles.velocity(i) * substep;
                if particles.is_pinned(i) { [0.0; 4] } else { [moved.x, moved.y, moved.z, 0.0] }
            };
            let positions: Vec<[f32; 4]> = (0..count).map(position).collect();
            let displacements: Vec<[f32; 4]> = (0..count).map(displacement).collect();
            let first = u64::from(record.first_particle) * PARTICLE;
            self.buffers.positions[0].write(&self.gpu, first, bytemuck::cast_slice(&positions));
            self.buffers.displacements.write(&self.gpu, first, bytemuck::cast_slice(&displacements));
        }
    }

    /// Stops bodies that have been woken: in the meantime the length of a step may have changed, and with it what a displacement means.
    fn encode_stops(&mut self, encoder: &mut wgpu::CommandEncoder) {
        for id in core::mem::take(&mut self.woken) {
            let Ok(Some(place)) = self.place_of(id) else { continue };
            let [first, count] = [place.first_particle, place.particle_count].map(u64::from);
            let size = Some(count * PARTICLE);
            encoder.clear_buffer(self.buffers.displacements.get(), first * PARTICLE, size);
        }
    }

    /// Hands the targets to the particles at the start of the step.
    fn encode_targets(&mut self, encoder: &mut wgpu::CommandEncoder) {
        if self.targets.is_empty() {
            return;
        }
        let Self { gpu, buffers, bodies, targets, pin_kernel, .. } = self;
        let count = targets.len() as u32;
        let mut pins = vec![PinData { place: [0.0; 3], particle: count }];
        pins.extend(core::mem::take(targets).into_iter().map(|((id, particle), target)| {
            let record = &bodies[&id.0];
            PinData { place: (target - record.origin).to_array(), particle: record.first_particle + particle }
        }));
        buffers.pin_targets.write(gpu, 0, bytemuck::cast_slice(&pins));
        let bound = [buffers.pin_targets.get(), buffers.displacements.get()];
        pin_kernel.encode(gpu, encoder, bound, count.div_ceil(LIST_WORKGROUP));
    }

    fn submit(&mut self) {
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.encode_stops(&mut encoder);
        self.encode_targets(&mut encoder);
        let Self { gpu, kernels, buffers, .. } = self;
        let stride = dispatch_stride(gpu) as u32;
        let has_obstacles = !self.obstacles.is_empty();
        let has_extras = self.obstacles.iter().any(ObstacleData::needs_extras);
        let extras = if has_extras { Extras::FieldsAndReactions } else { Extras::None };
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
        for (class, &count) in self.class_counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            pass.set_pipeline(kernels.small_step(gpu, class, count, extras));
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
                Stage::Begin => &kernels.large_steps(gpu, extras).begin,
                Stage::Drift => &kernels.large_steps(gpu, extras).drift,
                Stage::Advance => &kernels.large_steps(gpu, extras).advance,
                Stage::Contacts => &kernels.large_steps(gpu, extras).contacts,
                Stage::Sticks => &kernels.large_steps(gpu, extras).sticks,
                Stage::Tethers => &kernels.large_steps(gpu, extras).tethers,
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
