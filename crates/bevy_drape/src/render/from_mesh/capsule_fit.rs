//! The tapered capsule that lies nearest to a part of a skin.
//!
//! Least squares by Levenberg and Marquardt: the sum of squared distances of the skin from the surface has its least by the places of
//! two balls and their radii. The derivatives are simple, as the nearest ball stays the nearest: a distance changes by the normal and
//! by the shares that both ends have in that ball. What lies outside counts more than what lies inside.
//!
//! Design: `docs/design/characters.md`.

use bevy::math::{DMat3, DVec3};

/// Weight of the skin that lies outside; the rest up to 1 is that of the skin inside. At a half the capsule would lie half outside.
const OUTSIDE: f64 = 0.85;

/// Weight of the way of an end from where it began, beside that of all skin: holds ends that nothing else holds, as in a tube.
const HELD: f64 = 1e-6;

const ROUNDS: usize = 60;

/// Ends and radii.
const UNKNOWNS: usize = 8;

type Row = [f64; UNKNOWNS];

/// A piece of skin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SkinPiece {
    pub place: DVec3,
    pub area: f64,
}

/// The convex hull of two balls.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FittedBalls {
    pub centres: [DVec3; 2],
    pub radii: [f64; 2],
}

impl FittedBalls {
    /// Fits them to a skin, whose bone may point to its next joint: along the bone or along the skin's longest axis. None if the skin has
    /// no extent.
    pub fn of_skin(skin: &[SkinPiece], bone: Option<DVec3>) -> Option<Self> {
        let area: f64 = skin.iter().map(|piece| piece.area).sum();
        let middle = skin.iter().map(|piece| piece.place * piece.area).sum::<DVec3>() / area;
        let axes = [bone.and_then(DVec3::try_normalize), longest_axis(skin, middle)];
        let begun = axes.into_iter().flatten().filter_map(|axis| Self::along(skin, middle, axis, area));
        let fitted = begun.map(|begun| begun.fitted(skin, area));
        let best = fitted.min_by(|(_, one), (_, other)| one.total_cmp(other));
        best.map(|(balls, _)| balls).filter(Self::is_good)
    }

    fn is_good(&self) -> bool {
        let is_finite = self.centres.iter().all(|centre| centre.is_finite());
        is_finite && self.radii.iter().all(|&radius| radius > 0.0 && radius.is_finite())
    }

    /// A capsule along `axis` that just reaches both ends of the skin.
    fn along(skin: &[SkinPiece], middle: DVec3, axis: DVec3, area: f64) -> Option<Self> {
        let heights = || skin.iter().map(|piece| (piece.place - middle).dot(axis));
        let (low, high) =
            (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
        let out =
            |piece: &SkinPiece| (piece.place - middle).reject_from_normalized(axis).length() * piece.area;
        let radius = skin.iter().map(out).sum::<f64>() / area;
        // Two balls that are one would never part.
        let inset = radius.min(0.45 * (high - low));
        let centres = [middle + axis * (low + inset), middle + axis * (high - inset)];
        Some(Self { centres, radii: [radius; 2] }).filter(Self::is_good)
    }

    /// Distance of a point from their surface, negative inside, the unit normal there, and the share of the second ball in the
    /// ball that is nearest.
    fn nearest(&self, point: DVec3) -> (f64, DVec3, f64) {
        let [from, to] = self.centres;
        let [bottom, top] = self.radii;
        let (along, length) = (to - from, from.distance(to));
        let narrowing = bottom - top;
        let share = if narrowing.abs() >= length {
            if narrowing > 0.0 { 0.0 } else { 1.0 }
        } else {
            let height = (point - from).dot(along) / length;
            let out = (point - from - along * (height / length)).length();
            let slope = narrowing / (length * length - narrowing * narrowing).sqrt();
            ((height - out * slope) / length).clamp(0.0, 1.0)
        };
        let from_centre = point - from.lerp(to, share);
        let distance = from_centre.length() - bottom + narrowing * share;
        (distance, from_centre.normalize_or_zero(), share)
    }

    /// Distance of a point from their surface, negative inside.
    pub fn distance(&self, point: DVec3) -> f64 {
        self.nearest(point).0
    }

    /// The sum of squared distances, by area, of the skin and of the ends from where they began.
    fn cost(&self, skin: &[SkinPiece], begun: &Self, held: f64) -> f64 {
        let of_skin: f64 = skin
            .iter()
            .map(|piece| {
                let distance = self.distance(piece.place);
                piece.area * weight(distance) * distance * distance
            })
            .sum();
        let ways = (0..2).map(|end| self.centres[end].distance_squared(begun.centres[end]));
        of_skin + held * ways.sum::<f64>()
    }

    /// The best balls that are found from here, and their cost.
    fn fitted(self, skin: &[SkinPiece], area: f64) -> (Self, f64) {
        let held = HELD * area;
        let (mut best, mut cost) = (self, self.cost(skin, &self, held));
        let mut damping = 1e-3;
        for _ in 0..ROUNDS {
            let (mut matrix, mut right) = ([[0.0; UNKNOWNS]; UNKNOWNS], [0.0; UNKNOWNS]);
            for piece in skin {
                let (distance, normal, share) = best.nearest(piece.place);
                let rest = 1.0 - share;
                let [x, y, z] = normal.to_array();
                let row = [x * rest, y * rest, z * rest, x * share, y * share, z * share, rest, share];
                let weight = piece.area * weight(distance);
                for (i, one) in row.into_iter().enumerate() {
                    right[i] += weight * one * distance;
                    for (cell, other) in matrix[i].iter_mut().zip(row) {
                        *cell += weight * one * other;
                    }
                }
            }
            for (i, way) in (0..2).flat_map(|end| {
                let way = self.centres[end] - best.centres[end];
                way.to_array().into_iter().enumerate().map(move |(axis, way)| (3 * end + axis, way))
            }) {
                matrix[i][i] += held;
                right[i] += held * way;
            }
            for (i, row) in matrix.iter_mut().enumerate() {
                row[i] += damping * (row[i] + held);
            }
            let Some(step) = solved(matrix, right) else { break };
            let end = |first: usize| DVec3::new(step[first], step[first + 1], step[first + 2]);
            let trial = Self {
                centres: [best.centres[0] + end(0), best.centres[1] + end(3)],
                radii: [best.radii[0] + step[6], best.radii[1] + step[7]],
            };
            let trial_cost = trial.cost(skin, &self, held);
            if trial.is_good() && trial_cost < cost {
                let is_settled = trial_cost > cost * (1.0 - 1e-9);
                (best, cost) = (trial, trial_cost);
                damping *= 0.3;
                if is_settled {
                    break;
                }
            } else {
                damping *= 5.0;
            }
        }
        (best, cost)
    }
}

fn weight(distance: f64) -> f64 {
    if distance > 0.0 { OUTSIDE } else { 1.0 - OUTSIDE }
}

/// The direction in which a skin is longest.
fn longest_axis(skin: &[SkinPiece], middle: DVec3) -> Option<DVec3> {
    let spread = skin.iter().fold(DMat3::ZERO, |sum, piece| {
        let off = piece.place - middle;
        sum + DMat3::from_cols(off * off.x, off * off.y, off * off.z) * piece.area
    });
    // Powers of the matrix, by squaring, leave its longest axis.
    let mut power = spread;
    for _ in 0..12 {
        let greatest = power.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
        power *= 1.0 / greatest;
        power *= power;
    }
    let columns = [power.x_axis, power.y_axis, power.z_axis];
    let longest = columns.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))?;
    longest.try_normalize()
}

