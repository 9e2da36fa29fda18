//! Whole numbers that know their range.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use crate::scene::OutOfRange;

/// A whole number from `LEAST` to `GREATEST`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "u32", into = "u32")]
pub struct Whole<const LEAST: u32, const GREATEST: u32>(u32);

impl<const LEAST: u32, const GREATEST: u32> Whole<LEAST, GREATEST> {
    /// Checks that the number is in the range.
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
