//! Ropes and cloth whose particles are joined to obstacles with rigid bodies: each pulls at the other.

use drape_solver::glam::{BVec3, DVec3, Quat, Vec3};
use drape_solver::{
    Body, BodySettings, ClothBuilder, Environment, Island, Placement, RigidBody, RopeBuilder, Shape, step,
};

use crate::common::*;

/// A particle that is joined to an obstacle: particle, obstacle, and the place in the obstacle's frame.
type Joint = (usize, usize, Vec3);

/// A body among boxes that it is joined to.
struct Scene {
    island: Island,
    environment: Environment,
    joints: Vec<Joint>,
}

/// A body with a particle pinned, so that it can be joined.
fn pinned(mut body: Body, particle: usize) -> Body {
    body.particles.set_inverse_mass(particle, 0.0);
    body
}

impl Scene {
    fn new(body: Body, environment: Environment) -> Self {
        Self { island: Island::of_body(body), environment, joints: Vec::new() }
    }

    fn with_box(mut self, at: Vec3, body: RigidBody) -> Self {
        let shape = Shape::Cuboid { half_extents: Vec3::splat(HALF) };
        self.environment.obstacles.push(obstacle(shape, at, 0.5).with_rigid_body(body).reporting_reaction());
        self
    }

    fn with_joint(mut self, particle: usize, obstacle: usize, anchor: Vec3) -> Self {
        self.joints.push((particle, obstacle, anchor));
        self
    }

    fn step(&mut self) {
        self.fly_and_join();
        step(&mut self.island, &self.environment).expect("a good step");
        self.land();
    }

    fn fly_and_join(&mut self) {
        let Self { island, environment, joints } = self;
        let (gravity, dt) = (environment.gravity, environment.dt);
        for index in 0..environment.obstacles.len() {
            environment.obstacles[index].fly(gravity, dt);
        }
        for &(particle, obstacle, anchor) in &*joints {
            island.bodies[0].particles.join(particle, obstacle, anchor);
        }
    }

    fn land(&mut self) {
        let Self { island, environment, .. } = self;
        for moved in &island.moved {
            environment.obstacles[moved.obstacle].land(moved);
        }
    }

    fn place(&self, index: usize) -> Placement {
        self.environment.obstacles[index].placement()
    }

    fn body(&self, index: usize) -> RigidBody {
        self.environment.obstacles[index].rigid_body().expect("it has one")
    }

    fn boxes(&self) -> impl Iterator<Item = (Placement, RigidBody)> {
        (0..self.environment.obstacles.len()).map(|index| (self.place(index), self.body(index)))
    }

    /// The greatest distance in metres between a particle and the point that it is joined to.
    fn gap(&self) -> f32 {
        let gap = |&(particle, obstacle, anchor): &Joint| {
            let place = self.place(obstacle);
            let joint = place.translation + place.rotation * anchor;
            particles(&self.island).position(particle).distance(joint)
        };
        self.joints.iter().map(gap).fold(0.0, f32::max)
    }

    fn motion(&self) -> Motion {
        let boxes = || self.boxes();
        Motion {
            linear: momentum(&self.island) + boxes().map(|(_, body)| momentum_of(body)).sum::<DVec3>(),
            angular: angular_momentum(&self.island)
                + boxes().map(|(place, body)| angular_momentum_of(body, place)).sum::<DVec3>(),
            energy: kinetic_energy(&self.island)
                + boxes().map(|(place, body)| f64::from(body.kinetic_energy(place))).sum::<f64>(),
        }
    }

