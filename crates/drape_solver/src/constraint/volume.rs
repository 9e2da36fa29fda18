//! The volume inside a closed surface, and the pressure that keeps it.
//!
//! The volume of a closed surface is a sixth of the sum of `p . (q x r)` over its faces; its gradient at a corner is a
//! sixth of the sum of the cross products of the other two corners. One Newton step along that gradient moves all
//! particles at once, each by its inverse mass, towards the target volume (Müller et al. 2007, "Position based dynamics",
//! section 4.4). The gradient sums to zero, so that momentum and angular momentum stay.
//!
//! Design: `docs/design/soft_bodies.md`.

use glam::DVec3;

use crate::state::body::Body;

/// Corrects the volume to the body's pressure times its rest volume.
pub(crate) fn project(body: &mut Body) {
    let Body { particles, topology, context, pressure, .. } = body;
    let Some(rest) = topology.rest_volume().filter(|_| *pressure > 0.0) else { return };
    let layout = &particles.layout;
    let place = |corner: u32| particles.position.get(layout.slot(corner as usize)).as_dvec3();
    let gradient = &mut context.gradient;
    gradient.clear();
    gradient.resize(topology.particle_count(), DVec3::ZERO);
    let about = topology.faces.first().map_or(DVec3::ZERO, |face| place(face[0]));
    let mut volume = 0.0;
    for &[p, q, r] in &topology.faces {
        let [a, b, c] = [p, q, r].map(|corner| place(corner) - about);
        let (of_a, of_b, of_c) = (b.cross(c) / 6.0, c.cross(a) / 6.0, a.cross(b) / 6.0);
        volume += a.dot(of_a);
        for (corner, slope) in [(p, of_a), (q, of_b), (r, of_c)] {
            gradient[corner as usize] += slope;
        }
    }
    let inverse_mass = |corner: usize| f64::from(particles.inverse_mass[layout.slot(corner)]);
    let weighted_square: f64 = gradient
        .iter()
        .enumerate()
        .map(|(corner, slope)| inverse_mass(corner) * slope.length_squared())
        .sum();
    let missing = rest * f64::from(*pressure) - volume;
    // A body that is squeezed flat has no gradient to expand along.
    if !(weighted_square > 0.0 && (missing / weighted_square).is_finite()) {
        return;
    }
    let longest = gradient.iter().enumerate().map(|(corner, slope)| inverse_mass(corner) * slope.length());
    let longest = longest.fold(0.0, f64::max) * (missing / weighted_square).abs();
    let most = f64::from(topology.longest_edge) * MOST_OF_EDGE;
    let scale = missing / weighted_square * (most / longest.max(most));
    for (corner, &slope) in gradient.iter().enumerate() {
        let slot = layout.slot(corner);
        let shift = slope * (f64::from(particles.inverse_mass[slot]) * scale);
        particles.position.add(slot, shift.as_vec3());
    }
}

/// The farthest that pressure moves a particle in one projection, in parts of the longest edge.
const MOST_OF_EDGE: f64 = 0.25;
