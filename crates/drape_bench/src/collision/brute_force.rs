//! The reference: every face against every ball, in double precision.

use drape_solver::glam::{DVec3, Vec3A};

use super::method::Pair;
use super::state::State;

/// Depth in metres below which single precision may find a contact or not: some ten roundings of a coordinate.
pub const TOLERANCE: f64 = 1e-5;

/// The errors of a method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactErrors {
    /// Contacts deeper than [`TOLERANCE`] that it did not find.
    pub missed: usize,
    /// Contacts that it found between a ball and a face that are farther apart than [`TOLERANCE`].
    pub false_contacts: usize,
}

/// All contacts of a state: those that must be found, and those that may be. Both are sorted.
pub struct ExactContacts {
    /// Deeper than the tolerance.
    pub certain: Vec<Pair>,
    /// Deeper than minus the tolerance.
    pub possible: Vec<Pair>,
}

impl ExactContacts {
    /// Tests every face.
    pub fn of(state: &State) -> Self {
        let mut exact = Self { certain: Vec::new(), possible: Vec::new() };
        for (ball, sphere) in (0..).zip(&state.balls) {
            let (centre, apart) = (sphere.centre.as_dvec3(), f64::from(sphere.apart));
            let far = apart + 2.0 * TOLERANCE;
            for face in 0..state.faces.len() as u32 {
                let corners = state.corners(face).map(Vec3A::as_dvec3);
                let [a, b, c] = corners;
                let is_apart = a.min(b).min(c).cmpgt(centre + far) | a.max(b).max(c).cmplt(centre - far);
                if is_apart.any() {
                    continue;
                }
                let depth = apart - nearest(corners, centre).distance(centre);
                if depth > TOLERANCE {
                    exact.certain.push((ball, face));
                }
                if depth > -TOLERANCE {
                    exact.possible.push((ball, face));
                }
            }
        }
        exact
    }

    /// Counts the errors in these contacts.
    pub fn errors_of(&self, mut found: Vec<Pair>) -> ContactErrors {
        found.sort_unstable();
        ContactErrors {
            missed: self.certain.iter().filter(|pair| found.binary_search(pair).is_err()).count(),
            false_contacts: found.iter().filter(|pair| self.possible.binary_search(pair).is_err()).count(),
        }
    }
}

/// The point of a triangle that is nearest to `point`: in its plane if that lies within, else on an edge.
fn nearest([a, b, c]: [DVec3; 3], point: DVec3) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let size = normal.length_squared();
    let is_inside = |p: DVec3, q: DVec3| (q - p).cross(point - p).dot(normal) >= 0.0;
    if size > 0.0 && is_inside(a, b) && is_inside(b, c) && is_inside(c, a) {
        return point - normal * ((point - a).dot(normal) / size);
    }
    let edges = [[a, b], [b, c], [c, a]].map(|[p, q]| {
        let along = q - p;
        let length = along.length_squared();
        let t = if length > 0.0 { ((point - p).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
        p + along * t
    });
    let nearer = |p: DVec3, q: DVec3| if q.distance(point) < p.distance(point) { q } else { p };
    edges.into_iter().reduce(nearer).unwrap_or(a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// No point of a fine sampling of the triangle is nearer.
    #[test]
    fn the_nearest_point_is_the_nearest() {
        let mut random = Random::new(3);
        let mut vector = || DVec3::from_array([(); 3].map(|()| random.either_side()));
        for _ in 0..300 {
            let ([a, b, c], point) = ([vector(), vector(), vector()], vector() * 2.0);
            let found = nearest([a, b, c], point).distance(point);
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let (u, v) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                    let other = a + (b - a) * u + (c - a) * v;
                    assert!(found <= other.distance(point) + 1e-12);
                }
            }
        }
    }

    #[test]
    fn errors_are_counted() {
        let exact = ExactContacts { certain: vec![(0, 1), (0, 2)], possible: vec![(0, 1), (0, 2), (0, 3)] };
        assert_eq!(exact.errors_of(vec![(0, 2), (0, 3), (0, 1)]), ContactErrors::default());
        assert_eq!(exact.errors_of(vec![(1, 2), (0, 1)]), ContactErrors { missed: 1, false_contacts: 1 });
    }
}
