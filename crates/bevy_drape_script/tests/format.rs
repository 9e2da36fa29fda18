//! The scene file: what it can say, and how its errors tell where they are.

use std::path::Path;

use bevy_drape_script::scene::{Action, Body, Expected, Names, Probe, Seconds};
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
            solver: (drag: 2.0),
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

#[test]
fn an_unknown_field_is_told_with_those_that_there_are() {
    let error = error("particles: (41, 31)", "particle: (41, 31)");
    assert_told(&error, "particle:", "bodies.curtain.particle", &["`particle`", "`particles`", "`size`"]);
}

#[test]
fn a_wrong_type_is_told() {
    let error = error("size: (2, 1.5)", "size: \"big\"");
    assert_told(
        &error,
        "size: \"big\"",
        "bodies.curtain.size",
        &["expected 2 values", "found `\"big\"`", "Width and height in metres"],
    );
}

#[test]
fn a_number_out_of_range_is_told_with_the_range() {
    let negative = error("size: (2, 1.5)", "size: (2, -1.5)");
    assert_told(&negative, "-1.5", "bodies.curtain.size[1]", &["from 0.000001 to 1000000", "found -1.5"]);
    let few = error("particles: (41, 31)", "particles: (41, 1)");
    assert_told(
        &few,
        "1)",
        "bodies.curtain.particles[1]",
        &["from 2 to 4096", "found 1", "Particles in a row and in a column"],
    );
    let version = error("version: 1", "version: 2");
    assert_told(&version, "2,", "version", &["from 1 to 1", "found 2"]);
}

#[test]
fn a_number_that_is_none_is_told() {
    let error = error("velocity: (0, 0, -15)", "velocity: (0, 0, inf)");
    assert_told(&error, "inf", "bodies.ball.velocity[2]", &["found inf"]);
}

#[test]
fn a_missing_version_is_told() {
    let error = error("version: 1,", "");
    assert!(error.0.to_string().contains("`version`"), "{}", error.0);
}

#[test]
fn an_unknown_choice_is_told_with_those_that_there_are() {
    let error = error("Fire(\"cannon\")", "Shoot(\"cannon\")");
    assert_told(&error, "Shoot", "timeline[0].do", &["`Shoot`", "`Fire(..)`"]);
}

#[test]
fn a_name_that_stands_for_nothing_is_told_with_those_that_do() {
    let fire = error("Fire(\"cannon\")", "Fire(\"canon\")");
    assert_told(
        &fire,
        "Fire(\"canon\")",
        "timeline[0].do",
        &["`canon`", "did you mean `cannon`?", "There are"],
    );
    let probe = error("Stretch(of: \"curtain\"", "Stretch(of: \"certain\"");
    assert_told(&probe, "Stretch(of: \"certain\"", "expectations[0].probe", &["`certain`", "curtain"]);
}

#[test]
fn a_name_that_stands_for_something_else_is_told() {
    let fire = error("Fire(\"cannon\")", "Fire(\"curtain\")");
    assert_told(&fire, "Fire(\"curtain\")", "timeline[0].do", &["expected a cannon"]);
    let stretch = error("Stretch(of: \"curtain\"", "Stretch(of: \"ball\"");
    assert_told(&stretch, "\"ball\", measure", "expectations[0].probe.of", &["sticks"]);
}

