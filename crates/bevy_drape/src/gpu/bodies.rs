//! The device, and the bodies on it.

use std::collections::BTreeSet;

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy::render::renderer::{RenderDevice, RenderQueue};
use drape_gpu::{Gpu, GpuError, GpuWorld};

use crate::gpu::report::{Disturbances, PendingReport};

/// The device that solves bodies with [`SolveOnGpu`](crate::gpu::SolveOnGpu): that of Bevy's renderer, unless you insert
/// [another one](Self::on).
///
/// ```
/// # use bevy::prelude::*;
/// use bevy_drape::gpu::{GpuBodies, GpuBody};
/// use bevy_drape::gpu::drape_gpu::PendingPositions;
///
/// /// Prints where the first particle of each body is, some frames later and without waiting.
/// fn follow(bodies: Res<GpuBodies>, all: Query<&GpuBody>, mut pending: Local<Vec<PendingPositions>>) -> Result {
///     let Some(world) = bodies.world() else { return Ok(()) };
///     if pending.is_empty() {
///         // Bodies that were never stepped have none.
///         pending.extend(all.iter().filter_map(|body| world.request_positions(body.id()).ok()));
///     }
///     for request in std::mem::take(&mut *pending) {
///         match request.try_take()? {
///             Ok(positions) => println!("{}", positions[0]),
///             Err(later) => pending.push(later),
///         }
///     }
///     Ok(())
/// }
/// ```
#[derive(Resource, Debug, Default)]
pub struct GpuBodies {
    gpu: Option<Gpu>,
    pub(super) world: Option<GpuWorld>,
    failure: Option<String>,
    /// Places and speeds that the GPU has been asked for.
    pub(super) report: Option<PendingReport>,
    pub(super) disturbances: Disturbances,
    /// True if there was a step in the last tick of the schedule that takes steps.
    pub(super) is_moving: bool,
    /// Obstacles that the log has named.
    pub(super) known_gaps: BTreeSet<Entity>,
}

impl GpuBodies {
    /// Solves on a device of your own, for an app without a renderer. Nothing is drawn from it. To be inserted before the first
    /// body.
    pub fn on(gpu: Gpu) -> Self {
        Self { gpu: Some(gpu), ..Self::default() }
    }

    /// The bodies; none before the first one.
    pub fn world(&self) -> Option<&GpuWorld> {
        self.world.as_ref()
    }

    /// The reason for which the processor solves all bodies, if there is one: no device, one that lacks something, or one that failed.
    pub fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    /// Makes the place `origin` the origin of the world. A report that is under way is of the old one.
    pub(crate) fn shift_origin(&mut self, origin: Vec3) {
        if let Some(world) = &mut self.world {
            world.shift_origin(origin);
        }
        self.report = None;
    }

    /// Forgets all bodies, and gives the GPU up for ever if it failed.
    pub(super) fn close(&mut self, failure: Option<String>) {
        if let Some(reason) = &failure {
            warn!("bodies with SolveOnGpu are solved on the processor: {reason}");
        }
        (self.world, self.report, self.failure) = (None, None, failure);
        self.known_gaps.clear();
    }

    /// Makes the world, if there is none and there is a device.
    pub(super) fn open(&mut self, renderer: &Renderer) {
        if self.world.is_some() || self.failure.is_some() {
            return;
        }
        match self.new_world(renderer) {
            Ok(Some(world)) => self.world = Some(world),
            Ok(None) => self.close(Some("there is no renderer and no device".to_string())),
            Err(error) => self.close(Some(error.to_string())),
        }
    }

    /// True if the bodies are on the device of the renderer.
    pub(super) fn is_on_renderer(&self) -> bool {
        self.gpu.is_none()
    }

    fn new_world(&self, renderer: &Renderer) -> Result<Option<GpuWorld>, GpuError> {
        if let Some(gpu) = &self.gpu {
            return Ok(Some(GpuWorld::new(gpu)));
        }
        let (Some(device), Some(queue)) = (&renderer.device, &renderer.queue) else { return Ok(None) };
        let gpu = Gpu::sharing(device.wgpu_device().clone(), (***queue).clone())?;
        let mut world = GpuWorld::new(&gpu);
        world.keep_last_positions()?;
        Ok(Some(world))
    }
}

/// The device of Bevy's renderer, in an app that draws.
#[derive(SystemParam)]
pub(crate) struct Renderer<'w> {
    device: Option<Res<'w, RenderDevice>>,
    queue: Option<Res<'w, RenderQueue>>,
}

impl Renderer<'_> {
    /// True if the device was replaced since this was last asked. Devices cannot be compared: those of two instances may count as equal.
    pub fn is_new(&self) -> bool {
        self.device.as_ref().is_some_and(|device| device.is_changed() && !device.is_added())
    }
}
