//! The surface of a body for contacts: its corners, edges and faces, in [stars](super::star), in a tree of patches.
//!
//! The tree is made once for a topology, from the rest positions. Its leaves are runs of [`LANES`] stars, and its nodes
//! are patches of neighbours.
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

use crate::simd::columns::LANES;
use crate::state::star::{EDGES, FACES, NONE, Star};
use crate::state::surface_leaf::SurfaceLeaves;
use crate::state::topology::Topology;
use crate::union_find::Groups;

/// A patch: the stars `first..first + count`. The left half follows it in the list of nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub first: u32,
    pub count: u32,
    /// The right half; 0 in a leaf.
    pub right: u32,
    /// True if its stars hang together.
    pub is_connected: bool,
}

/// The stars of a body, patch by patch.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surface {
    /// Whole leaves: those that are not full end with stars that [hold nothing](Star::is_nothing).
    pub stars: Vec<Star>,
    pub nodes: Vec<Node>,
    pub leaves: SurfaceLeaves,
    /// For each slot, the slots at the other ends of its edges: `around[first..]`, from `first_around` of the slot to
    /// that of the next.
    pub around: Vec<u32>,
    pub first_around: Vec<u32>,
    /// Near stars of each star, as for `around`: leaf and bit mask of the stars whose centres are at most two edges away.
    pub near: Vec<(u32, u16)>,
    pub first_near: Vec<u32>,
}

impl Surface {
    /// The surface of a topology.
    pub fn new(topology: &Topology) -> Self {
        let slots = topology.layout.cells() * LANES;
        let mut rest = vec![Vec3::ZERO; slots];
        for (index, slot) in topology.layout.slots().enumerate() {
            rest[slot] = topology.rest.get(index).copied().unwrap_or_default();
        }
        let stars = stars(topology);
        let edges: Vec<[u32; 2]> =
            stars.iter().flat_map(|star| (0..star.edge_count as usize).map(|k| star.edge(k))).collect();
        let (around, first_around) = lists(slots, edges.iter().flat_map(|&[a, b]| [(a, b), (b, a)]));
        let mut builder = Builder {
            centres: stars.iter().map(|star| rest[star.centre as usize]).collect(),
            stars: &stars,
            groups: Groups::default(),
            place: vec![0; slots],
            nodes: Vec::new(),
            leaves: Vec::new(),
        };
        let mut order: Vec<u32> = (0..stars.len() as u32).collect();
        if !order.is_empty() {
            builder.split(&mut order, 0);
        }
        let Builder { nodes, leaves, .. } = builder;
        let of_leaves = SurfaceLeaves::new(&leaves, &rest);
        let mut surface =
            Self { stars: leaves, nodes, leaves: of_leaves, around, first_around, ..Self::default() };
        surface.find_near(slots);
        surface
    }

    /// Lists the stars around each star.
    fn find_near(&mut self, slots: usize) {
        let real = (0..).zip(&self.stars).filter(|(_, star)| !star.is_nothing());
        let (stars, first) = lists(slots, real.map(|(place, star)| (star.centre, place)));
        let stars_at = |slot: u32| &stars[first[slot as usize] as usize..first[slot as usize + 1] as usize];
        let mut around: Vec<u32> = Vec::new();
        self.first_near.push(0);
        for star in &self.stars {
            around.clear();
            if !star.is_nothing() {
                around.push(star.centre);
                around.extend(self.around_slot(star.centre));
                for place in 0..around.len() {
                    around.extend(self.around_slot(around[place]));
                }
            }
            around.sort_unstable();
            around.dedup();
            let mut places: Vec<u32> = around.iter().flat_map(|&slot| stars_at(slot)).copied().collect();
            places.sort_unstable();
            for place in places {
                let (leaf, bit) = (place / LANES as u32, 1 << (place % LANES as u32));
                let own = *self.first_near.last().expect("pushed above") as usize;
                match self.near[own..].last_mut() {
                    Some((last, mask)) if *last == leaf => *mask |= bit,
                    _ => self.near.push((leaf, bit)),
                }
            }
            self.first_near.push(self.near.len() as u32);
        }
    }

