//! Tethers: no particle gets farther from a pin than the cloth between them is long.
//!
//! Kim, Chentanez and Müller-Fischer 2012, "Long Range Attachments". A tether is a one-sided stick from a
//! particle to a pin at the geodesic distance in the rest pose. Relaxation carries a pull only a few particles
//! down per sweep; a tether carries it the whole way at once, which takes the sag out of large cloths.
//!
//! ```text
//!   pin o-----------------.  the tether is slack inside the circle ...
//!        \    L          x   ... and a particle outside comes back to it
//!         '-------------'
//! ```
//!
//! Design: `docs/design/tethers.md`.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::Vec3;

use crate::constraint::projection::Projection;
use crate::constraint::stick::Joined;
use crate::motion::body_columns::BodyColumns;
use crate::simd::columns::{Columns, LANES};
use crate::simd::lanes::{Lanes3, load};
use crate::state::particles::Particles;
use crate::state::tethers::TetherPlan;

impl TetherPlan {
    /// Writes the positions of the pins to `places`; call it whenever they have moved. A freed pin, and one that is
    /// joined to an obstacle which would not feel the pull, gets NaN for a position, at which no tether acts.
    pub fn note_anchors(&self, particles: &Particles, places: &mut Columns) {
        places.reset(self.anchors.len());
        for (cell, anchor) in places.cells.iter_mut().zip(&self.anchors) {
            for lane in 0..LANES {
                let slot = anchor.slot(lane);
                let is_anchor = particles.is_anchor(slot);
                cell.set(lane, if is_anchor { particles.position.get(slot) } else { Vec3::NAN });
            }
        }
    }

