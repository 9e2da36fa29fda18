//! Bad input, faults of the device, and limits.

use drape_gpu::{Gpu, GpuError, GpuWorld, MAX_OBSTACLES};
use drape_solver::glam::Vec3;
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::{
    BendingRigidity, BodySettings, ClothBuilder, ClothMaterial, Environment, SelfContact, Shape,
    SoftBallBuilder,
};

use crate::common::*;

/// A body whose particle flies to infinity stays finite, and is reported; the others go on.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_particle_that_is_not_finite_is_kept_in_quarantine() {
    for n in [8, 40] {
        let mut sick = level(n, Vec3::ZERO, BodySettings::default());
        sick.particles.set_velocity(3, Vec3::splat(3e38));
        let mut world = GpuWorld::new(gpu());
        let [sick, sound] = [sick, level(n, Vec3::ZERO, BodySettings::default())]
            .map(|body| world.add(&body).expect("a body"));
        let mut was_noticed = false;
        for _ in 0..30 {
            run(&mut world, &gravity(), 1);
            was_noticed |= world.read_status(sick).expect("a body").expect("stepped").has_fault;
            assert!(positions(&world, sick).iter().all(|place| place.length() < 1e7));
        }
        assert!(was_noticed, "{n}");
        let fallen = centre(&positions(&world, sound)).y;
        assert!((fallen + 1.0).abs() < 0.2, "{n}: the sound one fell to {fallen}");
        assert!(!world.read_status(sound).expect("a body").expect("stepped").has_fault);
    }
}

/// Bodies that the shaders do not solve are refused by name, and so is bad input; nothing moves.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn what_cannot_be_solved_is_refused_by_name() {
    let mut world = GpuWorld::new(gpu());
    let sheet = level(8, Vec3::ZERO, BodySettings::default());
    let mut touching = sheet.clone();
    touching.settings.self_contact = SelfContact::On;
    let mut bad = sheet.clone();
    bad.settings.substeps = 0;
    let rigid =
        ClothMaterial { bending_rigidity: BendingRigidity::isotropic(1e-5), ..ClothMaterial::default() };
    let rigid =
        ClothBuilder::new(1.0, 1.0, 20, 20).material(rigid).build(BodySettings::default()).expect("valid");
    let mut ball = SoftBallBuilder::new(Vec3::ZERO, 0.3, 2).build(BodySettings::default()).expect("valid");
    ball.pressure = 1.0;
    for (body, word) in
        [(touching, "self-contact"), (bad, "substeps"), (rigid, "rigidity"), (ball, "pressure")]
    {
        let error = world.add(&body).expect_err(word).to_string();
        assert!(error.contains(word), "{error}");
    }
    let id = world.add(&sheet).expect("a body");
    let open = SharedShape::trimesh(vec![Vec3::ZERO, Vec3::Z, Vec3::X], vec![[0, 1, 2]]).expect("a triangle");
    let open = Shape::from_parry(open).expect("a shape");
    let environment = Environment { obstacles: vec![obstacle(open, Vec3::ZERO, 0.5)].into(), ..gravity() };
    for bad in [
        Environment { dt: 0.0, ..gravity() },
        Environment { dt: f32::NAN, ..gravity() },
        Environment { gravity: Vec3::NAN, ..gravity() },
    ] {
        assert!(matches!(world.step(&bad), Err(GpuError::Step(_))));
    }
    let ball = || obstacle(Shape::Sphere { radius: 0.1 }, Vec3::ZERO, 0.5);
    assert_eq!(positions(&world, id), sheet.particles.positions().collect::<Vec<_>>());
    assert!(world.left_out().is_empty());
    run(&mut world, &environment, 2);
    let [(0, reason)] = world.left_out() else { panic!("one obstacle has no inside") };
    assert!(reason.to_string().contains("open mesh"), "{reason}");
    let crowd: Vec<_> = (0..=MAX_OBSTACLES).map(|_| ball()).chain([ball().as_sensor()]).collect();
    run(&mut world, &Environment { obstacles: crowd.into(), ..gravity() }, 1);
    let [(MAX_OBSTACLES, reason)] = world.left_out() else { panic!("one obstacle too many") };
    assert!(matches!(reason, GpuError::Limit { needed: 1025, limit: 1024, .. }), "{reason}");
    world.remove(id).expect("it is there");
    assert_eq!(world.read_positions(id), Err(GpuError::NoSuchBody));
    assert_eq!(world.remove(id), Err(GpuError::NoSuchBody));
    run(&mut world, &gravity(), 2);
    assert!(world.is_empty());
}

/// After a loss of the device steps and reading fail with a word, and nothing panics.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_lost_device_is_an_error() {
    let gpu = Gpu::open().expect("an adapter");
    let mut world = GpuWorld::new(&gpu);
    let id = world.add(&level(8, Vec3::ZERO, BodySettings::default())).expect("a body");
    run(&mut world, &gravity(), 2);
    gpu.device().destroy();
    assert!(matches!(gpu.wait(), Err(GpuError::Lost(_))));
    assert!(matches!(world.step(&gravity()), Err(GpuError::Lost(_))));
    assert!(matches!(world.read_positions(id), Err(GpuError::Lost(_))));
}

/// A limit of the device that is too low is named, with its value.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_limit_of_the_device_is_named() {
    let few = limited(|limits| limits.max_storage_buffers_per_shader_stage = 8).map(drop);
    assert!(matches!(
        few,
        Err(GpuError::Limit { needed: 10, limit: 8, name: "maxStorageBuffersPerShaderStage", .. })
    ));
    let small = limited(|limits| limits.max_storage_buffer_binding_size = 1 << 20).expect("a device");
    let mut world = GpuWorld::new(&small);
    let error =
        world.add(&level(300, Vec3::ZERO, BodySettings::default())).expect_err("too large").to_string();
    assert!(error.contains("maxStorageBufferBindingSize") && error.contains("1048576"), "{error}");
    assert!(world.is_empty());
    let id = world.add(&level(30, Vec3::ZERO, BodySettings::default())).expect("there is room for this one");
    run(&mut world, &gravity(), 2);
    assert!(positions(&world, id)[0].y < 0.0);
}
