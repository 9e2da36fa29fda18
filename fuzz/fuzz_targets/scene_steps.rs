//! Builds a scene from the fuzzer's choices and edits it while it runs: 200 steps without a panic or NaN.
//!
//! The scene is written as text, and the parser must accept it.

#![no_main]

use core::fmt::Write;

use bevy_drape::ball::ProjectileState;
use bevy_drape::prelude::*;
use bevy_drape_script::play::ScenePlay;
use bevy_drape_script::{SceneRunner, SceneScript};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let text = scene(&mut Choices(bytes));
    let script = match SceneScript::parse(&text) {
        Ok(script) => script,
        Err(error) => panic!("{error}\n{text}"),
    };
    let mut runner = SceneRunner::headless(script);
    for _ in 0..200 {
        runner.step();
    }
    let world = runner.world();
    let bodies = world.get_resource::<ScenePlay>().map(|play| play.bodies(world)).unwrap_or_default();
    for (name, entity) in bodies {
        if let Some(particles) = world.get::<Particles>(entity) {
            assert!(particles.is_finite(), "{name} is not finite in\n{text}");
        }
        if let Some(ball) = world.get::<ProjectileState>(entity) {
            assert!(ball.is_finite(), "{name} is not finite in\n{text}");
        }
    }
});

/// The fuzzer's bytes as choices, then zeros.
struct Choices<'a>(&'a [u8]);

impl Choices<'_> {
    fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    /// A number below `count`.
    fn below(&mut self, count: u8) -> u8 {
        self.byte() % count
    }

    fn of<'t>(&mut self, texts: &[&'t str]) -> &'t str {
        texts[usize::from(self.below(texts.len() as u8))]
    }

    /// A position with coordinates from -2 to 2 in steps of an eighth.
    fn place(&mut self) -> String {
        let mut axis = || f32::from(self.below(33)) / 8.0 - 2.0;
        format!("({}, {}, {})", axis(), axis(), axis())
    }

    /// A size from a thousandth to a million, more often near one.
    fn size(&mut self) -> &'static str {
        self.of(&["1", "0.5", "0.1", "2", "0.2", "0.05", "1", "0.3", "0.001", "20", "1e3", "1e6"])
    }

    fn velocity(&mut self) -> String {
        let speed = self.of(&["0", "1", "-1", "5", "-20", "100", "-300", "0.01"]);
        let [a, b] = [0; 2].map(|_| self.of(&["0", "1", "-3", "30"]));
        format!("({a}, {speed}, {b})")
    }

    /// Settings of the solver, and a surface.
    fn solver(&mut self) -> String {
        let substeps = self.of(&["8", "1", "2", "4", "16"]);
        let iterations = self.of(&["2", "1", "4"]);
        let drag = self.of(&["0.6", "0", "3", "100"]);
        let friction = self.of(&["0.5", "0", "1", "50"]);
        let thickness = self.of(&["0.005", "0", "0.02", "0.3"]);
        let structural = self.of(&["Sweeps", "Lines"]);
        let self_contact = self.of(&["Off", "On"]);
        let tethers = self.of(&["true", "false"]);
        format!(
            "(substeps: {substeps}, iterations: {iterations}, structural: {structural}, self_contact: {self_contact}, \
             tethers: {tethers}), surface: (drag: {drag}, friction: {friction}, thickness: {thickness})"
        )
    }
}

const NAMES: [&str; 4] = ["a", "b", "c", "d"];

