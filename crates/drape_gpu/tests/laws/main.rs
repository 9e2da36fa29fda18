//! Laws of physics on the GPU, and figures beside the processor's own. They need a graphics adapter, software included: `.ci/gpu` runs them.

mod beside_processor;
mod common;
mod contact;
mod distance_fields;
mod faults;
mod motion;
mod same_bits;
mod stability;
mod surface;
mod tube;
