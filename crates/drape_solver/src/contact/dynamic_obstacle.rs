//! Obstacles that contacts push around within the step.
//!
//! An obstacle with a [`RigidBody`](crate::RigidBody) flies freely from substep to substep. Each contact splits its
//! push between the obstacle and the particle or ball by their inverse masses at the contact point, as between two
//! balls. The next contact sees the obstacle in its new pose. So no contact gains energy, however light the obstacle
//! is.
//!
//! Design: `docs/design/dynamic_obstacles.md`.

use crate::contact::body_contacts::BodyContacts;
use crate::contact::island_contacts::IslandContacts;
use crate::contact::mover::Mover;
use crate::state::obstacle::Obstacle;
use crate::state::obstacle_motion::MovedObstacle;

/// Lists the obstacles with rigid bodies that something may touch in this step.
pub(crate) fn detect(contacts: &mut IslandContacts, obstacles: &[Obstacle]) {
    let IslandContacts { bodies, ball_obstacle, movers, .. } = contacts;
    movers.clear();
    for index in bodies.iter().flat_map(BodyContacts::obstacles).chain(ball_obstacle.obstacles()) {
        let Some((body, drive)) = obstacles[index].starts_with() else { continue };
        if let Err(place) = movers.binary_search_by_key(&index, |mover| mover.obstacle) {
            movers.insert(place, Mover::new(index, &obstacles[index], body, drive));
        }
    }
}

/// Flies the movers freely to the end of the coming substep, `substep` seconds long.
pub(crate) fn begin_substep(movers: &mut [Mover], substep: f32) {
    movers.iter_mut().for_each(|mover| mover.begin_substep(substep));
}

/// Writes the places and motions of the movers at the end of the step.
pub(crate) fn finish(movers: &[Mover], moved: &mut Vec<MovedObstacle>) {
    moved.clear();
    moved.extend(movers.iter().map(|mover| MovedObstacle {
        obstacle: mover.obstacle,
        placement: mover.to,
        body: mover.end,
    }));
}
