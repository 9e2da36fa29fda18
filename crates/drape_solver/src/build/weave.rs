//! Cloth whose stiffness differs from place to place or from direction to direction.
//!
//! ```text
//!   V  warp          A cloth of threads is stiff along them and soft at 45 degrees. At an angle a from the warp
//!   |   / bias       its compliance is
//!   |  /               c(a) = c_warp cos^4 a + c_weft sin^4 a + (4 c_bias - c_warp - c_weft) sin^2 a cos^2 a,
//!   | / a            the law of orthotropic plates (Jones 1975, "Mechanics of Composite Materials", equation 2.97),
//!   +------- U       with c = (1 - s) / s of a stiffness s.
//!      weft
//! ```
//!
//! Design: docs/design/cloth_from_meshes.md.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use crate::error::{BuildError, in_range};

/// Stiffness by direction, as in woven cloth.
#[derive(Clone, Debug, PartialEq)]
pub struct Weave {
    /// Texture coordinates of each vertex of the mesh. The warp runs along V and has the cloth's stretch stiffness; the weft
    /// runs along U.
    pub coordinates: Vec<Vec2>,
    /// Stiffness of edges along the weft, 0 (slack) to 1 (rigid).
    pub weft_stiffness: f32,
    /// Stiffness of edges at 45 degrees, 0 to 1.
    pub bias_stiffness: f32,
}

/// The number of steps of 7.5 degrees from the warp to the weft. Edges are sorted by them.
const DIRECTIONS: u8 = 12;
/// The greatest shade; the least is 0.
const SHADES: f32 = 15.0;

/// The greatest compliance, as good as slack.
const SLACK: f64 = 1e12;

/// Edges of one class have the same stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Class {
    /// Shade of paint: 0 is black, [`SHADES`] white.
    shade: u8,
    /// Steps from the warp: 0 is along the warp, [`DIRECTIONS`] along the weft.
    direction: u8,
}

impl Class {
    /// The stiffness of edges of this class, in a cloth that has `stiffness` along the warp.
    pub fn stiffness(self, stiffness: f32, weave: Option<&Weave>) -> f32 {
        if weave.is_none() && f32::from(self.shade) == SHADES {
            return stiffness;
        }
        let compliance = |stiffness: f32| (f64::from(1.0 - stiffness) / f64::from(stiffness)).min(SLACK);
        let dark = 1.0 - f64::from(self.shade) / f64::from(SHADES);
        let (along, added) = (compliance(stiffness), dark * dark * dark);
        let woven = weave.map_or(along, |weave| {
            let [warp, weft, bias] =
                [along, compliance(weave.weft_stiffness), compliance(weave.bias_stiffness)];
            let angle = f64::from(self.direction) / f64::from(DIRECTIONS) * core::f64::consts::FRAC_PI_2;
            let (sin, cos) = (libm::sin(angle) * libm::sin(angle), libm::cos(angle) * libm::cos(angle));
            warp * cos * cos + weft * sin * sin + (4.0 * bias - warp - weft) * sin * cos
        });
        // If the bias is stiffer than the threads, the law is negative in between.
        (1.0 / (1.0 + woven.max(0.0) + added)) as f32
    }
}

impl Weave {
    pub(crate) fn validate(&self, vertices: usize) -> Result<(), BuildError> {
        in_range("weft stiffness", self.weft_stiffness, f32::MIN_POSITIVE, 1.0)?;
        in_range("bias stiffness", self.bias_stiffness, f32::MIN_POSITIVE, 1.0)?;
        if self.coordinates.len() != vertices || !self.coordinates.iter().all(|uv| uv.is_finite()) {
            return Err(BuildError::BadShape {
                reason: "a weave needs finite texture coordinates at every vertex",
            });
        }
        Ok(())
    }

