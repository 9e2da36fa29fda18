//! The scene file: what it can say, and how its errors tell where they are.

mod fragments;
mod overrides;
mod refusals;

use std::path::Path;

use bevy_drape_script::scene::{
    Action, Balls, Body, Cloth, Expected, Names, Pins, Probe, Rope, Seconds, SoftBall, Turn,
};
use bevy_drape_script::{Override, SceneError, SceneScript};

const CURTAIN: &str = r#"(
    version: 1,
    about: "A curtain and a ball",
    settings: (duration: 2, solver: (substeps: 16)),
    bodies: {
        "curtain": Cloth(
            size: (2, 1.5),
            particles: (41, 31),
            at: (0, 2, 0),
            surface: (drag: 2.0),
        ),
        "ball": Balls(at: (0, 1, 3), velocity: (0, 0, -15)),
        "rope": Rope(start: (3, 2, 0), end: (3, 1, 0), particles: 11),
    },
    obstacles: {
        "ground": (shape: Ground),
        "post": (shape: Capsule(radius: 0.1, length: 2), at: (2, 1, 0), motion: Steady(velocity: (0, 0, 1))),
    },
    cannons: { "cannon": (at: (0, 1, 8), aim: Point(0, 2, 0), speed: 18) },
    timeline: [
        (at: 1.5, do: Fire("cannon")),
        (when: Resting("curtain"), do: Stop),
        (at: 1, do: SetWind(1, 0, 0)),
        (at: 1, do: Drag(of: "curtain", point: Middle, path: [(0, (0, 0, 0)), (1, (0, 0, 1))])),
    ],
    expectations: [
        (name: "hangs", probe: Stretch(of: "curtain", measure: Rms), expect: AtMost(0.01)),
        (when: Always, probe: Position(of: "curtain", axis: Y), expect: Between(0, 3)),
        (when: Eventually(within: 2), probe: Activity(of: ["ball", "curtain"]), expect: Is("Resting")),
        (when: At(1), probe: Energy(kind: Kinetic), expect: Near(value: 1, tolerance: 0.5)),
    ],
)"#;

/// The error of the scene in which `from` is replaced by `to`, and the text of that scene.
fn error(from: &str, to: &str) -> (SceneError, String) {
    assert!(CURTAIN.contains(from), "{from}");
    let text = CURTAIN.replacen(from, to, 1);
    (SceneScript::parse(&text).expect_err("a bad scene"), text)
}

/// Asserts that the error lies where `text` has `at`, is about `field`, and says `words`.
fn assert_told((error, text): &(SceneError, String), at: &str, field: &str, words: &[&str]) {
    let message = error.to_string();
    println!("{message}");
    assert_eq!(error.field, field, "{message}");
    let start = text.find(at).expect("it is there");
    let (line, column) = (
        text[..start].matches('\n').count() + 1,
        start - text[..start].rfind('\n').map_or(0, |end| end + 1) + 1,
    );
    assert_eq!(error.line, Some(line as u32), "{message}");
    let columns = column..=column + at.len();
    assert!(
        error.column.is_some_and(|found| columns.contains(&(found as usize))),
        "{message} and not {line}:{columns:?}"
    );
    for word in words {
        assert!(message.contains(word), "“{message}” does not say {word}");
    }
}

/// A folder of its own with these files.
fn folder(name: &str, files: &[(&str, &str)]) -> std::path::PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    for (file, text) in files {
        let path = folder.join(file);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        std::fs::write(path, text).expect("written");
    }
    folder
}

#[test]
fn a_scene_is_read_as_it_is_written() {
    let script = SceneScript::parse(CURTAIN).expect("a good scene");
    assert_eq!(script.bodies.keys().collect::<Vec<_>>(), ["ball", "curtain", "rope"]);
    let Body::Cloth(cloth) = &script.bodies["curtain"] else { panic!("a cloth") };
    assert_eq!(cloth.particles.0.get(), 41);
    assert_eq!(cloth.areal_density.get(), 0.25, "the plugin's own default");
    assert_eq!(script.timeline[0].action, Action::Fire("cannon".to_string()));
    assert_eq!(script.expectations[2].expect, Expected::Is("Resting".to_string()));
    let Probe::Activity { of } = &script.expectations[2].probe else { panic!("activity") };
    assert_eq!(*of, Names(vec!["ball".to_string(), "curtain".to_string()]));
}

#[test]
fn values_stand_in_round_brackets_or_square_ones() {
    let square = CURTAIN
        .replace("(2, 1.5)", "[2, 1.5]")
        .replace("(41, 31)", "[41, 31]")
        .replace("(0, 1, 3)", "[0, 1, 3]");
    let script = SceneScript::parse(&square).expect("a good scene");
    assert_eq!(script, SceneScript::parse(CURTAIN).expect("a good scene"));
}

#[test]
fn what_is_written_reads_the_same() {
    let script = SceneScript::parse(CURTAIN).expect("a good scene");
    let text = script.to_ron().expect("written");
    assert_eq!(SceneScript::parse(&text).expect("read again"), script, "{text}");
}

#[test]
fn the_readme_tells_what_is_left_out() {
    let (cloth, rope, ball, jelly) =
        (Cloth::default(), Rope::default(), Balls::default(), SoftBall::default());
    let length = rope.end.get().distance(rope.start.get());
    let told = format!(
        "a `Cloth` is {} by {} m with {} by {} particles and {} kg/m², upright, hung by its top edge; a `Rope` is {length} m long with \
         {} particles and {} kg/m; a ball has a radius of {} m and {} kg; a `SoftBall` has a radius of {} m and {} rings.",
        cloth.size.0.get(),
        cloth.size.1.get(),
        cloth.particles.0.get(),
        cloth.particles.1.get(),
        cloth.areal_density.get(),
        rope.particles.get(),
        rope.linear_density.get(),
        ball.radius.get(),
        ball.mass.get(),
        jelly.radius.get(),
        jelly.rings.get(),
    );
    let readme = include_str!("../../README.md").split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(readme.contains(&told), "{told}");
    assert!(matches!(cloth.pins, Pins::Top) && cloth.turn == Turn::default());
    assert!(rope.pin_start && !rope.pin_end);
}

/// What the README shows are scenes that work: they are shipped as they stand there.
#[test]
fn the_scenes_of_the_readme_are_shipped() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = std::fs::read_to_string(folder.join("README.md")).expect("a README").replace('\r', "");
    let mut scenes = readme.split("```ron\n").skip(1).filter_map(|rest| rest.split("```").next());
    for name in ["hello", "everything"] {
        let shown = scenes.next().expect("a scene");
        SceneScript::parse(shown).unwrap_or_else(|error| panic!("{error}"));
        let shipped = folder.join("../../assets/scenes").join(name).with_extension("scene.ron");
        // A package from crates.io has no scenes beside it.
        if let Ok(shipped) = std::fs::read_to_string(shipped) {
            assert_eq!(shipped.replace('\r', ""), shown, "{name}");
        }
    }
}
