//! Pieces that hold pins whose ways differ: each of their particles follows the pins near it.
//!
//! A piece that moves as one keeps its parts apart, but tears away from pins that go other ways. So each particle moves as a
//! rigid body would that follows the pins, the near ones most (moving least squares, Schaefer et al. 2006): pins that turn
//! together carry the piece along without a gap, and between pins that go apart the way changes evenly.
//!
//! ```text
//!     o-->       pins        o  |          the mean way of both is none, and the pins tear away from the piece
//!     |                      v  |          the piece turns with them
//! ```
//!
//! Design: `docs/design/self_contact.md`.

use glam::{DMat3, DVec3, Vec3};

use crate::contact::surface::points::Points;
use crate::union_find::Groups;

/// Squared distance in square metres below which a pin is no nearer.
const NEAREST: f64 = 1e-12;

/// Resistance against turning, in parts of that of the pins: pins in a line say nothing of a turn about it.
const RESISTANCE: f64 = 1e-6;

/// Pins by pieces, and the ways of the particles that follow those of a piece.
#[derive(Clone, Debug, Default)]
pub(crate) struct Followers {
    /// The piece and the number of each pin.
    pins: Vec<[u32; 2]>,
    ways: Vec<Follower>,
}

/// A particle, with its way in a substep and the part of it that becomes velocity.
#[derive(Clone, Copy, Debug)]
struct Follower {
    id: usize,
    way: Parts,
    motion: Parts,
}

/// A way: that of the pins, and what comes from their turning.
#[derive(Clone, Copy, Debug)]
struct Parts {
    moved: Vec3,
    turned: Vec3,
}

impl Parts {
    /// The way with this part of the turning.
    fn sum(self, turned: f32) -> Vec3 {
        self.moved + self.turned * turned
    }
}

impl Followers {
    /// Moves the particles of pieces whose pins go different ways; those of other `pieces` stay where they are.
    pub fn carry(&mut self, pieces: &mut Groups, points: &mut Points) {
        let Self { pins, ways } = self;
        pins.clear();
        for (id, _) in (0..).zip(&points.inverse_mass).filter(|(_, inverse_mass)| **inverse_mass == 0.0) {
            pins.push([pieces.root(id), id]);
        }
        pins.sort_unstable();
        for pins in pins.chunk_by(|a, b| a[0] == b[0]) {
            let [piece, first] = pins[0];
            let first = points.way(first as usize);
            if pins.iter().all(|&[_, pin]| points.way(pin as usize) == first) {
                continue;
            }
            ways.clear();
            let (mut fastest, mut longest) = (0.0_f32, 0.0_f32);
            for id in (0..points.start.len()).filter(|&id| pieces.root(id as u32) == piece) {
                fastest = fastest.max(points.way(id).length());
                if points.inverse_mass[id] > 0.0 {
                    let follower = follow(id, pins, points);
                    longest = longest.max(follower.way.sum(1.0).length());
                    ways.push(follower);
                }
            }
            // What is far from pins that turn gets at most twice as fast as the fastest of the piece.
            let turned = if longest > fastest { fastest / longest } else { 1.0 };
            for &Follower { id, way, motion } in &*ways {
                points.end[id] = points.start[id] + way.sum(turned).extend(0.0);
                points.motion[id] = motion.sum(turned);
            }
        }
    }
}