    /// Pulls every particle of `cells` back to within its tethers' lengths, but by no more than the reach of `rest` at once. The cells are
    /// at `places` in the columns.
    #[inline(always)]
    pub fn project<S: Simd>(
        &self,
        simd: S,
        cells: Range<usize>,
        places: Range<usize>,
        joined: &mut Joined,
        rest: &BodyColumns,
        projection: impl Projection,
    ) {
        let BodyColumns { anchors, tether_reach: most, length_ratio, .. } = *rest;
        let zero = f32x16::splat(simd, 0.0);
        let most_squared = f32x16::splat(simd, most * most);
        for (cell, place) in cells.zip(places) {
            let ties = &self.ties[self.first[cell] as usize..self.first[cell + 1] as usize];
            if ties.is_empty() {
                continue;
            }
            let is_all_free = joined.common_mass[place] > 0.0;
            let mut position = Lanes3::load(simd, &joined.position[place]);
            for tie in ties {
                let delta = position.minus(Lanes3::load(simd, &anchors[tie.anchor as usize]));
                let distance_squared = delta.dot(delta);
                let length = load(simd, &tie.length) * length_ratio;
                let mut is_taut: mask32x16<S> = distance_squared.simd_gt(length * length);
                if !is_all_free {
                    is_taut &= load(simd, &joined.inverse_mass[place]).simd_gt(zero);
                }
                // The tethers of most ties are slack.
                if !is_taut.any_true() {
                    continue;
                }
                let mut part = projection.errors(simd, distance_squared, length);
                let is_too_far = (part * part * distance_squared).simd_gt(most_squared) & is_taut;
                if is_too_far.any_true() {
                    part = is_too_far.select(most / distance_squared.sqrt(), part);
                }
                position = position.minus(delta.times(part)).or(is_taut, position);
            }
            position.store(&mut joined.position[place]);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::build::topology_builder::TopologyBuilder;
    use crate::state::body::Body;
    use crate::state::layout::Layout;
    use crate::state::settings::BodySettings;
    use crate::state::tethers::Tethers;
    use crate::state::topology::{StickKind, StickMaterial};
    use crate::substep::order::BodyStage;
    use crate::substep::testing::run_stages;

    #[test]
    fn geodesic_tethers_run_along_the_chain_and_not_through_the_air() {
        // A chain folded into a hairpin: particle 4 lies beside the pin, but four links away.
        let edges = (0..4).map(|i| (i, i + 1, 1.0));
        let tethers = Tethers::geodesic(5, edges, &[0]);
        let lengths: Vec<f32> = tethers.iter().map(|(_, _, length)| length).collect();
        assert_eq!(lengths, [1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn each_particle_keeps_its_nearest_pins() {
        let rest: Vec<Vec3> = (0..20).map(|i| Vec3::X * i as f32).collect();
        let pins = [0, 1, 2, 3, 4, 5];
        let straight = Tethers::straight(&rest, &pins);
        let edges = (0..19).map(|i| (i, i + 1, 1.0));
        assert_eq!(straight, Tethers::geodesic(20, edges, &pins));
        let of_last: Vec<u32> = straight.iter().filter(|t| t.0 == 19).map(|(_, pin, _)| pin).collect();
        assert_eq!(of_last, [5, 4, 3, 2]);
    }

    /// The pins of one shoulder take one tether, and leave room for those of the other.
    #[test]
    fn pins_that_sticks_join_count_as_one() {
        let rest: Vec<Vec3> = (0..20).map(|i| Vec3::X * i as f32).collect();
        let mut builder = TopologyBuilder::new(&rest);
        builder
            .family(StickMaterial::rigid(StickKind::Structural), (0..19).map(|i| [i, i + 1]))
            .expect("valid");
        builder.geodesic_tethers(&[0, 1, 2, 3, 4, 18, 19]).expect("valid");
        let tethers = builder.build().expect("valid").tethers();
        let of_ten: Vec<u32> = tethers.iter().filter(|t| t.0 == 10).map(|&(_, pin, _)| pin).collect();
        assert_eq!(of_ten, [4, 18]);
    }

    /// However many pins there are: a tie is tested for all lanes of a cell.
    #[test]
    fn a_cell_of_many_pins_has_as_many_ties_as_its_particles_have_tethers() {
        let pin = |i: u32, rank: u32| 16 + (5 * i + 7 * rank + 3 * i * rank) % 32;
        let list = (0..16).flat_map(|i| (0..2).map(move |rank| (i, pin(i, rank), 1.0 + rank as f32)));
        let plan = TetherPlan::new(&Tethers::from_list(list.clone()), &Layout::Linear { count: 48 });
        assert_eq!(plan.first, [0, 2, 2, 2]);
        assert!(plan.list(&Layout::Linear { count: 48 }).into_iter().eq(list));
    }

    #[test]
    fn a_taut_tether_brings_the_particle_back_and_a_freed_pin_lets_go() {
        let positions = [Vec3::ZERO, Vec3::new(3.0, 4.0, 0.0)];
        let particles = Particles::new(Vec3::ZERO, &positions, &[0.0, 1.0]).expect("valid");
        let mut builder = TopologyBuilder::new(&positions);
        builder.tethers(Tethers::geodesic(2, [(0, 1, 2.5)], &[0])).expect("valid");
        let topology = Arc::new(builder.build().expect("valid"));
        let mut body = Body::new(particles, topology, BodySettings::default());
        let project = |body: &mut Body| {
            run_stages(body, 1.0, &[BodyStage::Integrate, BodyStage::Tethers]);
            body.particles.position(1)
        };
        assert!((project(&mut body) - Vec3::new(1.5, 2.0, 0.0)).length() < 1e-6);
        body.particles.set_inverse_mass(0, 1.0);
        body.particles.set_position(1, positions[1]);
        assert_eq!(project(&mut body), positions[1]);
    }

    #[test]
    fn of_an_edge_of_pins_the_nearest_alone_holds() {
        let rest: Vec<Vec3> = (0..12).map(|i| Vec3::new((i % 4) as f32, (i / 4) as f32, 0.0)).collect();
        let mut builder = TopologyBuilder::grid(&rest, 4, 3).expect("a grid");
        builder.grid_family(StickMaterial::rigid(StickKind::Structural), [1, 0]).expect("valid");
        builder.straight_tethers(&[0, 1, 3]).expect("valid");
        let topology = builder.build().expect("valid");
        let of_nine: Vec<_> = topology.tethers().into_iter().filter(|tether| tether.0 == 9).collect();
        assert_eq!(of_nine.iter().map(|tether| tether.1).collect::<Vec<_>>(), [1, 3]);
    }
}
