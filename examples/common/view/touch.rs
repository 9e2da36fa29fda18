//! Fingers beside the bodies: one turns the camera, two zoom, and a tap fires. A finger on a body drags it.

use bevy::ecs::system::SystemParam;
use bevy::input::touch::Touch;
use bevy::picking::hover::HoverMap;
use bevy::picking::pointer::PointerId;
use bevy::prelude::*;
use bevy_drape::cannon::{Cannon, FireCannon};
use bevy_drape::prelude::*;

use crate::view::orbit::Orbit;

/// Farthest that a finger moves in a tap, in pixels.
const TAP: f32 = 12.0;

/// Follows fingers.
pub struct TouchPlugin;

impl Plugin for TouchPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<FreeFingers>().add_systems(Update, (find_free, look, fire).chain());
    }
}

/// Fingers that came down beside all bodies.
#[derive(Resource, Default)]
struct FreeFingers(Vec<u64>);

/// The mouse pointer with its left button, or else a finger.
#[derive(SystemParam)]
pub struct Press<'w, 's> {
    windows: Query<'w, 's, &'static Window>,
    buttons: Res<'w, ButtonInput<MouseButton>>,
    touches: Res<'w, Touches>,
}

impl Press<'_, '_> {
    /// Where it is, in physical pixels.
    pub fn place(&self) -> Option<Vec2> {
        let finger = self.touches.first_pressed_position();
        self.windows.iter().find_map(|window| {
            finger.map(|at| at * window.scale_factor()).or_else(|| window.physical_cursor_position())
        })
    }

    /// True while it is down.
    pub fn is_down(&self) -> bool {
        self.buttons.pressed(MouseButton::Left) || self.touches.first_pressed_position().is_some()
    }

    /// True in the frame in which it comes down.
    pub fn has_begun(&self) -> bool {
        self.buttons.just_pressed(MouseButton::Left) || self.touches.any_just_pressed()
    }
}

/// The bodies under pointers.
#[derive(SystemParam)]
pub struct BodiesUnder<'w, 's> {
    hover: Res<'w, HoverMap>,
    bodies: Query<'w, 's, (), With<Particles>>,
}

impl BodiesUnder<'_, '_> {
    /// True if there is one under this pointer.
    pub fn has(&self, pointer: PointerId) -> bool {
        let over = self.hover.get(&pointer);
        over.is_some_and(|over| over.keys().any(|&entity| self.bodies.contains(entity)))
    }
}

fn find_free(touches: Res<Touches>, under: BodiesUnder, mut free: ResMut<FreeFingers>) {
    let is_known = |finger: u64| touches.get_pressed(finger).is_some() || touches.just_released(finger);
    free.0.retain(|&finger| is_known(finger));
    for touch in touches.iter_just_pressed() {
        if !under.has(PointerId::Touch(touch.id())) {
            free.0.push(touch.id());
        }
    }
}

fn look(touches: Res<Touches>, free: Res<FreeFingers>, mut cameras: Query<(&mut Orbit, &mut Transform)>) {
    let fingers: Vec<&Touch> = free.0.iter().filter_map(|&finger| touches.get_pressed(finger)).collect();
    let (turn, zoom) = match *fingers {
        [finger] => (finger.delta(), 1.0),
        [one, other] => {
            let before = one.previous_position().distance(other.previous_position());
            let now = one.position().distance(other.position());
            (Vec2::ZERO, before.max(1.0) / now.max(1.0))
        }
        _ => return,
    };
    for (mut orbit, mut transform) in &mut cameras {
        orbit.turn(turn);
        orbit.zoom(zoom);
        *transform = orbit.transform();
    }
}

fn fire(
    touches: Res<Touches>,
    free: Res<FreeFingers>,
    cannons: Query<Entity, With<Cannon>>,
    mut fire: MessageWriter<FireCannon>,
) {
    let is_tap = |touch: &Touch| free.0.contains(&touch.id()) && touch.distance().length() < TAP;
    if touches.iter_just_released().any(is_tap) {
        fire.write_batch(cannons.iter().map(|cannon| FireCannon { cannon }));
    }
}
