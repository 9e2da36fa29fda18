//! Sticks: two particles kept at their rest length.
//!
//! ```text
//!   before   1 o=========================o 2      |delta| > rest
//!   after         1 o===============o 2           moved by w1/(w1+w2) and w2/(w1+w2) of the error
//! ```
//!
//! The exact form takes a square root (Liu 2019, section 3); the square-root-free form is one Newton step about
//! the rest length (Jakobsen 2001, section 5). Printed copies of the latter have a sign reversed; the one here
//! takes a stick of length `e` rest lengths to `1 - (e - 1)^2 / (1 + e^2)`.

use crate::columns::Columns;
use crate::constants::REFERENCE_STEP;
use crate::particles::Particles;
use crate::settings::StickProjection;
use crate::topology::{StickBatch, StickMaterial, StickRun, Topology};

/// The part of a stick's error that one relaxation iteration removes, for a `stiffness` in 0..=1, a substep of
/// `substep` seconds and `iterations` iterations per substep.
///
/// Stiffness `s` stands for the compliance `(1 - s) / s` in units of the reference step squared. In a substep
/// `h`, an implicit spring of that compliance removes the part `k = 1 / (1 + (h0 / h)^2 (1 - s) / s)` of its
/// error (Macklin, Müller and Chentanez 2016, "XPBD", equation 18, for one isolated constraint): under a
/// constant load the stick then settles at the same length for every `h`. Over `n` iterations that part is
/// spread as `1 - (1 - k)^(1/n)` (Müller et al. 2007, "Position Based Dynamics", section 3.3).
pub fn iteration_stiffness(stiffness: f32, substep: f32, iterations: u32) -> f32 {
    if stiffness >= 1.0 {
        return 1.0;
    }
    if stiffness <= 0.0 {
        return 0.0;
    }
    let ratio = f64::from(REFERENCE_STEP) / f64::from(substep);
    let slack = (1.0 - f64::from(stiffness)) / f64::from(stiffness);
    let per_substep = 1.0 / (1.0 + ratio * ratio * slack);
    -libm::expm1(libm::log1p(-per_substep) / f64::from(iterations)) as f32
}

/// The part of the speed along a stick that a substep of `substep` seconds takes, at `damping` (1/s).
pub(crate) fn substep_damping(material: &StickMaterial, substep: f32) -> f32 {
    -libm::expm1(-f64::from(material.damping) * f64::from(substep)) as f32
}

/// The greatest difference between a stick's length and its rest length, in metres.
pub(crate) fn greatest_error(particles: &Particles, topology: &Topology) -> f32 {
    let error = |i: usize| {
        let [a, b] = topology.stick(i).map(|end| particles.position.get(end as usize));
        (a.distance(b) - topology.rest_length(i)).abs()
    };
    let sticks = topology.batches.iter().filter(|batch| batch.material.stiffness > 0.0);
    sticks.flat_map(StickBatch::range).map(error).fold(0.0, f32::max)
}

/// One sweep over all sticks, batch by batch, in reverse where `reverse` is set. `stiffness` holds the factor
/// of [`iteration_stiffness`] for each batch.
pub(crate) fn relax(
    particles: &mut Particles,
    topology: &Topology,
    stiffness: &[f32],
    projection: StickProjection,
    reverse: bool,
) {
    let mut project = |index: usize| {
        let (batch, stiffness) = (&topology.batches[index], stiffness[index]);
        if stiffness > 0.0 {
            match projection {
                StickProjection::Exact => {
                    project_batch(particles, topology, batch, stiffness, exact);
                }
                StickProjection::SquareRootFree => {
                    project_batch(particles, topology, batch, stiffness, square_root_free);
                }
            }
        }
    };
    let count = topology.batches.len();
    if reverse {
        (0..count).rev().for_each(&mut project);
    } else {
        (0..count).for_each(&mut project);
    }
}

/// Relative error `(|delta| - rest) / |delta|` from the squared length and the rest length. A stick of zero
/// length has no direction to push in: it is left alone.
fn exact(length_squared: f32, rest: f32) -> f32 {
    if length_squared > 0.0 {
        let length = length_squared.sqrt();
        (length - rest) / length
    } else {
        0.0
    }
}

/// The same to second order in the strain, without the square root.
fn square_root_free(length_squared: f32, rest: f32) -> f32 {
    let rest_squared = rest * rest;
    (length_squared - rest_squared) / (length_squared + rest_squared)
}

fn project_batch(
    particles: &mut Particles,
    topology: &Topology,
    batch: &StickBatch,
    stiffness: f32,
    relative_error: impl Fn(f32, f32) -> f32 + Copy,
) {
    for run in topology.runs(batch) {
        let rest = &topology.rest_length[run.first..run.first + run.count];
        if run.count >= LEAST_RUN {
            project_run(particles, run, rest, stiffness, relative_error);
        } else {
            for (k, &rest) in rest.iter().enumerate() {
                project_one(particles, [run.a + k, run.b + k], rest, stiffness, relative_error);
            }
        }
    }
}

