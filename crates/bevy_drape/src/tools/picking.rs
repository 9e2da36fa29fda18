//! Bevy's pointer events on simulated bodies, and bodies that pointers drag.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy::picking::events::PointerClick;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::gestures::Gestures;
//!
//! fn setup(mut commands: Commands) {
//!     // Mouse and fingers take hold of it, each with no more than 30 N.
//!     let draggable = Draggable { greatest_force: 30.0, ..default() };
//!     commands.spawn((Cloth::new(2.0, 1.5), draggable)).observe(pierce);
//! }
//!
//! fn pierce(click: On<PointerClick>, mut commands: Commands) {
//!     if let (Some(place), Some(normal)) = (click.hit.position, click.hit.normal)
//!         && let Ok(direction) = Dir3::new(-normal)
//!     {
//!         commands.pierce(place, direction, 0.1);
//!     }
//! }
//! ```

use bevy::camera::Camera;
use bevy::camera::visibility::{InheritedVisibility, RenderLayers};
use bevy::picking::backend::ray::RayMap;
use bevy::picking::backend::{HitData, PointerHits};
use bevy::picking::events::{PointerCancel, PointerDragEnd, PointerDragStart};
use bevy::picking::pointer::{PointerButton, PointerId};
use bevy::picking::{Pickable, PickingSystems};
use bevy::prelude::*;

use crate::attach::grab::{Grab, Hand, nearest_particle};
use crate::ball::projectile::ProjectileState;
use crate::body::body_state::BodyState;
use crate::body::particles::{Particles, Sticks};
use crate::tools::ray_cast::{BodyHit, cast_ray, meet_link, meets_box};

/// Least radius of links for pointers, in metres: ropes are thin.
const LINK_RADIUS: f32 = 0.03;
/// First id of the hands of pointers; smaller ids are free for others.
const FIRST_HAND: u64 = 1 << 63;

/// A backend for Bevy's picking: observers of [`PointerEvent`](bevy::picking::events::PointerEvent)s on bodies and balls work, and pointers drag
/// [`Draggable`] bodies. Hits carry a [`BodyHit`] as extra data.
///
/// Does nothing in an app without Bevy's `PickingPlugin`. [`Pickable`], [`RenderLayers`] and visibility count as for meshes.
#[derive(Clone, Copy, Debug, Default)]
pub struct DrapePickingPlugin;

impl Plugin for DrapePickingPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Draggable>()
            .init_resource::<Drags>()
            .add_systems(
                PreUpdate,
                (
                    find_hits.in_set(PickingSystems::Backend),
                    pull_dragged.after(PickingSystems::Backend).before(PickingSystems::Hover),
                )
                    .run_if(resource_exists::<RayMap>),
            )
            .add_observer(take_hold)
            .add_observer(let_go_at_end)
            .add_observer(let_go_if_cancelled);
    }
}

/// Lets pointers drag a body: the primary button of a mouse, and each finger. The held point keeps its distance along
/// the pointer's ray until the pointer is released. Pieces of a torn body are draggable too.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct Draggable {
    /// Radius in metres around the pointer within which particles are held, less with growing distance; 0.2 by default.
    pub radius: f32,
    /// The greatest force of each pointer in newtons; infinite by default.
    pub greatest_force: f32,
}

impl Default for Draggable {
    fn default() -> Self {
        Self { radius: 0.2, greatest_force: f32::INFINITY }
    }
}

/// A pointer that drags something.
#[derive(Clone, Copy, Debug)]
struct PointerDrag {
    pointer: PointerId,
    camera: Entity,
    /// The id of its hand, which may hold a piece that has come off.
    hand: u64,
    /// Distance along the ray at which it was grabbed, in metres.
    distance: f32,
    /// Offset from the pointer to the held particle.
    offset: Vec3,
}

/// Pointers that drag something, and the number of all drags so far.
#[derive(Resource, Debug, Default)]
struct Drags {
    under_way: Vec<PointerDrag>,
    count: u64,
}

