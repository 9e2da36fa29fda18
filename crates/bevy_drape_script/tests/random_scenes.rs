//! Random scenes from the grammar of scene files: whatever they say, 200 steps of them go well.

mod random;

use bevy_drape::ball::ProjectileState;
use bevy_drape::prelude::*;
use bevy_drape_script::play::ScenePlay;
use bevy_drape_script::{SceneRunner, SceneScript};
use proptest::collection::vec;
use proptest::prelude::*;

use crate::random::{between, cases};

/// Steps of a scene.
const STEPS: u64 = 200;

fn number(range: core::ops::Range<f32>) -> impl Strategy<Value = String> {
    between(range.start, range.end).prop_map(|number| format!("{number:?}"))
}

fn vector(reach: f32) -> impl Strategy<Value = String> {
    (number(-reach..reach), number(-reach..reach), number(-reach..reach))
        .prop_map(|(x, y, z)| format!("({x}, {y}, {z})"))
}

fn turn() -> impl Strategy<Value = String> {
    (number(0.1..1.0), number(-1.0..1.0), number(-360.0..360.0))
        .prop_map(|(x, y, degrees)| format!("(axis: ({x}, {y}, 0.5), degrees: {degrees})"))
}

fn solver() -> impl Strategy<Value = String> {
    let quality = prop_oneof![Just("Low"), Just("Medium"), Just("High")];
    let contact = prop_oneof![2 => Just("Off"), 1 => Just("On")];
    (quality, number(0.0..5.0), number(0.0..2.0), number(0.0..0.05), contact).prop_map(
        |(quality, drag, friction, thickness, contact)| {
            format!(
                "(quality: {quality}, self_contact: {contact}), surface: (drag: {drag}, friction: {friction}, thickness: {thickness})"
            )
        },
    )
}

fn body() -> impl Strategy<Value = String> {
    let pins = prop_oneof![Just("None"), Just("Top"), Just("TopCorners"), Just("Left"), Just("Corners")];
    let tears = prop_oneof![
        Just("None".to_string()),
        number(0.01..1.0).prop_map(|strain| format!("(strain: {strain})"))
    ];
    let cloth = (vector(2.0), turn(), 2..12_u32, 2..12_u32, number(0.2..2.0), pins, solver(), vector(5.0), tears).prop_map(
        |(at, turn, columns, rows, size, pins, solver, velocity, tears)| {
            format!(
                "Cloth(at: {at}, turn: {turn}, particles: ({columns}, {rows}), size: ({size}, 1), pins: {pins}, \
                 solver: {solver}, velocity: {velocity}, tearable: {tears})"
            )
        },
    );
    let rope = (vector(2.0), 2..30_u32, any::<bool>(), any::<bool>(), solver()).prop_map(
        |(start, particles, pin_start, pin_end, solver)| {
            format!(
                "Rope(start: {start}, end: (3, 0, 0), particles: {particles}, pin_start: {pin_start}, \
                 pin_end: {pin_end}, solver: {solver})"
            )
        },
    );
    let soft = (vector(2.0), turn(), 1..4_u32, any::<bool>(), solver()).prop_map(|(at, turn, rings, pin_rim, solver)| {
        format!("SoftBall(at: {at}, turn: {turn}, rings: {rings}, pin_rim: {pin_rim}, solver: {solver}, tearable: (strain: 0.3))")
    });
    let rig = (vector(2.0), number(0.01..10.0), any::<bool>(), solver()).prop_map(|(at, mass, pinned, solver)| {
        format!(
            "Rig(at: {at}, particles: {{ \"a\": (pinned: {pinned}), \"b\": (at: (1, 0, 0), mass: {mass}), \"c\": (at: (0, 1, 0)) }}, \
             sticks: [(a: \"a\", b: \"b\"), (a: \"b\", b: \"c\", kind: Shear)], solver: {solver})"
        )
    });
    let balls = (vector(2.0), vector(30.0), number(0.02..0.5), number(0.01..50.0), 1..4_u32, number(0.0..1.0)).prop_map(
        |(at, velocity, radius, mass, count, restitution)| {
            format!(
                "Balls(at: {at}, velocity: {velocity}, radius: {radius}, mass: {mass}, restitution: {restitution}, \
                 copies: (count: ({count}, 1, 2), scatter: 0.1))"
            )
        },
    );
    let size = || number(0.1..1.0);
    let closed = prop_oneof![
        (size(), 0..3_u32)
            .prop_map(|(radius, divisions)| format!("Sphere(radius: {radius}, divisions: {divisions})")),
        (size(), size()).prop_map(|(x, z)| format!("Cuboid(size: ({x}, 0.5, {z}))")),
    ];
    let open = size().prop_map(|x| {
        format!("Triangles(vertices: [(0, 0, 0), ({x}, 0, 0), (0, 1, 0), ({x}, 1, 0.2)], triangles: [(0, 1, 2), (2, 1, 3)])")
    });
    let pressure = prop_oneof![Just("None".to_string()), number(0.0..3.0)];
    let sheet = (prop_oneof![2 => closed.clone(), 1 => open], vector(2.0), turn(), pressure, 0..4_u32, solver(), vector(5.0)).prop_map(
        |(mesh, at, turn, pressure, pin, solver, velocity)| {
            format!(
                "ClothMesh(mesh: {mesh}, at: {at}, turn: {turn}, pressure: {pressure}, pins: [{pin}], solver: {solver}, velocity: {velocity}, \
                 tearable: (strain: 0.4))"
            )
        },
    );
    let solid = (closed, vector(2.0), turn(), number(0.0..1.0), number(0.0..2.0), solver(), vector(5.0)).prop_map(
        |(mesh, at, turn, stiffness, pressure, solver, velocity)| {
            format!(
                "SoftBody(mesh: {mesh}, at: {at}, turn: {turn}, stiffness: {stiffness}, pressure: {pressure}, solver: {solver}, velocity: {velocity})"
            )
        },
    );
    prop_oneof![3 => cloth, 1 => rope, 1 => soft, 1 => rig, 2 => balls, 1 => sheet, 1 => solid]
}

