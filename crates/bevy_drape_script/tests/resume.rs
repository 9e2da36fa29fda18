//! A scene goes on from a checkpoint as if it had never stopped: to the bit, with its timeline, drags, counts and verdicts.

use bevy::ecs::message::{MessageCursor, Messages};
use bevy_drape_script::checkpoint::{Checkpoint, CheckpointError};
use bevy_drape_script::play::CheckpointTaken;
use bevy_drape_script::{Report, SceneRunner, SceneScript};

/// The rows of the cloths are as wide as the solver's vectors: where they are not, it counts speeds of places between rows that no
/// particle is at, which a snapshot does not keep, and an island may form a step earlier or later.
///
/// Shots, drags, pushes, changes, and what comes and goes, on both sides of the checkpoints.
const SCENE: &str = r#"(
    version: 1,
    settings: (duration: 3),
    parameters: { "fine": (default: (13, 11), sets: ["curtain.particles"]) },
    bodies: {
        "curtain": Cloth(size: (1.2, 1), at: (0, 1.5, 0), contacts: true),
        "slashed": Cloth(size: (1, 1), particles: (16, 16), at: (-4, 2, 0)),
        "rope": Rope(start: (1, 2, 0), end: (1.8, 2, 0), particles: 16, velocity: (0, 0, 1)),
        "pair": Rig(particles: { "a": (at: (-1.5, 2, 0), pinned: true), "b": (at: (-1, 2, 0)) }, sticks: [(a: "a", b: "b")]),
        "balls": Balls(at: (0, 3, 0.3), radius: 0.05, mass: 0.2, copies: (count: (2, 1, 1))),
        "late": Cloth(size: (0.5, 0.5), particles: (16, 8), pins: None, at: (0, 2.5, 0.5), present: false),
        "brief": Balls(at: (3, 1, 0), present: false),
    },
    obstacles: {
        "ground": (shape: Ground),
        "post": (shape: Capsule(radius: 0.1, length: 1), at: (0.3, 0.8, 0.2), motion: Steady(velocity: (0, 0, -0.2))),
        "box": (shape: Cuboid(size: (0.2, 0.2, 0.2)), at: (-0.3, 2.4, -0.3), motion: Dynamic(mass: 0.5)),
        "awning": (shape: Cuboid(size: (0.2, 0.2, 0.2)), at: (9, 9, 9)),
        "step": (shape: Cuboid(size: (1, 0.2, 1)), at: (0, 0.1, 0), present: false),
    },
    cannons: { "cannon": (at: (0, 1, 3), aim: Point(0, 1.5, 0), speed: 8, ball: (radius: 0.06, mass: 0.3)) },
    timeline: [
        (at: 0.2, repeat: (every: 0.6, times: 4), do: Fire("cannon")),
        (at: 0.45, do: Cut(of: "slashed", from: ((-5, 2.1, -1), (-5, 2.1, 1)), to: ((-3.9, 2.1, -1), (-3.9, 2.1, 1)))),
        (at: 0.5, do: Checkpoint("shot")),
        (at: 0.6, do: Drag(of: "curtain", point: Last, path: [(0, (0, 0, 0)), (0.8, (0.3, 0.2, 0.3))])),
        (at: 0.7, do: Spawn("late")),
        (at: 0.75, do: Spawn("step")),
        (at: 0.8, do: Spawn("brief")),
        (at: 0.55, do: Despawn("awning")),
        (at: 0.9, do: Set("settings.wind.velocity", (1, 0, 0))),
        (at: 1, do: Checkpoint("dragged")),
        (at: 1, do: Fire("cannon")),
        (at: 0.95, do: Cut(of: "slashed", from: ((-5, 1.8, -1), (-5, 1.8, 1)), to: ((-3, 1.9, -1), (-3, 1.9, 1)))),
        (at: 1.1, do: Pause(0.2)),
        (at: 1.15, do: Cut(of: "slashed", from: ((-5, 2.3, -1), (-5, 2.3, 1)), to: ((-3, 2.3, -1), (-3, 2.3, 1)))),
        (at: 1.2, do: Despawn("rope")),
        (at: 1.3, do: Despawn("brief")),
        (when: Hit(of: "cannon", on: "curtain"), do: Push(of: "pair", impulse: (0, 0, 1))),
        (when: Measured(probe: Hits(of: "cannon"), expect: AtLeast(3)), do: Checkpoint("triggered")),
        (at: 2, do: Unpin(of: "curtain")),
        (at: 2.1, do: Set("curtain.surface.drag", 4)),
        (at: 2.3, do: Checkpoint("fallen")),
        (at: 2.4, do: Pin(of: "curtain", particles: Particles([0, 1]))),
    ],
    expectations: [
        (when: Always, probe: Position(of: "curtain", axis: Y), expect: AtLeast(1.3)),
        (when: Eventually(within: 1.5), probe: Hits(of: "cannon", on: "curtain"), expect: AtLeast(1)),
        (probe: Position(of: "curtain", point: Last, axis: X, since: 0.4), expect: Reported),
        (when: During(0.3, 2.5), probe: Energy(kind: Kinetic), expect: Reported),
        (probe: Contacts(of: "curtain"), expect: Reported),
        (probe: Touching(of: "curtain"), expect: Reported),
        (probe: Hits(of: "cannon#2"), expect: Reported),
        (probe: Activity(of: "late"), expect: Reported),
    ],
)"#;

