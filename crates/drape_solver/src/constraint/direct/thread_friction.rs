//! Friction in the threads of a grid: their plastic sums follow the weighted sums, and their rests follow the surface.
//!
//! ```text
//!             up                   normal  n = (right - left) x (down - up), of unit length
//!              |                   along the row  K = (left - p) + (right - p)
//!     left --- p --- right         along the column  K = (up - p) + (down - p)
//!              |
//!            down                  rest = n * the part of the plastic sum
//! ```
//!
//! Design: `docs/design/bending.md`.

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::Vec3;

use crate::constraint::bending_friction::followed;
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::{Isa, Kernel};
use crate::simd::lanes::{Lanes3, load};
use crate::state::bending_friction::Slip;
use crate::state::bends::BentGrid;
use crate::state::body::Body;
use crate::state::layout::{Grid, Layout};

/// Lets the friction of a grid's threads slip, and finds their rests.
pub(crate) fn follow(body: &mut Body, isa: Isa) {
    let Body { particles, topology, context, .. } = body;
    let Some(lines) = topology.bends.lines.filter(|_| topology.bends.has_friction()) else {
        return;
    };
    particles.plastic.reserve_threads(&topology.layout);
    let position = &*particles.position.cells;
    for rest in &mut context.bends.rest {
        rest.resize(position.len(), Cell::default());
    }
    let slip = lines.threads.map(|threads| threads.and_then(|threads| threads.slip));
    let [rows, columns] = &mut particles.plastic.threads;
    let [rests_of_rows, rests_of_columns] = &mut context.bends.rest;
    match &topology.layout {
        Layout::Grid(grid) => isa.run(Follow {
            grid: *grid,
            position,
            slip,
            plastic: [rows.as_chunks_mut().0, columns.as_chunks_mut().0],
            rest: [rests_of_rows, rests_of_columns],
        }),
        layout => {
            follow_one_by_one(
                lines,
                layout,
                position,
                slip,
                [rows, columns],
                [rests_of_rows, rests_of_columns],
            );
        }
    }
}

/// A grid in patches.
struct Follow<'a> {
    grid: Grid,
    position: &'a [Cell],
    /// Along rows and along columns.
    slip: [Option<Slip>; 2],
    plastic: [&'a mut [[f32; LANES]]; 2],
    rest: [&'a mut [Cell]; 2],
}

impl Kernel for Follow<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let Grid { columns, rows, width, height, .. } = self.grid;
        for column in 0..width {
            let lanes = |from: usize, end: usize| {
                self.grid.lanes_of_column(column, |column| (from..end).contains(&column))
            };
            let in_row = [lanes(0, columns), lanes(1, columns), lanes(0, columns - 1)];
            for row in 0..height {
                let lanes =
                    |from: usize, end: usize| self.grid.lanes_of_row(row, |row| (from..end).contains(&row));
                let in_column = [lanes(0, rows), lanes(1, rows), lanes(0, rows - 1)];
                self.follow(simd, [column, row], in_row, in_column);
            }
        }
    }
}

