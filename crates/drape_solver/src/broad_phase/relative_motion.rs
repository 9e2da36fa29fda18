//! Bounds on the relative motion of particles: for how long a known distance keeps two of them apart.
//!
//! Two particles cannot touch before their paths have used up the distance between them. So one number, the greatest
//! path of all particles, says for each pair when it must be tested again, and a pair that is far apart costs one
//! comparison. The mean motion of all particles brings no two nearer and is subtracted: falling cloth counts as
//! standing still.
//!
//! A substep has two legs: projections and friction at the end of the substep before, and free flight. Both count in
//! full.
//!
//! Design: `docs/design/self_contact.md`.

use std::sync::{Arc, Weak};

use glam::Vec3;

use crate::simd::columns::{Cell, Columns, LANES};
use crate::simd::isa::{Isa, Kernel};
use crate::state::body::Body;
use crate::state::settings::SelfContact;
use crate::state::topology::Topology;

/// The paths of the particles of an island, against each other.
#[derive(Clone, Debug, Default)]
pub(crate) struct RelativeMotion {
    known: Vec<Known>,
    /// Motion since the lists were made that live on from step to step.
    pub of_lists: Motion,
    /// Motion since the first free flight of the step.
    pub of_step: Motion,
}

/// Upper bound in metres on the approach of any two particles since some beginning.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Motion {
    /// The bound when the substep began.
    pub at_start: f32,
    pub now: f32,
}

impl Motion {
    fn add(&mut self, first: f32, flight: f32) {
        self.at_start = self.now + 2.0 * first;
        self.now = self.at_start + 2.0 * flight;
    }
}

/// A body at the last call.
#[derive(Clone, Debug, Default)]
struct Known {
    /// Its index in the island, by which lists name it.
    place: usize,
    topology: Weak<Topology>,
    level: SelfContact,
    thickness: f32,
    origin: Vec3,
    position: Columns,
    /// 1 for each slot that holds a particle, else 0.
    real: Vec<[f32; LANES]>,
}

impl Known {
    fn is(&self, place: usize, body: &Body) -> bool {
        self.place == place
            && core::ptr::eq(self.topology.as_ptr(), Arc::as_ptr(&body.topology))
            && self.level == body.settings.self_contact
            && self.thickness.to_bits() == body.settings.thickness.to_bits()
            && self.position.cells.len() == body.particles.position.cells.len()
    }

    fn note(&mut self, place: usize, body: &Body) {
        if !self.is(place, body) {
            self.place = place;
            self.topology = Arc::downgrade(&body.topology);
            self.level = body.settings.self_contact;
            self.thickness = body.settings.thickness;
            let layout = &body.particles.layout;
            self.real.clear();
            self.real.extend((0..layout.cells()).map(|cell| {
                let bits = layout.real_lanes(cell);
                core::array::from_fn(|lane| f32::from((bits >> lane) & 1))
            }));
        }
        self.origin = body.particles.origin;
        self.position.cells.clone_from(&body.particles.position.cells);
    }
}

impl RelativeMotion {
    /// Forgets everything.
    pub fn forget(&mut self) {
        self.known.clear();
    }

    /// Adds the motion since the last call; it comes after the free flight of a substep. Returns false if the bodies
    /// are not those of the last call, or if the sum has become too long to be added to: the bounds then begin anew.
    pub fn follow(&mut self, bodies: &[Body], isa: Isa, is_first: bool) -> bool {
        let on = || bodies.iter().enumerate().filter(|(_, body)| body.has_self_contact());
        let are_known = on().count() == self.known.len()
            && on().zip(&self.known).all(|((i, body), known)| known.is(i, body));
        if are_known {
            let mut sums = Legs { first: Vec3::ZERO, flight: Vec3::ZERO };
            let mut count = 0.0;
            for ((_, body), known) in on().zip(&self.known) {
                let of_body = isa.run(Sum(Ways::new(body, known)));
                sums = Legs { first: sums.first + of_body.first, flight: sums.flight + of_body.flight };
                count += body.particles.len() as f32;
            }
            let mean = Legs { first: sums.first / count, flight: sums.flight / count };
            let (mut first, mut flight) = (0.0_f32, 0.0_f32);
            for ((_, body), known) in on().zip(&self.known) {
                let of_body = isa.run(Greatest(Ways::new(body, known), mean));
                (first, flight) = (first.max(of_body[0]), flight.max(of_body[1]));
            }
            self.of_lists.add(first.sqrt(), flight.sqrt());
            self.of_step.add(first.sqrt(), flight.sqrt());
        }
        self.known.resize_with(on().count(), Known::default);
        on().zip(&mut self.known).for_each(|((place, body), known)| known.note(place, body));
        // NaN counts as too long.
        let is_good = are_known && self.of_lists.now < LONGEST_WAY;
        if !is_good {
            self.of_lists = Motion::default();
        }
        if is_first || !are_known {
            self.of_step = Motion::default();
        }
        is_good
    }
}

