//! Backstops as data: a sphere behind the animated place of each particle, which the particle may not enter.
//!
//! `constraint/backstop.rs` enforces them.
//!
//! Design: `docs/design/characters.md`.

use glam::Vec3;

use crate::constants::MAX_MAGNITUDE;
use crate::error::{BuildError, finite, in_range};
use crate::simd::columns::LANES;
use crate::state::animated_columns::AnimatedColumns;

/// A sphere behind the animated place of a particle, which keeps the particle from sinking into what it covers.
///
/// ```text
///   outside     x      the animated place
///               |      distance, along the normal
///            .-----.
///   body    (   c   )  the sphere, of this radius around c
/// ```
///
/// Unreal's and Unity's cloth have the same two numbers; in `NvCloth` they are separation constraints.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Backstop {
    /// How far behind its animated place the particle may go along the normal, in metres, to 1e6. Below 0 the particle is kept
    /// in front of that place.
    pub distance: f32,
    /// Radius of the sphere in metres, 0 to 1e6; 0 is no backstop. A large sphere is almost a plane; a particle that
    /// passes the middle of a small one comes out on its other side. Above some 30 m rounding is felt: 0.01 mm.
    pub radius: f32,
}

impl Backstop {
    /// Checks both numbers.
    ///
    /// # Errors
    /// [`BuildError`] if the distance is not finite or beyond 1e6, or the radius is not from 0 to 1e6.
    pub fn validate(&self) -> Result<(), BuildError> {
        finite("distance of a backstop", self.distance)?;
        in_range("radius of a backstop", self.radius, 0.0, MAX_MAGNITUDE)?;
        Ok(())
    }
}

/// The backstops of a body's particles, by slot; empty where there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Backstops {
    /// Animated places, relative to the body's origin.
    pub place: AnimatedColumns,
    /// Directions of length one away from the spheres.
    pub normal: AnimatedColumns,
    /// Distance of each sphere behind the animated place, in metres.
    pub distance: Vec<f32>,
    /// Radius in metres; 0 without a backstop.
    pub radius: Vec<f32>,
}

impl Backstops {
    pub fn is_empty(&self) -> bool {
        self.radius.is_empty()
    }

    /// Makes room for the particles of `cells` cells, all without a backstop.
    pub fn reset(&mut self, cells: usize) {
        self.place.reset(cells);
        self.normal.reset(cells);
        for numbers in [&mut self.distance, &mut self.radius] {
            numbers.clear();
            numbers.resize(cells * LANES, 0.0);
        }
    }

    pub fn set(&mut self, slot: usize, place: [Vec3; 2], normal: [Vec3; 2], backstop: Backstop) {
        self.place.set(slot, place);
        self.normal.set(slot, normal);
        (self.distance[slot], self.radius[slot]) = (backstop.distance, backstop.radius);
    }

    pub fn get(&self, slot: usize) -> Option<Backstop> {
        let radius = self.radius.get(slot).copied().filter(|radius| *radius > 0.0)?;
        Some(Backstop { distance: self.distance[slot], radius })
    }

    /// Copies the backstop of a slot of another body, if there is one.
    pub fn copy(&mut self, to: usize, others: &Self, from: usize) {
        if let Some(backstop) = others.get(from) {
            self.set(to, others.place.get(from), others.normal.get(from), backstop);
        }
    }

    /// Centre of a sphere relative to the body's origin, now and at the end of the next step.
    pub fn centres(&self, slot: usize) -> [Vec3; 2] {
        let ([place, next_place], [normal, next_normal]) = (self.place.get(slot), self.normal.get(slot));
        let depth = self.distance[slot] + self.radius[slot];
        [place - normal * depth, next_place - next_normal * depth]
    }
}
