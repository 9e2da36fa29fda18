//! Results of a world for the caller, at once or later.

use std::time::Duration;

use drape_solver::Reaction;
use drape_solver::glam::Vec3;

use crate::error::GpuError;
use crate::gpu::{Gpu, PendingBytes};
use crate::source::IMPULSE_UNITS;
use crate::world::body_record::GpuBodyId;
use crate::world::gpu_world::{GpuWorld, PARTICLE};

/// Bytes of the sums of an obstacle's reactions: six numbers of 64 bits.
pub(super) const REACTION: u64 = 48;

impl GpuWorld {
    /// Positions of a body's particles (world, metres), after all steps that were started. Waits for them.
    ///
    /// # Errors
    /// [`GpuError::NoSuchBody`], [`GpuError::Lost`].
    pub fn read_positions(&self, id: GpuBodyId) -> Result<Vec<Vec3>, GpuError> {
        let record = self.record(id)?;
        if let Some((_, particles)) = self.arriving.iter().find(|(other, _)| *other == id) {
            return Ok(particles.positions().collect());
        }
        let count = self.models[record.model].1.particle_count;
        let first = u64::from(record.first_particle) * PARTICLE;
        let bytes = self.gpu.read(self.buffers.positions[0].get(), first, u64::from(count) * PARTICLE)?;
        Ok(places(&bytes, record.origin))
    }

    /// The opposite of all impulses that each obstacle which [asks for them](drape_solver::Obstacle::reporting_reaction) has given to bodies in
    /// the last step that was started; obstacles that touched nothing are left out. Waits for the step.
    ///
    /// The coupling is explicit: the caller moves the obstacle by them before the next step. Momentum is kept.
    ///
    /// # Errors
    /// [`GpuError::Lost`].
    pub fn read_reactions(&self) -> Result<Vec<Reaction>, GpuError> {
        if self.obstacles.iter().all(|obstacle| obstacle.is_asking == 0) {
            return Ok(Vec::new());
        }
        let bytes = self.obstacles.len() as u64 * REACTION;
        let sums = self.gpu.read(self.buffers.reactions.get(), 0, bytes)?;
        let sums: Vec<[i64; 6]> = bytemuck::pod_collect_to_vec(&sums);
        let vector = |sum: &[i64]| {
            Vec3::from_array([0, 1, 2].map(|k| (sum[k] as f64 / f64::from(IMPULSE_UNITS)) as f32))
        };
        let touched = sums.iter().zip(&self.obstacle_indices).filter(|(sum, _)| **sum != [0; 6]);
        let reaction = |(sum, &index): (&[i64; 6], &u32)| Reaction {
            obstacle: index as usize,
            impulse: vector(&sum[..3]),
            angular_impulse: vector(&sum[3..]),
        };
        Ok(touched.map(reaction).collect())
    }

    /// The time that the GPU took for the last step, once it is done; none if the device has no clock. Waits for the step.
    ///
    /// # Errors
    /// [`GpuError::Lost`].
    pub fn read_step_time(&self) -> Result<Option<Duration>, GpuError> {
        self.timer.as_ref().map(|timer| timer.read(&self.gpu)).transpose()
    }

    /// Asks for the positions of a body after all steps that were started, and does not wait: a game looks for them in a later frame. On a shared device
    /// they come when its owner polls it, or submits something.
    ///
    /// # Errors
    /// [`GpuError::NoSuchBody`]; [`GpuError::NotStepped`]; [`GpuError::Lost`].
    pub fn request_positions(&self, id: GpuBodyId) -> Result<PendingPositions, GpuError> {
        let place = self.place_of(id)?.ok_or(GpuError::NotStepped)?;
        let (first, count) = (u64::from(place.first_particle), u64::from(place.particle_count));
        let bytes = self.gpu.request(self.buffers.positions[0].get(), first * PARTICLE, count * PARTICLE)?;
        Ok(PendingPositions { gpu: self.gpu.clone(), bytes, origin: place.origin })
    }
}

/// Positions that a game has [asked](GpuWorld::request_positions) for.
#[derive(Debug)]
pub struct PendingPositions {
    gpu: Gpu,
    bytes: PendingBytes,
    origin: Vec3,
}

impl PendingPositions {
    /// The positions (world, metres) once the GPU has come so far, else the request itself. Never waits.
    ///
    /// # Errors
    /// [`GpuError::Lost`].
    pub fn try_take(self) -> Result<Result<Vec<Vec3>, Self>, GpuError> {
        self.gpu.notice_loss()?;
        Ok(match self.bytes.try_take()? {
            Some(bytes) => Ok(places(&bytes, self.origin)),
            None => Err(self),
        })
    }
}

/// Positions in the world from those relative to a body's origin.
fn places(bytes: &[u8], origin: Vec3) -> Vec<Vec3> {
    let place = |place: [f32; 4]| origin + Vec3::new(place[0], place[1], place[2]);
    bytemuck::pod_collect_to_vec::<u8, [f32; 4]>(bytes).into_iter().map(place).collect()
}
