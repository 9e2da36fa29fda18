//! A game of two players, who push a curtain and a rope about with spheres and fire balls at them.

use std::error::Error;

use drape_solver::glam::Vec3;
use drape_solver::{
    Ball, BallId, BallMaterial, BodyId, BodySettings, ClothBuilder, Edge, Obstacle, ObstacleId, Placement,
    RopeBuilder, SelfContact, Shape, StateHasher, World,
};

/// What a player does in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Input {
    /// Where the player's sphere is driven, in hundredths of a metre for each step.
    pub drive: [i8; 3],
    /// Fires the player's ball.
    pub fire: bool,
}

impl Input {
    pub const BYTES: usize = 4;

    /// What `player` does in a step: as random as a child with a joystick.
    pub fn of(player: usize, step: u32) -> Self {
        // Each push lasts a quarter of a second.
        let mut seed = u64::from(step / 15) << 1 | player as u64;
        let mut next = || {
            // SplitMix64 (Steele, Lea and Flood 2014).
            seed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mixed = (seed ^ (seed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            (mixed >> 32) % 5
        };
        let drive = [(); 3].map(|()| next() as i8 - 2);
        Self { drive, fire: step.is_multiple_of(15) && next() == 0 }
    }

    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let [x, y, z] = self.drive.map(i8::cast_unsigned);
        [x, y, z, u8::from(self.fire)]
    }

    pub fn from_bytes([x, y, z, fire]: [u8; Self::BYTES]) -> Self {
        Self { drive: [x, y, z].map(u8::cast_signed), fire: fire != 0 }
    }
}

/// The world, and what in it belongs to whom.
pub struct Game {
    world: World,
    bodies: [(&'static str, BodyId); 2],
    balls: [(&'static str, BallId); 2],
    spheres: [ObstacleId; 2],
}

impl Game {
    pub fn new() -> Result<Self, Box<dyn Error>> {
        let mut world = World::new();
        world.add_obstacle(Obstacle::ground());
        let settings = BodySettings { self_contact: SelfContact::On, ..BodySettings::default() };
        let curtain = ClothBuilder::new(1.5, 1.5, 16, 16)
            .placed(Vec3::new(-0.75, 2.0, 0.0), Vec3::X, Vec3::NEG_Y)
            .pin_edge(Edge::Top)
            .build(settings)?;
        let ends = [Vec3::new(-0.5, 2.0, 0.4), Vec3::new(0.5, 2.0, 0.4)];
        let rope = RopeBuilder::new(ends[0], ends[1], 24).pin_start().build(settings)?;
        let bodies = [("curtain", world.add_body(curtain)), ("rope", world.add_body(rope))];
        let mut add_ball = |name, x: f32| -> Result<_, Box<dyn Error>> {
            let ball = Ball::new(BallMaterial::default(), Vec3::new(x, 0.5, 1.5), Vec3::ZERO)?;
            Ok((name, world.add_ball(ball)))
        };
        let balls = [add_ball("first ball", -1.0)?, add_ball("second ball", 1.0)?];
        let mut add_sphere = |x: f32| -> Result<_, Box<dyn Error>> {
            let place = Placement::at(Vec3::new(x, 1.0, 0.5));
            Ok(world.add_obstacle(Obstacle::new(Shape::Sphere { radius: 0.2 }, place, 0.5)?))
        };
        let spheres = [add_sphere(-0.4)?, add_sphere(0.4)?];
        Ok(Self { world, bodies, balls, spheres })
    }

    /// Takes a step in which each player does something.
    pub fn step(&mut self, inputs: [Input; 2]) -> Result<(), Box<dyn Error>> {
        let dt = self.world.dt;
        for (player, input) in inputs.into_iter().enumerate() {
            if let Some(sphere) = self.world.obstacle_mut(self.spheres[player]) {
                let drive = input.drive.map(|drive| 0.01 * f32::from(drive));
                let place = sphere.placement().translation + Vec3::from_array(drive);
                let place = place.clamp(Vec3::new(-1.0, 0.3, -0.8), Vec3::new(1.0, 1.8, 0.8));
                sphere.move_to(Placement::at(place), dt);
            }
            let (_, ball) = self.balls[player];
            if input.fire
                && let Some(ball) = self.world.ball_mut(ball)
            {
                ball.set_position(Vec3::new(0.4 * player as f32 - 0.2, 1.3, 2.0));
                ball.set_velocity(Vec3::new(0.0, 1.0, -9.0));
            }
        }
        self.world.step()?;
        Ok(())
    }

    /// Changes the last bit of the height of a particle of the curtain.
    pub fn disturb(&mut self, particle: usize) {
        let (_, curtain) = self.bodies[0];
        if let Some(curtain) = self.world.body_mut(curtain) {
            let place = curtain.particles.position(particle);
            curtain.particles.set_position(particle, place.with_y(place.y.next_up()));
        }
    }

    /// The hash of everything.
    pub fn hash(&self) -> u64 {
        let mut hasher = StateHasher::new();
        for (_, body) in self.bodies {
            hasher.particles(&self.world[body].particles);
        }
        for (_, ball) in self.balls {
            hasher.ball(&self.world[ball]);
        }
        hasher.finish()
    }

    /// The name and the hash of each body and ball.
    pub fn hashes(&self) -> impl Iterator<Item = (&'static str, u64)> + '_ {
        let body = |(name, id): (_, BodyId)| {
            (name, StateHasher::new().particles(&self.world[id].particles).finish())
        };
        let ball = |(name, id): (_, BallId)| (name, StateHasher::new().ball(&self.world[id]).finish());
        self.bodies.into_iter().map(body).chain(self.balls.into_iter().map(ball))
    }

    /// The places in metres of the particles of a body or ball, in the order of [`hashes`](Self::hashes).
    pub fn places(&self, member: usize) -> Vec<Vec3> {
        match self.bodies.get(member) {
            Some(&(_, body)) => self.world[body].particles.positions().collect(),
            None => vec![self.world[self.balls[member - self.bodies.len()].1].position()],
        }
    }
}
