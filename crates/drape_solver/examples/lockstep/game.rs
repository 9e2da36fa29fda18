//! A game of two players, who push a curtain and a rope about with spheres and fire balls at them.

use std::error::Error;

use drape_solver::glam::Vec3;
use drape_solver::{
    Ball, BallId, BallMaterial, BodyId, BodySettings, ClothBuilder, Edge, Obstacle, ObstacleId, Placement,
    RopeBuilder, SelfContact, Shape, StateHasher, World,
};

/// The moves of a player in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Input {
    /// The way of the player's sphere in hundredths of a metre.
    pub drive: [i8; 3],
    /// Fires the player's ball.
    pub fire: bool,
}

impl Input {
    /// Length of a message about it.
    pub const BYTES: usize = 4;

    /// The random moves of `player` in a step.
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

    /// A message about it.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let [x, y, z] = self.drive.map(i8::cast_unsigned);
        [x, y, z, u8::from(self.fire)]
    }

    /// Reads a message.
    pub fn from_bytes([x, y, z, fire]: [u8; Self::BYTES]) -> Self {
        Self { drive: [x, y, z].map(u8::cast_signed), fire: fire != 0 }
    }
}

/// The world, and the names of what is in it.
pub struct Game {
    /// The world.
    pub world: World,
    bodies: [(&'static str, BodyId); 2],
    /// The balls of the players.
    pub balls: [(&'static str, BallId); 2],
    spheres: [(&'static str, ObstacleId); 2],
}

impl Game {
    /// The game before its first step.
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
        let mut add_sphere = |name, x: f32| -> Result<_, Box<dyn Error>> {
            let place = Placement::at(Vec3::new(x, 1.0, 0.5));
            Ok((name, world.add_obstacle(Obstacle::new(Shape::Sphere { radius: 0.2 }, place, 0.5)?)))
        };
        let spheres = [add_sphere("first sphere", -0.4)?, add_sphere("second sphere", 0.4)?];
        Ok(Self { world, bodies, balls, spheres })
    }

    /// Takes a step in which each player does something.
    pub fn step(&mut self, inputs: [Input; 2]) -> Result<(), Box<dyn Error>> {
        for (player, input) in inputs.into_iter().enumerate() {
            self.drive(player, input.drive);
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

    /// Moves the sphere of a player by hundredths of a metre, within the next step.
    pub fn drive(&mut self, player: usize, drive: [i8; 3]) {
        let dt = self.world.dt;
        let (_, sphere) = self.spheres[player];
        if let Some(sphere) = self.world.obstacle_mut(sphere) {
            let way = Vec3::from_array(drive.map(|drive| 0.01 * f32::from(drive)));
            let place = sphere.placement().translation + way;
            let place = place.clamp(Vec3::new(-1.0, 0.3, -0.8), Vec3::new(1.0, 1.8, 0.8));
            sphere.move_to(Placement::at(place), dt);
        }
    }

    /// Moves a particle of the curtain by the last bit of its height.
    pub fn disturb(&mut self, particle: usize) {
        let (_, curtain) = self.bodies[0];
        if let Some(curtain) = self.world.body_mut(curtain) {
            let place = curtain.particles.position(particle);
            curtain.particles.set_position(particle, place.with_y(place.y.next_up()));
        }
    }

    /// The hash of all places and motions. What else decides the next bits, such as the time that a body has been at rest,
    /// comes from those.
    pub fn hash(&self) -> u64 {
        // FNV-1a (Fowler, Noll and Vo 1991), eight bytes at a time.
        let join = |all: u64, (_, hash): (_, u64)| (all ^ hash).wrapping_mul(0x0000_0100_0000_01B3);
        self.hashes().fold(0xCBF2_9CE4_8422_2325, join)
    }

    /// The name and the hash of each body, ball and sphere.
    pub fn hashes(&self) -> impl Iterator<Item = (&'static str, u64)> + '_ {
        let body = |(name, id): (_, BodyId)| {
            (name, StateHasher::new().particles(&self.world[id].particles).finish())
        };
        let ball = |(name, id): (_, BallId)| (name, StateHasher::new().ball(&self.world[id]).finish());
        let sphere = |(name, id): (_, ObstacleId)| {
            let place = self.world[id].placement().translation;
            (name, StateHasher::new().numbers(&place.to_array()).finish())
        };
        let bodies = self.bodies.into_iter().map(body);
        bodies.chain(self.balls.into_iter().map(ball)).chain(self.spheres.into_iter().map(sphere))
    }

    /// The places in metres of the particles of a body, or of a ball or sphere, in the order of [`hashes`](Self::hashes).
    pub fn places(&self, member: usize) -> Vec<Vec3> {
        let balls = self.balls.map(|(_, ball)| self.world[ball].position());
        let spheres = self.spheres.map(|(_, sphere)| self.world[sphere].placement().translation);
        match self.bodies.get(member) {
            Some(&(_, body)) => self.world[body].particles.positions().collect(),
            None => vec![[balls, spheres].concat()[member - self.bodies.len()]],
        }
    }
}
