//! The left mouse button, or a finger: on cloth it drags it. A click or a tap fires where there is no cloth.

use bevy::picking::pointer::PointerId;
use bevy::prelude::*;
use bevy_drape::cannon::{Cannon, FireCannon};
use bevy_drape::prelude::*;

use crate::view::touch::{BodiesUnder, TouchPlugin};

/// Radius of the piece of cloth that is held, in metres.
const HANDFUL: f32 = 0.22;

/// Drags cloth and fires.
pub struct PointerPlugin;

impl Plugin for PointerPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(TouchPlugin).add_systems(Update, (offer, fire));
    }
}

type Untouched = (Added<Particles>, Without<Draggable>);

/// Makes every built body draggable.
fn offer(bodies: Query<Entity, Untouched>, mut commands: Commands) {
    for body in &bodies {
        commands.entity(body).insert(Draggable { radius: HANDFUL, ..default() });
    }
}

fn fire(
    buttons: Res<ButtonInput<MouseButton>>,
    under: BodiesUnder,
    cannons: Query<Entity, With<Cannon>>,
    mut fire: MessageWriter<FireCannon>,
) {
    if buttons.just_pressed(MouseButton::Left) && !under.has(PointerId::Mouse) {
        fire.write_batch(cannons.iter().map(|cannon| FireCannon { cannon }));
    }
}
