//! Values of fields: numbers in a range, vectors, rotations, names.
//!
//! Import each other and `text`; all other files of `scene` import them.

mod brackets;
mod literal;
mod named;
mod names;
mod number;
mod turn;
mod vector;
mod whole;

pub(crate) use brackets::bracketed;
pub use literal::Literal;
pub use named::Named;
pub use names::Names;
pub(crate) use names::whole;
pub use number::{
    Bound, Fraction, NonNegative, Number, OutOfRange, Positive, Pressure, Seconds, StepLength, Tolerance,
};
pub use turn::Turn;
pub use vector::Vector;
pub use whole::Whole;
