//! Places the leaves of a surface as a whole: enough to see that nothing is near, at a tenth of the work of placing stars.
//!
//! Normals are scaled by what they are at rest, so a face that has shrunk leans to no side and counts as not flat.
//!
//! Design: `docs/design/self_contact.md`.

use fearless_simd::Simd;
use glam::{Vec3, Vec3A, Vec3Swizzles};

use crate::broad_phase::surface_pairs::{Lean, PlacedLeaf};
use crate::broad_phase::swept_box::SweptBox;
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::Kernel;
use crate::state::surface_leaf::{MOST_CORNERS, SurfaceLeaves};

/// The leaves of one body, on an even way.
pub(crate) struct FlyingLeaves<'a> {
    pub leaves: &'a SurfaceLeaves,
    /// Places at the start, with the body's origin at `origin`, and ways in a substep, in metres.
    pub starts: &'a [Cell],
    pub ways: &'a [Cell],
    pub origin: Vec3,
    /// Substeps that are left.
    pub substeps: f32,
    /// Metres by which boxes are wider than what they hold.
    pub growth: f32,
    pub placed: &'a mut Vec<PlacedLeaf>,
}

/// How much faces turn if their corners move against each other by at most `d` metres: their normals, at rest 1 long, change
/// by at most `lever d + scale d²`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Turning {
    /// In 1/m.
    pub lever: f32,
    /// In 1/m².
    pub scale: f32,
}

impl Turning {
    pub fn of(self, d: f32) -> f32 {
        self.lever * d + self.scale * d * d
    }

    pub fn or_more(self, other: Self) -> Self {
        Self { lever: self.lever.max(other.lever), scale: self.scale.max(other.scale) }
    }
}

/// Change of scaled normals on the way that both its ends do not show.
pub(crate) const MOST_BULGE: f32 = 0.05;

/// Places all leaves, with the lean of their own faces.
impl Kernel for FlyingLeaves<'_> {
    type Output = Turning;

    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Turning {
        let mut turning = Turning::default();
        let mut corners = [[Vec3A::ZERO; 2]; MOST_CORNERS];
        self.placed.clear();
        for leaf in 0..self.leaves.len() {
            let (placed_leaf, of_leaf) = self.place_leaf(leaf, &mut corners);
            self.placed.push(placed_leaf);
            turning = turning.or_more(of_leaf);
        }
        turning
    }
}

impl FlyingLeaves<'_> {
    #[inline(always)]
    fn place_leaf(&self, leaf: usize, corners: &mut [[Vec3A; 2]; MOST_CORNERS]) -> (PlacedLeaf, Turning) {
        let mut bounds = SweptBox::NOTHING;
        for (&slot, corner) in self.leaves.corners(leaf).iter().zip(corners.iter_mut()) {
            let [start, way] = [self.starts, self.ways].map(|cells| place(cells, slot));
            let way = way * self.substeps;
            bounds.add(start, way);
            *corner = [start, start + way];
        }
        let shift = Vec3A::from(self.origin);
        bounds.low += shift - self.growth;
        bounds.high += shift + self.growth;
        let faces = self.leaves.faces(leaf);
        let approach = (bounds.fast - bounds.slow).length();
        let scale = faces.iter().fold(0.0_f32, |most, face| most.max(face.scale));
        // The normal of a face whose corners go straight is a parabola: this is how far it may bulge.
        let bulge = 0.25 * scale * approach * approach;
        let bulges = !self.leaves.are_links && bulge >= MOST_BULGE;
        let (mut low, mut high, mut squares) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY, Vec3A::ZERO);
        for face in faces {
            let mut add = |normal: Vec3A| {
                low = low.min(normal * face.scale);
                high = high.max(normal * face.scale);
            };
            let [a, b, c] = face.corners.map(|corner| &corners[usize::from(corner) % MOST_CORNERS]);
            let [[u, v], [later_u, later_v]] = [0, 1].map(|time| [b[time] - a[time], c[time] - a[time]]);
            if self.leaves.are_links {
                add(u);
                add(later_u);
            } else {
                add(cross(u, v));
                add(cross(later_u, later_v));
                if bulges {
                    // With this one as the middle, the three hold the parabola between them (as Bézier's points do).
                    add((cross(u, later_v) + cross(later_u, v)) * 0.5);
                }
            }
            squares = squares.max(u * u + v * v);
        }
        let turning = if self.leaves.are_links {
            Turning { lever: scale, scale: 0.0 }
        } else {
            // The sum of two lengths is at most the root of twice the sum of their squares.
            let sides = (2.0 * squares.element_sum()).sqrt() + 2.0 * approach;
            Turning { lever: scale * sides, scale }
        };
        (PlacedLeaf { bounds, active: bounds, lean: Lean::between(low, high) }, turning)
    }
}

#[inline(always)]
fn place(cells: &[Cell], slot: u32) -> Vec3A {
    let (cell, lane) = (&cells[slot as usize / LANES], slot as usize % LANES);
    Vec3A::new(cell.x[lane], cell.y[lane], cell.z[lane])
}

/// The cross product by single products and differences, alike on every machine.
#[inline(always)]
fn cross(u: Vec3A, v: Vec3A) -> Vec3A {
    (u.zxy() * v - u * v.zxy()).zxy()
}