    /// The stars around the star at this place, itself too: see [`near`](Self::near).
    pub fn near_star(&self, place: usize) -> &[(u32, u16)] {
        &self.near[self.first_near[place] as usize..self.first_near[place + 1] as usize]
    }

    /// The slots at the other ends of the edges of a slot.
    pub fn around_slot(&self, slot: u32) -> &[u32] {
        &self.around[self.first_around[slot as usize] as usize..self.first_around[slot as usize + 1] as usize]
    }
}

/// Pairs of a number below `count` and a value, as one list for each number: all values, and where each list begins.
fn lists(count: usize, pairs: impl Iterator<Item = (u32, u32)>) -> (Vec<u32>, Vec<u32>) {
    let mut pairs: Vec<(u32, u32)> = pairs.collect();
    pairs.sort_unstable();
    let mut first = vec![0; count + 1];
    pairs.iter().for_each(|&(number, _)| first[number as usize + 1] += 1);
    for number in 1..first.len() {
        first[number] += first[number - 1];
    }
    (pairs.into_iter().map(|(_, value)| value).collect(), first)
}

/// The stars of a topology, in order of their centres' indices.
fn stars(topology: &Topology) -> Vec<Star> {
    let slot = |index: u32| topology.layout.slot(index as usize) as u32;
    let count = topology.particle_count();
    let is_virtual = topology.virtual_particles();
    let touches = |index: usize| is_virtual.get(index) != Some(&true);
    let star = |index: usize| Star::of(slot(index as u32), touches(index));
    let mut of: Vec<Vec<Star>> = (0..count).map(|index| vec![star(index)]).collect();
    for [a, b, c] in topology.contact_faces() {
        if a == b || b == c || c == a {
            continue;
        }
        let has_room =
            |corner: u32| of[corner as usize].iter().any(|star| (star.face_count as usize) < FACES);
        // Each turned so that the owner comes first: all keep their winding.
        let mut turned = [[a, b, c], [b, c, a], [c, a, b]];
        turned.sort_unstable();
        let [owner, d, e] = turned.into_iter().find(|face| has_room(face[0])).unwrap_or(turned[0]);
        let star = with_room(&mut of[owner as usize], |star| (star.face_count as usize) < FACES);
        star.faces[star.face_count as usize] = [slot(d), slot(e)];
        star.face_count += 1;
    }
    for (ends, sides) in edges(topology) {
        let has_room =
            |corner: &u32| of[*corner as usize].iter().any(|star| (star.edge_count as usize) < EDGES);
        let owner = ends.iter().copied().find(has_room).unwrap_or(ends[0]);
        let other = slot(ends[0] + ends[1] - owner);
        let star = with_room(&mut of[owner as usize], |star| (star.edge_count as usize) < EDGES);
        star.ends[star.edge_count as usize] = other;
        star.sides[star.edge_count as usize] = sides.map(|side| if side == NONE { NONE } else { slot(side) });
        star.edge_count += 1;
    }
    of.into_iter().flatten().collect()
}

/// The first of a particle's stars that has room, or a new one.
fn with_room(stars: &mut Vec<Star>, has_room: impl Fn(&Star) -> bool) -> &mut Star {
    let place = stars.iter().position(has_room).unwrap_or_else(|| {
        let centre = stars[0].centre;
        stars.push(Star::of(centre, false));
        stars.len() - 1
    });
    &mut stars[place]
}

