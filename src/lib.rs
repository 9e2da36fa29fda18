//! What the examples and tests share.
