//! The naive code with two changes: sticks in independent order, and real substeps.

use drape_solver::glam::Vec3;

use crate::contender::Contender;
use crate::naive::{Stick, collide, energy, integrate, relax, sticks};
use crate::workload::{STEP, Sheet};

/// As the naive loop, but no stick shares a particle with the ones next to it in the order.
pub struct Coloured {
    position: Vec<Vec3>,
    previous: Vec<Vec3>,
    inverse_mass: Vec<f32>,
    sticks: Vec<Stick>,
    substeps: u32,
    sweeps: u32,
}

impl Coloured {
    /// The sheet, with each family split into batches that share no particle.
    pub fn new(sheet: &Sheet, substeps: u32, sweeps: u32) -> Self {
        let position = sheet.positions();
        let mut pairs = Vec::new();
        for family in sheet.families() {
            // Along a line, a stick of length k meets the ones k before and after it: two colours do.
            let mut colours = [Vec::new(), Vec::new()];
            let mut used = vec![[false; 2]; position.len()];
            for pair in family {
                let ends = pair.map(|end| end as usize);
                let colour = usize::from(ends.iter().any(|&end| used[end][0]));
                for end in ends {
                    used[end][colour] = true;
                }
                colours[colour].push(pair);
            }
            pairs.extend(colours.concat());
        }
        Self {
            sticks: sticks(&position, &pairs),
            previous: position.clone(),
            position,
            inverse_mass: sheet.inverse_masses(),
            substeps,
            sweeps,
        }
    }
}

impl Contender for Coloured {
    fn step(&mut self) {
        let h = STEP / self.substeps as f32;
        for _ in 0..self.substeps {
            integrate(&mut self.position, &mut self.previous, &self.inverse_mass, h);
            for _ in 0..self.sweeps {
                relax(&mut self.position, &self.inverse_mass, &self.sticks);
                collide(&mut self.position, &self.inverse_mass);
            }
        }
    }

    fn positions(&self) -> Vec<Vec3> {
        self.position.clone()
    }

    fn energy(&self) -> f64 {
        energy(&self.position, &self.previous, &self.inverse_mass, STEP / self.substeps as f32)
    }

    fn bytes_per_particle(&self) -> f64 {
        28.0 + (size_of::<Stick>() * self.sticks.len()) as f64 / self.position.len() as f64
    }
}
