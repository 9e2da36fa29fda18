//! Sixteen faces or links next to an obstacle whose shape has a formula: their deepest points, found and followed, and how deep
//! these are.
//!
//! As in `nearest.rs` and `face_obstacle.rs`, without a branch.
//!
//! Design: `docs/design/obstacles.md`.

use fearless_simd::{Simd, f32x16, prelude::*};
use glam::Vec3;

use crate::constants::LOOKS_AGAIN;
use crate::geometry::nearest::HALVINGS;
use crate::geometry::nearest_lanes::{TriangleLanes, inverse, part};
use crate::geometry::pose::Pose;
use crate::geometry::shape::Shape;
use crate::geometry::surface_lanes::{LanePose, Solid};
use crate::geometry::taper::Taper;
use crate::simd::columns::{Cell, Columns, LANES};
use crate::simd::isa::{Isa, Kernel};
use crate::simd::lanes::{Lanes3, load, of_three, set_lanes};

/// Faces, or links, one in each lane. Lanes without one repeat another.
#[derive(Clone, Debug)]
pub(super) struct FaceLanes {
    /// Slots of the corners; a link repeats its second one.
    corners: [[u32; LANES]; 3],
    /// Of the deepest points.
    weights: [[f32; LANES]; 3],
    is_link: bool,
    /// Bit mask of the lanes that were near enough in this substep to be projected one by one; not all of them touch.
    projected: u16,
}

impl FaceLanes {
    /// Elements with these slots of their corners and these weights of a point, at most sixteen.
    pub fn new(elements: impl Iterator<Item = ([usize; 3], [f32; 3])>, is_link: bool) -> Self {
        let mut lanes = Self { corners: [[0; LANES]; 3], weights: [[0.0; LANES]; 3], is_link, projected: 0 };
        for (lane, (corners, weights)) in elements.enumerate() {
            // The last one fills all lanes that are left.
            for k in 0..3 {
                lanes.corners[k][lane..].fill(corners[k] as u32);
                lanes.weights[k][lane..].fill(weights[k]);
            }
        }
        lanes
    }

    /// Weights of the deepest point in a lane.
    pub fn weights(&self, lane: usize) -> [f32; 3] {
        self.weights.map(|weights| weights[lane])
    }

    /// Notes that the contact in a lane is projected in this substep.
    pub fn note_projected(&mut self, lane: usize) {
        self.projected |= 1 << lane;
    }

    /// True if one has been projected in this substep.
    pub fn is_projected(&self) -> bool {
        self.projected != 0
    }

    /// Forgets the lanes that were projected in the last substep, and returns them.
    pub fn take_projected(&mut self) -> impl Iterator<Item = usize> + use<> {
        set_lanes(core::mem::take(&mut self.projected))
    }

    /// Finds the deepest points in a shape that consists of these balls, wherever they were before.
    pub fn find(&mut self, isa: Isa, position: &Columns, balls: Taper, pose: &Pose) {
        isa.run(Find { lanes: self, cells: &position.cells, balls, pose });
    }

    /// Follows the deepest points.
    pub fn follow(&mut self, isa: Isa, position: &Columns, shape: &Shape, pose: &Pose) {
        isa.run(Follow { lanes: self, cells: &position.cells, shape, pose });
    }

    /// Depths of the deepest points below the distance `keeps` from the surface, in metres.
    pub fn depths(
        &self,
        isa: Isa,
        position: &Columns,
        shape: &Shape,
        pose: &Pose,
        keeps: f32,
    ) -> [f32; LANES] {
        isa.run(Depths { lanes: self, cells: &position.cells, shape, pose, keeps })
    }

    /// The corners, in the coordinates of an obstacle.
    #[inline(always)]
    fn corners<S: Simd>(&self, simd: S, cells: &[Cell], pose: LanePose<S>) -> [Lanes3<S>; 3] {
        let [a, b, c] = &self.corners;
        of_three(
            [a, b, c],
            #[inline(always)]
            |slots| pose.to_local(gathered(simd, cells, slots)),
        )
    }
}

/// The vectors in these slots.
#[inline(always)]
fn gathered<S: Simd>(simd: S, cells: &[Cell], slots: &[u32; LANES]) -> Lanes3<S> {
    let mut found = Cell::default();
    for (lane, &slot) in slots.iter().enumerate() {
        let (cell, from) = (&cells[slot as usize / LANES], slot as usize % LANES);
        found.x[lane] = cell.x[from];
        found.y[lane] = cell.y[from];
        found.z[lane] = cell.z[from];
    }
    Lanes3::load(simd, &found)
}