fn obstacle() -> impl Strategy<Value = String> {
    let size = || number(0.1..2.0);
    let shape = prop_oneof![
        Just("Ground".to_string()),
        size().prop_map(|radius| format!("Sphere(radius: {radius})")),
        (size(), size()).prop_map(|(radius, length)| format!("Capsule(radius: {radius}, length: {length})")),
        (size(), size(), size()).prop_map(|(bottom, top, length)| format!(
            "TaperedCapsule(bottom_radius: {bottom}, top_radius: {top}, length: {length})"
        )),
        (size(), size(), size()).prop_map(|(x, y, z)| format!("Cuboid(size: ({x}, {y}, {z}))")),
        (size(), size()).prop_map(|(radius, height)| format!("Cylinder(radius: {radius}, height: {height})")),
        (size(), size()).prop_map(|(radius, height)| format!("Cone(radius: {radius}, height: {height})")),
        size().prop_map(|x| format!("RoundCuboid(size: (1, 1, {x}), radius: 0.04)")),
        size().prop_map(|x| format!(
            "ConvexHull(points: [({x}, 0, 0), (0, 1, 0), (0, 0, 1), (0, -1, 0), (0, 0, -1)])"
        )),
        size().prop_map(|y| format!(
            "Mesh(vertices: [(-1, 0, -1), (1, 0, -1), (0, {y}, 1)], triangles: [(0, 1, 2)])"
        )),
        size().prop_map(|y| format!("HeightField(size: (3, 3), heights: [[0, {y}, 0], [0, 0, {y}]])")),
        size().prop_map(|side| format!("Voxels(side: {side}, cubes: [(0, 0, 0), (1, 0, 0), (0, 1, -1)])")),
        size().prop_map(|r| format!(
            "Compound(parts: [(shape: Sphere(radius: {r})), (shape: Cuboid(size: (1, 1, 1)), at: (1, 0, 0))])"
        )),
    ];
    let motion = prop_oneof![
        2 => Just("Static".to_string()),
        1 => (vector(3.0), number(-360.0..360.0))
            .prop_map(|(velocity, turn)| format!("Steady(velocity: {velocity}, degrees_per_second: {turn})")),
        1 => (vector(2.0), vector(2.0))
            .prop_map(|(a, b)| format!("Keyframes(keys: [(time: 0.5, at: {a}), (time: 1, at: {b})], repeat: true)")),
        1 => (number(0.01..100.0), vector(5.0))
            .prop_map(|(mass, velocity)| format!("Dynamic(mass: {mass}, inertia: (1, 1, 1), velocity: {velocity})")),
    ];
    (shape, motion, vector(2.0), turn(), number(0.0..2.0), any::<bool>()).prop_map(
        |(shape, motion, at, turn, friction, sensor)| {
            format!("(shape: {shape}, motion: {motion}, at: {at}, turn: {turn}, friction: {friction}, sensor: {sensor}, contacts: {sensor})")
        },
    )
}

