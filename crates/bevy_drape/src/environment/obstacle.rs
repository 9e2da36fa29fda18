//! Obstacles, which cloth and balls collide with.

use bevy::prelude::*;
pub use drape_solver::CombineRule;
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::{BuildError, Layers, Placement, Shape};

use crate::environment::obstacle_shape::ObstacleShape;

/// A solid that cloth, ropes and balls collide with. Nothing pushes it back unless it is a
/// [`DynamicObstacle`](crate::environment::dynamic_obstacle::DynamicObstacle). Its [`Transform`] gives place and scale.
/// Moving it carries its velocity into contacts.
///
/// A move faster than 1500 m/s counts as a teleport and carries no velocity, and so does any move with
/// [`TeleportObstacle`].
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default, Debug, Clone)]
#[require(Transform)]
pub struct Obstacle {
    /// Shape in the entity's coordinates.
    pub shape: ObstacleShape,
    /// Coulomb friction coefficient, 0 or more.
    pub friction: f32,
    /// Coefficient of static friction, which holds until sliding begins; at least `friction` counts.
    pub static_friction: f32,
    /// The rule by which these two and those of what touches it become one; the mean unless set otherwise.
    pub friction_rule: CombineRule,
    /// Coefficient of restitution against balls: 0 (no bounce) to 1.
    pub restitution: f32,
    /// The rule by which this and the ball's become one.
    pub restitution_rule: CombineRule,
    /// True for a sensor, which moves nothing and only reports contacts: see [`as_sensor`](Self::as_sensor).
    pub is_sensor: bool,
}

impl Default for Obstacle {
    /// A box with sides of one metre.
    fn default() -> Self {
        Self::new(ObstacleShape::default())
    }
}

impl Obstacle {
    /// An obstacle of `shape` with friction 0.5. The next step checks sizes: invalid obstacles are logged and left out.
    pub fn new(shape: impl Into<ObstacleShape>) -> Self {
        Self {
            shape: shape.into(),
            friction: 0.5,
            static_friction: 0.0,
            friction_rule: CombineRule::Average,
            restitution: 0.0,
            restitution_rule: CombineRule::Average,
            is_sensor: false,
        }
    }

    /// The half-space below the entity.
    pub fn ground() -> Self {
        Self::new(ObstacleShape::HalfSpace { normal: Vec3::Y })
    }

    /// A sphere of `radius` metres.
    pub fn sphere(radius: f32) -> Self {
        Self::new(ObstacleShape::Sphere { radius })
    }

    /// A capsule along the entity's Y axis: all points within `radius` metres of a segment of `length` metres.
    pub fn capsule(radius: f32, length: f32) -> Self {
        Self::new(ObstacleShape::Capsule { radius, length })
    }

    /// A tapered capsule along the entity's Y axis: the convex hull of two balls with these radii, the bottom one below, and `length`
    /// between their centres, all in metres.
    pub fn tapered_capsule(bottom_radius: f32, top_radius: f32, length: f32) -> Self {
        Self::new(ObstacleShape::TaperedCapsule { bottom_radius, top_radius, length })
    }

    /// A box with sides of `x`, `y` and `z` metres.
    pub fn cuboid(x: f32, y: f32, z: f32) -> Self {
        Self::new(ObstacleShape::Cuboid { size: Vec3::new(x, y, z) })
    }

    /// A cylinder along the entity's Y axis, of `radius` and `height` metres.
    pub fn cylinder(radius: f32, height: f32) -> Self {
        Self::new(ObstacleShape::Cylinder { radius, height })
    }

    /// A cone along the entity's Y axis with its tip up, of `radius` and `height` metres.
    pub fn cone(radius: f32, height: f32) -> Self {
        Self::new(ObstacleShape::Cone { radius, height })
    }

    /// The inside of a box with sides of `x`, `y` and `z` metres. Nothing leaves it.
    pub fn container(x: f32, y: f32, z: f32) -> Self {
        Self::new(ObstacleShape::Container { size: Vec3::new(x, y, z) })
    }

    /// The triangles of the entity's [`Mesh3d`]: the obstacle is there once the mesh has loaded, and follows its changes. The
    /// inside of a closed mesh is solid; an open mesh is a thin sheet.
    #[cfg(feature = "mesh")]
    pub fn trimesh() -> Self {
        Self::new(ObstacleShape::TriMesh)
    }

    /// The convex hull of the entity's [`Mesh3d`]: cheaper than [`trimesh`](Self::trimesh), and always solid.
    #[cfg(feature = "mesh")]
    pub fn convex_hull() -> Self {
        Self::new(ObstacleShape::ConvexHull)
    }

    /// Makes it a sensor, which moves nothing. Contacts are reported if it or the other entity has
    /// [`ContactEvents`](crate::body::contact_events::ContactEvents).
    pub fn as_sensor(mut self) -> Self {
        self.is_sensor = true;
        self
    }

    /// Sets the friction coefficient.
    pub fn with_friction(mut self, friction: f32) -> Self {
        self.friction = friction;
        self
    }

    /// Sets the coefficient of static friction.
    pub fn with_static_friction(mut self, static_friction: f32) -> Self {
        self.static_friction = static_friction;
        self
    }

    /// Sets the coefficient of restitution.
    pub fn with_restitution(mut self, restitution: f32) -> Self {
        self.restitution = restitution;
        self
    }
}

/// Marks an [`Obstacle`] whose [`Transform`] was set to another place: its next move carries no velocity into contacts.
/// The next step removes the mark.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// use bevy_drape::environment::TeleportObstacle;
///
/// fn open(mut commands: Commands, door: Single<Entity, With<Obstacle>>) {
///     commands.entity(*door).insert((Transform::from_xyz(3.0, 0.0, 0.0), TeleportObstacle));
/// }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Debug, Clone)]
pub struct TeleportObstacle;

impl From<SharedShape> for Obstacle {
    fn from(shape: SharedShape) -> Self {
        Self::new(shape)
    }
}

/// Builds the solver's obstacle of an unscaled `shape`. The flags turn on reports of contacts and of reactions.
pub(crate) fn built(
    obstacle: &Obstacle,
    shape: &Shape,
    scale: Vec3,
    placement: Placement,
    layers: Layers,
    [reports_contacts, reports_reaction]: [bool; 2],
) -> Result<drape_solver::Obstacle, BuildError> {
    let shape = shape.scaled(without_rounding(scale))?;
    let built = drape_solver::Obstacle::new(shape, placement, obstacle.friction)?
        .with_static_friction(obstacle.static_friction)?
        .with_restitution(obstacle.restitution)?
        .with_combine_rules(obstacle.friction_rule, obstacle.restitution_rule)
        .with_layers(layers);
    let built = if obstacle.is_sensor { built.as_sensor() } else { built };
    let built = if reports_contacts { built.reporting_contacts() } else { built };
    Ok(if reports_reaction { built.reporting_reaction() } else { built })
}

/// The scale without the rounding of a rotation that has been in a matrix: an uneven scale would make a hull with corners of a round shape.
fn without_rounding(scale: Vec3) -> Vec3 {
    let is_near = |one: f32, other: f32| (one - other).abs() <= ROUNDED_SCALE * other.abs();
    let scale = Vec3::from_array(scale.to_array().map(|part| if is_near(part, 1.0) { 1.0 } else { part }));
    let is_even = is_near(scale.y, scale.x) && is_near(scale.z, scale.x);
    if is_even { Vec3::splat(scale.x) } else { scale }
}

/// Part of a scale that may be rounding.
const ROUNDED_SCALE: f32 = 1e-5;
