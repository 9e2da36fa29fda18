//! The shapes with a formula, for the particles of a whole cell at once: the same formulas as
//! [`Shape::surface`](crate::geometry::shape::Shape).
//!
//! Design: `docs/design/obstacles.md`.

use fearless_simd::{Simd, f32x16, prelude::*};
use glam::Vec3;

use crate::geometry::pose::Pose;
use crate::geometry::shape::{Plane, Shape};
use crate::geometry::taper::Taper;
use crate::simd::columns::{Cell, LANES};
use crate::simd::lanes::{Lanes3, load, of_three};

/// The solid from which distances are measured.
#[derive(Clone, Copy)]
pub(crate) enum Solid<'a> {
    /// A shape with a formula of its own.
    Formula(&'a Shape),
    /// A plane for each lane.
    Planes(&'a LanePlanes),
}

/// A plane for each lane of a cell: points with `normal . p < offset` are inside.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LanePlanes {
    pub normal: Cell,
    pub offset: [f32; LANES],
}

impl LanePlanes {
    pub fn get(&self, lane: usize) -> Plane {
        Plane { normal: self.normal.get(lane), offset: self.offset[lane] }
    }
}

impl Solid<'_> {
    /// True if all `points` (world) are certainly farther than `distance` (metres) from the solid at `pose`; a quick
    /// test, which may give false for some of them.
    #[inline(always)]
    pub fn is_beyond<S: Simd>(self, simd: S, points: Lanes3<S>, pose: LanePose<S>, distance: f32) -> bool {
        let Self::Formula(Shape::Sphere { radius }) = self else {
            return false;
        };
        let reach = f32x16::splat(simd, (radius + distance) * (radius + distance));
        let from_centre = points.minus(pose.translation);
        from_centre.dot(from_centre).simd_gt(reach).all_true()
    }

    /// Distance (negative inside) and unit normal of the surface nearest to each of the `points` (world) at `pose`.
    #[inline(always)]
    pub fn surface_at<S: Simd>(
        self,
        simd: S,
        points: Lanes3<S>,
        pose: LanePose<S>,
    ) -> (f32x16<S>, Lanes3<S>) {
        // A rotation does not change a sphere.
        if let Self::Formula(Shape::Sphere { radius }) = self {
            return from_core(simd, points.minus(pose.translation), *radius);
        }
        let (distance, normal) = self.surface(simd, pose.to_local(points));
        (distance, pose.direction_to_world(normal))
    }

    /// Distance (negative inside) and unit normal of the surface nearest to each point, in the shape's coordinates.
    #[inline(always)]
    pub fn surface<S: Simd>(self, simd: S, point: Lanes3<S>) -> (f32x16<S>, Lanes3<S>) {
        match self {
            Self::Planes(planes) => {
                let normal = Lanes3::load(simd, &planes.normal);
                (normal.dot(point) - load(simd, &planes.offset), normal)
            }
            Self::Formula(Shape::HalfSpace { normal }) => {
                let normal = Lanes3::splat(simd, *normal);
                (normal.dot(point), normal)
            }
            Self::Formula(Shape::Sphere { radius }) => from_core(simd, point, *radius),
            Self::Formula(Shape::Capsule { half_length, radius }) => {
                let half = f32x16::splat(simd, *half_length);
                let below = (-half).max(point.y).min(half);
                from_core(simd, Lanes3 { y: point.y - below, ..point }, *radius)
            }
            Self::Formula(Shape::TaperedCapsule { half_length, bottom_radius, top_radius }) => {
                let taper = Taper::new(*half_length, *bottom_radius, *top_radius);
                let (from_axis, radius) = taper.core_lanes(simd, point);
                let (distance, normal) = from_core(simd, from_axis, 0.0);
                (distance - radius, normal)
            }
            Self::Formula(Shape::Cuboid { half_extents }) => cuboid(simd, point, *half_extents),
            // Containers and other shapes come as planes.
            Self::Formula(
                Shape::Container { .. } | Shape::Mesh(_) | Shape::Compound(_) | Shape::Parry(_),
            ) => (f32x16::splat(simd, f32::INFINITY), Lanes3::splat(simd, Vec3::Y)),
        }
    }
}

#[inline(always)]
fn from_core<S: Simd>(simd: S, from_core: Lanes3<S>, radius: f32) -> (f32x16<S>, Lanes3<S>) {
    let length = from_core.dot(from_core).sqrt();
    let is_off = length.simd_gt(f32x16::splat(simd, 0.0));
    let one = f32x16::splat(simd, 1.0);
    let direction = from_core.times(one / is_off.select(length, one));
    (length - radius, direction.or(is_off, Lanes3::splat(simd, Vec3::Y)))
}