fn scene(c: &mut Choices) -> String {
    let mut text = String::from("(version: 1, settings: (duration: 3, ");
    let gravity = c.of(&["(0, -9.81, 0)", "(0, 0, 0)", "(300, 0, 0)", "(0, -1000, 0)"]);
    let wind = c.of(&["(0, 0, 0)", "(3, 0, 1)", "(-60, 10, 0)"]);
    let dt = c.of(&["0.0166666667", "0.001", "0.05", "0.1"]);
    let _ = write!(text, "gravity: {gravity}, wind: (velocity: {wind}), dt: {dt}), bodies: {{ ");
    let bodies: Vec<String> = (0..=c.below(NAMES.len() as u8)).map(|_| body(c)).collect();
    for (name, body) in NAMES.iter().zip(&bodies) {
        let _ = write!(text, "\"{name}\": {body}, ");
    }
    text += "}, obstacles: { ";
    for number in 0..c.below(3) {
        let _ = write!(text, "\"o{number}\": {}, ", obstacle(c));
    }
    text += "}, timeline: [";
    for _ in 0..c.below(6) {
        let chosen = usize::from(c.below(bodies.len() as u8));
        // Balls have no particles to pin.
        let first = if bodies[chosen].starts_with("Balls") { 2 } else { 0 };
        let _ =
            write!(text, "(at: {}.{}, do: {}), ", c.below(3), c.below(10), action(c, NAMES[chosen], first));
    }
    text + "])"
}

fn body(c: &mut Choices) -> String {
    let present = c.of(&["true", "true", "true", "false"]);
    match c.below(3) {
        0 => format!(
            "Cloth(size: ({}, {}), particles: ({}, {}), areal_density: {}, bend_stiffness: {}, pins: {}, at: {}, velocity: {}, solver: {}, present: {present})",
            c.size(),
            c.size(),
            2 + c.below(9),
            2 + c.below(9),
            c.size(),
            c.of(&["0", "0.1", "1"]),
            c.of(&["Top", "None", "TopCorners", "Left", "Corners"]),
            c.place(),
            c.velocity(),
            c.solver(),
        ),
        1 => format!(
            "Rope(start: {}, end: {}, particles: {}, linear_density: {}, pin_end: {}, velocity: {}, solver: {}, present: {present})",
            c.place(),
            // Never at its start, which is at most 2 m high.
            format_args!("({}, 3, 0)", c.below(5)),
            2 + c.below(60),
            c.size(),
            c.of(&["false", "true"]),
            c.velocity(),
            c.solver(),
        ),
        _ => format!(
            "Balls(at: {}, velocity: {}, radius: {}, mass: {}, restitution: {}, friction: {}, present: {present})",
            c.place(),
            c.velocity(),
            c.size(),
            c.size(),
            c.of(&["0", "0.5", "1"]),
            c.of(&["0.5", "0", "10"]),
        ),
    }
}

fn obstacle(c: &mut Choices) -> String {
    let shape = match c.below(8) {
        0 => "Ground".to_string(),
        1 => format!("Sphere(radius: {})", c.size()),
        2 => format!("Capsule(radius: {}, length: {})", c.size(), c.size()),
        3 => format!("Cuboid(size: ({}, {}, {}))", c.size(), c.size(), c.size()),
        4 => format!("Container(size: ({}, {}, {}))", c.size(), c.size(), c.size()),
        5 => format!("Cylinder(radius: {}, height: {})", c.size(), c.size()),
        6 => format!("Cone(radius: {}, height: {})", c.size(), c.size()),
        _ => format!(
            "TaperedCapsule(bottom_radius: {}, top_radius: {}, length: {})",
            c.size(),
            c.size(),
            c.size()
        ),
    };
    format!("(shape: {shape}, at: {}, friction: {})", c.place(), c.of(&["0.5", "0", "5"]))
}

/// An action on a body or on the whole world, of a kind from `first` on.
fn action(c: &mut Choices, name: &str, first: u8) -> String {
    match first + c.below(7 - first) {
        0 => format!("Pin(of: \"{name}\")"),
        1 => format!("Unpin(of: \"{name}\")"),
        2 => format!("Push(of: \"{name}\", impulse: {})", c.velocity()),
        3 => format!("Spawn(\"{name}\")"),
        4 => format!("Despawn(\"{name}\")"),
        5 => format!("SetWind{}", c.velocity()),
        _ => format!("Set(\"settings.gravity\", {})", "[0, 5, 0]"),
    }
}
