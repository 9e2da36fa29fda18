//! The nearest point of a triangle or a segment to a shape: parry's query, for every shape.
//!
//! Design: `docs/design/obstacles.md`.

use glam::Vec3;
use parry3d::math::Pose as ParryPose;
use parry3d::query::details::closest_points_support_map_support_map;
use parry3d::query::{ClosestPoints, closest_points};
use parry3d::shape::{Cuboid, Segment, Shape as ParryShape, SupportMap, Triangle};

use crate::geometry::nearest_triangle::weighted;
use crate::geometry::nearest_triangle::{on_segment, on_triangle};
use crate::geometry::shape::Shape;
use crate::geometry::taper::Taper;

/// Halvings of the axis of a capsule, to within a millionth.
pub(crate) const HALVINGS: u32 = 20;

/// Nearest point of an element to a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Nearest {
    /// Farther apart than the reach of the query.
    Apart,
    /// Distance in metres, and the nearest point of the element.
    At(f32, Vec3),
    /// They intersect, or parry has no query for the two.
    Through,
}

/// A triangle or a segment, in the coordinates of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FaceOrEdge {
    Triangle([Vec3; 3]),
    Segment([Vec3; 2]),
}

impl FaceOrEdge {
    /// The same with all its corners moved.
    pub fn map(self, move_corner: impl Fn(Vec3) -> Vec3) -> Self {
        match self {
            Self::Triangle(corners) => Self::Triangle(corners.map(move_corner)),
            Self::Segment(ends) => Self::Segment(ends.map(move_corner)),
        }
    }

    fn nearest_to_point(self, point: Vec3) -> Vec3 {
        match self {
            Self::Triangle(corners) => weighted(on_triangle(corners, point), corners),
            Self::Segment([a, b]) => weighted(on_segment([a, b], point), [a, b, b]),
        }
    }

    /// The distance is a convex function of the ball's height: halves the heights between which it has its least.
    fn nearest_to_balls(self, taper: Taper) -> Vec3 {
        let (mut low, mut high) = (taper.low, taper.high);
        for _ in 0..HALVINGS {
            let middle = Vec3::Y * (0.5 * (low + high));
            let from_piece = middle - self.nearest_to_point(middle);
            if from_piece.y > taper.growth * from_piece.length() {
                high = middle.y;
            } else {
                low = middle.y;
            }
        }
        self.nearest_to_point(Vec3::Y * (0.5 * (low + high)))
    }

    fn nearest_to(self, shape: &dyn ParryShape, reach: f32) -> Nearest {
        let here = ParryPose::IDENTITY;
        let found = match self {
            Self::Triangle([a, b, c]) => closest_points(&here, &Triangle::new(a, b, c), &here, shape, reach),
            Self::Segment([a, b]) => closest_points(&here, &Segment::new(a, b), &here, shape, reach),
        };
        found.map_or(Nearest::Through, Nearest::of)
    }

    /// By GJK: more exact than parry's own test of triangles and boxes.
    fn nearest_to_convex(self, shape: &impl SupportMap, reach: f32) -> Nearest {
        let here = ParryPose::IDENTITY;
        Nearest::of(match self {
            Self::Triangle([a, b, c]) => {
                closest_points_support_map_support_map(&here, &Triangle::new(a, b, c), shape, reach)
            }
            Self::Segment([a, b]) => {
                closest_points_support_map_support_map(&here, &Segment::new(a, b), shape, reach)
            }
        })
    }
}

impl Nearest {
    fn at(distance: f32, point: Vec3, reach: f32) -> Self {
        match distance {
            _ if distance > reach => Self::Apart,
            _ if distance > 0.0 => Self::At(distance, point),
            _ => Self::Through,
        }
    }

    fn of(found: ClosestPoints) -> Self {
        match found {
            ClosestPoints::WithinMargin(own, other) if own.is_finite() => Self::At(own.distance(other), own),
            ClosestPoints::Disjoint => Self::Apart,
            _ => Self::Through,
        }
    }
}

