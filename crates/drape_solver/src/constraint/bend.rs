//! Listed bends: those of meshes and torn grids, solved together by conjugate gradients.
//!
//! An implicit step of the energies `K^2 / (2 compliance)` from the places `x` is the solution of
//!
//! ```text
//!   (M + A) step = - A x          A = sum of k k^T h^2 / compliance over all bends, of weights k
//! ```
//!
//! A bend relaxed by itself passes on only a small part of the load in a substep, if the cloth is fine or stiff, and the cloth would be
//! as limp as if it had a fraction of its rigidity. Conjugate gradients see the whole cloth at once: the load is smooth, and few
//! iterations give the step that it asks for (Hestenes and Stiefel 1952; with the masses as preconditioner, so that each of their
//! directions keeps momentum, and angular momentum too where bends are flat at rest).
//!
//! Bends of a whole grid are solved line by line (`direct/bent_chain.rs`).
//!
//! Design: `docs/design/bending.md`.

use glam::{Vec3, Vec4};

use crate::constants::ALONG_ONE_LINE;
use crate::constraint::bending_friction::{self, places};
use crate::simd::columns::{Cell, LANES};
use crate::state::bends::{BendScratch, ListedBend};
use crate::state::body::Body;

/// The greatest number of iterations of a solve.
const MOST_ITERATIONS: usize = 16;

/// A solve ends when the squared residual is this part of that at the start.
const TOLERANCE: f64 = 1e-6;

/// One implicit step of all listed bends of a body, in iteration `projection` of the substep.
pub(crate) fn project(body: &mut Body, projection: u32) {
    let Body { particles, topology, settings, context, .. } = body;
    let bends = &*topology.bends.listed;
    if bends.is_empty() || projection + 1 != settings.iterations {
        return;
    }
    let (inverse_mass, _) = particles.inverse_mass.as_chunks::<LANES>();
    let position = &mut particles.position.cells;
    solve(position, inverse_mass, bends, context.compliance_scale, &mut context.bends);
    bending_friction::follow(body);
}

/// One implicit step of all `bends` of a body. `scale` is one over the square of the substep, in 1/s^2.
fn solve(
    position: &mut [Cell],
    inverse_mass: &[[f32; LANES]],
    bends: &[ListedBend],
    scale: f32,
    scratch: &mut BendScratch,
) {
    let BendScratch { residual, pull, direction, image, listed_rests, .. } = scratch;
    let weight = |slot: usize| inverse_mass[slot / LANES][slot % LANES];
    residual.fill(Vec4::ZERO);
    add_forces(residual, bends, scale, |index, bend| {
        let sum = bend.sum(places(position, bend));
        let rest = listed_rests.get(index).map_or(Vec3::ZERO, |&rest| turned(sum, rest));
        (rest - sum).extend(0.0)
    });
    pull.copy_from_slice(residual);
    let mut norm: f64 =
        residual.iter().enumerate().map(|(slot, &r)| dot(r, r) * f64::from(weight(slot))).sum();
    let enough = norm * TOLERANCE;
    for _ in 0..MOST_ITERATIONS {
        if norm <= enough {
            break;
        }
        for (slot, direction) in direction.iter_mut().enumerate() {
            *direction = pull[slot] * weight(slot);
        }
        image.copy_from_slice(pull);
        add_forces(image, bends, scale, |_, bend| bend.sum(bend.slots.map(|slot| direction[slot as usize])));
        let curvature: f64 = direction.iter().zip(&*image).map(|(&p, &q)| dot(p, q)).sum();
        if !(curvature > 0.0 && curvature.is_finite()) {
            break;
        }
        let step = (norm / curvature) as f32;
        let mut left = 0.0;
        for slot in 0..residual.len() {
            let (cell, lane) = (slot / LANES, slot % LANES);
            let moved = direction[slot] * step;
            if moved != Vec4::ZERO {
                let place = position[cell].get(lane);
                position[cell].set(lane, place + moved.truncate());
            }
            residual[slot] -= image[slot] * step;
            left += dot(residual[slot], residual[slot]) * f64::from(weight(slot));
        }
        let part = (left / norm) as f32;
        norm = left;
        for (pull, &residual) in pull.iter_mut().zip(&*residual) {
            *pull = residual + *pull * part;
        }
    }
}

/// The `rest` of a bend, turned to its weighted `sum`: a pull along this does not turn the body, which has turned since the rest was found.
/// As it is where the two are not nearly along one line: then the direction of the sum is noise, as in what was pressed flat.
fn turned(sum: Vec3, rest: Vec3) -> Vec3 {
    let (squared, of_rest, product) = (sum.length_squared(), rest.length_squared(), rest.dot(sum));
    if product * product <= ALONG_ONE_LINE * squared * of_rest {
        return rest;
    }
    let size = (of_rest / squared).sqrt();
    sum * if product >= 0.0 { size } else { -size }
}

