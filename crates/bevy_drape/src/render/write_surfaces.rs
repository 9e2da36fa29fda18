//! Writes the surfaces that have moved, and that are seen, into their meshes.

use bevy::camera::primitives::Aabb;
use bevy::platform::time::Instant;
use bevy::prelude::*;

use crate::attach::animated_pose::AnimatedPose;
use crate::body::body_state::BodyState;
use crate::body::particles::Particles;
use crate::render::any_mesh::{AnyMesh, handle_of};
use crate::render::carriers::{Carriers, DrawnSurface};
use crate::render::entity_space::EntitySpace;
use crate::render::from_mesh::driven_mesh::DrivenMesh;
use crate::render::mesh_times::MeshTimes;
use crate::render::rope_mesh::{RopeSurface, write_ropes};
use crate::render::surface::Surface;
use crate::render::views::Views;
use crate::transform::interpolation::{ShowsBetweenSteps, step_fraction};

/// The number of surfaces from which threads share them: to call threads takes as long as to write one.
const SHARED_FROM: usize = 8;

/// Records each cloth after a step. Cloths that did not move are not interpolated.
pub(crate) fn record_surfaces(
    mut surfaces: Query<(Ref<Particles>, &mut Surface, Option<&mut AnimatedPose>)>,
    mut times: ResMut<MeshTimes>,
) {
    let start = Instant::now();
    let record =
        |(particles, mut surface, posed): (Ref<Particles>, Mut<Surface>, Option<Mut<AnimatedPose>>)| {
            if let Some(mut posed) = posed {
                posed.record();
            }
            if particles.is_changed() {
                surface.record(&particles);
            } else {
                surface.settle();
            }
        };
    if surfaces.iter().len() < SHARED_FROM {
        surfaces.iter_mut().for_each(record);
    } else {
        surfaces.par_iter_mut().for_each(record);
    }
    times.record = start.elapsed();
}

/// Writes interpolated surfaces into the meshes of moving cloths, where they are seen.
///
/// Vertices leave their meshes meanwhile, so that threads share the work.
pub(crate) fn write_surfaces(
    mut surfaces: Query<
        (Entity, &mut Surface, AnyMesh, &GlobalTransform, Option<&mut Aabb>, Option<&DrivenMesh>),
        (Or<(With<Particles>, With<DrivenMesh>)>, Without<RopeSurface>),
    >,
    bodies: Query<(&BodyState, Option<&AnimatedPose>)>,
    carriers: Carriers,
    views: Views,
    mut ropes: Query<(Entity, &mut RopeSurface, &Mesh3d, &GlobalTransform, &mut Aabb), With<Particles>>,
    places: Query<&GlobalTransform>,
    mut meshes: ResMut<Assets<Mesh>>,
    between: Res<ShowsBetweenSteps>,
    time: Option<Res<Time<Fixed>>>,
    mut times: ResMut<MeshTimes>,
    mut near: Local<Vec<u32>>,
) {
    let start = Instant::now();
    let fraction = if between.0 { step_fraction(time.as_deref()) } else { 1.0 };
    write_ropes(&mut ropes, &mut meshes, &views, fraction);
    let mut count = 0;
    for (entity, mut surface, mesh, transform, aabb, driven) in &mut surfaces {
        let Some(mesh) = handle_of(mesh) else { continue };
        let (body, posed) = bodies.get(driven.map_or(entity, |driven| driven.driver)).ok().unzip();
        let posed = posed.flatten();
        // The cloth is drawn relative to the character as it was in these steps, so that it is on the character as
        // drawn now.
        let ahead = posed.and_then(|posed| posed.ahead(fraction, |joint| places.get(joint).ok()));
        let to_steps = ahead.map(|ahead| ahead.inverse());
        let from = to_steps.map(|to_steps| GlobalTransform::from(to_steps * transform.affine()));
        let Some(space) = EntitySpace::new(from.as_ref().unwrap_or(transform)) else {
            continue;
        };
        if !surface.must_be_written(&space, fraction) || surface.mesh != mesh.id() {
            continue;
        }
        let surface = &mut *surface;
        surface.carried.clear();
        if let Some(body) = body.filter(|_| posed.is_some())
            && surface.is_moving()
        {
            let drawn = DrawnSurface {
                corners: surface.corners(),
                layers: body.layers,
                fraction,
                to_steps: to_steps.unwrap_or_default(),
                origin: space.translation,
            };
            carriers.find(&drawn, &mut near, &mut surface.carried);
        }
        let bounds = surface.bounds(&space, fraction, surface.carried.greatest);
        if let Some(mut aabb) = aabb {
            aabb.set_if_neq(bounds);
        }
        if views.may_see(entity, &bounds, transform)
            && let Some(asset) = meshes.get_mut_untracked(mesh)
        {
            count += usize::from(surface.take_vertices(asset, space, fraction));
        }
    }
    if count < SHARED_FROM {
        surfaces.iter_mut().for_each(|(_, mut surface, ..)| surface.bypass_change_detection().write_taken());
    } else {
        surfaces
            .par_iter_mut()
            .for_each(|(_, mut surface, ..)| surface.bypass_change_detection().write_taken());
    }
    for (_, mut surface, mesh, _, aabb, _) in &mut surfaces {
        let (true, Some(mesh)) = (surface.has_taken(), handle_of(mesh)) else { continue };
        if let Some(mut asset) = meshes.get_mut(mesh)
            && let Some(bounds) = surface.put_back(&mut asset)
            && let Some(mut aabb) = aabb
        {
            aabb.set_if_neq(bounds);
        }
    }
    times.write = start.elapsed();
}
