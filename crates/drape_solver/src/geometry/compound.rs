//! Several shapes as one obstacle.
//!
//! Design: `docs/design/obstacles.md`.

use glam::Vec3;
use parry3d::shape::Compound;

use crate::error::BuildError;
use crate::geometry::nearest::{FaceOrEdge, Nearest};
use crate::geometry::pose::{Placement, Pose};
use crate::geometry::shape::{Plane, Shape, Surface};
use crate::geometry::sweep::SweepHit;

/// Shapes that are moved as one. Made by [`Shape::compound`](crate::Shape::compound) and
/// [`Shape::from_parry`](crate::Shape::from_parry).
#[derive(Clone, Debug)]
pub struct CompoundShape {
    parts: Vec<Part>,
    low: Vec3,
    high: Vec3,
}

#[derive(Clone, Debug)]
struct Part {
    shape: Shape,
    placement: Placement,
    pose: Pose,
}

impl CompoundShape {
    pub(crate) fn of_compound(compound: &Compound) -> Result<Self, BuildError> {
        let parts = compound.shapes().iter().map(|(pose, shape)| {
            let placement = Placement { translation: pose.translation, rotation: pose.rotation };
            Ok((Shape::from_parry(shape.clone())?, placement))
        });
        Self::of_parts(parts.collect::<Result<_, BuildError>>()?)
    }

    pub(crate) fn of_parts(parts: Vec<(Shape, Placement)>) -> Result<Self, BuildError> {
        if parts.is_empty() || !parts.iter().all(|(_, placement)| placement.is_valid()) {
            return Err(BuildError::BadShape { reason: "it has no parts, or one without a place" });
        }
        let (mut low, mut high) = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
        let mut placed = Vec::with_capacity(parts.len());
        for (shape, placement) in parts {
            let pose = Pose::at(&placement, Vec3::ZERO);
            let (own_low, own_high) = shape.local_bounds();
            if !(own_low.is_finite() && own_high.is_finite()) {
                return Err(BuildError::BadShape { reason: "a part of it has no end" });
            }
            for corner in 0..8 {
                let pick = |axis: usize| if corner >> axis & 1 == 0 { own_low[axis] } else { own_high[axis] };
                let point = pose.point_to_world(Vec3::new(pick(0), pick(1), pick(2)));
                (low, high) = (low.min(point), high.max(point));
            }
            placed.push(Part { shape, placement, pose });
        }
        Ok(Self { parts: placed, low, high })
    }

    /// Each part is scaled along its own axes: parts that are turned keep their form only under an even scale.
    pub(crate) fn scaled(&self, scale: Vec3) -> Result<Self, BuildError> {
        let parts = self.parts.iter().map(|part| {
            let placement = Placement { translation: part.placement.translation * scale, ..part.placement };
            Ok((part.shape.scaled(scale)?, placement))
        });
        Self::of_parts(parts.collect::<Result<_, BuildError>>()?)
    }

    /// The shapes, each with its place.
    pub fn parts(&self) -> impl ExactSizeIterator<Item = (&Shape, Placement)> {
        self.parts.iter().map(|part| (&part.shape, part.placement))
    }

    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        (self.low, self.high)
    }

    /// True if all of its parts have an inside.
    pub(crate) fn is_solid(&self) -> bool {
        self.parts.iter().all(|part| part.shape.is_solid())
    }

    /// The surface of the part in which the point is deepest, or that is nearest to it.
    pub(crate) fn surface(&self, point: Vec3) -> Surface {
        let mut nearest = Surface { distance: f32::INFINITY, normal: Vec3::Y };
        for part in &self.parts {
            let local = part.pose.to_local(point);
            let (low, high) = part.shape.local_bounds();
            let beyond = (low - local).max(local - high).max(Vec3::ZERO);
            if nearest.distance >= 0.0 && beyond.length_squared() > nearest.distance * nearest.distance {
                continue;
            }
            let surface = part.shape.surface(local);
            if surface.distance < nearest.distance {
                let normal = part.pose.direction_to_world(surface.normal);
                nearest = Surface { normal, ..surface };
            }
        }
        nearest
    }

    /// The point of `piece` that is nearest to any part.
    pub(crate) fn nearest_on(&self, piece: FaceOrEdge, reach: f32) -> Nearest {
        let mut nearest = Nearest::Apart;
        let mut reach = reach;
        for part in &self.parts {
            match part.shape.nearest_on(piece.map(|corner| part.pose.to_local(corner)), reach) {
                Nearest::Apart => {}
                Nearest::Through => return Nearest::Through,
                Nearest::At(distance, point) => {
                    reach = distance;
                    nearest = Nearest::At(distance, part.pose.point_to_world(point));
                }
            }
        }
        nearest
    }

    /// First hit on a part of a ball that moves from `start` by `path`.
    pub(crate) fn sweep_ball(&self, radius: f32, start: Vec3, path: Vec3) -> Option<SweepHit> {
        let sweep = |shape: &Shape, pose: &Pose| {
            let from = pose.to_local(start);
            shape.sweep_ball(radius, from, pose.to_local(start + path) - from)
        };
        self.first_hit(sweep)
    }

    /// First hit on a part of a triangle or segment that moves by `path`.
    pub(crate) fn sweep_piece(&self, piece: FaceOrEdge, path: Vec3) -> Option<SweepHit> {
        let sweep = |shape: &Shape, pose: &Pose| {
            let path = pose.to_local(path) - pose.to_local(Vec3::ZERO);
            shape.sweep_piece(piece.map(|corner| pose.to_local(corner)), path)
        };
        self.first_hit(sweep)
    }

    fn first_hit(&self, sweep: impl Fn(&Shape, &Pose) -> Option<SweepHit>) -> Option<SweepHit> {
        let hits = self.parts.iter().filter_map(|Part { shape, pose, .. }| {
            let SweepHit { fraction, point, plane } = sweep(shape, pose)?;
            let (point, normal) = (pose.point_to_world(point), pose.direction_to_world(plane.normal));
            Some(SweepHit { fraction, point, plane: Plane { normal, offset: normal.dot(point) } })
        });
        hits.min_by(|a, b| a.fraction.total_cmp(&b.fraction))
    }

    /// First entry into a part on the `path` from `start`: the fraction of the path, and the normal there.
    pub(crate) fn cast(&self, start: Vec3, path: Vec3) -> Option<(f32, Vec3)> {
        let hits = self.parts.iter().filter_map(|part| {
            let (from, to) = (part.pose.to_local(start), part.pose.to_local(start + path));
            let (fraction, normal) = part.shape.cast(from, to - from)?;
            Some((fraction, part.pose.direction_to_world(normal)))
        });
        hits.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}
