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
        /// Name of the limit: WebGPU's, or `MAX_OBSTACLES`.
        name: &'static str,
    },
    /// The body has something that the GPU does not solve.
    #[error("{0} cannot be solved on the GPU")]
    Unsupported(&'static str),
    /// The step or the environment is invalid.
    #[error(transparent)]
    Step(#[from] drape_solver::StepError),
    /// Settings of a body are out of range.
    #[error(transparent)]
    Settings(#[from] drape_solver::BuildError),
    /// The particle is not pinned.
    #[error("particle {0} is not pinned")]
    NotPinned(u32),
    /// The vertices of a mesh contradict each other.
    #[error("the vertices of a mesh do not fit: {0}")]
    Vertices(&'static str),
    /// A value is not finite.
    #[error("{0} is not finite")]
    NotFinite(&'static str),
    /// The body has not been stepped since it was added, or all bodies rest.
    #[error("nothing has been stepped")]
    NotStepped,
    /// The world does not keep the positions of its last step.
    #[error("the world does not keep the positions of its last step: call `keep_last_positions` before it")]
    NoLastPositions,
    /// There is no body with this number, or it was removed.
    #[error("no such body")]
    NoSuchBody,
}

impl GpuError {
    /// The device failed for this reason.
    pub(crate) fn lost(reason: impl ToString) -> Self {
        Self::Lost(reason.to_string())
    }
}
