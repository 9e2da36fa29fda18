//! Moves bodies to the GPU and back.

use std::sync::Arc;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::resource::IsResource;
use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_gpu::{BodyMesh, GpuBodyId, GpuError, GpuWorld, TubeVertices, WeldedVertices};
use drape_solver::Body;

use crate::attach::animated_pose::AnimatedPose;
use crate::attach::attachment::Attachment;
use crate::attach::follow_particle::ParticleFollowers;
use crate::attach::grab::Grab;
use crate::attach::plane_lock::PlaneLock;
use crate::attach::winch::Winch;
use crate::attach::world_motion::{TeleportCloth, WorldMotion};
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::contact_events::ContactEvents;
use crate::body::defaults::{Defaults, Described};
use crate::body::layers::DrapeLayers;
use crate::body::on_gpu::OnGpu;
use crate::body::particles::{Particles, Sticks};
use crate::body::pressure::Pressure;
use crate::body::tearable::Tearable;
use crate::build::cloth::Cloth;
use crate::build::rope::Rope;
use crate::build::soft_ball::SoftBall;
use crate::environment::obstacle::Obstacle;
use crate::environment::obstacle_changes::ObstacleChanges;
use crate::gpu::bodies::{GpuBodies, Renderer};
use crate::gpu::components::{GpuBody, GpuVertices, SolveOnGpu};
use crate::gpu::report::LastReport;
use crate::refusal::Refusals;
use crate::render::from_mesh::cloth_mesh::ClothMesh;
use crate::render::from_mesh::driven_mesh::DrivenMesh;
use crate::render::from_mesh::soft_body::SoftBodyMesh;
use crate::render::rope_mesh::{RopeMesh, RopeSurface};
use crate::render::smoothing::SmoothingGroups;
use crate::render::surface::Surface;
use crate::render::vertex_map::VertexMap;
use crate::rig::components::Rig;

/// Components that only the processor knows.
macro_rules! components_of_processor {
    ($($component:ident),* $(,)?) => {
        /// The first of these components that an entity has, if it has one.
        fn component_of_processor(entity: EntityRef) -> Option<&'static str> {
            let found = [$((entity.contains::<$component>(), stringify!($component))),*];
            found.into_iter().find_map(|(is_there, name)| is_there.then_some(name))
        }

        /// Brings a body back to the processor that gains one of them.
        pub(crate) fn watch_components(app: &mut App) {
            $(app.add_observer(bring_back_with::<$component>);)*
        }
    };
}

components_of_processor! {
    AnimatedPose, Attachment, ContactEvents, Grab, ParticleFollowers, PlaneLock, Pressure, Rig, SoftBodyMesh, Tearable,
    TeleportCloth, Winch, WorldMotion,
}

