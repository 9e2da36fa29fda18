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

use fearless_simd::{Simd, f32x4, f32x16, prelude::*};
use glam::Vec3;

use crate::constants::ALONG_ONE_LINE;
use crate::constraint::bending_friction;
use crate::constraint::listed_bend::{BendGroup, PlacedBends, for_each_group, number_of};
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::{Isa, Kernel};
use crate::simd::lanes::{Lanes3, load};
use crate::simd::rows::{Rows, Window, lanes_of_rows, rows_of_columns, store_rows};
use crate::state::bends::{BendScratch, Bends};
use crate::state::body::Body;

/// The greatest number of iterations of a solve.
const MOST_ITERATIONS: usize = 16;

/// A solve ends when the squared residual is this part of that at the start.
const TOLERANCE: f32 = 1e-6;

/// One implicit step of all listed bends of a body, in iteration `projection` of the substep.
pub(crate) fn project(body: &mut Body, projection: u32, isa: Isa) {
    let Body { particles, topology, settings, context, .. } = body;
    if topology.bends.listed.is_empty() || projection + 1 != settings.iterations {
        return;
    }
    let BendScratch { places, residual, pull, direction, image, listed_rests, .. } = &mut context.bends;
    isa.run(Solve {
        bends: &topology.bends,
        rests: listed_rests,
        substep_squared: 1.0 / context.compliance_scale,
        position: &mut particles.position.cells,
        inverse_mass: particles.inverse_mass.as_chunks().0,
        places,
        residual,
        pull,
        direction,
        image,
    });
    bending_friction::follow(body, isa);
}

/// A solve: what it reads and writes. All rows are of the whole body; their fourth numbers are zero, but for those of `places`.
struct Solve<'a> {
    bends: &'a Bends,
    /// The weighted sums at rest of the listed bends; empty if all are zero.
    rests: &'a [[f32; 4]],
    /// In s^2: forces times this are in kg m.
    substep_squared: f32,
    position: &'a mut [Cell],
    inverse_mass: &'a [[f32; LANES]],
    places: &'a mut Rows,
    residual: &'a mut Rows,
    /// The direction, times the masses.
    pull: &'a mut Rows,
    direction: &'a mut Rows,
    /// The matrix times the direction.
    image: &'a mut Rows,
}

impl Kernel for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        self.begin(simd);
        let mut norm = self.norm(simd);
        let enough = TOLERANCE * norm;
        let mut part = 0.0;
        for _ in 0..MOST_ITERATIONS {
            if norm <= enough {
                break;
            }
            self.choose_direction(simd, part);
            let curvature = self.multiply(simd);
            if !(curvature > 0.0 && curvature.is_finite()) {
                break;
            }
            self.advance(simd, norm / curvature);
            let left = self.norm(simd);
            part = left / norm;
            norm = left;
        }
        self.places.put_back_all(simd, self.position);
    }
}

