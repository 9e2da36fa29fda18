//! The timeline of events, and the expectations: actions, triggers, probes, expected values.
//!
//! Import `value` and cannons. Called by `scene_script`, the checks and `play`.

mod action;
mod event;
mod expectation;
mod expected;
mod point;
mod probe;

pub use action::{Action, Selection};
pub use event::{Event, Repeat, Trigger};
pub use expectation::{Expectation, When};
pub use expected::{Expected, Measured};
pub use point::{Place, Point};
pub use probe::{Axis, Counted, Energy, Measure, Probe};
