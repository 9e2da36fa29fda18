//! The schedule: its sets, their order, and systems of the user's own in it.

use bevy::ecs::schedule::{LogLevel, ScheduleBuildSettings, ScheduleLabel};
use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::Sticks;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;
use bevy_drape::schedule::{DrapeSchedule, DrapeSubsteps};
use drape_solver::{Backstop, PoseDrive};

use crate::common::*;

#[derive(Resource, Default)]
struct Record(Vec<DrapeSystems>);

fn record(set: DrapeSystems) -> impl Fn(ResMut<Record>) {
    move |mut record| record.0.push(set)
}

#[test]
fn the_sets_run_in_the_documented_order() {
    use DrapeSystems::*;
    let mut app = app();
    app.init_resource::<Record>();
    for set in [ManageScene, AccumulateForces, FormIslands, DetectCollisions, Substeps, Finish] {
        app.add_systems(DrapeSchedule, record(set).in_set(set));
    }
    for set in [Integrate, Relax, ProjectCollisions] {
        app.add_systems(DrapeSubsteps, record(set).in_set(set));
    }
    app.world_mut().spawn((curtain(), SolverSettings { substeps: 3, ..default() }));
    step(&mut app, 1);
    let mut order = core::mem::take(&mut app.world_mut().resource_mut::<Record>().0);
    // A system beside the substeps may run before them or after them.
    let beside = order.iter().position(|&set| set == Substeps).expect("it ran");
    assert!(beside > 3 && beside < order.len() - 1);
    order.remove(beside);
    let substep = [Integrate, Relax, ProjectCollisions];
    let expected = [
        &[ManageScene, AccumulateForces, FormIslands, DetectCollisions],
        substep.as_slice(),
        substep.as_slice(),
        substep.as_slice(),
        &[Finish],
    ];
    assert_eq!(order, expected.concat());
}

/// Height of the ball as each set sees it.
#[derive(Resource, Default)]
struct Heights(Vec<(DrapeSystems, f32)>);

#[test]
fn each_set_does_what_it_says() {
    use DrapeSystems::*;
    let mut app = app();
    let ball = app.world_mut().spawn(Projectile::default()).id();
    step(&mut app, 1);
    app.init_resource::<Heights>();
    let look = |set: DrapeSystems| {
        move |balls: Query<&ProjectileState>, mut heights: ResMut<Heights>| {
            heights.0.push((set, balls.single().expect("one ball").position().y));
        }
    };
    app.add_systems(DrapeSchedule, look(DetectCollisions).in_set(DetectCollisions));
    app.add_systems(DrapeSchedule, look(Finish).in_set(Finish));
    app.add_systems(DrapeSubsteps, look(Integrate).after(Integrate).before(Relax));
    let before = ball_position(&app, ball).y;
    step(&mut app, 1);
    let heights = &app.world().resource::<Heights>().0;
    assert_eq!(heights.first(), Some(&(DetectCollisions, before)), "nothing moves before the substeps");
    assert_eq!(heights[1].0, Integrate);
    assert!(heights[1].1 < before, "integration moves the ball");
    assert_eq!(heights.last(), Some(&(Finish, ball_position(&app, ball).y)));
}

#[test]
fn nothing_in_the_schedules_is_ambiguous() {
    let mut app = app();
    for label in [DrapeSchedule.intern(), DrapeSubsteps.intern()] {
        app.edit_schedule(label, |schedule| {
            schedule.set_build_settings(ScheduleBuildSettings {
                ambiguity_detection: LogLevel::Error,
                ..default()
            });
        });
    }
    // So that the substeps are run through their schedule, too. A system of its own set is told to come after all.
    app.add_systems(DrapeSubsteps, (|| {}).after(DrapeSystems::ProjectCollisions));
    let cloth = app.world_mut().spawn(curtain()).id();
    app.world_mut().spawn(Obstacle::ground());
    app.world_mut().spawn(Projectile::default());
    step(&mut app, 3);
    assert_eq!(app.world().resource::<DrapeClock>().steps(), 3);
    assert!(app.world().get::<Particles>(cloth).is_some());
}

#[test]
fn the_plugin_steps_where_it_is_told_to() {
    // In Update, a step is as long as the frame.
    let mut app = app_in(Update);
    frame_time(&mut app, 0.02);
    let ball = app.world_mut().spawn(Projectile { velocity: Vec3::X * 10.0, ..default() }).id();
    step(&mut app, 10);
    let clock = app.world().resource::<DrapeClock>();
    assert_eq!(clock.steps(), 10);
    assert!((clock.delta() - 0.02).abs() < 1e-6);
    assert!((ball_position(&app, ball).x - 2.0).abs() < 1e-4);
}

#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
struct ByHand;

