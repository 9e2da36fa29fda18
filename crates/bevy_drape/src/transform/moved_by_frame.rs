//! Interpolation of transforms that are set once a frame, for fixed steps.
//!
//! ```text
//!   frame            1                   2                   3
//!   pose          P1 |                P2 |                P3 |
//!   fixed steps      |    s     s     s  |  s     s     s    |
//!   seen             |              between P0 and P1        between P1 and P2
//! ```
//!
//! An animation moves a character once a frame, after the fixed steps of that frame. At 10 frames per second the first
//! of six steps would see the whole motion and the others none; at 144 a step would see that of two or three frames. So
//! each step sees an interpolated pose between the last two frames, by the time of the step within the frame: one frame
//! late, and as smooth as the animation.

use bevy::app::RunFixedMainLoopSystems;
use bevy::prelude::*;
use bevy::time::Virtual;

use crate::attach::world_motion::TeleportCloth;
use crate::rigid_motion::between;
use crate::transform::interpolation::Interpolated;

/// Marks an entity whose [`Transform`] is set once a frame, by an animation or in `Update`. Instead of a jump, the
/// fixed steps of a frame see it interpolated between the last two frames. After the steps the transform is restored.
///
/// The joints of a skinned [`ClothMesh`](crate::render::from_mesh::cloth_mesh::ClothMesh) get it automatically, and so do those of a
/// [`BoneCloth`](crate::bones::BoneCloth) or of [`SpringBones`](crate::bones::SpringBones) and all that they hang on. Add it
/// to the character's root too if that moves in `Update`. Motion faster than 100 m/s is not interpolated, and neither
/// is any motion while a [`TeleportCloth`] waits. Transforms that are set in the fixed loop, and [`Interpolated`] ones,
/// are left alone.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform, FramePoses)]
pub struct MovedByFrame;

/// Marks an entity, if it is there, and all that it hangs on.
pub(crate) fn move_by_frames(commands: &mut Commands, entity: Entity, parents: &Query<&ChildOf>) {
    for entity in core::iter::once(entity).chain(parents.iter_ancestors(entity)) {
        if let Ok(mut entity) = commands.get_entity(entity) {
            entity.insert_if_new(MovedByFrame);
        }
    }
}

/// Transforms of the last two frames; none before the first.
#[derive(Component, Clone, Copy, Debug, Default)]
pub(crate) struct FramePoses {
    ends: Option<[Transform; 2]>,
    /// Transform written for the last step; none after a change by others.
    written: Option<Transform>,
}

impl FramePoses {
    /// Makes the place `origin` the origin of the coordinates.
    pub fn shift_origin(&mut self, origin: Vec3) {
        let ends = self.ends.iter_mut().flatten();
        ends.chain(&mut self.written).for_each(|place| place.translation -= origin);
    }
}

/// Speed in m/s above which a motion is a jump, shown at once.
const JUMP_SPEED: f32 = 100.0;

type Moved<'w, 's> = Query<
    'w,
    's,
    (&'static mut Transform, &'static mut FramePoses),
    (With<MovedByFrame>, Without<Interpolated>),
>;

/// Interpolates transforms that are set once a frame for fixed steps.
#[derive(Clone, Copy, Debug, Default)]
pub struct MovedByFramePlugin;

impl Plugin for MovedByFramePlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<MovedByFrame>()
            .add_systems(RunFixedMainLoop, note_poses.in_set(RunFixedMainLoopSystems::BeforeFixedMainLoop))
            .add_systems(FixedFirst, show_pose_of_step)
            .add_systems(
                RunFixedMainLoop,
                show_pose_of_frame.in_set(RunFixedMainLoopSystems::AfterFixedMainLoop),
            );
    }
}

/// Records transforms before the steps of a frame. Nothing is interpolated while a cloth waits to be teleported: its
/// character has arrived already.
fn note_poses(
    mut moved: Moved,
    teleports: Query<(), With<TeleportCloth>>,
    frame: Option<Res<Time<Virtual>>>,
) {
    let farthest = JUMP_SPEED * frame.map_or(f32::INFINITY, |frame| frame.delta_secs());
    for (transform, mut poses) in &mut moved {
        let [_, last] = poses.ends.unwrap_or([*transform; 2]);
        let is_jump = last.translation.distance(transform.translation) > farthest;
        let start = if is_jump || !teleports.is_empty() { *transform } else { last };
        poses.ends = Some([start, *transform]);
        poses.written = Some(*transform);
    }
}

/// Shows interpolated transforms before each step.
fn show_pose_of_step(mut moved: Moved, fixed: Res<Time<Fixed>>, frame: Option<Res<Time<Virtual>>>) {
    let length = frame.map_or(0.0, |frame| frame.delta_secs());
    let fraction = if length > 0.0 { 1.0 - fixed.overstep().as_secs_f32() / length } else { 1.0 };
    for (mut transform, mut poses) in &mut moved {
        let (Some([start, end]), Some(written)) = (poses.ends, poses.written) else { continue };
        if *transform != written {
            // Set by another system in the fixed loop, which has priority.
            poses.written = None;
            poses.ends = Some([*transform; 2]);
            continue;
        }
        let shown = between(&start, &end, fraction.clamp(0.0, 1.0));
        poses.written = Some(shown);
        transform.set_if_neq(shown);
    }
}

/// Restores the frame's transforms after its steps.
fn show_pose_of_frame(mut moved: Moved) {
    for (mut transform, mut poses) in &mut moved {
        match (poses.ends, poses.written) {
            (Some([_, end]), Some(written)) if *transform == written => _ = transform.set_if_neq(end),
            _ => poses.ends = Some([*transform; 2]),
        }
    }
}
