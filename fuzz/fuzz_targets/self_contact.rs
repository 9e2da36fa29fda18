//! Builds up to four small cloths from the fuzzer's choices, beside each other, and lets them fly, fall and fold for 40 steps: no
//! panic, no NaN, and no edge passes through a face, as none does at the start.

#![no_main]

use drape_solver::glam::{Quat, Vec3};
use drape_solver::state::crossings::CrossingCounter;
use drape_solver::state::measure;
use drape_solver::{
    Body, BodySettings, ClothBuilder, ClothMaterial, Environment, Island, Obstacle, Placement, SelfContact,
    Shape, step,
};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let (mut island, environment) = scene(&mut Choices(bytes));
    let mut counter = CrossingCounter::of(island.bodies.iter().map(|body| &*body.topology));
    let mut crossings = |island: &Island| {
        let corners: Vec<_> =
            island.bodies.iter().flat_map(|body| measure::positions(&body.particles)).collect();
        counter.count(&corners)
    };
    assert_eq!(crossings(&island), 0, "the scene begins without");
    for index in 0..40 {
        step(&mut island, &environment).expect("finite");
        assert_eq!(crossings(&island), 0, "after step {index}");
    }
});

/// Metres between the middles of neighbouring cloths: more than the greatest diagonal.
const APART: f32 = 0.75;

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

    fn of<T: Copy>(&mut self, values: &[T]) -> T {
        values[usize::from(self.below(values.len() as u8))]
    }

    /// A number from `-half` to `half`.
    fn about(&mut self, half: f32) -> f32 {
        half * (f32::from(self.byte()) / 127.5 - 1.0)
    }

    fn vector(&mut self, half: f32) -> Vec3 {
        Vec3::new(self.about(half), self.about(half), self.about(half))
    }
}

fn scene(c: &mut Choices) -> (Island, Environment) {
    let gravity = c.of(&[Vec3::NEG_Y * 9.81, Vec3::ZERO, Vec3::X * 100.0]);
    let dt = c.of(&[1.0 / 60.0, 0.005, 0.05]);
    let count = 1 + c.below(4);
    let bodies = (0..count).map(|place| cloth(c, f32::from(place) * APART)).collect();
    let obstacles: Vec<Obstacle> = (0..c.below(3)).map(|_| obstacle(c)).collect();
    let island = Island { bodies, ..Island::default() };
    (island, Environment { gravity, dt, obstacles: obstacles.into(), ..Environment::default() })
}

fn cloth(c: &mut Choices, x: f32) -> Body {
    let sizes = [0.4, 0.5, 0.2, 0.05];
    let (width, height) = (c.of(&sizes), c.of(&sizes));
    let turn = Quat::from_scaled_axis(c.vector(3.0));
    let (right, down) = (turn * Vec3::X, turn * Vec3::NEG_Y);
    let material = ClothMaterial {
        areal_density: c.of(&[0.25, 0.02, 2.0]),
        shear_stiffness: c.of(&[0.7, 0.0, 1.0]),
        bend_stiffness: c.of(&[0.1, 0.0, 0.5]),
        ..ClothMaterial::default()
    };
    let settings = BodySettings {
        substeps: c.of(&[8, 1, 4]),
        iterations: c.of(&[2, 1, 4]),
        friction: c.of(&[0.5, 0.0, 2.0]),
        thickness: c.of(&[0.005, 0.001, 0.02, 0.0001, 0.1]),
        self_contact: SelfContact::On,
        ..BodySettings::default()
    };
    let pins = c.byte();
    let mut cloth = ClothBuilder::new(width, height, 2 + u32::from(c.below(8)), 2 + u32::from(c.below(8)))
        .placed(Vec3::X * x - 0.5 * (width * right + height * down), right, down)
        .material(material)
        .pin_where(|column, row, _| match pins % 6 {
            0 => row == 0,
            1 => row == 0 && column == 0,
            2 => (column + row) % 5 == 0,
            _ => false,
        })
        .build(settings)
        .expect("valid");
    let most = c.of(&[2.0, 0.0, 10.0, 50.0]);
    let (flight, turning, closing) = (c.vector(most), c.vector(most), c.about(most));
    for i in 0..cloth.particles.len() {
        let from_middle = cloth.particles.position(i) - Vec3::X * x;
        let velocity = flight + (turning.cross(from_middle) + closing * from_middle) / 0.25;
        cloth.particles.set_velocity(i, velocity);
    }
    cloth
}

fn obstacle(c: &mut Choices) -> Obstacle {
    let size = c.of(&[0.1, 0.02, 0.3]);
    let shape = match c.below(3) {
        0 => Shape::HalfSpace { normal: Vec3::Y },
        1 => Shape::Sphere { radius: size },
        _ => Shape::Cuboid { half_extents: Vec3::splat(size) },
    };
    let middle = Vec3::new(1.0, -0.5, 0.0);
    Obstacle::new(shape, Placement::at(middle + c.vector(1.0)), c.of(&[0.5, 0.0, 2.0])).expect("valid")
}
