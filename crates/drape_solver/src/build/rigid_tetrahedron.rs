//! The builder of rigid bodies from four particles and six sticks (Jakobsen 2001, section 5).
//!
//! ```text
//!      +-----------o          The particles have a quarter of the mass M each, and lie in every other corner of a box of
//!     /|    o     /|          half sides s. M s^2 is the second moment of the mass along that axis, so mass, centre of
//!    o-----------+ |          mass and inertia are those of the body. They carry the corners of its collision mesh.
//!    | +---------|-+
//!    |/          |/
//!    +-----------o
//! ```
//!
//! Design: `docs/design/rigs.md`.

use std::sync::Arc;

use glam::{DMat3, Quat, Vec3};

use crate::build::topology_builder::TopologyBuilder;
use crate::error::{BuildError, finite_vector, positive};
use crate::geometry::pose::{Placement, Pose};
use crate::state::body::Body;
use crate::state::particles::Particles;
use crate::state::settings::BodySettings;
use crate::state::topology::{EmbeddedPoint, StickKind, StickMaterial};

/// A rigid body as a tetrahedron of particles that carries the corners of a convex collision mesh.
#[derive(Clone, Debug)]
pub struct RigidTetrahedronBuilder {
    mass: f32,
    moments: Vec3,
    corners: Vec<Vec3>,
    placement: Placement,
    velocity: Vec3,
    angular_velocity: Vec3,
}

/// Every other corner of a cube.
const CORNERS: [Vec3; 4] = [
    Vec3::new(1.0, 1.0, 1.0),
    Vec3::new(1.0, -1.0, -1.0),
    Vec3::new(-1.0, 1.0, -1.0),
    Vec3::new(-1.0, -1.0, 1.0),
];

/// The six sticks.
const STICKS: [[u32; 2]; 6] = [[0, 1], [2, 3], [0, 2], [1, 3], [0, 3], [1, 2]];

impl RigidTetrahedronBuilder {
    /// A body of `mass` kilograms, with principal moments of inertia (kg m^2) about its centre of mass along the axes of its
    /// placement. It has no corners yet.
    pub fn new(mass: f32, moments: Vec3) -> Self {
        Self {
            mass,
            moments,
            corners: Vec::new(),
            placement: Placement::default(),
            velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
        }
    }

    /// A solid box of even density, with eight corners. Half extents in metres.
    pub fn cuboid(mass: f32, half_extents: Vec3) -> Self {
        let squares = half_extents * half_extents;
        let moments = Vec3::new(squares.y + squares.z, squares.z + squares.x, squares.x + squares.y);
        let side = |bit: usize, i: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let corner = |i| half_extents * Vec3::new(side(0, i), side(1, i), side(2, i));
        Self { corners: (0..8).map(corner).collect(), ..Self::new(mass, moments * (mass / 3.0)) }
    }

    /// Sets the corners of its collision mesh, in metres from its centre of mass along its axes. Corners touch obstacles;
    /// edges and sides do not.
    pub fn corners(mut self, corners: impl IntoIterator<Item = Vec3>) -> Self {
        self.corners = corners.into_iter().collect();
        self
    }

    /// Principal moments of inertia in kg m^2.
    pub fn inertia(&self) -> Vec3 {
        self.moments
    }

    /// The corners of its collision mesh, in metres from its centre of mass.
    pub fn collision_mesh(&self) -> &[Vec3] {
        &self.corners
    }

    /// Sets the place of its centre of mass in the world, and its rotation.
    pub fn placed(mut self, placement: Placement) -> Self {
        self.placement = placement;
        self
    }

    /// Sets the velocity of its centre of mass (m/s) and its angular velocity (rad/s), in world axes.
    pub fn moving(mut self, velocity: Vec3, angular_velocity: Vec3) -> Self {
        (self.velocity, self.angular_velocity) = (velocity, angular_velocity);
        self
    }

    /// The places of the four particles, in metres from the centre of mass along the axes.
    ///
    /// # Errors
    /// [`BuildError`] if no body can have this mass and inertia: each moment must be less than the sum of the others.
    pub fn particles(&self) -> Result<[Vec3; 4], BuildError> {
        positive("mass", self.mass)?;
        finite_vector("inertia", self.moments)?;
        let Vec3 { x, y, z } = self.moments;
        let second = Vec3::new(y + z - x, z + x - y, x + y - z) * (0.5 / self.mass);
        positive("the sum of two moments of inertia less the third", second.min_element())?;
        let half_sides = Vec3::new(second.x.sqrt(), second.y.sqrt(), second.z.sqrt());
        Ok(CORNERS.map(|corner| corner * half_sides))
    }

    /// Builds the body: particles of equal mass, joined by rigid sticks.
    ///
    /// # Errors
    /// [`BuildError`] that names the invalid value.
    pub fn build(self, settings: BodySettings) -> Result<Body, BuildError> {
        settings.validate()?;
        let local = self.particles()?;
        if !self.placement.is_valid() {
            return Err(BuildError::BadShape { reason: "its placement is not finite" });
        }
        finite_vector("velocity", self.velocity)?;
        finite_vector("angular velocity", self.angular_velocity)?;
        let origin = self.placement.translation;
        let pose = Pose::at(&self.placement, Vec3::ZERO);
        let positions = local.map(|place| pose.point_to_world(place));
        let mut particles = Particles::new(origin, &positions, &[4.0 / self.mass; 4])?;
        for (i, place) in local.into_iter().enumerate() {
            let arm = pose.direction_to_world(place);
            particles.set_velocity(i, self.velocity + self.angular_velocity.cross(arm));
        }
        // Rest places are relative to the centre of mass, where rounding is least.
        let mut builder = TopologyBuilder::new(&local);
        builder.family(StickMaterial::rigid(StickKind::Structural), STICKS)?;
        let mut points = Vec::with_capacity(self.corners.len());
        for &corner in &self.corners {
            finite_vector("a corner", corner)?;
            let flat = BuildError::BadShape { reason: "it is too flat to be carried by four particles" };
            points.push(EmbeddedPoint::new([0, 1, 2, 3], local, corner).ok_or(flat)?);
        }
        builder.embedded(points)?.segments(STICKS)?;
        Ok(Body::new(particles, Arc::new(builder.build()?), settings))
    }
}

/// The placement of a rigid body from the places of its four particles: `rest` in its own coordinates, `now` in the world.
/// Takes the nearest rotation (the polar decomposition after Higham 1986) about the middle of the four. None if they lie
/// in a plane. Rounding may depend on the machine: use it to draw a body, not to simulate it.
pub fn placement_of(rest: [Vec3; 4], now: [Vec3; 4]) -> Option<Placement> {
    let middle = |places: [Vec3; 4]| places.into_iter().map(Vec3::as_dvec3).sum::<glam::DVec3>() * 0.25;
    let edges = |places: [Vec3; 4]| {
        let [origin, a, b, c] = places.map(Vec3::as_dvec3);
        DMat3::from_cols(a - origin, b - origin, c - origin)
    };
    let mut turn = edges(now) * edges(rest).inverse();
    for _ in 0..POLAR_ROUNDS {
        turn = (turn + turn.inverse().transpose()) * 0.5;
    }
    let rotation = Quat::from_mat3(&turn.as_mat3()).normalize();
    let translation = (middle(now) - turn * middle(rest)).as_vec3();
    (rotation.is_finite() && translation.is_finite() && turn.determinant() > 0.0)
        .then_some(Placement { translation, rotation })
}

/// The number of iterations. Each squares the error, and particles of a rigid body start with a small one.
const POLAR_ROUNDS: u32 = 5;
