//! Moving air: a wind, its gusts, and zones with a wind of their own.
//!
//! `air.rs` has the velocity of the air around a body, `air_force.rs` the force that it makes.
//!
//! Design: `docs/design/wind.md`.

use core::f64::consts::TAU;

use glam::{DVec3, Vec3};

use crate::error::{StepError, finite_vector, in_range, positive};
use crate::geometry::pose::{Placement, Pose};
use crate::splitmix::SplitMix64;

/// A wind that pushes on faces, and on the links of ropes.
///
/// With `u` the wind relative to a face of area `A` and unit normal `n`, the face feels the pressure of a flow on a plate,
/// `F = 1/2 rho c_d A (u . n)|u . n| n`, and, at right angles to `u`, the lift
/// `F = 1/2 rho c_l A (u . n) (n |u|^2 - u (u . n)) / |u|`, which is zero on a plate square to the flow or along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wind {
    /// Velocity of the air in m/s. Zero is no wind at all: still air brakes by the bodies' own drag.
    pub velocity: Vec3,
    /// Density of the air in kg/m^3.
    pub air_density: f32,
    /// Drag coefficient `c_d` of a plate square to the wind; 1.2 for a flat one.
    pub drag_coefficient: f32,
    /// Lift coefficient `c_l`; 0 by default. With some 1 a flag flutters more, and cloth that falls glides.
    pub lift_coefficient: f32,
    /// Gusts: the variation of the wind in space and time.
    pub turbulence: Turbulence,
    /// The part of the wind that an obstacle keeps off its lee, from 0, the default, to 1. A place is in the lee if a
    /// ray from there against the wind hits an obstacle within [`SHELTER_REACH`].
    pub shelter: f32,
}

/// Length of an obstacle's lee, in metres.
pub const SHELTER_REACH: f32 = 10.0;

impl Default for Wind {
    fn default() -> Self {
        Self {
            velocity: Vec3::ZERO,
            air_density: 1.2,
            drag_coefficient: 1.2,
            lift_coefficient: 0.0,
            turbulence: Turbulence::default(),
            shelter: 0.0,
        }
    }
}

impl Wind {
    /// A wind of `velocity` (m/s) in ordinary air.
    pub fn new(velocity: Vec3) -> Self {
        Self { velocity, ..Self::default() }
    }

    /// The way in metres from a place to the farthest obstacle that keeps the wind off it; none if obstacles do not.
    pub fn shelter_way(&self) -> Option<Vec3> {
        let direction = self.velocity.try_normalize()?;
        (self.shelter > 0.0).then_some(direction * -SHELTER_REACH)
    }

    /// Checks that everything is finite and in its range.
    ///
    /// # Errors
    /// [`StepError::BadEnvironment`].
    pub fn validate(&self) -> Result<(), StepError> {
        let Self { velocity, air_density, drag_coefficient, lift_coefficient, turbulence, shelter } = *self;
        let scalars = [Vec3::new(air_density, drag_coefficient, lift_coefficient), velocity];
        let are_finite = scalars.into_iter().all(|vector| finite_vector("wind", vector).is_ok());
        let is_good = are_finite
            && in_range("turbulence", turbulence.speed, 0.0, 1e6).is_ok()
            && positive("turbulence", turbulence.length).is_ok()
            && in_range("shelter", shelter, 0.0, 1.0).is_ok();
        if is_good { Ok(()) } else { Err(StepError::BadEnvironment("wind")) }
    }
}

/// Gusts: waves of all directions that the wind carries along, the same in every run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turbulence {
    /// Root mean square of the gusts' speed in m/s; 0, the default, is a steady wind.
    pub speed: f32,
    /// Size of the greatest gusts in metres; 4 by default.
    pub length: f32,
    /// Seed of the waves.
    pub seed: u32,
}

impl Default for Turbulence {
    fn default() -> Self {
        Self { speed: 0.0, length: 4.0, seed: 0 }
    }
}

/// The number of waves in a gust, each shorter than the one before.
pub const WAVES: usize = 6;

/// The length of each wave in parts of that of the one before.
const SHORTER: f64 = 0.7;

/// One wave of a gust, in which the air at a place `p` moves with `amplitude cos(number . p + phase)`, at right angles to the wave's direction.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wave {
    /// Radians per metre.
    pub number: DVec3,
    /// Metres per second.
    pub amplitude: DVec3,
    /// Radians per second, in air that stands still.
    pub frequency: f64,
    /// Radians at the origin of the world and of time.
    pub phase: f64,
}

