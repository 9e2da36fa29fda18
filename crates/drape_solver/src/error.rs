//! Errors of builders and steps, and the checks that raise them.
//!
//! ```
//! use drape_solver::{BodySettings, BuildError, ClothBuilder};
//!
//! let settings = BodySettings { drag: -1.0, ..BodySettings::default() };
//! let error = ClothBuilder::new(1.0, 1.0, 8, 8).build(settings).expect_err("drag is negative");
//! // The type is for programs, the sentence for people.
//! assert!(matches!(error, BuildError::OutOfRange { field: "drag", value: -1.0, .. }));
//! assert!(error.to_string().starts_with("drag must be"));
//! ```

use thiserror::Error;

/// The reason that a body, an obstacle or a ball cannot be built.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum BuildError {
    /// A number is NaN, infinite, or too large to compute with.
    #[error("{field} must be finite and below 1e6, but is {value}")]
    NotFinite {
        /// The field at fault.
        field: &'static str,
        /// Its value.
        value: f32,
    },
    /// A number that must be above zero is zero or negative.
    #[error("{field} must be above zero, but is {value}")]
    NotPositive {
        /// The field at fault.
        field: &'static str,
        /// Its value.
        value: f32,
    },
    /// A number lies outside its range.
    #[error("{field} must be from {min} to {max}, but is {value}")]
    OutOfRange {
        /// The field at fault.
        field: &'static str,
        /// Its value.
        value: f32,
        /// The least value allowed.
        min: f32,
        /// The greatest value allowed.
        max: f32,
    },
    /// A body needs more particles than it was given.
    #[error("{body} needs at least {needed} particles, but has {found}")]
    TooFewParticles {
        /// The kind of body.
        body: &'static str,
        /// The least number of particles.
        needed: u32,
        /// The number asked for.
        found: u32,
    },
    /// A body would have more particles than 32-bit indices and memory allow.
    #[error("{found} particles are too many for one body; the limit is {limit}")]
    TooManyParticles {
        /// The number asked for.
        found: u64,
        /// The greatest number allowed.
        limit: u64,
    },
    /// The two axes of a cloth do not span a plane, or are not of length one.
    #[error("the axes of a cloth must be of unit length and at right angles to each other")]
    BadAxes,
    /// A particle index points past the end.
    #[error("{what} names particle {index}, but the body has {count}")]
    NoSuchParticle {
        /// The thing that holds the index.
        what: &'static str,
        /// The index at fault.
        index: u32,
        /// The number of particles.
        count: u32,
    },
    /// A stick joins a particle to itself.
    #[error("a stick joins particle {particle} to itself")]
    SameEnds {
        /// The particle at both ends.
        particle: u32,
    },
    /// Two sticks join the same two particles.
    #[error("two sticks join particles {a} and {b}")]
    DuplicateStick {
        /// One end.
        a: u32,
        /// The other end.
        b: u32,
    },
    /// Two particles that a stick joins lie in the same place, so that its rest length is zero.
    #[error("particles {a} and {b} coincide: the stick between them would have rest length zero")]
    ZeroRestLength {
        /// One end.
        a: u32,
        /// The other end.
        b: u32,
    },
    /// The numbers of a torn body contradict themselves.
    #[error("this is no torn body: {reason}")]
    BadTopology {
        /// The fault.
        reason: &'static str,
    },
    /// An obstacle's shape is one that point queries cannot handle.
    #[error("the shape cannot be used as an obstacle: {reason}")]
    BadShape {
        /// The fault of the shape.
        reason: &'static str,
    },
}

impl BuildError {
    /// The field that holds an invalid number, if that is the fault.
    pub fn field(&self) -> Option<&'static str> {
        match *self {
            Self::NotFinite { field, .. }
            | Self::NotPositive { field, .. }
            | Self::OutOfRange { field, .. } => Some(field),
            _ => None,
        }
    }
}

/// The reason that a step cannot be taken, or the fault that it found.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum StepError {
    /// The time step is zero, negative, NaN or infinite.
    #[error("the time step must be finite and above zero, but is {0} s")]
    BadTimestep(f32),
    /// Gravity or wind is NaN or infinite.
    #[error("{0} must be finite")]
    BadEnvironment(&'static str),
    /// A body's setting is outside its range.
    #[error("settings of body {body}: {source}")]
    BadSettings {
        /// The body, by index in the island.
        body: usize,
        /// The field at fault.
        source: BuildError,
    },
    /// A body got a NaN or infinite position or velocity from its caller.
    #[error("body {0} holds a position or velocity that is not finite")]
    NonFiniteBody(usize),
    /// A ball got a NaN or infinite position or velocity from its caller.
    #[error("ball {0} holds a position or velocity that is not finite")]
    NonFiniteBall(usize),
}

/// Returns `value` if it is finite and of a magnitude that can be computed with.
///
/// # Errors
/// [`BuildError::NotFinite`] with the name of the field.
pub fn finite(field: &'static str, value: f32) -> Result<f32, BuildError> {
    // `abs() <= MAX` is false for NaN.
    if value.abs() <= crate::constants::MAX_MAGNITUDE {
        Ok(value)
    } else {
        Err(BuildError::NotFinite { field, value })
    }
}

/// Returns `value` if it is finite and above zero.
///
/// # Errors
/// [`BuildError::NotFinite`] or [`BuildError::NotPositive`] with the name of the field.
pub fn positive(field: &'static str, value: f32) -> Result<f32, BuildError> {
    if finite(field, value)? > 0.0 { Ok(value) } else { Err(BuildError::NotPositive { field, value }) }
}

/// Returns `value` if it lies in `min..=max`.
///
/// # Errors
/// [`BuildError::NotFinite`] for NaN, else [`BuildError::OutOfRange`], with the name of the field.
pub fn in_range(field: &'static str, value: f32, min: f32, max: f32) -> Result<f32, BuildError> {
    if value.is_nan() {
        Err(BuildError::NotFinite { field, value })
    } else if (min..=max).contains(&value) {
        Ok(value)
    } else {
        Err(BuildError::OutOfRange { field, value, min, max })
    }
}

/// Checks that two axes are of unit length and at right angles to each other.
pub(crate) fn right_angled(p: glam::Vec3, q: glam::Vec3) -> Result<(), BuildError> {
    let unit = |v: glam::Vec3| (v.length_squared() - 1.0).abs() < 1e-3;
    if unit(p) && unit(q) && p.dot(q).abs() < 1e-3 { Ok(()) } else { Err(BuildError::BadAxes) }
}

/// Returns `value` if all its components are finite.
pub(crate) fn finite_vector(field: &'static str, value: glam::Vec3) -> Result<glam::Vec3, BuildError> {
    for component in value.to_array() {
        finite(field, component)?;
    }
    Ok(value)
}
