//! The tables that the shaders read: bodies, batches of sticks, and what the dispatches of large bodies read.

use drape_solver::BodySettings;

use crate::buffers::dispatch_stride;
use crate::error::GpuError;
use crate::layout::{BatchData, BodyData, DispatchData, SizeClassData, StatusData};
use crate::model::Way;
use crate::source::SIZE_CLASSES;
use crate::world::dispatches::{self, Dispatch};
use crate::world::gpu_world::{GpuWorld, PARTICLE};

/// The tables of all bodies for steps of one length.
#[derive(Debug, Default)]
pub(super) struct Tables {
    bodies: Vec<BodyData>,
    /// The id of each.
    ids: Vec<u32>,
    batches: Vec<BatchData>,
    /// The number of small bodies of each size class. They come first, large ones last.
    class_counts: [u32; SIZE_CLASSES.len()],
    dispatches: Vec<Dispatch>,
    /// Ranges of particles that a step leaves in the second buffer of positions, in bytes.
    moved_over: Vec<(u64, u64)>,
}

impl GpuWorld {
    /// The tables for steps of `dt` seconds.
    pub(super) fn make_tables(&self, dt: f32) -> Tables {
        let Self { kernels, models, bodies, .. } = self;
        let mut tables = Tables::default();
        // Bodies of one topology with equal settings share their batches.
        let mut known: Vec<(usize, BodySettings, u32)> = Vec::new();
        let mut of_classes: [Vec<(u32, BodyData)>; SIZE_CLASSES.len()] = Default::default();
        let mut large: Vec<(u32, BodyData)> = Vec::new();
        for (&id, body) in bodies.iter().filter(|(_, body)| !body.is_resting) {
            let (_, model, first_pair) = &models[body.model];
            let is_same = |(model, settings, _): &&(usize, BodySettings, u32)| {
                *model == body.model && settings.has_same_bits(&body.settings)
            };
            let first_batch = match known.iter().find(is_same) {
                Some(&(.., first)) => first,
                None => {
                    let first = tables.batches.len() as u32;
                    tables.batches.extend(model.batches(&body.settings, dt, *first_pair));
                    known.push((body.model, body.settings, first));
                    first
                }
            };
            let mut data = body.data(model, dt, *first_pair, first_batch);
            if body.has_arrived && self.dt > 0.0 {
                data.rescale *= dt / self.dt;
            }
            let list = match model.way {
                Way::Small(class) => &mut of_classes[class],
                Way::Listed | Way::Tiled => &mut large,
            };
            list.push((id, data));
        }
        for (count, list) in tables.class_counts.iter_mut().zip(of_classes) {
            *count = list.len() as u32;
            tables.ids.extend(list.iter().map(|(id, _)| id));
            tables.bodies.extend(list.into_iter().map(|(_, data)| data));
        }
        for (id, data) in large {
            let number = tables.bodies.len() as u32;
            let model = &models[bodies[&id].model].1;
            if dispatches::push(&mut tables.dispatches, number, &data, model, kernels.inner()) == 1 {
                let range = [data.first_particle, data.particle_count].map(u64::from);
                tables.moved_over.push((range[0] * PARTICLE, range[1] * PARTICLE));
            }
            tables.ids.push(id);
            tables.bodies.push(data);
        }
        tables
    }

    /// Makes room for the tables.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the device has none.
    pub(super) fn reserve_tables(&mut self, tables: &Tables) -> Result<(), GpuError> {
        let Self { gpu, buffers, .. } = self;
        let Tables { bodies, batches, dispatches, .. } = tables;
        let statuses = (bodies.len() * size_of::<StatusData>()) as u64;
        buffers.reserve(gpu, size_of_val(&**bodies) as u64, |buffers| &mut buffers.bodies)?;
        buffers.reserve(gpu, size_of_val(&**batches) as u64, |buffers| &mut buffers.batches)?;
        buffers.reserve(gpu, statuses, |buffers| &mut buffers.statuses)?;
        buffers.reserve_dispatches(gpu, dispatch_stride(gpu) * dispatches.len() as u64)
    }

    /// Writes the tables, for which there is [room](Self::reserve_tables).
    pub(super) fn write_tables(&mut self, tables: Tables) {
        let Self { gpu, buffers, .. } = self;
        buffers.bodies.write(gpu, 0, bytemuck::cast_slice(&tables.bodies));
        buffers.batches.write(gpu, 0, bytemuck::cast_slice(&tables.batches));
        let stride = dispatch_stride(gpu) as usize;
        let mut data = vec![0; stride * tables.dispatches.len()];
        for (slot, dispatch) in data.chunks_mut(stride).zip(&tables.dispatches) {
            slot[..size_of::<DispatchData>()].copy_from_slice(bytemuck::bytes_of(&dispatch.data));
        }
        gpu.queue.write_buffer(&buffers.dispatches, 0, &data);
        let mut first_body = 0;
        for (buffer, &body_count) in buffers.size_classes.iter().zip(&tables.class_counts) {
            let data = SizeClassData { first_body, body_count, unused: [0; 2] };
            gpu.queue.write_buffer(buffer, 0, bytemuck::bytes_of(&data));
            first_body += body_count;
        }
        // To be written again for the next step, which must not rescale anything.
        self.is_stale = tables.bodies.iter().any(|body| body.rescale != 1.0);
        for body in self.bodies.values_mut() {
            (body.number, body.has_arrived, body.rescale) = (None, true, 1.0);
        }
        for (number, id) in tables.ids.iter().enumerate() {
            if let Some(body) = self.bodies.get_mut(id) {
                body.number = Some(number as u32);
            }
        }
        self.class_counts = tables.class_counts;
        self.dispatches = tables.dispatches;
        self.moved_over = tables.moved_over;
    }

    /// Makes room for so many particles.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the device has none.
    pub(super) fn reserve_particles(&mut self, count: u32) -> Result<(), GpuError> {
        let Self { gpu, buffers, models, snapshots, .. } = self;
        let bytes = u64::from(count) * PARTICLE;
        buffers.reserve(gpu, bytes, |buffers| &mut buffers.positions[0])?;
        buffers.reserve(gpu, bytes, |buffers| &mut buffers.displacements)?;
        if let Some(snapshots) = snapshots {
            snapshots.reserve(gpu, bytes)?;
        }
        if models.iter().any(|(_, model, _)| model.way == Way::Tiled) {
            buffers.reserve(gpu, bytes, |buffers| &mut buffers.positions[1])?;
        }
        if models.iter().any(|(_, model, _)| !matches!(model.way, Way::Small(_))) {
            buffers.reserve(gpu, 2 * bytes, |buffers| &mut buffers.flights)?;
            buffers.reserve(gpu, bytes, |buffers| &mut buffers.accelerations)?;
        }
        Ok(())
    }
}
