//! The angular momentum that sticks and pressure must not change: removes the error of their projections.
//!
//! A projection pushes two particles along the line between them, which gives them no angular momentum at their
//! positions *then*. The velocities of a substep refer to the positions at its start, however: with several
//! projections, one after the other, the pushes of a skin against its pressure add up to a small turn, each time in the
//! same direction. A balloon that is inflated beyond what its skin holds would spin up in free flight, and roll over
//! the ground by itself.
//!
//! With `p` the start position of a particle and `d` its displacement by the projections, they have added the sum of `m
//! p x d`. A small turn of the body about its centre of mass removes it.
//!
//! Design: `docs/design/soft_bodies.md`.

use glam::{DMat3, DVec3};

use crate::state::body::Body;

/// Removes the angular momentum that the projections of this substep have given to a free body under pressure.
pub(crate) fn restore(body: &mut Body) {
    let Body { particles, context, pressure, .. } = body;
    if *pressure <= 0.0 || particles.masses.has_pins {
        return;
    }
    let mass = |slot: usize| f64::from(1.0 / particles.inverse_mass[slot]);
    let place = |slot: usize| particles.position.get(slot).as_dvec3();
    let start = |slot: usize| (context.integrated.get(slot) - particles.displacement.get(slot)).as_dvec3();
    let slots = || particles.layout.slots();
    let mean = |place: &dyn Fn(usize) -> DVec3| {
        slots().map(|slot| place(slot) * mass(slot)).sum::<DVec3>() / particles.masses.free_mass
    };
    let (centre, start_centre) = (mean(&place), mean(&start));
    let (mut given, mut inertia) = (DVec3::ZERO, DMat3::ZERO);
    for slot in slots() {
        let arm = place(slot) - centre;
        let from = start(slot) - start_centre;
        let moved = place(slot) - context.integrated.get(slot).as_dvec3();
        given += from.cross(moved) * mass(slot);
        // A turn `t` moves the particle by `t x arm`, which adds `from x (t x arm) = t (from . arm) - arm (from . t)`.
        let outer = DMat3::from_cols(arm * from.x, arm * from.y, arm * from.z);
        inertia += (DMat3::from_diagonal(DVec3::splat(from.dot(arm))) - outer) * mass(slot);
    }
    let turn = -(inertia.inverse() * given);
    // Particles on one line have no inertia about it; and a great turn is no small error.
    if turn.is_finite() && turn.length() < MOST_TURN {
        for slot in particles.layout.slots() {
            let arm = particles.position.get(slot).as_dvec3() - centre;
            particles.position.add(slot, turn.cross(arm).as_vec3());
        }
    }
}

/// The greatest turn in a substep that is removed, in radians.
const MOST_TURN: f64 = 0.1;
