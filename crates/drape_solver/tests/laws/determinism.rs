//! Same input, same bits; and the stages one by one are the step.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::{
    BallMaterial, ClothBuilder, Edge, Environment, Isa, Island, Obstacle, Placement, RopeBuilder, Shape,
    SolverSettings, StateHasher, Threads, Wind, step, step_on,
};

use crate::common::*;

/// A bit of everything: curtain, rope, balls, wind, moving and parry obstacles.
fn scene() -> (Island, Environment) {
    let curtain = ClothBuilder::new(1.5, 1.5, 16, 16)
        .placed(Vec3::new(-0.75, 2.0, 0.0), Vec3::X, Vec3::NEG_Y)
        .pin_edge(Edge::Top)
        .build(SolverSettings::default())
        .expect("valid");
    let rope = RopeBuilder::new(Vec3::new(-1.0, 2.0, 0.5), Vec3::new(1.0, 2.0, 0.5), 21)
        .pin_start()
        .build(SolverSettings::default())
        .expect("valid");
    let mut island = Island { bodies: vec![curtain, rope], ..Island::default() };
    let material = BallMaterial::default();
    island.balls.push(ball(material, Vec3::new(0.1, 1.2, 2.0), Vec3::NEG_Z * 15.0));
    island.balls.push(ball(material, Vec3::new(0.2, 3.0, 0.3), Vec3::ZERO));
    let capsule = Shape::Capsule { half_length: 0.5, radius: 0.2 };
    let cylinder = Shape::Parry(SharedShape::cylinder(0.4, 0.3));
    let environment = Environment {
        wind: Wind::new(Vec3::new(1.0, 0.0, 2.0)),
        obstacles: vec![
            Obstacle::ground(),
            obstacle(capsule, Vec3::new(0.0, 1.0, -0.4), 0.5),
            obstacle(cylinder, Vec3::new(0.5, 0.5, -0.5), 0.5),
        ]
        .into(),
        ..gravity(FRAME)
    };
    (island, environment)
}

fn turn(environment: &mut Environment, index: usize) {
    let rotation = Quat::from_rotation_z(0.05 * index as f32);
    environment.obstacles[1].move_to(Placement { translation: Vec3::new(0.0, 1.0, -0.4), rotation }, FRAME);
}

fn hash(island: &Island) -> u64 {
    let mut hasher = StateHasher::new();
    for body in &island.bodies {
        hasher.particles(&body.particles);
    }
    for ball in &island.balls {
        hasher.ball(ball);
    }
    hasher.finish()
}

fn hash_after(steps: usize, mut take: impl FnMut(&mut Island, &Environment)) -> u64 {
    let (mut island, mut environment) = scene();
    for index in 0..steps {
        turn(&mut environment, index);
        take(&mut island, &environment);
    }
    hash(&island)
}

fn whole(island: &mut Island, environment: &Environment) {
    step(island, environment).expect("a good step");
}

/// Two runs give the same bits.
#[test]
fn two_runs_give_the_same_bits() {
    let first = hash_after(180, whole);
    assert_eq!(first, hash_after(180, whole));
    assert_ne!(first, hash_after(179, whole), "the hash tells states apart");
}

/// The stages one by one, as a schedule runs them, give the bits of the whole step.
#[test]
fn the_stages_one_by_one_are_the_step() {
    let staged = hash_after(120, step_staged);
    assert_eq!(staged, hash_after(120, whole));
}

/// Scratch memory that is warm, cold or left over from another step changes nothing.
#[test]
fn scratch_memory_has_no_part_in_the_result() {
    let cold = hash_after(60, |island, environment| {
        for body in &mut island.bodies {
            body.context = Default::default();
        }
        island.context = Default::default();
        whole(island, environment);
    });
    assert_eq!(cold, hash_after(60, whole));
}

/// One changed bit of input is seen in the hash, and what rests in the order of bodies is too.
#[test]
fn the_hash_sees_every_part_of_the_state() {
    let (island, _) = scene();
    let before = hash(&island);
    let mut changed = island.clone();
    changed.bodies[1].particles.set_velocity(3, Vec3::X * 1e-3);
    assert_ne!(hash(&changed), before);
    let mut changed = island.clone();
    changed.balls[1].set_spin(Vec3::Y * 1e-3);
    assert_ne!(hash(&changed), before);
    let mut changed = island.clone();
    changed.balls[0].set_rotation(Quat::from_rotation_x(1e-3));
    assert_ne!(hash(&changed), before);
    let mut changed = island;
    changed.bodies.swap(0, 1);
    assert_ne!(hash(&changed), before);
}

