//! Random numbers that are equal on every machine.

use drape_solver::splitmix::SplitMix64;

/// Random numbers in the forms that scenes and experiments need.
pub struct Random(SplitMix64);

impl Random {
    /// A generator that starts at `seed`.
    pub fn new(seed: u64) -> Self {
        Self(SplitMix64(seed))
    }

    /// A generator for item `index` of `seed`, unrelated to those of other items.
    pub fn of_index(seed: u64, index: u64) -> Self {
        Self::new(SplitMix64(seed).bits() ^ SplitMix64(!index).bits())
    }

    /// Evenly spread over -1..1.
    pub fn either_side(&mut self) -> f64 {
        2.0 * self.0.unit() - 1.0
    }

    /// Evenly spread over `low`..`high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * 0.5 * (self.either_side() + 1.0)
    }

    /// The numbers 0..`count` in random order.
    pub fn permutation(&mut self, count: u32) -> Vec<u32> {
        let mut order: Vec<u32> = (0..count).collect();
        for i in (1..order.len()).rev() {
            order.swap(i, (self.0.bits() % (i as u64 + 1)) as usize);
        }
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_permutation_has_every_number_once_and_not_in_order() {
        let shuffled = Random::new(1).permutation(1000);
        let mut sorted = shuffled.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..1000).collect::<Vec<_>>());
        let in_place = (0..1000).filter(|&i| shuffled[i as usize] == i).count();
        assert!(in_place < 20, "{in_place} stayed where they were");
    }

    #[test]
    fn numbers_fill_the_range() {
        let mut random = Random::new(1);
        let numbers: Vec<f64> = (0..10_000).map(|_| random.either_side()).collect();
        assert!(numbers.iter().all(|x| (-1.0..1.0).contains(x)));
        let mean = numbers.iter().sum::<f64>() / 1e4;
        let spread = numbers.iter().map(|x| x * x).sum::<f64>() / 1e4;
        assert!(mean.abs() < 0.03 && (spread - 1.0 / 3.0).abs() < 0.02, "{mean}, {spread}");
    }
}
