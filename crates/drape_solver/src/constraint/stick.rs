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
//!
//! Both formulas stand in `projection.rs`. Here, `project_lanes` moves the ends of a grid's sticks. Listed sticks have
//! kernels of their own, and loose ones the same scalar code (`listed_stick.rs`); lines are solved at once (`direct/`).
//!
//! Design: `docs/design/relaxation.md`.

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};

use crate::constants::REFERENCE_STEP;
use crate::constraint::listed_stick::project;
use crate::constraint::projection::Projection;
use crate::motion::body_columns::BodyColumns;
use crate::simd::columns::{Cell, LANES};
use crate::simd::lanes::{Lanes3, load};
use crate::state::grid::GridRun;
use crate::state::particles::Particles;
use crate::state::topology::{LooseStick, StickBound, Topology};

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

/// The greatest difference between a stick's length and its rest length, in metres.
pub(crate) fn greatest_error(particles: &Particles, topology: &Topology) -> f32 {
    let error = |i: usize, bound: StickBound| {
        let [a, b] = topology.stick(i).map(|end| particles.local_position(end as usize));
        bound.violation(f64::from(a.distance(b) - topology.rest_length(i))).abs() as f32
    };
    let batches = topology.batches.iter().filter(|batch| batch.material.stiffness > 0.0);
    let errors = batches.flat_map(|batch| batch.range().map(move |i| error(i, batch.material.bound)));
    errors.fold(0.0, f32::max)
}

/// The columns of some cells, as sticks read and write them.
pub(crate) struct Joined<'a> {
    pub position: &'a mut [Cell],
    pub inverse_mass: &'a [[f32; LANES]],
    /// For each cell the inverse mass that all its particles share, or 0.
    pub common_mass: &'a [f32],
}

impl<'a> Joined<'a> {
    /// The cells of a body from `first_cell` on, of which `position` are the positions.
    #[inline(always)]
    pub fn new(position: &'a mut [Cell], rest: &BodyColumns<'a>, first_cell: usize) -> Self {
        let (inverse_mass, common_mass) = (&rest.inverse_mass[first_cell..], &rest.common_mass[first_cell..]);
        Self { position, inverse_mass, common_mass }
    }
}

/// Rest length, stiffness and formula that the sticks of a batch share.
#[derive(Clone, Copy)]
pub(crate) struct Alike<P> {
    /// Metres.
    pub rest_length: f32,
    /// The part of the error that one iteration removes.
    pub stiffness: f32,
    pub projection: P,
}

/// Relaxes the sticks of the strips that begin at `first_cells`, a cell at a time.
#[inline(always)]
pub(crate) fn project_runs<S: Simd>(
    simd: S,
    joined: &mut Joined,
    runs: &[GridRun],
    first_cells: impl Iterator<Item = usize> + Clone,
    alike: Alike<impl Projection>,
) {
    for run in runs {
        let firsts = first_cells.clone();
        match run.shift {
            0 if run.lanes == u16::MAX => project_run::<S, 0, true>(simd, joined, run, firsts, alike),
            0 => project_run::<S, 0, false>(simd, joined, run, firsts, alike),
            1 => project_run::<S, 1, false>(simd, joined, run, firsts, alike),
            3 => project_run::<S, 3, false>(simd, joined, run, firsts, alike),
            4 => project_run::<S, 4, false>(simd, joined, run, firsts, alike),
            _ => project_run::<S, 5, false>(simd, joined, run, firsts, alike),
        }
    }
}

/// [`project_lanes`] as a function of its own, because the compiler would take minutes for one function of all kernels.
#[inline(always)]
fn project_run<S: Simd, const SHIFT: usize, const ALL_LANES: bool>(
    simd: S,
    joined: &mut Joined,
    run: &GridRun,
    first_cells: impl Iterator<Item = usize>,
    alike: Alike<impl Projection>,
) {
    simd.vectorize(
        #[inline(always)]
        || project_lanes::<S, SHIFT, ALL_LANES>(simd, joined, run, first_cells, alike),
    );
}

