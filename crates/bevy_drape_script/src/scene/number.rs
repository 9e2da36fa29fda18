//! Numbers that know their range: what is outside of it is refused where it stands in the file.

use core::fmt;
use core::marker::PhantomData;
use std::borrow::Cow;

use bevy::prelude::*;
use bevy_drape::drape_solver::constants::MAX_MAGNITUDE;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::SeqAccessDeserializer;
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// A number that is not in its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("expected a number{}, found {found}", range_in_words(*least, *greatest))]
pub struct OutOfRange {
    /// The least that is allowed.
    pub least: f64,
    /// The greatest that is allowed.
    pub greatest: f64,
    /// What was found.
    pub found: f64,
}

/// " from .. to ..", leaving out ends that are there only to keep out infinities.
pub(crate) fn range_in_words(least: f64, greatest: f64) -> String {
    let is_end = |end: &f64| end.abs() < ENDLESS;
    let least = Some(least).filter(is_end).map(|least| format!(" from {least}"));
    let greatest = Some(greatest).filter(is_end).map(|greatest| format!(" to {greatest}"));
    least.unwrap_or_default() + &greatest.unwrap_or_default()
}

/// More than anything in a scene measures.
const ENDLESS: f64 = 1.0e15;

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

            /// This number, if it is in the range.
            ///
            /// # Errors
            /// [`OutOfRange`], also for what is not a number.
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
    /// A volume in parts of that at rest, from 0 to 1000.
    Pressure(f32): 0.0, 1.0e3
}
number! {
    /// Seconds of simulated time, from 0 to 10^5: a day and some hours.
    Seconds(f64): 0.0, 1.0e5
}
number! {
    /// What a measured value is held against: a number from -10^15 to 10^15, in the unit of the probe.
    Bound(f64): -ENDLESS, ENDLESS
}
number! {
    /// How far a measured value may be from the expected one: from 0 to 10^15, in the unit of the probe.
    Tolerance(f64): 0.0, ENDLESS
}
number! {
    /// The length of a step in seconds, from a hundred thousandth to a tenth.
    StepLength(f64): 1.0e-5, 0.1
}

/// A number in double precision that prints as the shortest decimal number which is the same in its own.
fn shortest<T: fmt::Display>(value: T) -> f64 {
    value.to_string().parse().unwrap_or(f64::NAN)
}

/// A whole number from `LEAST` to `GREATEST`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "u32", into = "u32")]
pub struct Whole<const LEAST: u32, const GREATEST: u32>(u32);

impl<const LEAST: u32, const GREATEST: u32> Whole<LEAST, GREATEST> {
    /// This number, if it is in the range.
    ///
    /// # Errors
    /// [`OutOfRange`].
    pub fn new(value: u32) -> Result<Self, OutOfRange> {
        if (LEAST..=GREATEST).contains(&value) {
            Ok(Self(value))
        } else {
            let [least, greatest, found] = [LEAST, GREATEST, value].map(f64::from);
            Err(OutOfRange { least, greatest, found })
        }
    }

    /// A number that is known to be in the range.
    pub(crate) const fn known(value: u32) -> Self {
        Self(value)
    }

    /// The number itself.
    pub const fn get(self) -> u32 {
        self.0
    }
}

impl<const LEAST: u32, const GREATEST: u32> TryFrom<u32> for Whole<LEAST, GREATEST> {
    type Error = OutOfRange;

    fn try_from(value: u32) -> Result<Self, OutOfRange> {
        Self::new(value)
    }
}

impl<const LEAST: u32, const GREATEST: u32> From<Whole<LEAST, GREATEST>> for u32 {
    fn from(number: Whole<LEAST, GREATEST>) -> Self {
        number.0
    }
}

impl<const LEAST: u32, const GREATEST: u32> JsonSchema for Whole<LEAST, GREATEST> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("Whole{LEAST}To{GREATEST}").into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "integer", "minimum": LEAST, "maximum": GREATEST })
    }
}

/// A vector `(x, y, z)` of finite numbers, from -10^6 to 10^6.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deref, Serialize)]
#[serde(into = "(Number, Number, Number)")]
pub struct Vector(Vec3);

impl<'de> Deserialize<'de> for Vector {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        bracketed::<(Number, Number, Number), D>(deserializer).map(Self::from)
    }
}

impl Vector {
    /// This vector, if it is in the range.
    ///
    /// # Errors
    /// [`OutOfRange`], naming the first component that is not.
    pub fn new(vector: Vec3) -> Result<Self, OutOfRange> {
        for component in vector.to_array() {
            Number::new(component)?;
        }
        Ok(Self(vector))
    }

    /// A vector that is known to be in the range.
    pub(crate) const fn known(vector: Vec3) -> Self {
        Self(vector)
    }

    /// The vector itself.
    pub const fn get(self) -> Vec3 {
        self.0
    }
}

impl From<(Number, Number, Number)> for Vector {
    fn from((x, y, z): (Number, Number, Number)) -> Self {
        Self(Vec3::new(x.get(), y.get(), z.get()))
    }
}

impl From<Vector> for (Number, Number, Number) {
    fn from(vector: Vector) -> Self {
        let Vec3 { x, y, z } = vector.0;
        (Number(x), Number(y), Number(z))
    }
}

impl JsonSchema for Vector {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Vector".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        <(Number, Number, Number)>::json_schema(generator)
    }
}

/// Some values in brackets: round ones, as in `(2, 1.5)`, or square ones, as in `[2, 1.5]`.
pub(crate) fn bracketed<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<T, D::Error> {
    struct Bracketed<T>(PhantomData<T>);

    impl<'de, T: Deserialize<'de>> Visitor<'de> for Bracketed<T> {
        type Value = T;

        fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
            formatter.write_str("values in brackets")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, items: A) -> Result<T, A::Error> {
            T::deserialize(SeqAccessDeserializer::new(items))
        }
    }

    deserializer.deserialize_any(Bracketed(PhantomData))
}
