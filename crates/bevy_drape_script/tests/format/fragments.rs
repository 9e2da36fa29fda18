//! Scenes of several files.

use super::*;

#[test]
fn a_fragment_is_part_of_the_scene() {
    let folder = folder(
        "fragment",
        &[
            ("a.scene.ron", r#"(version: 1, include: ["parts/ground.ron"], bodies: { "c": Cloth() })"#),
            (
                "parts/ground.ron",
                r#"(version: 1, include: ["post.ron"], obstacles: { "ground": (shape: Ground) })"#,
            ),
            ("parts/post.ron", r#"(version: 1, obstacles: { "post": (shape: Sphere(radius: 0.1)) })"#),
        ],
    );
    let script = SceneScript::load(folder.join("a.scene.ron")).expect("a good scene");
    assert_eq!(script.obstacles.keys().collect::<Vec<_>>(), ["ground", "post"]);
}

#[test]
fn a_fragment_that_includes_itself_is_refused() {
    let folder = folder(
        "cycle",
        &[
            ("a.scene.ron", r#"(version: 1, include: ["b.ron"])"#),
            ("b.ron", "(\n    version: 1,\n    include: [\"../cycle/a.scene.ron\"],\n)"),
        ],
    );
    let error = SceneScript::load(folder.join("a.scene.ron")).expect_err("a cycle");
    assert_eq!(error.file, Some(folder.join("b.ron")));
    let text = std::fs::read_to_string(folder.join("b.ron")).expect("read");
    assert_told(&(error, text), "\"../cycle", "include[0]", &["includes itself"]);
}

#[test]
fn an_error_in_a_fragment_is_told_of_the_fragment() {
    let folder = folder(
        "bad_fragment",
        &[
            ("a.scene.ron", r#"(version: 1, include: ["b.ron"], obstacles: { "ground": (shape: Ground) })"#),
            ("b.ron", "(version: 1,\nobstacles: { \"x\": (shape: Sphere(radius: 0)) })"),
            ("d.ron", "(version: 1, obstacles: { \"ground\": (shape: Ground) })"),
            ("e.scene.ron", r#"(version: 1, include: ["f.ron"])"#),
            ("f.ron", "(version: 1, settings: (duration: 1))"),
            ("g.scene.ron", r#"(version: 1, include: ["d.ron"], obstacles: { "ground": (shape: Ground) })"#),
        ],
    );
    let told = |scene: &str, at_fault: &str, at: &str, field: &str, words: &[&str]| {
        let error = SceneScript::load(folder.join(scene)).expect_err("a bad scene");
        assert_eq!(error.file, Some(folder.join(at_fault)));
        let text = std::fs::read_to_string(folder.join(at_fault)).expect("read");
        assert_told(&(error, text), at, field, words);
    };
    told("a.scene.ron", "b.ron", "0))", "obstacles.x.shape.radius", &["found 0"]);
    told("e.scene.ron", "f.ron", "(duration", "settings", &["belong to the scene"]);
    told("g.scene.ron", "g.scene.ron", "\"d.ron\"", "include[0]", &["`ground`", "already"]);
}