/// A falling sheet with corner pins, tethers, friction and a sphere: everything that is compiled for each instruction
/// set. Large ones are swept down their strips, and none fills its cells.
fn sheet(columns: u32, rows: u32, isa: Isa) -> (Island, Environment) {
    let settings = SolverSettings { substeps: 4, ..SolverSettings::default() };
    let sheet = ClothBuilder::new(2.0, 2.0, columns, rows)
        .placed(Vec3::new(-1.0, 1.0, -1.0), Vec3::X, Vec3::Z)
        .pin(0)
        .pin(columns - 1)
        .build(settings)
        .expect("valid");
    let cuboid = Shape::Cuboid { half_extents: Vec3::new(0.3, 0.2, 0.4) };
    let obstacles = vec![
        Obstacle::ground(),
        obstacle(Shape::Sphere { radius: 0.5 }, Vec3::new(0.0, 0.3, 0.0), 0.5),
        obstacle(cuboid, Vec3::new(0.6, 0.5, 0.6), 0.5),
    ];
    (Island { isa, ..Island::of_body(sheet) }, Environment { obstacles: obstacles.into(), ..gravity(FRAME) })
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    for (columns, rows) in [(30, 21), (100, 90)] {
        let hashes: Vec<u64> = Isa::available()
            .into_iter()
            .map(|isa| {
                let (mut island, environment) = sheet(columns, rows, isa);
                for _ in 0..60 {
                    step(&mut island, &environment).expect("finite");
                }
                hash(&island)
            })
            .collect();
        assert!(hashes.windows(2).all(|pair| pair[0] == pair[1]), "{columns} x {rows}: {hashes:x?}");
    }
}

/// The hash of a sheet after some steps. Its sphere moves; a sheet that is not pinned is free of drift; the second
/// corner of one that is pulled moves.
fn sheet_after(
    (size, is_pinned, is_pulled): (u32, bool, bool),
    steps: usize,
    take: impl Fn(&mut Island, &Environment),
) -> u64 {
    let (mut island, mut environment) = sheet(size, size - 7, Isa::detected());
    let particles = &mut island.bodies[0].particles;
    if !is_pinned {
        particles.set_inverse_mass(0, particles.inverse_mass(1));
        particles.set_inverse_mass(size as usize - 1, particles.inverse_mass(1));
    }
    for index in 0..steps {
        let translation = Vec3::new(0.0, 0.4 + 0.02 * index as f32, 0.0);
        environment.obstacles[1].move_to(Placement::at(translation), FRAME);
        if is_pulled {
            let particles = &mut island.bodies[0].particles;
            let target = particles.position(size as usize - 1) + Vec3::X * 0.01;
            particles.set_pin_target(size as usize - 1, target);
        }
        take(&mut island, &environment);
    }
    hash(&island)
}

#[test]
fn a_sweep_down_the_strips_gives_the_bits_of_whole_stages() {
    for kind in [(100, true, false), (64, true, false), (64, false, false), (64, true, true)] {
        assert_eq!(sheet_after(kind, 60, whole), sheet_after(kind, 60, step_staged), "{kind:?}");
    }
}

/// So many threads, started anew for every step.
struct Fresh(usize);

impl Threads for Fresh {
    fn count(&self) -> usize {
        self.0
    }

    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        std::thread::scope(|scope| {
            scope.spawn(other);
            one();
        });
    }
}

/// However many threads come to help, and whenever they do.
#[test]
fn every_number_of_threads_gives_the_same_bits() {
    for kind in [(250, true, false), (250, false, false)] {
        let alone = sheet_after(kind, 8, whole);
        for threads in [2, 3, 8] {
            let shared = sheet_after(kind, 8, |island, environment| {
                step_on(island, environment, &Fresh(threads)).expect("finite");
            });
            assert_eq!(shared, alone, "{threads} threads, {kind:?}");
        }
    }
}
