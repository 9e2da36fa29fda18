//! The committed schema is that of the types.

use std::path::Path;

use bevy_drape_script::scene::schema;
use serde_json::Value;

/// `UPDATE_SCHEMA=1 cargo test -p bevy_drape_script --test schema` writes it anew.
#[test]
fn the_committed_schema_is_that_of_the_types() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scene.schema.json");
    let schema = schema().expect("a schema");
    if std::env::var_os("UPDATE_SCHEMA").is_some() {
        std::fs::write(&path, &schema).expect("written");
    }
    let committed = std::fs::read_to_string(&path).expect("it is committed");
    assert!(
        committed.replace('\r', "") == schema,
        "{} is out of date: run UPDATE_SCHEMA=1 cargo test -p bevy_drape_script --test schema",
        path.display()
    );
}

/// Every field that a file may have says what it means; where it has no default it must be given.
#[test]
fn every_field_is_documented() {
    let schema: Value = serde_json::from_str(&schema().expect("a schema")).expect("JSON");
    let mut count = 0;
    look(&schema, "", &mut count);
    assert!(count > 200, "only {count} fields");
}

fn look(value: &Value, path: &str, count: &mut usize) {
    match value {
        Value::Object(map) => {
            if let Some(Value::Object(properties)) = map.get("properties") {
                // A choice that holds something has one property, which it describes itself.
                let is_choice = properties.len() == 1 && map.contains_key("description");
                for (name, property) in properties {
                    *count += 1;
                    assert!(
                        is_choice || property.get("description").is_some(),
                        "{path}.{name} is not documented: {property}"
                    );
                }
            }
            for (key, value) in map {
                look(value, &format!("{path}.{key}"), count);
            }
        }
        Value::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                look(item, &format!("{path}[{index}]"), count);
            }
        }
        _ => {}
    }
}
