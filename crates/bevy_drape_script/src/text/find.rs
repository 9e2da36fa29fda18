//! Finds the value at a path in the text of a scene file.

use core::fmt;
use core::ops::Range;

use ron::de::Deserializer;
use ron::value::RawValue;
use serde::Deserialize;
use serde::de::{DeserializeSeed, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::path::{PathStep, path_steps};
use super::position::line_and_column;
use super::ron_options::ron_options;

/// The bytes of the value at `path` in `text`.
///
/// # Errors
/// The number of steps of the path that were found, and what `text` has instead of the next.
pub(crate) fn find(text: &str, path: &[PathStep]) -> Result<Range<usize>, (usize, Missing)> {
    let mut found = Found { value: None, left: path.len(), missing: Missing::NoParts };
    let deserializer = Deserializer::from_str_with_options(text, &ron_options());
    if let Ok(mut deserializer) = deserializer {
        // The walk ends in the middle of the text, which is an error to the parser.
        let _ = Walk { steps: path, found: &mut found }.deserialize(&mut deserializer);
    }
    let Some(raw) = found.value else { return Err((path.len() - found.left, found.missing)) };
    let before = raw.len() - raw.trim_start().len();
    let start = raw.as_ptr().addr() - text.as_ptr().addr() + before;
    Ok(start..start + raw.trim().len())
}

/// Line and column of the value at `path`, or of the innermost value around it that exists; and how many steps of the
/// path lead there.
pub(crate) fn locate(text: &str, path: &str) -> Option<((usize, usize), usize)> {
    let steps = path_steps(path);
    (0..=steps.len()).rev().find_map(|depth| {
        let value = find(text, &steps[..depth]).ok()?;
        Some((line_and_column(text, value.start), depth))
    })
}

/// The reason why a path ends too early.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Missing {
    /// There are only fields or entries of these names.
    Keys(Vec<String>),
    /// The list has only so many items.
    Items(usize),
    /// The value has no parts.
    NoParts,
}

struct Found<'de> {
    value: Option<&'de str>,
    /// The number of steps that were not taken.
    left: usize,
    missing: Missing,
}

/// Walks down a path and notes the text there.
struct Walk<'a, 'de> {
    steps: &'a [PathStep],
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
            self.found.value = Some(<&RawValue>::deserialize(deserializer)?.get_ron());
            return Ok(());
        }
        self.found.missing = Missing::NoParts;
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
            if matches!(&self.steps[0], PathStep::Key(wanted) if *wanted == key) {
                entries.next_value_seed(self.next())?;
                return drain_map(entries);
            }
            keys.push(key);
            entries.next_value::<IgnoredAny>()?;
        }
        self.found.missing = Missing::Keys(keys);
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut items: A) -> Result<(), A::Error> {
        let mut index = 0;
        loop {
            let is_wanted = self.steps[0] == PathStep::Index(index);
            let item = if is_wanted {
                items.next_element_seed(self.next())?
            } else {
                items.next_element::<IgnoredAny>()?.map(drop)
            };
            match item {
                None => {
                    self.found.missing = Missing::Items(index);
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
