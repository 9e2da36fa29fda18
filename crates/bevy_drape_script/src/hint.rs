//! What the types say about a field of a scene: what it means, and what can stand there. For errors about it.

use std::sync::LazyLock;

use serde_json::Value;

use crate::scene::{SceneScript, range_in_words};
use crate::text::Step;

static SCHEMA: LazyLock<Value> =
    LazyLock::new(|| serde_json::to_value(schemars::schema_for!(SceneScript)).unwrap_or_default());

/// What is known of a field.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field {
    schema: &'static Value,
    meaning: Option<&'static str>,
}

/// What is known of the field at `path`, in which choices are named; none if there is no such field.
pub(crate) fn field(path: &[Step]) -> Option<Field> {
    let mut field = Field { schema: &SCHEMA, meaning: None };
    for step in path {
        field.schema = go(field.schema, step)?;
        // An item of a list is told by the list, and what a choice holds by the choice.
        let own = field.schema.get("description").and_then(Value::as_str);
        field.meaning = own.or(field.meaning);
        if let Step::Variant(variant) = step {
            field.schema =
                field.schema.get("properties").and_then(|held| held.get(variant)).unwrap_or(field.schema);
        }
    }
    Some(field)
}

/// The schema itself, if it is only referred to here.
fn resolved(schema: &'static Value) -> &'static Value {
    let name = schema.get("$ref").and_then(Value::as_str);
    name.and_then(|name| SCHEMA.pointer(name.strip_prefix('#')?)).unwrap_or(schema)
}

fn choices(schema: &'static Value) -> impl Iterator<Item = &'static Value> {
    ["oneOf", "anyOf"].into_iter().filter_map(|kind| schema.get(kind)?.as_array()).flatten()
}

/// The schema one step on. Of a choice, that of the choice.
fn go(schema: &'static Value, step: &Step) -> Option<&'static Value> {
    let schema = resolved(schema);
    let direct = match step {
        Step::Key(key) => {
            let property = schema.get("properties").and_then(|properties| properties.get(key));
            property.or_else(|| schema.get("additionalProperties").filter(|more| more.is_object()))
        }
        Step::Index(index) => schema
            .get("prefixItems")
            .and_then(|items| items.get(index))
            .or_else(|| schema.get("items").filter(|items| items.is_object())),
        Step::Variant(variant) => choices(schema).find(|choice| name_of(choice) == Some(variant)),
    };
    // What need not be there, or a name that may also be a list of names.
    direct.or_else(|| {
        choices(schema).filter(|choice| name_of(choice).is_none()).find_map(|choice| go(choice, step))
    })
}

/// The name of a choice that is told by its name.
fn name_of(choice: &'static Value) -> Option<&'static str> {
    let held = || {
        let properties = choice.get("properties")?.as_object()?;
        let mut names = properties.keys().filter(|name| name.starts_with(char::is_uppercase));
        names.next().filter(|_| properties.len() == 1).map(String::as_str)
    };
    choice.get("const").and_then(Value::as_str).or_else(held)
}

impl Field {
    /// What it means, in the words of its documentation.
    pub fn meaning(self) -> Option<String> {
        let words = self.meaning?.split_whitespace().collect::<Vec<_>>().join(" ");
        Some(words.trim_end_matches('.').to_string())
    }

    /// What can stand there: "a number", "one of `None`, `Top`, .."
    pub fn expected(self) -> Option<String> {
        expected(self.schema)
    }

    /// The names of its fields, if it has some.
    pub fn fields(self) -> Vec<&'static str> {
        let properties = resolved(self.schema).get("properties").and_then(Value::as_object);
        properties.into_iter().flat_map(|properties| properties.keys()).map(String::as_str).collect()
    }

    /// The names of the choices that there are.
    pub fn choices(self) -> Vec<&'static str> {
        choices(resolved(self.schema)).filter_map(name_of).collect()
    }

    /// Whether it holds things by name.
    pub fn is_map(self) -> bool {
        resolved(self.schema).get("additionalProperties").is_some_and(Value::is_object)
    }
}

fn expected(schema: &'static Value) -> Option<String> {
    let schema = resolved(schema);
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
    let others: Vec<String> = choices(schema).filter_map(expected).collect();
    if !others.is_empty() {
        return Some(others.join(", or "));
    }
    // Of something that need not be there, what it is if it is.
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
