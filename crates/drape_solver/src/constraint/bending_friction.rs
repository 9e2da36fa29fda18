//! Friction in listed bends: their plastic sums follow the weighted sums, and their rests follow the surface.
//!
//! Threads of whole grids do the same in lanes (`direct/thread_friction.rs`).
//!
//! Design: `docs/design/bending.md`.

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::Vec3;

use crate::constraint::listed_bend::{PlacedBends, for_each_group, number_of};
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::{Isa, Kernel};
use crate::simd::lanes::{Lanes3, load};
use crate::simd::rows::{Rows, store_rows};
use crate::state::bending_friction::{PlasticBends, Slip};
use crate::state::bends::{BendScratch, Bends, ListedBend};
use crate::state::body::Body;
use crate::state::layout::Layout;
use crate::state::particles::Particles;
use crate::state::topology::Topology;

/// Lets the friction of a body's listed bends slip, and finds their rests.
pub(crate) fn follow(body: &mut Body, isa: Isa) {
    let Body { particles, topology, context, .. } = body;
    let bends = &topology.bends;
    let BendScratch { places, listed_rests, .. } = &mut context.bends;
    if !bends.have_rests {
        listed_rests.clear();
        return;
    }
    let Particles { position, inverse_mass, plastic, layout, .. } = particles;
    if bends.has_friction() {
        if layout.is_torn() {
            plastic.reserve_threads(layout);
        } else if plastic.edges.len() != bends.listed.len() {
            plastic.edges.clear();
            plastic.edges.extend(bends.listed.iter().map(|bend| bend.rest));
        }
    }
    listed_rests.resize(bends.listed.len().next_multiple_of(LANES), [0.0; 4]);
    isa.run(Follow {
        bends,
        position: &position.cells,
        inverse_mass: inverse_mass.as_chunks().0,
        places,
        plastic,
        rests: listed_rests.as_chunks_mut().0,
    });
}

/// All listed bends of a body.
struct Follow<'a> {
    bends: &'a Bends,
    position: &'a [Cell],
    inverse_mass: &'a [[f32; LANES]],
    places: &'a mut Rows,
    plastic: &'a mut PlasticBends,
    rests: &'a mut [[[f32; 4]; LANES]],
}

impl Kernel for Follow<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { bends: Bends { listed, .. }, position, inverse_mass, places, plastic, rests } = self;
        places.take_all(simd, position, inverse_mass);
        let places = places.window();
        // A list has bends of one kind.
        let are_threads = listed.first().is_some_and(|bend| bend.thread.is_some());
        for_each_group(
            listed,
            #[inline(always)]
            |index, group| {
                let bends = PlacedBends::load(simd, &places, group);
                let (normal, is_normal) = bends.normal(simd, are_threads);
                let at_rest = number_of(simd, group, |bend| bend.rest);
                let reach = number_of(simd, group, |bend| bend.slip.map_or(0.0, |slip| slip.reach));
                let has_friction = reach.simd_gt(f32x16::splat(simd, 0.0));
                let mut rest = at_rest;
                if has_friction.any_true() {
                    let end = listed.len().min((index + 1) * LANES);
                    let mut kept = [0.0; LANES];
                    for (i, kept) in (index * LANES..end).zip(&mut kept) {
                        *kept = listed[i].plastic(i, plastic);
                    }
                    let sum = bends.sum().dot(normal);
                    let after = followed(load(simd, &kept), sum, reach, is_normal);
                    rest = has_friction.select(at_rest + (after - at_rest) * Slip::PLASTIC_PART, at_rest);
                    for (i, kept) in (index * LANES..end).zip(after.to_array()) {
                        if listed[i].slip.is_some() {
                            listed[i].set_plastic(i, plastic, kept);
                        }
                    }
                }
                let Lanes3 { x, y, z } = normal.times(rest);
                store_rows(&mut rests[index], [x, y, z, f32x16::splat(simd, 0.0)]);
            },
        );
    }
}

/// The plastic sums once the weighted sums along the normals are `sum`. A hairpin pressed together has no front: what it has kept stays.
#[inline(always)]
pub(crate) fn followed<S: Simd>(
    kept: f32x16<S>,
    sum: f32x16<S>,
    reach: f32x16<S>,
    has_normal: mask32x16<S>,
) -> f32x16<S> {
    has_normal.select(kept.max(sum - reach).min(sum + reach), kept)
}

