//! The air around a body: the velocity of wind, gusts, zones and lee, sixteen places at once.
//!
//! Gusts and lee are worked out at the corners of a lattice around the body. Between them the velocity is interpolated, as a sum of the
//! corners' velocities whose weights are products of one for each axis:
//!
//! ```text
//!   weight of a corner
//!     1 |   /\
//!       |  /  \        1 at its own place, 0 at its neighbours'
//!     0 |_/____\_
//! ```
//!
//! Design: `docs/design/wind.md`.

use fearless_simd::{Simd, f32x16, prelude::*};
use glam::{DVec3, Vec3};

use crate::motion::wind::{Wave, Wind, WindZone};
use crate::simd::columns::{Cell, LANES};
use crate::simd::lanes::Lanes3;
use crate::state::obstacles::Obstacles;

/// Greatest number of lattice points along an axis at which gusts and shelter are computed for a body.
const MOST_PLACES: usize = 4;

/// The air around one body in one step.
pub(crate) struct Air<'a> {
    pub wind: &'a Wind,
    zones: &'a [WindZone],
    low: Vec3,
    /// Distance between neighbours of the lattice, in metres.
    spacing: Vec3,
    counts: [usize; 3],
    /// The velocity of the air in m/s, where gusts or shelter make it differ; x runs fastest.
    lattice: [Vec3; MOST_PLACES * MOST_PLACES * MOST_PLACES],
    has_lattice: bool,
    has_zones: bool,
}

impl<'a> Air<'a> {
    /// The air around a body in the box between `bounds` (world, metres), `time` seconds after the start; none if it does
    /// not move.
    pub fn new(
        wind: &'a Wind,
        zones: &'a [WindZone],
        obstacles: &Obstacles,
        time: f64,
        bounds: [Vec3; 2],
    ) -> Option<Self> {
        let has_gusts = wind.turbulence.speed > 0.0;
        let has_zones = zones.iter().any(|zone| zone.meets(bounds));
        if wind.velocity == Vec3::ZERO && !has_gusts && !has_zones {
            return None;
        }
        let [low, high] = bounds;
        let wanted = (high - low) / (0.25 * wind.turbulence.length);
        let counts =
            wanted.to_array().map(|count| (count.ceil() as usize).saturating_add(1).clamp(2, MOST_PLACES));
        let cells = Vec3::from(counts.map(|count| count as f32 - 1.0));
        let mut air = Self {
            wind,
            zones,
            low,
            spacing: ((high - low) / cells).max(Vec3::splat(f32::MIN_POSITIVE)),
            counts,
            lattice: [wind.velocity; MOST_PLACES * MOST_PLACES * MOST_PLACES],
            has_lattice: has_gusts || wind.shelter > 0.0,
            has_zones,
        };
        if air.has_lattice {
            air.fill(obstacles, time);
        }
        Some(air)
    }

    fn fill(&mut self, obstacles: &Obstacles, time: f64) {
        let Wind { velocity, turbulence, shelter, .. } = *self.wind;
        let waves = turbulence.waves();
        let shelter_way = self.wind.shelter_way();
        let [across, deep, _] = self.counts;
        for i in 0..self.counts.iter().product() {
            let steps = [i % across, i / across % deep, i / (across * deep)].map(|step| step as f32);
            let place = self.low + self.spacing * Vec3::from(steps);
            // The wind carries the gusts along.
            let carried = place.as_dvec3() - velocity.as_dvec3() * time;
            let gust = |wave: &Wave| {
                wave.amplitude * libm::cos(wave.number.dot(carried) + wave.frequency * time + wave.phase)
            };
            let mut here = velocity + waves.iter().map(gust).sum::<DVec3>().as_vec3();
            if shelter_way.is_some_and(|way| is_in_lee(place, way, obstacles)) {
                here *= 1.0 - shelter;
            }
            self.lattice[i] = here;
        }
    }

    /// The velocity of the air at sixteen places in the world, in m/s.
    #[inline(always)]
    pub fn velocities<S: Simd>(&self, simd: S, places: Lanes3<S>) -> Lanes3<S> {
        let velocities = if self.has_lattice {
            self.interpolated(simd, places)
        } else {
            Lanes3::splat(simd, self.wind.velocity)
        };
        if self.has_zones { self.with_zones(simd, places, velocities) } else { velocities }
    }

    #[inline(always)]
    fn interpolated<S: Simd>(&self, simd: S, places: Lanes3<S>) -> Lanes3<S> {
        let steps = places.minus(Lanes3::splat(simd, self.low));
        let spacing = Lanes3::splat(simd, self.spacing);
        let [across, deep, high] = self.counts;
        let along_x = weights(simd, steps.x / spacing.x, across);
        let along_y = weights(simd, steps.y / spacing.y, deep);
        let along_z = weights(simd, steps.z / spacing.z, high);
        let nothing = Lanes3::splat(simd, Vec3::ZERO);
        let mut sum = nothing;
        let planes = self.lattice.chunks_exact(across * deep);
        for (plane, weight_z) in planes.zip(&along_z[..high]) {
            let mut of_plane = nothing;
            for (row, weight_y) in plane.chunks_exact(across).zip(&along_y[..deep]) {
                let mut of_row = nothing;
                for (&velocity, &weight_x) in row.iter().zip(&along_x[..across]) {
                    of_row = of_row.plus(Lanes3::splat(simd, velocity).times(weight_x));
                }
                of_plane = of_plane.plus(of_row.times(*weight_y));
            }
            sum = sum.plus(of_plane.times(*weight_z));
        }
        sum
    }

