//! Shuffles of the numbers of several vectors, and the transposition of sixteen.
//!
//! Design: `docs/design/kernels.md`.

use fearless_simd::{Simd, f32x16, prelude::*};

use crate::simd::columns::LANES;

/// Reads sixteen vectors and writes sixteen: lane `j` of the one that is read as `i` is lane `i` of the one that is
/// written as `j`.
///
/// A perfect shuffle of the 256 numbers, cut into halves, moves the highest bit of a number's place to the lowest. After
/// four of them the two halves of the eight bits, which are vector and lane, have changed places.
#[inline(always)]
pub(crate) fn transpose<S: Simd>(read: impl Fn(usize) -> f32x16<S>, mut write: impl FnMut(usize, f32x16<S>)) {
    let rows = each(read);
    let columns = shuffle(shuffle(shuffle(shuffle(rows))));
    // Written out, as all the following: a loop would take the vectors through memory.
    let [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = columns;
    write(0, a);
    write(1, b);
    write(2, c);
    write(3, d);
    write(4, e);
    write(5, f);
    write(6, g);
    write(7, h);
    write(8, i);
    write(9, j);
    write(10, k);
    write(11, l);
    write(12, m);
    write(13, n);
    write(14, o);
    write(15, p);
}

#[inline(always)]
fn each<T>(of: impl Fn(usize) -> T) -> [T; LANES] {
    [
        of(0),
        of(1),
        of(2),
        of(3),
        of(4),
        of(5),
        of(6),
        of(7),
        of(8),
        of(9),
        of(10),
        of(11),
        of(12),
        of(13),
        of(14),
        of(15),
    ]
}

#[inline(always)]
fn shuffle<S: Simd>(v: [f32x16<S>; LANES]) -> [f32x16<S>; LANES] {
    each(
        #[inline(always)]
        |i| {
            let (a, b) = (v[i / 2], v[i / 2 + LANES / 2]);
            if i % 2 == 0 { a.zip_low(b) } else { a.zip_high(b) }
        },
    )
}

/// A perfect shuffle of the 64 numbers of four vectors: the highest bit of a number's place becomes the lowest.
#[inline(always)]
pub(crate) fn shuffle_four<S: Simd>([a, b, c, d]: [f32x16<S>; 4]) -> [f32x16<S>; 4] {
    let (first, second) = a.interleave(c);
    let (third, fourth) = b.interleave(d);
    [first, second, third, fourth]
}

/// The inverse of [`shuffle_four`].
#[inline(always)]
pub(crate) fn unshuffle_four<S: Simd>(v: [f32x16<S>; 4]) -> [f32x16<S>; 4] {
    let (a, c) = v[0].deinterleave(v[1]);
    let (b, d) = v[2].deinterleave(v[3]);
    [a, b, c, d]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::isa::{Isa, Kernel};
    use crate::simd::lanes::load;

    struct Transpose([[f32; LANES]; LANES]);

    impl Kernel for Transpose {
        type Output = [[f32; LANES]; LANES];

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let mut columns = [[0.0; LANES]; LANES];
            transpose(|row| load(simd, &self.0[row]), |column, vector| columns[column] = vector.to_array());
            columns
        }
    }

    #[test]
    fn rows_become_columns_on_every_instruction_set() {
        let rows: [[f32; LANES]; LANES] =
            core::array::from_fn(|i| core::array::from_fn(|j| (i * LANES + j) as f32));
        for isa in Isa::available() {
            let columns = isa.run(Transpose(rows));
            for (i, j) in (0..LANES).flat_map(|i| (0..LANES).map(move |j| (i, j))) {
                assert_eq!(columns[j][i], rows[i][j], "{}", isa.name());
            }
        }
    }
}