/// The kernel: lane `l` of cell `a` against lane `l + SHIFT` of cell `b`, in the lanes that have a stick.
///
/// If all particles have the same mass, each end moves by half the error. That is the result of the general formula, to
/// the last bit, without its divisions.
#[inline(always)]
fn project_lanes<S: Simd, const SHIFT: usize, const ALL_LANES: bool>(
    simd: S,
    joined: &mut Joined,
    run: &GridRun,
    first_cells: impl Iterator<Item = usize>,
    Alike { rest_length, stiffness, projection }: Alike<impl Projection>,
) {
    let lanes = mask32x16::from_bitmask(simd, u64::from(run.lanes));
    let zero = f32x16::splat(simd, 0.0);
    let rest = f32x16::splat(simd, rest_length);
    let half = f32x16::splat(simd, stiffness * 0.5);
    for first_cell in first_cells {
        let (mut a, mut b) = (first_cell + run.a as usize, first_cell + run.b as usize);
        for _ in 0..run.count {
            let Ok([cell_a, cell_b]) = joined.position.get_disjoint_mut([a, b]) else {
                return;
            };
            let (p, q) = (Lanes3::load(simd, cell_a), Lanes3::load(simd, cell_b));
            let delta = shifted::<S, SHIFT>(q).minus(p);
            let mut error = projection.errors(simd, delta.dot(delta), rest);
            if !ALL_LANES {
                error = lanes.select(error, zero);
            }
            let common = joined.common_mass[a];
            let (move_a, move_b) = if common > 0.0 && common == joined.common_mass[b] {
                let both = delta.times(error * half);
                (both, both)
            } else {
                let wa = load(simd, &joined.inverse_mass[a]);
                let mut wb = load(simd, &joined.inverse_mass[b]);
                if SHIFT > 0 {
                    wb = wb.slide::<SHIFT>(wb);
                }
                // Avoids a division by zero if both ends are pinned.
                let weight = (wa + wb).max(f32x16::splat(simd, f32::MIN_POSITIVE));
                (
                    delta.times(error * (wa / weight * stiffness)),
                    delta.times(error * (wb / weight * stiffness)),
                )
            };
            p.plus(move_a).store(cell_a);
            q.minus(unshifted::<S, SHIFT>(move_b)).store(cell_b);
            a += run.step as usize;
            b += run.step as usize;
        }
    }
}

/// Relaxes sticks that belong to no run, one by one. Their ends may be anywhere, so `joined` holds the whole body.
#[inline(always)]
pub(crate) fn project_loose(
    joined: &mut Joined,
    sticks: &[LooseStick],
    backwards: bool,
    stiffness: f32,
    projection: impl Projection,
) {
    for i in 0..sticks.len() {
        let LooseStick { slots, rest_length } = sticks[if backwards { sticks.len() - 1 - i } else { i }];
        let [[a, i], [b, j]] = slots.map(|slot| [slot as usize / LANES, slot as usize % LANES]);
        let ends = [joined.position[a].get(i), joined.position[b].get(j)];
        let masses = [joined.inverse_mass[a][i], joined.inverse_mass[b][j]];
        let [p, q] = project(ends, masses, rest_length, stiffness, projection);
        joined.position[a].set(i, p);
        joined.position[b].set(j, q);
    }
}

#[inline(always)]
fn shifted<S: Simd, const SHIFT: usize>(v: Lanes3<S>) -> Lanes3<S> {
    if SHIFT == 0 { v } else { v.shifted::<SHIFT>() }
}

