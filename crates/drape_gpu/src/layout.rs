//! Structures for the shaders, field by field as `shaders/structures.wgsl` declares it.

use bytemuck::{Pod, Zeroable};
use drape_solver::motion::wind::WAVES;

#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct WaveData {
    pub number: [f32; 3],
    pub phase: f32,
    pub amplitude: [f32; 3],
    pub unused: f32,
}

/// `Step`: the same for all bodies.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct StepData {
    pub gravity: [f32; 3],
    pub duration: f32,
    pub wind: [f32; 3],
    pub drag: f32,
    pub lift: f32,
    pub is_windy: u32,
    pub wave_count: u32,
    pub obstacle_count: u32,
    pub waves: [WaveData; WAVES],
}

/// `Obstacle`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ObstacleData {
    pub low: [f32; 3],
    pub shape: u32,
    pub high: [f32; 3],
    pub friction: f32,
    pub start: [f32; 3],
    pub static_friction: f32,
    pub end: [f32; 3],
    pub combine_rule: u32,
    pub start_rotation: [f32; 4],
    pub end_rotation: [f32; 4],
    pub size: [f32; 4],
    pub memberships: u32,
    pub filters: u32,
    pub is_moving: u32,
    pub is_asking: u32,
    pub cell: [f32; 3],
    pub first_pair: u32,
    pub corners: [u32; 3],
    pub unused: u32,
}

impl ObstacleData {
    /// True if it has a field of distances, or asks for its reactions.
    pub fn needs_extras(&self) -> bool {
        self.shape == FIELD || self.is_asking != 0
    }
}

/// The number of a shape with a field of distances.
pub(crate) const FIELD: u32 = 6;

/// `Body`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct BodyData {
    pub origin: [f32; 3],
    pub first_particle: u32,
    pub particle_count: u32,
    pub substeps: u32,
    pub iterations: u32,
    pub is_square_root_free: u32,
    pub first_batch: u32,
    pub batch_count: u32,
    pub first_tether: u32,
    pub tethers_per_particle: u32,
    pub first_fan: u32,
    pub memberships: u32,
    pub filters: u32,
    pub thickness: f32,
    pub friction: f32,
    pub static_friction: f32,
    pub substep: f32,
    pub decay: f32,
    pub gain: f32,
    pub tether_pull: f32,
    pub columns: u32,
    pub rows: u32,
    pub inverse_mass: f32,
    pub rescale: f32,
    pub has_squares: u32,
    pub unused: u32,
}

/// `Batch`: sticks that share no particle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct BatchData {
    pub first: u32,
    pub count: u32,
    pub stiffness: f32,
    pub side: i32,
    pub right: i32,
    pub down: i32,
    pub phase: u32,
    pub rest_length: f32,
}

/// `Run` of `small_bodies.wgsl`: the bodies of one dispatch.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SizeClassData {
    pub first_body: u32,
    pub body_count: u32,
    pub unused: [u32; 2],
}

/// `Status`. Coordinates are [ordered](StatusData::coordinate) integers.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct StatusData {
    pub low: [u32; 3],
    pub is_broken: u32,
    pub high: [u32; 3],
    pub fastest: u32,
    pub drift: [i32; 6],
    pub unused: [u32; 2],
}

impl StatusData {
    /// The coordinate that an integer of the same order stands for.
    pub fn coordinate(key: u32) -> f32 {
        f32::from_bits(if key >> 31 == 1 { key & 0x7fff_ffff } else { !key })
    }
}

/// `PinTarget` of `pins.wgsl`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct PinData {
    pub place: [f32; 3],
    pub particle: u32,
}

/// `Pass` of `large_bodies.wgsl`: one stage of one body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct DispatchData {
    pub body: u32,
    pub batch: u32,
    pub substep: u32,
    pub iteration: u32,
    pub ends: u32,
    pub begins: u32,
    pub unused: [u32; 2],
}
