//! Values from the outside: parameters, and any value by its path.

use core::sync::atomic::{AtomicU32, Ordering};

use super::*;

fn overridden(texts: &[&str]) -> Result<SceneScript, SceneError> {
    let with_parameters = CURTAIN.replace(
        "bodies: {",
        r#"parameters: { "fine": (default: [21, 16], sets: ["curtain.particles"]) }, bodies: {"#,
    );
    // Tests run side by side.
    static FOLDERS: AtomicU32 = AtomicU32::new(0);
    let name = format!("overridden_{}", FOLDERS.fetch_add(1, Ordering::Relaxed));
    let folder = folder(&name, &[("a.scene.ron", with_parameters.as_str())]);
    let overrides: Vec<Override> = texts.iter().map(|text| text.parse()).collect::<Result<_, _>>()?;
    SceneScript::load_with(folder.join("a.scene.ron"), &overrides)
}

fn particles(script: &SceneScript) -> (u32, u32) {
    let Body::Cloth(cloth) = &script.bodies["curtain"] else { panic!("a cloth") };
    (cloth.particles.0.get(), cloth.particles.1.get())
}

#[test]
fn a_parameter_has_a_default_and_can_be_overridden() {
    assert_eq!(particles(&overridden(&[]).expect("good")), (21, 16));
    assert_eq!(particles(&overridden(&["fine=[128,96]"]).expect("good")), (128, 96));
    assert_eq!(particles(&overridden(&["fine=(12, 9)"]).expect("good")), (12, 9));
}

#[test]
fn any_value_can_be_overridden_by_its_path() {
    let script = overridden(&[
        "curtain.particles=[5,4]",
        "settings.duration=2.5",
        "settings.solver.quality=High",
        "post.shape.radius=0.2",
        "timeline[0].at=0.25",
        "bodies.curtain.pins=Indices([1,2])",
        "ball.material=None",
        "ball.velocity=[0, 0, 1]",
        "timeline[2].do=SetWind(3, 0, 0)",
        "expectations[1].when=During(0.1, 0.2)",
    ])
    .expect("good");
    assert_eq!(particles(&script), (5, 4));
    assert_eq!(script.settings.duration.get(), 2.5);
    assert_eq!(script.timeline[0].at.map(Seconds::get), Some(0.25));
    let text = script.to_ron().expect("text");
    for part in ["quality: High", "radius: 0.2", "Indices([", "SetWind(", "During("] {
        assert!(text.contains(part), "{text}");
    }
}

#[test]
fn an_override_that_cannot_be_is_told() {
    for (text, words) in [
        (
            "curtain.particle=[5,4]",
            &["--set curtain.particle=[5,4]:", "no `particle`", "did you mean `particles`?"][..],
        ),
        ("curtain.particles=[5,1]", &["--set curtain.particles=[5,1]: ", "from 2 to 4096", "found 1"]),
        ("curtain.particles=many", &["curtain.particles", "2 values", "`many`"]),
        ("curtain.pins=Tops", &["--set curtain.pins=Tops: bodies.curtain.pins:", "did you mean `Top`?"]),
        ("curtain.pins=Indices([1,x])", &["curtain.pins[1]", "a whole number", "found `x`"]),
        (
            "curtain.pins=Indices([9999])",
            &["--set curtain.pins=Indices([9999]): ", "below 336", "found 9999"],
        ),
        ("curtain.material=red", &["--set curtain.material=red: ", "no material is called `red`"]),
        ("timeline[0].do=Fire(canon)", &["--set timeline[0].do=Fire(canon): ", "in quotes"]),
        ("timeline[0].do=Fire(\"canon\")", &["--set timeline[0].do=", "did you mean `cannon`?"]),
        ("fine=[5,1]", &["--set fine=[5,1]: ", "curtain.particles", "from 2 to 4096"]),
        ("certain.particles=[5,4]", &["certain", "did you mean `curtain`?"]),
        ("settings.gravity=(0, -1)", &["settings.gravity", "3 values", "found 2"]),
        ("settings.duration=1), bodies: (", &["settings.duration", "nothing after"]),
        ("timeline[9].at=1", &["no item 9", "4"]),
        ("settings.duration", &["PATH=VALUE"]),
        ("settings.duration=(1", &["settings.duration"]),
    ] {
        let error = overridden(&[text]).expect_err(text).to_string();
        println!("{error}");
        for word in words {
            assert!(error.contains(word), "“{error}” does not say {word}");
        }
    }
}

#[test]
fn a_default_that_cannot_be_is_told_where_it_stands() {
    let text = CURTAIN.replace(
        "bodies: {",
        "parameters: {\n        \"fine\": (default: [21, 1], sets: [\"curtain.particles\"]) },\n bodies: {",
    );
    let error = SceneScript::parse(&text).expect_err("one row");
    let words = ["bodies.curtain.particles[1]", "from 2 to 4096", "found 1"];
    assert_told(&(error, text), "[21, 1]", "parameters.fine.default", &words);
    let text = CURTAIN.replace(
        "bodies: {",
        "parameters: {\n        \"held\": (default: Indices([0, 5000]), sets: [\"curtain.pins\"]) },\n bodies: {",
    );
    let error = SceneScript::parse(&text).expect_err("no such particle");
    assert_told(
        &(error, text),
        "Indices",
        "parameters.held.default",
        &["bodies.curtain.pins[1]", "found 5000"],
    );
}
