//! Looks fields up in the JSON schema of a file: their meaning and their allowed values, for error messages.

use std::sync::LazyLock;

use serde_json::Value;

use super::path::PathStep;
use super::range::range_in_words;

/// The JSON schema of a file, generated when the first error needs it.
#[derive(Debug)]
pub(crate) struct Schema(LazyLock<Value>);

/// A field of a [`Schema`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Field<'a> {
    root: &'a Value,
    schema: &'a Value,
    meaning: Option<&'a str>,
}

impl Schema {
    pub const fn new(generate: fn() -> Value) -> Self {
        Self(LazyLock::new(generate))
    }

    /// The field at `path`, in which variants are named; none if there is no such field.
    pub(super) fn field(&self, path: &[PathStep]) -> Option<Field<'_>> {
        let root = &*self.0;
        let mut field = Field { root, schema: root, meaning: None };
        for step in path {
            field.schema = child(root, field.schema, step)?;
            // Items of a list share its description, and the content of a variant shares that of the variant.
            let own = field.schema.get("description").and_then(Value::as_str);
            field.meaning = own.or(field.meaning);
            if let PathStep::Variant(variant) = step {
                let content = field.schema.get("properties").and_then(|content| content.get(variant));
                field.schema = content.unwrap_or(field.schema);
            }
        }
        Some(field)
    }
}

/// The definition that `schema` refers to, or `schema` itself.
fn resolved<'a>(root: &'a Value, schema: &'a Value) -> &'a Value {
    let name = schema.get("$ref").and_then(Value::as_str);
    name.and_then(|name| root.pointer(name.strip_prefix('#')?)).unwrap_or(schema)
}

fn choices(schema: &Value) -> impl Iterator<Item = &Value> {
    ["oneOf", "anyOf"].into_iter().filter_map(|kind| schema.get(kind)?.as_array()).flatten()
}

/// The schema one step further down.
fn child<'a>(root: &'a Value, schema: &'a Value, step: &PathStep) -> Option<&'a Value> {
    let schema = resolved(root, schema);
    let direct = match step {
        PathStep::Key(key) => {
            let property = schema.get("properties").and_then(|properties| properties.get(key));
            property.or_else(|| schema.get("additionalProperties").filter(|more| more.is_object()))
        }
        PathStep::Index(index) => schema
            .get("prefixItems")
            .and_then(|items| items.get(index))
            .or_else(|| schema.get("items").filter(|items| items.is_object())),
        PathStep::Variant(variant) => choices(schema).find(|choice| name_of(choice) == Some(variant)),
    };
    // Optional fields, and names that may also be lists of names, are choices without names.
    direct.or_else(|| {
        choices(schema)
            .filter(|choice| name_of(choice).is_none())
            .find_map(|choice| child(root, choice, step))
    })
}

/// The name of a choice that has one.
fn name_of(choice: &Value) -> Option<&str> {
    let held = || {
        let properties = choice.get("properties")?.as_object()?;
        let mut names = properties.keys().filter(|name| name.starts_with(char::is_uppercase));
        names.next().filter(|_| properties.len() == 1).map(String::as_str)
    };
    choice.get("const").and_then(Value::as_str).or_else(held)
}

impl<'a> Field<'a> {
    /// Its meaning, in the words of its documentation.
    pub fn meaning(self) -> Option<String> {
        let words = self.meaning?.split_whitespace().collect::<Vec<_>>().join(" ");
        Some(words.trim_end_matches('.').to_string())
    }

    /// Its allowed values: "a number", "one of `None`, `Top`, .."
    pub fn expected(self) -> Option<String> {
        expected(self.root, self.schema)
    }

    /// The names of its fields; empty if it has none.
    pub fn fields(self) -> Vec<&'a str> {
        let properties = resolved(self.root, self.schema).get("properties").and_then(Value::as_object);
        properties.into_iter().flat_map(|properties| properties.keys()).map(String::as_str).collect()
    }

    /// The names of its choices; empty if it is no choice.
    pub fn choices(self) -> Vec<&'a str> {
        choices(resolved(self.root, self.schema)).filter_map(name_of).collect()
    }

    /// True if it is a map with names as keys.
    pub fn is_map(self) -> bool {
        resolved(self.root, self.schema).get("additionalProperties").is_some_and(Value::is_object)
    }
}

/// The values that `schema` allows, in words.
fn expected(root: &Value, schema: &Value) -> Option<String> {
    let schema = resolved(root, schema);
    let names: Vec<String> = choices(schema)
        .filter_map(|choice| {
            let name = name_of(choice)?;
            Some(if choice.get("const").is_some() { format!("`{name}`") } else { format!("`{name}(..)`") })
        })
        .collect();
    if !names.is_empty() {
        return Some(if names.len() == 1 {
            names[0].clone()
        } else {
            format!("one of {}", names.join(", "))
        });
    }
    let others: Vec<String> = choices(schema).filter_map(|choice| expected(root, choice)).collect();
    if !others.is_empty() {
        return Some(others.join(", or "));
    }
    // An optional value has two types: its own and `null`.
    let kind = match schema.get("type")? {
        Value::Array(kinds) => kinds.first()?.as_str()?,
        kind => kind.as_str()?,
    };
    let range = || {
        let [least, greatest] = ["minimum", "maximum"].map(|end| schema.get(end).and_then(Value::as_f64));
        range_in_words(least.unwrap_or(f64::NEG_INFINITY), greatest.unwrap_or(f64::INFINITY))
    };
    Some(match kind {
        "number" => format!("a number{}", range()),
        "integer" => format!("a whole number{}", range()),
        "boolean" => "`true` or `false`".to_string(),
        "string" => "a text in quotes".to_string(),
        "array" => match schema.get("prefixItems").and_then(Value::as_array) {
            Some(items) => {
                format!("{} values: `({})`", items.len(), vec![".."; items.len()].join(", "))
            }
            None => "a list: `[.., ..]`".to_string(),
        },
        "object" => match schema.get("properties").and_then(Value::as_object) {
            Some(properties) => {
                let mut fields: Vec<String> =
                    properties.keys().take(2).map(|name| format!("{name}: ..")).collect();
                if fields.len() < properties.len() {
                    fields.push("..".to_string());
                }
                format!("fields in round brackets: `({})`", fields.join(", "))
            }
            None => "names and what they stand for, in braces: `{ \"name\": .. }`".to_string(),
        },
        _ => return None,
    })
}
