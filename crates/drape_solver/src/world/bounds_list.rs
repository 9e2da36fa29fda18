//! A list of boxes, and the question if any is near a point.

use glam::Vec3;

use crate::world::bounds::Bounds;

/// Boxes in the order in which they begin along x, for many questions between two changes.
#[derive(Clone, Default, Debug)]
pub struct BoundsList {
    all: Vec<Bounds>,
    /// For each box, how far along x it reaches, or one before it.
    ends: Vec<f32>,
}

impl BoundsList {
    /// Replaces all boxes. Leaves those out that are not finite.
    pub fn replace(&mut self, boxes: impl Iterator<Item = Bounds>) {
        let Self { all, ends } = self;
        all.clear();
        all.extend(boxes.filter(|bounds| bounds.is_finite()));
        all.sort_unstable_by(|one, other| one.low.x.total_cmp(&other.low.x));
        ends.clear();
        ends.extend(all.iter().scan(f32::NEG_INFINITY, |end, bounds| {
            *end = end.max(bounds.high.x);
            Some(*end)
        }));
    }

    /// True if a box is within `radius` metres of a point.
    pub fn is_any_within(&self, radius: f32, point: Vec3) -> bool {
        let begun = self.all.partition_point(|bounds| bounds.low.x <= point.x + radius);
        let begun = self.all[..begun].iter().zip(&self.ends).rev();
        begun
            .take_while(|(_, end)| **end >= point.x - radius)
            .any(|(bounds, _)| bounds.distance_to(point) <= radius)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::random::{between, cases};

    fn point() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(between(0.0, 10.0)).prop_map(Vec3::from_array)
    }

    fn boxes() -> impl Strategy<Value = Bounds> {
        (point(), point()).prop_map(|(low, size)| Bounds::new(low, low + 0.1 * size))
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn a_box_is_found_among_others_as_if_each_were_asked(
            all in prop::collection::vec(boxes(), 0..9),
            point in point(),
            radius in between(0.0, 3.0),
        ) {
            let mut list = BoundsList::default();
            list.replace(all.iter().copied());
            let is_within = all.iter().any(|bounds| bounds.distance_to(point) <= radius);
            prop_assert_eq!(list.is_any_within(radius, point), is_within);
        }
    }
}
