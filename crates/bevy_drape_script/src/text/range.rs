//! Ranges of numbers, in words.

/// Greater than any magnitude in a scene: a bound beyond it only keeps out infinities.
pub(crate) const ENDLESS: f64 = 1.0e15;

/// " from .. to ..", without the ends that are [`ENDLESS`].
pub(crate) fn range_in_words(least: f64, greatest: f64) -> String {
    let is_end = |end: &f64| end.abs() < ENDLESS;
    let least = Some(least).filter(is_end).map(|least| format!(" from {least}"));
    let greatest = Some(greatest).filter(is_end).map(|greatest| format!(" to {greatest}"));
    least.unwrap_or_default() + &greatest.unwrap_or_default()
}
