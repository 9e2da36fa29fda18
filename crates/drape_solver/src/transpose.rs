//! Turns sixteen vectors of sixteen numbers into the sixteen of their columns.

use fearless_simd::{Simd, f32x16, prelude::*};

use crate::columns::LANES;

/// Lane `j` of vector `i` becomes lane `i` of vector `j`.
///
/// A perfect shuffle of the 256 numbers, cut into halves, moves the highest bit of a number's place to the lowest. After
/// four of them the two halves of the eight bits, which are vector and lane, have changed places.
#[inline(always)]
pub(crate) fn transpose<S: Simd>(mut vectors: [f32x16<S>; LANES]) -> [f32x16<S>; LANES] {
    for _ in 0..LANES.ilog2() {
        let before = vectors;
        for (i, pair) in vectors.chunks_exact_mut(2).enumerate() {
            let (a, b) = (before[i], before[i + LANES / 2]);
            pair[0] = a.zip_low(b);
            pair[1] = a.zip_high(b);
        }
    }
    vectors
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::isa::{Isa, Kernel};
    use crate::lanes::load;

    struct Transpose([[f32; LANES]; LANES]);

    impl Kernel for Transpose {
        type Output = [[f32; LANES]; LANES];

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            transpose(self.0.map(|row| load(simd, &row))).map(|column| column.to_array())
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
