//! Backstops: no particle enters the sphere behind its animated place.
//!
//! ```text
//!          p       p  the animated place of the particle
//!       .-----.
//!     x'   c  |    c  the middle of the sphere, behind p along the normal
//!       '--x--'    x  the particle: put out of the sphere, away from its middle
//! ```
//!
//! The sphere is a moving kinematic obstacle without friction or restitution, as in `NvCloth` and Unreal's cloth. A
//! particle that meets it loses the velocity towards it and keeps the rest. The way out of the sphere is no velocity, so
//! relative to the sphere no particle gains energy. Backstops act after limits on motion. Where the way out leads beyond
//! a limit, the particle goes to the nearest place on the circle where both surfaces meet; where they do not meet, the
//! limit holds.
//!
//! Between two steps place and normal travel evenly, and the normal keeps its length: a middle on its straight way would
//! bring a large sphere nearer in a turn.
//!
//! Design: `docs/design/characters.md`.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};

use crate::constraint::motion_limit::Ball;
use crate::motion::body_columns::{BodyColumns, MovingColumns};
use crate::simd::columns::LANES;
use crate::simd::lanes::{Lanes3, load};
use crate::state::backstops::Backstops;

/// Squared length under which a direction is none.
const NO_DIRECTION: f32 = 1e-20;

impl Backstops {
    /// Puts the free particles of `cells`, at `places` in the moving columns, out of their spheres, in a substep between
    /// these two fractions of the step.
    #[inline(always)]
    pub fn enforce<S: Simd>(
        &self,
        simd: S,
        moving: &mut MovingColumns,
        places: Range<usize>,
        rest: &BodyColumns,
        cells: Range<usize>,
        [before, after]: [f32; 2],
    ) {
        let zero = f32x16::splat(simd, 0.0);
        let (radii, _) = self.radius.as_chunks::<LANES>();
        for (place, cell) in places.zip(cells) {
            let radius = load(simd, &radii[cell]);
            let is_free: mask32x16<S> = load(simd, &rest.inverse_mass[cell]).simd_gt(zero);
            let sphere = self.sphere(simd, cell, after);
            let position = Lanes3::load(simd, &moving.position[place]);
            let offset = position.minus(sphere.centre);
            let squared = offset.dot(offset);
            let is_inside = squared.simd_lt(radius * radius) & is_free;
            if !is_inside.any_true() {
                continue;
            }
            let mut outward = direction(simd, offset, sphere.normal);
            let limits = &rest.pose.limits;
            let mut is_held = is_inside;
            if !limits.is_empty() {
                let ball = limits.balls(simd, cell, after);
                (outward, is_held) = heed(simd, &sphere, radius, &ball, outward, is_inside);
            }
            let out = sphere.centre.plus(outward.times(radius));
            let travel = sphere.centre.minus(self.sphere(simd, cell, before).centre);
            let displacement = Lanes3::load(simd, &moving.displacement[place]);
            travel
                .plus(slide(simd, displacement.minus(travel), outward, radius))
                .or(is_held, displacement)
                .store(&mut moving.displacement[place]);
            out.or(is_held, position).store(&mut moving.position[place]);
        }
    }

    /// The spheres of a cell at this fraction of the step.
    #[inline(always)]
    fn sphere<S: Simd>(&self, simd: S, cell: usize, fraction: f32) -> Sphere<S> {
        let place = self.place.at(simd, cell, fraction);
        let normal = self.normal.at(simd, cell, fraction);
        let next = Lanes3::load(simd, &self.normal.next.cells[cell]);
        let normal = direction(simd, normal, next);
        let [distances, radii] = [&self.distance, &self.radius].map(|column| column.as_chunks::<LANES>().0);
        let depth = load(simd, &distances[cell]) + load(simd, &radii[cell]);
        Sphere { centre: place.minus(normal.times(depth)), normal }
    }
}

/// A sphere in each lane.
struct Sphere<S: Simd> {
    centre: Lanes3<S>,
    normal: Lanes3<S>,
}

/// The displacements of particles relative to their spheres, which they have left in these directions.
///
/// A displacement is the way of a whole substep, along a chord of the sphere: a tangent at its end would hold the particle
/// on the sphere for longer than its weight does.
#[inline(always)]
fn slide<S: Simd>(simd: S, relative: Lanes3<S>, outward: Lanes3<S>, radius: f32x16<S>) -> Lanes3<S> {
    let zero = f32x16::splat(simd, 0.0);
    let leaving = relative.dot(outward);
    let along = relative.minus(outward.times(leaving));
    let squared = along.dot(along).min(radius * radius);
    let of_chord = squared / (radius + (radius * radius - squared).sqrt());
    let slid = along.plus(outward.times(leaving.max(of_chord)));
    let gain = slid.dot(slid) / relative.dot(relative);
    let is_faster = gain.simd_gt(f32x16::splat(simd, 1.0));
    slid.times(f32x16::splat(simd, 1.0) / gain.max(zero).sqrt()).or(is_faster, slid)
}

/// Turns the directions in which particles leave their spheres, so that they stay within their limits. Tells also who
/// leaves at all.
#[inline(always)]
fn heed<S: Simd>(
    simd: S,
    sphere: &Sphere<S>,
    radius: f32x16<S>,
    ball: &Ball<S>,
    outward: Lanes3<S>,
    is_inside: mask32x16<S>,
) -> (Lanes3<S>, mask32x16<S>) {
    let zero = f32x16::splat(simd, 0.0);
    let off = sphere.centre.plus(outward.times(radius)).minus(ball.centre);
    let is_beyond = off.dot(off).simd_gt(ball.reach * ball.reach) & is_inside;
    if !is_beyond.any_true() {
        return (outward, is_inside);
    }
    let between = ball.centre.minus(sphere.centre);
    let axis = direction(simd, between, sphere.normal);
    let distance = between.dot(axis);
    // The circle lies so far below the top of the sphere; as differences of squares it would be lost in rounding.
    let gap = distance - radius;
    let below = (ball.reach - gap) * (ball.reach + gap) / (distance + distance);
    let across = below * (radius + radius - below);
    let sideways = outward.minus(axis.times(outward.dot(axis)));
    let is_meeting = across.simd_gt(zero) & sideways.dot(sideways).simd_gt(f32x16::splat(simd, NO_DIRECTION));
    let circle =
        direction(simd, sideways, axis).times(across.max(zero).sqrt()).plus(axis.times(radius - below));
    let turned = direction(simd, circle, axis).or(is_beyond, outward);
    (turned, is_inside & (is_meeting | !is_beyond))
}

/// Vectors of length one, or `other` where there is no direction.
#[inline(always)]
fn direction<S: Simd>(simd: S, vector: Lanes3<S>, other: Lanes3<S>) -> Lanes3<S> {
    let squared = vector.dot(vector);
    let has_direction = squared.simd_gt(f32x16::splat(simd, NO_DIRECTION));
    vector.times(f32x16::splat(simd, 1.0) / squared.sqrt()).or(has_direction, other)
}
