//! Finds the bends of a surface, with the compliance that its rigidity asks for.
//!
//! ```text
//!   grid, spacings s along the thread and t across        mesh, edge e between triangles of areas A and B
//!     energy  1/2 rigidity (K / s^2)^2 s t                  energy  1/2 rigidity K^2 / (A + B),   |K| = |e| angle
//! ```
//!
//! Both are `1/2 rigidity curvature^2` on each part of the surface. (The form of Bergou et al. is three times as large: it takes
//! each edge for the curvature of its own third of the area.)
//!
//! Design: `docs/design/bending.md`.

use glam::DVec3;

use crate::build::adjacency::by_corner;
use crate::build::mesh::surface::{opposite, sides, unordered};
use crate::simd::columns::LANES;
use crate::state::bending_friction::{BendingFriction, Slip};
use crate::state::bends::{
    BendEntry, BendMatrix, BendingRigidity, Bends, BentGrid, BentThreads, ListedBend, is_at_edge,
};
use crate::state::grid::GridBatch;
use crate::state::layout::Layout;
use crate::state::topology::{BatchSticks, StickKind, Topology};
use crate::state::torn_grid::TornGrid;

/// Angle in radians below which the rest of a mesh counts as flat.
const FLAT: f64 = 1e-3;

/// Compliance in m/N from which on a bend resists nothing: rounding would lose its force.
const SLACK: f32 = 1e20;

/// Greatest cotangent of an angle: bends of thinner slivers of triangles are left out.
const SLIVER: f64 = 1e4;

impl Bends {
    /// The bends of a body with this topology, whole or torn. `size` has the columns and rows of a whole grid.
    pub fn new(
        topology: &Topology,
        size: Option<[u32; 2]>,
        rigidity: BendingRigidity,
        friction: BendingFriction,
    ) -> Self {
        let mut bends = Self { rigidity, friction, ..Self::default() };
        if rigidity.is_zero() || topology.rest.is_empty() {
            return bends;
        }
        match (&topology.layout, size) {
            (_, Some([columns, rows])) => bends.add_lines(topology, columns as usize, rows as usize),
            (Layout::Torn(torn), None) => bends.add_torn_grid(topology, torn),
            _ => bends.add_faces(topology),
        }
        bends.matrix = BendMatrix::new(&bends.listed, topology.layout.cells() * LANES);
        bends.have_rests = bends.listed.iter().any(|bend| bend.rest != 0.0 || bend.slip.is_some());
        bends
    }

    fn add_lines(&mut self, topology: &Topology, columns: usize, rows: usize) {
        if columns < 2 || rows < 2 {
            return;
        }
        let side = |to: usize| topology.rest[0].distance(topology.rest[to]);
        let [dx, dy] = [side(1), side(columns)];
        self.lines = Some(BentGrid { columns, rows, threads: self.threads([dx, dy]) });
    }

    /// The bends along rows and along columns, of particles `dx` and `dy` metres apart.
    fn threads(&self, [dx, dy]: [f32; 2]) -> [Option<BentThreads>; 2] {
        let of = |rigidity: f32, friction: f32, along: f32, across: f32| {
            let compliance = along * along * along / (rigidity * across);
            let slip = Slip::new(rigidity, friction, along * along);
            (compliance < SLACK).then_some(BentThreads { compliance, slip })
        };
        let Self { rigidity, friction, .. } = self;
        [of(rigidity.weft, friction.weft, dx, dy), of(rigidity.warp, friction.warp, dy, dx)]
    }

