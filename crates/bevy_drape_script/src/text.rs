//! The text of a scene file: RON to values, and places in it.

use core::fmt;

use ron::Options;
use ron::de::Deserializer;
use ron::extensions::Extensions;
use serde::de::{DeserializeOwned, DeserializeSeed, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use serde_path_to_error::{Path, Segment};

use crate::SceneError;

/// How scene files are written: `Some(..)` may be left out, and a choice holds the fields of what is in it.
fn options() -> Options {
    Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES)
}

/// The value that `text` tells.
pub(crate) fn parse<T: DeserializeOwned>(text: &str) -> Result<T, SceneError> {
    let text = text.trim_start_matches('\u{feff}');
    let at = |error: ron::error::SpannedError| {
        let start = error.span.start;
        SceneError::new(error.code).at((start.line, start.col))
    };
    let mut deserializer = Deserializer::from_str_with_options(text, &options()).map_err(at)?;
    let value = serde_path_to_error::deserialize(&mut deserializer).map_err(|error| {
        let field = field_path(error.path());
        SceneError { field, ..at(deserializer.span_error(error.into_inner())) }
    })?;
    deserializer.end().map_err(|error| at(deserializer.span_error(error)))?;
    Ok(value)
}

/// `value` as the text of a scene file.
pub(crate) fn write<T: Serialize>(value: &T) -> Result<String, SceneError> {
    options().to_string_pretty(value, ron::ser::PrettyConfig::default()).map_err(SceneError::new)
}

/// A path as a file's author thinks of it: `bodies.curtain.size`, without the names of choices.
pub(crate) fn field_path(path: &Path) -> String {
    let mut text = String::new();
    for segment in path {
        match segment {
            Segment::Seq { index } => text.push_str(&format!("[{index}]")),
            Segment::Map { key } => {
                if !text.is_empty() {
                    text.push('.');
                }
                text.push_str(key);
            }
            Segment::Enum { .. } | Segment::Unknown => {}
        }
    }
    text
}

/// A step of a path: into a field or an entry, or to an item of a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    Key(String),
    Index(usize),
}

/// The steps of a path such as `timeline[2].do`.
pub(crate) fn steps(path: &str) -> Vec<Step> {
    let mut steps = Vec::new();
    for part in path.split('.').filter(|part| !part.is_empty()) {
        let mut pieces = part.split('[');
        if let Some(key) = pieces.next().filter(|key| !key.is_empty()) {
            steps.push(Step::Key(key.to_string()));
        }
        for piece in pieces {
            let inside = piece.strip_suffix(']').unwrap_or(piece);
            steps.push(inside.parse().map_or_else(|_| Step::Key(inside.to_string()), Step::Index));
        }
    }
    steps
}

/// Line and column of the value at `path`, or of what holds it. Found by reading the text again, up to there.
pub(crate) fn locate(text: &str, path: &str) -> Option<(usize, usize)> {
    let steps = steps(path);
    (0..=steps.len()).rev().find_map(|depth| {
        let mut deserializer = Deserializer::from_str_with_options(text, &options()).ok()?;
        let mut is_found = false;
        let error =
            Walk { steps: &steps[..depth], is_found: &mut is_found }.deserialize(&mut deserializer).err()?;
        let start = deserializer.span_error(error).span.end;
        is_found.then_some((start.line, start.col))
    })
}

/// Walks down a path and ends with an error there, as errors alone know their place.
struct Walk<'a> {
    steps: &'a [Step],
    is_found: &'a mut bool,
}

impl<'de> DeserializeSeed<'de> for Walk<'_> {
    type Value = ();

    fn deserialize<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        if self.steps.is_empty() {
            *self.is_found = true;
            return Err(D::Error::custom("here"));
        }
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Walk<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("something with parts")
    }

    fn visit_newtype_struct<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        self.deserialize(deserializer)
    }

    fn visit_some<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        self.deserialize(deserializer)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<(), A::Error> {
        while let Some(key) = entries.next_key::<String>()? {
            if self.steps.first() == Some(&Step::Key(key)) {
                return entries.next_value_seed(Walk { steps: &self.steps[1..], is_found: self.is_found });
            }
            entries.next_value::<IgnoredAny>()?;
        }
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<(), A::Error> {
        let mut index = 0;
        loop {
            if self.steps.first() == Some(&Step::Index(index)) {
                let walk = Walk { steps: &self.steps[1..], is_found: self.is_found };
                return items.next_element_seed(walk).map(|_| ());
            }
            if items.next_element::<IgnoredAny>()?.is_none() {
                return Ok(());
            }
            index += 1;
        }
    }
}

/// A value that may stand for anything in a scene: what `--set` gives.
pub(crate) fn parse_value(text: &str) -> Result<serde_json::Value, SceneError> {
    parse::<AnyValue>(text).map(|value| value.0)
}

#[derive(Deserialize)]
#[serde(transparent)]
struct AnyValue(serde_json::Value);
