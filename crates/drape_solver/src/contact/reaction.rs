//! Reactions on obstacles: the exact opposite of every push that contacts and friction gave to bodies and balls.
//!
//! A push changes a displacement by `d`, and so the momentum by `m d / h` with the substep `h`. For obstacles that ask,
//! contacts sum up these `m d` as they push; after each substep the sums are added up here in double precision, with
//! the moments of their points. Overlaps that are taken out in position only change no momentum, so they do not count.
//!
//! Design: `docs/design/dynamic_obstacles.md`.

use glam::DVec3;

use crate::contact::island_contacts::IslandContacts;
use crate::contact::joint;
use crate::contact::mover::{Mover, mover};
use crate::contact::obstacle_push::ObstaclePush;
use crate::state::ball::Ball;
use crate::state::body::Body;
use crate::state::obstacle::Obstacle;
use crate::state::obstacle_motion::Reaction;
use crate::state::substep::Substep;

/// The sums of one step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reactions {
    /// True if an obstacle that asks for its reactions may push anything in this step.
    is_on: bool,
    /// One for each obstacle, in order of the obstacles.
    sums: Vec<ReactionSum>,
}

/// The sum of the pushes of one obstacle on bodies and balls.
#[derive(Clone, Copy, Debug)]
struct ReactionSum {
    obstacle: usize,
    /// In newton seconds.
    impulse: DVec3,
    /// In newton metre seconds, about the world's origin.
    angular_impulse: DVec3,
    /// Place of the obstacle at the end of the step, if nothing moves it.
    end: DVec3,
}

impl Reactions {
    pub fn clear(&mut self) {
        self.is_on = false;
        self.sums.clear();
    }

    /// True if the step must go substep by substep.
    pub fn is_on(&self) -> bool {
        self.is_on
    }

    fn add(&mut self, obstacles: &[Obstacle], substep: f32, given: ObstaclePush) {
        let ObstaclePush { obstacle, point, push, moment } = given;
        let [impulse, couple] = [push, moment].map(|sum| sum.as_dvec3() / f64::from(substep));
        let angular_impulse = point.cross(impulse) + couple;
        // A body that is no longer finite is removed, and its momentum with it.
        if !(impulse.is_finite() && angular_impulse.is_finite()) {
            return;
        }
        match self.sums.binary_search_by_key(&obstacle, |sum| sum.obstacle) {
            Ok(place) => {
                self.sums[place].impulse += impulse;
                self.sums[place].angular_impulse += angular_impulse;
            }
            Err(place) => {
                let end = obstacles[obstacle].placement().translation.as_dvec3();
                self.sums.insert(place, ReactionSum { obstacle, impulse, angular_impulse, end });
            }
        }
    }
}

/// Finds the obstacles near bodies and balls that ask for their reactions.
pub(crate) fn detect(reactions: &mut Reactions, contacts: &mut IslandContacts, obstacles: &[Obstacle]) {
    let asks = |index: usize| obstacles[index].keeps_account();
    for contacts in &mut contacts.bodies {
        reactions.is_on |= contacts.obstacles.mark_asking(asks);
        reactions.is_on |= contacts.faces.obstacles().any(asks);
        reactions.is_on |= contacts.embedded.obstacles().any(asks);
        reactions.is_on |= !contacts.joints.is_empty();
    }
    reactions.is_on |= contacts.ball_obstacle.obstacles().any(asks);
}

/// Adds the pushes of the substep that has just ended.
pub(crate) fn gather(
    reactions: &mut Reactions,
    contacts: &IslandContacts,
    bodies: &[Body],
    balls: &[Ball],
    substep: Substep,
) {
    if !reactions.is_on {
        return;
    }
    let mut add = |given: ObstaclePush| {
        if substep.obstacles[given.obstacle].reports_reaction() {
            reactions.add(substep.obstacles, substep.duration, given);
        }
    };
    for (body, contacts) in bodies.iter().zip(&contacts.bodies) {
        let particles = &body.particles;
        let origin = particles.origin.as_dvec3();
        for (obstacle, slot, moved) in contacts.obstacles.given() {
            let point = origin + particles.position.get(slot).as_dvec3();
            add(ObstaclePush::at(point, obstacle, moved / particles.inverse_mass[slot]));
        }
        contacts.faces.given(particles).for_each(&mut add);
        contacts.embedded.given(particles).for_each(&mut add);
        joint::given(&contacts.joints).for_each(&mut add);
    }
    contacts.ball_obstacle.given(balls).for_each(add);
}

/// Writes the reactions of the step, in order of the obstacles.
pub(crate) fn finish(sums: &Reactions, movers: &[Mover], reactions: &mut Vec<Reaction>) {
    reactions.clear();
    reactions.extend(sums.sums.iter().map(|sum| {
        let end = mover(movers, sum.obstacle).map_or(sum.end, Mover::centre);
        let angular_impulse = sum.angular_impulse - end.cross(sum.impulse);
        Reaction {
            obstacle: sum.obstacle,
            impulse: -sum.impulse.as_vec3(),
            angular_impulse: -angular_impulse.as_vec3(),
        }
    }));
}
