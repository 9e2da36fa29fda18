//! Writes the tables that the shaders read: bodies, batches of sticks, and what the dispatches of large bodies read.

use drape_solver::BodySettings;

use crate::buffers::pass_stride;
use crate::error::GpuError;
use crate::layout::{BodyData, PassData, RunData, StatusData};
use crate::source::SIZE_CLASSES;
use crate::world::gpu_world::{GpuWorld, PARTICLE};
use crate::world::passes;

impl GpuWorld {
    /// Writes the tables of bodies and batches for steps of `dt` seconds, and lists the dispatches of large bodies.
    pub(super) fn write_tables(&mut self, dt: f32) -> Result<(), GpuError> {
        let Self { gpu, kernels, models, bodies: members, .. } = self;
        let mut batches = Vec::new();
        // Bodies of one topology with equal settings share their batches.
        let mut known: Vec<(usize, BodySettings, u32)> = Vec::new();
        let mut by_class: [Vec<(u32, BodyData)>; SIZE_CLASSES.len() + 1] = Default::default();
        for (&id, member) in members.iter() {
            let (_, model, first_pair) = &models[member.model];
            let is_same = |(model, settings, _): &&(usize, BodySettings, u32)| {
                *model == member.model && settings.has_same_bits(&member.settings)
            };
            let first_batch = match known.iter().find(is_same) {
                Some(&(.., first)) => first,
                None => {
                    let first = batches.len() as u32;
                    batches.extend(model.batches(&member.settings, dt, *first_pair));
                    known.push((member.model, member.settings, first));
                    first
                }
            };
            let data = member.data(model, dt, *first_pair, first_batch);
            let class = kernels.size_class(gpu, model.particle_count).unwrap_or(SIZE_CLASSES.len());
            by_class[class].push((id, data));
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
            for (id, data) in list {
                let number = table.len() as u32;
                table.push(*data);
                let Some(member) = members.get_mut(id) else { continue };
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
        let Self { gpu, buffers, .. } = self;
        buffers.reserve(gpu, bodies.len() as u64, |buffers| &mut buffers.bodies)?;
        buffers.reserve(gpu, batches.len() as u64, |buffers| &mut buffers.batches)?;
        buffers.reserve(gpu, body_count * size_of::<StatusData>() as u64, |buffers| &mut buffers.statuses)?;
        buffers.bodies.write(gpu, 0, bodies);
        buffers.batches.write(gpu, 0, batches);
        let stride = pass_stride(gpu) as usize;
        let mut data = vec![0; stride * self.dispatches.len()];
        for (slot, dispatch) in data.chunks_mut(stride.max(1)).zip(&self.dispatches) {
            slot[..size_of::<PassData>()].copy_from_slice(bytemuck::bytes_of(&dispatch.data));
        }
        buffers.write_passes(gpu, &data)
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
        if models.iter().any(|(_, model, _)| model.is_tiled) {
            buffers.reserve(gpu, bytes, |buffers| &mut buffers.positions[1])?;
        }
        if models.iter().any(|(_, model, _)| !model.is_small) {
            buffers.reserve(gpu, 2 * bytes, |buffers| &mut buffers.flights)?;
            buffers.reserve(gpu, bytes, |buffers| &mut buffers.accelerations)?;
        }
        Ok(())
    }
}
