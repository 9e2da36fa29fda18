//! The left mouse button: pressed on cloth it takes hold of it, pressed elsewhere it fires.

use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_drape::grab::pick;
use bevy_drape::prelude::*;

/// How far beside a particle the pointer may be, in metres.
const REACH: f32 = 0.1;
/// Radius of the piece of cloth that is held, in metres.
const HANDFUL: f32 = 0.22;
/// Lowest that cloth is dragged to, in metres.
const FLOOR: f32 = 0.03;

/// What the pointer holds.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct Hand(Option<Held>);

#[derive(Clone, Copy, Debug)]
struct Held {
    body: Entity,
    /// Where the cloth was taken: it is dragged in the plane through this point that faces the camera.
    point: Vec3,
}

/// Drags cloth and fires.
pub struct PointerPlugin;

impl Plugin for PointerPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Hand>().add_systems(Update, (press, drag, release).chain());
    }
}

type Cameras<'w, 's> = Query<'w, 's, (&'static Camera, &'static GlobalTransform), With<Camera3d>>;
type Windows<'w, 's> = Query<'w, 's, &'static Window, With<PrimaryWindow>>;

/// The line of sight through the pointer, if it is in the window.
fn pointer_ray(windows: &Windows, cameras: &Cameras) -> Option<Ray3d> {
    let pointer = windows.single().ok()?.cursor_position()?;
    let (camera, transform) = cameras.single().ok()?;
    camera.viewport_to_world(transform, pointer).ok()
}

fn press(
    mut commands: Commands,
    mut hand: ResMut<Hand>,
    mut fire: MessageWriter<FireCannon>,
    buttons: Res<ButtonInput<MouseButton>>,
    windows: Windows,
    cameras: Cameras,
    bodies: Query<(Entity, &Particles)>,
    cannons: Query<Entity, With<Cannon>>,
) {
    if !buttons.just_pressed(MouseButton::Left) {
        return;
    }
    let Some(ray) = pointer_ray(&windows, &cameras) else {
        return;
    };
    let picked = pick(ray, REACH, bodies.iter().map(|(entity, particles)| (entity, &particles.0)));
    match picked.and_then(|picked| bodies.get(picked.entity).ok().zip(Some(picked))) {
        Some(((body, particles), picked)) => {
            commands.entity(body).insert(Grab::new(particles, picked.particle, HANDFUL));
            hand.0 = Some(Held { body, point: picked.position });
        }
        None => {
            fire.write_batch(cannons.iter().map(|cannon| FireCannon { cannon }));
        }
    }
}

fn drag(hand: Res<Hand>, windows: Windows, cameras: Cameras, mut grabs: Query<&mut Grab>) {
    let Some(held) = hand.0 else {
        return;
    };
    let (Some(ray), Ok((_, camera)), Ok(mut grab)) =
        (pointer_ray(&windows, &cameras), cameras.single(), grabs.get_mut(held.body))
    else {
        return;
    };
    let plane = InfinitePlane3d::new(camera.forward());
    if let Some(point) = ray.plane_intersection_point(held.point, plane) {
        grab.pull_to(point.with_y(point.y.max(FLOOR)));
    }
}

fn release(mut commands: Commands, mut hand: ResMut<Hand>, buttons: Res<ButtonInput<MouseButton>>) {
    if buttons.pressed(MouseButton::Left) {
        return;
    }
    // A curtain that was taken away meanwhile has nothing to be let go of.
    if let Some(held) = hand.0.take()
        && let Ok(mut body) = commands.get_entity(held.body)
    {
        body.remove::<Grab>();
    }
}