/// Moves bodies to the GPU that have asked for it, or have been built, since the last step.
pub(crate) fn move_to_gpu(
    mut commands: Commands,
    waiting: Query<
        (Entity, EntityRef, Described, &Particles, &Sticks),
        (With<SolveOnGpu>, Or<(Changed<SolveOnGpu>, Changed<Sticks>)>, Without<IsResource>),
    >,
    obstacles: Query<Entity, With<Obstacle>>,
    driven: Query<&DrivenMesh, Allow<Disabled>>,
    defaults: Defaults,
    renderer: Renderer,
    mut bodies: ResMut<GpuBodies>,
    mut changes: ResMut<ObstacleChanges>,
) {
    if waiting.is_empty() {
        return;
    }
    bodies.open(&renderer);
    let Some(world) = bodies.world.as_mut() else { return };
    if world.is_empty() {
        // Those far from all other bodies were left where they were.
        changes.recheck.extend(&obstacles);
    }
    for (entity, components, described, particles, sticks) in &waiting {
        if components.contains::<GpuBody>() {
            // The body was built anew.
            commands.entity(entity).remove::<OnGpu>();
        }
        if components.contains::<TeleportCloth>() {
            // The processor moves it in this step. It goes to the GPU in the next one.
            commands.entity(entity).queue_silenced(|mut entity: EntityWorldMut| {
                entity.get_mut::<SolveOnGpu>().iter_mut().for_each(DetectChangesMut::set_changed);
            });
            continue;
        }
        let is_known = components.contains::<Cloth>()
            || components.contains::<ClothMesh>()
            || components.contains::<Rope>()
            || components.contains::<SoftBall>();
        let reason = match component_of_processor(components) {
            Some("AnimatedPose") => {
                "it follows joints, or has painted limits, backstops or drives".to_string()
            }
            Some(name) => format!("the GPU does not know its {name}"),
            None if !is_known => {
                "the GPU knows no bodies but Cloth, ClothMesh, Rope and SoftBall".to_string()
            }
            None if !sticks.face_parts().is_empty() => "its faces were cut".to_string(),
            None if components.get::<BodyState>().is_some_and(|state| state.torn_from.is_some()) => {
                "it is torn".to_string()
            }
            None if driven.iter().any(|driven| driven.driver == entity) => {
                "a DrivenMesh follows it".to_string()
            }
            None => {
                let settings = defaults.of_body(described);
                let layers = DrapeLayers::of(components.get::<DrapeLayers>());
                let body = Body::new(particles.0.clone(), Arc::clone(&sticks.0), settings);
                let body = Body { layers, ..body };
                let welded = components.get::<Surface>().and_then(Surface::welded);
                match add(world, &body, welded) {
                    Ok((id, vertices)) => {
                        let topology = Arc::clone(world.topology(id).unwrap_or(&sticks.0));
                        commands.queue(take_parts(entity, GpuBody(id), vertices, Body { topology, ..body }));
                        continue;
                    }
                    Err(error) => error.to_string(),
                }
            }
        };
        let name = components.get::<Name>().map_or("", Name::as_str);
        warn!("body {entity} {name} with SolveOnGpu is solved on the processor: {reason}");
    }
}

/// Adds a body, and the vertices of its mesh, if several may lie on one particle.
fn add(
    world: &mut GpuWorld,
    body: &Body,
    welded: Option<&VertexMap>,
) -> Result<(GpuBodyId, Option<GpuVertices>), GpuError> {
    let vertices = welded.map(|map| {
        let SmoothingGroups { first, faces } = map.groups();
        let vertices = WeldedVertices { particles: &map.particles, normals: first, faces };
        world.add_vertices(&vertices).map(|welded| GpuVertices(BodyMesh::Welded(welded)))
    });
    let vertices = vertices.transpose()?;
    Ok((world.add(body)?, vertices))
}

/// Takes the parts of a body off its entity. If they are gone meanwhile, so is the body on the GPU.
fn take_parts(entity: Entity, id: GpuBody, vertices: Option<GpuVertices>, body: Body) -> impl Command {
    move |world: &mut World| {
        let mut entity = world.get_entity_mut(entity).ok();
        let taken = entity.as_mut().and_then(EntityWorldMut::take::<(Particles, Sticks, BodyState)>);
        if let (Some(entity), Some((.., state))) = (&mut entity, taken) {
            let report = LastReport::at(&body);
            let Body { particles, topology, settings, layers, .. } = body;
            let anchor = state.anchor;
            let state = BodyState { settings, layers, ..state };
            entity.insert((OnGpu { particles, topology, state, anchor }, id, report, Activity::Active));
            if let Some(vertices) = vertices {
                entity.insert(vertices);
            }
        } else if let Some(bodies) = world.resource_mut::<GpuBodies>().world.as_mut() {
            // It has just been added.
            let _ = bodies.remove(id.0);
        }
    }
}

/// Tells the GPU how the tubes of ropes lie on their particles: of ropes that are new there, and of tubes that are.
pub(crate) fn move_tubes(
    mut commands: Commands,
    ropes: Query<
        (Entity, &RopeSurface, &Mesh3d),
        (With<GpuBody>, Or<(Changed<RopeSurface>, Changed<Mesh3d>, Added<GpuBody>)>, Allow<Disabled>),
    >,
    mut bodies: ResMut<GpuBodies>,
) {
    let Some(world) = bodies.world.as_mut() else { return };
    for (entity, surface, mesh) in &ropes {
        if surface.mesh != mesh.id() {
            // Of a rope that the entity was before.
            continue;
        }
        let RopeMesh { radius, sides } = surface.made_for;
        match world.add_tube(&TubeVertices { particles: &surface.order, sides, radius }) {
            Ok(tube) => {
                commands.entity(entity).insert(GpuVertices(BodyMesh::Tube(tube)));
            }
            Err(error) => warn!("rope {entity} on the GPU is not drawn: {error}"),
        }
    }
}