/// Edges of faces, and links, by index, the lower end first; with the third corners of the faces beside them, if there
/// are two such faces.
fn edges(topology: &Topology) -> Vec<([u32; 2], [u32; 2])> {
    let mut all: Vec<([u32; 2], u32)> = Vec::new();
    for [a, b, c] in topology.contact_faces() {
        for ([p, q], third) in [([a, b], c), ([b, c], a), ([c, a], b)] {
            if p != q {
                all.push(([p.min(q), p.max(q)], third));
            }
        }
    }
    all.extend(topology.segments.iter().filter(|[a, b]| a != b).map(|&[a, b]| ([a.min(b), a.max(b)], NONE)));
    all.sort_unstable();
    let runs = all.chunk_by(|a, b| a.0 == b.0);
    runs.map(|run| match run {
        [one, other] if one.1 != NONE && other.1 != NONE => (one.0, [one.1, other.1]),
        _ => (run[0].0, [run[0].1, NONE]),
    })
    .collect()
}

struct Builder<'a> {
    stars: &'a [Star],
    /// Centres of the stars at rest, in metres.
    centres: Vec<Vec3>,
    groups: Groups,
    /// For each slot, 1 and the place of its star in the patch that is looked at; 0 for slots outside.
    place: Vec<u32>,
    nodes: Vec<Node>,
    leaves: Vec<Star>,
}

