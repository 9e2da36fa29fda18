//! What random tests share: numbers, and how many cases of which seed.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// A number from `low` to `high`, both included, that shrinks towards zero. Drawn as an integer, because proptest 1.12
/// panics for some seeds when it is asked for a range of floats.
pub fn between(low: f32, high: f32) -> impl Strategy<Value = f32> {
    let step = low.abs().max(high.abs()) / (1 << 24) as f32;
    let (first, last) = ((low / step).floor() as i32, (high / step).ceil() as i32);
    (first..=last).prop_map(move |steps| (steps as f32 * step).clamp(low, high))
}

/// So many cases, the same ones in every run, so that a commit passes everywhere or nowhere. `PROPTEST_RNG_SEED` asks for
/// others, `PROPTEST_CASES` for more or fewer.
pub fn cases(count: u32) -> ProptestConfig {
    if let Ok(seed) = std::env::var("PROPTEST_RNG_SEED") {
        println!("PROPTEST_RNG_SEED={seed}");
    }
    ProptestConfig {
        cases: count,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(20_190_717),
        ..ProptestConfig::default()
    }
}
