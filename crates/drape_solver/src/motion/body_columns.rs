//! The columns of a body for kernels: those that a substep changes, and those that it only reads.

use glam::Vec3;

use crate::motion::integrate::Flight;
use crate::simd::columns::{Cell, LANES};
use crate::state::frame_motion::SubstepMotion;
use crate::state::pose_constraints::PoseConstraints;
use crate::state::substep::Substep;
use crate::state::topology::Topology;

/// The columns of some cells that a substep changes.
pub(crate) struct MovingColumns<'a> {
    pub position: &'a mut [Cell],
    pub displacement: &'a mut [Cell],
    /// Positions after integration.
    pub integrated: &'a mut [Cell],
}

/// Data that all strips of a body share. Columns are those of the whole body.
#[derive(Clone, Copy)]
pub(crate) struct BodyColumns<'a> {
    pub inverse_mass: &'a [[f32; LANES]],
    /// For each cell the inverse mass that all its particles share, or 0.
    pub common_mass: &'a [f32],
    pub topology: &'a Topology,
    pub stiffness: &'a [f32],
    pub damping: &'a [f32],
    pub flight: Flight,
    pub varying: &'a [Cell],
    pub anchors: &'a [Cell],
    pub substep: Substep<'a>,
    /// Origin of the body's own coordinates, in the world, in metres.
    pub origin: Vec3,
    /// Metres.
    pub thickness: f32,
    pub drift: Vec3,
    pub pose: &'a PoseConstraints,
    pub frame: Option<&'a SubstepMotion>,
    /// Greatest pull of a tether in one substep, in metres.
    pub tether_reach: f32,
    /// Factor on the rest lengths of the topology in this substep.
    pub length_ratio: f32,
}
