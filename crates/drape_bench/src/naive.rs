//! The naive loop: an array of vectors, sticks one after another in natural order, with a square root each.
//!
//! It runs substeps x sweeps as sweeps of one step: in natural order, single sweeps with substeps blow up.

use drape_solver::glam::{DVec3, Vec3};

use crate::contender::Contender;
use crate::workload::{GRAVITY, LOWEST, SPHERE_CENTRE, SPHERE_RADIUS, STEP, Sheet};

/// A stick as the paper has it.
#[derive(Clone, Copy)]
pub struct Stick {
    a: usize,
    b: usize,
    rest: f32,
}

/// Particles and sticks as arrays of structures.
pub struct Naive {
    position: Vec<Vec3>,
    previous: Vec<Vec3>,
    inverse_mass: Vec<f32>,
    sticks: Vec<Stick>,
    sweeps: u32,
}

impl Naive {
    /// The sheet, with the sticks of each particle together, row by row.
    pub fn new(sheet: &Sheet, sweeps: u32) -> Self {
        let position = sheet.positions();
        let mut pairs: Vec<[u32; 2]> = sheet.families().concat();
        pairs.sort_unstable_by_key(|&[a, b]| (a.min(b), a.max(b)));
        Self {
            sticks: sticks(&position, &pairs),
            previous: position.clone(),
            position,
            inverse_mass: sheet.inverse_masses(),
            sweeps,
        }
    }
}

/// Sticks at the length that `position` gives them.
pub fn sticks(position: &[Vec3], pairs: &[[u32; 2]]) -> Vec<Stick> {
    let measure = |&[a, b]: &[u32; 2]| {
        let (a, b) = (a as usize, b as usize);
        Stick { a, b, rest: position[a].distance(position[b]) }
    };
    pairs.iter().map(measure).collect()
}

/// One Verlet step of `h` seconds.
pub fn integrate(position: &mut [Vec3], previous: &mut [Vec3], inverse_mass: &[f32], h: f32) {
    for ((x, old), &w) in position.iter_mut().zip(previous).zip(inverse_mass) {
        if w > 0.0 {
            let next = *x + (*x - *old) + GRAVITY * (h * h);
            *old = *x;
            *x = next;
        }
    }
}

/// Brings each stick to its rest length, in the order given.
pub fn relax(position: &mut [Vec3], inverse_mass: &[f32], sticks: &[Stick]) {
    for stick in sticks {
        let (wa, wb) = (inverse_mass[stick.a], inverse_mass[stick.b]);
        if wa + wb == 0.0 {
            continue;
        }
        let delta = position[stick.b] - position[stick.a];
        let length = delta.length();
        let scale = (length - stick.rest) / (length * (wa + wb));
        position[stick.a] += delta * (wa * scale);
        position[stick.b] -= delta * (wb * scale);
    }
}

/// Moves particles out of the sphere.
pub fn collide(position: &mut [Vec3], inverse_mass: &[f32]) {
    for (x, &w) in position.iter_mut().zip(inverse_mass) {
        let out = *x - SPHERE_CENTRE;
        let distance_squared = out.length_squared();
        if w > 0.0 && distance_squared < SPHERE_RADIUS * SPHERE_RADIUS {
            *x = SPHERE_CENTRE + out * (SPHERE_RADIUS / distance_squared.sqrt());
        }
    }
}

/// Energy of free particles that moved from `previous` to `position` in `h` seconds, in joules.
pub fn energy(position: &[Vec3], previous: &[Vec3], inverse_mass: &[f32], h: f32) -> f64 {
    let of_one = |((x, old), &w): ((&Vec3, &Vec3), &f32)| {
        let velocity = (*x - *old).as_dvec3() / f64::from(h);
        let above = x.as_dvec3() - DVec3::Y * f64::from(LOWEST);
        let per_mass = 0.5 * velocity.length_squared() - GRAVITY.as_dvec3().dot(above);
        if w > 0.0 { per_mass / f64::from(w) } else { 0.0 }
    };
    position.iter().zip(previous).zip(inverse_mass).map(of_one).sum()
}

impl Contender for Naive {
    fn step(&mut self) {
        integrate(&mut self.position, &mut self.previous, &self.inverse_mass, STEP);
        for _ in 0..self.sweeps {
            relax(&mut self.position, &self.inverse_mass, &self.sticks);
            collide(&mut self.position, &self.inverse_mass);
        }
    }

    fn positions(&self) -> Vec<Vec3> {
        self.position.clone()
    }

    fn energy(&self) -> f64 {
        energy(&self.position, &self.previous, &self.inverse_mass, STEP)
    }

    fn bytes_per_particle(&self) -> f64 {
        28.0 + (size_of::<Stick>() * self.sticks.len()) as f64 / self.position.len() as f64
    }
}