    /// The direction of each edge of a face, from corner `k` to the next. None if the texture coordinates have no area.
    fn directions(&self, face: [u32; 3], positions: [Vec3; 3]) -> Option<[u8; 3]> {
        let uvs = face.map(|vertex| self.coordinates[vertex as usize]);
        let [right, up] = [uvs[1] - uvs[0], uvs[2] - uvs[0]];
        let area = right.perp_dot(up);
        if area == 0.0 {
            return None;
        }
        let [p, q] = [positions[1] - positions[0], positions[2] - positions[0]];
        // The lengths in the world of a whole U and a whole V.
        let weft = ((p * up.y - q * right.y) / area).length();
        let warp = ((q * right.x - p * up.x) / area).length();
        Some([0, 1, 2].map(|k| {
            let edge = uvs[(k + 1) % 3] - uvs[k];
            let angle = libm::atan2(f64::from(edge.x.abs() * weft), f64::from(edge.y.abs() * warp));
            (angle / core::f64::consts::FRAC_PI_2 * f64::from(DIRECTIONS)).round() as u8
        }))
    }

    /// The direction of each edge between particles, the lower index first. An edge at a seam has the direction that the
    /// first of its faces gives.
    pub fn of_edges(
        &self,
        faces: &[[u32; 3]],
        vertices: &[Vec3],
        particle_of_vertex: &[Option<u32>],
    ) -> BTreeMap<[u32; 2], u8> {
        let mut known = BTreeMap::new();
        for &face in faces {
            let positions = face.map(|vertex| vertices[vertex as usize]);
            let particles = face.map(|vertex| particle_of_vertex[vertex as usize]);
            let ([Some(a), Some(b), Some(c)], Some(directions)) =
                (particles, self.directions(face, positions))
            else {
                continue;
            };
            for ([p, q], direction) in [[a, b], [b, c], [c, a]].into_iter().zip(directions) {
                known.entry([p.min(q), p.max(q)]).or_insert(direction);
            }
        }
        known
    }
}

/// Sorts sticks by their class.
pub(crate) fn by_class(
    sticks: &[[u32; 2]],
    paint: &[f32],
    directions: &BTreeMap<[u32; 2], u8>,
) -> BTreeMap<Class, Vec<[u32; 2]>> {
    let mut classes: BTreeMap<Class, Vec<[u32; 2]>> = BTreeMap::new();
    for &[a, b] in sticks {
        let of = |particle: u32| paint.get(particle as usize).copied().unwrap_or(1.0).clamp(0.0, 1.0);
        let shade = (0.5 * (of(a) + of(b)) * SHADES).round() as u8;
        let direction = directions.get(&[a.min(b), a.max(b)]).copied().unwrap_or(0);
        classes.entry(Class { shade, direction }).or_default().push([a, b]);
    }
    classes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weave() -> Weave {
        Weave { coordinates: vec![], weft_stiffness: 0.99, bias_stiffness: 0.9 }
    }

    #[test]
    fn warp_weft_and_bias_have_their_own_stiffness() {
        let at = |direction| Class { shade: SHADES as u8, direction }.stiffness(0.999, Some(&weave()));
        assert!(
            (at(0) - 0.999).abs() < 1e-6 && (at(DIRECTIONS) - 0.99).abs() < 1e-6,
            "{} {}",
            at(0),
            at(DIRECTIONS)
        );
        assert!((at(DIRECTIONS / 2) - 0.9).abs() < 1e-6, "{}", at(DIRECTIONS / 2));
    }

    #[test]
    fn the_darker_the_softer() {
        let at = |shade| Class { shade, direction: 0 }.stiffness(1.0, None);
        assert_eq!(at(SHADES as u8), 1.0);
        assert_eq!(at(0), 0.5);
        assert!((1..=SHADES as u8).all(|shade| at(shade) > at(shade - 1)));
    }

    #[test]
    fn edges_are_measured_in_the_world_and_not_in_the_picture() {
        // Twice as wide as high, with a square texture: the diagonal is nearer to the weft.
        let weave = Weave { coordinates: vec![Vec2::ZERO, Vec2::X, Vec2::ONE], ..weave() };
        let directions = weave.directions([0, 1, 2], [Vec3::ZERO, Vec3::X * 2.0, Vec3::new(2.0, 1.0, 0.0)]);
        // 63.4 degrees from the warp.
        assert_eq!(directions, Some([DIRECTIONS, 0, 8]));
        let flat = Weave { coordinates: vec![Vec2::ZERO; 3], ..weave };
        assert_eq!(flat.directions([0, 1, 2], [Vec3::ZERO, Vec3::X, Vec3::Y]), None);
    }
}
