//! Numbers that know their range: the parser rejects others with line and column.

use core::fmt;
use std::borrow::Cow;

use bevy_drape::drape_solver::constants::MAX_MAGNITUDE;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use crate::text::{ENDLESS, range_in_words};

/// The error of a number outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("expected a number{}, found {found}", range_in_words(*least, *greatest))]
pub struct OutOfRange {
    /// The least that is allowed.
    pub least: f64,
    /// The greatest that is allowed.
    pub greatest: f64,
    /// The number that was found.
    pub found: f64,
}

macro_rules! number {
    ($(#[$meta:meta])* $name:ident($inner:ty): $least:expr, $greatest:expr) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
        #[serde(try_from = "f64", into = "f64")]
        pub struct $name($inner);

        impl $name {
            /// The least value.
            pub const LEAST: $inner = $least;
            /// The greatest value.
            pub const GREATEST: $inner = $greatest;

            /// Checks that the number is in the range.
            ///
            /// # Errors
            /// [`OutOfRange`], also for NaN.
            pub fn new(value: $inner) -> Result<Self, OutOfRange> {
                if (Self::LEAST..=Self::GREATEST).contains(&value) {
                    Ok(Self::known(value))
                } else {
                    Err(OutOfRange {
                        least: shortest(Self::LEAST),
                        greatest: shortest(Self::GREATEST),
                        found: shortest(value),
                    })
                }
            }

            /// A number that is known to be in the range.
            pub(crate) const fn known(value: $inner) -> Self {
                Self(value)
            }

            /// The number itself.
            pub const fn get(self) -> $inner {
                self.0
            }
        }

        impl TryFrom<f64> for $name {
            type Error = OutOfRange;

            fn try_from(value: f64) -> Result<Self, OutOfRange> {
                Self::new(value as $inner)
            }
        }

        impl From<$name> for f64 {
            fn from(number: $name) -> Self {
                shortest(number.0)
            }
        }

        impl JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!({
                    "type": "number",
                    "minimum": shortest(Self::LEAST),
                    "maximum": shortest(Self::GREATEST),
                })
            }
        }
    };
}

number! {
    /// A finite number: from -10^6 to 10^6.
    #[derive(Default)]
    Number(f32): -MAX_MAGNITUDE, MAX_MAGNITUDE
}
number! {
    /// A number above zero: from 10^-6 to 10^6.
    Positive(f32): 1.0e-6, MAX_MAGNITUDE
}
number! {
    /// A number from 0 to 10^6.
    #[derive(Default)]
    NonNegative(f32): 0.0, MAX_MAGNITUDE
}
number! {
    /// A number from 0 to 1.
    #[derive(Default)]
    Fraction(f32): 0.0, 1.0
}
number! {
    /// A volume in units of the rest volume, from 0 to 1000.
    Pressure(f32): 0.0, 1.0e3
}
number! {
    /// Seconds of simulated time, from 0 to 10^5.
    Seconds(f64): 0.0, 1.0e5
}
number! {
    /// A bound for measured values: a number from -10^15 to 10^15, in the unit of the probe.
    Bound(f64): -ENDLESS, ENDLESS
}
number! {
    /// The greatest distance of a measured value from the expected one: from 0 to 10^15, in the unit of the probe.
    Tolerance(f64): 0.0, ENDLESS
}
number! {
    /// The length of a step in seconds, from 10^-5 to 0.1.
    StepLength(f64): 1.0e-5, 0.1
}

/// Converts a number to double precision so that it prints with as few digits as in its own.
fn shortest<T: fmt::Display>(value: T) -> f64 {
    value.to_string().parse().unwrap_or(f64::NAN)
}
