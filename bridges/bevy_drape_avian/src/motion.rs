//! Reads the motion of dynamic bodies, and writes it back.

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_drape::drape_solver::Placement;
use bevy_drape_bridge::{BodyObstacle, BodyReach, EngineBody, ObstacleOf, Surroundings};

/// Looks which dynamic bodies are near cloth.
pub(crate) fn find_near(
    mut bodies: Query<(&Position, &Rotation, &LinearVelocity, &BodyObstacle, &mut BodyReach)>,
    mut surroundings: ResMut<Surroundings>,
    physics: Res<Time<Physics>>,
) {
    let seconds = if physics.is_paused() { 0.0 } else { physics.delta_secs() };
    for (position, rotation, velocity, obstacle, mut reach) in &mut bodies {
        let place = placement(position, rotation);
        surroundings.look_at(obstacle, &mut reach, place, velocity.0, seconds);
    }
}

/// Reads all dynamic bodies near cloth: where Avian's step begins, and where it ends.
pub(crate) fn read(
    mut obstacles: Query<(&ObstacleOf, &mut EngineBody)>,
    bodies: Query<(
        &Position,
        &Rotation,
        &LinearVelocity,
        &AngularVelocity,
        Option<&LockedAxes>,
        Option<&SleepThreshold>,
        Has<SleepingDisabled>,
        Has<Sleeping>,
    )>,
    time: Res<Time<Physics>>,
) {
    for (of, mut body) in &mut obstacles {
        let Ok((position, rotation, velocity, spin, locked, threshold, is_kept_awake, is_asleep)) =
            bodies.get(of.0)
        else {
            continue;
        };
        let threshold = threshold.copied().unwrap_or_default();
        let locked = locked.copied().unwrap_or_default().to_bits();
        let is_locked = |bit: u8| locked >> bit & 1 == 1;
        *body = EngineBody {
            place: placement(position, rotation),
            velocity: velocity.0,
            angular_velocity: spin.0,
            locked_translation: [5, 4, 3].map(is_locked),
            locked_rotation: [2, 1, 0].map(is_locked),
            is_asleep,
            sleep_speeds: if is_kept_awake { [-1.0; 2] } else { [threshold.linear, threshold.angular] },
            is_paused: time.is_paused(),
            ..*body
        };
    }
}

/// Moves the bodies that cloth has pushed to where it left them.
pub(crate) fn write(
    obstacles: Query<(&ObstacleOf, &EngineBody)>,
    mut bodies: Query<(&mut Position, &mut Rotation, &mut LinearVelocity, &mut AngularVelocity)>,
) {
    for (of, body) in obstacles.iter().filter(|(_, body)| body.is_pushed) {
        if let Ok((mut position, mut rotation, mut velocity, mut spin)) = bodies.get_mut(of.0) {
            (position.0, rotation.0) = (body.place.translation, body.place.rotation);
            (velocity.0, spin.0) = (body.velocity, body.angular_velocity);
        }
    }
}

/// A place in cloth's terms.
pub(crate) fn placement(position: &Position, rotation: &Rotation) -> Placement {
    Placement { translation: position.0, rotation: rotation.0 }
}

/// The place of a collider in its body.
pub(crate) fn place_in_body(place: &ColliderTransform) -> Placement {
    Placement { translation: place.translation, rotation: place.rotation }
}
