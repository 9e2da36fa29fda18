//! What sticks and pressure take and give of a body's angular momentum, which they cannot.
//!
//! A projection pushes two particles apart along the line between them, and so turns nothing about where they are *then*. The
//! velocities of a substep are from where they were at its start: with several projections, one after the other, the
//! pushes of a skin against its pressure add up to a small turn, each time the same way. A balloon that is blown up
//! beyond what its skin holds would spin up in free flight, and drive itself over the ground.
//!
//! With `p` where a particle was and `d` what the projections moved it by, what they have given is the sum of `m p x d`. A
//! small turn of the body about its centre of mass takes it back.

use glam::{DMat3, DVec3};

use crate::state::body::Body;

/// Takes back the angular momentum that the projections of this substep have given to a free body under pressure.
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
        // What a turn `t`, which moves the particle by `t x arm`, gives: `from x (t x arm) = t (from . arm) - arm (from . t)`.
        let outer = DMat3::from_cols(arm * from.x, arm * from.y, arm * from.z);
        inertia += (DMat3::from_diagonal(DVec3::splat(from.dot(arm))) - outer) * mass(slot);
    }
    let turn = -(inertia.inverse() * given);
    // All in one line, it has no inertia about it; and a great turn is no small error.
    if turn.is_finite() && turn.length() < MOST_TURN {
        for slot in particles.layout.slots() {
            let arm = particles.position.get(slot).as_dvec3() - centre;
            particles.position.add(slot, turn.cross(arm).as_vec3());
        }
    }
}

/// The greatest turn in a substep that is taken back, in radians.
const MOST_TURN: f64 = 0.1;