/// Brings a body back to the processor that loses its [`SolveOnGpu`].
pub(crate) fn bring_back_released(released: On<Remove<SolveOnGpu>>, mut commands: Commands) {
    bring_back_by(&mut commands, released.entity, true);
}

/// Brings a body back to the processor that gains a component which the GPU does not know.
fn bring_back_with<C: Component>(
    added: On<Add<C>>,
    on_gpu: Query<(), (With<GpuBody>, Allow<Disabled>)>,
    mut commands: Commands,
) {
    if on_gpu.contains(added.entity) {
        bring_back_by(&mut commands, added.entity, true);
    }
}

/// Brings bodies back that a mesh is to follow.
pub(crate) fn bring_back_drivers(
    driven: Query<&DrivenMesh, (Changed<DrivenMesh>, Allow<Disabled>)>,
    mut commands: Commands,
) {
    driven.iter().for_each(|driven| bring_back_by(&mut commands, driven.driver, true));
}

/// Has a body brought back by the next commands, if it is there by then.
pub(crate) fn bring_back_by(commands: &mut Commands, entity: Entity, can_be_read: bool) {
    if let Ok(mut entity) = commands.get_entity(entity) {
        entity.queue_silenced(move |entity: EntityWorldMut| bring_back(entity, can_be_read));
    }
}

/// Brings a body back to the processor, if it is on the GPU: at rest where it is there, or, if it cannot be read, where its entity is. In browsers nothing
/// may wait.
fn bring_back(mut entity: EntityWorldMut, can_be_read: bool) {
    let Some(&body) = entity.get::<GpuBody>() else { return };
    if entity.contains::<Particles>() {
        // The body was built anew, and has not gone there yet.
        entity.remove::<OnGpu>();
        return;
    }
    let world =
        entity.resource::<GpuBodies>().world().filter(|_| can_be_read && cfg!(not(target_family = "wasm")));
    let positions = world.and_then(|world| world.read_positions(body.0).ok());
    let activity = entity.get::<Activity>().copied().unwrap_or_default();
    let now = entity.get::<GlobalTransform>().map(GlobalTransform::affine).filter(Affine3A::is_finite);
    let Some(mut parts) = entity.take::<OnGpu>() else { return };
    let there = parts.state.anchor;
    if parts.follows_entity(activity)
        && let Some(now) = now
    {
        parts.state.anchor = now;
    }
    if let Some(positions) = positions {
        for (i, position) in positions.into_iter().enumerate() {
            parts.particles.set_position(i, position);
            parts.particles.set_velocity(i, Vec3::ZERO);
        }
        parts.anchor = there;
    }
    parts.follow();
    let OnGpu { mut particles, topology, state, .. } = parts;
    for &(pin, local) in &state.pins {
        // The entity may have moved in a step that failed.
        particles.set_pin_target(pin as usize, state.anchor.transform_point3(local));
    }
    if let Some(mut surface) = entity.get_mut::<Surface>() {
        surface.restart(&particles);
    }
    if let Some(mut surface) = entity.get_mut::<RopeSurface>() {
        surface.restart(&particles);
    }
    entity.insert((Particles(particles), Sticks(topology), Activity::Active, state));
}

/// Removes a body from the GPU that is gone, or was taken from its entity.
pub(crate) fn remove_from_gpu(
    removed: On<Remove<OnGpu>>,
    ids: Query<&GpuBody, Allow<Disabled>>,
    mut bodies: ResMut<GpuBodies>,
    mut refusals: ResMut<Refusals>,
    mut commands: Commands,
) {
    refusals.forget_component(removed.entity, SolveOnGpu::NAME);
    if let (Ok(body), Some(world)) = (ids.get(removed.entity), bodies.world.as_mut()) {
        // The world may have lost it with its device.
        let _ = world.remove(body.0);
    }
    if let Ok(mut entity) = commands.get_entity(removed.entity) {
        entity.try_remove::<(GpuBody, GpuVertices, LastReport)>();
    }
}
