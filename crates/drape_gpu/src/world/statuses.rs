//! Boxes, speeds and faults of bodies, at once or later.

use std::sync::Arc;

use drape_solver::glam::Vec3;

use crate::error::GpuError;
use crate::gpu::{Gpu, PendingBytes};
use crate::layout::StatusData;
use crate::world::body_record::GpuBodyId;
use crate::world::gpu_world::GpuWorld;

/// Box, speed and fault of a body in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyStatus {
    /// Least corner of the box around the particles (world, metres).
    pub low: Vec3,
    /// Greatest corner.
    pub high: Vec3,
    /// Speed of the fastest particle in m/s.
    pub greatest_speed: f32,
    /// True if a particle would have been farther away than [`MAX_MAGNITUDE`](drape_solver::constants::MAX_MAGNITUDE), or nowhere. A small body
    /// then rests where it was before the step; of a large one, such particles rest where they were before sticks moved them.
    pub has_fault: bool,
}

/// The bodies that a step moves, in the order of their ids.
pub(super) type Stepped = Arc<[(GpuBodyId, SteppedBody)]>;

/// The parts of a body that its status needs, as they were in the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct SteppedBody {
    origin: Vec3,
    /// Its place in the table of bodies.
    number: u32,
    substeps: u32,
}

/// Bytes of the status of a body.
const STATUS: u64 = size_of::<StatusData>() as u64;

impl BodyStatus {
    /// The status of a body in a step of `dt` seconds.
    fn new(status: &StatusData, body: &SteppedBody, dt: f32) -> Self {
        let corner = |keys: [u32; 3]| body.origin + Vec3::from(keys.map(StatusData::coordinate));
        Self {
            low: corner(status.low),
            high: corner(status.high),
            greatest_speed: f32::from_bits(status.fastest).sqrt() * body.substeps as f32 / dt,
            has_fault: status.is_broken != 0,
        }
    }
}

impl GpuWorld {
    /// Box, speed and fault of a body in the last step that was started. None if it took no part in it. Waits for the step.
    ///
    /// # Errors
    /// [`GpuError::NoSuchBody`], [`GpuError::Lost`].
    pub fn read_status(&self, id: GpuBodyId) -> Result<Option<BodyStatus>, GpuError> {
        self.record(id)?;
        let Ok(found) = self.stepped.binary_search_by_key(&id, |(id, _)| *id) else { return Ok(None) };
        let body = &self.stepped[found].1;
        let bytes = self.gpu.read(self.buffers.statuses.get(), u64::from(body.number) * STATUS, STATUS)?;
        Ok(Some(BodyStatus::new(&bytemuck::pod_read_unaligned(&bytes), body, self.dt)))
    }

    /// Asks for box, speed and fault of all bodies that do not rest in the last step that was started, and does not wait: a game looks for them in a later frame. On a
    /// shared device they come when its owner polls it, or submits something.
    ///
    /// # Errors
    /// [`GpuError::NotStepped`] if no body took part; [`GpuError::Lost`].
    pub fn request_statuses(&self) -> Result<PendingStatuses, GpuError> {
        if self.stepped.is_empty() {
            return Err(GpuError::NotStepped);
        }
        let size = self.stepped.len() as u64 * STATUS;
        let bytes = self.gpu.request(self.buffers.statuses.get(), 0, size)?;
        Ok(PendingStatuses { gpu: self.gpu.clone(), bytes, bodies: Arc::clone(&self.stepped), dt: self.dt })
    }

    /// The bodies that the tables have.
    pub(super) fn list_stepped(&self) -> Stepped {
        let stepped = self.bodies.iter().filter_map(|(&id, record)| {
            let (origin, substeps) = (record.origin, record.settings.substeps);
            Some((GpuBodyId(id), SteppedBody { origin, number: record.number?, substeps }))
        });
        stepped.collect()
    }
}

/// Statuses that a game has [asked](GpuWorld::request_statuses) for.
#[derive(Debug)]
pub struct PendingStatuses {
    gpu: Gpu,
    bytes: PendingBytes,
    bodies: Stepped,
    dt: f32,
}

impl PendingStatuses {
    /// The statuses in ascending order of ids, once the GPU has come so far, else the request itself. Never waits. Bodies that were added after the step
    /// are not among them; those that were removed are.
    ///
    /// # Errors
    /// [`GpuError::Lost`].
    pub fn try_take(self) -> Result<Result<Vec<(GpuBodyId, BodyStatus)>, Self>, GpuError> {
        self.gpu.notice_loss()?;
        let Some(bytes) = self.bytes.try_take()? else { return Ok(Err(self)) };
        let statuses: Vec<StatusData> = bytemuck::pod_collect_to_vec(&bytes);
        let status = |(id, body): &(GpuBodyId, SteppedBody)| {
            Some((*id, BodyStatus::new(statuses.get(body.number as usize)?, body, self.dt)))
        };
        Ok(Ok(self.bodies.iter().filter_map(status).collect()))
    }
}
