//! Lets tied particles pull at the dynamic obstacles that they are tied to.
//!
//! Design: `docs/design/joints.md`.

use bevy::prelude::*;
use drape_solver::Placement;

use crate::attach::attachment::Attachment;
use crate::attach::attachment_state::AttachmentState;
use crate::body::particles::Particles;
use crate::environment::dynamic_obstacle::DynamicObstacle;
use crate::environment::moved_by_obstacle::MovedByObstacle;
use crate::environment::obstacle::Obstacle;
use crate::environment::solver_environment::SolverEnvironment;

/// Joins particles that are tied to dynamic obstacles with them for the coming step.
pub(crate) fn join_attached(
    mut bodies: Query<(&Attachment, &AttachmentState, &mut Particles)>,
    obstacles: Query<&GlobalTransform, (With<DynamicObstacle>, With<Obstacle>)>,
    riders: Query<(&GlobalTransform, &MovedByObstacle)>,
    solver: Res<SolverEnvironment>,
) {
    for (attachment, state, mut particles) in &mut bodies {
        // A body that slept since has kept those of its last request.
        particles.bypass_change_detection().clear_joints();
        for (place, tie) in attachment.ties.iter().enumerate() {
            let (obstacle, frame, transform) = match (obstacles.get(tie.entity), riders.get(tie.entity)) {
                (Ok(transform), _) => (tie.entity, Placement::default(), transform),
                (_, Ok((transform, &MovedByObstacle { obstacle, translation, rotation }))) => {
                    (obstacle, Placement { translation, rotation }, transform)
                }
                _ => continue,
            };
            let Some(slot) = solver.obstacles.slot(obstacle) else { continue };
            let scale = transform.scale();
            for held in state.held.iter().filter(|held| held.tie as usize == place) {
                let anchor = frame.translation + frame.rotation * (scale * held.local);
                particles.join(held.particle as usize, slot, anchor);
            }
            // One that moves moves all that hangs on it, however little.
            if solver.environment.obstacles[slot].is_moving() {
                particles.rouse();
            }
        }
    }
}
