//! Laws on the GPU.
use drape_gpu::{Gpu, GpuWorld};
use drape_solver::glam::Vec3;
use drape_solver::{BodySettings, Body, ClothBuilder, Edge, Environment, Island, step, Obstacle, Shape, Placement};

fn compare(name: &str, body: Body, environment: Environment, steps: usize) {
    let gpu = Gpu::open().expect("adapter");
    let mut world = GpuWorld::new(&gpu);
    let id = world.add(&body).expect("fits");
    let mut island = Island::of_body(body);
    for k in 0..steps {
        let mut environment = environment.clone();
        environment.time = k as f64 * environment.dt as f64;
        world.step(&environment).expect("steps");
        step(&mut island, &environment).expect("steps");
        if k == 0 || k == 9 || k + 1 == steps {
            let ours = world.read_positions(id).expect("reads");
            let worst = ours.iter().zip(island.bodies[0].particles.positions()).map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
            println!("{name} step {k}: {worst:e} on {} bounds {:?}", gpu.adapter(), world.read_bounds(id));
        }
    }
}

#[test]
fn smoke() {
    let settings = BodySettings::default();
    let air = Environment::default();
    compare("small", ClothBuilder::new(1.0, 1.0, 16, 16).pin_edge(Edge::Top).build(settings).expect("valid"), Environment { gravity: Vec3::new(3.0, -9.81, 2.0), ..air.clone() }, 60);
    compare("mid", ClothBuilder::new(1.0, 1.0, 30, 30).pin_edge(Edge::Top).build(settings).expect("valid"), Environment { gravity: Vec3::new(3.0, -9.81, 2.0), ..air.clone() }, 60);
    let mut windy = air.clone();
    windy.wind = drape_solver::Wind::new(Vec3::new(2.0, 0.0, 5.0));
    windy.wind.lift_coefficient = 0.5;
    windy.wind.turbulence.speed = 2.0;
    compare("wind", ClothBuilder::new(1.0, 1.0, 16, 16).pin_edge(Edge::Left).build(settings).expect("valid"), windy.clone(), 60);
    let mut ball = air.clone();
    ball.obstacles = vec![Obstacle::new(Shape::Sphere { radius: 0.3 }, Placement::at(Vec3::new(0.5, -0.5, 0.0)), 0.5).expect("valid"), Obstacle::new(Shape::HalfSpace { normal: Vec3::Y }, Placement::at(Vec3::new(0.0, -1.5, 0.0)), 0.5).expect("valid")].into();
    let flat = |n| ClothBuilder::new(1.0, 1.0, n, n).placed(Vec3::ZERO, Vec3::X, Vec3::Z).build(settings).expect("valid");
    compare("ball", flat(16), ball.clone(), 60);
    compare("large", ClothBuilder::new(1.0, 1.0, 70, 60).pin_edge(Edge::Top).build(settings).expect("valid"), Environment { gravity: Vec3::new(3.0, -9.81, 2.0), ..air.clone() }, 60);
    compare("large wind", ClothBuilder::new(1.0, 1.0, 70, 60).pin_edge(Edge::Left).build(settings).expect("valid"), windy.clone(), 60);
    compare("large ball", flat(64), ball, 60);
}