    /// The bends along rows and columns that have lost neither a particle nor a stick.
    fn add_torn_grid(&mut self, topology: &Topology, torn: &TornGrid) {
        let grid = torn.grid;
        let sticks = |offset| Sticks::new(topology, offset);
        let [along_rows, along_columns] = [sticks((1, 0)), sticks((0, 1))];
        let (Some(dx), Some(dy)) = (along_rows.rest_length, along_columns.rest_length) else {
            return;
        };
        let threads = self.threads([dx, dy]);
        let all = [along_rows, along_columns];
        for direction in [0, 1] {
            let Some(BentThreads { compliance, slip }) = threads[direction] else { continue };
            let [right, down] = [1 - direction, direction];
            let [sticks, across] = [&all[direction], &all[1 - direction]];
            let first =
                |row: usize| (0..grid.columns.saturating_sub(2 * right)).map(move |column| (column, row));
            for (column, row) in (0..grid.rows.saturating_sub(2 * down)).flat_map(first) {
                let [a, b, c] = [0, 1, 2].map(|i| grid.slot(column + i * right, row + i * down));
                if sticks.join([a, b]) && sticks.join([b, c]) {
                    let (line, lines) = if down == 0 { (row, grid.rows) } else { (column, grid.columns) };
                    let width = if is_at_edge(line, lines) { 0.5 } else { 1.0 };
                    // The front of a grid is where rows, columns and the normal have the order of a right hand.
                    let place = [column + right, row + down];
                    let after = [place[0] + down, place[1] + right];
                    let before = || Some([place[0].checked_sub(down)?, place[1].checked_sub(right)?]);
                    let beside = |to: Option<[usize; 2]>| {
                        let [column, row] = to.filter(|to| to[0] < grid.columns && to[1] < grid.rows)?;
                        let slot = grid.slot(column, row);
                        across.join([b, slot]).then_some(slot)
                    };
                    let (d, is_turned, slip) = match (beside(Some(after)), beside(before())) {
                        (Some(after), _) => (after, direction == 1, slip),
                        (None, Some(before)) => (before, direction == 0, slip),
                        (None, None) => (c, false, None),
                    };
                    let slots = if is_turned { [c, b, a, d] } else { [a, b, c, d] };
                    self.listed.push(ListedBend {
                        slots: slots.map(|slot| slot as u32),
                        weights: [1.0, -2.0, 1.0, 0.0],
                        stiffness: width / Slip::compliance(slip, compliance),
                        rest: 0.0,
                        slip,
                        thread: Some(direction as u8),
                    });
                }
            }
        }
    }

    /// One bend across each edge between two triangles.
    fn add_faces(&mut self, topology: &Topology) {
        let mut joints: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * topology.faces.len());
        for &face in &topology.faces {
            joints.extend(sides(face).map(|side| (unordered(side), opposite(face, side))));
        }
        joints.sort_unstable();
        let mean = |warp: f32, weft: f32| 0.5 * (f64::from(warp) + f64::from(weft));
        let rigidity = mean(self.rigidity.warp, self.rigidity.weft);
        let friction = mean(self.friction.warp, self.friction.weft);
        for joint in joints.chunk_by(|p, q| p.0 == q.0) {
            if let [([a, b], c), (_, d)] = *joint
                && c != d
            {
                let corners = [a, b, c, d];
                let rest = corners.map(|corner| topology.rest[corner as usize].as_dvec3());
                let Some((weights, areas, sum)) = across_edge(rest) else {
                    continue;
                };
                let compliance = (areas / rigidity) as f32;
                if !(compliance > 0.0 && compliance < SLACK) {
                    continue;
                }
                let slip = Slip::new(rigidity as f32, friction as f32, areas as f32);
                self.listed.push(ListedBend {
                    slots: corners.map(|corner| topology.layout.slot(corner as usize) as u32),
                    weights,
                    stiffness: 1.0 / Slip::compliance(slip, compliance),
                    rest: sum as f32,
                    slip,
                    thread: None,
                });
            }
        }
        // In the order of memory.
        self.listed.sort_by_key(|bend| bend.slots);
    }
}

