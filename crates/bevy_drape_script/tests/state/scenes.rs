//! A world with a bit of everything, for tests of recordings and checkpoints.

use std::io::Write;
use std::sync::{Arc, Mutex};

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::ball::ProjectileState;
use bevy_drape::clock::DrapeClock;
use bevy_drape::drape_solver::StateHasher;
use bevy_drape::prelude::*;
use bevy_drape::snapshot::members;
use bevy_drape_script::recording::{Header, RecordSteps};

/// Length of a step in seconds.
pub const STEP: f32 = 1.0 / 60.0;

/// An obstacle that goes round and round.
#[derive(Component)]
struct Carousel;

fn turn(mut obstacles: Query<&mut Transform, With<Carousel>>, clock: Res<DrapeClock>) {
    for mut transform in &mut obstacles {
        let (sin, cos) = (2.0 * clock.elapsed() as f32).sin_cos();
        *transform = Transform::from_xyz(0.3 * cos, 0.6, 0.3 * sin).with_rotation(Quat::from_rotation_y(cos));
    }
}

/// A curtain, a cape that touches itself, a rope, a ball, a post, the ground, and if `is_moving` an obstacle that
/// goes round and one that flies. It has taken one step.
pub fn world(is_moving: bool) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
        .insert_resource(Time::<Fixed>::from_seconds(f64::from(STEP)))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    let world = app.world_mut();
    if is_moving {
        // Flies into the curtain.
        world.spawn((
            Name::new("crate"),
            Obstacle::cuboid(0.2, 0.2, 0.2),
            DynamicObstacle { velocity: Vec3::NEG_Z * 2.0, ..DynamicObstacle::cuboid(0.5, Vec3::splat(0.2)) },
            Transform::from_xyz(0.4, 1.4, -0.5),
        ));
    }
    let quiet = BodySurface { drag: 3.0, ..default() };
    let touching = SolverSettings { self_contact: SelfContact::On, ..default() };
    world.spawn((Name::new("ground"), Obstacle::ground().with_friction(0.8)));
    world.spawn((
        Name::new("post"),
        Carousel,
        Obstacle::capsule(0.15, 0.4).with_friction(0.6),
        Transform::from_xyz(0.0, 0.6, 0.0),
    ));
    world.spawn((
        Name::new("curtain"),
        Cloth::new(1.2, 1.0).with_particles(23, 19),
        quiet,
        Transform::from_xyz(0.0, 1.5, -1.0),
    ));
    world.spawn((
        Name::new("cape"),
        Cloth::new(0.8, 0.8).with_particles(15, 15).with_pins(ClothPins::None),
        touching,
        BodySurface { thickness: 0.01, friction: 0.4, ..quiet },
        Transform::from_xyz(0.0, 1.2, 0.0).with_rotation(Quat::from_rotation_x(1.4)),
    ));
    world.spawn((
        Name::new("rope"),
        Rope::new(Vec3::new(-1.0, 1.5, 0.5), Vec3::new(-0.2, 1.5, 0.5), 25),
        touching,
        quiet,
    ));
    world.spawn((
        Name::new("ball"),
        Projectile { radius: 0.1, mass: 0.5, velocity: Vec3::new(0.5, 0.0, -4.0), ..default() },
        Transform::from_xyz(0.0, 1.2, 0.0),
    ));
    if is_moving {
        app.add_systems(FixedUpdate, turn);
    }
    app.update();
    app.update();
    app
}

/// Shoots at the curtain.
pub fn fire(app: &mut App) {
    let ball = Projectile { radius: 0.12, mass: 1.0, velocity: Vec3::new(0.2, 1.0, -6.0), ..default() };
    app.world_mut().spawn((ball, Transform::from_xyz(-0.3, 1.1, 0.5)));
}

/// The bits of all bodies and balls.
pub fn hash(app: &mut App) -> u64 {
    let mut hasher = StateHasher::new();
    for (_, entity) in members(app.world_mut()) {
        let entity = app.world().entity(entity);
        if let Some(particles) = entity.get::<Particles>() {
            hasher.particles(particles);
        }
        if let Some(ball) = entity.get::<ProjectileState>() {
            hasher.ball(ball);
        }
    }
    hasher.finish()
}

#[derive(Clone, Default)]
struct Memory(Arc<Mutex<Vec<u8>>>);

impl Write for Memory {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().expect("nobody panicked").extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// The world, recorded for so many steps, with a shot and a wind; and where the curtain is in the end.
pub fn recorded(steps: usize, wind: f32) -> (Vec<u8>, Vec<Vec3>) {
    let mut app = world(true);
    app.world_mut().resource_mut::<Wind>().velocity = Vec3::X * wind;
    let memory = Memory::default();
    let header = Header { scene: "all of it".into(), dt: STEP };
    RecordSteps::new(memory.clone(), header).expect("memory").start(&mut app);
    for step in 0..steps {
        if step == 20 {
            fire(&mut app);
        }
        app.update();
    }
    RecordSteps::finish(app.world_mut()).expect("memory");
    let mut curtains = app.world_mut().query::<(&Name, &Particles)>();
    let curtain = curtains.iter(app.world()).find(|(name, _)| name.as_str() == "curtain");
    let last = curtain.map(|(_, particles)| particles.positions().collect()).unwrap_or_default();
    let bytes = memory.0.lock().expect("nobody panicked").clone();
    (bytes, last)
}