/// The points with these weights.
#[inline(always)]
fn weighted<S: Simd>([a, b, c]: [f32x16<S>; 3], corners: [Lanes3<S>; 3]) -> Lanes3<S> {
    corners[0].times(a).plus(corners[1].times(b)).plus(corners[2].times(c))
}

struct Depths<'a> {
    lanes: &'a FaceLanes,
    cells: &'a [Cell],
    shape: &'a Shape,
    pose: &'a Pose,
    keeps: f32,
}

impl Kernel for Depths<'_> {
    type Output = [f32; LANES];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let Self { lanes, cells, shape, pose, keeps } = self;
        let corners = lanes.corners(simd, cells, LanePose::new(simd, pose));
        let [a, b, c] = &lanes.weights;
        let point = weighted([load(simd, a), load(simd, b), load(simd, c)], corners);
        let (distance, _) = Solid::Formula(shape).surface(simd, point);
        (f32x16::splat(simd, keeps) - distance).to_array()
    }
}

/// Balls along which the distance changes by less than this, in parts of their way, are equally near: a face that lies along the axis touches
/// as near to the middle as it can, not at the end to which rounding leads.
const AS_NEAR: f32 = 1e-5;

struct Find<'a> {
    lanes: &'a mut FaceLanes,
    cells: &'a [Cell],
    balls: Taper,
    pose: &'a Pose,
}

impl Kernel for Find<'_> {
    type Output = ();

    /// How far an element is off a ball is a convex function of the ball's height: halves the heights between which it has its least.
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { lanes, cells, balls, pose } = self;
        let corners = lanes.corners(simd, cells, LanePose::new(simd, pose));
        let element = Element::new(simd, corners, lanes.is_link);
        let splat = |value: f32| f32x16::splat(simd, value);
        let (mut low, mut high) = (splat(balls.low), splat(balls.high));
        let rounds = if balls.low < balls.high { HALVINGS } else { 0 };
        let (half, zero) = (splat(0.5), splat(0.0));
        let (most, least) = (splat(balls.growth + AS_NEAR), splat(balls.growth - AS_NEAR));
        for _ in 0..rounds {
            let middle = Lanes3 { x: zero, y: (low + high) * half, z: zero };
            let from_element = middle.minus(weighted(element.nearest(simd, middle), corners));
            let length = from_element.dot(from_element).sqrt();
            let is_lower = from_element.y.simd_gt(most * length);
            let is_higher = from_element.y.simd_lt(least * length);
            (low, high) = (is_lower.select(low, middle.y), is_higher.select(high, middle.y));
        }
        let [a, b, c] = element.nearest(simd, Lanes3 { x: zero, y: (low + high) * half, z: zero });
        lanes.weights = [a.to_array(), b.to_array(), c.to_array()];
    }
}

struct Follow<'a> {
    lanes: &'a mut FaceLanes,
    cells: &'a [Cell],
    shape: &'a Shape,
    pose: &'a Pose,
}

impl Kernel for Follow<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { lanes, cells, shape, pose } = self;
        let corners = lanes.corners(simd, cells, LanePose::new(simd, pose));
        let element = Element::new(simd, corners, lanes.is_link);
        if let Shape::Sphere { .. } = shape {
            let nearest = element.nearest(simd, Lanes3::splat(simd, Vec3::ZERO));
            lanes.weights = [nearest[0].to_array(), nearest[1].to_array(), nearest[2].to_array()];
            return;
        }
        let [a, b, c] = &lanes.weights;
        let mut weights = [load(simd, a), load(simd, b), load(simd, c)];
        let mut point = weighted(weights, corners);
        let (mut distance, mut normal) = Solid::Formula(shape).surface(simd, point);
        for _ in 0..LOOKS_AGAIN {
            let inwards = point.minus(normal.times(distance.abs()));
            let trial = element.nearest(simd, inwards);
            let place = weighted(trial, corners);
            let (there, its_normal) = Solid::Formula(shape).surface(simd, place);
            let is_deeper = there.simd_lt(distance);
            for k in 0..3 {
                weights[k] = is_deeper.select(trial[k], weights[k]);
            }
            point = place.or(is_deeper, point);
            normal = its_normal.or(is_deeper, normal);
            distance = is_deeper.select(there, distance);
        }
        lanes.weights = [weights[0].to_array(), weights[1].to_array(), weights[2].to_array()];
    }
}

/// Triangles or segments.
enum Element<S: Simd> {
    Triangle(Lanes3<S>, TriangleLanes<S>),
    /// The first end, the way to the second, and one over its squared length.
    Segment(Lanes3<S>, Lanes3<S>, f32x16<S>),
}