/// Solves a symmetric, positive definite system by elimination. None if it is singular.
fn solved(mut matrix: [Row; UNKNOWNS], mut right: Row) -> Option<Row> {
    for pivot in 0..UNKNOWNS {
        let row = matrix[pivot];
        if row[pivot] <= 0.0 || !row[pivot].is_finite() {
            return None;
        }
        for below in pivot + 1..UNKNOWNS {
            let factor = matrix[below][pivot] / row[pivot];
            matrix[below].iter_mut().zip(row).for_each(|(cell, above)| *cell -= factor * above);
            right[below] -= factor * right[pivot];
        }
    }
    for i in (0..UNKNOWNS).rev() {
        let known: f64 = (i + 1..UNKNOWNS).map(|j| matrix[i][j] * right[j]).sum();
        right[i] = (right[i] - known) / matrix[i][i];
    }
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn direction(index: u32) -> DVec3 {
        let part = |k: f64| (f64::from(index) * k).fract() * 2.0 - 1.0;
        DVec3::new(part(0.618_034), part(0.754_878), part(0.569_84)).normalize_or(DVec3::X)
    }

    #[test]
    fn a_tapered_capsule_is_found_in_its_own_skin() {
        let known = FittedBalls {
            centres: [DVec3::new(0.3, 0.1, 0.2), DVec3::new(0.5, 0.7, 0.3)],
            radii: [0.2, 0.1],
        };
        let skin: Vec<SkinPiece> = (1..2000)
            .map(|index| {
                let share = (f64::from(index) * 0.381_966).fract();
                let start = known.centres[0].lerp(known.centres[1], share) + direction(index) * 0.01;
                let (distance, normal, _) = known.nearest(start);
                SkinPiece { place: start - normal * distance, area: 1.0 }
            })
            .collect();
        for bone in [None, Some(DVec3::Y), Some(DVec3::X)] {
            let mut found = FittedBalls::of_skin(&skin, bone).expect("a skin");
            if found.radii[0] < found.radii[1] {
                found.centres.reverse();
                found.radii.reverse();
            }
            for end in 0..2 {
                let off = found.centres[end].distance(known.centres[end]);
                // The skin of a tube hardly tells where its ends are.
                assert!(off < 1e-2, "{bone:?}: end {end} is {off} m off");
                assert!((found.radii[end] - known.radii[end]).abs() < 2e-3, "{bone:?}: {:?}", found.radii);
            }
        }
    }

    #[test]
    fn a_ball_is_found_in_its_own_skin_and_no_capsule_in_none() {
        let skin = |radius: f64| -> Vec<SkinPiece> {
            (1..500)
                .map(|index| SkinPiece { place: DVec3::Z + direction(index) * radius, area: 1.0 })
                .collect()
        };
        let found = FittedBalls::of_skin(&skin(0.2), None).expect("a skin");
        for index in 1..500 {
            let distance = found.distance(DVec3::Z + direction(index) * 0.2);
            assert!(distance.abs() < 2e-3, "{distance} m off: {found:?}");
        }
        assert!(FittedBalls::of_skin(&skin(0.0), None).is_none());
        assert!(FittedBalls::of_skin(&[], Some(DVec3::X)).is_none());
    }
}
