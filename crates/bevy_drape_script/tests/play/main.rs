//! Scenes that are played: events, triggers, probes and expectations, each seen to do what it says.

mod actions;

use bevy_drape_script::play::{CheckpointTaken, PictureDue, ScenePlay};
use bevy_drape_script::scene::Measured;
use bevy_drape_script::{Report, SceneRunner, SceneScript};

fn script(text: &str) -> SceneScript {
    SceneScript::parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Runs a scene of these fields.
fn run(fields: &str) -> Report {
    let report = SceneRunner::headless(script(&format!("(version: 1, {fields})"))).run();
    println!("{report}");
    report
}

/// The number that expectation `index` has measured.
fn number(report: &Report, index: usize) -> f64 {
    match report.verdicts[index].got {
        Some(Measured::Number(number)) => number,
        ref other => panic!("no number: {other:?}"),
    }
}

#[test]
fn a_falling_ball_does_what_is_expected_of_it() {
    let report = run(r#"
        settings: (duration: 1),
        bodies: { "ball": Balls(at: (0, 10, 0), velocity: (2, 0, 0)) },
        expectations: [
            (probe: Position(of: "ball", axis: Y), expect: Near(value: 5.095, tolerance: 0.001)),
            (when: At(0.5), probe: Position(of: "ball", axis: X), expect: Near(value: 1, tolerance: 1e-5)),
            // The velocity is half a step old: m g v h / 2, 1.6 J in the end.
            (when: Always, probe: Energy(), expect: Between(198.5, 200.21)),
            (when: Eventually(within: 0.6), probe: Velocity(of: "ball", axis: Y), expect: AtMost(-5)),
            (when: During(0.5, 1), probe: Speed(of: "ball"), expect: AtLeast(5)),
            (probe: Momentum(of: "ball", axis: X), expect: Near(value: 4, tolerance: 1e-4)),
            (probe: Position(of: "ball", axis: Y, since: 0.5), expect: Near(value: -3.67875, tolerance: 0.001)),
            (probe: StateHash(), expect: Reported),
        ]"#);
    report.assert_passed();
    assert_eq!(report.steps, 60);
}

/// "It comes to rest" held before the push, when it hung at rest still.
#[test]
fn what_is_to_come_true_after_a_time_is_not_looked_at_before() {
    let report = run(r#"
        settings: (duration: 2),
        bodies: { "ball": Balls(at: (0, 1, 0)) },
        obstacles: { "ground": (shape: Ground) },
        expectations: [
            (when: Eventually(within: 2), probe: Speed(of: "ball"), expect: AtMost(0.5)),
            (when: Eventually(within: 2, after: 0.3), probe: Speed(of: "ball"), expect: AtMost(0.5)),
        ]"#);
    report.assert_passed();
    let times: Vec<f64> = report.verdicts.iter().map(|verdict| verdict.time.expect("measured")).collect();
    // After the first steps of its fall, and when it lies on the ground after sqrt(2 h / g) = 0.43 s.
    assert!(times[0] < 0.06 && times[1] > 0.4, "{times:?}");
}

/// The middle of a cloth of an even number of particles was the first of a row: on its edge.
#[test]
fn the_middle_of_a_cloth_is_in_its_middle() {
    let report = run(r#"
        settings: (duration: 0.1, gravity: (0, 0, 0)),
        bodies: { "cloth": Cloth(size: (1, 2), particles: (8, 12), at: (3, 0, 0)) },
        expectations: [
            (probe: Position(of: "cloth", point: Middle, axis: X), expect: Near(value: 3, tolerance: 0.08)),
            (probe: Position(of: "cloth", point: Middle, axis: Y), expect: Near(value: 0, tolerance: 0.1)),
        ]"#);
    report.assert_passed();
}

#[test]
fn what_does_not_hold_is_told_with_scene_time_expected_and_got() {
    let mut runner = SceneRunner::headless(script(
        r#"(version: 1,
        settings: (duration: 1),
        bodies: { "ball": Balls(at: (0, 10, 0)), "ghost": Balls(present: false) },
        expectations: [
            (name: "floats", when: Always, probe: Position(of: "ball", axis: Y), expect: AtLeast(9)),
            (when: At(0.5), probe: Position(of: "ball", axis: Y), expect: Near(value: 0, tolerance: 1)),
            (when: Eventually(within: 0.5), probe: Position(of: "ball", axis: Y), expect: AtMost(6)),
            (when: At(1), probe: Position(of: "ghost", axis: Y), expect: Near(value: 0, tolerance: 1)),
        ])"#,
    ))
    .named("fall");
    runner.note_recording("target/fall.rec");
    let report = runner.run();
    assert!(!report.passed());
    let complaint = report.complaint();
    println!("{complaint}");
    let lines: Vec<&str> = complaint.lines().collect();
    assert_eq!(lines.len(), 5, "{complaint}");
    // It has fallen a metre after sqrt(2 / g) = 0.452 s: in the step that ends at 28 / 60 s.
    for words in ["fall: FAIL floats", "always", "expected at least 9 m", "got 8.93", "at 0.467 s"] {
        assert!(lines[0].contains(words), "{} does not say {words}", lines[0]);
    }
    assert!(lines[1].contains("0 ± 1 m") && lines[1].contains("got 8.77"), "{}", lines[1]);
    assert!(lines[2].contains("within 0.5 s") && lines[2].contains("got 8.77"), "{}", lines[2]);
    assert!(lines[3].contains("never"), "{}", lines[3]);
    assert!(lines[4].contains("target/fall.rec"), "{}", lines[4]);
    let caught = std::panic::catch_unwind(|| report.assert_passed());
    assert!(caught.is_err(), "it asserts nothing");
}

#[test]
fn what_is_only_reported_is_told_so() {
    let report = run(r#"
        settings: (duration: 0.5),
        bodies: { "ball": Balls(at: (0, 10, 0)) },
        expectations: [(probe: Position(of: "ball", axis: Y), expect: Reported)]"#);
    let verdict = report.verdicts[0].to_string();
    assert!(verdict.starts_with("info ") && verdict.contains("a report only: got 8.7"), "{verdict}");
}

#[test]
fn what_touches_now_is_told_from_what_ever_did() {
    // It falls for 0.45 s and bounces to a quarter of the height: on its way again for as long.
    run(r#"
        settings: (duration: 4),
        bodies: { "ball": Balls(at: (0, 1.15, 0), restitution: 0.5, contacts: true) },
        obstacles: { "ground": (shape: Ground, restitution: 0.5) },
        expectations: [
            (when: During(0, 0.4), probe: Touching(of: "ball", on: "ground"), expect: Near(value: 0, tolerance: 0)),
            (when: Eventually(within: 0.5), probe: Touching(of: "ball", on: "ground"), expect: Near(value: 1, tolerance: 0)),
            (when: During(0.6, 0.85), probe: Touching(of: "ball", on: "ground"), expect: Near(value: 0, tolerance: 0)),
            (when: During(0.6, 0.85), probe: Contacts(of: "ball", on: "ground"), expect: Near(value: 1, tolerance: 0)),
            (probe: Touching(), expect: Near(value: 1, tolerance: 0)),
            (probe: Contacts(), expect: AtLeast(2)),
        ]"#)
    .assert_passed();
}

/// Two boxes that fly apart had the same hash.
#[test]
fn the_state_hash_knows_of_dynamic_obstacles_and_set_of_their_motion() {
    let hash = |event: &str| {
        let report = run(&format!(
            r#"settings: (duration: 0.5), timeline: [{event}],
            obstacles: {{ "crate": (shape: Cuboid(size: (1, 1, 1)), motion: Dynamic(gravity_scale: 0)) }},
            expectations: [(probe: Position(of: "crate", axis: X), expect: Reported)]"#
        ));
        (report.state_hash.clone(), number(&report, 0))
    };
    let still = hash("");
    let pushed = hash(r#"(at: 0.1, do: Push(of: "crate", impulse: (1, 0, 0)))"#);
    let set = hash(r#"(at: 0.1, do: Set("crate.motion.velocity", (3, 0, 0)))"#);
    assert_eq!(still, hash(""));
    assert!(still.0 != pushed.0 && pushed.0 != set.0 && still.0 != set.0);
    assert!(
        still.1 == 0.0 && (pushed.1 - 0.4).abs() < 0.02 && (set.1 - 1.2).abs() < 0.06,
        "{still:?} {pushed:?} {set:?}"
    );
}

#[test]
fn what_can_never_be_measured_is_refused() {
    let error = |bodies: &str, probe: &str| {
        let text = format!(
            r#"(version: 1, bodies: {{ {bodies} }}, obstacles: {{ "box": (shape: Cuboid(size: (1, 1, 1))) }},
            expectations: [(probe: {probe}, expect: Reported)])"#
        );
        SceneScript::parse(&text).map_err(|error| error.to_string())
    };
    let pair = r#""a": Cloth(contacts: true), "b": Cloth()"#;
    let said = error(pair, r#"Contacts(of: "a", on: "b")"#).expect_err("they pass through each other");
    assert!(said.contains("self_contact: On"), "{said}");
    for good in [r#"Contacts(of: "a", on: "box")"#, r#"Contacts(of: "a")"#, r#"Contacts()"#] {
        error(pair, good).expect("it can be measured");
    }
    let touching = pair.replace("contacts: true", "contacts: true, solver: (self_contact: On)");
    error(&touching, r#"Contacts(of: "a", on: "b")"#).expect_err("one of them still does not");
    error(&touching.replace("Cloth()", "Cloth(solver: (self_contact: On))"), r#"Contacts(of: "a", on: "b")"#)
        .expect("both do");
    let said = error(pair, r#"Extent(of: "box")"#).expect_err("an obstacle");
    assert!(said.contains("`shape`"), "{said}");
}

#[test]
fn energy_is_counted_from_a_time_on() {
    let report = run(r#"
        settings: (duration: 1),
        bodies: { "ball": Balls(at: (0, 10, 0), mass: 2) },
        expectations: [
            (probe: Energy(kind: Potential), expect: Reported),
            (when: At(0.5), probe: Energy(kind: Potential), expect: Reported),
            (probe: Energy(kind: Potential, since: 0.5), expect: Reported),
        ]"#);
    let [end, half, since] = [0, 1, 2].map(|index| number(&report, index));
    assert!((end - half - since).abs() < 1e-3 && since < -60.0, "{end} {half} {since}");
}

/// A cut beside the cloth and a push of what was gone went by without a word.
#[test]
fn what_was_asked_for_in_vain_is_noted_and_fails_nothing() {
    let report = run(r#"
        settings: (duration: 0.5),
        bodies: {
            "ball": Balls(at: (0, 1, 0)),
            "sheet": Cloth(at: (3, 5, 0), size: (1, 1), particles: (5, 5), pins: Top),
        },
        timeline: [
            (at: 0.1, do: Cut(of: "sheet", from: ((9, 9, 0), (9, 8, 0)), to: ((9, 9, 1), (9, 8, 1)))),
            (at: 0.1, do: Despawn("ball")),
            (at: 0.2, repeat: (every: 0.1, times: 3), do: Push(of: "ball", impulse: (0, 1, 0))),
            (at: 0.2, do: Spawn("sheet")),
            (when: Measured(probe: Position(of: "sheet", axis: Y), expect: AtLeast(100)), do: Stop),
            (at: 0.3, do: Cut(from: ((3.1, 9, -1), (3.1, 0, -1)), to: ((3.1, 9, 1), (3.1, 0, 1)))),
        ]"#);
    report.assert_passed();
    let expected = [
        "timeline[0] at 0.100 s: the cut severed nothing",
        "timeline[2] at 0.200 s: `ball` is not there",
        "timeline[3] at 0.200 s: `sheet` is there already",
        "timeline[4]: it was never set off",
        "nothing is expected",
    ];
    assert_eq!(report.notes, expected);
    for note in expected {
        assert!(report.to_string().contains(&format!("note {note}")), "{report}");
    }
}

#[test]
fn junit_tells_what_could_not_be_loaded_from_what_was_refused() {
    let unread = bevy_drape_script::run_scene("no/such.scene.ron");
    let good = run(r#"settings: (duration: 0.1), bodies: { "ball": Balls() }"#);
    let xml = bevy_drape_script::to_junit("all", [&unread, &good]).expect("XML");
    let place = |text: &str| xml.find(text).unwrap_or_else(|| panic!("no {text} in {xml}"));
    assert!(place("it can be loaded") < place("nothing is refused"));
    assert_eq!(xml.matches("<failure").count(), 1, "{xml}");
    assert!(place("nothing is refused") < place("nothing is expected"), "{xml}");
}

#[test]
fn keyframes_carry_and_belts_drag_along() {
    run(r#"
        settings: (duration: 2),
        bodies: { "ball": Balls(at: (0, 0.25, 0), rolling_resistance: 0), "brick": Rig(particles: { "a": (at: (5, 0, 0)) }) },
        obstacles: {
            "lift": (shape: Cuboid(size: (1, 0.2, 1)), motion: Keyframes(keys: [(time: 0, at: (0, 0, 0)), (time: 1, at: (0, 0, 0)), (time: 2, at: (0, 1, 0))])),
            "belt": (shape: Cuboid(size: (40, 1, 1)), at: (5, -0.5, 0), motion: Steady(velocity: (0.5, 0, 0))),
        },
        expectations: [
            (when: At(1), probe: Position(of: "ball", axis: Y), expect: Near(value: 0.25, tolerance: 0.002)),
            (when: At(1.5), probe: Position(of: "lift", axis: Y), expect: Near(value: 0.5, tolerance: 1e-5)),
            (probe: Position(of: "ball", axis: Y), expect: Near(value: 1.25, tolerance: 0.002)),
            (probe: Velocity(of: "brick", axis: X), expect: Near(value: 0.5, tolerance: 0.001)),
        ]"#)
    .assert_passed();
}

#[test]
fn contacts_are_counted_and_a_sensor_moves_nothing() {
    run(r#"
        settings: (duration: 1),
        bodies: { "ball": Balls(at: (0, 1, 0)) },
        obstacles: { "gate": (shape: Cuboid(size: (1, 0.2, 1)), sensor: true, contacts: true) },
        expectations: [
            (probe: Contacts(of: "ball", on: "gate"), expect: Near(value: 1, tolerance: 0)),
            (probe: Position(of: "ball", axis: Y), expect: Near(value: -3.905, tolerance: 0.001)),
        ]"#)
    .assert_passed();
}

#[test]
fn what_the_plugin_refuses_fails_the_scene() {
    let report = run(r#"settings: (duration: 0.1), bodies: { "c": Cloth(surface: (drag: 1e6)) }"#);
    assert!(!report.passed() && report.complaint().contains("drag"), "{report}");
}

#[test]
fn the_same_scene_has_the_same_bits_and_its_steps_can_be_looked_at() {
    let fields = r#"version: 1, settings: (duration: 1, seed: 7), bodies: {
        "curtain": Cloth(particles: (17, 17), at: (0, 1, 0)),
        "rain": Balls(at: (0, 3, 0), radius: 0.05, mass: 0.1, copies: (count: (3, 2, 3), spacing: (0.2, 0.3, 0.2), scatter: 0.02)),
    }"#;
    let run = || {
        let mut looked = Vec::new();
        let report = SceneRunner::headless(script(&format!("({fields})")))
            .run_with(|world, step| looked.push((step, world.resource::<ScenePlay>().state_hash(world))));
        (report.state_hash, looked)
    };
    let (hash, looked) = run();
    assert_eq!(looked.len(), 60);
    assert_eq!(looked[59].0, 60);
    assert_eq!(hash, format!("{:016x}", looked[59].1));
    assert_eq!((hash, looked), run());
}

#[test]
fn a_step_time_ratio_is_reported_and_never_fails() {
    let report = run(r#"
        settings: (duration: 0.1),
        bodies: { "big": Cloth(particles: (65, 65)), "small": Cloth(particles: (9, 9)) },
        expectations: [(probe: StepTimeRatio(of: "big", against: "small"), expect: AtMost(0.001))]"#);
    report.assert_passed();
    assert!(number(&report, 0) > 0.0);
}

#[test]
fn winds_blow_where_and_while_they_are_there() {
    run(r#"
        settings: (duration: 3, gravity: (0, 0, 0)),
        bodies: {
            "near": Cloth(size: (0.4, 0.4), particles: (5, 5), pins: None, surface: (drag: 0)),
            "far": Cloth(size: (0.4, 0.4), particles: (5, 5), pins: None, at: (5, 0, 0), surface: (drag: 0)),
        },
        winds: { "fan": (region: Sphere(radius: 1), flow: Along(0, 0, 2), present: false) },
        timeline: [(at: 1, do: Spawn("fan")), (at: 1.3, do: Set("fan.flow", Along(0, 0, 4))), (at: 1.6, do: Despawn("fan"))],
        expectations: [
            (when: At(0.9), probe: Speed(of: "near"), expect: Near(value: 0, tolerance: 0)),
            (when: At(1.6), probe: Velocity(of: "near", axis: Z), expect: AtLeast(0.2)),
            (when: During(0, 3), probe: Speed(of: "far"), expect: Near(value: 0, tolerance: 0)),
        ]"#)
    .assert_passed();
}

/// Before its base was known the value itself was looked at: this held at once.
#[test]
fn what_counts_from_a_time_is_not_looked_at_before() {
    let report = run(r#"
        settings: (duration: 1, gravity: (0, 0, 0)),
        bodies: { "ball": Balls(at: (0, -1, 0)) },
        expectations: [
            (when: Eventually(), probe: Position(of: "ball", axis: Y, since: 0.5), expect: AtMost(-0.5)),
            (when: Always, probe: Position(of: "ball", axis: Y, since: 0.5), expect: AtLeast(-0.1)),
        ]"#);
    let passed: Vec<bool> = report.verdicts.iter().map(|verdict| verdict.passed).collect();
    assert_eq!(passed, [false, true]);
    let text = r#"(version: 1, bodies: { "ball": Balls() },
        expectations: [(when: At(1), probe: Position(of: "ball", axis: Y, since: 2), expect: AtMost(0))])"#;
    let error = SceneScript::parse(text).expect_err("it is never looked at").to_string();
    assert!(error.contains("expectations[0].probe.since"), "{error}");
}

/// It was told as of the first step, as if nobody had waited.
#[test]
fn a_word_that_never_came_is_told_as_it_was_last() {
    let report = run(r#"
        settings: (duration: 1),
        bodies: { "ball": Balls(at: (0, 99, 0)) },
        expectations: [(when: Eventually(within: 0.5), probe: Activity(of: "ball"), expect: Is("Resting"))]"#);
    let verdict = &report.verdicts[0];
    assert!(!verdict.passed && verdict.time.is_some_and(|time| (time - 0.5).abs() < 0.01), "{verdict}");
}

/// "It was never there to be measured" was said of a ball that was there from the first.
#[test]
fn nothing_is_looked_at_before_the_first_step() {
    let text = r#"(version: 1, bodies: { "ball": Balls() },
        expectations: [(when: At(0), probe: Speed(of: "ball"), expect: AtMost(1))])"#;
    let error = SceneScript::parse(text).expect_err("there is no such look").to_string();
    assert!(error.contains("after the first step") && error.contains("expectations[0].when"), "{error}");
}
