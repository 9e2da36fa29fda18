//! Vectors of [`LANES`] vectors, with which kernels compute.
//!
//! Every operation is one of `+ - * /`, a square root, a comparison or a choice, lane by lane: exact in IEEE
//! arithmetic, whatever the width of the registers. Products are never fused with sums.
//!
//! Design: `docs/design/kernels.md`.

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::Vec3;

use crate::simd::columns::{Cell, LANES};

/// A vector in each lane.
#[derive(Clone, Copy)]
pub(crate) struct Lanes3<S: Simd> {
    pub x: f32x16<S>,
    pub y: f32x16<S>,
    pub z: f32x16<S>,
}

impl<S: Simd> Lanes3<S> {
    #[inline(always)]
    pub fn load(simd: S, cell: &Cell) -> Self {
        Self { x: load(simd, &cell.x), y: load(simd, &cell.y), z: load(simd, &cell.z) }
    }

    #[inline(always)]
    pub fn store(self, cell: &mut Cell) {
        cell.x = self.x.to_array();
        cell.y = self.y.to_array();
        cell.z = self.z.to_array();
    }

    #[inline(always)]
    pub fn splat(simd: S, v: Vec3) -> Self {
        Self { x: f32x16::splat(simd, v.x), y: f32x16::splat(simd, v.y), z: f32x16::splat(simd, v.z) }
    }

    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }

    #[inline(always)]
    pub fn minus(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }

    #[inline(always)]
    pub fn times(self, factor: f32x16<S>) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }

    #[inline(always)]
    pub fn dot(self, other: Self) -> f32x16<S> {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The vectors at unit length, zero where they are zero, and where they are not.
    #[inline(always)]
    pub fn unit(self, simd: S) -> (Self, mask32x16<S>) {
        let length = self.dot(self).sqrt();
        let zero = f32x16::splat(simd, 0.0);
        let is_some = length.simd_gt(zero);
        (self.times(is_some.select(f32x16::splat(simd, 1.0) / length, zero)), is_some)
    }

    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// The vectors of the lanes `SHIFT` higher; the highest lanes get those of the lowest.
    #[inline(always)]
    pub fn shifted<const SHIFT: usize>(self) -> Self {
        Self {
            x: self.x.slide::<SHIFT>(self.x),
            y: self.y.slide::<SHIFT>(self.y),
            z: self.z.slide::<SHIFT>(self.z),
        }
    }

    /// [`shifted`](Self::shifted) by as many lanes as it takes from a patch of a grid to one of its neighbours, or back.
    #[inline(always)]
    pub fn shifted_by(self, lanes: usize) -> Self {
        Self { x: shifted_by(self.x, lanes), y: shifted_by(self.y, lanes), z: shifted_by(self.z, lanes) }
    }

    /// The vectors of the lanes that are 0 to 16 higher; the highest lanes get those of the lowest.
    #[inline(always)]
    pub fn rotated(self, lanes: usize) -> Self {
        Self { x: rotated(self.x, lanes), y: rotated(self.y, lanes), z: rotated(self.z, lanes) }
    }

    /// `self` where `mask` holds, else `other`.
    #[inline(always)]
    pub fn or(self, mask: mask32x16<S>, other: Self) -> Self {
        Self {
            x: mask.select(self.x, other.x),
            y: mask.select(self.y, other.y),
            z: mask.select(self.z, other.z),
        }
    }
}

/// The numbers of the lanes that are 0, 1, 3, 4 or 5 higher, or as many lower: `16 - lanes` higher.
#[inline(always)]
pub(crate) fn shifted_by<S: Simd>(v: f32x16<S>, lanes: usize) -> f32x16<S> {
    match lanes {
        0 => v,
        1 => v.slide::<1>(v),
        3 => v.slide::<3>(v),
        4 => v.slide::<4>(v),
        5 => v.slide::<5>(v),
        11 => v.slide::<11>(v),
        12 => v.slide::<12>(v),
        13 => v.slide::<13>(v),
        15 => v.slide::<15>(v),
        _ => unreachable!("no patch lies {lanes} lanes away"),
    }
}

/// The numbers of the lanes that are 0 to 16 higher; the highest lanes get those of the lowest.
#[inline(always)]
pub(crate) fn rotated<S: Simd>(v: f32x16<S>, lanes: usize) -> f32x16<S> {
    let v = if lanes & 1 == 0 { v } else { v.slide::<1>(v) };
    let v = if lanes & 2 == 0 { v } else { v.slide::<2>(v) };
    let v = if lanes & 4 == 0 { v } else { v.slide::<4>(v) };
    if lanes & 8 == 0 { v } else { v.slide::<8>(v) }
}

/// What a function gives for both. Vectors go through this in place of an array's own `map`, which is not compiled for the instruction
/// set: each operation may be a call there, with its vectors in memory.
#[inline(always)]
pub(crate) fn of_two<T, U>([a, b]: [T; 2], of: impl Fn(T) -> U) -> [U; 2] {
    [of(a), of(b)]
}

/// What a function gives for all three; see [`of_two`].
#[inline(always)]
pub(crate) fn of_three<T, U>([a, b, c]: [T; 3], of: impl Fn(T) -> U) -> [U; 3] {
    [of(a), of(b), of(c)]
}

/// The numbers of the lanes whose bits are set, the lowest first.
#[inline(always)]
pub(crate) fn set_lanes(bits: impl Into<u64>) -> impl Iterator<Item = usize> {
    let mut left = bits.into();
    core::iter::from_fn(move || {
        let lane = left.trailing_zeros() as usize;
        (left != 0).then(|| {
            left &= left - 1;
            lane
        })
    })
}

/// Bit mask of the first `count` lanes, or all.
#[inline(always)]
pub(crate) fn first_lanes(count: usize) -> u16 {
    if count >= LANES { u16::MAX } else { (1 << count) - 1 }
}

/// The numbers of one column of a cell.
#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, values: &[f32; LANES]) -> f32x16<S> {
    f32x16::load_array_ref(simd, values)
}
