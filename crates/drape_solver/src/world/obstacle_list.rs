//! The obstacles of a world: their names, and which of them move.

use glam::Vec3;

use crate::state::obstacle::Obstacle;
use crate::state::obstacle_motion::MovedObstacle;
use crate::state::obstacles::Obstacles;
use crate::world::id::{MemberId, ObstacleId};
use crate::world::slots::Slots;
use crate::world::waking::{Proxy, Waking};

/// The names of obstacles, whose indices change as others are taken out.
#[derive(Clone, Debug, Default)]
pub(crate) struct ObstacleList {
    /// The index of each obstacle.
    indices: Slots<usize>,
    /// The obstacle of each index.
    ids: Vec<ObstacleId>,
    /// Those that were added or edited since the last step.
    edited: Vec<ObstacleId>,
    /// Those that what hits them moves.
    flying: Vec<ObstacleId>,
}

impl ObstacleList {
    /// Adds an obstacle to the end of the list.
    pub fn add(&mut self, obstacles: &mut Obstacles, obstacle: Obstacle) -> ObstacleId {
        let id = ObstacleId(self.indices.insert(obstacles.push(obstacle)));
        self.ids.push(id);
        self.edited.push(id);
        id
    }

    /// Takes an obstacle out; what touched it wakes.
    pub fn remove(
        &mut self,
        obstacles: &mut Obstacles,
        id: ObstacleId,
        waking: &mut Waking<MemberId>,
    ) -> Option<Obstacle> {
        let index = self.indices.remove(id.0)?;
        self.ids.swap_remove(index);
        if let Some(moved) = self.ids.get(index)
            && let Some(of_moved) = self.indices.get_mut(moved.0)
        {
            *of_moved = index;
        }
        self.edited.retain(|&other| other != id);
        self.flying.retain(|&other| other != id);
        let obstacle = obstacles.swap_remove(index);
        waking.disturb(Proxy::of_obstacle(&obstacle));
        Some(obstacle)
    }

    pub fn index(&self, id: ObstacleId) -> Option<usize> {
        self.indices.get(id.0).copied()
    }

    /// The obstacle of an index.
    pub fn id(&self, index: usize) -> ObstacleId {
        self.ids[index]
    }

    /// All obstacles by index.
    pub fn ids(&self) -> &[ObstacleId] {
        &self.ids
    }

    /// Those that what hits them moves, by index.
    pub fn flying(&self) -> impl Iterator<Item = usize> + '_ {
        self.flying.iter().filter_map(|&id| self.index(id))
    }

    /// Hands an obstacle out to be changed; what touches it wakes.
    pub fn edit<'a>(
        &mut self,
        obstacles: &'a mut Obstacles,
        id: ObstacleId,
        waking: &mut Waking<MemberId>,
    ) -> Option<&'a mut Obstacle> {
        let obstacle = obstacles.get_mut(self.index(id)?)?;
        waking.disturb(Proxy::of_obstacle(obstacle));
        if !self.edited.contains(&id) {
            self.edited.push(id);
        }
        Some(obstacle)
    }

    /// Has obstacles with rigid bodies fly through the coming step, and what is in the way of any obstacle wake.
    pub fn begin_step(
        &mut self,
        obstacles: &mut Obstacles,
        gravity: Vec3,
        dt: f32,
        waking: &mut Waking<MemberId>,
    ) {
        for &id in &self.edited {
            let Some(obstacle) = self.index(id).map(|index| &obstacles[index]) else { continue };
            waking.disturb(Proxy::of_obstacle(obstacle));
            self.flying.retain(|&other| other != id);
            if obstacle.rigid_body().is_some() {
                self.flying.push(id);
            }
        }
        for &id in &self.flying {
            let Some(index) = self.index(id) else { continue };
            obstacles[index].fly(gravity, dt);
            if obstacles[index].is_moving() {
                waking.disturb(Proxy::of_obstacle(&obstacles[index]));
            }
        }
    }

    /// Ends a step: obstacles stand still where it has brought them.
    pub fn end_step<'a>(
        &mut self,
        obstacles: &mut Obstacles,
        moved: impl Iterator<Item = &'a MovedObstacle>,
    ) {
        moved.for_each(|moved| obstacles[moved.obstacle].land(moved));
        for id in self.edited.iter().chain(&self.flying) {
            if let Some(&index) = self.indices.get(id.0)
                && obstacles[index].is_moving()
            {
                let placement = obstacles[index].placement();
                obstacles[index].teleport(placement);
            }
        }
        self.edited.clear();
    }
}
