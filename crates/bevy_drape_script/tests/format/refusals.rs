//! What is wrong in a scene is told with its place, its field and what was expected.

use super::*;

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
            "surface: (drag: 2.0)",
            "pins: 8",
            "8",
            "bodies.curtain.pins",
            &["one of `None`, `Top`", "found `8`", "Which"][..],
        ),
        ("surface: (drag: 2.0)", "pins: \"Top\"", "\"Top\"", "bodies.curtain.pins", &["did you mean `Top`?"]),
        (
            "surface: (drag: 2.0)",
            "pins: Topp",
            "Topp",
            "bodies.curtain.pins",
            &["`Indices(..)`", "did you mean `Top`?"],
        ),
        ("surface: (drag: 2.0)", "pins: Top(3)", "(3)", "bodies.curtain", &["`Top` holds nothing"]),
        (
            "surface: (drag: 2.0)",
            "pins: Indices(1, 2)",
            "1, 2",
            "bodies.curtain.pins",
            &["a list: `[.., ..]`", "found `1`"],
        ),
        (
            "surface: (drag: 2.0)",
            "pins: Indices",
            ",\n        ),\n        \"ball",
            "bodies.curtain.pins",
            &["`Indices(..)` that holds"],
        ),
        ("surface: (drag: 2.0)", "pins = Top", "= Top", "bodies.curtain", &["expected `:`", "found `=`"]),
        (
            "surface: (drag: 2.0)",
            "\"pins\": Top",
            "\"pins\"",
            "bodies.curtain",
            &[field, "did you mean `pins`?"],
        ),
        (
            "surface: (drag: 2.0)",
            "pins: Top pins: Top",
            "pins: Top,",
            "bodies.curtain",
            &["expected `,`", "found `pins`"],
        ),
        (
            "surface: (drag: 2.0)",
            "pins: Top, pins: Top",
            "pins: Top,\n",
            "bodies.curtain",
            &["`pins` is given twice"],
        ),
        (
            "surface: (drag: 2.0)",
            "material: red",
            "red",
            "bodies.curtain.material",
            &["in quotes", "found `red`", "`\"red\"`?"],
        ),
        (
            "surface: (drag: 2.0)",
            "present: yes",
            "yes",
            "bodies.curtain.present",
            &["`true` or `false`", "found `yes`"],
        ),
        (
            "surface: (drag: 2.0)",
            "velocity: 3",
            "3,\n        ),\n        \"ball",
            "bodies.curtain.velocity",
            &["3 values"],
        ),
        (
            "surface: (drag: 2.0)",
            "velocity: (1, 2)",
            "1, 2)",
            "bodies.curtain.velocity",
            &["3 values", "found 2"],
        ),
        ("(41, 31)", "(41, 31, 2)", "2)", "bodies.curtain.particles", &["2 values", "found more"]),
        ("(41, 31)", "(41.5, 31)", ".5, 31", "bodies.curtain.particles", &["a whole number, found `41.5`"]),
        ("drag: 2.0", "drag: two", "two", "bodies.curtain.surface.drag", &["a number from 0", "found `two`"]),
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
        ("AtMost(NaN)", "", ["expected a number,", "found NaN"]),
        ("Near(value: -NaN, tolerance: 1)", ".value", ["expected a number,", "found NaN"]),
        ("Near(value: 1, tolerance: NaN)", ".tolerance", ["expected a number from 0,", "found NaN"]),
        ("Near(value: 1, tolerance: -0.1)", ".tolerance", ["expected a number from 0,", "found -0.1"]),
        ("Between(0, inf)", "[1]", ["expected a number,", "found inf"]),
    ] {
        let error = error("AtMost(0.01)", expected);
        assert_told(&error, expected, &format!("expectations[0].expect{field}"), &words);
    }
}

/// They were told as fields that there are not, or as names without their quotes.
#[test]
fn a_bracket_that_is_not_closed_is_guessed() {
    let guess = "is a bracket before it not closed?";
    for (from, to, at, field) in [
        ("duration: 2, solver: (substeps: 16)),", "duration: 2,", "bodies: {", "settings.bodies"),
        ("velocity: (0, 0, -15)),", "velocity: (0, 0, -15),", "\"rope\": Rope", "bodies.ball"),
        ("particles: 11),\n    },", "particles: 11),", "obstacles: {", "bodies"),
    ] {
        assert_told(&error(from, to), at, field, &[guess]);
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
