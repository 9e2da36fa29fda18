//! Ropes.

use drape_solver::StickKind;
use drape_solver::glam::Vec3;

use crate::scenes::model::{Family, Model};
use crate::scenes::world::SIDE;

/// `count` particles over 2 m along X, joined by links only, pinned at the first.
pub fn rope(count: u32) -> Model {
    let place = |i: u32| SIDE * (i as f32 / (count - 1) as f32 - 0.5);
    let links: Vec<[u32; 2]> = (0..count - 1).map(|i| [i, i + 1]).collect();
    Model {
        positions: (0..count).map(|i| Vec3::X * place(i)).collect(),
        grid: Some([count, 1]),
        pinned: vec![0],
        families: vec![Family { kind: StickKind::Structural, sticks: links.clone(), offset: [1, 0] }],
        natural_order: links,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rope_is_as_long_as_its_links() {
        let rope = rope(64);
        assert_eq!(rope.stick_count(), 63);
        let length: f32 = rope.structural().map(|link| rope.rest_length(link)).sum();
        assert!((length - SIDE).abs() < 1e-5);
    }
}
