//! The states of cloth and balls in which the methods find contacts.

use drape_solver::glam::{Vec3, Vec3A};
use drape_solver::{Body, Environment, Island};

/// A ball, relative to the origin of the cloth.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    /// Its centre, in metres.
    pub centre: Vec3,
    /// Distance of centre and face at which they touch: radius and thickness, in metres.
    pub apart: f32,
    /// The greatest distance in metres from its centre at the start of the step that its surface can reach within the
    /// step.
    pub reach: f32,
}

/// The state of a cloth and of the balls around it, at one moment.
pub struct State {
    /// The island that the solver steps: one body, and balls.
    pub island: Island,
    /// The environment, without obstacles: only contacts of balls with cloth are compared.
    pub environment: Environment,
    /// Particles relative to the origin of the cloth, in metres; each fills a vector register.
    pub positions: Vec<Vec3A>,
    /// The cloth's faces, by particles.
    pub faces: Vec<[u32; 3]>,
    /// The balls, in the order of the island.
    pub balls: Vec<Sphere>,
    /// Least and greatest corner of the box around the cloth at the start of the step.
    pub bounds: [Vec3; 2],
    /// The greatest motion of a particle within the step, in metres.
    pub motion: f32,
}

impl State {
    /// The state of an island of one body, which is stepped by `dt` seconds under `gravity`.
    pub fn new(island: Island, dt: f32, gravity: Vec3) -> Self {
        let environment = Environment { dt, gravity, ..Environment::default() };
        let faces = island.bodies[0].topology.faces().to_vec();
        Self {
            island,
            environment,
            positions: Vec::new(),
            faces,
            balls: Vec::new(),
            bounds: [Vec3::ZERO; 2],
            motion: 0.0,
        }
    }

    /// The cloth.
    pub fn cloth(&self) -> &Body {
        &self.island.bodies[0]
    }

    /// Corners of a face.
    #[inline(always)]
    pub fn corners(&self, face: u32) -> [Vec3A; 3] {
        self.faces[face as usize].map(|particle| self.positions[particle as usize])
    }

    /// True if the box of a face touches the box from `low` to `high`.
    #[inline(always)]
    pub fn is_within(&self, face: u32, low: Vec3A, high: Vec3A) -> bool {
        let [a, b, c] = self.corners(face);
        !(a.min(b).min(c).cmpgt(high) | a.max(b).max(c).cmplt(low)).any()
    }

    /// Copies the positions at the start of a step, and computes the bounds of motion within it.
    pub fn begin_step(&mut self) {
        self.copy_places();
        let Environment { dt, gravity, .. } = self.environment;
        let gravity = gravity.length();
        let cloth = &self.island.bodies[0];
        let (low, high) = cloth.particles.bounds();
        self.bounds = [low, high].map(|corner| corner - cloth.particles.origin());
        let speeds = self.island.balls.iter().map(|ball| ball.velocity().length());
        self.motion = speeds.fold(cloth.particles.greatest_speed(), f32::max) * dt;
        let thickness = cloth.settings.thickness;
        for (sphere, ball) in self.balls.iter_mut().zip(&self.island.balls) {
            sphere.reach = ball.reach(dt, gravity) + thickness;
        }
    }

    /// Copies the current positions.
    pub fn copy_places(&mut self) {
        let Self { island, positions, balls, .. } = self;
        let cloth = &island.bodies[0];
        positions.clear();
        positions.extend((0..cloth.particles.len()).map(|i| Vec3A::from(cloth.particles.local_position(i))));
        balls.resize(island.balls.len(), Sphere { centre: Vec3::ZERO, apart: 0.0, reach: 0.0 });
        for (sphere, ball) in balls.iter_mut().zip(&island.balls) {
            sphere.centre = ball.position() - cloth.particles.origin();
            sphere.apart = ball.material().radius + cloth.settings.thickness;
        }
    }

    /// The balls that can meet the box around the cloth in this step, with their numbers.
    pub fn near_balls(&self) -> impl Iterator<Item = (u32, &Sphere)> {
        let [low, high] = self.bounds;
        let is_near = move |(_, ball): &(u32, &Sphere)| {
            let reach = Vec3::splat(ball.reach + self.motion);
            (ball.centre + reach).cmpge(low).all() && (ball.centre - reach).cmple(high).all()
        };
        (0..).zip(&self.balls).filter(is_near)
    }
}