impl Shape {
    /// The balls of which it consists, if it is a sphere or a capsule of either kind.
    pub(crate) fn balls(&self) -> Option<Taper> {
        let [half_length, bottom, top] = match *self {
            Self::Sphere { radius } => [0.0, radius, radius],
            Self::Capsule { half_length, radius } => [half_length, radius, radius],
            Self::TaperedCapsule { half_length, bottom_radius, top_radius } => {
                [half_length, bottom_radius, top_radius]
            }
            _ => return None,
        };
        Some(Taper::new(half_length, bottom, top))
    }

    /// The point of `piece` that is nearest to the shape, if it is within `reach` metres.
    pub(crate) fn nearest_on(&self, piece: FaceOrEdge, reach: f32) -> Nearest {
        match self {
            // Only particles touch these shapes.
            Self::HalfSpace { .. } | Self::Container { .. } => Nearest::Through,
            Self::Sphere { radius } => {
                let point = piece.nearest_to_point(Vec3::ZERO);
                Nearest::at(point.length() - radius, point, reach)
            }
            // By the capsule's core: GJK converges only on shapes with corners.
            Self::Capsule { half_length, radius } => {
                let core = Segment::new(Vec3::Y * *half_length, Vec3::NEG_Y * *half_length);
                match piece.nearest_to_convex(&core, reach + radius) {
                    Nearest::At(distance, point) => Nearest::At(distance - radius, point),
                    other => other,
                }
            }
            Self::TaperedCapsule { half_length, bottom_radius, top_radius } => {
                let point = piece.nearest_to_balls(Taper::new(*half_length, *bottom_radius, *top_radius));
                Nearest::at(self.distance(point), point, reach)
            }
            Self::Cuboid { half_extents } => piece.nearest_to_convex(&Cuboid::new(*half_extents), reach),
            Self::Mesh(mesh) => piece.nearest_to(mesh.triangles(), reach),
            Self::Compound(compound) => compound.nearest_on(piece, reach),
            Self::Parry(shape) => piece.nearest_to(&*shape.0, reach),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parry3d::shape::SharedShape;

    /// A triangle over the edge of a box, nearest in its middle, for every way to describe that box.
    #[test]
    fn the_middle_of_a_face_over_an_edge_is_found() {
        let half = Vec3::new(0.5, 0.2, 0.3);
        let (vertices, indices) = Cuboid::new(half).to_trimesh();
        let at = ParryPose::from_translation(Vec3::ZERO);
        let shapes = [
            SharedShape::cuboid(half.x, half.y, half.z),
            SharedShape::trimesh(vertices.clone(), indices).expect("a box"),
            SharedShape::convex_hull(&vertices).expect("a box"),
            SharedShape::compound(vec![(at, SharedShape::cuboid(half.x, half.y, half.z))]),
        ];
        // The plane x + y = 0.71 touches no more than the neighbourhood of the edge at x = 0.5, y = 0.2.
        let corners = [Vec3::new(0.31, 0.4, -0.1), Vec3::new(0.31, 0.4, 0.1), Vec3::new(0.71, 0.0, 0.0)];
        for shape in shapes {
            let shape = Shape::from_parry(shape).expect("valid");
            let Nearest::At(distance, point) = shape.nearest_on(FaceOrEdge::Triangle(corners), 0.1) else {
                panic!("{shape:?} is near");
            };
            assert!((distance - 0.01 / 2.0_f32.sqrt()).abs() < 1e-5, "{shape:?}: {distance}");
            assert!((point.truncate() - glam::Vec2::new(0.505, 0.205)).length() < 1e-4, "{shape:?}: {point}");
            let away = FaceOrEdge::Triangle(corners).map(|corner| corner + Vec3::X);
            assert_eq!(shape.nearest_on(away, 0.1), Nearest::Apart, "{shape:?}");
            let through = FaceOrEdge::Triangle(corners).map(|corner| corner - Vec3::X * 0.1);
            assert_eq!(shape.nearest_on(through, 0.1), Nearest::Through, "{shape:?}");
        }
    }
}
