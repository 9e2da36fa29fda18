//! The volume inside a closed surface, and the pressure that keeps it.
//!
//! The volume of a closed surface is a sixth of the sum of `p . (q x r)` over its faces; what a corner adds when it moves is a
//! sixth of the sum of the cross products of the other two. All particles are moved along that gradient at once, each by
//! its inverse mass, by as much as takes the volume to what it should be (Müller et al. 2007, "Position based dynamics",
//! section 4.4). The gradient sums to zero, so that momentum and angular momentum stay.

use glam::DVec3;

use crate::state::body::Body;

/// Brings the volume to the part of that at rest which the body's pressure asks for.
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
        for (corner, way) in [(p, of_a), (q, of_b), (r, of_c)] {
            gradient[corner as usize] += way;
        }
    }
    let inverse_mass = |corner: usize| f64::from(particles.inverse_mass[layout.slot(corner)]);
    let steep: f64 =
        gradient.iter().enumerate().map(|(corner, way)| inverse_mass(corner) * way.length_squared()).sum();
    let missing = rest * f64::from(*pressure) - volume;
    // Squeezed flat, it has no direction to open in.
    if !(steep > 0.0 && (missing / steep).is_finite()) {
        return;
    }
    let longest = gradient.iter().enumerate().map(|(corner, way)| inverse_mass(corner) * way.length());
    let longest = longest.fold(0.0, f64::max) * (missing / steep).abs();
    let most = f64::from(topology.longest_edge) * MOST_OF_EDGE;
    let scale = missing / steep * (most / longest.max(most));
    for (corner, &way) in gradient.iter().enumerate() {
        let slot = layout.slot(corner);
        let shift = way * (f64::from(particles.inverse_mass[slot]) * scale);
        particles.position.add(slot, shift.as_vec3());
    }
}

/// The farthest that pressure moves a particle in one projection, in parts of the longest edge.
const MOST_OF_EDGE: f64 = 0.25;