impl Follow<'_> {
    /// The threads whose middle is in this column and row of the patches. `in_row` has the lanes with a particle there, with one on
    /// its left and with one on its right, so far as columns decide; `in_column` the same of rows, above and below.
    #[inline(always)]
    fn follow<S: Simd>(&mut self, simd: S, at: [usize; 2], in_row: [u16; 3], in_column: [u16; 3]) {
        let Grid { across, width, height, .. } = self.grid;
        let [column, row] = at;
        let cell = row * width + column;
        let middle = Lanes3::load(simd, &self.position[cell]);
        let has_left = mask(simd, in_row[1] & in_column[0]);
        let has_right = mask(simd, in_row[2] & in_column[0]);
        let has_up = mask(simd, in_column[1] & in_row[0]);
        let has_down = mask(simd, in_column[2] & in_row[0]);
        let left = if column == 0 { (cell + width - 1, LANES - 1) } else { (cell - 1, 0) };
        let right = if column + 1 == width { (cell + 1 - width, 1) } else { (cell + 1, 0) };
        let last = (height - 1) * width;
        let up = if row == 0 { (cell + last, (LANES - across) % LANES) } else { (cell - width, 0) };
        let down = if row + 1 == height { (cell - last, across % LANES) } else { (cell + width, 0) };
        let left = self.neighbour(simd, left, has_left, middle);
        let right = self.neighbour(simd, right, has_right, middle);
        let up = self.neighbour(simd, up, has_up, middle);
        let down = self.neighbour(simd, down, has_down, middle);
        let (normal, has_normal) = right.minus(left).cross(down.minus(up)).unit(simd);
        self.slip(simd, 0, cell, (normal, has_normal), [left, middle, right], has_left & has_right);
        self.slip(simd, 1, cell, (normal, has_normal), [up, middle, down], has_up & has_down);
    }

    /// The particles of a cell, each in the lane so many lower, where they exist; else those in the middle.
    #[inline(always)]
    fn neighbour<S: Simd>(
        &self,
        simd: S,
        (cell, lanes): (usize, usize),
        exists: mask32x16<S>,
        middle: Lanes3<S>,
    ) -> Lanes3<S> {
        Lanes3::load(simd, &self.position[cell]).shifted_by(lanes).or(exists, middle)
    }

    /// Lets the threads in one direction slip, and finds their rests.
    #[inline(always)]
    fn slip<S: Simd>(
        &mut self,
        simd: S,
        direction: usize,
        cell: usize,
        (normal, has_normal): (Lanes3<S>, mask32x16<S>),
        [start, middle, end]: [Lanes3<S>; 3],
        exists: mask32x16<S>,
    ) {
        let Some(slip) = self.slip[direction] else { return };
        let sum = start.minus(middle).plus(end.minus(middle)).dot(normal);
        let plastic = &mut self.plastic[direction][cell];
        let reach = f32x16::splat(simd, slip.reach);
        let followed = followed(load(simd, plastic), sum, reach, has_normal);
        let followed = exists.select(followed, f32x16::splat(simd, 0.0));
        *plastic = followed.to_array();
        normal.times(followed * Slip::PLASTIC_PART).store(&mut self.rest[direction][cell]);
    }
}

#[inline(always)]
fn mask<S: Simd>(simd: S, lanes: u16) -> mask32x16<S> {
    mask32x16::from_bitmask(simd, u64::from(lanes))
}