#[inline(always)]
fn cuboid<S: Simd>(simd: S, point: Lanes3<S>, half: Vec3) -> (f32x16<S>, Lanes3<S>) {
    let zero = f32x16::splat(simd, 0.0);
    let one = f32x16::splat(simd, 1.0);
    let sign = |v: f32x16<S>| v.simd_lt(zero).select(-one, one);
    let side = Lanes3 { x: sign(point.x), y: sign(point.y), z: sign(point.z) };
    let beyond =
        Lanes3 { x: point.x * side.x - half.x, y: point.y * side.y - half.y, z: point.z * side.z - half.z };
    let positive = |v: f32x16<S>| v.simd_gt(zero).select(v, zero);
    let outside = Lanes3 { x: positive(beyond.x), y: positive(beyond.y), z: positive(beyond.z) };
    let distance = outside.dot(outside).sqrt();
    let is_outside = distance.simd_gt(zero);
    let scale = one / is_outside.select(distance, one);
    let away = Lanes3 { x: outside.x * side.x, y: outside.y * side.y, z: outside.z * side.z }.times(scale);
    // Inside, out of the nearest face.
    let by_x = beyond.x.simd_ge(beyond.y) & beyond.x.simd_ge(beyond.z);
    let by_y = beyond.y.simd_ge(beyond.z);
    let depth = by_x.select(beyond.x, by_y.select(beyond.y, beyond.z));
    let nothing = Lanes3 { x: zero, y: zero, z: zero };
    let upright = Lanes3 { y: side.y, ..nothing }.or(by_y, Lanes3 { z: side.z, ..nothing });
    let face = Lanes3 { x: side.x, ..nothing }.or(by_x, upright);
    (is_outside.select(distance, depth), away.or(is_outside, face))
}

/// A pose, in lanes.
#[derive(Clone, Copy)]
pub(crate) struct LanePose<S: Simd> {
    axes: [Lanes3<S>; 3],
    translation: Lanes3<S>,
}

impl<S: Simd> LanePose<S> {
    #[inline(always)]
    pub fn new(simd: S, pose: &Pose) -> Self {
        let (axes, translation) = pose.parts();
        let axes = of_three(
            axes,
            #[inline(always)]
            |axis| Lanes3::splat(simd, axis),
        );
        Self { axes, translation: Lanes3::splat(simd, translation) }
    }

    #[inline(always)]
    pub fn to_local(self, point: Lanes3<S>) -> Lanes3<S> {
        let p = point.minus(self.translation);
        let [x, y, z] = self.axes;
        Lanes3 { x: x.dot(p), y: y.dot(p), z: z.dot(p) }
    }

    #[inline(always)]
    pub fn direction_to_world(self, local: Lanes3<S>) -> Lanes3<S> {
        let [x, y, z] = self.axes;
        x.times(local.x).plus(y.times(local.y)).plus(z.times(local.z))
    }

    #[inline(always)]
    pub fn point_to_world(self, local: Lanes3<S>) -> Lanes3<S> {
        self.direction_to_world(local).plus(self.translation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::isa::{Isa, Kernel};
    use crate::simd::miri::unless_miri;

    struct Measure<'a>(&'a Shape, &'a Cell);

    impl Kernel for Measure<'_> {
        type Output = ([f32; LANES], Cell);

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let (distance, normal) = Solid::Formula(self.0).surface(simd, Lanes3::load(simd, self.1));
            let mut normals = Cell::default();
            normal.store(&mut normals);
            (distance.to_array(), normals)
        }
    }

    #[test]
    fn cells_and_single_points_see_the_same_surface() {
        let half_extents = Vec3::new(0.5, 1.0, 2.0);
        let shapes = [
            Shape::Sphere { radius: 0.7 },
            Shape::Cuboid { half_extents },
            Shape::Capsule { half_length: 0.8, radius: 0.3 },
            Shape::TaperedCapsule { half_length: 0.8, bottom_radius: 0.3, top_radius: 0.7 },
            Shape::TaperedCapsule { half_length: 0.2, bottom_radius: 0.9, top_radius: 0.3 },
            Shape::HalfSpace { normal: Vec3::Y },
        ];
        for (shape, isa) in
            shapes.iter().flat_map(|shape| Isa::available().into_iter().map(move |isa| (shape, isa)))
        {
            for step in 0..unless_miri(500, 2) {
                let mut points = Cell::default();
                for lane in 0..LANES {
                    let spread = |k: f32| libm::sinf((step * LANES + lane) as f32 * k) * 2.5;
                    points.set(lane, Vec3::new(spread(0.7), spread(1.3), spread(2.9)));
                }
                let (distance, normal) = isa.run(Measure(shape, &points));
                for (lane, distance) in distance.into_iter().enumerate() {
                    let one = shape.surface(points.get(lane));
                    assert!((distance - one.distance).abs() < 1e-6, "{shape:?}");
                    assert!((normal.get(lane) - one.normal).length() < 1e-6, "{shape:?}");
                }
            }
        }
    }
}
