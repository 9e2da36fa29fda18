//! Values in the text of a file.

use core::fmt;
use std::borrow::Cow;

use ron::error::SpannedError;
use ron::value::RawValue;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::ser::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A value as it is written in a scene file: `0.5`, `(0, 1, 0)`, `High`, `Indices([1, 2])`. Its type depends on the
/// place where it is put.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Literal(String);

impl Literal {
    /// The value as text.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The value in `text`, if it is well-formed.
    pub(crate) fn from_ron(text: &str) -> Result<Self, SpannedError> {
        let text = text.trim();
        RawValue::from_ron(text).map(|_| Self(text.to_string()))
    }

    /// The texts that it may stand for, the likeliest first: a string may lack its quotes, and a variant may have some.
    pub(crate) fn readings(&self) -> Vec<String> {
        let is_word = |text: &str| {
            text.starts_with(char::is_alphabetic)
                && text.chars().all(|c| c.is_alphanumeric() || "_-#".contains(c))
        };
        let mut readings = vec![self.0.clone()];
        if is_word(&self.0) {
            readings.push(format!("\"{}\"", self.0));
        }
        let unquoted = self.0.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
        readings.extend(unquoted.filter(|inside| is_word(inside)).map(str::to_string));
        readings
    }
}

impl fmt::Display for Literal {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

macro_rules! literal_from_number {
    ($($number:ty),*) => {$(
        impl From<$number> for Literal {
            fn from(number: $number) -> Self {
                Self(number.to_string())
            }
        }
    )*};
}

literal_from_number!(u32, u64, i32, f32, f64, bool);

impl<T: Into<Literal>> From<Vec<T>> for Literal {
    fn from(items: Vec<T>) -> Self {
        let items: Vec<String> = items.into_iter().map(|item| item.into().0).collect();
        Self(format!("[{}]", items.join(", ")))
    }
}

impl Serialize for Literal {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let raw = RawValue::from_ron(&self.0).map_err(S::Error::custom)?;
        raw.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Literal {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let raw = Box::<RawValue>::deserialize(deserializer)?;
        Ok(Self(raw.get_ron().trim().to_string()))
    }
}

impl JsonSchema for Literal {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Literal".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        Schema::from(true)
    }
}
