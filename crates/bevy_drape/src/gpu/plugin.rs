//! Registers the bodies on the GPU.

use bevy::camera::visibility::VisibilitySystems;
use bevy::core_pipeline::schedule::camera_driver;
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::mesh::{
    mark_2d_meshes_as_changed_if_their_assets_changed, mark_3d_meshes_as_changed_if_their_assets_changed,
};
use bevy::prelude::*;
use bevy::render::mesh::allocator::MeshAllocator;
use bevy::render::renderer::RenderGraph;
use bevy::render::{ExtractSchedule, Render, RenderApp, RenderStartup, RenderSystems, init_gpu_resource};
use bevy::transform::TransformSystems;

use crate::detail::change::choose_detail;
use crate::gpu::bodies::GpuBodies;
use crate::gpu::components::{GpuBody, SolveOnGpu};
use crate::gpu::detail::{choose_detail_on_gpu, note_lost_detail_on_gpu};
use crate::gpu::moves::{
    bring_back_drivers, bring_back_released, move_to_gpu, move_tubes, remove_from_gpu, watch_components,
};
use crate::gpu::pins::move_pins_on_gpu;
use crate::gpu::renderer::{
    SlabWriters, allow_writing, forget_device, note_moved_meshes, take_shown, write_slabs,
};
use crate::gpu::report::{take_report, write_bounds};
use crate::gpu::rest::wake_on_gpu;
use crate::gpu::shown::{ShownBodies, list_shown};
use crate::gpu::step::{begin_frame, note_motion, step_on_gpu};
use crate::render::visibility::hide_culled;
use crate::render::write_surfaces::write_surfaces;
use crate::schedule::{DrapeSchedule, DrapeSystems, ScenePhase};
use crate::step::form_islands::form_islands;
use crate::step::run::run_drape_schedule;

/// Solves and draws bodies with [`SolveOnGpu`] on the GPU. Needs the [`MeshPlugin`](crate::render::MeshPlugin) of the same schedule.
#[derive(Clone, Copy, Debug)]
pub struct GpuPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl GpuPlugin {
    /// For steps taken in `schedule`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self { schedule: schedule.intern() }
    }
}

impl Plugin for GpuPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(SolveOnGpu, GpuBody)>()
            .init_resource::<GpuBodies>()
            .init_resource::<ShownBodies>()
            .add_observer(bring_back_released)
            .add_observer(remove_from_gpu)
            .add_observer(note_lost_detail_on_gpu)
            .add_systems(First, begin_frame)
            .add_systems(
                DrapeSchedule,
                (
                    // Before they are made coarser, and before obstacles are read: those that were out of reach may be met by these bodies.
                    (bring_back_drivers, move_to_gpu)
                        .chain()
                        .after(ScenePhase::CutBodies)
                        .before(ScenePhase::ChooseDetail),
                    choose_detail_on_gpu.in_set(ScenePhase::ChooseDetail).after(choose_detail),
                    move_pins_on_gpu.in_set(ScenePhase::MovePins),
                    (wake_on_gpu, step_on_gpu).chain().in_set(DrapeSystems::FormIslands).before(form_islands),
                ),
            )
            .add_systems(self.schedule, note_motion.after(run_drape_schedule))
            .add_systems(
                PostUpdate,
                (
                    (take_report, write_bounds)
                        .chain()
                        .after(write_surfaces)
                        .after(TransformSystems::Propagate)
                        .before(hide_culled)
                        .before(VisibilitySystems::CalculateBounds),
                    (move_tubes, list_shown)
                        .chain()
                        .after(TransformSystems::Propagate)
                        .after(VisibilitySystems::VisibilityPropagate)
                        .after(write_bounds)
                        .after(write_surfaces)
                        // A change of the asset alone changes nothing that is listed.
                        .ambiguous_with(mark_2d_meshes_as_changed_if_their_assets_changed)
                        .ambiguous_with(mark_3d_meshes_as_changed_if_their_assets_changed),
                ),
            );
        watch_components(app);
    }

    /// Bevy's plugins have been built by now, in whatever order they were added.
    fn finish(&self, app: &mut App) {
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else { return };
        render_app
            .init_resource::<ShownBodies>()
            .init_resource::<SlabWriters>()
            .add_systems(
                RenderStartup,
                (allow_writing.before(init_gpu_resource::<MeshAllocator>), forget_device),
            )
            .add_systems(ExtractSchedule, take_shown)
            .add_systems(Render, note_moved_meshes.in_set(RenderSystems::ExtractCommands))
            .add_systems(RenderGraph, write_slabs.before(camera_driver));
    }
}