impl BendMatrix {
    /// That of some bends between this number of slots.
    fn new(bends: &[ListedBend], slots: usize) -> Self {
        let mut matrix = Self::default();
        if bends.is_empty() {
            return matrix;
        }
        let (first, around) = by_corner(bends.iter().map(|bend| bend.slots), slots);
        matrix.starts.reserve(slots + 1);
        matrix.starts.push(0);
        // The stiffness between a particle and each of those near it, and where it is in the list.
        let mut near: Vec<(u32, f64)> = Vec::new();
        let mut index_of = vec![u32::MAX; slots];
        for slot in 0..slots {
            let own = &around[first[slot] as usize..first[slot + 1] as usize];
            // A particle may be in two corners of a bend.
            for bend in own.chunk_by(|p, q| p == q) {
                let ListedBend { slots, weights, stiffness, .. } = &bends[bend[0] as usize];
                let Some(own) = (0..4).find(|&i| slots[i] as usize == slot) else { continue };
                let pull = f64::from(weights[own]) * f64::from(*stiffness);
                for i in (0..4).filter(|&i| slots[i] as usize != slot) {
                    let (other, joined) = (slots[i], pull * f64::from(weights[i]));
                    if joined == 0.0 {
                        continue;
                    }
                    let index = &mut index_of[other as usize];
                    if *index == u32::MAX {
                        *index = near.len() as u32;
                        near.push((other, 0.0));
                    }
                    near[*index as usize].1 += joined;
                }
            }
            matrix.entries.extend(
                near.iter().map(|&(other, joined)| BendEntry { row: 4 * other, stiffness: joined as f32 }),
            );
            matrix.starts.push(matrix.entries.len() as u32);
            near.drain(..).for_each(|(other, _)| index_of[other as usize] = u32::MAX);
        }
        matrix
    }
}

/// Weights of the bend across the edge of the first two corners, the area of its two triangles, and the length of its weighted
/// sum, with its sign. None for triangles without an area, and for slivers.
fn across_edge([a, b, c, d]: [DVec3; 4]) -> Option<([f32; 4], f64, f64)> {
    let double_area = |p: DVec3| (b - a).cross(p - a).length();
    let areas = [c, d].map(double_area);
    if !areas.iter().all(|&area| area > 0.0) {
        return None;
    }
    // Cotangents of the angles at `a` and `b` in both triangles.
    let at_a = [c, d].map(|p| (b - a).dot(p - a));
    let at_b = [c, d].map(|p| (a - b).dot(p - b));
    let cotangent = |products: [f64; 2]| [products[0] / areas[0], products[1] / areas[1]];
    let ([ac, ad], [bc, bd]) = (cotangent(at_a), cotangent(at_b));
    if [ac, ad, bc, bd].iter().any(|cotangent| cotangent.abs() > SLIVER) {
        return None;
    }
    let weights = [bc + bd, ac + ad, -(ac + bc), -(ad + bd)];
    let sum = a * weights[0] + b * weights[1] + c * weights[2] + d * weights[3];
    let normal = (b - a).cross(c - a) - (b - a).cross(d - a);
    let is_flat = sum.length() <= FLAT * a.distance(b);
    let rest = if is_flat { 0.0 } else { sum.length().copysign(sum.dot(normal)) };
    Some((weights.map(|weight| weight as f32), 0.5 * (areas[0] + areas[1]), rest))
}

/// The structural sticks of a torn grid in one direction.
struct Sticks<'a> {
    /// Halves of the family, each with the sticks that are gone.
    halves: Vec<(&'a GridBatch, &'a [u32])>,
    rest_length: Option<f32>,
}

impl<'a> Sticks<'a> {
    fn new(topology: &'a Topology, offset: (isize, usize)) -> Self {
        let mut sticks = Self { halves: Vec::new(), rest_length: None };
        for batch in topology.batches.iter().filter(|batch| batch.material.kind == StickKind::Structural) {
            if let BatchSticks::Grid { batch, severed, rest_length, .. } = &batch.sticks
                && batch.offset() == offset
            {
                sticks.halves.push((batch, severed));
                sticks.rest_length = Some(*rest_length);
            }
        }
        sticks
    }

