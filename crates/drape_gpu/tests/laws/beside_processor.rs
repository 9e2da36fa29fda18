//! The same scenes on the processor.

use drape_gpu::GpuWorld;
use drape_solver::glam::Vec3;
use drape_solver::{
    Body, BodySettings, ClothBuilder, ClothMaterial, Edge, Environment, Island, MeshClothBuilder,
    RopeBuilder, Shape, Turbulence, Wind, step,
};

use crate::common::*;

/// Takes `steps` steps.
fn run_on_processor(island: &mut Island, environment: &Environment, steps: usize) {
    let mut environment = environment.clone();
    for _ in 0..steps {
        step(island, &environment).expect("a good step");
        environment.time += f64::from(environment.dt);
    }
}

/// Positions of the island's body.
fn on_processor(island: &Island) -> Vec<Vec3> {
    island.bodies[0].particles.positions().collect()
}

/// In the first tenth of a second, before small differences grow, particles are where the processor has them: sticks are relaxed in the same
/// order, in workgroups, tiles and batches.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn the_first_steps_are_those_of_the_processor() {
    let tilted = Environment { gravity: Vec3::new(3.0, -9.81, 2.0), ..gravity() };
    let wind = Wind { lift_coefficient: 0.5, ..Wind::new(Vec3::new(2.0, 0.0, 5.0)) };
    // The processor interpolates gusts between places: long ones, so that it makes no difference.
    let turbulence = Turbulence { speed: 3.0, length: 3000.0, ..Turbulence::default() };
    let [windy, gusty] =
        [wind, Wind { turbulence, ..wind }].map(|wind| Environment { wind, ..tilted.clone() });
    for environment in [tilted, windy, gusty] {
        for (columns, rows) in [(16, 16), (30, 30), (70, 60), (33, 200)] {
            for iterations in [1, 2, 3] {
                let settings = BodySettings { iterations, ..swept() };
                let cloth = ClothBuilder::new(1.0, 1.0, columns, rows).pin_edge(Edge::Top);
                let body = cloth.build(settings).expect("valid");
                let (mut world, id) = world_of(&body);
                let mut island = Island::of_body(body);
                run(&mut world, &environment, 6);
                run_on_processor(&mut island, &environment, 6);
                let worst = farthest_apart(&positions(&world, id), &on_processor(&island));
                // Rounding differs from device to device.
                assert!(worst < 5e-4, "{columns} x {rows}, {iterations} iterations: {worst} m apart");
            }
        }
    }
}

/// A storm on thin cloth, which would be torn out of shape if it could get faster than the air, and particles far beyond their tethers, which would
/// leap back at once, begin as on the processor too.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn storms_and_leaps_begin_as_on_the_processor() {
    let thin = ClothMaterial { areal_density: 0.01, ..ClothMaterial::default() };
    let storm = Environment {
        wind: Wind { lift_coefficient: 1.0, ..Wind::new(Vec3::new(20.0, 0.0, 40.0)) },
        ..gravity()
    };
    for n in [14, 40] {
        let cloth = || ClothBuilder::new(1.0, 1.0, n, n).material(thin).pin_edge(Edge::Left);
        let blown = cloth().build(swept()).expect("valid");
        let mut torn = cloth().build(swept()).expect("valid");
        torn.particles.set_position(2 * n as usize - 1, Vec3::new(4.0, 0.0, 1.0));
        for (body, environment) in [(blown, &storm), (torn, &gravity())] {
            let (mut world, id) = world_of(&body);
            let mut island = Island::of_body(body);
            for _ in 0..2 {
                run(&mut world, environment, 1);
                step(&mut island, environment).expect("a good step");
            }
            let worst = farthest_apart(&positions(&world, id), &on_processor(&island));
            assert!(worst < 1e-3, "{n}: {worst} m apart");
        }
    }
}