impl Wave {
    /// The phase in radians at the origin of the world, `time` seconds after the start, in a wind of `velocity` (m/s) that carries the wave
    /// along. A place `p` adds `number . p`.
    pub fn phase_at_origin(&self, velocity: Vec3, time: f64) -> f64 {
        self.frequency * time + self.phase - self.number.dot(velocity.as_dvec3() * time)
    }
}

impl Turbulence {
    /// The waves, the longest first.
    pub fn waves(&self) -> [Wave; WAVES] {
        let mut random = SplitMix64(u64::from(self.seed));
        let mut length = f64::from(self.length);
        let speed = f64::from(self.speed) * (2.0 / WAVES as f64).sqrt();
        core::array::from_fn(|_| {
            let along = direction(&mut random);
            let across = along.cross(direction(&mut random));
            let number = along * (TAU / length);
            let wave = Wave {
                number,
                amplitude: across.normalize_or(along.any_orthonormal_vector()) * speed,
                // Gusts last about as long as they take to pass a place at their own speed.
                frequency: TAU * f64::from(self.speed) / length,
                phase: TAU * random.unit(),
            };
            length *= SHORTER;
            wave
        })
    }
}

/// A unit vector, all directions alike.
fn direction(random: &mut SplitMix64) -> DVec3 {
    let (height, angle) = (2.0 * random.unit() - 1.0, TAU * random.unit());
    let across = (1.0 - height * height).max(0.0).sqrt();
    DVec3::new(across * libm::cos(angle), across * libm::sin(angle), height)
}

/// A place with a wind of its own, on top of that which blows everywhere: a fan, a draught, an explosion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindZone {
    /// Shape and size of the zone.
    pub region: WindRegion,
    /// Place of the zone in the world.
    pub placement: Placement,
    /// Direction and speed of the air.
    pub flow: WindFlow,
    /// The outer part of the region, from 0 to 1, in which the wind falls off to nothing.
    pub falloff: f32,
}

/// The shape of a [`WindZone`] in its own coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WindRegion {
    /// A ball of this radius in metres.
    Sphere(f32),
    /// A box of these half extents in metres.
    Cuboid(Vec3),
}

/// Flow of the air in a [`WindZone`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WindFlow {
    /// With this velocity in m/s, in the zone's own coordinates.
    Along(Vec3),
    /// Away from the middle, or towards it if negative, at so many m/s.
    Outwards(f32),
}

impl WindZone {
    /// Checks that everything is finite and in its range.
    ///
    /// # Errors
    /// [`StepError::BadEnvironment`].
    pub fn validate(&self) -> Result<(), StepError> {
        let Self { region, placement, flow, falloff } = *self;
        let is_region_good = match region {
            WindRegion::Sphere(radius) => positive("radius", radius).is_ok(),
            WindRegion::Cuboid(half_extents) => {
                finite_vector("half extents", half_extents).is_ok() && half_extents.min_element() > 0.0
            }
        };
        let speed = match flow {
            WindFlow::Along(velocity) => velocity,
            WindFlow::Outwards(speed) => Vec3::X * speed,
        };
        let is_flow_good =
            finite_vector("velocity", speed).is_ok() && in_range("falloff", falloff, 0.0, 1.0).is_ok();
        if is_region_good && placement.is_valid() && is_flow_good {
            Ok(())
        } else {
            Err(StepError::BadEnvironment("a wind zone"))
        }
    }

    /// The velocity of the air in m/s that it adds at a place in the world.
    pub fn velocity_at(&self, place: Vec3) -> Vec3 {
        let pose = Pose::at(&self.placement, Vec3::ZERO);
        let local = pose.to_local(place);
        // From 0 in the middle to 1 at the rim.
        let outwards = match self.region {
            WindRegion::Sphere(radius) => local.length() / radius,
            WindRegion::Cuboid(half_extents) => (local.abs() / half_extents).max_element(),
        };
        let strength =
            if outwards > 1.0 { 0.0 } else { ((1.0 - outwards) / self.falloff.max(1e-6)).min(1.0) };
        let velocity = match self.flow {
            WindFlow::Along(velocity) => velocity,
            WindFlow::Outwards(speed) => local.normalize_or_zero() * speed,
        };
        pose.direction_to_world(velocity * strength)
    }

    /// True if it may reach into a box.
    pub(crate) fn meets(&self, [low, high]: [Vec3; 2]) -> bool {
        let reach = match self.region {
            WindRegion::Sphere(radius) => radius,
            WindRegion::Cuboid(half_extents) => half_extents.length(),
        };
        let middle = self.placement.translation;
        (middle + reach).cmpge(low).all() && (middle - reach).cmple(high).all()
    }
}
