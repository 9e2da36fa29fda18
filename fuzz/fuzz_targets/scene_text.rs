//! Reads any text as a scene: it is rejected with a reason, or written and read back as the same scene.

#![no_main]

use bevy_drape_script::SceneScript;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match SceneScript::parse(text) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(scene) => {
            let written = scene.to_ron().expect("a scene that was read can be written");
            let again = SceneScript::parse(&written).expect("what was written can be read");
            assert_eq!(again, scene);
        }
    }
});
