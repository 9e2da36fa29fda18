//! Tethers: no particle farther from a pin than the cloth between them is long.
//!
//! Kim, Chentanez and Müller-Fischer 2012, "Long Range Attachments". A tether is a one-sided stick from a
//! particle to a pin at the geodesic distance in the rest pose. Relaxation carries a pull only a few particles
//! down per sweep; a tether carries it the whole way at once, which takes the sag out of large cloths.
//!
//! ```text
//!   pin o-----------------.  the tether is slack inside the circle ...
//!        \    L          x   ... and a particle outside comes back to it
//!         '-------------'
//! ```

use std::collections::BinaryHeap;

use core::cmp::{Ordering, Reverse};
use glam::Vec3;

use crate::constants::MAX_TETHERS;
use crate::particles::Particles;

/// The tethers of a body: up to [`MAX_TETHERS`] for each particle, nearest pin first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tethers {
    /// Particle that each tether holds; ascending.
    particle: Vec<u32>,
    pin: Vec<u32>,
    length: Vec<f32>,
}

impl Tethers {
    /// No tethers.
    pub fn none() -> Self {
        Self::default()
    }

    /// Tethers for a body that is flat and convex at rest, where the geodesic is the straight line.
    pub fn straight(rest: &[Vec3], pins: &[u32]) -> Self {
        let mut tethers = Self::default();
        if pins.is_empty() {
            return tethers;
        }
        let mut nearest: Vec<(f32, u32)> = Vec::with_capacity(pins.len());
        for (i, &position) in rest.iter().enumerate() {
            if pins.contains(&(i as u32)) {
                continue;
            }
            let distance = |&pin: &u32| (position.distance(rest[pin as usize]), pin);
            nearest.clear();
            nearest.extend(pins.iter().map(distance));
            if nearest.len() > MAX_TETHERS {
                nearest.select_nth_unstable_by(MAX_TETHERS - 1, by_distance);
                nearest.truncate(MAX_TETHERS);
            }
            nearest.sort_unstable_by(by_distance);
            for &(length, pin) in &nearest {
                tethers.push(i as u32, pin, length);
            }
        }
        tethers
    }

    /// Tethers along the sticks of a body of any form: `edges` are (end, end, rest length in metres). Runs
    /// Dijkstra's algorithm from all pins at once; each particle keeps the first pins that reach it.
    pub fn geodesic(
        particle_count: usize,
        edges: impl IntoIterator<Item = (u32, u32, f32)>,
        pins: &[u32],
    ) -> Self {
        let mut neighbours: Vec<Vec<(u32, f32)>> = vec![Vec::new(); particle_count];
        for (a, b, length) in edges {
            neighbours[a as usize].push((b, length));
            neighbours[b as usize].push((a, length));
        }
        let mut reached: Vec<Vec<(f32, u32)>> = vec![Vec::new(); particle_count];
        let mut queue: BinaryHeap<Reverse<Visit>> = BinaryHeap::new();
        for &pin in pins {
            queue.push(Reverse(Visit { distance: 0.0, particle: pin, pin }));
        }
        while let Some(Reverse(visit)) = queue.pop() {
            let known = &mut reached[visit.particle as usize];
            if known.len() == MAX_TETHERS || known.iter().any(|&(_, pin)| pin == visit.pin) {
                continue;
            }
            known.push((visit.distance, visit.pin));
            for &(particle, length) in &neighbours[visit.particle as usize] {
                let distance = visit.distance + length;
                queue.push(Reverse(Visit { distance, particle, ..visit }));
            }
        }
        let mut tethers = Self::default();
        for (i, known) in reached.iter().enumerate() {
            if !pins.contains(&(i as u32)) {
                for &(length, pin) in known {
                    tethers.push(i as u32, pin, length);
                }
            }
        }
        tethers
    }

    /// The number of tethers.
    pub fn len(&self) -> usize {
        self.length.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.length.is_empty()
    }

    /// Each tether as (particle, pin, length in metres).
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (u32, u32, f32)> + '_ {
        (0..self.len()).map(|i| (self.particle[i], self.pin[i], self.length[i]))
    }

    pub(crate) fn highest_index(&self) -> Option<u32> {
        self.particle.iter().chain(&self.pin).copied().max()
    }

    fn push(&mut self, particle: u32, pin: u32, length: f32) {
        self.particle.push(particle);
        self.pin.push(pin);
        self.length.push(length);
    }

    /// Brings every particle back to within its tethers' lengths, but by no more than `most` (metres) at once. A tether
    /// whose pin has been freed is slack.
    pub(crate) fn project(&self, particles: &mut Particles, most: f32) {
        for (particle, pin, length) in self.iter() {
            let (i, pin) = (particle as usize, pin as usize);
            if particles.inverse_mass[pin] != 0.0 || particles.inverse_mass[i] == 0.0 {
                continue;
            }
            let anchor = particles.position.get(pin);
            let delta = particles.position.get(i) - anchor;
            let distance_squared = delta.length_squared();
            if distance_squared > length * length {
                let distance = distance_squared.sqrt();
                let scale = length.max(distance - most) / distance;
                particles.position.set(i, anchor + delta * scale);
            }
        }
    }
}

fn by_distance(a: &(f32, u32), b: &(f32, u32)) -> Ordering {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
}

/// A particle reached from a pin, ordered by distance, then by index so that ties are the same everywhere.
#[derive(Clone, Copy, PartialEq)]
struct Visit {
    distance: f32,
    particle: u32,
    pin: u32,
}

impl Eq for Visit {}

impl Ord for Visit {
    fn cmp(&self, other: &Self) -> Ordering {
        self.distance
            .total_cmp(&other.distance)
            .then(self.particle.cmp(&other.particle))
            .then(self.pin.cmp(&other.pin))
    }
}

impl PartialOrd for Visit {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn geodesic_tethers_run_along_the_chain_and_not_through_the_air() {
        // A chain folded into a hairpin: particle 4 lies beside the pin, but four links away.
        let edges = (0..4).map(|i| (i, i + 1, 1.0));
        let tethers = Tethers::geodesic(5, edges, &[0]);
        let lengths: Vec<f32> = tethers.iter().map(|(_, _, length)| length).collect();
        assert_eq!(lengths, [1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn each_particle_keeps_its_nearest_pins() {
        let rest: Vec<Vec3> = (0..20).map(|i| Vec3::X * i as f32).collect();
        let pins = [0, 1, 2, 3, 4, 5];
        let straight = Tethers::straight(&rest, &pins);
        let edges = (0..19).map(|i| (i, i + 1, 1.0));
        assert_eq!(straight, Tethers::geodesic(20, edges, &pins));
        let of_last: Vec<u32> = straight.iter().filter(|t| t.0 == 19).map(|(_, pin, _)| pin).collect();
        assert_eq!(of_last, [5, 4, 3, 2]);
    }

    #[test]
    fn a_taut_tether_brings_the_particle_back_and_a_freed_pin_lets_go() {
        let positions = [Vec3::ZERO, Vec3::new(3.0, 4.0, 0.0)];
        let mut particles = Particles::new(Vec3::ZERO, &positions, &[0.0, 1.0]).expect("valid");
        let tethers = Tethers::geodesic(2, [(0, 1, 2.5)], &[0]);
        tethers.project(&mut particles, f32::INFINITY);
        assert!((particles.position(1) - Vec3::new(1.5, 2.0, 0.0)).length() < 1e-6);
        particles.set_inverse_mass(0, 1.0);
        particles.set_position(1, positions[1]);
        tethers.project(&mut particles, f32::INFINITY);
        assert_eq!(particles.position(1), positions[1]);
    }
}
