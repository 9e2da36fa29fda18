//! The nearest points of a point and a triangle, and of two segments, sixteen at a time.
//!
//! As in `nearest_triangle.rs` and `nearest_segments.rs`, without a branch: each candidate is worked out, and the nearest
//! one chosen.
//!
//! Design: `docs/design/self_contact.md`.

use fearless_simd::{Simd, f32x16, prelude::*};

use crate::simd::lanes::Lanes3;

/// On x86 one instruction is this very choice, down to zeros and NaN; those of other machines differ there.
const CHOOSES_BY_ITSELF: bool = cfg!(any(target_arch = "x86", target_arch = "x86_64"));

/// The lesser of two numbers in each lane; the second if neither is.
#[inline(always)]
pub(crate) fn least<S: Simd>(a: f32x16<S>, b: f32x16<S>) -> f32x16<S> {
    if CHOOSES_BY_ITSELF { a.min(b) } else { a.simd_lt(b).select(a, b) }
}

/// The greater; the second if neither is.
#[inline(always)]
pub(crate) fn most<S: Simd>(a: f32x16<S>, b: f32x16<S>) -> f32x16<S> {
    if CHOOSES_BY_ITSELF { a.max(b) } else { a.simd_gt(b).select(a, b) }
}

/// Between 0 and 1; 0 for NaN.
#[inline(always)]
pub(crate) fn part<S: Simd>(simd: S, value: f32x16<S>) -> f32x16<S> {
    least(most(value, f32x16::splat(simd, 0.0)), f32x16::splat(simd, 1.0))
}

/// Least squared length that is divided by, in square metres.
const TINY: f32 = 1e-30;

/// One over each number, and a large number in place of one over zero.
#[inline(always)]
pub(crate) fn inverse<S: Simd>(simd: S, value: f32x16<S>) -> f32x16<S> {
    f32x16::splat(simd, 1.0) / most(value, f32x16::splat(simd, TINY))
}

/// A triangle with a corner at zero: its sides from there, and one over the squared lengths of these, of the third side,
/// and over the determinant of the first two.
#[derive(Clone, Copy)]
pub(crate) struct TriangleLanes<S: Simd> {
    pub sides: [Lanes3<S>; 2],
    pub inverses: [f32x16<S>; 4],
}

impl<S: Simd> TriangleLanes<S> {
    #[inline(always)]
    pub fn new(simd: S, [u, v]: [Lanes3<S>; 2]) -> Self {
        let third = v.minus(u);
        let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
        let inverses = [
            inverse(simd, uu),
            inverse(simd, vv),
            inverse(simd, third.dot(third)),
            inverse(simd, uu * vv - uv * uv),
        ];
        Self { sides: [u, v], inverses }
    }

    /// Weights of the two sides at the point nearest to `point`.
    #[inline(always)]
    pub fn nearest(&self, simd: S, point: Lanes3<S>) -> [f32x16<S>; 2] {
        let ([u, v], [iu, iv, it, id]) = (self.sides, self.inverses);
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
        let (pu, pv) = (point.dot(u), point.dot(v));
        let s = (vv * pu - uv * pv) * id;
        let t = (uu * pv - uv * pu) * id;
        // A triangle without area has no inside.
        let has_area = id.simd_lt(f32x16::splat(simd, 1.0 / TINY));
        let inside = has_area & s.simd_ge(zero) & t.simd_ge(zero) & (s + t).simd_le(one);
        let third = v.minus(u);
        let beyond = point.minus(u);
        let [along_u, along_v, along] =
            [part(simd, pu * iu), part(simd, pv * iv), part(simd, beyond.dot(third) * it)];
        let ways =
            [point.minus(u.times(along_u)), point.minus(v.times(along_v)), beyond.minus(third.times(along))];
        let [on_u, on_v, on_third] = [ways[0].dot(ways[0]), ways[1].dot(ways[1]), ways[2].dot(ways[2])];
        let is_v = on_v.simd_lt(on_u);
        let is_third = on_third.simd_lt(least(on_u, on_v));
        let rim_s = is_third.select(one - along, is_v.select(zero, along_u));
        let rim_t = is_third.select(along, is_v.select(along_v, zero));
        [inside.select(s, rim_s), inside.select(t, rim_t)]
    }
}