#[test]
fn a_schedule_run_by_hand_steps_by_hand() {
    let mut app = app_in(ByHand);
    let ball = app.world_mut().spawn(Projectile::default()).id();
    step(&mut app, 5);
    assert!(app.world().get::<ProjectileState>(ball).is_none(), "nobody ran the schedule");
    app.world_mut().run_schedule(ByHand);
    app.world_mut().run_schedule(ByHand);
    assert_eq!(app.world().resource::<DrapeClock>().steps(), 2);
    assert!(ball_position(&app, ball).y < 0.0);
}

#[test]
fn forces_of_the_user_act() {
    let mut app = app();
    let rope = Rope { pin_start: false, particles: 3, ..default() };
    let rope = app.world_mut().spawn((rope, dragless())).id();
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(5.0, 0.0, 0.0))).id();
    // Twice the weight upwards: everything falls up.
    let lift = |mut bodies: Query<&mut Particles>, mut balls: Query<&mut ProjectileState>| {
        for mut particles in &mut bodies {
            for i in 0..particles.len() {
                let mass = 1.0 / particles.inverse_mass(i);
                particles.add_force(i, Vec3::Y * (2.0 * GRAVITY * mass));
            }
        }
        for mut ball in &mut balls {
            let mass = ball.material().mass;
            ball.add_force(Vec3::Y * (2.0 * GRAVITY * mass));
        }
    };
    app.add_systems(DrapeSchedule, lift.in_set(DrapeSystems::AccumulateForces));
    step(&mut app, 1);
    let start = (centre(&app, rope).y, get::<Particles>(&app, rope).velocity(1).y);
    run(&mut app, 1.0);
    let expected = start.0 + start.1 + 0.5 * GRAVITY;
    let height = centre(&app, rope).y;
    assert!((height - expected).abs() < 0.02, "the rope is at {height} m, expected {expected} m");
    let t = 1.0 + STEP;
    // The ball was launched for a fall, and is off its parabola by one substep's change of acceleration.
    let (height, expected) = (ball_position(&app, ball).y, 0.5 * GRAVITY * t * t);
    assert!(
        (height - expected).abs() < 2.0 * GRAVITY * STEP,
        "the ball is at {height} m, expected {expected} m"
    );
}

#[derive(Resource, Default)]
struct Count(u32);

#[test]
fn a_system_between_the_substep_sets_runs_in_every_substep() {
    let mut app = app();
    app.init_resource::<Count>();
    let count = |mut count: ResMut<Count>| count.0 += 1;
    app.add_systems(DrapeSubsteps, count.after(DrapeSystems::Relax).before(DrapeSystems::ProjectCollisions));
    app.world_mut().spawn((curtain(), SolverSettings { substeps: 5, ..default() }));
    step(&mut app, 3);
    assert_eq!(app.world().resource::<Count>().0, 15);
}

#[test]
fn a_system_between_the_substeps_can_hold_a_particle() {
    let mut app = app();
    let rope = Rope { pin_start: false, particles: 5, ..default() };
    let rope = app.world_mut().spawn(rope).id();
    let hold = |mut bodies: Query<&mut Particles>| {
        for mut particles in &mut bodies {
            particles.set_position(2, Vec3::new(0.0, -0.5, 0.0));
            particles.set_velocity(2, Vec3::ZERO);
        }
    };
    app.add_systems(DrapeSubsteps, hold.after(DrapeSystems::ProjectCollisions));
    run(&mut app, 2.0);
    let particles = get::<Particles>(&app, rope);
    assert_eq!(particles.position(2), Vec3::new(0.0, -0.5, 0.0));
    // The ends hang down from it; without the hand in the middle the rope would be 20 m below.
    assert!((particles.position(4).y + 1.0).abs() < 0.02, "{}", particles.position(4));
}

/// The substeps went on with columns that were empty by then.
#[test]
fn a_system_between_the_substeps_can_take_a_pose_away() {
    let mut app = app();
    let cloth = app.world_mut().spawn(free_cloth()).id();
    app.update();
    let clear = |mut bodies: Query<&mut Particles>| {
        for mut particles in &mut bodies {
            particles.clear_motion_limits();
            particles.clear_backstops();
            particles.clear_pose_drives();
        }
    };
    app.add_systems(DrapeSubsteps, clear.after(DrapeSystems::Integrate).before(DrapeSystems::Relax));
    let mut particles = get_mut::<Particles>(&mut app, cloth);
    let (backstop, drive) =
        (Backstop { distance: 0.0, radius: 1.0 }, PoseDrive { angular_frequency: 10.0, damping_ratio: 1.0 });
    for i in 0..particles.len() {
        let place = particles.position(i);
        particles.set_motion_limit(i, place, 0.01);
        particles.set_backstop(i, place, Vec3::Y, backstop).expect("valid");
        particles.set_pose_drive(i, place, drive).expect("valid");
    }
    run(&mut app, 0.5);
    let fallen = -centre(&app, cloth).y;
    assert!((fallen - 0.5 * GRAVITY * 0.25).abs() < 0.1, "it fell {fallen} m");
}

