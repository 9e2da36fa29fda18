//! Finds out whether anything can be drawn at all.

use bevy::render::settings::{Backends, WgpuSettings};
use bevy::tasks::block_on;
use thiserror::Error;

/// There is no graphics adapter, neither hardware nor software.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("no graphics adapter found; on Linux, Mesa's software driver will do (package mesa-vulkan-drivers)")]
pub struct NoAdapter;

/// Makes sure that there is an adapter: Bevy's renderer panics where it finds none.
///
/// # Errors
/// [`NoAdapter`].
pub fn find_adapter() -> Result<(), NoAdapter> {
    let settings = WgpuSettings::default();
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = settings.backends.unwrap_or(Backends::all());
    let options =
        wgpu::RequestAdapterOptions { power_preference: settings.power_preference, ..Default::default() };
    let found = block_on(wgpu::Instance::new(descriptor).request_adapter(&options));
    found.map(drop).map_err(|_| NoAdapter)
}
