//! Collision detection of balls against a cloth, by five methods: what Table 1 of the founding paper compares.
//!
//! All are asked the same two questions about the same states. At the start of a step: which faces could a ball meet
//! within it ([`Method::begin_step`])? In each substep: which faces does it overlap now, where, along which normal and
//! how deep ([`Method::find`])? All may rely on the same knowledge, which the solver has from a look at all particles
//! that it takes anyway: the box around the cloth, and how far a particle or a ball can move in the step.
//!
//! | module | method |
//! |---|---|
//! | [`ours`] | the code that the solver runs |
//! | [`feature`] | a closest-feature query for each candidate pair |
//! | [`uniform_grid`] | spatial decomposition |
//! | [`object_space`] | a bounding-volume tree of the cloth |
//! | [`sweep_and_prune`] | sweep and prune, then GJK with cached separating axes, as in SOLID 2.0 |
//! | [`brute_force`] | every face, in double precision: the judge of the others |

pub mod brute_force;
pub mod closest_feature;
pub mod feature;
pub mod object_space;
pub mod ours;
pub mod sweep_and_prune;
pub mod uniform_grid;

use drape_solver::glam::{Vec3, Vec3A};
use drape_solver::{Body, Environment, Island};

/// A ball, relative to the origin of the cloth.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    /// Its centre, in metres.
    pub centre: Vec3,
    /// Distance of centre and face at which they touch: radius and thickness, in metres.
    pub apart: f32,
    /// How far from its centre at the start of the step its surface can get within it, in metres.
    pub reach: f32,
}

/// The state of a cloth and of the balls around it, at one moment.
pub struct State {
    /// What the solver steps: one body, and balls.
    pub island: Island,
    /// The step, without obstacles: only contacts of balls with cloth are looked for.
    pub environment: Environment,
    /// Particles relative to the origin of the cloth, in metres; each fills a vector register.
    pub positions: Vec<Vec3A>,
    /// The cloth's faces, by particles.
    pub faces: Vec<[u32; 3]>,
    /// The balls, in the order of the island.
    pub balls: Vec<Sphere>,
    /// Least and greatest corner of the box around the cloth at the start of the step.
    pub bounds: [Vec3; 2],
    /// How far a particle can move within the step, in metres.
    pub motion: f32,
}

/// A ball and a face that overlap, by their numbers.
pub type Pair = (u32, u32);

/// A way to find the contacts of balls with a cloth.
pub trait Method {
    /// What it is called.
    fn name(&self) -> &'static str;
    /// Broad phase, at the start of a step.
    fn begin_step(&mut self, state: &mut State);
    /// Narrow phase, in a substep: keeps all contacts, with weights, normal and depth. Gives the number of faces that
    /// were asked for their nearest point.
    fn find(&mut self, state: &mut State) -> usize;
    /// The contacts that were found last.
    fn pairs(&self, state: &State) -> Vec<Pair>;
}

/// What every method tells about a contact.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Ball and face.
    pub pair: Pair,
    /// Weights of the face's corners in the nearest point.
    pub weights: [f32; 3],
    /// Unit vector from the nearest point to the ball's centre.
    pub normal: Vec3,
    /// How deep they overlap, in metres.
    pub depth: f32,
}

/// The methods, ours first.
pub fn all() -> Vec<Box<dyn Method>> {
    vec![
        Box::new(ours::Ours::default()),
        Box::new(feature::FeatureBased::default()),
        Box::new(uniform_grid::UniformGrid::default()),
        Box::new(object_space::ObjectSpace::default()),
        Box::new(sweep_and_prune::SweepAndPrune::default()),
    ]
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

    /// Whether the boxes of a face and of the space from `low` to `high` touch.
    #[inline(always)]
    pub fn is_within(&self, face: u32, low: Vec3A, high: Vec3A) -> bool {
        let [a, b, c] = self.corners(face);
        !(a.min(b).min(c).cmpgt(high) | a.max(b).max(c).cmplt(low)).any()
    }

    /// Takes over where all is at the start of a step, and what is known about the step.
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

    /// Takes over where all is now.
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

    /// Balls, by number, that can meet the box around the cloth in this step.
    pub fn near_balls(&self) -> impl Iterator<Item = (u32, &Sphere)> {
        let [low, high] = self.bounds;
        let is_near = move |(_, ball): &(u32, &Sphere)| {
            let reach = Vec3::splat(ball.reach + self.motion);
            (ball.centre + reach).cmpge(low).all() && (ball.centre - reach).cmple(high).all()
        };
        (0..).zip(&self.balls).filter(is_near)
    }
}
