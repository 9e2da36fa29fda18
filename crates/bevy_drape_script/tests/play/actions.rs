//! What events do: each action, and what sets it off.

use super::*;

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
        settings: (duration: 2, surface: (drag: 0)),
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
        settings: (duration: 1, surface: (drag: 0)),
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
        settings: (duration: 0.5, gravity: (0, 0, 0), surface: (drag: 0)),
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
        settings: (duration: 3, surface: (drag: 3)),
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
        settings: (duration: 1, surface: (drag: 3)),
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
        settings: (duration: 6, surface: (drag: 3)),
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

#[test]
fn settings_change_by_their_paths() {
    run(r#"
        settings: (duration: 1, surface: (drag: 0)),
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
fn a_cut_body_goes_by_its_name_and_its_pieces_by_theirs() {
    let mut runner = SceneRunner::headless(script(
        r#"(version: 1,
        settings: (duration: 2),
        bodies: { "sheet": Cloth(size: (1, 1), particles: (11, 11), at: (0, 3, 0)) },
        timeline: [
            (at: 0.5, do: Cut(of: "sheet", from: ((-1, 2.97, -1), (-1, 2.97, 1)), to: ((1, 2.97, -1), (1, 2.97, 1)))),
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

/// The second hand took the curtain out of the first, and with the first both let go.
#[test]
fn two_hands_drag_one_curtain() {
    run(r#"
        settings: (duration: 1.2, surface: (drag: 3)),
        bodies: { "curtain": Cloth(particles: (11, 11), at: (0, 2, 0)) },
        timeline: [
            (at: 0, do: Drag(of: "curtain", point: Particle(110), path: [(0.4, (0, 0.1, 0.2)), (0.6, (0, 0.1, 0.2))])),
            (at: 0, do: Drag(of: "curtain", point: Particle(120), path: [(0.4, (0, 0.1, -0.2)), (1.2, (0, 0.1, -0.2))])),
        ],
        expectations: [
            (when: At(0.55), probe: Position(of: "curtain", point: Particle(110), axis: Z), expect: Near(value: 0.2, tolerance: 0.05)),
            (when: At(0.55), probe: Position(of: "curtain", point: Particle(120), axis: Z), expect: Near(value: -0.2, tolerance: 0.05)),
            (when: At(1.1), probe: Position(of: "curtain", point: Particle(110), axis: Z), expect: AtMost(0.1)),
            (when: At(1.1), probe: Position(of: "curtain", point: Particle(120), axis: Z), expect: Near(value: -0.2, tolerance: 0.05)),
        ]"#)
    .assert_passed();
}

/// The piece that came off in the hand hung in the air for ever.
#[test]
fn what_is_cut_off_in_the_hand_follows_it_and_is_let_go() {
    run(r#"
        settings: (duration: 2),
        bodies: { "curtain": Cloth(particles: (11, 11), at: (0, 2, 0)) },
        timeline: [
            (at: 0, do: Drag(of: "curtain", point: Last, path: [(0.5, (0, 0, 0)), (1, (0, 0.3, 0))])),
            (at: 0.4, do: Cut(of: "curtain", from: ((-2, 1.6, -1), (-2, 1.6, 1)), to: ((2, 1.6, -1), (2, 1.6, 1)))),
        ],
        expectations: [
            (when: Always, probe: Pieces(of: "curtain"), expect: Between(1, 2)),
            (when: At(0.95), probe: Greatest(of: "curtain#2", axis: Y), expect: AtLeast(1.2)),
            (probe: Greatest(of: "curtain#2", axis: Y), expect: AtMost(-1)),
        ]"#)
    .assert_passed();
}

/// The clock stood still for good.
#[test]
fn another_scene_begins_in_the_pause_of_the_one_before() {
    let mut runner = SceneRunner::headless(script(
        r#"(version: 1, bodies: { "ball": Balls() }, timeline: [(at: 0.1, do: Pause(5))])"#,
    ));
    (0..12).for_each(|_| _ = runner.step());
    let another = script(r#"(version: 1, settings: (duration: 1), bodies: { "ball": Balls() })"#);
    bevy_drape_script::play::begin_scene(runner.world_mut(), another);
    (0..10).for_each(|_| _ = runner.step());
    assert!(runner.world().resource::<ScenePlay>().steps() >= 9);
}

/// What was due at the end had no step before which to happen.
#[test]
fn a_picture_is_taken_at_the_end() {
    let mut runner = SceneRunner::headless(script(
        r#"(version: 1, settings: (duration: 0.5), bodies: { "ball": Balls() }, cameras: { "eye": (at: (0, 0, 5), look_at: (0, 0, 0)) },
        timeline: [(at: 0.5, do: Picture("eye"))])"#,
    ));
    let mut pictures = 0;
    let mut goes_on = true;
    while goes_on {
        goes_on = runner.step();
        pictures += runner
            .world()
            .resource::<bevy::ecs::message::Messages<PictureDue>>()
            .iter_current_update_messages()
            .count();
    }
    assert_eq!(pictures, 1);
}

#[test]
fn what_a_stop_or_the_end_left_undone_is_noted() {
    let report = run(r#"
        settings: (duration: 1),
        bodies: { "ball": Balls() },
        cannons: { "cannon": () },
        timeline: [
            (at: 0.2, do: Push(of: "cannon#3", impulse: (0, 1, 0))),
            (at: 0.3, do: Stop),
            (at: 0.6, do: Fire("cannon")),
        ],
        expectations: [(probe: Count(Bodies), expect: Near(value: 1, tolerance: 0))]"#);
    report.assert_passed();
    let expected =
        ["timeline[2]: the scene was over before", "`cannon#3` never came to be pinned, let go or pushed"];
    assert_eq!(report.notes, expected);
}

/// A timeline that was set while it ran went out of bounds.
#[test]
fn what_cannot_change_or_be_kept_is_refused() {
    let error = |event: &str| {
        let text = format!(
            r#"(version: 1, bodies: {{ "ball": Balls() }}, timeline: [{event}, (at: 0.1, do: Stop)])"#
        );
        SceneScript::parse(&text).expect_err("it cannot be").to_string()
    };
    for (event, words) in [
        (r#"(at: 0.5, do: Set("timeline", []))"#, "does not change"),
        (r#"(at: 0.5, do: Set("expectations[0].expect", 1))"#, "does not change"),
        (r#"(at: 0, do: Checkpoint("start"))"#, "before the first step"),
        (
            r#"(when: Measured(probe: Position(of: "ball", axis: Y, since: 0), expect: AtMost(-0.5)), do: Stop)"#,
            "no `since`",
        ),
    ] {
        let error = error(event);
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn contacts_are_told_until_they_are_set_not_to_be() {
    let report = run(r#"
        settings: (duration: 1),
        bodies: {
            "one": Cloth(size: (0.3, 0.3), particles: (4, 4), pins: None, at: (0, 0.5, 0), contacts: true),
            "two": Cloth(size: (0.3, 0.3), particles: (4, 4), pins: None, at: (2, 0.5, 0), contacts: true),
        },
        obstacles: { "ground": (shape: Ground) },
        timeline: [(at: 0, do: Set("one.contacts", false))],
        expectations: [
            (probe: Contacts(of: "one"), expect: AtMost(0)),
            (probe: Contacts(of: "two"), expect: AtLeast(1)),
        ]"#);
    report.assert_passed();
}
