//! The viewpoints of a scene: its cameras, or one from which all of it is seen.

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::cannon::Cannon;
use bevy_drape::environment::ShapeFromMesh;
use bevy_drape::prelude::*;
use bevy_drape_script::play::ScenePlay;
use bevy_drape_script::scene::Camera as SceneCamera;

use crate::view::viewpoint::Viewpoint;

/// Vertical angle of view of a scene without cameras, in degrees.
const FIELD_OF_VIEW: f32 = 45.0;
/// Direction of the viewpoint: angle to the right, and above the horizon, in radians.
pub const DIRECTION: (f32, f32) = (0.4, 0.25);
/// Largest obstacle that must be seen whole, in metres. The ground need not.
const LARGEST: f32 = 6.0;

/// The viewpoint of a scene's camera.
pub fn viewpoint_of(camera: &SceneCamera) -> Viewpoint {
    Viewpoint {
        eye: camera.at.get(),
        target: camera.look_at.get(),
        field_of_view: camera.field_of_view.get().to_radians(),
    }
}

/// The box around all that a scene has shown so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Framing {
    bounds: Option<(Vec3, Vec3)>,
}

impl Framing {
    /// Widens the box to what there is now.
    pub fn note(&mut self, world: &mut World) {
        let Some(play) = world.get_resource::<ScenePlay>() else { return };
        let mut seen = Vec::new();
        for (_, entity) in play.bodies(world) {
            if let Some(body) = world.get::<Particles>(entity) {
                seen.extend(body.positions().map(|place| (place, 0.0)));
            } else if let Some(ball) = world.get::<ProjectileState>(entity) {
                seen.push((ball.position(), ball.material().radius));
            }
        }
        let mut obstacles = world.query::<(&Obstacle, Option<&ShapeFromMesh>, &Transform)>();
        for (obstacle, from_mesh, place) in obstacles.iter(world) {
            let Ok(Some(shape)) = obstacle.shape.solid(from_mesh) else { continue };
            let (low, high) = shape.local_bounds();
            let radius = 0.5 * (high - low).length();
            if radius <= 0.5 * LARGEST {
                seen.push((place.transform_point(0.5 * (low + high)), radius));
            }
        }
        let mut cannons = world.query_filtered::<&Transform, With<Cannon>>();
        seen.extend(cannons.iter(world).map(|cannon| (cannon.translation, 0.5)));
        for (place, radius) in seen.into_iter().filter(|(place, _)| place.is_finite()) {
            let (least, greatest) = self.bounds.unwrap_or((place, place));
            self.bounds = Some((least.min(place - radius), greatest.max(place + radius)));
        }
    }

    /// The middle of the box, and a distance from which all of it is seen, in metres.
    pub fn middle_and_distance(&self) -> (Vec3, f32) {
        let (least, greatest) = self.bounds.unwrap_or((Vec3::NEG_ONE, Vec3::ONE));
        let radius = (0.5 * (greatest - least).length()).max(0.5);
        (0.5 * (least + greatest), radius / (0.5 * FIELD_OF_VIEW.to_radians()).sin())
    }

    /// The view from which all of it is seen.
    pub fn view(&self) -> Viewpoint {
        let (target, distance) = self.middle_and_distance();
        let (yaw, pitch) = DIRECTION;
        let turn = Quat::from_rotation_y(yaw) * Quat::from_rotation_x(-pitch);
        let eye = target + turn * Vec3::Z * distance;
        Viewpoint { eye: eye.with_y(eye.y.max(0.1)), target, field_of_view: FIELD_OF_VIEW.to_radians() }
    }
}
