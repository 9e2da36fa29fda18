//! Sizes of tests under Miri, which takes about a thousand times as long.
//!
//! Design: `docs/design/kernels.md`.

/// `size`, or `small` under Miri.
pub(crate) fn unless_miri<T>(size: T, small: T) -> T {
    if cfg!(miri) { small } else { size }
}
