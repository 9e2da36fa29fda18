//! The same input gives the same bits, and the stages one by one give the bits of the step.

use drape_solver::glam::{IVec3, Quat, Vec3};
use drape_solver::parry3d::math::Pose;
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::parry3d::utils::Array2;
use drape_solver::{
    BallMaterial, BodySettings, ClothBuilder, Edge, Environment, Isa, Island, Obstacle, Placement, RigidBody,
    RopeBuilder, SelfContact, Shape, StructuralSolve, Threads, Wind, step, step_on,
};

use crate::bending_friction::hash_of_folds;
use crate::common::*;
use crate::lines::hash_of_sheet;
use crate::membrane::hash_of_elastic_sheet;
use crate::mesh::hash_of_mesh;
use crate::torn_lines::hash_of_torn_sheet;

/// A bit of everything: curtain, rope, balls, wind, moving and parry obstacles.
fn scene() -> (Island, Environment) {
    let curtain = ClothBuilder::new(1.5, 1.5, 16, 16)
        .placed(Vec3::new(-0.75, 2.0, 0.0), Vec3::X, Vec3::NEG_Y)
        .pin_edge(Edge::Top)
        .build(BodySettings::default())
        .expect("valid");
    let rope = RopeBuilder::new(Vec3::new(-1.0, 2.0, 0.5), Vec3::new(1.0, 2.0, 0.5), 21)
        .pin_start()
        .build(BodySettings::default())
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

/// The rotation about an axis of length 1, with the same bits on every machine.
fn turned(axis: Vec3, angle: f32) -> Quat {
    Quat::from_vec4((axis * libm::sinf(0.5 * angle)).extend(libm::cosf(0.5 * angle)))
}

fn turn(environment: &mut Environment, index: usize) {
    let rotation = turned(Vec3::Z, 0.05 * index as f32);
    environment.obstacles[1].move_to(Placement { translation: Vec3::new(0.0, 1.0, -0.4), rotation }, FRAME);
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

/// Scratch memory may be warm, cold or left over from another step.
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

/// The hash changes with one bit of input, and with the order of bodies.
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

/// A falling sheet with corner pins, tethers, friction and a sphere: all kernels that are compiled for each instruction
/// set. Large sheets are swept in strips, and none fills its cells.
fn sheet([columns, rows]: [u32; 2], structural: StructuralSolve, isa: Isa) -> (Island, Environment) {
    let settings = BodySettings { substeps: 4, structural, ..BodySettings::default() };
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
    for (size, structural) in each_with([[30, 21], [100, 90]], BOTH) {
        let hashes: Vec<u64> = Isa::available()
            .into_iter()
            .map(|isa| {
                let (mut island, environment) = sheet(size, structural, isa);
                for _ in 0..60 {
                    step(&mut island, &environment).expect("finite");
                }
                hash(&island)
            })
            .collect();
        assert!(hashes.windows(2).all(|pair| pair[0] == pair[1]), "{size:?}, {structural:?}: {hashes:x?}");
    }
}

/// The hash of a sheet after some steps. Its sphere moves, a sheet without pins does not drift, and the second corner of one
/// with a pull moves.
fn sheet_after(
    (size, is_pinned, is_pulled): (u32, bool, bool),
    structural: StructuralSolve,
    steps: usize,
    take: impl Fn(&mut Island, &Environment),
) -> u64 {
    let (mut island, mut environment) = sheet([size, size - 7], structural, Isa::detected());
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
    let kinds = [(100, true, false), (64, true, false), (64, false, false), (64, true, true)];
    for (kind, structural) in each_with(kinds, BOTH) {
        let [whole, staged] = [whole, step_staged].map(|take| sheet_after(kind, structural, 60, take));
        assert_eq!(whole, staged, "{kind:?}, {structural:?}");
    }
}

/// Claims this number of threads, and starts a new one for every join.
pub struct Fresh(pub usize);

impl Threads for Fresh {
    fn count(&self) -> usize {
        self.0
    }

    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        // It has no threads.
        if cfg!(target_family = "wasm") {
            one();
            other();
            return;
        }
        std::thread::scope(|scope| {
            scope.spawn(other);
            one();
        });
    }
}

/// Any number of threads may help, and may come at any time.
#[test]
fn every_number_of_threads_gives_the_same_bits() {
    let kinds = [(250, true, false), (250, false, false)];
    for (kind, structural) in each_with(kinds, BOTH) {
        let alone = sheet_after(kind, structural, 8, whole);
        for threads in [2, 3, 8] {
            let shared = sheet_after(kind, structural, 8, |island, environment| {
                step_on(island, environment, &Fresh(threads)).expect("finite");
            });
            assert_eq!(shared, alone, "{threads} threads, {kind:?}, {structural:?}");
        }
    }
}

/// Every shape of obstacle, at rest and moving, and every kind of contact: a large sheet over all of them, between two smaller
/// ones that touch it and themselves, and balls that bounce and fly.
fn all_contacts(isa: Isa) -> (Island, Environment) {
    let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2].map(|bit| 0.4 * bit as f32 - 0.2);
    let corners: Vec<Vec3> = (0..8).map(|i| Vec3::from(corner(i))).collect();
    let (vertices, triangles) = SharedShape::cuboid(0.15, 0.1, 0.2).as_cuboid().expect("one").to_trimesh();
    let roof = vec![Vec3::new(-0.2, 0.0, -0.2), Vec3::new(0.2, 0.0, -0.2), Vec3::new(0.0, 0.1, 0.3)];
    let heights = Array2::new(3, 3, (0..9).map(|i| (i * i % 5) as f32 * 0.1).collect());
    let part = SharedShape::cuboid(0.05, 0.2, 0.05);
    let beside = Pose::from_translation(Vec3::X * 0.15);
    let shapes = [
        SharedShape::ball(0.2),
        SharedShape::capsule_y(0.2, 0.02),
        SharedShape::capsule_x(0.2, 0.05),
        SharedShape::cuboid(0.2, 0.1, 0.01),
        SharedShape::cone(0.2, 0.15),
        SharedShape::convex_hull(&corners).expect("a cube"),
        SharedShape::trimesh(vertices, triangles).expect("a box"),
        SharedShape::trimesh(roof, vec![[0, 1, 2]]).expect("a triangle"),
        SharedShape::heightfield(heights, Vec3::new(0.5, 0.3, 0.5)),
        SharedShape::voxels(Vec3::splat(0.1), &[IVec3::ZERO, IVec3::X, IVec3::Y]),
        SharedShape::compound(vec![(Pose::IDENTITY, part.clone()), (beside, part)]),
    ];
    let mut obstacles = vec![Obstacle::ground()];
    obstacles.push(obstacle(Shape::Container { half_extents: Vec3::new(1.6, 3.0, 1.6) }, Vec3::ZERO, 0.2));
    for (i, shape) in shapes.into_iter().enumerate() {
        let at = Vec3::new((i % 4) as f32 * 0.6 - 0.9, 0.5, (i / 4) as f32 * 0.6 - 0.6);
        let shape = Shape::from_parry(shape).expect("a valid shape");
        obstacles.push(obstacle(shape, at, 0.4).with_restitution(0.5).expect("valid"));
    }
    let thrown = obstacle(Shape::Cuboid { half_extents: Vec3::splat(0.1) }, Vec3::new(0.4, 1.0, 0.3), 0.4);
    let body = RigidBody::new(0.3, Vec3::splat(0.002)).expect("a valid body");
    obstacles.push(thrown.with_rigid_body(body).reporting_reaction());
    let spread = |size: f32, count: u32, height: f32, self_contact: SelfContact| {
        let settings = BodySettings { substeps: 4, thickness: 0.01, self_contact, ..BodySettings::default() };
        let cloth = ClothBuilder::new(size, size, count, count).placed(
            Vec3::new(-0.5 * size, height, -0.5 * size),
            Vec3::X,
            Vec3::Z,
        );
        cloth.build(settings).expect("valid")
    };
    let bodies = vec![
        spread(2.4, 30, 0.75, SelfContact::Off),
        spread(1.0, 12, 0.85, SelfContact::On),
        spread(0.6, 12, 0.95, SelfContact::On),
    ];
    let mut island = Island { bodies, isa, ..Island::default() };
    let bouncing = BallMaterial { radius: 0.06, mass: 3.0, restitution: 0.8, ..BallMaterial::default() };
    for (x, speed) in [(-0.9, 4.0), (0.0, 12.0), (0.05, 2.0), (0.9, 20.0)] {
        island.balls.push(ball(bouncing, Vec3::new(x, 1.4 + 0.02 * speed, 0.1), Vec3::NEG_Y * speed));
    }
    (island, Environment { obstacles: obstacles.into(), ..gravity(FRAME) })
}

