//! Stands an obstacle in for each dynamic body: an entity of its own with the shapes of all its colliders, about its
//! centre of mass.

use bevy::prelude::*;
use bevy_drape::drape_solver::parry3d::shape::SharedShape;
use bevy_drape::drape_solver::{BuildError, Placement, Shape};
use bevy_drape::environment::{DynamicObstacle, MovedByObstacle, ObstacleShape};
use bevy_drape::prelude::*;

use crate::frame::InertialFrame;
use crate::marks::{BodyObstacle, ObstacleOf};

/// A collider of a dynamic body.
#[derive(Clone)]
pub struct Part {
    /// Its entity.
    pub entity: Entity,
    /// Its shape, scaled.
    pub shape: SharedShape,
    /// Its place in the body.
    pub place: Placement,
}

/// Distance in metres from the origin of a shape to its farthest point, or somewhat more.
pub fn reach_of(shape: &SharedShape) -> f32 {
    let sphere = shape.compute_local_bounding_sphere();
    sphere.center.length() + sphere.radius
}

/// A dynamic body, as an engine has it.
#[derive(Clone)]
pub struct BodyParts {
    /// Mass in kilograms.
    pub mass: f32,
    /// Its principal axes.
    pub frame: InertialFrame,
    /// Its place in the world.
    pub place: Placement,
    /// The colliders that cloth touches, at least one.
    pub parts: Vec<Part>,
    /// An obstacle with its friction and restitution, of any shape. Cloth sees one surface and one set of layers for a body.
    pub surface: Obstacle,
    /// Layers.
    pub layers: DrapeLayers,
}

/// On a dynamic body with an obstacle: how far its colliders reach, and if anything that could touch them is near.
#[derive(Component, Clone, Copy, Debug)]
pub struct BodyReach {
    /// Radius in metres of a sphere about the body's origin that contains all colliders.
    pub(crate) radius: f32,
    /// True while the obstacle is enabled.
    pub(crate) is_near: bool,
    /// True until the first step of the obstacle.
    pub(crate) is_new: bool,
}

impl BodyReach {
    /// Lets it reach farther by so many metres, until its obstacle is brought up to date.
    pub fn grow(&mut self, by: f32) {
        self.radius += by;
    }
}

/// The colliders in the obstacle of a body, each with its place in the body.
#[derive(Component, Clone, Debug, Default, PartialEq)]
pub struct Parts(pub Vec<(Entity, Placement)>);

/// Gives a body an obstacle of these parts, or takes it away.
pub fn update_body(
    commands: &mut Commands,
    body: Entity,
    known: Option<(&BodyObstacle, &BodyReach)>,
    parts: Option<BodyParts>,
) {
    let Some(BodyParts { mass, frame, place, parts, surface, layers }) = parts else {
        if let Some((known, _)) = known {
            commands.entity(known.entity()).try_despawn();
            commands.entity(body).try_remove::<(MovedByObstacle, BodyReach)>();
        }
        return;
    };
    let reaches = parts.iter().map(|part| part.place.translation.length() + reach_of(&part.shape));
    let radius = reaches.fold(0.0, f32::max);
    let obstacle = (
        Obstacle { shape: shape(&frame, &parts), ..surface },
        layers,
        DynamicObstacle::new(mass, frame.moments),
        Parts(parts.iter().map(|part| (part.entity, part.place)).collect()),
        frame,
    );
    let obstacle = match known {
        Some((known, _)) => commands.entity(known.entity()).try_insert(obstacle).id(),
        None => {
            let Placement { translation, rotation } = frame.of_body(place);
            let there = Transform { translation, rotation, ..default() };
            commands.spawn((obstacle, there, ObstacleOf(body))).id()
        }
    };
    let Placement { translation, rotation } = frame.placed(Placement::default());
    let new = BodyReach { radius, is_near: true, is_new: true };
    let reach = known.map_or(new, |(_, &known)| BodyReach { radius, ..known });
    commands.entity(body).try_insert((MovedByObstacle { obstacle, translation, rotation }, reach));
}

/// The shape of colliders together, in the body's inertial frame.
fn shape(frame: &InertialFrame, parts: &[Part]) -> ObstacleShape {
    let placed =
        parts.iter().map(|part| Ok((Shape::from_parry(part.shape.clone())?, frame.placed(part.place))));
    let shape = placed.collect::<Result<Vec<_>, BuildError>>().and_then(Shape::compound);
    // An obstacle that cannot be is refused by the plugin, which names the entity.
    shape.map_or_else(|_| ObstacleShape::Sphere { radius: f32::NAN }, ObstacleShape::from)
}