/// So they are on a device with the least shared memory that there is, where a grid of 40 x 40 takes a dispatch for each batch.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn batches_move_a_grid_as_tiles_do() {
    let gpu = limited(|limits| limits.max_compute_workgroup_storage_size = 16_384).expect("a device");
    let environment = Environment { gravity: Vec3::new(3.0, -9.81, 2.0), ..gravity() };
    for n in [16, 27, 40] {
        let body = ClothBuilder::new(1.0, 1.0, n, n).pin_edge(Edge::Top).build(swept()).expect("valid");
        let mut world = GpuWorld::new(&gpu);
        let id = world.add(&body).expect("a body");
        let (mut tiled, other) = world_of(&body);
        for world in [&mut world, &mut tiled] {
            run(world, &environment, 6);
        }
        let worst = farthest_apart(&positions(&world, id), &positions(&tiled, other));
        assert!(worst < 1e-5, "{n} x {n}: {worst} m apart");
    }
}

/// Ten seconds later stretch agrees within 2 % and a tenth of a point, the centre (the potential energy) and the corners of the box within
/// 2 cm of a body of 1 m.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn after_six_hundred_steps_figures_are_those_of_the_processor() {
    let settings = swept();
    let sheet = |n| ClothBuilder::new(1.0, 1.0, n, n).pin(0).pin(n - 1).build(settings).expect("valid");
    let rope = RopeBuilder::new(Vec3::ZERO, Vec3::new(1.0, 0.0, 0.0), 64)
        .pin_start()
        .build(settings)
        .expect("valid");
    let scenes = [("many", sheet(16)), ("sheet", sheet(40)), ("ropes", rope), ("mesh", mesh(settings))];
    for (name, body) in scenes {
        let environment = Environment {
            obstacles: vec![obstacle(Shape::Sphere { radius: 0.3 }, Vec3::new(0.5, -0.6, 0.15), 0.5)].into(),
            ..gravity()
        };
        let (mut world, id) = world_of(&body);
        let mut island = Island::of_body(body.clone());
        run(&mut world, &environment, 600);
        run_on_processor(&mut island, &environment, 600);
        let ours = positions(&world, id);
        let theirs = on_processor(&island);
        let stretches = [stretch(&body, &ours), stretch(&body, &theirs)];
        assert!(
            (stretches[0] - stretches[1]).abs() < 1e-3 + 0.02 * stretches[1],
            "{name}: stretch {stretches:?}"
        );
        let centres = [centre(&ours), centre(&theirs)];
        assert!(centres[0].distance(centres[1]) < 0.02, "{name}: centres {centres:?}");
        let corner =
            |places: &[Vec3], of: fn(Vec3, Vec3) -> Vec3| places.iter().copied().reduce(of).expect("some");
        for of in [Vec3::min, Vec3::max] {
            let corners = [corner(&ours, of), corner(&theirs, of)];
            assert!(corners[0].distance(corners[1]) < 0.02, "{name}: corners {corners:?}");
        }
    }
}

/// A mesh of triangles whose corners lie unevenly, held at two corners.
fn mesh(settings: BodySettings) -> Body {
    let n = 36_u32;
    let uneven = |i: u32, j: u32| {
        let inner = |i| i > 0 && i + 1 < n;
        let shift = if inner(i) && inner(j) { 0.3 } else { 0.0 };
        let [x, z] = [(7 * i + 3 * j) % 5, (2 * i + 11 * j) % 7].map(|k| shift * (k as f32 / 6.0 - 0.4));
        Vec3::new(i as f32 + x, 0.0, j as f32 + z) / (n - 1) as f32
    };
    let places = (0..n * n).map(|k| uneven(k % n, k / n)).collect();
    let squares = (0..n * n).filter(|k| k % n + 1 < n && k / n + 1 < n);
    let faces: Vec<[u32; 3]> = squares.flat_map(|k| [[k, k + n, k + 1], [k + 1, k + n, k + n + 1]]).collect();
    MeshClothBuilder::new(places, faces).pin(0).pin(n - 1).build(settings).expect("a mesh")
}
