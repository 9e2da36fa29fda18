//! Moves bodies to the GPU and back.

use std::sync::Arc;

use bevy::camera::visibility::NoFrustumCulling;
use bevy::ecs::resource::IsResource;
use bevy::prelude::*;
use drape_solver::Body;

use crate::attach::animated_pose::AnimatedPose;
use crate::attach::attachment::Attachment;
use crate::attach::follow_particle::ParticleFollowers;
use crate::attach::grab::Grab;
use crate::attach::plane_lock::PlaneLock;
use crate::attach::winch::Winch;
use crate::attach::world_motion::WorldMotion;
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::contact_events::ContactEvents;
use crate::body::defaults::Defaults;
use crate::body::fabric::Fabric;
use crate::body::layers::DrapeLayers;
use crate::body::on_gpu::OnGpu;
use crate::body::particles::{Particles, Sticks};
use crate::body::pressure::Pressure;
use crate::body::settings::SolverSettings;
use crate::body::surface::BodySurface;
use crate::body::tearable::Tearable;
use crate::detail::level::LevelOfDetail;
use crate::environment::obstacle::Obstacle;
use crate::environment::obstacle_changes::ObstacleChanges;
use crate::gpu::bodies::{GpuBodies, Renderer};
use crate::gpu::components::{GpuBody, SolveOnGpu};
use crate::render::from_mesh::cloth_mesh::ClothMesh;
use crate::render::from_mesh::soft_body::SoftBodyMesh;
use crate::render::rope_mesh::RopeMesh;
use crate::render::surface::Surface;
use crate::rig::components::Rig;

/// The component for which the processor has to solve an entity's body, if it has one.
fn component_of_processor(entity: EntityRef) -> Option<&'static str> {
    let found = [
        (entity.contains::<AnimatedPose>(), "AnimatedPose"),
        (entity.contains::<Attachment>(), "Attachment"),
        (entity.contains::<ClothMesh>(), "ClothMesh"),
        (entity.contains::<ContactEvents>(), "ContactEvents"),
        (entity.contains::<Grab>(), "Grab"),
        (entity.contains::<LevelOfDetail>(), "LevelOfDetail"),
        (entity.contains::<ParticleFollowers>(), "FollowParticle"),
        (entity.contains::<PlaneLock>(), "PlaneLock"),
        (entity.contains::<Pressure>(), "Pressure"),
        (entity.contains::<Rig>(), "Rig"),
        (entity.contains::<RopeMesh>(), "RopeMesh"),
        (entity.contains::<SoftBodyMesh>(), "SoftBodyMesh"),
        (entity.contains::<Tearable>(), "Tearable"),
        (entity.contains::<Winch>(), "Winch"),
        (entity.contains::<WorldMotion>(), "WorldMotion"),
    ];
    found.into_iter().find_map(|(is_there, name)| is_there.then_some(name))
}

/// Moves bodies to the GPU that ask for it and have been built since the last step.
pub(crate) fn move_to_gpu(
    mut commands: Commands,
    waiting: Query<
        (Entity, EntityRef, &Particles, &Sticks),
        (With<SolveOnGpu>, Or<(Added<SolveOnGpu>, Changed<Sticks>)>, Without<IsResource>),
    >,
    obstacles: Query<Entity, With<Obstacle>>,
    defaults: Defaults,
    renderer: Renderer,
    mut bodies: ResMut<GpuBodies>,
    mut changes: ResMut<ObstacleChanges>,
) {
    if waiting.is_empty() {
        return;
    }
    bodies.open(&renderer);
    let Some(world) = bodies.world_mut() else { return };
    if world.is_empty() {
        // Those far from all other bodies were left where they were.
        changes.recheck.extend(&obstacles);
    }
    for (entity, components, particles, sticks) in &waiting {
        if components.contains::<GpuBody>() {
            // The body was built anew.
            commands.entity(entity).remove::<OnGpu>();
        }
        let reason = match component_of_processor(components) {
            Some(name) => format!("the GPU does not know its {name}"),
            None => {
                let settings = defaults.of_body(
                    components.get::<SolverSettings>(),
                    components.get::<Fabric>(),
                    components.get::<BodySurface>(),
                );
                let layers = DrapeLayers::of(components.get::<DrapeLayers>());
                let body = Body::new(particles.0.clone(), Arc::clone(&sticks.0), settings);
                let body = Body { layers, ..body };
                match world.add(&body) {
                    Ok(id) => {
                        let topology = Arc::clone(world.topology(id).unwrap_or(&sticks.0));
                        commands.entity(entity).queue(take_parts(GpuBody(id), Body { topology, ..body }));
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

/// Takes the parts of a body off its entity.
fn take_parts(id: GpuBody, body: Body) -> impl EntityCommand {
    move |mut entity: EntityWorldMut| {
        let Some((.., state)) = entity.take::<(Particles, Sticks, Activity, BodyState)>() else { return };
        let Body { particles, topology, settings, layers, .. } = body;
        let anchor = state.anchor;
        let state = BodyState { settings, layers, ..state };
        // The processor does not know how far the body reaches.
        entity.insert((OnGpu { particles, topology, state, anchor }, id, NoFrustumCulling));
    }
}

/// Brings a body back to the processor that loses its [`SolveOnGpu`].
pub(crate) fn bring_back_released(released: On<Remove<SolveOnGpu>>, mut commands: Commands) {
    if let Ok(mut entity) = commands.get_entity(released.entity) {
        entity.queue_silenced(bring_back);
    }
}

/// Brings a body back to the processor, if it is on the GPU: where it is there, at rest.
pub(crate) fn bring_back(mut entity: EntityWorldMut) {
    let Some(&body) = entity.get::<GpuBody>() else { return };
    let world = entity.resource::<GpuBodies>().world();
    let positions = world.and_then(|world| world.read_positions(body.0).ok());
    let Some(OnGpu { mut particles, topology, state, .. }) = entity.take() else { return };
    for (i, position) in positions.into_iter().flatten().enumerate() {
        particles.set_position(i, position);
        particles.set_velocity(i, Vec3::ZERO);
    }
    // It would be drawn between where it went to the GPU and where it is now.
    entity.remove::<Surface>();
    entity.insert((Particles(particles), Sticks(topology), Activity::Active, state));
}

/// Removes a body from the GPU that is gone, or was taken from its entity.
pub(crate) fn remove_from_gpu(
    removed: On<Remove<OnGpu>>,
    ids: Query<&GpuBody>,
    mut bodies: ResMut<GpuBodies>,
    mut commands: Commands,
) {
    if let (Ok(body), Some(world)) = (ids.get(removed.entity), bodies.world_mut()) {
        // It is unknown if the world is another one.
        let _ = world.remove(body.0);
    }
    if let Ok(mut entity) = commands.get_entity(removed.entity) {
        entity.try_remove::<(GpuBody, NoFrustumCulling)>();
    }
}