/// The way of a particle that follows these pins.
fn follow(id: usize, pins: &[[u32; 2]], points: &Points) -> Follower {
    let at = points.start[id].truncate();
    let of = |pin: usize| {
        let arm = (points.start[pin].truncate() - at).as_dvec3();
        let square = arm.length_squared() + NEAREST;
        (1.0 / (square * square), arm, points.way(pin).as_dvec3(), points.motion[pin].as_dvec3())
    };
    let pins = || pins.iter().map(|&[_, pin]| of(pin as usize));
    let (mut weights, mut middle, mut way, mut motion) = (0.0, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
    for (weight, arm, of_way, of_motion) in pins() {
        weights += weight;
        middle += arm * weight;
        way += of_way * weight;
        motion += of_motion * weight;
    }
    let [middle, way, motion] = [middle, way, motion].map(|sum| sum / weights);
    let (mut inertia, mut turns) = (DMat3::ZERO, [DVec3::ZERO; 2]);
    for (weight, arm, of_way, of_motion) in pins() {
        let arm = arm - middle;
        let outer = DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
        inertia += (DMat3::from_diagonal(DVec3::splat(arm.length_squared())) - outer) * weight;
        turns[0] += arm.cross(of_way - way) * weight;
        turns[1] += arm.cross(of_motion - motion) * weight;
    }
    let size = inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z;
    let inverse = if size > 0.0 {
        (inertia + DMat3::from_diagonal(DVec3::splat(RESISTANCE * size))).inverse()
    } else {
        DMat3::ZERO
    };
    let parts = |moved: DVec3, turn: DVec3| {
        let turned = (inverse * turn).cross(-middle);
        Parts { moved: moved.as_vec3(), turned: turned.as_vec3() }
    };
    Follower { id, way: parts(way, turns[0]), motion: parts(motion, turns[1]) }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

    /// A piece of these places, of which the first few are pins that go by these ways.
    fn carried(starts: &[Vec3], pin_ways: &[Vec3], fastest: f32) -> Points {
        let mut points = Points::default();
        points.start = starts.iter().map(|start| start.extend(0.0)).collect();
        points.end = points.start.clone();
        points.end.last_mut().expect("has points").y += fastest;
        points.motion = vec![Vec3::ZERO; starts.len()];
        points.inverse_mass = vec![1.0; starts.len()];
        for (id, &way) in pin_ways.iter().enumerate() {
            points.inverse_mass[id] = 0.0;
            points.end[id] += way.extend(0.0);
            points.motion[id] = way;
        }
        let mut pieces = Groups::new(starts.len());
        (1..starts.len() as u32).for_each(|id| {
            pieces.join(0, id);
        });
        Followers::default().carry(&mut pieces, &mut points);
        points
    }

    fn places() -> Vec<Vec3> {
        let place = |i: u32| Vec3::new((i % 3) as f32 * 0.1, 0.03 * (i / 9) as f32, (i / 3 % 3) as f32 * 0.1);
        (0..27).map(place).collect()
    }

    #[test]
    fn a_piece_goes_all_the_way_with_pins_in_a_line_that_turn() {
        let starts = places();
        let turn = Quat::from_rotation_y(1e-3);
        let way = |start: Vec3| turn * start - start + Vec3::Y * 2e-3;
        let pins: Vec<Vec3> = starts[..3].iter().map(|&start| way(start)).collect();
        let points = carried(&starts, &pins, 1.0);
        for (id, &start) in starts.iter().enumerate() {
            assert!(points.way(id).distance(way(start)) < 1e-6, "{start}");
            assert!(points.motion[id].distance(way(start)) < 1e-6, "{start}");
        }
    }

    #[test]
    fn a_particle_beside_a_pin_goes_its_way_wherever_others_go() {
        let mut starts = places();
        starts[20] = starts[0] + Vec3::Y * 1e-4;
        let ways = [Vec3::X * 1e-3, Vec3::Y * -1e-3, Vec3::Z * 2e-3];
        let points = carried(&starts, &ways, 1.0);
        assert!(points.way(20).distance(ways[0]) < 1e-5, "{}", points.way(20));
    }

    #[test]
    fn what_is_far_from_pins_that_turn_gets_at_most_twice_as_fast() {
        let mut starts = places();
        starts[26] *= 100.0;
        let ways = [Vec3::ZERO, Vec3::Y * 1e-3];
        let points = carried(&starts, &ways, 0.0);
        let longest = (0..27).map(|id| points.way(id).length()).fold(0.0, f32::max);
        assert!(longest < 2.001e-3, "{longest}");
    }
}