/// The positions of a bend's particles.
pub(crate) fn places(position: &[Cell], bend: &ListedBend) -> [Vec3; 4] {
    bend.slots.map(|slot| position[slot as usize / LANES].get(slot as usize % LANES))
}

/// The plastic sums of the bends across the edges of a piece of a mesh, whose `origins` are the indices of its `particles` in the whole.
/// Bends that the whole does not have are held as they are.
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
    let Bends { listed, .. } = &whole.topology.bends;
    let edges = &whole.particles.plastic.edges;
    // A mesh that was never stepped has kept nothing yet.
    let sum_of = |index: usize| if edges.len() == listed.len() { edges[index] } else { listed[index].rest };
    let edges = listed.iter().enumerate().filter(|(_, bend)| bend.thread.is_none());
    let mut kept: Vec<([u32; 4], f32)> = edges
        .map(|(index, bend)| {
            let corners = bend.slots.map(|slot| corner(&whole.topology.layout, slot) as u32);
            keyed(corners, sum_of(index))
        })
        .collect();
    kept.sort_unstable_by_key(|&(corners, _)| corners);
    let of_bend = |bend: &ListedBend| {
        let corners = bend.slots.map(|slot| origins[corner(&topology.layout, slot)]);
        let (corners, sign) = keyed(corners, 1.0);
        match kept.binary_search_by_key(&corners, |&(corners, _)| corners) {
            Ok(place) => kept[place].1 * sign,
            Err(_) => {
                let sum = bend.signed_sum(places(&particles.position.cells, bend));
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
        body.context.bends.reserve(body.particles.layout.cells());
        follow(&mut body, Isa::detected());
        thread_friction::follow(&mut body, Isa::detected());
        body
    }

    /// Distances of the plastic sums from their weighted sums, in parts of their reach.
    fn distances(body: &Body) -> Vec<f32> {
        let bends = body.topology.bends.listed.iter().enumerate();
        let off = bends.filter_map(|(index, bend)| {
            let sum = bend.signed_sum(places(&body.particles.position.cells, bend));
            Some((bend.plastic(index, &body.particles.plastic) - sum).abs() / bend.slip?.reach)
        });
        off.collect()
    }

    /// Cuts a sheet twice, not quite through the middle of a square; the second cut parts it.
    fn cut(body: &mut Body) -> Vec<Body> {
        let cuts = [
            [Vec3::new(0.031, 0.1, 0.0), Vec3::new(0.21, -0.19, 0.0)],
            [Vec3::new(-0.1, -0.11, 0.0), Vec3::new(0.5, -0.13, 0.0)],
        ];
        let mut pieces = Vec::new();
        for [from, to] in cuts {
            let wide = Vec3::Z;
            let blade = [[from - wide, to - wide, to + wide], [from - wide, to + wide, from + wide]];
            let cut = body.cut(&blade).expect("can be cut").expect("the blade must meet the cloth");
            pieces.extend(cut.pieces.into_iter().map(|piece| piece.body));
        }
        pieces.push(body.clone());
        pieces
    }

    /// No plastic sum changes its sign or its bend where a sheet tears, though particles get other indices: each is still within reach of
    /// the weighted sum that it has followed.
    #[test]
    fn a_tear_leaves_plastic_sums_with_their_bends() {
        for is_mesh in [false, true] {
            for piece in cut(&mut bent(is_mesh)) {
                let distances = distances(&piece);
                assert!(distances.len() > 50, "{} bends", distances.len());
                // The front of a thread beside a crack is not quite where it was.
                let farthest = distances.into_iter().fold(0.0, f32::max);
                assert!(farthest < 1.5, "a mesh: {is_mesh}: {farthest} times the reach");
            }
        }
    }

    /// They are those of the whole, and not found anew: of a sheet that is flat again before it slips, they are far from its sums.
    #[test]
    fn a_tear_finds_the_bends_of_a_mesh_again() {
        let mut body = bent(true);
        for i in 0..body.particles.len() {
            let place = body.particles.position(i);
            body.particles.set_position(i, place.with_z(0.0));
        }
        let is_far = |&distance: &f32| distance > 1.5;
        let before = distances(&body).into_iter().filter(is_far).count();
        let after: usize =
            cut(&mut body).iter().map(|piece| distances(piece).into_iter().filter(is_far).count()).sum();
        assert!(before > 50 && 10 * after > 8 * before, "{before} bends before, {after} after");
    }
}