/// Beyond this, in metres, small distances would be lost in the rounding of the sum.
const LONGEST_WAY: f32 = 4.0;

/// The two legs of a substep.
#[derive(Clone, Copy)]
struct Legs {
    first: Vec3,
    flight: Vec3,
}

/// The data from which the ways of a body's particles are computed.
struct Ways<'a> {
    position: &'a [Cell],
    displacement: &'a [Cell],
    before: &'a [Cell],
    real: &'a [[f32; LANES]],
    /// The way of the body's origin.
    shift: Vec3,
}

impl<'a> Ways<'a> {
    fn new(body: &'a Body, known: &'a Known) -> Self {
        Self {
            position: &body.particles.position.cells,
            displacement: &body.particles.displacement.cells,
            before: &known.position.cells,
            real: &known.real,
            shift: body.particles.origin - known.origin,
        }
    }

    /// The legs of a cell's particles along one axis, less `mean`; zero for lanes without a particle.
    #[inline(always)]
    fn legs(&self, cell: usize, axis: usize, mean: Legs) -> [[f32; LANES]; 2] {
        let (position, displacement) = (&self.position[cell], &self.displacement[cell]);
        let (now, flown) = (position.axes()[axis], displacement.axes()[axis]);
        let before = self.before[cell].axes()[axis];
        let real = &self.real[cell];
        let shift = self.shift[axis] - mean.first[axis];
        let mean = mean.flight[axis];
        [
            core::array::from_fn(|k| (now[k] - flown[k] - before[k] + shift) * real[k]),
            core::array::from_fn(|k| (flown[k] - mean) * real[k]),
        ]
    }
}

struct Sum<'a>(Ways<'a>);

impl Kernel for Sum<'_> {
    type Output = Legs;

    #[inline(always)]
    fn run<S: fearless_simd::Simd>(self, _: S) -> Legs {
        let none = Legs { first: Vec3::ZERO, flight: Vec3::ZERO };
        let mut sums = [[[0.0_f32; LANES]; 3]; 2];
        for cell in 0..self.0.position.len() {
            for axis in 0..3 {
                let legs = self.0.legs(cell, axis, none);
                for (sums, leg) in sums.iter_mut().zip(legs) {
                    for (sum, way) in sums[axis].iter_mut().zip(leg) {
                        *sum += way;
                    }
                }
            }
        }
        let [first, flight] = sums.map(|axes| Vec3::from_array(axes.map(|lanes| lanes.iter().sum::<f32>())));
        Legs { first, flight }
    }
}

/// The greatest squares of the two legs, less their means.
struct Greatest<'a>(Ways<'a>, Legs);

impl Kernel for Greatest<'_> {
    type Output = [f32; 2];

    #[inline(always)]
    fn run<S: fearless_simd::Simd>(self, _: S) -> [f32; 2] {
        let mut greatest = [[0.0_f32; LANES]; 2];
        for cell in 0..self.0.position.len() {
            let [x, y, z] = [0, 1, 2].map(|axis| self.0.legs(cell, axis, self.1));
            for leg in 0..2 {
                for k in 0..LANES {
                    let squared = x[leg][k] * x[leg][k] + y[leg][k] * y[leg][k] + z[leg][k] * z[leg][k];
                    greatest[leg][k] = if squared > greatest[leg][k] { squared } else { greatest[leg][k] };
                }
            }
        }
        greatest.map(|lanes| lanes.into_iter().fold(0.0, f32::max))
    }
}
