//! Widths of the strips of torn cloth that its sticks stand for.
//!
//! ```text
//!   o---o---o     A stick is as wide as half of the squares on both of its sides. Those that are gone, or that a blade has
//!   |   |         divided, make it narrower.
//!   o---o---o
//! ```
//!
//! Design: `docs/design/membrane.md`.

use crate::constraint::direct::grid_lines::Lines;
use crate::simd::columns::LANES;
use crate::state::face_part::FacePart;
use crate::state::layout::Grid;
use crate::state::topology::Topology;

/// Widths of the sticks to the neighbours in a grid, in parts of those inside it. By the slot of the particle at which a stick begins, and of
/// that at which it ends: at the end of a tear several lead from one particle to the next place.
pub(super) struct StripWidths {
    from: [Vec<f32>; 4],
    to: [Vec<f32>; 4],
}

/// The least width. A blade may leave slivers.
const LEAST_WIDTH: f32 = 0.01;

impl StripWidths {
    /// Those of a torn grid, from its faces.
    pub fn of(topology: &Topology) -> Self {
        let count = topology.layout.cells() * LANES;
        let mut widths = Self {
            from: core::array::from_fn(|_| vec![0.0; count]),
            to: core::array::from_fn(|_| vec![0.0; count]),
        };
        let mut shares = vec![1.0; topology.faces.len()];
        topology.parts.iter().for_each(|part| shares[part.face as usize] = 0.0);
        topology.parts.iter().for_each(|part| shares[part.face as usize] += FacePart::share(part));
        let slot_and_place =
            |index| (topology.layout.slot(index), topology.place_in_grid(index).unwrap_or_default());
        let corners: Vec<(usize, [isize; 2])> = (0..topology.particle_count()).map(slot_and_place).collect();
        for (&face, share) in topology.faces.iter().zip(shares) {
            widths.add_face(face.map(|corner| corners[corner as usize]), share);
        }
        widths
    }

    /// Adds what is left of a face, given by slots and places of its corners: half a square, and so a half of the strips of its sides.
    fn add_face(&mut self, corners: [(usize, [isize; 2]); 3], share: f32) {
        let (slots, places) = (corners.map(|corner| corner.0), corners.map(|corner| corner.1));
        for (corner, [a, b]) in [[1, 2], [2, 0], [0, 1]].into_iter().enumerate() {
            let offset = [0, 1].map(|axis| places[b][axis] - places[a][axis]);
            let Some(lines) = Lines::along_offset(offset) else { continue };
            let [first, last] = if lines.offset() == offset { [a, b] } else { [b, a] };
            self.from[lines as usize][slots[first]] += 0.5 * share;
            self.to[lines as usize][slots[last]] += 0.5 * share;
            if lines.is_diagonal() {
                // The other diagonal leads from the corner between the legs to a particle of the other half of the square.
                let opposite =
                    [0, 1].map(|axis| places[a][axis] + places[b][axis] - 2 * places[corner][axis]);
                if let Some(lines) = Lines::along_offset(opposite) {
                    let ends = if lines.offset() == opposite { &mut self.from } else { &mut self.to };
                    ends[lines as usize][slots[corner]] += share;
                }
            }
        }
    }

    /// The slots of the ends of those sticks of a torn grid that are not as wide as inside it.
    pub fn other_than_inside(&self, lines: Lines, grid: Grid) -> impl Iterator<Item = [u32; 2]> {
        let [right, down] = lines.offset();
        let beside = move |slot: usize, way: isize| {
            let [column, row] = grid.place(slot);
            let column = column.checked_add_signed(way * right).filter(|&column| column < grid.columns)?;
            let row = row.checked_add_signed(way * down).filter(|&row| row < grid.rows)?;
            Some([slot, grid.slot(column, row)])
        };
        let slots = grid.width * grid.height * LANES;
        let is_other = move |widths: &[f32], slot: &usize| !matches!(widths[*slot], 0.0 | 1.0);
        let [from, to] = [&self.from, &self.to].map(|of| &*of[lines as usize]);
        let begun =
            (0..slots).filter(move |slot| is_other(from, slot)).filter_map(move |slot| beside(slot, 1));
        let ended =
            (0..slots).filter(move |slot| is_other(to, slot)).filter_map(move |slot| beside(slot, -1));
        let ended = ended.map(|[end, start]| [start, end]);
        begun.chain(ended).map(|ends| ends.map(|slot| slot as u32))
    }

    /// The compliance of the stick between the particles in these slots, in parts of that inside the cloth.
    pub fn softness(&self, lines: Lines, [from, to]: [u32; 2]) -> f32 {
        let [from, to] =
            [(&self.from, from), (&self.to, to)].map(|(of, slot)| of[lines as usize][slot as usize]);
        let width = match lines {
            Lines::Rows | Lines::Columns => from.min(to),
            // Each end of a diagonal across the edge of two faces knows one of them alone.
            Lines::Diagonals | Lines::Antidiagonals => 0.5 * (from + to),
        };
        1.0 / width.clamp(LEAST_WIDTH, 1.0)
    }
}