/// Runs to the end; the checkpoints that were taken on the way, as they come back from bytes.
fn run(mut runner: SceneRunner) -> (Report, Vec<(String, Checkpoint)>) {
    let mut cursor = MessageCursor::<CheckpointTaken>::default();
    let mut taken = Vec::new();
    let mut goes_on = true;
    while goes_on {
        goes_on = runner.step();
        for CheckpointTaken { name, checkpoint } in
            cursor.read(runner.world().resource::<Messages<CheckpointTaken>>())
        {
            let bytes = checkpoint.to_bytes().expect("small enough");
            taken.push((name.clone(), Checkpoint::from_bytes(&bytes).expect("just written")));
        }
    }
    (runner.report(), taken)
}

#[test]
fn a_scene_goes_on_from_a_checkpoint_with_the_same_bits() {
    let script = SceneScript::parse(SCENE).unwrap_or_else(|error| panic!("{error}"));
    let (whole, taken) = run(SceneRunner::headless(script));
    println!("{whole}");
    let names: Vec<&str> = taken.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names.len(), 4, "{names:?}");
    for (name, checkpoint) in &taken {
        let runner = SceneRunner::resume(checkpoint).unwrap_or_else(|error| panic!("{name}: {error}"));
        let (rest, again) = run(runner);
        assert_eq!(rest.state_hash, whole.state_hash, "{name}");
        assert_eq!(rest.verdicts, whole.verdicts, "{name}");
        assert_eq!((rest.steps, &rest.problems), (whole.steps, &whole.problems), "{name}");
        // It takes itself again, and what comes after it.
        let from = names.iter().position(|known| known == name).expect("its own name");
        assert_eq!(again.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), names[from..], "{name}");
    }
}

/// Quick save and quick load. Obstacles were numbered on, and the scene was gone.
#[test]
fn a_checkpoint_is_loaded_into_the_world_that_it_was_taken_of() {
    let script = SceneScript::parse(SCENE).unwrap_or_else(|error| panic!("{error}"));
    let mut runner = SceneRunner::headless(script.clone());
    while runner.step() {}
    let hash = runner.report().state_hash;
    let (_, taken) = run(SceneRunner::headless(script));
    for (name, checkpoint) in &taken[..2] {
        checkpoint.resume(runner.world_mut()).unwrap_or_else(|error| panic!("{name}: {error}"));
        while runner.step() {}
        assert_eq!(runner.report().state_hash, hash, "{name}");
    }
}

#[test]
fn a_checkpoint_without_a_scene_is_not_resumed() {
    let script = SceneScript::parse("(version: 1, bodies: { \"ball\": Balls() })").expect("a scene");
    let mut runner = SceneRunner::headless(script);
    runner.step();
    let bare = Checkpoint::take(runner.world_mut(), "bare");
    let error = SceneRunner::resume(&bare).err().expect("no scene in it");
    assert!(matches!(error, CheckpointError::NoPlay), "{error}");
}