    /// Takes a step, and asserts that momentum is kept, no energy gained since `start`, and no joint gapes.
    #[track_caller]
    fn step_and_compare(&mut self, start: &Motion, what: &str) {
        self.step();
        let Motion { linear, angular, energy } = self.motion();
        let lost = (linear - start.linear).length() / start.linear.length();
        assert!(lost < 1e-5, "{what}: {lost} of the momentum");
        let lost = (angular - start.angular).length() / start.linear.length();
        assert!(lost < 0.01, "{what}: {lost} m of angular momentum");
        let gained = energy / start.energy;
        assert!(gained < 1.001, "{what}: {gained} of the energy");
        assert!(self.gap() < 1e-5, "{what}: the joint gapes by {} m", self.gap());
    }
}

/// The motion of everything in a scene.
struct Motion {
    linear: DVec3,
    angular: DVec3,
    energy: f64,
}

/// A rope of one metre and 0.1 kg that hangs from a pin, and whose end may be joined.
fn hanging_rope(particles: u32, settings: BodySettings) -> Body {
    let rope = RopeBuilder::new(Vec3::ZERO, Vec3::NEG_Y, particles).pin(0).build(settings).expect("valid");
    pinned(rope, particles as usize - 1)
}

/// A box at the end of a rope, from a tenth of the rope's mass to a thousand times that, hangs still at the rope's length,
/// and the rope carries its weight.
#[test]
fn a_box_hangs_at_the_end_of_a_rope() {
    for structural in BOTH {
        for mass in [0.01, 0.1, 1.0, 10.0, 100.0] {
            let what = format!("{mass} kg, {structural:?}");
            let rope = hanging_rope(40, BodySettings { structural, ..BodySettings::default() });
            let mut scene = Scene::new(rope, gravity(FRAME))
                .with_box(Vec3::NEG_Y * (1.0 + HALF), cube(mass))
                .with_joint(39, 0, Vec3::Y * HALF);
            let mut given = 0.0;
            for index in 0..360 {
                scene.step();
                assert!(scene.gap() < 1e-6, "{what}: the joint gapes by {} m", scene.gap());
                if index >= 240 {
                    given += scene.island.reactions.iter().map(|r| r.impulse.y).sum::<f32>();
                }
            }
            let stretch = -scene.place(0).translation.y - HALF - 1.0;
            assert!(stretch.abs() < 1e-3, "{what}: {stretch} m too long");
            let weight = mass * G * 120.0 * FRAME;
            assert!((given / weight - 1.0).abs() < 2e-3, "{what}: {given} N s carried, not {weight}");
        }
    }
}

/// A rope of 0.1 kg on which a box of 50 kg swings is straight. With sweeps and tethers alone it swung through sideways, as if it
/// were slack.
#[test]
fn a_rope_under_a_heavy_box_swings_straight() {
    let along = Quat::from_rotation_z(1.0) * Vec3::NEG_Y;
    let rope = RopeBuilder::new(Vec3::ZERO, along, 40).pin(0).build(swept()).expect("valid");
    let scene = Scene::new(pinned(rope, 39), gravity(FRAME)).with_box(along, cube(50.0));
    let mut scene = scene.with_joint(39, 0, Vec3::ZERO);
    for index in 0..120 {
        scene.step();
        let particles = particles(&scene.island);
        let end = particles.position(39);
        let off = |i| particles.position(i).reject_from(end).length();
        let most = (0..40).map(off).fold(0.0, f32::max);
        assert!(most < 0.02, "{most} m off the straight line at step {index}");
    }
}