/// The same for a grid that is too small for patches.
fn follow_one_by_one(
    BentGrid { columns, rows, .. }: BentGrid,
    layout: &Layout,
    position: &[Cell],
    slip: [Option<Slip>; 2],
    plastic: [&mut [f32]; 2],
    rest: [&mut [Cell]; 2],
) {
    let slot = |column: usize, row: usize| layout.slot(row * columns + column);
    for (column, row) in (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))) {
        let place = |column: usize, row: usize| {
            let slot = slot(column.min(columns - 1), row.min(rows - 1));
            position[slot / LANES].get(slot % LANES)
        };
        let middle = place(column, row);
        let [left, right] = [place(column.saturating_sub(1), row), place(column + 1, row)];
        let [up, down] = [place(column, row.saturating_sub(1)), place(column, row + 1)];
        let normal = (right - left).cross(down - up).normalize_or_zero();
        let own = slot(column, row);
        let is_inside = |at: usize, count: usize| at > 0 && at + 1 < count;
        let ends = [(left, right, is_inside(column, columns)), (up, down, is_inside(row, rows))];
        for (direction, (start, end, exists)) in ends.into_iter().enumerate() {
            let Some(slip) = slip[direction].filter(|_| exists) else { continue };
            let sum = ((start - middle) + (end - middle)).dot(normal);
            let kept = plastic[direction][own];
            let followed = if normal == Vec3::ZERO { kept } else { slip.follow(kept, sum) };
            plastic[direction][own] = followed;
            let kept: Vec3 = normal * (followed * Slip::PLASTIC_PART);
            rest[direction][own / LANES].set(own % LANES, kept);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    use crate::build::cloth::{ClothBuilder, ClothMaterial};
    use crate::constraint::testing::dice;
    use crate::simd::miri::unless_miri;
    use crate::state::bending_friction::BendingFriction;
    use crate::state::bends::BendingRigidity;
    use crate::state::settings::BodySettings;

    const SPACING: f32 = 0.02;
    /// Friction slips at 0.3 and 0.15 of the spacing.
    const REACH: [f32; 2] = [0.3 * SPACING, 0.15 * SPACING];

    fn crumpled(columns: u32, rows: u32) -> Body {
        let rigidity = 1e-4;
        let friction = |reach: f32| reach * 4.0 * rigidity / (SPACING * SPACING);
        let material = ClothMaterial {
            bending_rigidity: BendingRigidity::isotropic(rigidity),
            bending_friction: BendingFriction { weft: friction(REACH[0]), warp: friction(REACH[1]) },
            ..ClothMaterial::default()
        };
        let size = [columns, rows].map(|count| (count - 1) as f32 * SPACING);
        let cloth = ClothBuilder::new(size[0], size[1], columns, rows).material(material);
        let mut body = cloth.build(BodySettings::default()).expect("valid");
        body.particles.arrange(&body.topology.layout);
        let mut dice = dice(9);
        for i in 0..body.particles.len() {
            let moved = body.particles.position(i) + Vec3::new(dice(), dice(), dice()) * 0.5 * SPACING;
            body.particles.set_position(i, moved);
        }
        body
    }

    /// The plastic sum and the rest, along the row and along the column of a particle, of threads that were straight.
    fn expected(body: &Body, [columns, rows]: [usize; 2], at: [usize; 2]) -> [(f64, DVec3); 2] {
        let place = |column: usize, row: usize| body.particles.position(row * columns + column).as_dvec3();
        let [column, row] = at;
        let [left, right] = [column.max(1) - 1, (column + 1).min(columns - 1)].map(|c| place(c, row));
        let [up, down] = [row.max(1) - 1, (row + 1).min(rows - 1)].map(|r| place(column, r));
        let normal = (right - left).cross(down - up).normalize();
        let middle = place(column, row);
        let of = |ends: [DVec3; 2], reach: f32, exists: bool| {
            let sum = (ends[0] + ends[1] - 2.0 * middle).dot(normal);
            let reach = f64::from(reach);
            let beyond = (sum.abs() - reach).max(0.0).copysign(sum);
            if exists { (beyond, normal * 0.8 * beyond) } else { (0.0, DVec3::ZERO) }
        };
        let is_inside = |at: usize, count: usize| at > 0 && at + 1 < count;
        [
            of([left, right], REACH[0], is_inside(column, columns)),
            of([up, down], REACH[1], is_inside(row, rows)),
        ]
    }

    /// Patches side by side, with ghosts, in a square, above each other, and grids too small for them.
    #[test]
    fn plastic_sums_and_rests_are_those_of_their_definition() {
        let sizes = [(33, 9), (48, 5), (17, 16), (16, 15), (3, 48), (3, 46), (6, 5), (32, 8)];
        for (columns, rows) in sizes.into_iter().take(unless_miri(8, 1)) {
            for isa in Isa::available() {
                let mut body = crumpled(columns, rows);
                follow(&mut body, isa);
                let size = [columns, rows].map(|count| count as usize);
                let mut slipped = 0;
                for i in 0..body.particles.len() {
                    let slot = body.topology.layout.slot(i);
                    let at = [i % size[0], i / size[0]];
                    for (direction, (plastic, rest)) in expected(&body, size, at).into_iter().enumerate() {
                        let found = body.particles.plastic.threads[direction][slot];
                        let subject = format!("{columns} x {rows}, {at:?}, {direction}, {}", isa.name());
                        assert!((f64::from(found) - plastic).abs() < 2e-6 * f64::from(SPACING), "{subject}");
                        let found = body.context.bends.rest[direction][slot / LANES].get(slot % LANES);
                        assert!(found.as_dvec3().distance(rest) < 2e-6 * f64::from(SPACING), "{subject}");
                        slipped += usize::from(plastic != 0.0);
                    }
                }
                assert!(slipped > body.particles.len() / 4, "{slipped} threads have slipped");
                let before = body.particles.plastic.clone();
                follow(&mut body, isa);
                assert_eq!(body.particles.plastic, before, "what does not move does not slip");
            }
        }
    }
}