/// What somebody may write who has not read everything, where the error lies, and what it says.
#[test]
fn mistakes_are_told_in_the_words_of_the_file() {
    let field = "the name of a field";
    let one_of = "expected one of `Cloth(..)`, `Rope(..)`";
    for (from, to, at, path, words) in [
        (
            "solver: (drag: 2.0)",
            "pins: 8",
            "8",
            "bodies.curtain.pins",
            &["one of `None`, `Top`", "found `8`", "Which"][..],
        ),
        ("solver: (drag: 2.0)", "pins: \"Top\"", "\"Top\"", "bodies.curtain.pins", &["did you mean `Top`?"]),
        (
            "solver: (drag: 2.0)",
            "pins: Topp",
            "Topp",
            "bodies.curtain.pins",
            &["`Indices(..)`", "did you mean `Top`?"],
        ),
        ("solver: (drag: 2.0)", "pins: Top(3)", "(3)", "bodies.curtain", &["`Top` holds nothing"]),
        (
            "solver: (drag: 2.0)",
            "pins: Indices(1, 2)",
            "1, 2",
            "bodies.curtain.pins",
            &["a list: `[.., ..]`", "found `1`"],
        ),
        (
            "solver: (drag: 2.0)",
            "pins: Indices",
            ",\n        ),\n        \"ball",
            "bodies.curtain.pins",
            &["`Indices(..)` that holds"],
        ),
        ("solver: (drag: 2.0)", "pins = Top", "= Top", "bodies.curtain", &["expected `:`", "found `=`"]),
        (
            "solver: (drag: 2.0)",
            "\"pins\": Top",
            "\"pins\"",
            "bodies.curtain",
            &[field, "did you mean `pins`?"],
        ),
        (
            "solver: (drag: 2.0)",
            "pins: Top pins: Top",
            "pins: Top,",
            "bodies.curtain",
            &["expected `,`", "found `pins`"],
        ),
        (
            "solver: (drag: 2.0)",
            "pins: Top, pins: Top",
            "pins: Top,\n",
            "bodies.curtain",
            &["`pins` is given twice"],
        ),
        (
            "solver: (drag: 2.0)",
            "material: red",
            "red",
            "bodies.curtain.material",
            &["in quotes", "found `red`", "`\"red\"`?"],
        ),
        (
            "solver: (drag: 2.0)",
            "present: yes",
            "yes",
            "bodies.curtain.present",
            &["`true` or `false`", "found `yes`"],
        ),
        (
            "solver: (drag: 2.0)",
            "velocity: 3",
            "3,\n        ),\n        \"ball",
            "bodies.curtain.velocity",
            &["3 values"],
        ),
        (
            "solver: (drag: 2.0)",
            "velocity: (1, 2)",
            "1, 2)",
            "bodies.curtain.velocity",
            &["3 values", "found 2"],
        ),
        ("(41, 31)", "(41, 31, 2)", "2)", "bodies.curtain.particles", &["2 values", "found more"]),
        ("(41, 31)", "(41.5, 31)", ".5, 31", "bodies.curtain.particles", &["a whole number, found `41.5`"]),
        ("drag: 2.0", "drag: two", "two", "bodies.curtain.solver.drag", &["a number from 0", "found `two`"]),
        ("duration: 2", "duration: 2s", "s,", "settings", &["a number, found `2s`"]),
        ("duration: 2", "seed: -1", "-1,", "settings.seed", &["a whole number from 0", "found `-1`"]),
        (
            "\"ball\": Balls",
            "ball: Balls",
            "ball: Balls",
            "bodies",
            &["a name in quotes", "did you mean `\"ball\"`?"],
        ),
        ("Balls(at", "Bals(at", "Bals", "bodies.ball", &[one_of, "did you mean `Balls`?"]),
        ("Balls(at", "(at", "(at: (0, 1, 3)", "bodies.ball", &[one_of, "found `(`"]),
        ("Fire(\"cannon\")", "Fire(cannon)", "cannon)", "timeline[0].do", &["did you mean `\"cannon\"`?"]),
        (
            "(at: 1.5, do: Fire",
            "(1.5, Fire",
            "1.5, Fire",
            "timeline[0]",
            &[field, "found `1.5`", "`at`, `do`"],
        ),
        (
            "(at: 1.5, do: Fire(\"cannon\"))",
            "(at: 1.5)",
            "),\n        (when: R",
            "timeline[0].do",
            &["`do` is missing"],
        ),
        (
            "when: Always",
            "when: always",
            "always, probe",
            "expectations[1].when",
            &["`At(..)`", "did you mean `Always`?"],
        ),
        ("within: 2", "2", "2), probe", "expectations[2].when", &[field, "`within`"]),
        (
            "expect: AtMost(0.01)",
            "expect: 0.01",
            "0.01",
            "expectations[0].expect",
            &["one of `Near(..)`", "found `0.01`"],
        ),
        (
            "Stretch(of: \"curtain\"",
            "Stretch(of: curtain",
            "curtain, m",
            "expectations[0].probe.of",
            &["in quotes", "`\"curtain\"`?"],
        ),
        ("bodies: {", "bodies: [", "[\n", "bodies", &["in braces", "found `[`"]),
        ("timeline: [", "timeline: {", "{\n        (at", "timeline", &["a list", "found `{`"]),
    ] {
        assert_told(&error(from, to), at, path, words);
        let message = error(from, to).0.problem;
        for jargon in ["Identifier", "identifier", "variant", "struct ", "unit value", "tuple", "r#"] {
            assert!(!message.contains(jargon), "“{message}” says {jargon}");
        }
    }
}

#[test]
fn a_name_given_twice_is_told() {
    let error = error("\"rope\": Rope(", "\"ball\": Rope(");
    assert_told(&error, "\"ball\": Rope", "bodies", &["`ball` is taken"]);
}

