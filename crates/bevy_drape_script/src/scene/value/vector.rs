//! Vectors of finite numbers.

use std::borrow::Cow;

use bevy::prelude::*;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer, Serialize};

use crate::scene::{Number, OutOfRange, bracketed};

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
    /// Checks that all components are in the range.
    ///
    /// # Errors
    /// [`OutOfRange`] with the first component that is not.
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
        (Number::known(x), Number::known(y), Number::known(z))
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
