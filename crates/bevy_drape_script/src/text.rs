//! The text of a scene file: RON to values, and places in it.

use core::fmt;
use core::ops::Range;

use ron::Options;
use ron::de::Deserializer;
use ron::extensions::Extensions;
use ron::value::RawValue;
use serde::de::{DeserializeOwned, DeserializeSeed, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use serde_path_to_error::{Path, Segment};

use crate::SceneError;
use crate::explain::explain;

/// How scene files are written: `Some(..)` may be left out, and a choice holds the fields of what is in it.
fn options() -> Options {
    Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES)
}

/// The value that `text` tells.
pub(crate) fn parse<T: DeserializeOwned>(text: &str) -> Result<T, SceneError> {
    let text = text.trim_start_matches('\u{feff}');
    let mut deserializer =
        Deserializer::from_str_with_options(text, &options()).map_err(|error| explain(&error, &[], text))?;
    let value = serde_path_to_error::deserialize(&mut deserializer).map_err(|error| {
        let path = steps_of(error.path());
        explain(&deserializer.span_error(error.into_inner()), &path, text)
    })?;
    deserializer.end().map_err(|error| explain(&deserializer.span_error(error), &[], text))?;
    Ok(value)
}

/// `value` as the text of a scene file.
pub(crate) fn write<T: Serialize>(value: &T) -> Result<String, SceneError> {
    options().to_string_pretty(value, ron::ser::PrettyConfig::default()).map_err(SceneError::new)
}

/// A step of a path: into a field or an entry, to an item of a list, or into what a choice holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    Key(String),
    Index(usize),
    Variant(String),
}

fn steps_of(path: &Path) -> Vec<Step> {
    let step = |segment: &Segment| match segment {
        Segment::Seq { index } => Some(Step::Index(*index)),
        Segment::Map { key } => Some(Step::Key(key.clone())),
        Segment::Enum { variant } => Some(Step::Variant(variant.clone())),
        Segment::Unknown => None,
    };
    path.iter().filter_map(step).collect()
}

/// A path as a file's author thinks of it: `bodies.curtain.size`, without the names of choices.
pub(crate) fn field_path(steps: &[Step]) -> String {
    let mut text = String::new();
    for step in steps {
        match step {
            Step::Index(index) => text.push_str(&format!("[{index}]")),
            Step::Key(key) => {
                if !text.is_empty() {
                    text.push('.');
                }
                text.push_str(key);
            }
            Step::Variant(_) => {}
        }
    }
    text
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

/// Where in `text` the value at `path` stands.
///
/// # Errors
/// How many steps of the path were taken, and what there is instead of the next.
pub(crate) fn find(text: &str, path: &[Step]) -> Result<Range<usize>, (usize, Instead)> {
    let mut walk = Found { place: None, left: path.len(), instead: Instead::NoParts };
    let deserializer = Deserializer::from_str_with_options(text, &options());
    if let Ok(mut deserializer) = deserializer {
        // The walk ends in the middle of the text, which is an error to the parser.
        let _ = Walk { steps: path, found: &mut walk }.deserialize(&mut deserializer);
    }
    let Some(raw) = walk.place else { return Err((path.len() - walk.left, walk.instead)) };
    let before = raw.len() - raw.trim_start().len();
    let start = raw.as_ptr().addr() - text.as_ptr().addr() + before;
    Ok(start..start + raw.trim().len())
}

/// Line and column of the value at `path`, or of what holds it; and how many steps of the path were found.
pub(crate) fn locate(text: &str, path: &str) -> Option<((usize, usize), usize)> {
    let steps = steps(path);
    (0..=steps.len()).rev().find_map(|depth| {
        let place = find(text, &steps[..depth]).ok()?;
        Some((line_and_column(text, place.start), depth))
    })
}

/// Line and column, counted from 1, of the byte at `offset`.
pub(crate) fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = &text[..offset];
    let line = before.bytes().filter(|&byte| byte == b'\n').count() + 1;
    let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
    (line, column)
}

/// What there is where a path does not go on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Instead {
    /// Fields or entries of these names.
    Keys(Vec<String>),
    /// A list of so many items.
    Items(usize),
    /// Something that has no parts.
    NoParts,
}

struct Found<'de> {
    place: Option<&'de str>,
    /// Number of steps that were not taken.
    left: usize,
    instead: Instead,
}

/// Walks down a path and notes the text there.
struct Walk<'a, 'de> {
    steps: &'a [Step],
    found: &'a mut Found<'de>,
}

impl<'de> Walk<'_, 'de> {
    fn next(&mut self) -> Walk<'_, 'de> {
        Walk { steps: &self.steps[1..], found: self.found }
    }
}

impl<'de> DeserializeSeed<'de> for Walk<'_, 'de> {
    type Value = ();

    fn deserialize<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        self.found.left = self.steps.len();
        if self.steps.is_empty() {
            self.found.place = Some(<&RawValue>::deserialize(deserializer)?.get_ron());
            return Ok(());
        }
        self.found.instead = Instead::NoParts;
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Walk<'_, 'de> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("something with parts")
    }

    fn visit_newtype_struct<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        self.deserialize(deserializer)
    }

    fn visit_some<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        self.deserialize(deserializer)
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut entries: A) -> Result<(), A::Error> {
        let mut keys = Vec::new();
        while let Some(key) = entries.next_key::<String>()? {
            if matches!(&self.steps[0], Step::Key(wanted) if *wanted == key) {
                entries.next_value_seed(self.next())?;
                return drain_map(entries);
            }
            keys.push(key);
            entries.next_value::<IgnoredAny>()?;
        }
        self.found.instead = Instead::Keys(keys);
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut items: A) -> Result<(), A::Error> {
        let mut index = 0;
        loop {
            let is_wanted = self.steps[0] == Step::Index(index);
            let item = if is_wanted {
                items.next_element_seed(self.next())?
            } else {
                items.next_element::<IgnoredAny>()?.map(drop)
            };
            match item {
                None => {
                    self.found.instead = Instead::Items(index);
                    return Ok(());
                }
                Some(()) if is_wanted => {
                    while items.next_element::<IgnoredAny>()?.is_some() {}
                    return Ok(());
                }
                Some(()) => index += 1,
            }
        }
    }
}

fn drain_map<'de, A: MapAccess<'de>>(mut entries: A) -> Result<(), A::Error> {
    while entries.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
    Ok(())
}
