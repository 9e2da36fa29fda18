//! The effective mass of a point between particles.
//!
//! ```text
//!        push                   If two of three corners are pinned and the push acts close to the line
//!         |                     between them, the third corner moves 1 / a times as far as the point,
//!   pin --v-------- o           where a is its weight.
//!      a = 0.02
//! ```
//!
//! Design: `docs/design/contacts.md`.

/// Effective inverse mass in 1/kg of a point that is the weighted mean of corners, or of the distance between two such
/// points, whose weights have opposite signs. A lower bound keeps every corner from moving more than twice as far as
/// the point.
pub(crate) fn effective_inverse_mass<const N: usize>(weights: [f32; N], inverse_masses: [f32; N]) -> f32 {
    let (mut sum, mut most) = (0.0, 0.0_f32);
    for (weight, inverse_mass) in weights.into_iter().zip(inverse_masses) {
        let share = weight * inverse_mass;
        sum += weight * share;
        most = most.max(share.abs());
    }
    sum.max(0.5 * most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_between_free_corners_has_the_mass_that_a_push_feels() {
        let third = 1.0 / 3.0;
        assert!((effective_inverse_mass([third; 3], [6.0; 3]) - 2.0).abs() < 1e-6);
        assert_eq!(effective_inverse_mass([1.0, -0.5, -0.5, 0.0], [2.0; 4]), 3.0);
    }

    #[test]
    fn no_corner_moves_by_more_than_twice_the_way_of_the_point() {
        for a in [0.5, 0.1, 0.02, 1e-6] {
            let inverse_mass = 7.0;
            let moved =
                a * inverse_mass / effective_inverse_mass([a, 0.5, 0.5 - a], [inverse_mass, 0.0, 0.0]);
            assert!(moved <= 2.0 * (1.0 + 1e-6), "{a}: {moved}");
        }
        assert_eq!(effective_inverse_mass([0.2, 0.3, 0.5], [0.0; 3]), 0.0);
    }
}