    #[inline(always)]
    fn with_zones<S: Simd>(&self, simd: S, places: Lanes3<S>, velocities: Lanes3<S>) -> Lanes3<S> {
        let (mut at, mut sums) = (Cell::default(), Cell::default());
        places.store(&mut at);
        velocities.store(&mut sums);
        for lane in 0..LANES {
            let of_zones = self.zones.iter().map(|zone| zone.velocity_at(at.get(lane)));
            sums.add(lane, of_zones.sum());
        }
        Lanes3::load(simd, &sums)
    }
}

/// The weights of `count` points a unit apart at a distance of `steps` from the first. Beyond the ends, the ends count.
#[inline(always)]
fn weights<S: Simd>(simd: S, steps: f32x16<S>, count: usize) -> [f32x16<S>; MOST_PLACES] {
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let steps = steps.max(zero).min(f32x16::splat(simd, count as f32 - 1.0));
    // A closure in `array::from_fn` would not be inlined, and each of its vectors would go through memory.
    let mut weights = [zero; MOST_PLACES];
    for (point, weight) in weights.iter_mut().enumerate() {
        *weight = (one - (steps - f32x16::splat(simd, point as f32)).abs()).max(zero);
    }
    weights
}

/// True if an obstacle stands on the way upwind from a place.
fn is_in_lee(place: Vec3, way: Vec3, obstacles: &Obstacles) -> bool {
    obstacles.is_any_near(place.min(place + way), place.max(place + way), |obstacle| {
        let pose = obstacle.pose_at(1.0, Vec3::ZERO);
        let local = [place, place + way].map(|point| pose.to_local(point));
        !obstacle.is_sensor() && obstacle.shape().cast(local[0], local[1] - local[0]).is_some()
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::motion::environment::Environment;
    use crate::motion::wind::Turbulence;
    use crate::simd::isa::{Isa, Kernel};

    struct At<'a>(&'a Air<'a>, Cell);

    impl Kernel for At<'_> {
        type Output = Cell;

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Cell {
            let mut velocities = Cell::default();
            self.0.velocities(simd, Lanes3::load(simd, &self.1)).store(&mut velocities);
            velocities
        }
    }

    /// The velocities of the air at sixteen places.
    pub(crate) fn velocities(air: &Air, places: Cell) -> Cell {
        Isa::detected().run(At(air, places))
    }

    /// The velocity at a place by the waves themselves.
    fn by_waves(wind: &Wind, place: Vec3, time: f64) -> Vec3 {
        let waves = wind.turbulence.waves();
        let gusts = waves.iter().map(|wave| {
            wave.amplitude
                * libm::cos(wave.number.dot(place.as_dvec3()) + wave.phase_at_origin(wind.velocity, time))
        });
        wind.velocity + gusts.sum::<DVec3>().as_vec3()
    }

    /// Between corners the velocity is linear along each axis. Beyond them it is that of the border.
    #[test]
    fn gusts_are_those_of_the_corners_and_interpolated_between_them() {
        let turbulence = Turbulence { speed: 3.0, length: 4.0, seed: 8 };
        let wind = Wind { turbulence, ..Wind::new(Vec3::new(1.0, -2.0, 5.0)) };
        let (low, size, time) = (Vec3::new(-3.0, 10.0, 0.5), Vec3::new(2.7, 1.8, 0.6), 2.5);
        let environment = Environment::default();
        let air = Air::new(&wind, &[], &environment.obstacles, time, [low, low + size]).expect("it moves");
        assert_eq!(air.counts, [4, 3, 2]);
        // In parts of the lattice's cells.
        let places = [
            [0.0, 0.0, 0.0],
            [3.0, 0.0, 0.0],
            [0.0, 2.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 1.0, 1.0],
            [2.0, 2.0, 0.0],
            [0.25, 0.0, 0.0],
            [1.5, 1.0, 0.0],
            [1.0, 0.75, 1.0],
            [2.0, 1.0, 0.4],
            [0.3, 1.6, 0.7],
            [2.9, 0.1, 0.2],
            [-1.0, 1.0, 0.0],
            [4.0, 1.0, 1.0],
            [1.0, 5.0, 0.5],
            [0.5, 0.5, -2.0],
        ];
        let mut cell = Cell::default();
        let at = |steps: [f32; 3]| low + Vec3::from(steps) * size / Vec3::new(3.0, 2.0, 1.0);
        places.into_iter().enumerate().for_each(|(lane, steps)| cell.set(lane, at(steps)));
        let velocities = velocities(&air, cell);
        for (lane, steps) in places.into_iter().enumerate() {
            let within =
                [(steps[0], 3.0), (steps[1], 2.0), (steps[2], 1.0)].map(|(step, most)| step.clamp(0.0, most));
            let first = [(within[0], 2.0), (within[1], 1.0), (within[2], 0.0)]
                .map(|(step, most)| step.floor().min(most));
            let mut expected = Vec3::ZERO;
            for corner in 0..8 {
                let next = [corner & 1, corner >> 1 & 1, corner >> 2].map(|side| side as f32);
                let part = |axis: usize| {
                    let part = within[axis] - first[axis];
                    if next[axis] == 1.0 { part } else { 1.0 - part }
                };
                let weight = part(0) * part(1) * part(2);
                let place = at([0, 1, 2].map(|axis| first[axis] + next[axis]));
                expected += by_waves(&wind, place, time) * weight;
            }
            let error = velocities.get(lane).distance(expected);
            assert!(error < 1e-3, "{steps:?}: {} instead of {expected}", velocities.get(lane));
        }
    }
}
