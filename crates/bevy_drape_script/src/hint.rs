//! Hints: what a field of a scene means, for errors about it.

use serde_json::Value;

use crate::SceneError;
use crate::scene::SceneScript;
use crate::text::{Step, steps};

/// The same error, and what its field means, if the types say so.
pub(crate) fn with_hint(mut error: SceneError) -> SceneError {
    if let Some(meaning) = meaning(&error.field) {
        error.problem = format!("{} ({})", error.problem, meaning.trim_end_matches('.'));
    }
    error
}

/// What the field at `path` means, in the words of its documentation.
fn meaning(path: &str) -> Option<String> {
    let schema = serde_json::to_value(schemars::schema_for!(SceneScript)).ok()?;
    let mut place = &schema;
    let mut meaning = None;
    for step in steps(path) {
        place = go(&schema, place, &step)?;
        // An item of a list is told by the list.
        if let Some(text) = place.get("description").and_then(Value::as_str) {
            meaning = Some(text.split_whitespace().collect::<Vec<_>>().join(" "));
        }
    }
    meaning
}

/// The schema one step on, through references and choices.
fn go<'a>(root: &'a Value, place: &'a Value, step: &Step) -> Option<&'a Value> {
    if let Some(name) = place.get("$ref").and_then(Value::as_str) {
        let definition = root.pointer(name.strip_prefix('#')?)?;
        return go(root, definition, step);
    }
    let direct = match step {
        Step::Key(key) => {
            let property = place.get("properties").and_then(|properties| properties.get(key));
            property.or_else(|| place.get("additionalProperties").filter(|more| more.is_object()))
        }
        Step::Index(index) => place
            .get("prefixItems")
            .and_then(|items| items.get(index))
            .or_else(|| place.get("items").filter(|items| items.is_object())),
    };
    direct.or_else(|| {
        let choices = ["oneOf", "anyOf", "allOf"].into_iter().filter_map(|kind| place.get(kind)?.as_array());
        choices.flatten().find_map(|choice| {
            // A choice that holds something is an object of one property, which a path leaves out.
            let properties = choice.get("properties").and_then(Value::as_object);
            let held =
                properties.filter(|properties| properties.len() == 1).and_then(|only| only.values().next());
            held.and_then(|held| go(root, held, step)).or_else(|| go(root, choice, step))
        })
    })
}