impl<S: Simd> Element<S> {
    #[inline(always)]
    fn new(simd: S, [a, b, c]: [Lanes3<S>; 3], is_link: bool) -> Self {
        let along = b.minus(a);
        if is_link {
            Self::Segment(a, along, inverse(simd, along.dot(along)))
        } else {
            Self::Triangle(a, TriangleLanes::new(simd, [along, c.minus(a)]))
        }
    }

    /// Weights of the points nearest to `points`.
    #[inline(always)]
    fn nearest(&self, simd: S, points: Lanes3<S>) -> [f32x16<S>; 3] {
        let (one, zero) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, 0.0));
        match self {
            Self::Triangle(a, triangle) => {
                let [s, t] = triangle.nearest(simd, points.minus(*a));
                [one - s - t, s, t]
            }
            Self::Segment(a, along, inverse) => {
                let t = part(simd, points.minus(*a).dot(*along) * *inverse);
                [one - t, t, zero]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use crate::contact::ball_cloth::FaceOrLink;
    use crate::contact::face_obstacle::deepest;
    use crate::contact::surface::testing::Numbers;
    use crate::geometry::nearest_triangle;
    use crate::geometry::pose::Placement;
    use crate::simd::miri::unless_miri;

    use super::*;

    const SHAPES: [Shape; 4] = [
        Shape::Sphere { radius: 0.3 },
        Shape::Cuboid { half_extents: Vec3::new(0.2, 0.3, 0.1) },
        Shape::Capsule { half_length: 0.2, radius: 0.15 },
        Shape::TaperedCapsule { half_length: 0.2, bottom_radius: 0.1, top_radius: 0.2 },
    ];

    /// Twelve faces or links of a decimetre near an obstacle at the origin, and their corners.
    fn elements(numbers: &mut Numbers, is_link: bool) -> (Columns, Vec<FaceOrLink>, FaceLanes) {
        const COUNT: usize = 12;
        let mut position = Columns::default();
        position.reset(3);
        let mut found = Vec::new();
        for first in (0..COUNT as u32).map(|k| 3 * k) {
            let middle = numbers.vector().normalize_or(Vec3::Y) * 0.35;
            (0..3).for_each(|k| position.set(first as usize + k, middle + numbers.vector() * 0.1));
            let corners = [first, first + 1, first + 2];
            let link = FaceOrLink::Link([first, first + 1]);
            found.push(if is_link { link } else { FaceOrLink::Face(corners) });
        }
        let lanes =
            FaceLanes::new(found.iter().map(|element| (element.corners(), element.middle())), is_link);
        (position, found, lanes)
    }

    #[test]
    fn lanes_follow_deepest_points_as_one_at_a_time_does() {
        let mut numbers = Numbers(7);
        let rotation = Quat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0);
        let pose = Pose::at(&Placement { translation: Vec3::new(0.01, -0.02, 0.03), rotation }, Vec3::ZERO);
        for step in 0..unless_miri(40, 1) {
            let shape = &SHAPES[step % SHAPES.len()];
            for is_link in [false, true] {
                let (position, elements, start) = elements(&mut numbers, is_link);
                let mut ends = Vec::new();
                for isa in Isa::available() {
                    let mut lanes = start.clone();
                    lanes.follow(isa, &position, shape, &pose);
                    let depths = lanes.depths(isa, &position, shape, &pose, 0.01);
                    ends.push(
                        [lanes.weights[0], lanes.weights[1], lanes.weights[2], depths]
                            .map(|k| k.map(f32::to_bits)),
                    );
                    for (lane, element) in elements.iter().enumerate() {
                        let corners = element.corners().map(|slot| pose.to_local(position.get(slot)));
                        let (_, surface) =
                            deepest(shape, *element, corners, element.middle(), 0.0, LOOKS_AGAIN);
                        let weights = lanes.weights(lane);
                        assert!(weights.iter().all(|weight| (-1e-6..=1.0).contains(weight)), "{weights:?}");
                        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
                        let own = shape.surface(nearest_triangle::weighted(weights, corners)).distance;
                        assert!((own - surface.distance).abs() < 2e-5, "{shape:?}: {own} {surface:?}");
                        // To the last bit: what is left out for its depth has none when it is looked at by itself.
                        assert_eq!(depths[lane].to_bits(), (0.01 - own).to_bits(), "{shape:?}");
                    }
                }
                assert!(
                    ends.iter().all(|end| *end == ends[0]),
                    "{shape:?}: the bits depend on the instruction set"
                );
            }
        }
    }

    /// The same of all instruction sets.
    fn found(start: &FaceLanes, position: &Columns, shape: &Shape, pose: &Pose) -> FaceLanes {
        let balls = shape.balls().expect("made of balls");
        let mut of_each_isa = Isa::available().into_iter().map(|isa| {
            let mut lanes = start.clone();
            lanes.find(isa, position, balls, pose);
            lanes
        });
        let first = of_each_isa.next().expect("an instruction set");
        assert!(of_each_isa.all(|lanes| lanes.weights == first.weights), "{shape:?}");
        first
    }

    /// No point of a fine grid is deeper than the deepest point.
    #[test]
    fn deepest_points_in_balls_are_found() {
        const GRID: usize = 40;
        let shapes = [
            Shape::Sphere { radius: 0.3 },
            Shape::Capsule { half_length: 0.2, radius: 0.15 },
            Shape::TaperedCapsule { half_length: 0.2, bottom_radius: 0.1, top_radius: 0.2 },
            Shape::TaperedCapsule { half_length: 0.2, bottom_radius: 0.2, top_radius: 0.1 },
            // The upper ball holds the lower one.
            Shape::TaperedCapsule { half_length: 0.05, bottom_radius: 0.1, top_radius: 0.3 },
        ];
        let part = |k: usize| k as f32 / GRID as f32;
        let mut numbers = Numbers(11);
        let rotation = Quat::from_euler(glam::EulerRot::XYZ, -0.7, 0.2, 1.4);
        let pose = Pose::at(&Placement { translation: Vec3::new(-0.02, 0.01, 0.0), rotation }, Vec3::ZERO);
        let mut inside = 0;
        for step in 0..unless_miri(60, 5) {
            let shape = &shapes[step % shapes.len()];
            for is_link in [false, true] {
                let (mut position, elements, start) = elements(&mut numbers, is_link);
                // The first has no area or length.
                (1..3).for_each(|slot| position.set(slot, position.get(0)));
                let lanes = found(&start, &position, shape, &pose);
                for (lane, element) in elements.iter().enumerate() {
                    let corners = element.corners().map(|slot| pose.to_local(position.get(slot)));
                    let distance = |weights| shape.distance(nearest_triangle::weighted(weights, corners));
                    let most = if is_link { 0 } else { GRID };
                    let grid = (0..=GRID).flat_map(|i| (0..=most.min(GRID - i)).map(move |j| (i, j)));
                    let on_grid = grid.map(|(i, j)| distance([part(i), part(GRID - i - j), part(j)]));
                    let least = on_grid.fold(f32::INFINITY, f32::min);
                    let own = distance(lanes.weights(lane));
                    assert!(own < least + 1e-5 && own > least - 0.01, "{shape:?}: {own}, not {least}");
                    inside += usize::from(own < 0.0);
                }
            }
        }
        assert!(inside > unless_miri(100, 5), "{inside}");
    }

    /// A face along the axis is as near at all heights: rounding alone led to its upper end.
    #[test]
    fn a_face_along_the_axis_touches_in_the_middle() {
        let shape = Shape::Capsule { half_length: 0.5, radius: 0.1 };
        let pose = Pose::at(&Placement::default(), Vec3::ZERO);
        for turn in 0..unless_miri(50, 2) {
            let (sin, cos) = libm::sincosf(turn as f32);
            let (out, aside) = (Vec3::new(cos, 0.0, sin), Vec3::new(-sin, 0.0, cos));
            let mut position = Columns::default();
            position.reset(1);
            let away = out * 0.11;
            let corners = [away + Vec3::Y * 0.3, away - Vec3::Y * 0.3, away + aside * 0.2];
            corners.into_iter().enumerate().for_each(|(slot, corner)| position.set(slot, corner));
            let start = FaceLanes::new([([0, 1, 2], [0.0; 3])].into_iter(), false);
            let weights = found(&start, &position, &shape, &pose).weights(0);
            let height = nearest_triangle::weighted(weights, corners).y;
            assert!(height.abs() < 1e-3, "{height} at {turn} rad");
        }
    }

    #[test]
    fn lanes_that_were_projected_are_forgotten_once() {
        let (_, _, mut lanes) = elements(&mut Numbers(1), false);
        assert!(!lanes.is_projected());
        [3, 11, 3].into_iter().for_each(|lane| lanes.note_projected(lane));
        assert!(lanes.is_projected());
        assert_eq!(lanes.take_projected().collect::<Vec<_>>(), [3, 11]);
        assert!(!lanes.is_projected());
    }
}