impl Builder<'_> {
    /// Makes the node of these stars, which begin at number `first`, and the nodes below it.
    fn split(&mut self, order: &mut [u32], first: usize) {
        let place = self.nodes.len();
        let is_connected = self.is_connected(order);
        let leaves = order.len().div_ceil(LANES);
        self.nodes.push(Node { first: first as u32, count: (leaves * LANES) as u32, right: 0, is_connected });
        if leaves == 1 {
            self.leaves.extend(order.iter().map(|&star| self.stars[star as usize]));
            self.leaves.resize(first + LANES, self.padding(order[0]));
            return;
        }
        let centres = &self.centres;
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for &star in &*order {
            (low, high) = (low.min(centres[star as usize]), high.max(centres[star as usize]));
        }
        let size = (high - low).to_array();
        let axis = (1..3).fold(0, |longest, axis| if size[axis] > size[longest] { axis } else { longest });
        // Whole leaves to the left.
        let middle = leaves / 2 * LANES;
        order.select_nth_unstable_by(middle, |&a, &b| {
            centres[a as usize][axis].total_cmp(&centres[b as usize][axis]).then(a.cmp(&b))
        });
        let (left, right) = order.split_at_mut(middle);
        self.split(left, first);
        self.nodes[place].right = self.nodes.len() as u32;
        self.split(right, first + middle);
    }

    fn padding(&self, star: u32) -> Star {
        Star::of(self.stars[star as usize].centre, false)
    }

    /// True if these stars hang together by their edges.
    fn is_connected(&mut self, order: &[u32]) -> bool {
        for (number, &star) in (1..).zip(order) {
            self.place[self.stars[star as usize].centre as usize] = number;
        }
        self.groups.reset(order.len() + 1);
        for (number, &star) in (1..).zip(order) {
            let star = &self.stars[star as usize];
            let own = self.place[star.centre as usize];
            self.groups.join(own, number);
            for &end in &star.ends[..star.edge_count as usize] {
                if self.place[end as usize] != 0 {
                    self.groups.join(own, self.place[end as usize]);
                }
            }
        }
        for &star in order {
            self.place[self.stars[star as usize].centre as usize] = 0;
        }
        (1..=order.len() as u32).all(|number| self.groups.root(number) == 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::cloth::ClothBuilder;
    use crate::build::mesh::cloth::MeshClothBuilder;
    use crate::build::rope::RopeBuilder;
    use crate::state::settings::BodySettings;

    /// A fan of faces round one corner, which has more edges and faces than a star holds, and a corner apart.
    fn fan(count: u32) -> Topology {
        let round = |i: u32| {
            let angle = i as f32 * 0.7;
            Vec3::new(libm::cosf(angle), 0.1 * i as f32, libm::sinf(angle))
        };
        let corners = core::iter::once(Vec3::ZERO).chain((0..=count).map(round)).collect();
        let faces = (1..=count).map(|i| [0, i, i + 1]).collect();
        let cloth = MeshClothBuilder::new(corners, faces).build(BodySettings::default()).expect("valid");
        (*cloth.topology).clone()
    }

    fn topologies() -> Vec<Topology> {
        let settings = BodySettings::default();
        let cloth = ClothBuilder::new(1.0, 1.3, 9, 13).build(settings).expect("valid");
        let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X, 40).build(settings).expect("valid");
        vec![(*cloth.topology).clone(), (*rope.topology).clone(), fan(8)]
    }

    fn sorted<const N: usize>(mut ids: [u32; N]) -> [u32; N] {
        ids.sort_unstable();
        ids
    }

    #[test]
    fn each_corner_edge_and_face_belongs_to_one_star() {
        for topology in topologies() {
            let slot = |index: u32| topology.layout.slot(index as usize) as u32;
            let surface = Surface::new(&topology);
            let stars = &surface.stars;
            let mut centres: Vec<u32> =
                stars.iter().filter(|star| star.has_centre).map(|star| star.centre).collect();
            centres.sort_unstable();
            let mut slots: Vec<u32> = (0..topology.particle_count() as u32).map(slot).collect();
            slots.sort_unstable();
            assert_eq!(centres, slots);

            let face_count = |star: &Star| star.face_count as usize;
            let mut faces: Vec<[u32; 3]> =
                stars.iter().flat_map(|star| (0..face_count(star)).map(|k| star.face(k))).collect();
            // Turned so that the least corner comes first: the winding shows.
            let turned = |face: &mut [u32; 3]| {
                let least = (0..3).fold(0, |least, k| if face[k] < face[least] { k } else { least });
                face.rotate_left(least);
            };
            faces.iter_mut().for_each(turned);
            let mut expected: Vec<[u32; 3]> = topology.faces.iter().map(|face| face.map(slot)).collect();
            expected.iter_mut().for_each(turned);
            faces.sort_unstable();
            expected.sort_unstable();
            assert_eq!(faces, expected);

            let mut edges: Vec<[u32; 2]> = stars
                .iter()
                .flat_map(|star| (0..star.edge_count as usize).map(|k| sorted(star.edge(k))))
                .collect();
            let sides = topology.faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            let links = topology.segments.iter().copied();
            let mut expected: Vec<[u32; 2]> = sides.chain(links).map(|edge| sorted(edge.map(slot))).collect();
            edges.sort_unstable();
            expected.sort_unstable();
            expected.dedup();
            assert_eq!(edges, expected);
        }
    }

    #[test]
    fn a_grid_needs_one_star_for_each_particle_and_a_fan_several() {
        let [grid, _, fan] = topologies().try_into().expect("three");
        let count = |topology: &Topology| {
            Surface::new(topology).stars.iter().filter(|star| !star.is_nothing()).count()
        };
        assert_eq!(count(&grid), grid.particle_count());
        assert!(count(&fan) >= fan.particle_count());
    }

    /// Near stars are those at most two edges away: the tests of flat patches rely on it.
    #[test]
    fn stars_near_a_star_are_those_two_edges_away() {
        for topology in topologies() {
            let surface = Surface::new(&topology);
            let around = |slots: &[u32]| -> Vec<u32> {
                let mut all = slots.to_vec();
                all.extend(slots.iter().flat_map(|&slot| surface.around_slot(slot)));
                all
            };
            for (place, star) in surface.stars.iter().enumerate().filter(|(_, star)| !star.is_nothing()) {
                let reached = around(&around(&[star.centre]));
                for (other, of) in surface.stars.iter().enumerate().filter(|(_, star)| !star.is_nothing()) {
                    let leaf = (other / LANES) as u32;
                    let bit = 1 << (other % LANES);
                    let is_near =
                        surface.near_star(place).iter().any(|&(at, mask)| at == leaf && mask & bit != 0);
                    assert_eq!(is_near, reached.contains(&of.centre), "{place} {other}");
                }
            }
        }
    }
}
