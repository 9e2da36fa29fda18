//! The particles of all bodies of an island that touch by their surfaces, in one list.
//!
//! Design: `docs/design/self_contact.md`.

use glam::{Vec3, Vec4};

use crate::simd::columns::{Cell, Columns, LANES};
use crate::state::body::Body;
use crate::state::particles::Particles;
use crate::state::star::NONE;

/// Places of particles at the start of a substep and now, relative to the origin of the first body, in metres. The fourth
/// number of a place is zero: kernels load places whole.
#[derive(Clone, Debug, Default)]
pub(crate) struct Points {
    /// For each body the number of its first particle; [`NONE`] if its surface touches nothing.
    pub first: Vec<u32>,
    /// The number of cells of all these bodies.
    cells: usize,
    /// Places at the start of the substep, as the bodies have them. What follows is read from it when it is needed.
    pub start_cells: Vec<Cell>,
    /// The body of each particle.
    pub body: Vec<u32>,
    /// In 1/kg.
    pub inverse_mass: Vec<f32>,
    pub start: Vec<Vec4>,
    pub end: Vec<Vec4>,
    /// Places after free flight.
    pub flight: Vec<Vec4>,
    /// The part of their ways in this substep that becomes velocity, in metres.
    pub motion: Vec<Vec3>,
    /// Motion as the bodies have it.
    known_motion: Vec<Vec3>,
    /// Places as the bodies have them.
    known: Vec<Vec4>,
}

impl Points {
    pub fn clear(&mut self) {
        self.first.clear();
        self.cells = 0;
        self.start_cells.clear();
        self.start.clear();
    }

    /// The number of particles.
    pub fn len(&self) -> usize {
        self.cells * LANES
    }

    /// True if no surface touches anything.
    pub fn is_empty(&self) -> bool {
        self.start_cells.is_empty()
    }

    /// Numbers the particles.
    pub fn number(&mut self, bodies: &[Body]) {
        self.clear();
        for body in bodies {
            if body.has_self_contact() {
                self.first.push((self.cells * LANES) as u32);
                self.cells += body.particles.position.cells.len();
            } else {
                self.first.push(NONE);
            }
        }
    }

    /// Notes where the particles are at the start of a substep, before anything has moved.
    pub fn begin_substep(&mut self, bodies: &[Body]) {
        self.number(bodies);
        for body in bodies.iter().filter(|body| body.has_self_contact()) {
            self.start_cells.extend_from_slice(&body.particles.position.cells);
        }
    }

    /// Reads the particles as they were at the start of the substep, once for a substep.
    pub fn read_starts(&mut self, bodies: &[Body]) {
        if !self.start.is_empty() {
            return;
        }
        let Self { first, start_cells, start, body: of, inverse_mass, .. } = self;
        of.clear();
        inverse_mass.clear();
        let origin = bodies.first().map_or(Vec3::ZERO, |body| body.particles.origin);
        for (place, (body, &first)) in (0..).zip(bodies.iter().zip(&*first)).filter(|(_, of)| *of.1 != NONE) {
            let cells = first as usize / LANES..first as usize / LANES + body.particles.position.cells.len();
            read_cells(&start_cells[cells], body.particles.origin - origin, start);
            inverse_mass.extend_from_slice(&body.particles.inverse_mass);
            of.resize(inverse_mass.len(), place);
        }
    }

    /// Has the bodies watch the ways from where their particles were when the substep began to where they are in this `column`.
    pub fn prepare_watches(&self, bodies: &mut [Body], column: fn(&Body) -> &Columns, index: u32) {
        for (body, &first) in bodies.iter_mut().zip(&self.first).filter(|(_, first)| **first != NONE) {
            let mut watch = core::mem::take(&mut body.context.watch);
            let starts = &self.start_cells[first as usize / LANES..];
            let next = &column(body).cells;
            watch.prepare_towards(&starts[..next.len()], next, index);
            body.context.watch = watch;
        }
    }