/// The hash after some steps in which every second obstacle moves, two of them fast.
fn all_contacts_after(steps: usize, isa: Isa, take: impl Fn(&mut Island, &Environment)) -> u64 {
    let (mut island, mut environment) = all_contacts(isa);
    let (mut touches, mut pairs, mut thrown) = (0, 0, 0);
    let last = environment.obstacles.len() - 1;
    for step in 1..=steps {
        environment.obstacles[last].fly(environment.gravity, FRAME);
        for i in (2..last).step_by(2) {
            let Placement { mut translation, .. } = environment.obstacles[i].placement();
            let rise = if i % 5 == 2 { 0.12 } else { 0.02 };
            translation.y += if step % 8 < 4 { rise } else { -rise };
            let rotation = turned(Vec3::Y, 0.1 * step as f32);
            environment.obstacles[i].move_to(Placement { translation, rotation }, FRAME);
        }
        take(&mut island, &environment);
        for moved in &island.moved {
            environment.obstacles[moved.obstacle].land(moved);
        }
        thrown += island.reactions.len();
        touches += island.touches.len();
        pairs += island.self_contact_counts().pairs;
    }
    assert!(touches > 0 && pairs > 0, "{touches} touches, {pairs} pairs of cloth");
    assert!(thrown > 0, "the box that was thrown must hit something");
    hash(&island)
}

