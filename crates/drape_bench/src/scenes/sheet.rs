//! Square sheets.

use drape_solver::StickKind;
use drape_solver::glam::Vec3;

use crate::scenes::model::{Family, Model, Pins};
use crate::scenes::world::SIDE;

/// `n` x `n` particles over 2 m x 2 m in the XZ plane, by rows: workload W.
pub fn sheet(n: u32, pins: Pins) -> Model {
    let place = places(n, SIDE);
    grid(n, pins, |column, row| Vec3::new(place(column), 0.0, place(row)))
}

/// `n` x `n` particles over half a metre square, hanging in the XY plane by its upper edge.
pub fn curtain(n: u32) -> Model {
    let place = places(n, 0.5);
    grid(n, Pins::Edge, |column, row| Vec3::new(place(column), -place(row), 0.0))
}

/// Positions of the particles of a row, in metres from its middle.
fn places(n: u32, side: f32) -> impl Fn(u32) -> f32 {
    let spacing = side / (n - 1) as f32;
    move |i| i as f32 * spacing - side * 0.5
}

/// Horizontals, verticals, the two diagonals, skip-one bends in rows and in columns:
/// `2n(n-1) + 2(n-1)^2 + 2n(n-2)` sticks.
fn grid(n: u32, pins: Pins, position: impl Fn(u32, u32) -> Vec3) -> Model {
    let position = &position;
    let positions = (0..n).flat_map(|row| (0..n).map(move |column| position(column, row))).collect();
    let pinned = match pins {
        Pins::Corners => vec![0, n - 1],
        Pins::Edge => (0..n).collect(),
        Pins::Start => vec![0],
    };
    let family = |kind, cells, from: [u32; 2], to: [u32; 2]| {
        let offset = [0, 1].map(|axis| to[axis] as i32 - from[axis] as i32);
        Family { kind, sticks: pairs(n, cells, from, to), offset }
    };
    let families = vec![
        family(StickKind::Structural, [n - 1, n], [0, 0], [1, 0]),
        family(StickKind::Structural, [n, n - 1], [0, 0], [0, 1]),
        family(StickKind::Shear, [n - 1, n - 1], [0, 0], [1, 1]),
        family(StickKind::Shear, [n - 1, n - 1], [1, 0], [0, 1]),
        family(StickKind::Bend, [n - 2, n], [0, 0], [2, 0]),
        family(StickKind::Bend, [n, n - 2], [0, 0], [0, 2]),
    ];
    // The sticks of each particle together, row by row.
    let mut natural_order: Vec<[u32; 2]> = families.iter().flat_map(|f| f.sticks.iter().copied()).collect();
    natural_order.sort_unstable_by_key(|&[a, b]| (a.min(b), a.max(b)));
    Model { positions, grid: Some([n, n]), pinned, families, natural_order }
}

/// For each of `columns` x `rows` cells, the pair of particles at the offsets `from` and `to`.
fn pairs(n: u32, [columns, rows]: [u32; 2], from: [u32; 2], to: [u32; 2]) -> Vec<[u32; 2]> {
    let index = |[column, row]: [u32; 2]| row * n + column;
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
    cells.map(|[c, r]| [from, to].map(|[dc, dr]| index([c + dc, r + dr]))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sheet_has_the_sticks_that_the_formula_says() {
        for n in [3, 8, 17] {
            let model = sheet(n, Pins::Edge);
            let n = n as usize;
            assert_eq!(model.stick_count(), 2 * n * (n - 1) + 2 * (n - 1) * (n - 1) + 2 * n * (n - 2));
            assert_eq!(model.structural().count(), 2 * n * (n - 1));
        }
    }

    #[test]
    fn sticks_are_as_long_as_their_kind_says() {
        let model = sheet(9, Pins::Corners);
        let spacing = 0.25_f32;
        for family in &model.families {
            let expected = match family.kind {
                StickKind::Structural => spacing,
                StickKind::Shear => spacing * 2.0_f32.sqrt(),
                StickKind::Bend => 2.0 * spacing,
            };
            for &stick in &family.sticks {
                assert!((model.rest_length(stick) - expected).abs() < 1e-6, "{:?} {stick:?}", family.kind);
            }
        }
    }

    #[test]
    fn pins_are_on_one_side() {
        for (pins, count) in [(Pins::Corners, 2), (Pins::Edge, 5)] {
            let model = sheet(5, pins);
            assert_eq!(model.pinned.len(), count);
            assert!(model.pinned.iter().all(|&pin| model.positions[pin as usize].z == -1.0));
        }
        let curtain = curtain(8);
        let highest = curtain.positions.iter().map(|p| p.y).fold(f32::MIN, f32::max);
        assert!(curtain.pinned.iter().all(|&pin| curtain.positions[pin as usize].y == highest));
    }
}