/// A ball, two cloths of different substeps and an obstacle, all in contact at some time; 2 s of it.
fn busy_scene(app: &mut App) -> Vec<Entity> {
    let world = app.world_mut();
    world.spawn(Obstacle::ground());
    world.spawn((Obstacle::sphere(0.2), Transform::from_xyz(0.0, 0.2, 0.0)));
    let few = SolverSettings { substeps: 3, iterations: 1, ..default() };
    let ball = |z| Projectile { velocity: Vec3::new(0.5, 1.0, z), ..default() };
    vec![
        world.spawn((curtain(), Transform::from_xyz(0.0, 1.0, 0.0))).id(),
        world.spawn((free_cloth(), few, Transform::from_xyz(3.0, 1.0, 0.0))).id(),
        world.spawn((Rope::default(), Transform::from_xyz(-3.0, 2.0, 0.0))).id(),
        world.spawn((ball(9.0), Transform::from_xyz(0.0, 1.0, -2.0))).id(),
        world.spawn((ball(-20.0), Transform::from_xyz(3.0, 1.0, 2.0))).id(),
    ]
}

#[test]
fn substeps_one_by_one_give_the_same_bits_as_all_at_once() {
    let (mut fused, mut staged) = (app(), app());
    staged.add_systems(DrapeSubsteps, (|| {}).in_set(DrapeSystems::Relax));
    let (in_fused, in_staged) = (busy_scene(&mut fused), busy_scene(&mut staged));
    for count in 0..120 {
        step(&mut fused, 1);
        step(&mut staged, 1);
        assert_eq!(hash(&fused, &in_fused), hash(&staged, &in_staged), "step {count}");
    }
    let hits = fused.world().resource::<Hits>().0.len();
    assert!(hits >= 3, "there were {hits} hits only");
}

#[test]
fn a_system_anywhere_in_the_step_finds_the_bodies_in_their_components_and_leaves_the_bits() {
    use DrapeSystems::*;
    let mut fused = app();
    let in_fused = busy_scene(&mut fused);
    step(&mut fused, 90);
    for set in [AccumulateForces, FormIslands, DetectCollisions, Substeps, Finish] {
        for is_before in [false, true] {
            let mut hooked = app();
            hooked.init_resource::<Count>();
            let look = |bodies: Query<(&Particles, &Sticks)>, mut count: ResMut<Count>| {
                for (particles, sticks) in &bodies {
                    assert_eq!(particles.len(), sticks.particle_count());
                    count.0 += 1;
                }
            };
            if is_before {
                hooked.add_systems(DrapeSchedule, look.before(set));
            } else {
                hooked.add_systems(DrapeSchedule, look.in_set(set));
            }
            let in_hooked = busy_scene(&mut hooked);
            step(&mut hooked, 90);
            assert_eq!(hash(&hooked, &in_hooked), hash(&fused, &in_fused), "with a system in {set:?}");
            assert!(hooked.world().resource::<Count>().0 >= 3 * 89);
        }
    }
}

#[test]
fn a_system_right_after_the_substeps_sees_where_they_led() {
    let mut app = app();
    app.init_resource::<Heights>();
    let look = |balls: Query<&ProjectileState>, mut heights: ResMut<Heights>| {
        heights.0.push((DrapeSystems::Finish, balls.single().expect("one ball").position().y));
    };
    let after = DrapeSystems::Substeps;
    app.add_systems(DrapeSchedule, look.after(after).before(DrapeSystems::Finish));
    let ball = app.world_mut().spawn(Projectile::default()).id();
    for _ in 0..3 {
        step(&mut app, 1);
        let seen = app.world().resource::<Heights>().0.last().map(|&(_, height)| height);
        assert_eq!(seen, Some(ball_position(&app, ball).y));
    }
}

#[test]
fn the_time_of_the_stages_is_told_however_they_are_run() {
    for is_hooked in [false, true] {
        let mut app = app();
        if is_hooked {
            app.add_systems(DrapeSubsteps, (|| {}).in_set(DrapeSystems::Relax));
        }
        app.world_mut().spawn(Cloth { particles: UVec2::splat(64), ..default() });
        step(&mut app, 2);
        let times = app.world().resource::<bevy_drape::schedule::StepTimes>();
        // Either may be the longer one: a busy machine stops the program where it likes.
        assert!(!times.substeps.is_zero() && !times.detect_collisions.is_zero(), "{times:?}");
        assert!(times.substeps + times.detect_collisions <= times.step, "{times:?}");
    }
}