/// Each part is a function of its own, because the compiler would take long for one function of all.
impl Solve<'_> {
    /// Takes the positions, and finds the forces of the bends there.
    fn begin<S: Simd>(&mut self, simd: S) {
        let Self { bends, rests, places, residual, pull, substep_squared, .. } = self;
        pull.clear();
        residual.clear();
        simd.vectorize(
            #[inline(always)]
            || {
                places.take_all(simd, self.position, self.inverse_mass);
                let (rests, _) = rests.as_chunks();
                let (places, mut residual) = (places.window(), residual.window());
                for_each_group(
                    &bends.listed,
                    #[inline(always)]
                    |index, group| {
                        let sum = PlacedBends::load(simd, &places, group).sum();
                        let to_rest = match rests.get(index) {
                            Some(rests) => turned(simd, sum, lanes_of_rows(simd, rests)).minus(sum),
                            None => Lanes3::splat(simd, Vec3::ZERO).minus(sum),
                        };
                        let stiffness = number_of(simd, group, |bend| bend.stiffness);
                        add_forces(simd, &mut residual, group, to_rest.times(stiffness * *substep_squared));
                    },
                );
            },
        );
    }

    /// The squared residual, each particle's times its inverse mass.
    fn norm<S: Simd>(&self, simd: S) -> f32 {
        let Self { residual, inverse_mass, .. } = self;
        simd.vectorize(
            #[inline(always)]
            || {
                let mut sum = f32x16::splat(simd, 0.0);
                for (residual, masses) in residual.quarters().iter().zip(*inverse_mass) {
                    let weights = rows_of_columns([load(simd, masses); 4]);
                    for i in 0..4 {
                        let residual = load(simd, &residual[i]);
                        // In this order squares of small masses do not vanish.
                        sum += residual * (residual * weights[i]);
                    }
                }
                total(sum)
            },
        )
    }

    /// Goes on where the residual pulls, and by `part` of the direction before.
    fn choose_direction<S: Simd>(&mut self, simd: S, part: f32) {
        let Self { residual, pull, direction, inverse_mass, .. } = self;
        let residuals = residual.quarters().iter().zip(*inverse_mass);
        let directions = pull.quarters_mut().iter_mut().zip(direction.quarters_mut());
        simd.vectorize(
            #[inline(always)]
            || {
                for ((pull, direction), (residual, masses)) in directions.zip(residuals) {
                    let weights = rows_of_columns([load(simd, masses); 4]);
                    for i in 0..4 {
                        let pulled = load(simd, &residual[i]) + load(simd, &pull[i]) * part;
                        pull[i] = pulled.to_array();
                        direction[i] = (pulled * weights[i]).to_array();
                    }
                }
            },
        );
    }

    /// Multiplies the matrix with the direction. Returns the product of the result with the direction.
    fn multiply<S: Simd>(&mut self, simd: S) -> f32 {
        let Self { bends, substep_squared, pull, direction, image, .. } = self;
        let rows = bends.matrix.starts.windows(2);
        simd.vectorize(
            #[inline(always)]
            || {
                let (pull, direction, mut image) = (pull.window(), direction.window(), image.window());
                let mut curvature = f32x4::splat(simd, 0.0);
                for (slot, ends) in (0..).zip(rows) {
                    let place = direction.place(4 * slot);
                    let own = direction.get(simd, place);
                    let mut product = f32x4::splat(simd, 0.0);
                    // By differences, as neighbours move by nearly the same.
                    for entry in &bends.matrix.entries[ends[0] as usize..ends[1] as usize] {
                        let other = direction.get(simd, direction.place(entry.row));
                        product += (other - own) * entry.stiffness;
                    }
                    let result = pull.get(simd, place) + product * *substep_squared;
                    image.set(place, result);
                    curvature += own * result;
                }
                let [x, y, z, _] = curvature.to_array();
                x + y + z
            },
        )
    }

    /// Moves the particles by `step` times the direction.
    fn advance<S: Simd>(&mut self, simd: S, step: f32) {
        let Self { places, residual, direction, image, position, .. } = self;
        let moves = places.quarters_mut().iter_mut().zip(direction.quarters());
        let changes = residual.quarters_mut().iter_mut().zip(image.quarters());
        simd.vectorize(
            #[inline(always)]
            || {
                for ((place, direction), (residual, image)) in moves.zip(changes).take(position.len()) {
                    for i in 0..4 {
                        place[i] = (load(simd, &place[i]) + load(simd, &direction[i]) * step).to_array();
                        residual[i] = (load(simd, &residual[i]) - load(simd, &image[i]) * step).to_array();
                    }
                }
            },
        );
    }
}

/// The `rest` of each bend, turned to its weighted `sum`: a pull along this does not turn the body, which has turned since the rest was
/// found. As it is where the two are not nearly along one line: then the direction of the sum is noise, as in what was pressed flat.
#[inline(always)]
fn turned<S: Simd>(simd: S, sum: Lanes3<S>, rest: Lanes3<S>) -> Lanes3<S> {
    let (squared, of_rest, product) = (sum.dot(sum), rest.dot(rest), rest.dot(sum));
    let is_along = (product * product).simd_gt(squared * of_rest * ALONG_ONE_LINE);
    let size = (of_rest / squared).sqrt();
    let size = product.simd_ge(f32x16::splat(simd, 0.0)).select(size, -size);
    sum.times(size).or(is_along, rest)
}

/// Adds sixteen bends' forces on their weighted sums to those on their particles.
#[inline(always)]
fn add_forces<S: Simd>(simd: S, forces: &mut Window, group: &BendGroup, force: Lanes3<S>) {
    let Lanes3 { x, y, z } = force;
    let mut rows = [[0.0; 4]; LANES];
    store_rows(&mut rows, [x, y, z, f32x16::splat(simd, 0.0)]);
    for (bend, row) in group.iter().zip(rows) {
        let force = f32x4::load_array(simd, row);
        for (slot, weight) in bend.slots.into_iter().zip(bend.weights) {
            let place = forces.place(4 * slot);
            forces.set(place, forces.get(simd, place) + force * weight);
        }
    }
}

/// The sum of all lanes, in one order on all machines.
#[inline(always)]
fn total<S: Simd>(lanes: f32x16<S>) -> f32 {
    lanes.to_array().into_iter().sum()
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
        body.context.bends.reserve(body.particles.layout.cells());
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
        project(&mut body, last, Isa::detected());
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
        project(&mut body, last, Isa::detected());
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