#[test]
fn times_that_never_come_are_told() {
    for (from, to, at, path, words) in [
        ("At(1)", "At(99)", "At(99)", "expectations[3].when", &["up to 2 s", "found 99"][..]),
        (
            "Always",
            "During(9, 3)",
            "During(9, 3)",
            "expectations[1].when",
            &["earlier time first", "9 s, then 3 s"],
        ),
        ("Always", "During(1, 3)", "During(1, 3)", "expectations[1].when", &["up to 2 s", "found 3"]),
        ("within: 2", "within: 2.5", "2.5", "expectations[2].when.within", &["up to 2 s", "found 2.5"]),
        ("axis: Y)", "axis: Y, since: 7)", "7)", "expectations[1].probe.since", &["up to 2 s", "found 7"]),
        (
            "within: 2",
            "within: 1, after: 1.5",
            "1.5), probe",
            "expectations[2].when.after",
            &["up to 1 s", "found 1.5"],
        ),
        (
            "Is(\"Resting\")",
            "Is(\"Rest\")",
            "Is(\"Rest\")",
            "expectations[2].expect",
            &["did you mean `Resting`", "Frozen"],
        ),
    ] {
        assert_told(&error(from, to), at, path, words);
    }
    // The timeline may prolong the scene.
    let longer =
        CURTAIN.replace("SetWind(1, 0, 0)", "Set(\"settings.duration\", 100)").replace("At(1)", "At(99)");
    SceneScript::parse(&longer).expect("it comes to 99 s");
}

#[test]
fn words_and_numbers_are_told_apart() {
    let error = error("expect: Is(\"Resting\")", "expect: AtMost(1)");
    assert_told(&error, "AtMost(1))", "expectations[2].expect", &["Is("]);
}

// Found by the fuzz target `scene_text`: `NaN` was read as a tolerance, which nothing is within.
#[test]
fn what_nothing_can_be_within_is_refused() {
    for (expected, field, words) in [
        ("AtMost(NaN)", "", ["number from", "found NaN"]),
        ("Near(value: -NaN, tolerance: 1)", ".value", ["number from", "found NaN"]),
        ("Near(value: 1, tolerance: NaN)", ".tolerance", ["number from 0", "found NaN"]),
        ("Near(value: 1, tolerance: -0.1)", ".tolerance", ["number from 0", "found -0.1"]),
        ("Between(0, inf)", "[1]", ["number from", "found inf"]),
    ] {
        let error = error("AtMost(0.01)", expected);
        assert_told(&error, expected, &format!("expectations[0].expect{field}"), &words);
    }
}

#[test]
fn text_that_is_no_scene_is_told() {
    let end = SceneScript::parse("(version: 1, bodies: {").expect_err("no end");
    assert_eq!(end.line, Some(1), "{end}");
    let more = SceneScript::parse("(version: 1) 2").expect_err("too much");
    assert!(more.column.is_some_and(|column| column >= 13), "{more}");
}

#[test]
fn a_file_that_is_not_there_is_told_by_its_path() {
    let error = SceneScript::load("no/such.scene.ron").expect_err("no such file");
    assert_eq!(error.file.as_deref(), Some(Path::new("no/such.scene.ron")));
    assert!(error.to_string().starts_with("no/such.scene.ron: cannot be read: "), "{error}");
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

fn overridden(texts: &[&str]) -> Result<SceneScript, SceneError> {
    let with_parameters = CURTAIN.replace(
        "bodies: {",
        r#"parameters: { "fine": (default: [21, 16], sets: ["curtain.particles"]) }, bodies: {"#,
    );
    // Tests run side by side.
    let name = format!("overridden_{}", std::thread::current().name().unwrap_or_default());
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

/// A probe that can only ever measure nothing would make a scene pass that should not: it is refused, with the way out.
#[test]
fn probes_that_can_measure_nothing_are_refused() {
    let with = |told: bool, probe: &str| {
        SceneScript::parse(&format!(
            r#"(
    version: 1,
    bodies: {{ "cloth": Cloth(contacts: {told}), "ball": Balls() }},
    obstacles: {{ "ground": (shape: Ground) }},
    expectations: [(when: Always, probe: {probe}, expect: AtMost(0))],
)"#
        ))
    };
    for probe in
        [r#"Contacts(of: "cloth", on: "ground")"#, r#"Contacts(of: "ball#1", on: "cloth")"#, "Contacts()"]
    {
        let error = with(false, probe).expect_err(probe).to_string();
        assert!(error.contains("contacts: true") && error.contains("expectations[0].probe"), "{error}");
        with(true, probe).unwrap_or_else(|error| panic!("{probe}: {error}"));
    }
    let error = with(true, r#"Hits(of: "cloth", on: "ball")"#).expect_err("no ball").to_string();
    assert!(error.contains("Contacts") && error.contains("expectations[0].probe.of"), "{error}");
    for probe in [r#"Hits(of: "ball#1", on: "cloth")"#, r#"Hits(on: "ground")"#] {
        with(false, probe).unwrap_or_else(|error| panic!("{probe}: {error}"));
    }
}