/// Runs shorter than this are not worth setting up slices for.
const LEAST_RUN: usize = 4;

/// The kernel for one stick: documentation of the one for runs.
fn project_one(
    particles: &mut Particles,
    [a, b]: [usize; 2],
    rest: f32,
    stiffness: f32,
    relative_error: impl Fn(f32, f32) -> f32,
) {
    let (wa, wb) = (particles.inverse_mass[a], particles.inverse_mass[b]);
    let weight = wa + wb;
    if weight > 0.0 {
        let delta = particles.position.get(b) - particles.position.get(a);
        let scale = stiffness * relative_error(delta.length_squared(), rest) / weight;
        particles.position.add(a, delta * (wa * scale));
        particles.position.add(b, delta * (-wb * scale));
    }
}

/// The same for a run: plain arithmetic on slices, which the compiler turns into vector code.
fn project_run(
    particles: &mut Particles,
    run: &StickRun,
    rest: &[f32],
    stiffness: f32,
    relative_error: impl Fn(f32, f32) -> f32,
) {
    let n = rest.len();
    let wa = &particles.inverse_mass[run.a..][..n];
    let wb = &particles.inverse_mass[run.b..][..n];
    let Columns { x, y, z } = &mut particles.position;
    let (ax, bx) = both_ends(x, run);
    let (ay, by) = both_ends(y, run);
    let (az, bz) = both_ends(z, run);
    for i in 0..n {
        let (dx, dy, dz) = (bx[i] - ax[i], by[i] - ay[i], bz[i] - az[i]);
        let weight = wa[i] + wb[i];
        let error = stiffness * relative_error(dx * dx + dy * dy + dz * dz, rest[i]);
        let scale = if weight > 0.0 { error / weight } else { 0.0 };
        let (sa, sb) = (wa[i] * scale, -wb[i] * scale);
        ax[i] += dx * sa;
        ay[i] += dy * sa;
        az[i] += dz * sa;
        bx[i] += dx * sb;
        by[i] += dy * sb;
        bz[i] += dz * sb;
    }
}

/// The slices of a column that hold the first and the second ends of a run.
fn both_ends<'a>(column: &'a mut [f32], run: &StickRun) -> (&'a mut [f32], &'a mut [f32]) {
    let (low, high) = column.split_at_mut(run.b);
    (&mut low[run.a..][..run.count], &mut high[..run.count])
}

