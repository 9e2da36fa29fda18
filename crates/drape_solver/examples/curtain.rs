//! A ball hits a curtain above the ground, without an engine: `cargo run --release -p drape_solver --example curtain`.

use drape_solver::glam::Vec3;
use drape_solver::state::measure::stretch;
use drape_solver::{Ball, BallMaterial, BodySettings, ClothBuilder, Edge, Obstacle, World};

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let mut world = World::new();
    world.add_obstacle(Obstacle::ground());

    // 2 m x 1.5 m, pinned along its top edge two metres above the ground.
    let curtain = ClothBuilder::new(2.0, 1.5, 32, 24)
        .placed(Vec3::new(-1.0, 2.0, 0.0), Vec3::X, Vec3::NEG_Y)
        .pin_edge(Edge::Top)
        .build(BodySettings { drag: 1.0, ..BodySettings::default() })?;
    let curtain = world.add_body(curtain);
    let (place, velocity) = (Vec3::new(0.0, 1.2, -3.0), Vec3::new(0.0, 2.0, 8.0));
    let ball = world.add_ball(Ball::new(BallMaterial::default(), place, velocity)?);

    println!("time (s)   ball height (m)   deflection (cm)   stretch (%)   active bodies");
    for step in 0..=900 {
        if step % 60 == 0 {
            let (ball, cloth) = (&world[ball], &world[curtain]);
            let deflection = cloth.particles.positions().map(|p| p.z.abs()).fold(0.0, f32::max);
            println!(
                "{:8.2}{:18.3}{:18.1}{:14.2}{:16}",
                world.time(),
                ball.position().y,
                deflection * 100.0,
                stretch(&cloth.particles, &cloth.topology).rms * 100.0,
                world.counts().active,
            );
        }
        world.step()?;
    }
    Ok(())
}
