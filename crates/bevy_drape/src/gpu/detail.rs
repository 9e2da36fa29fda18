//! Level of detail of bodies on the GPU: fewer substeps with growing distance, then none. They keep their particles.

use bevy::ecs::entity_disabling::Disabled;
use bevy::math::Vec3A;
use bevy::prelude::*;
use drape_solver::world::bounds::Bounds;

use crate::body::activity::Activity;
use crate::body::on_gpu::OnGpu;
use crate::detail::change::{freeze, is_valid};
use crate::detail::level::{CurrentDetail, DetailLevel, LevelOfDetail};
use crate::gpu::bodies::GpuBodies;
use crate::gpu::components::GpuBody;
use crate::gpu::report::LastReport;
use crate::refusal::Refusals;
use crate::viewer::View;

/// Gives each body the level that its distance asks for: when a viewer has moved, and when the body has been reported, or carried along while it was frozen.
pub(crate) fn choose_detail_on_gpu(
    mut on_gpu: Query<
        (
            Entity,
            Option<Ref<LevelOfDetail>>,
            &mut CurrentDetail,
            Ref<GpuBody>,
            &OnGpu,
            &mut LastReport,
            Ref<GlobalTransform>,
            &mut Activity,
        ),
        Allow<Disabled>,
    >,
    mut view: View,
    mut bodies: ResMut<GpuBodies>,
    mut refusals: ResMut<Refusals>,
) {
    let is_all = view.is_new();
    let Some(world) = bodies.world.as_mut() else { return };
    for (entity, detail, mut current, body, parts, mut last, transform, mut activity) in &mut on_gpu {
        let is_changed = detail.as_ref().is_some_and(DetectChanges::is_changed);
        if !(is_all || is_changed || body.is_changed() || last.is_changed() || transform.is_changed()) {
            continue;
        }
        if matches!(*activity, Activity::Resting | Activity::Culled) {
            continue;
        }
        let detail = detail.as_deref().filter(|detail| is_valid(detail, entity, &mut refusals));
        let anchor = transform.affine();
        let is_carried =
            parts.follows_entity(*activity) && anchor != parts.state.anchor && anchor.is_finite();
        let way = if is_carried { anchor.translation - parts.state.anchor.translation } else { Vec3A::ZERO };
        let Bounds { low, high } = last.bounds;
        let bounds = Bounds::new(low + Vec3::from(way), high + Vec3::from(way));
        let (level, spent) = LevelOfDetail::spent_at(detail, view.distance(bounds), current.level);
        let DetailLevel { most_substeps, frozen, .. } = spent;
        let is_new = current.set_if_neq(CurrentDetail { level, most_substeps, ..*current });
        if is_new || body.is_changed() {
            // Never more than in its own settings, which are valid.
            let _ = world.set_substeps(body.id(), current.limit(parts.state.settings).substeps);
        }
        freeze(&mut activity, frozen);
        if is_carried && *activity == Activity::Active {
            last.was_carried = true;
        }
    }
}

/// Has the body looked at in the next step that loses its [`LevelOfDetail`].
pub(crate) fn note_lost_detail_on_gpu(
    lost: On<Remove<LevelOfDetail>>,
    mut reports: Query<&mut LastReport, Allow<Disabled>>,
) {
    if let Ok(mut last) = reports.get_mut(lost.entity) {
        last.set_changed();
    }
}