/// Takes the part `damping[batch]` of the speed at which the ends of each stick part or close. Only velocities
/// change; momentum is kept.
pub(crate) fn damp(particles: &mut Particles, topology: &Topology, damping: &[f32]) {
    for (batch, &damping) in topology.batches.iter().zip(damping) {
        if damping == 0.0 {
            continue;
        }
        for i in batch.range() {
            let [a, b] = topology.stick(i).map(|end| end as usize);
            let (wa, wb) = (particles.inverse_mass[a], particles.inverse_mass[b]);
            let delta = particles.position.get(b) - particles.position.get(a);
            let length_squared = delta.length_squared();
            if wa + wb == 0.0 || length_squared == 0.0 {
                continue;
            }
            let parting = particles.displacement.get(b) - particles.displacement.get(a);
            let scale = damping * parting.dot(delta) / (length_squared * (wa + wb));
            particles.displacement.add(a, delta * (wa * scale));
            particles.displacement.add(b, delta * (-wb * scale));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::{StickKind, TopologyBuilder};
    use glam::Vec3;

    fn stick_of_rest_length_one() -> Topology {
        let mut builder = TopologyBuilder::new(&[Vec3::ZERO, Vec3::X]);
        let material = StickMaterial::rigid(StickKind::Structural);
        builder.family(material, [[0, 1]]).expect("valid");
        builder.build().expect("valid")
    }

    fn project_once(positions: [Vec3; 2], w: [f32; 2], projection: StickProjection) -> [Vec3; 2] {
        let mut particles = Particles::new(Vec3::ZERO, &positions, &w).expect("valid");
        relax(&mut particles, &stick_of_rest_length_one(), &[1.0], projection, false);
        [particles.position(0), particles.position(1)]
    }

    /// S8: one projection of the exact form restores the rest length from any strain.
    #[test]
    fn exact_projection_restores_the_rest_length() {
        for e in [0.1, 0.5, 1.0, 2.0, 10.0] {
            let [a, b] = project_once([Vec3::ZERO, Vec3::X * e], [1.0, 1.0], StickProjection::Exact);
            assert!((a.distance(b) - 1.0).abs() < 1e-6, "from {e}");
            assert!(((a + b) / 2.0 - Vec3::X * e / 2.0).length() < 1e-6, "middle stays");
        }
    }

    /// S10: the identity that tells the right sign from the misprinted one, over e in 0.1..10.
    #[test]
    fn square_root_free_projection_lands_where_the_identity_says() {
        for step in 0..=400 {
            let e = 0.1 * libm::powf(100.0, step as f32 / 400.0);
            let ends = [Vec3::ZERO, Vec3::X * e];
            let [a, b] = project_once(ends, [1.0, 1.0], StickProjection::SquareRootFree);
            let expected = 1.0 - (e - 1.0) * (e - 1.0) / (1.0 + e * e);
            assert!((a.distance(b) - expected).abs() < 2e-6, "e = {e}");
        }
    }

    /// S9: the ends move in proportion to their inverse masses, and a pinned end not at all.
    #[test]
    fn ends_move_by_their_share_of_inverse_mass() {
        let ends = [Vec3::ZERO, Vec3::X * 2.0];
        for projection in [StickProjection::Exact, StickProjection::SquareRootFree] {
            let [a, b] = project_once(ends, [3.0, 1.0], projection);
            assert!((a.x - 3.0 * (2.0 - b.x)).abs() < 1e-6);
            let [a, _] = project_once(ends, [0.0, 1.0], projection);
            assert_eq!(a, Vec3::ZERO);
            assert_eq!(project_once(ends, [0.0, 0.0], projection), ends);
        }
    }

    /// S14: two particles in one place give no direction; nothing is divided by zero.
    #[test]
    fn a_stick_of_zero_length_stays_finite() {
        for projection in [StickProjection::Exact, StickProjection::SquareRootFree] {
            let [a, b] = project_once([Vec3::ONE; 2], [1.0, 1.0], projection);
            assert_eq!([a, b], [Vec3::ONE; 2]);
        }
    }

    /// The kernel for runs must move every end as the kernel for one stick does, to the last bit.
    #[test]
    fn runs_and_single_sticks_give_the_same_bits() {
        let spread = |i: usize, k: f32| libm::sinf(i as f32 * k) * 3.0;
        let positions: Vec<Vec3> =
            (0..40).map(|i| Vec3::new(spread(i, 0.7), spread(i, 1.3), spread(i, 2.9))).collect();
        let inverse_masses: Vec<f32> =
            (0..40).map(|i| if i % 7 == 0 { 0.0 } else { 1.0 + i as f32 }).collect();
        let start = Particles::new(Vec3::ZERO, &positions, &inverse_masses).expect("valid");
        let run = StickRun { first: 0, count: 17, a: 2, b: 20 };
        let rest: Vec<f32> = (0..17).map(|i| 0.5 + 0.1 * i as f32).collect();
        for error in [exact, square_root_free] {
            let (mut whole, mut single) = (start.clone(), start.clone());
            project_run(&mut whole, &run, &rest, 0.8, error);
            for (k, &rest) in rest.iter().enumerate() {
                project_one(&mut single, [run.a + k, run.b + k], rest, 0.8, error);
            }
            assert_eq!(whole, single);
            assert_ne!(whole, start);
        }
    }

    #[test]
    fn stiffness_per_iteration_compounds_to_the_same_whole() {
        let whole = iteration_stiffness(0.3, REFERENCE_STEP, 1);
        assert!((whole - 0.3).abs() < 1e-6);
        for n in [2, 5, 16] {
            let each = iteration_stiffness(0.3, REFERENCE_STEP, n);
            let left = libm::powf(1.0 - each, n as f32);
            assert!((1.0 - left - whole).abs() < 1e-5);
        }
        assert_eq!(iteration_stiffness(1.0, 0.001, 7), 1.0);
        assert_eq!(iteration_stiffness(0.0, 0.001, 7), 0.0);
    }

    /// S13: the speed along a stick decays as exp(-damping t); momentum and sideways speed stay.
    #[test]
    fn damping_takes_the_speed_along_the_stick_only() {
        let positions = [Vec3::ZERO, Vec3::X];
        let mut particles = Particles::new(Vec3::ZERO, &positions, &[1.0, 1.0]).expect("valid");
        particles.set_velocity(0, Vec3::new(-1.0, 0.0, 0.0));
        particles.set_velocity(1, Vec3::new(1.0, 3.0, 0.0));
        let material = StickMaterial { damping: 2.0, ..StickMaterial::rigid(StickKind::Bend) };
        let factor = substep_damping(&material, 0.5);
        damp(&mut particles, &stick_of_rest_length_one(), &[factor]);
        let parting = particles.velocity(1) - particles.velocity(0);
        assert!((parting.x - 2.0 * libm::expf(-1.0)).abs() < 1e-5);
        assert!((parting.y - 3.0).abs() < 1e-6);
        assert!((particles.velocity(0) + particles.velocity(1) - Vec3::Y * 3.0).length() < 1e-5);
    }
}