    /// True if a stick joins these slots.
    fn join(&self, ends: [usize; 2]) -> bool {
        let mut found = self.halves.iter().filter_map(|(batch, severed)| {
            let stick = batch.stick_between(ends)?;
            Some(severed.binary_search(&(stick as u32)).is_err())
        });
        found.next().unwrap_or(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a cylinder the bends of a mesh have the energy of its curvature.
    #[test]
    fn the_energy_of_a_cylinder_is_that_of_its_curvature() {
        let (spacing, curvature) = (0.01_f64, 0.5);
        let height = 0.75_f64.sqrt() * spacing;
        // A patch of equilateral triangles, bent about axes in several directions.
        for turn in [0.0_f64, 0.3, 0.7, 1.2] {
            let place = |x: f64, y: f64| {
                let along = x * libm::cos(turn) + y * libm::sin(turn);
                DVec3::new(x, y, 0.5 * curvature * along * along)
            };
            let mut energy = 0.0;
            // The three edges that begin at a vertex.
            for ([x, y], [u, v], [p, q]) in [
                ([1.0, 0.0], [0.5, 1.0], [0.5, -1.0]),
                ([0.5, 1.0], [1.0, 0.0], [-0.5, 1.0]),
                ([-0.5, 1.0], [0.5, 1.0], [-1.0, 0.0]),
            ] {
                let corner = |x: f64, y: f64| place(x * spacing, y * height);
                let corners = [corner(0.0, 0.0), corner(x, y), corner(u, v), corner(p, q)];
                let flat = corners.map(|corner| corner.with_z(0.0));
                let (weights, areas, _) = across_edge(flat).expect("it has an area");
                let sum: DVec3 =
                    corners.iter().zip(weights).map(|(&corner, weight)| corner * f64::from(weight)).sum();
                energy += 0.5 * sum.length_squared() / areas;
            }
            let expected = 0.5 * curvature * curvature * spacing * height;
            assert!((energy / expected - 1.0).abs() < 1e-3, "{turn}: {energy} of {expected}");
        }
    }

    /// Also of a thread without a neighbour, whose last particle is in two corners.
    #[test]
    fn the_matrix_has_the_forces_of_all_bends() {
        let bend =
            |slots, weights, stiffness| ListedBend { slots, weights, stiffness, ..ListedBend::default() };
        let bends = [
            bend([0, 1, 2, 2], [1.0, -2.0, 1.0, 0.0], 3.0),
            bend([1, 2, 3, 0], [1.0, -2.0, 1.0, 0.0], 0.5),
            bend([4, 2, 0, 3], [1.25, 0.5, -0.75, -1.0], 2.0),
        ];
        let ways: [f32; 6] = [0.5, -1.0, 2.0, 0.25, -3.0, 9.0];
        let matrix = BendMatrix::new(&bends, ways.len());
        for (slot, ends) in matrix.starts.windows(2).enumerate() {
            let entries = &matrix.entries[ends[0] as usize..ends[1] as usize];
            let found: f32 = entries
                .iter()
                .map(|entry| entry.stiffness * (ways[entry.row as usize / 4] - ways[slot]))
                .sum();
            let mut expected = 0.0;
            for ListedBend { slots, weights, stiffness, .. } in bends {
                let sum: f32 =
                    slots.iter().zip(weights).map(|(&other, weight)| ways[other as usize] * weight).sum();
                let own = slots.iter().zip(weights).filter(|own| *own.0 as usize == slot);
                expected += own.map(|(_, weight)| weight * stiffness * sum).sum::<f32>();
            }
            assert!((found - expected).abs() < 1e-5, "slot {slot}: {found}, not {expected}");
        }
    }

    #[test]
    fn flat_triangles_have_no_rest_and_curved_ones_a_sign() {
        let corners = |height: f64| {
            [DVec3::ZERO, DVec3::Y, DVec3::new(1.0, 0.5, height), DVec3::new(-1.0, 0.5, height)]
        };
        let rest = |height| across_edge(corners(height)).expect("it has an area").2;
        assert_eq!(rest(0.0), 0.0);
        assert!(rest(0.1) * rest(-0.1) < 0.0);
    }
}
