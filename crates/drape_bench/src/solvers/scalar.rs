//! The scalar code that the naive and the coloured loop share: arrays of vectors, and one stick at a time.

use drape_solver::glam::{DVec3, Vec3};

use crate::scenes::model::Model;
use crate::scenes::scene::Scene;
use crate::scenes::world::{GRAVITY, LOWEST, SPHERE_CENTRE, SPHERE_RADIUS};

/// A stick as in the paper.
#[derive(Clone, Copy)]
struct Stick {
    a: usize,
    b: usize,
    rest: f32,
}

/// Current and previous positions of the particles of one body.
pub struct Points {
    position: Vec<Vec3>,
    previous: Vec<Vec3>,
}

/// Equal bodies: each has its own points, all share masses and sticks.
pub struct Scalar {
    /// The bodies' points.
    pub bodies: Vec<Points>,
    /// Masses and sticks, which all bodies share.
    pub frame: Frame,
}

/// Masses and sticks of a body.
pub struct Frame {
    inverse_mass: Vec<f32>,
    sticks: Vec<Stick>,
}

impl Scalar {
    /// The bodies of `scene`, their sticks in the order of `pairs`.
    pub fn new(scene: &Scene, pairs: &[[u32; 2]]) -> Self {
        let model: &Model = &scene.model;
        let stick = |&pair: &[u32; 2]| {
            let [a, b] = pair.map(|end| end as usize);
            Stick { a, b, rest: model.rest_length(pair) }
        };
        let points = |_| Points { position: model.positions.clone(), previous: model.positions.clone() };
        Self {
            bodies: (0..scene.bodies).map(points).collect(),
            frame: Frame { inverse_mass: model.inverse_masses(), sticks: pairs.iter().map(stick).collect() },
        }
    }

    /// Positions of all bodies.
    pub fn positions(&self) -> Vec<Vec3> {
        self.bodies.iter().flat_map(|points| points.position.iter().copied()).collect()
    }

    /// Energy of all free particles, if they moved from `previous` to `position` in `h` seconds, in joules.
    pub fn energy(&self, h: f32) -> f64 {
        self.bodies.iter().map(|points| points.energy(&self.frame, h)).sum()
    }

    /// Memory per particle, the shared masses and sticks counted once, in bytes.
    pub fn bytes_per_particle(&self) -> f64 {
        let Frame { inverse_mass, sticks } = &self.frame;
        let particles = inverse_mass.len() * self.bodies.len();
        let bytes =
            particles * 2 * size_of::<Vec3>() + size_of_val(&inverse_mass[..]) + size_of_val(&sticks[..]);
        bytes as f64 / particles as f64
    }
}

impl Points {
    /// One Verlet step of `h` seconds.
    pub fn integrate(&mut self, frame: &Frame, h: f32) {
        for ((x, old), &w) in self.position.iter_mut().zip(&mut self.previous).zip(&frame.inverse_mass) {
            if w > 0.0 {
                let next = *x + (*x - *old) + GRAVITY * (h * h);
                *old = *x;
                *x = next;
            }
        }
    }

    /// Brings each stick to its rest length, one after another.
    pub fn relax(&mut self, frame: &Frame) {
        let Self { position, .. } = self;
        for stick in &frame.sticks {
            let (wa, wb) = (frame.inverse_mass[stick.a], frame.inverse_mass[stick.b]);
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
    pub fn collide(&mut self, frame: &Frame) {
        for (x, &w) in self.position.iter_mut().zip(&frame.inverse_mass) {
            let out = *x - SPHERE_CENTRE;
            let distance_squared = out.length_squared();
            if w > 0.0 && distance_squared < SPHERE_RADIUS * SPHERE_RADIUS {
                *x = SPHERE_CENTRE + out * (SPHERE_RADIUS / distance_squared.sqrt());
            }
        }
    }

    fn energy(&self, frame: &Frame, h: f32) -> f64 {
        let of_one = |((x, old), &w): ((&Vec3, &Vec3), &f32)| {
            let velocity = (*x - *old).as_dvec3() / f64::from(h);
            let above = x.as_dvec3() - DVec3::Y * f64::from(LOWEST);
            let per_mass = 0.5 * velocity.length_squared() - GRAVITY.as_dvec3().dot(above);
            if w > 0.0 { per_mass / f64::from(w) } else { 0.0 }
        };
        self.position.iter().zip(&self.previous).zip(&frame.inverse_mass).map(of_one).sum()
    }
}
