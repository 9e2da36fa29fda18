//! Particles that a limit on motion keeps in an obstacle.
//!
//! Design: `docs/design/characters.md`.

use crate::constants::{AT_LIMIT, LIMIT_CONFLICT_DEPTH};
use crate::contact::particle_obstacle::ObstacleContacts;
use crate::state::body::Body;
use crate::state::substep::Substep;

/// Counts the particles that a limit keeps in an obstacle, at the end of a step.
pub(crate) fn count_conflicts(contacts: &ObstacleContacts, body: &mut Body, substep: Substep) {
    let Body { particles, settings, context, .. } = body;
    let limit_conflicts = &mut context.limit_conflicts;
    limit_conflicts.clear();
    if particles.pose.limits.is_empty() {
        return;
    }
    for candidate in &contacts.candidates {
        let obstacle = &substep.obstacles[contacts.groups[usize::from(candidate.group)].obstacle];
        for slot in candidate.each_lane().map(|lane| candidate.slot(lane)) {
            let Some(([_, centre], reach)) = particles.pose.limits.get(slot) else { continue };
            let position = particles.position.get(slot);
            if particles.inverse_mass[slot] == 0.0 || position.distance(centre) < reach - AT_LIMIT {
                continue;
            }
            let local = obstacle.pose_at(1.0, particles.origin).to_local(position);
            let depth = settings.thickness - obstacle.shape().surface(local).distance;
            if depth > LIMIT_CONFLICT_DEPTH {
                limit_conflicts.push(slot as u32);
            }
        }
    }
    limit_conflicts.sort_unstable();
    limit_conflicts.dedup();
}
