//! The motion of one free rigid body, which makes an obstacle dynamic.
//!
//! Design: `docs/design/dynamic_obstacles.md`.

use glam::{BVec3, Vec3};

use crate::error::{BuildError, finite_vector, positive};
use crate::geometry::pose::{Placement, Pose, turn_between, turned};
use crate::state::obstacle_motion::Reaction;

/// A rigid body between two steps. The origin of its [`Placement`] is its centre of mass; the axes of the placement are
/// its principal axes.
///
/// ```
/// use drape_solver::{Environment, Island, Obstacle, Placement, RigidBody, Shape, step};
/// use drape_solver::glam::Vec3;
///
/// let shape_of_2_kg = Obstacle::new(Shape::Cuboid { half_extents: Vec3::splat(0.2) }, Placement::default(), 0.5)?;
/// let mut body = RigidBody::new(2.0, Vec3::splat(0.05))?;
/// let mut environment = Environment::default();
/// let index = environment.obstacles.push(shape_of_2_kg.reporting_reaction());
/// let mut island = Island::default();
/// for _ in 0..10 {
///     body.accelerate(environment.gravity, environment.dt);
///     let next = body.advance(environment.obstacles[index].placement(), environment.dt);
///     environment.obstacles[index].move_to(next, environment.dt);
///     step(&mut island, &environment)?;
///     for reaction in &island.reactions {
///         body.receive(reaction, environment.obstacles[reaction.obstacle].placement());
///     }
/// }
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidBody {
    mass: f32,
    moments: Vec3,
    /// 1 for each world axis along which pushes and gravity move it, 0 for those that are locked.
    movable: Vec3,
    /// The same for turns about the axes.
    turnable: Vec3,
    /// Velocity of the centre of mass in m/s.
    pub velocity: Vec3,
    /// Angular velocity in rad/s, in world axes.
    pub angular_velocity: Vec3,
}

impl RigidBody {
    /// A body at rest, of `mass` kilograms and with these principal moments of inertia (kg m^2).
    ///
    /// # Errors
    /// [`BuildError`] if one of them is not positive.
    pub fn new(mass: f32, moments: Vec3) -> Result<Self, BuildError> {
        positive("mass", mass)?;
        finite_vector("inertia", moments)?;
        positive("inertia", moments.min_element())?;
        Ok(Self {
            mass,
            moments,
            movable: Vec3::ONE,
            turnable: Vec3::ONE,
            velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
        })
    }

    /// Returns the body with world axes locked: no push and no gravity moves it along those of `translation`, and no push turns it
    /// about those of `rotation`. A velocity along them stays.
    #[must_use]
    pub fn with_locked_axes(self, translation: BVec3, rotation: BVec3) -> Self {
        let free = |locked| Vec3::select(locked, Vec3::ZERO, Vec3::ONE);
        Self { movable: free(translation), turnable: free(rotation), ..self }
    }

    /// Mass in kilograms.
    pub fn mass(&self) -> f32 {
        self.mass
    }

    /// Accelerates the body by `acceleration` (m/s^2) for `dt` seconds, but not along locked axes.
    pub fn accelerate(&mut self, acceleration: Vec3, dt: f32) {
        self.velocity += acceleration * dt * self.movable;
    }

    /// Moves the body for `dt` seconds free of forces and returns its placement; linear momentum stays, and angular
    /// momentum if no turn is locked.
    pub fn advance(&mut self, from: Placement, dt: f32) -> Placement {
        let momentum = self.angular_momentum(from);
        let mut to = Placement { translation: from.translation + self.velocity * dt, ..from };
        if momentum != Vec3::ZERO {
            // One turn is exact for small angles only.
            for _ in 0..TURNS {
                to.rotation = turned(to.rotation, self.angular_velocity * (dt / TURNS as f32));
                self.keep_angular_momentum(momentum, to);
            }
        }
        to
    }

    /// Sets the velocities to those from which `drive`, which is returned, leads the body from one placement to
    /// another and to these final velocities within `dt` seconds: the parabola through both ends.
    ///
    /// ```text
    /// place   from ----.__          velocity   2 way / dt - v  \
    ///                     `-._                                   `--- v     acceleration   2 (v - way / dt) / dt
    ///                         `to
    /// ```
    pub(crate) fn lead(&mut self, from: Placement, to: Placement, dt: f32) -> Drive {
        let way = (to.translation - from.translation) / dt;
        let turn = turn_between(from.rotation, to.rotation) / dt;
        let linear = (self.velocity - way) * (2.0 / dt);
        let start = 2.0 * way - self.velocity;
        let is_stop = linear.length() > STOP && start.dot(linear) < 0.0;
        let drive = Drive::Engine {
            linear,
            angular: (self.angular_velocity - turn) * (2.0 / dt),
            stop_at: is_stop.then_some(self.velocity),
        };
        self.velocity = start;
        self.angular_velocity = 2.0 * turn - self.angular_velocity;
        drive
    }

    /// Moves the body for `dt` seconds under a drive, and returns its placement. What touches nothing arrives at the same place,
    /// whatever the number of parts that a step is taken in.
    pub(crate) fn advance_under(&mut self, drive: Drive, from: Placement, dt: f32) -> Placement {
        match drive {
            Drive::Gravity(acceleration) => {
                self.accelerate(acceleration, 0.5 * dt);
                let to = self.advance(from, dt);
                self.accelerate(acceleration, 0.5 * dt);
                to
            }
            Drive::Engine { linear, angular, stop_at } => {
                let left = stop_at.map_or(dt, |end| self.seconds_to(end, linear).clamp(0.0, dt));
                self.advance_driven(linear * (left / dt), angular, from, dt)
            }
        }
    }