fn event() -> impl Strategy<Value = String> {
    let body = || prop_oneof![Just("a"), Just("b")];
    let action = prop_oneof![
        Just("Fire(\"cannon\")".to_string()),
        vector(20.0).prop_map(|aim| format!("Aim(cannon: \"cannon\", aim: Point{aim}, speed: 40)")),
        vector(20.0).prop_map(|wind| format!("SetWind{wind}")),
        (body(), vector(3.0)).prop_map(|(of, impulse)| format!("Push(of: \"{of}\", impulse: {impulse})")),
        body().prop_map(|of| format!("Despawn(\"{of}\")")),
        body().prop_map(|of| format!("Spawn(\"{of}\")")),
        Just("Spawn(\"solid\")".to_string()),
        Just("Despawn(\"solid\")".to_string()),
        number(0.0..2.0).prop_map(|friction| format!("Set(\"solid.friction\", {friction})")),
        vector(20.0).prop_map(|gravity| format!("Set(\"settings.gravity\", {gravity})")),
        (1..20_u32).prop_map(|substeps| format!("Set(\"settings.solver.substeps\", {substeps})")),
        (vector(2.0), vector(2.0))
            .prop_map(|(tip, way)| format!("Cut(from: ({tip}, (0, 2, 0)), to: ({way}, {tip}))")),
        vector(2.0).prop_map(|tip| format!(
            "Cut(of: \"sheet\", from: ((-2, 1, -1), (-2, 1, 1)), to: ({tip}, (2, 1, 1)))"
        )),
        Just("Unpin(of: \"sheet#2\")".to_string()),
        Just("Despawn(\"fan\")".to_string()),
        Just("Spawn(\"fan\")".to_string()),
        number(0.0..5.0).prop_map(|speed| format!("Set(\"settings.wind.gusts.speed\", {speed})")),
        Just("Pin(of: \"sheet\")".to_string()),
        Just("Unpin(of: \"sheet\", particles: Pinned)".to_string()),
        vector(2.0).prop_map(|to| format!(
            "Drag(of: \"sheet\", point: Middle, path: [(0.2, {to}), (0.5, (0, 0, 0))])"
        )),
        (2..9_u32).prop_map(|columns| format!("Set(\"sheet.particles\", [{columns}, 3])")),
    ];
    let moment = prop_oneof![
        3 => number(0.0..3.0).prop_map(|time| format!("at: {time}")),
        1 => Just("when: Hit()".to_string()),
        1 => Just("when: Resting(\"sheet\")".to_string()),
    ];
    (moment, action).prop_map(|(moment, action)| format!("({moment}, do: {action})"))
}

prop_compose! {
    fn scene()(
        a in body(),
        b in body(),
        solid in obstacle(),
        other in obstacle(),
        events in vec(event(), 0..8),
        seed in any::<u64>(),
    ) -> String {
        format!(r#"(
    version: 1,
    settings: (duration: 3.3333333, seed: {seed}),
    bodies: {{ "a": {a}, "b": {b}, "sheet": Cloth(size: (1, 1), particles: (9, 9), at: (0, 1, 0)) }},
    obstacles: {{ "solid": {solid}, "other": {other} }},
    winds: {{ "fan": (flow: Outwards(8), at: (0.5, 1, 0)) }},
    cannons: {{ "cannon": (at: (0, 1, 3)) }},
    timeline: [{events}],
    expectations: [(when: Always, probe: Energy(kind: Kinetic), expect: AtMost(1e12))],
)"#, events = events.join(", "))
    }
}

proptest! {
    #![proptest_config(ProptestConfig { max_shrink_iters: 200, ..cases(32) })]

    #[test]
    fn no_random_scene_breaks_a_run(text in scene()) {
        let script = SceneScript::parse(&text).map_err(|error| TestCaseError::fail(error.to_string()))?;
        let written = script.to_ron().expect("it can be written");
        prop_assert_eq!(&SceneScript::parse(&written).expect("it reads again"), &script);
        let mut worst = None;
        let report = SceneRunner::headless(script).run_with(|world, step| {
            let play = world.resource::<ScenePlay>();
            for (name, body) in play.bodies(world) {
                let is_finite = world.get::<Particles>(body).is_none_or(|body| body.is_finite())
                    && world.get::<ProjectileState>(body).is_none_or(|ball| ball.is_finite());
                if !is_finite && worst.is_none() {
                    worst = Some((name, step));
                }
            }
        });
        prop_assert_eq!(worst, None);
        prop_assert_eq!(report.steps, STEPS);
        prop_assert!(report.passed(), "{}", report.complaint());
    }
}