    /// Reads where the particles are now, and their motion: what they have moved since this `followed` column is part of it.
    pub fn read<'a>(&mut self, bodies: &'a [Body], followed: impl Fn(&'a Body) -> &'a Columns) {
        read(bodies, &mut self.end);
        self.known.clone_from(&self.end);
        self.motion.clear();
        for body in bodies.iter().filter(|body| body.has_self_contact()) {
            let Particles { position, displacement, .. } = &body.particles;
            for ((position, displacement), followed) in
                position.cells.iter().zip(&displacement.cells).zip(&followed(body).cells)
            {
                let motion = |lane| displacement.get(lane) + (position.get(lane) - followed.get(lane));
                self.motion.extend((0..LANES).map(motion));
            }
        }
        self.known_motion.clone_from(&self.motion);
    }

    /// Reads where the particles were after free flight.
    pub fn read_flight(&mut self, bodies: &[Body]) {
        read_columns(bodies, &mut self.flight, |body| &body.context.integrated);
    }

    /// Moves the bodies' particles to where they are now. `move_particle` gets the body, the slot, the way in metres, and the
    /// part of it that becomes velocity.
    pub fn write(&mut self, bodies: &mut [Body], move_particle: impl Fn(&mut Body, usize, Vec3, Vec3)) {
        for (body, &first) in bodies.iter_mut().zip(&self.first).filter(|(_, first)| **first != NONE) {
            for slot in 0..body.particles.inverse_mass.len() {
                let id = first as usize + slot;
                let (end, motion) = (self.end[id], self.motion[id]);
                if end != self.known[id] || motion != self.known_motion[id] {
                    let way = (end - self.known[id]).truncate();
                    move_particle(body, slot, way, motion - self.known_motion[id]);
                    (self.known[id], self.known_motion[id]) = (end, motion);
                }
            }
        }
    }

    /// Places of the particles with these numbers, now.
    pub fn ends<const N: usize>(&self, ids: [u32; N]) -> [Vec3; N] {
        ids.map(|id| self.end[id as usize].truncate())
    }

    /// Places of the particles with these numbers when the substep began.
    pub fn starts<const N: usize>(&self, ids: [u32; N]) -> [Vec3; N] {
        ids.map(|id| self.start[id as usize].truncate())
    }

    /// The parts of their ways that become velocity, in metres.
    pub fn motions<const N: usize>(&self, ids: [u32; N]) -> [Vec3; N] {
        ids.map(|id| self.motion[id as usize])
    }

    pub fn inverse_masses<const N: usize>(&self, ids: [u32; N]) -> [f32; N] {
        ids.map(|id| self.inverse_mass[id as usize])
    }

    /// Moves particle `id` by this way in metres, which becomes velocity.
    pub fn move_by(&mut self, id: usize, way: Vec3) {
        self.end[id] += way.extend(0.0);
        self.motion[id] += way;
    }

    /// Moves particle `id` by this way in metres, in position only.
    pub fn shift_by(&mut self, id: usize, way: Vec3) {
        self.end[id] += way.extend(0.0);
    }

    /// Way of particle `id` in this substep so far, in metres.
    pub fn way(&self, id: usize) -> Vec3 {
        (self.end[id] - self.start[id]).truncate()
    }
}

fn read(bodies: &[Body], to: &mut Vec<Vec4>) {
    read_columns(bodies, to, |body| &body.particles.position);
}

fn read_columns(bodies: &[Body], to: &mut Vec<Vec4>, columns: impl Fn(&Body) -> &Columns) {
    to.clear();
    let origin = bodies.first().map_or(Vec3::ZERO, |body| body.particles.origin);
    for body in bodies.iter().filter(|body| body.has_self_contact()) {
        read_cells(&columns(body).cells, body.particles.origin - origin, to);
    }
}

/// Appends the places of these cells, with their origin at `shift`.
fn read_cells(cells: &[Cell], shift: Vec3, to: &mut Vec<Vec4>) {
    for cell in cells {
        to.extend((0..LANES).map(|lane| (cell.get(lane) + shift).extend(0.0)));
    }
}
