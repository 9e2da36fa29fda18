//! The query that three of the methods end in: the feature of a face (corner, edge or inside) that is closest to a
//! ball's centre.
//!
//! It is parry's own query, which walks the Voronoi regions of the triangle. Faces whose box or plane is apart from the
//! ball are not queried.

use drape_solver::glam::{Vec3, Vec3A};
use drape_solver::parry3d::query::PointQueryWithLocation;
use drape_solver::parry3d::shape::{Triangle, TrianglePointLocation};

use super::method::Contact;
use super::state::{Sphere, State};

/// The results of queries.
#[derive(Default)]
pub struct ClosestFeatureQueries {
    /// Contacts found.
    pub contacts: Vec<Contact>,
    /// Number of faces that were queried for their nearest point.
    pub count: usize,
}

impl ClosestFeatureQueries {
    /// Clears the results and keeps the memory.
    pub fn clear(&mut self) {
        self.contacts.clear();
        self.count = 0;
    }

    /// Queries one face, if its current box touches that of the ball, and its plane touches the ball.
    #[inline(always)]
    pub fn query(&mut self, state: &State, ball: u32, sphere: &Sphere, face: u32) {
        let Sphere { centre, apart, .. } = *sphere;
        let middle = Vec3A::from(centre);
        if !state.is_within(face, middle - apart, middle + apart) {
            return;
        }
        let [a, b, c] = state.corners(face).map(Vec3::from);
        let normal = (b - a).cross(c - a);
        let height = normal.dot(centre - a);
        if height * height > 1.001 * apart * apart * normal.length_squared() {
            return;
        }
        self.count += 1;
        let (nearest, place) = Triangle::new(a, b, c).project_local_point_and_get_location(centre, true);
        let offset = centre - nearest.point;
        let distance_squared = offset.length_squared();
        if distance_squared >= apart * apart {
            return;
        }
        let distance = distance_squared.sqrt();
        self.contacts.push(Contact {
            pair: (ball, face),
            weights: weights(&place),
            normal: if distance > 0.0 { offset / distance } else { side([a, b, c]) },
            depth: apart - distance,
        });
    }
}

fn weights(place: &TrianglePointLocation) -> [f32; 3] {
    // There are none only if the triangle has no area.
    place.barycentric_coordinates().unwrap_or([1.0, 0.0, 0.0])
}

fn side([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a).normalize_or(Vec3::Y)
}