/// The inverse of [`shifted`]. A lane that was shifted round the end has no stick, and its move is zero.
#[inline(always)]
fn unshifted<S: Simd, const SHIFT: usize>(v: Lanes3<S>) -> Lanes3<S> {
    match SHIFT {
        0 => v,
        1 => v.shifted::<15>(),
        3 => v.shifted::<13>(),
        4 => v.shifted::<12>(),
        _ => v.shifted::<11>(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use glam::Vec3;

    use crate::build::topology_builder::TopologyBuilder;
    use crate::constraint::projection::{Exact, SquareRootFree};
    use crate::simd::isa::{Isa, Kernel};
    use crate::state::body::Body;
    use crate::state::settings::{BodySettings, StickProjection};
    use crate::state::topology::{StickKind, StickMaterial};
    use crate::substep::order::BodyStage;
    use crate::substep::testing::run_stages;

    fn stick_of_rest_length_one() -> Topology {
        let mut builder = TopologyBuilder::new(&[Vec3::ZERO, Vec3::X]);
        let material = StickMaterial::rigid(StickKind::Structural);
        builder.family(material, [[0, 1]]).expect("valid");
        builder.build().expect("valid")
    }

    fn project_once(positions: [Vec3; 2], w: [f32; 2], projection: StickProjection) -> [Vec3; 2] {
        let particles = Particles::new(Vec3::ZERO, &positions, &w).expect("valid");
        let settings = BodySettings { projection, tethers: false, ..BodySettings::default() };
        let mut body = Body::new(particles, Arc::new(stick_of_rest_length_one()), settings);
        run_stages(&mut body, 1.0, &[BodyStage::Sticks]);
        [body.particles.position(0), body.particles.position(1)]
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

    /// S10: the identity that distinguishes the right sign from the misprinted one, for e from 0.1 to 10.
    #[test]
    fn square_root_free_projection_lands_where_the_identity_says() {
        for step in 0..=400 {
            // Not `powf`: it takes roots in assembly, which Miri does not run.
            let e = 0.1 * libm::expf(step as f32 / 400.0 * libm::logf(100.0));
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

    struct ProjectRun<'a, 'b, P: Projection>(&'a mut Joined<'b>, GridRun, P);

    impl<P: Projection> Kernel for ProjectRun<'_, '_, P> {
        type Output = ();

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) {
            let alike = Alike { rest_length: 0.7, stiffness: 0.8, projection: self.2 };
            project_runs(simd, self.0, &[self.1], 0..1, alike);
        }
    }

    fn cells_and_single_sticks_agree(projection: impl Projection) {
        let spread = |i: usize, k: f32| libm::sinf(i as f32 * k) * 3.0;
        let mut start = [Cell::default(); 4];
        for slot in 0..4 * LANES {
            start[slot / LANES]
                .set(slot % LANES, Vec3::new(spread(slot, 0.7), spread(slot, 1.3), spread(slot, 2.9)));
        }
        let uneven: Vec<[f32; LANES]> = (0..4)
            .map(|cell| {
                core::array::from_fn(|lane| if (cell + lane) % 7 == 0 { 0.0 } else { 1.0 + lane as f32 })
            })
            .collect();
        let even = vec![[2.5; LANES]; 4];
        for isa in Isa::available() {
            for (inverse_mass, common) in [(&uneven, [0.0; 4]), (&even, [2.5; 4]), (&even, [0.0; 4])] {
                for (shift, lanes) in
                    [(0, u16::MAX), (0, 0x0ff3), (1, 0x7fff), (3, 0x1fff), (4, 0x0fff), (5, 0x07ff)]
                {
                    let run = GridRun { a: 0, b: 2, count: 2, step: 1, shift, lanes };
                    let (mut whole, mut single) = (start, start);
                    let mut joined = Joined { position: &mut whole, inverse_mass, common_mass: &common };
                    isa.run(ProjectRun(&mut joined, run, projection));
                    for (cell, lane) in (0..2).flat_map(|cell| (0..LANES).map(move |lane| (cell, lane))) {
                        if lanes & (1 << lane) != 0 {
                            let a = cell * LANES + lane;
                            let ends = [a, a + 2 * LANES + usize::from(shift)];
                            let ends = ends.map(|slot| (slot / LANES, slot % LANES));
                            let masses = ends.map(|(cell, lane)| inverse_mass[cell][lane]);
                            let places = ends.map(|(cell, lane)| single[cell].get(lane));
                            let moved = project(places, masses, 0.7, 0.8, projection);
                            for ((cell, lane), place) in ends.into_iter().zip(moved) {
                                single[cell].set(lane, place);
                            }
                        }
                    }
                    assert_eq!(whole, single, "shift {shift} on {}", isa.name());
                    assert_ne!(whole, start);
                }
            }
        }
    }

    /// The kernel for cells must move every end as the formula for one stick does, to the last bit.
    #[test]
    fn cells_and_single_sticks_give_the_same_bits() {
        cells_and_single_sticks_agree(Exact);
        cells_and_single_sticks_agree(SquareRootFree);
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
}
