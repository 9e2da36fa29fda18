//! Apps, steps and figures that the tests share.

use std::time::Duration;

use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::Activity;
use bevy_drape::cannon::CannonFired;
use bevy_drape::contact::BallHit;
use bevy_drape::prelude::*;
use bevy_drape::sleep::ActivityCounts;
use drape_solver::StateHasher;
use drape_solver::state::measure;

/// Length of a step in seconds.
pub const STEP: f32 = 1.0 / 60.0;

/// Size of gravity in m/s^2, as the plugin has it by default.
pub const GRAVITY: f32 = 9.81;

/// All hits so far.
#[derive(Resource, Default)]
pub struct Hits(pub Vec<BallHit>);

/// All shots so far.
#[derive(Resource, Default)]
pub struct Shots(pub Vec<CannonFired>);

/// Nothing but the plugin, ready to step.
pub fn app() -> App {
    app_with(DrapePlugins::default())
}

/// The same, with the plugin's steps in `schedule`.
pub fn app_in(schedule: impl ScheduleLabel) -> App {
    app_with(DrapePlugins::new(schedule))
}

fn app_with(plugins: DrapePlugins) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, plugins))
        .insert_resource(Time::<Fixed>::from_seconds(1.0 / 60.0))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
        .init_resource::<Hits>()
        .init_resource::<Shots>()
        .add_systems(Last, collect);
    // The first update takes no time and so no step.
    app.update();
    app
}

fn collect(
    mut hit: MessageReader<BallHit>,
    mut fired: MessageReader<CannonFired>,
    mut hits: ResMut<Hits>,
    mut shots: ResMut<Shots>,
) {
    hits.0.extend(hit.read());
    shots.0.extend(fired.read());
}

/// Takes `count` steps.
pub fn step(app: &mut App, count: usize) {
    for _ in 0..count {
        app.update();
    }
}

/// Takes the steps of `seconds` seconds.
pub fn run(app: &mut App, seconds: f32) {
    step(app, (seconds / STEP).round() as usize);
}

/// Makes an update last `seconds` of the wall clock.
pub fn frame_time(app: &mut App, seconds: f32) {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(seconds)));
}

/// The component `C` of `entity`.
pub fn get<C: Component>(app: &App, entity: Entity) -> &C {
    app.world().get::<C>(entity).expect("the component")
}

/// The component `C` of `entity`, to be changed.
pub fn get_mut<C: Component<Mutability = bevy::ecs::component::Mutable>>(
    app: &mut App,
    entity: Entity,
) -> Mut<'_, C> {
    app.world_mut().get_mut::<C>(entity).expect("the component")
}

/// The activity of `entity`: simulated, at rest or culled.
pub fn activity(app: &App, entity: Entity) -> Activity {
    *get::<Activity>(app, entity)
}

/// The counts of active, resting and culled bodies.
pub fn counts(app: &App) -> (usize, usize, usize) {
    let counts = app.world().resource::<ActivityCounts>();
    (counts.active, counts.resting, counts.culled)
}

/// The bits of bodies and balls, in this order.
pub fn hash(app: &App, entities: &[Entity]) -> u64 {
    let mut hasher = StateHasher::new();
    for &entity in entities {
        if let Some(particles) = app.world().get::<Particles>(entity) {
            hasher.particles(particles);
        }
        if let Some(ball) = app.world().get::<ProjectileState>(entity) {
            hasher.ball(ball);
        }
    }
    hasher.finish()
}

/// Root mean square speed of the free particles, in m/s.
pub fn speed(app: &App, body: Entity) -> f32 {
    measure::mean_square_speed(get::<Particles>(app, body)).sqrt()
}

/// Centre of mass of the free particles, in metres.
pub fn centre(app: &App, body: Entity) -> Vec3 {
    let particles = get::<Particles>(app, body);
    let free = || (0..particles.len()).filter(|&i| !particles.is_pinned(i));
    free().map(|i| particles.position(i)).sum::<Vec3>() / free().count() as f32
}

/// The position of a ball in metres.
pub fn ball_position(app: &App, ball: Entity) -> Vec3 {
    get::<ProjectileState>(app, ball).position()
}

/// The refusals of `entity`, in the words of the log.
pub fn refusals(app: &App, entity: Entity) -> Vec<String> {
    app.world().resource::<Refusals>().of(entity).map(ToString::to_string).collect()
}

/// Sets gravity to zero.
pub fn weightless(app: &mut App) {
    app.insert_resource(DrapeGravity(Vec3::ZERO));
}

/// A curtain of one metre by one with 9 x 9 particles, its top edge pinned.
pub fn curtain() -> Cloth {
    Cloth { size: Vec2::ONE, particles: UVec2::splat(9), ..default() }
}

/// The same, pinned nowhere.
pub fn free_cloth() -> Cloth {
    curtain().with_pins(ClothPins::None)
}

/// The drag of a heavy curtain, so that it hangs quietly soon.
pub fn quiet() -> BodySurface {
    BodySurface { drag: 3.0, ..default() }
}

/// The same without friction.
pub fn slippery() -> BodySurface {
    BodySurface { friction: 0.0, ..quiet() }
}

/// Without any drag.
pub fn dragless() -> BodySurface {
    BodySurface { drag: 0.0, ..default() }
}

/// Steps until `entity` is at rest. Panics after half a minute of simulated time.
pub fn settle(app: &mut App, entity: Entity) {
    for _ in 0..1800 {
        app.update();
        if activity(app, entity) == Activity::Resting {
            return;
        }
    }
    panic!("{entity} did not come to rest within 30 s");
}

/// Numbers that are no quantity.
pub const BAD: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

/// Spawns `bundle` beside a ball in free flight; asserts that it is refused in words that name `words`, and that the
/// ball flies on. Returns the app and the entity.
pub fn assert_refused(bundle: impl Bundle, words: &[&str]) -> (App, Entity) {
    let mut app = app();
    let witness = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(50.0, 0.0, 0.0))).id();
    let bad = app.world_mut().spawn(bundle).id();
    run(&mut app, 0.5);
    let messages = refusals(&app, bad);
    assert_eq!(messages.len(), 1, "{messages:?}");
    for word in [bad.to_string().as_str()].iter().chain(words) {
        assert!(messages[0].contains(word), "“{}” does not name {word}", messages[0]);
    }
    assert_eq!(app.world().resource::<Refusals>().iter().len(), 1);
    let fallen = -ball_position(&app, witness).y;
    assert!((fallen - 0.5 * GRAVITY * 0.25).abs() < 1e-3, "the witness fell {fallen} m");
    let counts = counts(&app);
    assert_eq!(counts.0, 1, "only the witness is active: {counts:?}");
    (app, bad)
}

/// Asserts that nothing is said about `entity` any more and that it is simulated.
pub fn assert_mended(app: &mut App, entity: Entity) {
    step(app, 3);
    assert_eq!(activity(app, entity), Activity::Active);
    let before = hash(app, &[entity]);
    step(app, 10);
    assert_ne!(hash(app, &[entity]), before, "it stands still");
    assert_eq!(activity(app, entity), Activity::Active);
}