    /// The time in seconds in which an acceleration brings its own part of the velocity to that of `end`.
    fn seconds_to(&self, end: Vec3, acceleration: Vec3) -> f32 {
        (end - self.velocity).dot(acceleration) / acceleration.length_squared()
    }

    fn advance_driven(&mut self, linear: Vec3, angular: Vec3, from: Placement, dt: f32) -> Placement {
        let before = *self;
        self.velocity += linear * dt;
        self.angular_velocity += angular * dt;
        let turn = (before.angular_velocity + self.angular_velocity) * (0.5 * dt);
        let mut to = from;
        to.translation += (before.velocity + self.velocity) * (0.5 * dt);
        // A turn by nothing rounds the quaternion, and a body at rest would wake what lies on it.
        if turn != Vec3::ZERO {
            to.rotation = turned(from.rotation, turn);
        }
        to
    }

    /// Applies the reaction of a step that ended with the body at `placement`.
    pub fn receive(&mut self, reaction: &Reaction, placement: Placement) {
        self.push(reaction.impulse, reaction.angular_impulse, placement);
    }

    /// Applies an impulse (newton seconds) at the centre of mass, and an angular impulse (newton metre seconds) about
    /// it.
    pub fn push(&mut self, impulse: Vec3, angular_impulse: Vec3, placement: Placement) {
        self.velocity += impulse / self.mass * self.movable;
        self.angular_velocity += self.turn_by(placement, angular_impulse);
    }

    /// Effective inverse mass in 1/kg of the point at `arm` (metres) from the centre, against a push along the unit
    /// vector `direction`.
    pub(crate) fn inverse_mass_at(&self, placement: Placement, arm: Vec3, direction: Vec3) -> f32 {
        let lever = arm.cross(direction);
        // Exactly 0 if all axes are locked, and 1 if none is.
        let along_free =
            if self.movable == Vec3::ONE { 1.0 } else { (direction * self.movable).length_squared() };
        self.mass.recip() * along_free + lever.dot(self.turn_by(placement, lever))
    }

    /// Upper bound of the effective inverse mass of the point at `arm` over all directions: exact where no axis is locked.
    pub(crate) fn greatest_inverse_mass_at(&self, placement: Placement, arm: Vec3) -> f32 {
        let [x, y, z] = Vec3::AXES.map(|axis| self.turn_by(placement, arm.cross(axis)).cross(arm));
        // The matrix with these columns has the eigenvalue 0 along the arm; the others follow from trace and norm.
        let trace = x.x + y.y + z.z;
        let norm_squared = x.length_squared() + y.length_squared() + z.length_squared();
        let difference = (2.0 * norm_squared - trace * trace).max(0.0).sqrt();
        self.mass.recip() * self.movable.max_element() + 0.5 * (trace + difference)
    }

    /// Adapts the angular velocity to a turn from one placement to another, which keeps the angular momentum.
    pub(crate) fn turn_to(&mut self, from: Placement, to: Placement) {
        self.keep_angular_momentum(self.angular_momentum(from), to);
    }

    /// Sets the angular velocity to that of `momentum` at a placement. A body that is locked hands momentum on to what
    /// locks it, and keeps its angular velocity.
    fn keep_angular_momentum(&mut self, momentum: Vec3, placement: Placement) {
        if self.turnable == Vec3::ONE {
            self.angular_velocity = self.scaled(placement, momentum, self.moments.recip());
        }
    }

    /// Angular momentum about its centre of mass, in kg m^2/s.
    pub fn angular_momentum(&self, placement: Placement) -> Vec3 {
        self.scaled(placement, self.angular_velocity, self.moments)
    }

    /// Kinetic energy in joules.
    pub fn kinetic_energy(&self, placement: Placement) -> f32 {
        let turning = self.angular_velocity.dot(self.angular_momentum(placement));
        0.5 * (self.mass * self.velocity.length_squared() + turning)
    }

    /// Change of the angular velocity by an angular impulse.
    fn turn_by(&self, placement: Placement, angular_impulse: Vec3) -> Vec3 {
        self.scaled(placement, angular_impulse * self.turnable, self.moments.recip()) * self.turnable
    }

    /// A world vector, scaled along the principal axes.
    fn scaled(&self, placement: Placement, vector: Vec3, by: Vec3) -> Vec3 {
        let pose = Pose::at(&placement, placement.translation);
        pose.direction_to_world(pose.to_local(vector) * by)
    }
}

/// The source of a body's acceleration on its way through a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Drive {
    /// Gravity, in m/s^2.
    Gravity(Vec3),
    /// Another engine, with all that acts on the body but contacts of cloth, ropes and balls.
    Engine {
        /// In m/s^2.
        linear: Vec3,
        /// In rad/s^2, in world axes.
        angular: Vec3,
        /// The velocity in m/s at which something in the engine stops the body, such as the ground. That pushes no longer once
        /// cloth has slowed the body down as far.
        stop_at: Option<Vec3>,
    },
}

/// An engine that slows a body down by more, in m/s^2, stops it on something.
const STOP: f32 = 100.0;

/// The number of small turns in a step.
const TURNS: u32 = 16;
