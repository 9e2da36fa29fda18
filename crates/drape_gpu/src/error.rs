//! Typed errors.

use thiserror::Error;

/// A reason why something cannot be solved on the GPU.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// There is no graphics adapter, neither hardware nor software.
    #[error(
        "no graphics adapter with compute shaders; on Linux, Mesa's software driver will do (package mesa-vulkan-drivers)"
    )]
    NoAdapter,
    /// The adapter opens no device.
    #[error("the graphics adapter opens no device: {0}")]
    NoDevice(String),
    /// The device was lost, or refused to work.
    #[error("the graphics device failed: {0}")]
    Lost(String),
    /// The device has too little of something.
    #[error("{what} needs {needed}, but the device allows {limit} ({name})")]
    Limit {
        /// The thing that does not fit.
        what: &'static str,
        /// The amount that it needs.
        needed: u64,
        /// The most that the device allows.
        limit: u64,
        /// The limit's name in WebGPU.
        name: &'static str,
    },
    /// The body has something that the GPU does not solve.
    #[error("{0} cannot be solved on the GPU")]
    Unsupported(&'static str),
    /// The step, the environment or the settings are invalid.
    #[error(transparent)]
    Step(#[from] drape_solver::StepError),
    /// Settings of a body are out of range.
    #[error(transparent)]
    Settings(#[from] drape_solver::BuildError),
    /// There is no body with this number, or it was removed.
    #[error("no such body")]
    NoSuchBody,
}
