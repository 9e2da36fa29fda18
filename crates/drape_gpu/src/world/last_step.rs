//! The last step of a world, for whoever draws it.

use std::sync::Arc;

use crate::error::GpuError;
use crate::world::body_record::{BodyPlace, GpuBodyId};
use crate::world::gpu_world::GpuWorld;

/// The places of all bodies in a step, in the order of their ids. It stays the same one until bodies come or go.
pub(crate) type Places = Arc<[(GpuBodyId, BodyPlace)]>;

/// The bodies of a world before and after its last step, for a [`SurfaceWriter`](crate::SurfaceWriter). It holds handles only, so that it can go to
/// the thread of a renderer while the world is stepped. It shows its step until the second [`GpuWorld::begin_frame`], if
/// one is called before the next step; else the next step writes over it.
#[derive(Clone, Debug)]
pub struct LastStep {
    /// Pairs of words of the world, its positions before and after the step.
    pub(crate) read: [wgpu::Buffer; 3],
    pub(crate) places: Places,
}

impl LastStep {
    /// The number of particles of a body, at rest or not. None if it was added after the step.
    pub fn particle_count(&self, id: GpuBodyId) -> Option<u32> {
        self.place_of(id).map(|place| place.particle_count)
    }

    /// The place of a body in the buffers; none if it was added after the step.
    pub(crate) fn place_of(&self, id: GpuBodyId) -> Option<&BodyPlace> {
        let found = self.places.binary_search_by_key(&id, |(id, _)| *id).ok()?;
        Some(&self.places[found].1)
    }
}

impl GpuWorld {
    /// The bodies before and after the last step: to be asked for in each frame, after its steps.
    ///
    /// # Errors
    /// [`GpuError::NoLastPositions`] if the world does not [keep them](Self::keep_last_positions), or has not been stepped since.
    pub fn last_step(&self) -> Result<LastStep, GpuError> {
        let snapshots = self.snapshots.as_ref().and_then(|snapshots| snapshots.last());
        let [before, after] = snapshots.ok_or(GpuError::NoLastPositions)?;
        let read = [self.buffers.pairs.get(), before, after].map(wgpu::Buffer::clone);
        Ok(LastStep { read, places: Arc::clone(&self.places) })
    }

    /// The places of all bodies, at rest or not.
    pub(super) fn list_places(&self) -> Places {
        self.bodies
            .keys()
            .filter_map(|&id| Some((GpuBodyId(id), self.place_of(GpuBodyId(id)).ok()??)))
            .collect()
    }
}
