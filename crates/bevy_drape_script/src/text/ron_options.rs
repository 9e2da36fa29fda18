//! The dialect of RON that scene files are written in.

use ron::Options;
use ron::extensions::Extensions;

/// `Some(..)` may be left out, and a variant holds the fields of its content: `Cloth(size: (1, 2))`.
pub(super) fn ron_options() -> Options {
    Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES)
}
