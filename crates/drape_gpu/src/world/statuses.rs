//! Boxes, speeds and faults of bodies, at once or later.

use std::sync::Arc;

use drape_solver::glam::Vec3;

use crate::error::GpuError;
use crate::gpu::{Gpu, PendingBytes};
use crate::layout::StatusData;
use crate::world::body_record::{BodyPlace, GpuBodyId};
use crate::world::gpu_world::GpuWorld;
use crate::world::last_step::Places;

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

/// Bytes of the status of a body.
const STATUS: u64 = size_of::<StatusData>() as u64;

impl BodyStatus {
    /// The status of a body in a step of `dt` seconds.
    fn new(status: &StatusData, place: &BodyPlace, dt: f32) -> Self {
        let corner = |keys: [u32; 3]| place.origin + Vec3::from(keys.map(StatusData::coordinate));
        Self {
            low: corner(status.low),
            high: corner(status.high),
            greatest_speed: f32::from_bits(status.fastest).sqrt() * place.substeps as f32 / dt,
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
        let Some(place) = self.place_of(id)? else { return Ok(None) };
        let Some(number) = place.number else { return Ok(None) };
        let bytes = self.gpu.read(self.buffers.statuses.get(), u64::from(number) * STATUS, STATUS)?;
        Ok(Some(BodyStatus::new(&bytemuck::pod_read_unaligned(&bytes), &place, self.dt)))
    }

    /// Asks for box, speed and fault of all bodies that do not rest in the last step that was started, and does not wait: a game looks for them in a later frame. On a
    /// shared device they come when its owner polls it, or submits something.
    ///
    /// # Errors
    /// [`GpuError::NotStepped`] if no body took part; [`GpuError::Lost`].
    pub fn request_statuses(&self) -> Result<PendingStatuses, GpuError> {
        let count = self.places.iter().filter(|(_, place)| place.number.is_some()).count() as u64;
        if count == 0 {
            return Err(GpuError::NotStepped);
        }
        let bytes = self.gpu.request(self.buffers.statuses.get(), 0, count * STATUS)?;
        Ok(PendingStatuses { gpu: self.gpu.clone(), bytes, places: Arc::clone(&self.places), dt: self.dt })
    }
}

/// Statuses that a game has [asked](GpuWorld::request_statuses) for.
#[derive(Debug)]
pub struct PendingStatuses {
    gpu: Gpu,
    bytes: PendingBytes,
    places: Places,
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
        let status = |&(id, place): &(GpuBodyId, BodyPlace)| {
            Some((id, BodyStatus::new(statuses.get(place.number? as usize)?, &place, self.dt)))
        };
        Ok(Ok(self.places.iter().filter_map(status).collect()))
    }
}