/// Adds to `forces` those of all bends, whose weighted sums `sum` gives.
fn add_forces(
    forces: &mut [Vec4],
    bends: &[ListedBend],
    scale: f32,
    sum: impl Fn(usize, &ListedBend) -> Vec4,
) {
    let per_scale = 1.0 / scale;
    for (index, bend) in bends.iter().enumerate() {
        let force = sum(index, bend) * (bend.stiffness * per_scale);
        for (slot, weight) in bend.slots.into_iter().zip(bend.weights) {
            forces[slot as usize] += force * weight;
        }
    }
}

/// The product of the first three numbers.
fn dot(a: Vec4, b: Vec4) -> f64 {
    let [a, b] = [a, b].map(Vec4::as_dvec4);
    a.x * b.x + a.y * b.y + a.z * b.z
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::build::topology_builder::TopologyBuilder;
    use crate::constraint::testing::dice;
    use crate::state::bends::BendingRigidity;
    use crate::state::particles::Particles;
    use crate::state::settings::BodySettings;
    use glam::DVec3;

    const SCALE: f32 = 1e4;

    /// A crumpled sheet of triangles, of which one particle is pinned and others are heavy.
    fn crumpled(pin: bool) -> Body {
        let side = 5;
        let places = (0..side * side).map(|i| Vec3::new((i % side) as f32, (i / side) as f32, 0.0) * 0.1);
        let rest: Vec<Vec3> = places.collect();
        let faces = (0..side - 1).flat_map(|row| (0..side - 1).map(move |column| row * side + column));
        let faces = faces.flat_map(|a| [[a, a + 1, a + side], [a + 1, a + side + 1, a + side]]);
        let mut builder = TopologyBuilder::new(&rest);
        builder.faces(faces.map(|face| face.map(|corner| corner as u32))).expect("valid");
        builder.bending(BendingRigidity::isotropic(1e-3)).expect("valid");
        let mut dice = dice(7);
        let moved: Vec<Vec3> =
            rest.iter().map(|&place| place + Vec3::new(dice(), dice(), dice()) * 0.05).collect();
        let weights: Vec<f32> = (0..rest.len())
            .map(|i| if i == 3 && pin { 0.0 } else { 100.0 + (i % 4) as f32 * 300.0 })
            .collect();
        let particles = Particles::new(Vec3::ZERO, &moved, &weights).expect("valid");
        let topology = Arc::new(builder.build().expect("valid"));
        let mut body = Body::new(particles, topology, BodySettings::default());
        body.context.bends.reserve(body.particles.layout.cells() * LANES);
        body.context.compliance_scale = SCALE;
        body
    }

    fn places(body: &Body) -> Vec<Vec3> {
        body.particles.local_positions().collect()
    }

    /// Forces of the bends on the particles, in units of `kg m` per square of the substep.
    fn forces(body: &Body, places: &[Vec3]) -> Vec<Vec3> {
        let mut forces = vec![Vec3::ZERO; places.len()];
        for bend in &body.topology.bends.listed {
            let particles =
                bend.slots.map(|slot| body.topology.layout.index(slot as usize).expect("a particle"));
            let sum = bend.sum(particles.map(|i| places[i])) * (bend.stiffness / SCALE);
            particles.into_iter().zip(bend.weights).for_each(|(i, weight)| forces[i] -= sum * weight);
        }
        forces
    }

    /// The step is that of the bends at its end: mass times step is their force there.
    #[test]
    fn a_solve_is_an_implicit_step() {
        let mut body = crumpled(true);
        let before = places(&body);
        let start = forces(&body, &before).iter().map(|force| force.length()).fold(0.0, f32::max);
        let last = body.settings.iterations - 1;
        project(&mut body, last);
        let after = places(&body);
        let forces = forces(&body, &after);
        for (i, force) in forces.into_iter().enumerate() {
            let weight = body.particles.inverse_mass(i);
            let step = after[i] - before[i];
            if weight == 0.0 {
                assert_eq!(step, Vec3::ZERO, "a pin stays");
            } else {
                let error = (step / weight - force).length() / start;
                assert!(error < 0.02, "particle {i}: {error} of the force at the start");
            }
        }
    }

    #[test]
    fn a_solve_keeps_momentum_and_angular_momentum() {
        let mut body = crumpled(false);
        let before = places(&body);
        let last = body.settings.iterations - 1;
        project(&mut body, last);
        let after = places(&body);
        let (mut momentum, mut angular, mut scale) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for (i, (from, to)) in before.into_iter().zip(after).enumerate() {
            let pushed = (to - from).as_dvec3() / f64::from(body.particles.inverse_mass(i));
            momentum += pushed;
            angular += from.as_dvec3().cross(pushed);
            scale += pushed.length();
        }
        assert!(scale > 1e-4, "it has moved");
        assert!(momentum.length() < 1e-5 * scale, "{momentum} of {scale}");
        assert!(angular.length() < 1e-5 * scale, "{angular} of {scale}");
    }
}