#[test]
fn every_kind_of_contact_gives_the_same_bits_however_it_is_stepped() {
    let steps = 4;
    let alone = all_contacts_after(steps, Isa::detected(), whole);
    for isa in Isa::available() {
        assert_eq!(all_contacts_after(steps, isa, whole), alone, "{isa:?}");
    }
    for threads in [2, 3, 8] {
        let shared = all_contacts_after(steps, Isa::detected(), |island, environment| {
            step_on(island, environment, &Fresh(threads)).expect("finite");
        });
        assert_eq!(shared, alone, "{threads} threads");
    }
    assert_eq!(all_contacts_after(steps, Isa::detected(), step_staged), alone, "stage by stage");
}

/// On a machine with one instruction set, nothing else compares its bits with those of other machines.
#[test]
fn every_machine_ends_in_the_golden_bits() {
    let ends = [
        hash_after(180, whole),
        all_contacts_after(40, Isa::detected(), whole),
        sheet_after((100, true, false), StructuralSolve::Sweeps, 60, whole),
        sheet_after((64, true, true), StructuralSolve::Sweeps, 60, whole),
        hash_of_sheet(100, 90, Isa::detected()),
        hash_of_mesh(Isa::detected(), BodySettings { substeps: 4, ..BodySettings::default() }),
        hash_of_elastic_sheet(Isa::detected()),
        hash_of_folds(Isa::detected()),
        hash_of_torn_sheet(64, 48, Isa::detected()),
    ];
    let golden = [
        0x66d18c9c363f706d,
        0x56026ec619fb0d19,
        0x9450ab507696daa5,
        0xc00d243c8f36fb0b,
        0xeecbb9eda539708a,
        0x4c341edcf72d3427,
        0xda6b2467d76fb186,
        0xf477dbfdd8f105fc,
        0xc5d87a5ee5727112,
    ];
    assert!(
        ends == golden,
        "the scenes end in other bits than they used to, in {ends:#x?}. If that is meant on every machine, write the new ones here \
         and give the reason in the commit message"
    );
}
