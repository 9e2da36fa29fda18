//! Scenes that are played: events, triggers, probes and expectations, each seen to do what it says.

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

#[test]
fn a_cannon_fires_when_it_is_told_and_hits_what_it_aims_at() {
    run(r#"
        settings: (duration: 3),
        cannons: { "cannon": (at: (0, 1, 8), aim: Point(0, 1.5, 0), speed: 18) },
        obstacles: { "wall": (shape: Cuboid(size: (4, 4, 0.2)), at: (0, 2, -0.1)) },
        timeline: [
            (at: 0.5, repeat: (every: 0.5, times: 2), do: Fire("cannon")),
            (at: 1.2, do: Aim(cannon: "cannon", aim: Angles(elevation: 89, azimuth: 0), speed: 30)),
            (at: 1.3, do: Fire("cannon")),
        ],
        expectations: [
            (when: At(0.5), probe: Count(Bodies), expect: Near(value: 0, tolerance: 0)),
            (when: At(0.6), probe: Count(Bodies), expect: Near(value: 1, tolerance: 0)),
            (probe: Hits(of: "cannon#1", on: "wall"), expect: Near(value: 1, tolerance: 0)),
            (probe: Hits(of: "cannon", on: "wall"), expect: Near(value: 2, tolerance: 0)),
            (when: At(0.9666), probe: Position(of: "cannon#1", axis: Y), expect: Near(value: 1.5, tolerance: 0.02)),
            (probe: Velocity(of: "cannon#3", axis: Y), expect: AtLeast(10)),
        ]"#)
    .assert_passed();
}

#[test]
fn pins_let_go_and_hold_again() {
    // A free sheet falls g t^2 / 2: 1.226 m in half a second. Held again, it stays.
    run(r#"
        settings: (duration: 2, solver: (drag: 0)),
        bodies: { "sheet": Cloth(particles: (5, 5), at: (0, 5, 0)) },
        timeline: [
            (at: 0.5, do: Unpin(of: "sheet")),
            (at: 1, do: Pin(of: "sheet")),
        ],
        expectations: [
            (when: At(0.5), probe: Position(of: "sheet", axis: Y, since: 0), expect: Near(value: 0, tolerance: 0.01)),
            (when: At(1), probe: Position(of: "sheet", point: First, axis: Y, since: 0.5), expect: Near(value: -1.226, tolerance: 0.03)),
            (when: At(1.5), probe: Position(of: "sheet", axis: Y, since: 1.02), expect: Near(value: 0, tolerance: 1e-6)),
        ]"#)
    .assert_passed();
}

#[test]
fn a_freed_particle_has_the_mass_of_its_cloth() {
    // 1 m^2 of 0.25 kg/m^2: when its pins are freed, the momentum of the whole is m g t.
    run(r#"
        settings: (duration: 1, solver: (drag: 0)),
        bodies: { "sheet": Cloth(particles: (5, 5), at: (0, 5, 0), pins: None), "held": Cloth(particles: (5, 5), at: (3, 5, 0)) },
        timeline: [(at: 0, do: Unpin(of: "held", particles: Pinned))],
        expectations: [
            (probe: Momentum(of: "sheet", axis: Y), expect: Near(value: -2.4525, tolerance: 0.001)),
            (probe: Momentum(of: "held", axis: Y), expect: Near(value: -2.4525, tolerance: 0.03)),
        ]"#)
    .assert_passed();
}

#[test]
fn a_push_changes_momentum_by_its_impulse() {
    run(r#"
        settings: (duration: 0.5, gravity: (0, 0, 0), solver: (drag: 0)),
        bodies: {
            "sheet": Cloth(particles: (5, 5), pins: None),
            "ball": Balls(at: (9, 0, 0)),
            "bob": Rig(at: (0, 9, 0), particles: { "a": (mass: 2), "b": (at: (1, 0, 0)) }, sticks: [(a: "a", b: "b")]),
        },
        obstacles: { "box": (shape: Cuboid(size: (1, 1, 1)), at: (0, 0, 9), motion: Dynamic(mass: 3)) },
        timeline: [
            (at: 0.1, do: Push(of: "sheet", impulse: (0, 0, 1))),
            (at: 0.1, do: Push(of: "ball", impulse: (0, 0, 2))),
            (at: 0.1, do: Push(of: "bob", impulse: (0, 0, 3), particles: Particles([1]))),
            (at: 0.1, do: Push(of: "box", impulse: (0, 0, 4))),
        ],
        expectations: [
            (when: At(0.1), probe: Momentum(), expect: Near(value: 0, tolerance: 1e-7)),
            (probe: Momentum(of: "sheet", axis: Z), expect: Near(value: 1, tolerance: 1e-4)),
            (probe: Momentum(of: "ball", axis: Z), expect: Near(value: 2, tolerance: 1e-4)),
            (probe: Momentum(of: "bob", axis: Z), expect: Near(value: 3, tolerance: 1e-4)),
            (probe: Momentum(of: "box", axis: Z), expect: Near(value: 4, tolerance: 1e-4)),
            (probe: Velocity(of: "bob", axis: Z), expect: Near(value: 1, tolerance: 1e-4)),
            (probe: Energy(of: "box", kind: Kinetic), expect: Near(value: 2.667, tolerance: 0.001)),
        ]"#)
    .assert_passed();
}

#[test]
fn a_dragged_particle_follows_its_path_and_is_let_go() {
    run(r#"
        settings: (duration: 3, solver: (drag: 3)),
        bodies: { "curtain": Cloth(particles: (11, 11), at: (0, 2, 0)) },
        timeline: [(at: 0, do: Drag(of: "curtain", point: Particle(115), radius: 0.2, path: [(0.5, (0, 0.1, 0.4)), (1, (0, 0.1, 0.4))]))],
        expectations: [
            (when: At(1), probe: Position(of: "curtain", point: Particle(115), axis: Z), expect: Near(value: 0.4, tolerance: 0.05)),
            (probe: Position(of: "curtain", point: Particle(115), axis: Z), expect: Near(value: 0, tolerance: 0.05)),
        ]"#)
    .assert_passed();
}

#[test]
fn a_path_of_places_leads_to_them_wherever_the_particle_was() {
    run(r#"
        settings: (duration: 1, solver: (drag: 3)),
        bodies: { "curtain": Cloth(particles: (11, 11), at: (0, 2, 0)) },
        timeline: [(at: 0, do: Drag(of: "curtain", point: Last, path: [(0.5, (0.4, 1.6, 0.3)), (1, (0.4, 1.6, 0.3))], absolute: true))],
        expectations: [
            (when: At(0.9), probe: Position(of: "curtain", point: Last, axis: X), expect: Near(value: 0.4, tolerance: 0.03)),
            (when: At(0.9), probe: Position(of: "curtain", point: Last, axis: Y), expect: Near(value: 1.6, tolerance: 0.03)),
            (when: At(0.9), probe: Position(of: "curtain", point: Last, axis: Z), expect: Near(value: 0.3, tolerance: 0.03)),
        ]"#)
    .assert_passed();
}

/// To hold 2 kg on a rope at 30 degrees to the side takes 2 g tan 30 = 11 N. 3 N reach to 9 degrees.
#[test]
fn a_hand_is_as_strong_as_it_is_told_to_be() {
    let report = run(r#"
        settings: (duration: 6, solver: (drag: 3)),
        bodies: {
            "weak": Rope(end_mass: 2, particles: 8),
            "strong": Rope(start: (3, 0, 0), end: (3, -1, 0), end_mass: 2, particles: 8),
        },
        timeline: [
            (at: 0, do: Drag(of: "weak", point: Last, path: [(1, (0.5, 0.134, 0)), (6, (0.5, 0.134, 0))], greatest_force: 3)),
            (at: 0, do: Drag(of: "strong", point: Last, path: [(1, (0.5, 0.134, 0)), (6, (0.5, 0.134, 0))], greatest_force: 30)),
        ],
        expectations: [
            (when: At(5.8), probe: Position(of: "weak", point: Last, axis: X), expect: Near(value: 0.151, tolerance: 0.03)),
            (when: At(5.8), probe: Position(of: "strong", point: Last, axis: X), expect: Near(value: 3.5, tolerance: 0.03)),
        ]"#);
    report.assert_passed();
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
    assert!(said.contains("self_contact: Particles"), "{said}");
    for good in [r#"Contacts(of: "a", on: "box")"#, r#"Contacts(of: "a")"#, r#"Contacts()"#] {
        error(pair, good).expect("it can be measured");
    }
    let touching = pair.replace("contacts: true", "contacts: true, solver: (self_contact: Particles)");
    error(&touching, r#"Contacts(of: "a", on: "b")"#).expect_err("one of them still does not");
    error(
        &touching.replace("Cloth()", "Cloth(solver: (self_contact: Particles))"),
        r#"Contacts(of: "a", on: "b")"#,
    )
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

#[test]
fn junit_tells_what_could_not_be_loaded_from_what_was_refused() {
    let unread = bevy_drape_script::run_scene("no/such.scene.ron");
    let good = run(r#"settings: (duration: 0.1), bodies: { "ball": Balls() }"#);
    let xml = bevy_drape_script::to_junit("all", [&unread, &good]).expect("XML");
    let place = |text: &str| xml.find(text).unwrap_or_else(|| panic!("no {text} in {xml}"));
    assert!(place("it can be loaded") < place("nothing is refused"));
    assert_eq!(xml.matches("<failure").count(), 1, "{xml}");
}

#[test]
fn settings_change_by_their_paths() {
    run(r#"
        settings: (duration: 1, solver: (drag: 0)),
        bodies: { "ball": Balls(at: (0, 5, 0)), "slider": Balls(at: (4, 0.15, 0), velocity: (3, 0, 0), friction: 1, rolling_resistance: 0) },
        obstacles: { "ground": (shape: Ground, friction: 1) },
        timeline: [
            (at: 0, do: Set("settings.gravity", [0, -1, 0])),
            (at: 0.5, do: Set("settings.wind.velocity", [1, 0, 0])),
        ],
        expectations: [
            (probe: Position(of: "ball", axis: Y), expect: Near(value: 4.5, tolerance: 0.001)),
        ]"#)
    .assert_passed();
}

#[test]
fn what_is_spawned_appears_and_what_is_despawned_vanishes() {
    run(r#"
        settings: (duration: 2),
        bodies: { "late": Balls(at: (0, 1, 0), present: false), "rain": Balls(copies: (count: (3, 1, 2)), at: (5, 1, 0)) },
        obstacles: { "floor": (shape: Cuboid(size: (2, 0.2, 2)), at: (0, 0, 0), present: false) },
        timeline: [
            (at: 0.5, do: Spawn("late")),
            (at: 0.5, do: Spawn("floor")),
            (at: 0.75, do: Despawn("rain")),
        ],
        expectations: [
            (when: At(0.5), probe: Count(Bodies), expect: Near(value: 6, tolerance: 0)),
            (when: At(0.6), probe: Count(Bodies), expect: Near(value: 7, tolerance: 0)),
            (probe: Count(Bodies), expect: Near(value: 1, tolerance: 0)),
            (probe: Position(of: "late", axis: Y), expect: Near(value: 0.25, tolerance: 0.001)),
            (when: During(1, 2), probe: Penetration(of: "late"), expect: AtMost(1e-4)),
        ]"#)
    .assert_passed();
}

#[test]
fn a_trigger_sets_its_event_off_once() {
    let report = run(r#"
        settings: (duration: 20),
        bodies: { "ball": Balls(at: (0, 1, 0)), "late": Balls(at: (3, 1, 0), present: false) },
        obstacles: { "ground": (shape: Ground) },
        timeline: [
            (when: Hit(of: "ball", on: "ground"), do: Spawn("late")),
            (when: Measured(probe: Position(of: "late", axis: Y), expect: AtMost(0.5)), do: Push(of: "late", impulse: (0, 0, 2))),
            (when: Resting("ball"), do: Stop),
        ],
        expectations: [
            (when: Eventually(within: 0.5), probe: Count(Bodies), expect: Near(value: 2, tolerance: 0)),
            (when: Eventually(within: 1), probe: Velocity(of: "late", axis: Z), expect: Near(value: 1, tolerance: 0.01)),
            (probe: Activity(of: "ball"), expect: Is("Resting")),
        ]"#);
    report.assert_passed();
    assert!(report.simulated_s < 5.0, "stopped at {} s", report.simulated_s);
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
fn a_pause_stops_the_simulation_and_not_the_scene() {
    let mut runner = SceneRunner::headless(script(
        r#"(version: 1, settings: (duration: 1), bodies: { "ball": Balls() }, timeline: [
            (at: 0.5, do: Pause(0.5)), (at: 0.5, do: Picture("eye")), (at: 0.75, do: Checkpoint("late")),
        ], cameras: { "eye": () })"#,
    ));
    let mut updates = 0;
    let mut seen = Vec::new();
    while runner.step() {
        updates += 1;
        let world = runner.world();
        let steps = world.resource::<ScenePlay>().steps();
        for due in world.resource::<bevy::ecs::message::Messages<PictureDue>>().iter_current_update_messages()
        {
            seen.push((due.camera.clone(), steps));
        }
        for due in
            world.resource::<bevy::ecs::message::Messages<CheckpointTaken>>().iter_current_update_messages()
        {
            seen.push((due.name.clone(), steps));
        }
    }
    assert_eq!(runner.report().steps, 60);
    assert_eq!(updates, 89, "half a second stood still");
    assert_eq!(seen, [("eye".to_string(), 30), ("late".to_string(), 46)]);
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
    let report = run(r#"settings: (duration: 0.1), bodies: { "c": Cloth(solver: (drag: 1e6)) }"#);
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
fn a_cut_body_goes_by_its_name_and_its_pieces_by_theirs() {
    let mut runner = SceneRunner::headless(script(
        r#"(version: 1,
        settings: (duration: 2),
        bodies: { "sheet": Cloth(size: (1, 1), particles: (11, 11), at: (0, 3, 0)) },
        timeline: [
            (at: 0.5, do: Cut(of: "sheet", from: ((-1, 3.03, -1), (-1, 3.03, 1)), to: ((1, 3.03, -1), (1, 3.03, 1)))),
            (when: Measured(probe: Pieces(of: "sheet"), expect: AtLeast(2)), do: Push(of: "sheet#2", impulse: (0.1, 0, 0))),
            (at: 1.5, do: Set("sheet.particles", (5, 5))),
        ],
        expectations: [
            (when: At(0.4), probe: Pieces(of: "sheet"), expect: Near(value: 1, tolerance: 0)),
            (when: At(0.4), probe: Torn(), expect: Near(value: 0, tolerance: 0)),
            (when: At(1), probe: Pieces(of: "sheet"), expect: Near(value: 2, tolerance: 0)),
            // One stick of each column.
            (when: At(1), probe: Torn(of: "sheet"), expect: Near(value: 11, tolerance: 0)),
            (when: At(1), probe: Velocity(of: "sheet#2", axis: X), expect: AtLeast(0.5)),
            (when: At(1), probe: Velocity(of: "sheet#1", axis: X), expect: Near(value: 0, tolerance: 0.01)),
            (when: At(1), probe: Extent(of: "sheet", axis: Y), expect: AtLeast(1.5)),
            (probe: Pieces(of: "sheet"), expect: Near(value: 1, tolerance: 0)),
        ])"#,
    ));
    for _ in 0..60 {
        runner.step();
    }
    let world = runner.world();
    let play = world.resource::<ScenePlay>();
    let names: Vec<String> = play.bodies(world).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["sheet#1", "sheet#2"]);
    runner.run().assert_passed();
}

#[test]
fn winds_blow_where_and_while_they_are_there() {
    run(r#"
        settings: (duration: 3, gravity: (0, 0, 0)),
        bodies: {
            "near": Cloth(size: (0.4, 0.4), particles: (5, 5), pins: None, solver: (drag: 0)),
            "far": Cloth(size: (0.4, 0.4), particles: (5, 5), pins: None, at: (5, 0, 0), solver: (drag: 0)),
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

#[test]
fn what_cannot_be_cut_or_blown_is_refused() {
    for (line, words) in [
        (
            r#"timeline: [(at: 0, do: Cut(of: "ball", from: ((0, 0, 0), (1, 0, 0)), to: ((0, 1, 0), (1, 1, 0))))]"#,
            "`ball` is none",
        ),
        (r#"timeline: [(at: 0, do: Push(of: "fan", impulse: (0, 0, 1)))]"#, "nothing pushes"),
        (r#"expectations: [(probe: Speed(of: "fan"), expect: Reported)]"#, "a wind is felt"),
        (r#"expectations: [(probe: Pieces(of: "ball"), expect: Reported)]"#, "nothing else tears"),
        (r#"cannons: { "fan": () }"#, "called `fan` already"),
    ] {
        let text = format!(r#"(version: 1, bodies: {{ "ball": Balls() }}, winds: {{ "fan": () }}, {line})"#);
        let error = SceneScript::parse(&text).expect_err(line).to_string();
        assert!(error.contains(words), "{error} does not say {words}");
    }
}
