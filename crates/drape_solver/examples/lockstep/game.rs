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

/// The world, and what is in it.
pub struct Game {
    /// The world.
    pub world: World,
    curtain: BodyId,
    rope: BodyId,
    /// The balls of the players.
    pub balls: [BallId; 2],
    spheres: [ObstacleId; 2],
}

/// Something in the world that moves.
#[derive(Clone, Copy)]
enum Member {
    Body(BodyId),
    Ball(BallId),
    Sphere(ObstacleId),
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
        let [curtain, rope] = [curtain, rope].map(|body| world.add_body(body));
        let mut add_ball = |x: f32| -> Result<_, Box<dyn Error>> {
            let ball = Ball::new(BallMaterial::default(), Vec3::new(x, 0.5, 1.5), Vec3::ZERO)?;
            Ok(world.add_ball(ball))
        };
        let balls = [add_ball(-1.0)?, add_ball(1.0)?];
        let mut add_sphere = |x: f32| -> Result<_, Box<dyn Error>> {
            let place = Placement::at(Vec3::new(x, 1.0, 0.5));
            Ok(world.add_obstacle(Obstacle::new(Shape::Sphere { radius: 0.2 }, place, 0.5)?))
        };
        let spheres = [add_sphere(-0.4)?, add_sphere(0.4)?];
        Ok(Self { world, curtain, rope, balls, spheres })
    }

    /// Takes a step in which each player does something.
    pub fn step(&mut self, inputs: [Input; 2]) -> Result<(), Box<dyn Error>> {
        for (player, input) in inputs.into_iter().enumerate() {
            self.drive(player, input.drive);
            if input.fire
                && let Some(ball) = self.world.ball_mut(self.balls[player])
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
        if let Some(sphere) = self.world.obstacle_mut(self.spheres[player]) {
            let way = Vec3::from_array(drive.map(|drive| 0.01 * f32::from(drive)));
            let place = sphere.placement().translation + way;
            let place = place.clamp(Vec3::new(-1.0, 0.3, -0.8), Vec3::new(1.0, 1.8, 0.8));
            sphere.move_to(Placement::at(place), dt);
        }
    }

    /// Moves a particle of the curtain by the last bit of its height.
    pub fn disturb(&mut self, particle: usize) {
        if let Some(curtain) = self.world.body_mut(self.curtain) {
            let place = curtain.particles.position(particle);
            curtain.particles.set_position(particle, place.with_y(place.y.next_up()));
        }
    }

    /// The names of all that moves.
    fn members(&self) -> [(&'static str, Member); 6] {
        [
            ("curtain", Member::Body(self.curtain)),
            ("rope", Member::Body(self.rope)),
            ("first ball", Member::Ball(self.balls[0])),
            ("second ball", Member::Ball(self.balls[1])),
            ("first sphere", Member::Sphere(self.spheres[0])),
            ("second sphere", Member::Sphere(self.spheres[1])),
        ]
    }

    fn hash_member(&self, member: Member, hasher: &mut StateHasher) {
        match member {
            Member::Body(body) => hasher.particles(&self.world[body].particles),
            Member::Ball(ball) => hasher.ball(&self.world[ball]),
            Member::Sphere(sphere) => hasher.numbers(&self.world[sphere].placement().translation.to_array()),
        };
    }

    /// The hash of all places and motions. What else decides the next bits, such as the time that a body has been at rest,
    /// comes from those.
    pub fn hash(&self) -> u64 {
        let mut hasher = StateHasher::new();
        for (_, member) in self.members() {
            self.hash_member(member, &mut hasher);
        }
        hasher.finish()
    }

    /// The name and the hash of each body, ball and sphere.
    pub fn hashes(&self) -> impl Iterator<Item = (&'static str, u64)> + '_ {
        self.members().into_iter().map(|(name, member)| {
            let mut hasher = StateHasher::new();
            self.hash_member(member, &mut hasher);
            (name, hasher.finish())
        })
    }

    /// The places in metres of the particles of a body, or of a ball or sphere, in the order of [`hashes`](Self::hashes).
    pub fn places(&self, member: usize) -> Vec<Vec3> {
        let (_, member) = self.members()[member];
        match member {
            Member::Body(body) => self.world[body].particles.positions().collect(),
            Member::Ball(ball) => vec![self.world[ball].position()],
            Member::Sphere(sphere) => vec![self.world[sphere].placement().translation],
        }
    }
}
