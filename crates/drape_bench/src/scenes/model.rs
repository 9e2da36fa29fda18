//! One body as data that every solver can load.

use clap::ValueEnum;
use drape_solver::StickKind;
use drape_solver::glam::Vec3;
use serde::Serialize;

use crate::scenes::world::MASS;

/// The pinned particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Pins {
    /// The two corners of one side.
    Corners,
    /// That whole side.
    Edge,
    /// The first particle of a rope.
    #[value(skip)]
    Start,
}

/// Sticks of one kind, as pairs of particle indices, in the order in which a program would list them.
#[derive(Clone, Debug)]
pub struct Family {
    /// The purpose of the sticks.
    pub kind: StickKind,
    /// Their ends.
    pub sticks: Vec<[u32; 2]>,
    /// On a grid, the number of columns to the right and rows down from one end to the other.
    pub offset: [i32; 2],
}

/// A body: particles, pins and sticks.
#[derive(Clone, Debug)]
pub struct Model {
    /// Starting positions in metres: the rest pose.
    pub positions: Vec<Vec3>,
    /// Columns and rows, if the particles form a grid.
    pub grid: Option<[u32; 2]>,
    /// The pinned particles, ascending.
    pub pinned: Vec<u32>,
    /// The sticks, in an order of families that gains no energy.
    pub families: Vec<Family>,
    /// All sticks in natural order: as a plain loop over the body would meet them.
    pub natural_order: Vec<[u32; 2]>,
}

impl Model {
    /// Inverse masses in 1/kg, 0 for pins. All particles have equal masses.
    pub fn inverse_masses(&self) -> Vec<f32> {
        let mut inverse = vec![self.positions.len() as f32 / MASS; self.positions.len()];
        for &pin in &self.pinned {
            inverse[pin as usize] = 0.0;
        }
        inverse
    }

    /// The distance at rest between the ends of a stick, in metres.
    pub fn rest_length(&self, [a, b]: [u32; 2]) -> f32 {
        self.positions[a as usize].distance(self.positions[b as usize])
    }

    /// Number of sticks.
    pub fn stick_count(&self) -> usize {
        self.families.iter().map(|family| family.sticks.len()).sum()
    }

    /// The sticks that keep the body from stretching.
    pub fn structural(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let structural = self.families.iter().filter(|family| family.kind == StickKind::Structural);
        structural.flat_map(|family| family.sticks.iter().copied())
    }
}