fn find_hits(
    rays: Res<RayMap>,
    cameras: Query<(&Camera, Option<&RenderLayers>)>,
    bodies: Query<(Entity, &Particles, &Sticks, &BodyState)>,
    balls: Query<(Entity, &ProjectileState)>,
    looks: Query<(Option<&Pickable>, Option<&RenderLayers>, Option<&InheritedVisibility>)>,
    mut output: MessageWriter<PointerHits>,
) {
    for (id, &ray) in rays.iter() {
        let Ok((camera, layers)) = cameras.get(id.camera) else { continue };
        let layers = layers.cloned().unwrap_or_default();
        let is_seen = |entity: Entity| {
            looks.get(entity).is_ok_and(|(pickable, own, visibility)| {
                pickable.is_none_or(|pickable| pickable.is_hoverable || pickable.should_block_lower)
                    && own.map_or(layers.intersects(&RenderLayers::default()), |own| layers.intersects(own))
                    && visibility.is_none_or(|visibility| visibility.get())
            })
        };
        let mut picks = Vec::new();
        for (entity, particles, sticks, state) in &bodies {
            let radius = state.settings.thickness.max(LINK_RADIUS);
            if meets_box(ray, f32::INFINITY, state.extent.bounds.grown(radius))
                && is_seen(entity)
                && let Some(hit) = cast_ray(ray, f32::INFINITY, particles, sticks, radius)
            {
                let BodyHit { distance, position, normal, .. } = hit;
                let (position, normal) = (Some(position), Some(normal));
                picks.push((entity, HitData::new_with_extra(id.camera, distance, position, normal, hit)));
            }
        }
        for (entity, ball) in &balls {
            if let Some(hit) = meet_link(ray, [ball.position(); 2], ball.material().radius)
                && is_seen(entity)
            {
                let (position, normal) = (Some(hit.position), Some(hit.normal));
                picks.push((entity, HitData::new(id.camera, hit.distance, position, normal)));
            }
        }
        if !picks.is_empty() {
            output.write(PointerHits::new(id.pointer, picks, camera.order as f32));
        }
    }
}

/// Puts a hand on the body when a drag begins.
fn take_hold(
    start: On<PointerDragStart>,
    mut bodies: Query<(&Particles, &Draggable, Option<&mut Grab>)>,
    mut drags: ResMut<Drags>,
    mut commands: Commands,
) {
    let Ok((particles, draggable, grab)) = bodies.get_mut(start.entity) else { return };
    let hit = &start.hit;
    let Some(place) = hit.position else { return };
    let known = hit.extra_as::<BodyHit>().map(|hit| hit.particle).filter(|&known| known < particles.len());
    let Some(particle) = known.or_else(|| nearest_particle(particles, place)) else { return };
    if start.button != PointerButton::Primary {
        return;
    }
    drags.count += 1;
    let id = FIRST_HAND + drags.count;
    let mut hand = Hand::new(particles, particle, draggable.radius);
    (hand.id, hand.greatest_force) = (id, draggable.greatest_force);
    drags.under_way.push(PointerDrag {
        pointer: start.pointer.id,
        camera: hit.camera,
        hand: id,
        distance: hit.depth,
        offset: hand.target - place,
    });
    match grab {
        Some(mut grab) => grab.hold(hand),
        None => drop(commands.entity(start.entity).insert(Grab::from(hand))),
    }
}

/// Moves hands with their pointers. The hand of a pointer outside its camera's view stays.
fn pull_dragged(rays: Res<RayMap>, mut drags: ResMut<Drags>, mut grabs: Query<&mut Grab>) {
    if drags.under_way.is_empty() {
        return;
    }
    drags.under_way.retain(|drag| {
        let ray = rays.iter().find(|(id, _)| id.pointer == drag.pointer && id.camera == drag.camera);
        // The hand may hold several pieces by now, or none.
        let mut holds = false;
        for mut grab in &mut grabs {
            if let Some(hand) = grab.bypass_change_detection().hand_mut(drag.hand) {
                holds = true;
                if let Some((_, ray)) = ray {
                    hand.target = ray.get_point(drag.distance) + drag.offset;
                }
            }
        }
        holds
    });
}

fn let_go_at_end(end: On<PointerDragEnd>, drags: ResMut<Drags>, grabs: Hands, commands: Commands) {
    if end.button == PointerButton::Primary {
        let_go(end.pointer.id, drags, grabs, commands);
    }
}

fn let_go_if_cancelled(end: On<PointerCancel>, drags: ResMut<Drags>, grabs: Hands, commands: Commands) {
    let_go(end.pointer.id, drags, grabs, commands);
}

type Hands<'w, 's> = Query<'w, 's, (Entity, &'static mut Grab)>;

/// Releases the hands of a pointer from everything that they hold.
fn let_go(pointer: PointerId, mut drags: ResMut<Drags>, mut grabs: Hands, mut commands: Commands) {
    for drag in drags.under_way.extract_if(.., |drag| drag.pointer == pointer) {
        for (entity, mut grab) in &mut grabs {
            if grab.hand_mut(drag.hand).is_some() && grab.let_go(drag.hand) {
                commands.entity(entity).try_remove::<Grab>();
            }
        }
    }
}