/// A box on a massless stick is a double pendulum: its slow mode has the period that the linear equations give.
///
/// ```text
///   o pin           l, a    lengths of the stick, and from the joint to the centre of the box
///   | l             k       radius of gyration of the box about its centre
///   x joint         | g l - w^2 l^2     -w^2 l a              |
///  [|] a            | -w^2 l a          g a - w^2 (a^2 + k^2) |  = 0
/// ```
#[test]
fn a_box_on_a_stick_swings_with_the_period_of_a_double_pendulum() {
    let (length, arm) = (0.8_f64, f64::from(HALF));
    let gyration = (2.0 * arm).powi(2) / 6.0;
    let g = f64::from(G);
    // With u = w^2: u^2 l^2 k^2 - u g l (l a + a^2 + k^2) + g^2 l a = 0, divided by l.
    let [a, b, c] = [length * gyration, -g * (length * arm + arm * arm + gyration), g * g * arm];
    let square = (-b - (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
    // The part of the box's angle in the slow mode, per angle of the stick.
    let turn = (g - square * length) / (square * arm);
    for mass in [0.1, 10.0] {
        let small = 0.02;
        let (stick, tilt) = (Quat::from_rotation_z(small), Quat::from_rotation_z(small * turn as f32));
        let joint = stick * (Vec3::NEG_Y * length as f32);
        let settings = BodySettings { substeps: 16, iterations: 2, ..bare() };
        let body = joined(&[Vec3::ZERO, joint], &[0.0, 0.0], &[[0, 1]], settings);
        let at = joint + tilt * (Vec3::NEG_Y * HALF);
        let mut scene =
            Scene::new(body, gravity(FRAME)).with_box(at, cube(mass)).with_joint(1, 0, Vec3::Y * HALF);
        scene.environment.obstacles[0].teleport(Placement { translation: at, rotation: tilt });
        let (mut crossings, mut last) = (Vec::new(), f64::from(at.x));
        for index in 0..600 {
            scene.step();
            let now = f64::from(scene.place(0).translation.x);
            if last * now < 0.0 {
                crossings.push((f64::from(index) + last / (last - now)) * f64::from(FRAME));
            }
            last = now;
        }
        let period = crossings[2] - crossings[0];
        let expected = core::f64::consts::TAU / square.sqrt();
        law(&format!("period of {mass} kg on a stick"), period, expected, 5e-3);
    }
}

/// A box flies off, the rope behind it comes taut and pulls another box along. Momentum is kept to 1e-5, angular momentum
/// to 1 %, and no energy is gained, from a hundredth to a hundred times the mass of the other box.
#[test]
fn two_boxes_on_a_rope_keep_momentum_and_gain_no_energy() {
    for structural in BOTH {
        for mass in [0.04, 0.4, 4.0, 40.0, 400.0] {
            let what = format!("{mass} kg, {structural:?}");
            let settings = BodySettings { structural, drag: 0.0, ..BodySettings::default() };
            let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X, 40).build(settings).expect("valid");
            let mut body = cube(mass);
            (body.velocity, body.angular_velocity) = (Vec3::new(2.0, 1.0, 0.5), Vec3::new(0.0, 1.0, -2.0));
            let mut scene = Scene::new(pinned(pinned(rope, 0), 39), weightless(FRAME))
                .with_box(Vec3::NEG_X * HALF, cube(4.0))
                .with_box(Vec3::X * (1.0 + HALF), body)
                .with_joint(0, 0, Vec3::X * HALF)
                .with_joint(39, 1, Vec3::new(-HALF, 0.0, 0.0));
            let mut longest = 0.0_f32;
            let start = scene.motion();
            for index in 0..60 {
                scene.step_and_compare(&start, &format!("{what}, step {index}"));
                let ends = [0, 39].map(|i| particles(&scene.island).position(i));
                longest = longest.max(ends[0].distance(ends[1]));
            }
            assert!(longest < 1.0001, "{what}: the rope of 1 m is {longest} m long");
            let pulled = scene.body(0).velocity.length();
            assert!(pulled > 0.01 * mass.min(4.0), "{what}: the other box goes at {pulled} m/s");
        }
    }
}

/// A whole edge of a cloth is joined to a bar: all its particles together pull no more than one would. Momentum, energy
/// and joints hold as for ropes.
#[test]
fn a_cloth_joined_to_a_bar_along_its_edge_keeps_momentum_and_gains_no_energy() {
    for mass in [0.01, 0.3, 30.0] {
        let what = format!("{mass} kg");
        let settings = BodySettings { drag: 0.0, ..BodySettings::default() };
        let cloth = ClothBuilder::new(1.0, 1.0, 17, 17).placed(Vec3::ZERO, Vec3::X, Vec3::NEG_Y);
        let mut cloth = cloth.build(settings).expect("valid");
        let edge: Vec<usize> = (0..289).filter(|&i| cloth.particles.position(i).y == 0.0).collect();
        edge.iter().for_each(|&i| cloth.particles.set_inverse_mass(i, 0.0));
        let mut bar = RigidBody::new(mass, Vec3::new(0.001, 0.1, 0.1) * mass).expect("valid");
        (bar.velocity, bar.angular_velocity) = (Vec3::new(0.5, 3.0, 1.0), Vec3::new(0.5, 0.0, 1.0));
        let centre = Vec3::new(0.5, 0.2, 0.0);
        let mut scene = Scene::new(cloth, weightless(FRAME)).with_box(centre, bar);
        for i in edge {
            let anchor = particles(&scene.island).position(i) - centre;
            scene = scene.with_joint(i, 0, anchor);
        }
        let start = scene.motion();
        for index in 0..200 {
            scene.step_and_compare(&start, &format!("{what}, step {index}"));
        }
    }
}

/// What is joined to a point inside an obstacle passes its surface: a rope that is tied to the middle of a box hangs
/// straight, and the box at its end.
#[test]
fn a_rope_joined_to_the_middle_of_a_box_passes_its_surface() {
    let settings = BodySettings { thickness: 0.01, ..BodySettings::default() };
    let mut scene = Scene::new(hanging_rope(40, settings), gravity(FRAME))
        .with_box(Vec3::NEG_Y, cube(1.0))
        .with_joint(39, 0, Vec3::ZERO);
    (0..240).for_each(|_| scene.step());
    let place = scene.place(0).translation;
    assert!(place.distance(Vec3::NEG_Y) < 1e-3, "the box is at {place}");
}

/// A box that cannot move holds a rope as a pin does. It fell, as its axes were locked for pushes alone.
#[test]
fn a_locked_box_holds_its_rope_like_a_pin() {
    let rope = |settings| RopeBuilder::new(Vec3::ZERO, Vec3::X, 20).linear_density(2.0).build(settings);
    let rope = || pinned(rope(BodySettings::default()).expect("valid"), 0);
    let locked = cube(1.0).with_locked_axes(BVec3::TRUE, BVec3::TRUE);
    let scene = Scene::new(rope(), gravity(FRAME)).with_box(Vec3::ZERO, locked);
    let mut joined = scene.with_joint(0, 0, Vec3::ZERO);
    let mut island = Island::of_body(rope());
    for _ in 0..60 {
        joined.step();
        step(&mut island, &gravity(FRAME)).expect("a good step");
    }
    assert_eq!(joined.place(0).translation, Vec3::ZERO);
    let pair = joined.island.bodies[0].particles.positions().zip(island.bodies[0].particles.positions());
    pair.for_each(|(joined, pinned)| assert!(joined.distance(pinned) < 1e-4, "{joined}, not {pinned}"));
}

/// A step in stages has the bits of a whole one.
#[test]
fn joints_have_the_same_bits_stage_by_stage() {
    let scene = || {
        let scene = Scene::new(hanging_rope(40, BodySettings::default()), gravity(FRAME));
        scene.with_box(Vec3::new(0.1, -1.1, 0.0), cube(1.0)).with_joint(39, 0, Vec3::new(-0.1, 0.1, 0.0))
    };
    let [mut whole, mut staged] = [scene(), scene()];
    for _ in 0..60 {
        whole.step();
        staged.fly_and_join();
        step_staged(&mut staged.island, &staged.environment);
        staged.land();
    }
    assert_eq!(whole.place(0), staged.place(0));
    assert_eq!(whole.island.bodies[0].particles, staged.island.bodies[0].particles);
}
