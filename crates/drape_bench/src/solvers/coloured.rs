//! The naive code with two changes: sticks in independent order, and real substeps.

use crate::scenes::model::Model;
use crate::scenes::scene::Scene;
use crate::solvers::options::SolverOptions;
use crate::solvers::scalar_loop::ScalarLoop;

/// The naive loop with sticks in an order in which neighbours share no particle, and with real substeps.
pub fn coloured(scene: &Scene, options: &SolverOptions) -> ScalarLoop {
    ScalarLoop::new(scene, &independent_order(&scene.model), options.substeps, options.sweeps)
}

/// All sticks, family by family, each split into batches that share no particle.
fn independent_order(model: &Model) -> Vec<[u32; 2]> {
    let mut order = Vec::new();
    for family in &model.families {
        let mut batches: Vec<Vec<[u32; 2]>> = Vec::new();
        // A bit for each batch that a particle is in already.
        let mut used = vec![0_u64; model.positions.len()];
        for &stick in &family.sticks {
            let [a, b] = stick.map(|end| end as usize);
            let batch = (used[a] | used[b]).trailing_ones().min(u64::BITS - 1) as usize;
            used[a] |= 1 << batch;
            used[b] |= 1 << batch;
            if batches.len() <= batch {
                batches.resize_with(batch + 1, Vec::new);
            }
            batches[batch].push(stick);
        }
        order.extend(batches.concat());
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::model::Pins;
    use crate::scenes::{mesh, sheet};

    #[test]
    fn the_order_has_every_stick_once_and_neighbours_share_no_particle() {
        let mesh = mesh::mesh(1000, Pins::Corners).expect("a mesh");
        for (model, batches) in [(sheet::sheet(9, Pins::Corners), 12), (mesh, 40)] {
            let order = independent_order(&model);
            let sorted = |mut sticks: Vec<[u32; 2]>| {
                sticks.sort_unstable();
                sticks
            };
            let shares = |pair: &&[[u32; 2]]| pair[0].iter().any(|end| pair[1].contains(end));
            // Only where one batch ends and the next begins.
            assert!(order.windows(2).filter(shares).count() < batches);
            assert_eq!(sorted(order), sorted(model.natural_order));
        }
    }
}
