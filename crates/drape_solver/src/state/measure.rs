//! Figures about a body: energy, momentum, stretch.

use glam::{DVec3, Vec3};

use crate::state::body::Body;
use crate::state::crossings::CrossingCounter;
use crate::state::particles::Particles;
use crate::state::topology::{StickKind, Topology};

/// Strain of sticks of one kind, as fractions: `|length / rest length - 1|`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stretch {
    /// Root of the mean square.
    pub rms: f64,
    /// The greatest.
    pub max: f64,
}

/// Strain of all structural sticks; sticks with a bound count only beyond it.
pub fn stretch(particles: &Particles, topology: &Topology) -> Stretch {
    let mut sum = 0.0;
    let mut count = 0_u32;
    let mut max = 0.0_f64;
    for batch in topology.batches().iter().filter(|b| b.material.kind == StickKind::Structural) {
        for i in batch.range() {
            let [a, b] = topology.stick(i).map(|end| particles.local_position(end as usize));
            let strain = f64::from(a.distance(b)) / f64::from(topology.rest_length(i)) - 1.0;
            let strain = batch.material.bound.violation(strain);
            sum += strain * strain;
            max = max.max(strain.abs());
            count += 1;
        }
    }
    Stretch { rms: (sum / f64::from(count.max(1))).sqrt(), max }
}

/// Positions of all particles in double precision, in metres.
pub fn positions(particles: &Particles) -> impl Iterator<Item = DVec3> {
    let origin = particles.origin().as_dvec3();
    particles.local_positions().map(move |place| origin + place.as_dvec3())
}

/// The number of edges and links that pass through faces, of these bodies' own and of each other's. What only touches does
/// not count, and a rope through a rope is not seen. To count many times, keep a [`CrossingCounter`].
pub fn crossings<'a>(bodies: impl Iterator<Item = (&'a Particles, &'a Topology)> + Clone) -> usize {
    let corners: Vec<DVec3> = bodies.clone().flat_map(|(particles, _)| positions(particles)).collect();
    CrossingCounter::of(bodies.map(|(_, topology)| topology)).count(&corners)
}

/// Kinetic energy of the free particles in joules.
pub fn kinetic_energy(particles: &Particles) -> f64 {
    free(particles).map(|(i, mass)| 0.5 * mass * particles.velocity(i).as_dvec3().length_squared()).sum()
}

/// Potential energy of the free particles in joules, in the field `gravity` (m/s^2), zero at the world's origin.
pub fn potential_energy(particles: &Particles, gravity: Vec3) -> f64 {
    let down = gravity.as_dvec3();
    free(particles).map(|(i, mass)| -mass * world(particles, i).dot(down)).sum()
}

/// Mass of the free particles in kilograms.
pub fn mass(particles: &Particles) -> f64 {
    free(particles).map(|(_, mass)| mass).sum()
}

/// Linear momentum of the free particles in kg m/s.
pub fn momentum(particles: &Particles) -> DVec3 {
    free(particles).map(|(i, mass)| particles.velocity(i).as_dvec3() * mass).sum()
}

/// Angular momentum of the free particles about the world's origin in kg m^2/s.
pub fn angular_momentum(particles: &Particles) -> DVec3 {
    free(particles).map(|(i, mass)| world(particles, i).cross(particles.velocity(i).as_dvec3()) * mass).sum()
}

/// Mean of the squared speeds of the free particles in (m/s)^2; 0 where all are pinned.
pub fn mean_square_speed(particles: &Particles) -> f32 {
    particles.mean_square_speed()
}

/// Total mechanical energy of a body in joules: kinetic and potential.
pub fn mechanical_energy(body: &Body, gravity: Vec3) -> f64 {
    kinetic_energy(&body.particles) + potential_energy(&body.particles, gravity)
}

fn free(particles: &Particles) -> impl Iterator<Item = (usize, f64)> + '_ {
    let masses = (0..particles.len()).map(|i| (i, particles.inverse_mass(i)));
    masses.filter(|&(_, w)| w > 0.0).map(|(i, w)| (i, 1.0 / f64::from(w)))
}

fn world(particles: &Particles, i: usize) -> DVec3 {
    particles.origin().as_dvec3() + particles.local_position(i).as_dvec3()
}
