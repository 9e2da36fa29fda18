//! Friction in listed bends: their plastic sums follow the weighted sums, and their rests follow the surface.
//!
//! Threads of whole grids do the same in lanes (`direct/thread_friction.rs`).
//!
//! Design: `docs/design/bending.md`.

use glam::Vec3;

use crate::simd::columns::{Cell, LANES};
use crate::state::bending_friction::Slip;
use crate::state::bends::{Bends, ListedBend};
use crate::state::body::Body;
use crate::state::layout::Layout;
use crate::state::particles::Particles;
use crate::state::topology::Topology;

/// Lets the friction of a body's listed bends slip, and finds their rests.
pub(crate) fn follow(body: &mut Body) {
    let Body { particles, topology, context, .. } = body;
    let Bends { listed, have_rests, .. } = &topology.bends;
    let Particles { position, plastic, layout, .. } = particles;
    let rests = &mut context.bends.listed_rests;
    if !have_rests {
        rests.clear();
        return;
    }
    if topology.bends.has_friction() {
        if layout.is_torn() {
            plastic.reserve_threads(layout);
        } else if plastic.edges.len() != listed.len() {
            plastic.edges.clear();
            plastic.edges.extend(listed.iter().map(|bend| bend.rest));
        }
    }
    rests.resize(listed.len(), Vec3::ZERO);
    for (index, (bend, at_rest)) in listed.iter().zip(rests).enumerate() {
        let places = places(&position.cells, bend);
        let normal = bend.normal(places);
        let mut rest = bend.rest;
        if let Some(slip) = bend.slip {
            let followed = slip.follow(bend.plastic(index, plastic), bend.sum(places).dot(normal));
            bend.set_plastic(index, plastic, followed);
            rest = Slip::rest(rest, followed);
        }
        *at_rest = normal * rest;
    }
}

/// The positions of a bend's particles.
pub(crate) fn places(position: &[Cell], bend: &ListedBend) -> [Vec3; 4] {
    bend.slots.map(|slot| position[slot as usize / LANES].get(slot as usize % LANES))
}

/// What friction keeps of the bends across the edges of a piece of a mesh, whose `origins` are the indices of its `particles` in the
/// whole. Bends that the whole has not are held as they are.
pub(crate) fn kept_edges(
    whole: &Body,
    topology: &Topology,
    particles: &Particles,
    origins: &[u32],
) -> Vec<f32> {
    if !topology.bends.has_friction() || topology.layout.is_torn() {
        return Vec::new();
    }
    // By their corners, those of the edge in order and those across it too; negative if one of the two pairs is turned.
    let keyed = |corners: [u32; 4], sum: f32| {
        let [a, b, c, d] = corners;
        let is_turned = (a > b) != (c > d);
        ([a.min(b), a.max(b), c.min(d), c.max(d)], if is_turned { -sum } else { sum })
    };
    let corner = |layout: &Layout, slot: u32| layout.index(slot as usize).unwrap_or_default();
    let old = whole.topology.bends.listed.iter().zip(&whole.particles.plastic.edges);
    let mut kept: Vec<([u32; 4], f32)> = old
        .map(|(bend, &sum)| keyed(bend.slots.map(|slot| corner(&whole.topology.layout, slot) as u32), sum))
        .collect();
    kept.sort_unstable_by_key(|&(corners, _)| corners);
    let of_bend = |bend: &ListedBend| {
        let corners = bend.slots.map(|slot| origins[corner(&topology.layout, slot)]);
        let (corners, sign) = keyed(corners, 1.0);
        match kept.binary_search_by_key(&corners, |&(corners, _)| corners) {
            Ok(place) => kept[place].1 * sign,
            Err(_) => {
                let places = places(&particles.position.cells, bend);
                let sum = bend.sum(places).dot(bend.normal(places));
                bend.slip.map_or(sum, |slip| slip.balanced(bend.rest, sum))
            }
        }
    };
    topology.bends.listed.iter().map(of_bend).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::cloth::{ClothBuilder, ClothMaterial};
    use crate::build::mesh::cloth::MeshClothBuilder;
    use crate::constraint::direct::thread_friction;
    use crate::simd::isa::Isa;
    use crate::state::bending_friction::BendingFriction;
    use crate::state::bends::BendingRigidity;
    use crate::state::settings::BodySettings;

    /// A sheet that is bent about one of its diagonals, as a grid or as a mesh, in which friction has slipped.
    fn bent(is_mesh: bool) -> Body {
        let material = ClothMaterial {
            bending_rigidity: BendingRigidity::isotropic(1e-4),
            bending_friction: BendingFriction::isotropic(1e-3),
            ..ClothMaterial::default()
        };
        let grid = ClothBuilder::new(0.3, 0.3, 17, 17).material(material);
        let mut body = grid.build(BodySettings::default()).expect("valid");
        if is_mesh {
            let places = body.particles.positions().collect();
            let mesh = MeshClothBuilder::new(places, body.topology.faces().to_vec()).material(material);
            body = mesh.build(BodySettings::default()).expect("valid");
        }
        body.particles.arrange(&body.topology.layout);
        for i in 0..body.particles.len() {
            let flat = body.particles.position(i);
            let along = flat.dot(Vec3::new(1.0, -1.0, 0.0));
            body.particles.set_position(i, flat + Vec3::Z * 5.0 * along * along);
        }
        follow(&mut body);
        thread_friction::follow(&mut body, Isa::detected());
        body
    }

    /// Greatest distance of a plastic sum from its weighted sum, in parts of its reach.
    fn farthest(body: &Body) -> f32 {
        let bends = body.topology.bends.listed.iter().enumerate();
        let off = bends.filter_map(|(index, bend)| {
            let places = places(&body.particles.position.cells, bend);
            let sum = bend.sum(places).dot(bend.normal(places));
            Some((bend.plastic(index, &body.particles.plastic) - sum).abs() / bend.slip?.reach)
        });
        off.fold(0.0, f32::max)
    }

    /// No plastic sum changes its sign or its bend where a sheet tears, though particles get other indices: each is still within reach of
    /// the weighted sum that it has followed.
    #[test]
    fn a_tear_leaves_plastic_sums_with_their_bends() {
        for is_mesh in [false, true] {
            let mut body = bent(is_mesh);
            // Not quite through the middle of a square; it ends inside.
            for [from, to] in [
                [Vec3::new(0.031, 0.1, 0.0), Vec3::new(0.21, -0.19, 0.0)],
                [Vec3::new(-0.1, -0.11, 0.0), Vec3::new(0.5, -0.13, 0.0)],
            ] {
                let wide = Vec3::Z;
                let blade = [[from - wide, to - wide, to + wide], [from - wide, to + wide, from + wide]];
                let cut = body.cut(&blade).expect("can be cut").expect("the blade must meet the cloth");
                for body in cut.pieces.iter().map(|piece| &piece.body).chain([&body]) {
                    let count = body.topology.bends.listed.len();
                    assert!(count > 50, "{count} bends");
                    let farthest = farthest(body);
                    // The front of a thread beside a crack is not quite where it was.
                    assert!(farthest < 1.5, "a mesh: {is_mesh}: {farthest} times the reach");
                }
            }
        }
    }
}