/// Parameters, from 0 to 1, of the nearest points of the segments from `w` to `w + u` and from zero to `v`. `inverses`
/// are one over the squared lengths of `u` and `v`.
#[inline(always)]
pub(crate) fn between_segments<S: Simd>(
    simd: S,
    w: Lanes3<S>,
    [u, v]: [Lanes3<S>; 2],
    [iu, iv]: [f32x16<S>; 2],
) -> [f32x16<S>; 2] {
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let (uw, vw) = (u.dot(w), v.dot(w));
    let area = uu * vv - uv * uv;
    // Parallel segments have many nearest points: the search begins in the middle.
    let is_steep = area.simd_gt(uu * vv * 1e-6);
    let s = part(simd, (uv * vw - uw * vv) * inverse(simd, area));
    let s = is_steep.select(s, f32x16::splat(simd, 0.5));
    let t = part(simd, (uv * s + vw) * iv);
    let s = part(simd, (uv * t - uw) * iu);
    [s, part(simd, (uv * s + vw) * iv)]
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::{nearest_segments, nearest_triangle};
    use crate::simd::columns::LANES;
    use crate::simd::isa::{Isa, Kernel};
    use crate::simd::miri::unless_miri;

    /// Weights on a triangle from zero with sides `u` and `v`, and parameters on segments, for one case in each lane.
    struct Cases([[Vec3; 3]; LANES]);

    impl Kernel for Cases {
        type Output = [[f32; LANES]; 4];

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let [w, u, v] = [0, 1, 2].map(|k| {
                let axis = |axis: usize| {
                    f32x16::load_array_ref(simd, &core::array::from_fn(|lane| self.0[lane][k][axis]))
                };
                Lanes3 { x: axis(0), y: axis(1), z: axis(2) }
            });
            let [a, b] = TriangleLanes::new(simd, [u, v]).nearest(simd, w);
            let inverses = [inverse(simd, u.dot(u)), inverse(simd, v.dot(v))];
            let [s, t] = between_segments(simd, w, [u, v], inverses);
            [a, b, s, t].map(SimdBase::to_array)
        }
    }

    /// Least and most of each lane of the two.
    struct Choices([[f32; LANES]; 2]);

    impl Kernel for Choices {
        type Output = [[f32; LANES]; 2];

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let [a, b] = self.0.map(|values| f32x16::load_array_ref(simd, &values));
            [least(a, b).to_array(), most(a, b).to_array()]
        }
    }

    /// Equal zeros of both signs and NaN, too, give the same bits on all machines: the second of the two.
    #[test]
    fn least_and_most_are_choices_down_to_the_last_bit() {
        let values = [0.0, -0.0, 1.0, -1.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 1e-42];
        for shift in 0..values.len() {
            let a: [f32; LANES] = core::array::from_fn(|lane| values[lane % values.len()]);
            let b: [f32; LANES] = core::array::from_fn(|lane| values[(lane + shift) % values.len()]);
            for isa in Isa::available() {
                let [low, high] = isa.run(Choices([a, b]));
                for lane in 0..LANES {
                    let (x, y) = (a[lane], b[lane]);
                    let expected = [if x < y { x } else { y }, if x > y { x } else { y }];
                    assert_eq!(
                        [low[lane], high[lane]].map(f32::to_bits),
                        expected.map(f32::to_bits),
                        "{x} {y}"
                    );
                }
            }
        }
    }

    #[test]
    fn lanes_find_what_one_at_a_time_finds() {
        for step in 0..unless_miri(300, 2) {
            let spread = |k: f32| libm::sinf((step as f32 + 0.3) * k);
            let cases: [[Vec3; 3]; LANES] = core::array::from_fn(|lane| {
                let k = 0.37 + lane as f32 * 0.113;
                let vector = |k: f32| Vec3::new(spread(k), spread(k * 1.7), spread(k * 2.9));
                let u = vector(k * 1.3);
                let v = match lane {
                    4 => u,
                    lane if lane % 5 == 4 => u * -0.7,
                    _ => vector(k * 2.1),
                };
                [vector(k), u, v]
            });
            for isa in Isa::available() {
                let found = isa.run(Cases(cases));
                for (lane, &[w, u, v]) in cases.iter().enumerate() {
                    let [a, b, s, t] = found.map(|lanes| lanes[lane]);
                    // Rounding alone says on which side of a triangle without width a point lies; that of lane 4 has one side.
                    if lane % 5 != 4 || lane == 4 {
                        let [_, p, q] = nearest_triangle::on_triangle([Vec3::ZERO, u, v], w);
                        let (own, other) = (w.distance(u * a + v * b), w.distance(u * p + v * q));
                        assert!((own - other).abs() < 1e-4, "{own} {other}");
                        assert!(a >= 0.0 && b >= 0.0 && a + b <= 1.0 + 1e-6);
                    }
                    let [p, q] = nearest_segments::between_segments([w, w + u], [Vec3::ZERO, v]);
                    let (own, other) = ((w + u * s).distance(v * t), (w + u * p).distance(v * q));
                    assert!(own < other + 1e-3, "{own} {other}");
                }
            }
        }
    }
}
