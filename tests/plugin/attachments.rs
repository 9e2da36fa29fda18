//! Particles that follow entities, and entities that follow particles.

use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::prelude::*;
use bevy_drape::snapshot::Snapshot;
use bevy_drape::tear::CutCloth;

use crate::common::*;

fn place(app: &App, body: Entity, particle: usize) -> Vec3 {
    get::<Particles>(app, body).position(particle)
}

fn hook(app: &mut App, x: f32, y: f32, z: f32) -> Entity {
    app.world_mut().spawn(Transform::from_xyz(x, y, z)).id()
}

/// A rope of a metre between two hooks, each at one of its ends.
fn bridge() -> (App, Entity, [Entity; 2]) {
    let mut app = app();
    let hooks = [hook(&mut app, 0.0, 2.0, 0.0), hook(&mut app, 0.9, 2.0, 0.0)];
    let rope = Rope::new(Vec3::new(0.0, 2.0, 0.0), Vec3::new(1.0, 2.0, 0.0), 21);
    let rope =
        app.world_mut().spawn((rope, quiet(), Attachment::first(hooks[0]).and(Tie::last(hooks[1])))).id();
    step(&mut app, 1);
    (app, rope, hooks)
}

#[test]
fn both_ends_of_a_rope_go_where_two_entities_go() {
    let (mut app, rope, hooks) = bridge();
    for count in 0..120 {
        let angle = count as f32 * 0.05;
        for (hook, sign) in hooks.into_iter().zip([1.0, -1.0]) {
            let mut transform = get_mut::<Transform>(&mut app, hook);
            transform.translation.z = 0.3 * sign * libm::sinf(angle);
            transform.translation.y = 2.0 + 0.1 * sign * libm::sinf(angle);
        }
        get_mut::<Transform>(&mut app, hooks[1]).translation.x -= 0.005;
        step(&mut app, 1);
        let [first, last] = hooks.map(|hook| get::<Transform>(&app, hook).translation);
        assert!(place(&app, rope, 0).distance(first) < 1e-5);
        // It was tied a tenth of a metre beside the second hook.
        assert!(place(&app, rope, 20).distance(last + Vec3::X * 0.1) < 1e-5);
    }
    assert!(place(&app, rope, 10).y < 1.8, "the middle sags");
}

#[test]
fn a_tied_particle_keeps_its_place_as_the_entity_turns_and_its_parent_moves() {
    let mut app = app();
    let ship = hook(&mut app, 0.0, 0.0, 0.0);
    let mast = app.world_mut().spawn((Transform::from_xyz(0.0, 3.0, 0.0), ChildOf(ship))).id();
    let sail =
        app.world_mut().spawn((curtain(), Transform::from_xyz(0.0, 3.0, 0.0), Attachment::pinned(mast))).id();
    step(&mut app, 1);
    let before = place(&app, sail, 0) - Vec3::Y * 3.0;
    for _ in 0..60 {
        get_mut::<Transform>(&mut app, ship).translation.x += 0.02;
        get_mut::<Transform>(&mut app, mast).rotate_y(0.01);
        step(&mut app, 1);
        let mast = *app.world().get::<GlobalTransform>(mast).expect("a place");
        let off = place(&app, sail, 0).distance(mast.transform_point(before));
        assert!(off < 1e-4, "{off}");
    }
    // The entity of the sail does not count any more.
    let held = place(&app, sail, 0);
    get_mut::<Transform>(&mut app, sail).translation.x = 40.0;
    step(&mut app, 1);
    assert_eq!(place(&app, sail, 0), held);
}

#[test]
fn a_fast_hook_pulls_without_a_jerk() {
    let (mut app, rope, hooks) = bridge();
    run(&mut app, 1.0);
    let mut fastest = 0.0_f32;
    for _ in 0..60 {
        for hook in hooks {
            get_mut::<Transform>(&mut app, hook).translation.z += 20.0 * STEP;
        }
        step(&mut app, 1);
        let particles = get::<Particles>(&app, rope);
        // Evenly through the step, and not in its first substep.
        assert!(particles.velocity(0).distance(Vec3::Z * 20.0) < 0.1, "{}", particles.velocity(0));
        fastest = fastest.max(particles.greatest_speed());
    }
    // The middle swings after the ends and past them; a jerk would throw it off at a multiple.
    assert!(fastest < 60.0, "{fastest} m/s");
}

#[test]
fn a_rope_falls_when_it_is_untied_or_what_it_is_tied_to_is_gone() {
    let (mut app, rope, hooks) = bridge();
    app.world_mut().despawn(hooks[1]);
    run(&mut app, 0.5);
    assert!(place(&app, rope, 20).y < 1.5, "let go with the hook");
    assert!(place(&app, rope, 0).distance(Vec3::new(0.0, 2.0, 0.0)) < 1e-5, "the other end is held");
    let mass = 1.0 / get::<Particles>(&app, rope).inverse_mass(20);
    assert!((mass - 0.1 * 0.5 / 20.0).abs() < 1e-6, "it weighs again what it did: {mass} kg");
    app.world_mut().entity_mut(rope).remove::<Attachment>();
    run(&mut app, 0.5);
    // The rope itself has its start pinned.
    assert!(place(&app, rope, 0).distance(Vec3::new(0.0, 2.0, 0.0)) < 1e-5);
}

#[test]
fn ties_are_changed_while_they_hold() {
    let (mut app, rope, hooks) = bridge();
    run(&mut app, 0.5);
    let (first, middle) = (place(&app, rope, 0), place(&app, rope, 10));
    *get_mut::<Attachment>(&mut app, rope) = Attachment::first(hooks[0]).and(Tie::indices(hooks[1], [10]));
    run(&mut app, 0.5);
    assert_eq!(place(&app, rope, 0), first);
    assert!(place(&app, rope, 10).distance(middle) < 1e-4, "held where it was");
    assert!(place(&app, rope, 20).y < middle.y - 0.2, "the end hangs down");
}

#[test]
fn what_cannot_be_tied_is_told_once_and_the_rest_is_tied() {
    let mut app = app();
    let post = hook(&mut app, 0.0, 0.0, 0.0);
    let cloth = app.world_mut().spawn((free_cloth(), Attachment::indices(post, [3, 81]))).id();
    run(&mut app, 0.5);
    let messages = refusals(&app, cloth);
    assert_eq!(messages.len(), 1, "{messages:?}");
    assert!(messages[0].contains("Attachment") && messages[0].contains("81"), "{messages:?}");
    assert!(place(&app, cloth, 3).distance(Vec3::new(3.0 / 8.0 - 0.5, 0.5, 0.0)) < 1e-5);
    get_mut::<Transform>(&mut app, post).translation.x = f32::NAN;
    step(&mut app, 3);
    assert!(place(&app, cloth, 3).distance(Vec3::new(3.0 / 8.0 - 0.5, 0.5, 0.0)) < 1e-5);
    assert_eq!(refusals(&app, post).len(), 1);
}

#[test]
fn a_tied_curtain_sleeps_until_its_rail_moves() {
    let mut app = app();
    let rail = hook(&mut app, 0.0, 1.0, 0.0);
    let curtain = app.world_mut().spawn((curtain(), quiet(), Attachment::pinned(rail))).id();
    settle(&mut app, curtain);
    get_mut::<Transform>(&mut app, rail).translation.x += 0.05;
    step(&mut app, 1);
    assert_eq!(activity(&app, curtain), Activity::Active);
    assert!((place(&app, curtain, 0).x + 0.45).abs() < 1e-5);
}

#[test]
fn the_pieces_of_a_torn_body_hang_on_what_it_hung_on() {
    let mut app = app();
    let posts = [hook(&mut app, -0.5, 0.5, 0.0), hook(&mut app, 0.5, 0.5, 0.0)];
    let tied = Attachment::indices(posts[0], [0]).and(Tie::indices(posts[1], [8]));
    let cloth = app.world_mut().spawn((free_cloth(), tied)).id();
    run(&mut app, 0.5);
    let blade = [Vec3::new(0.06, 3.0, -2.0), Vec3::new(0.06, 3.0, 2.0)];
    let cut = CutCloth::sweep(blade, blade.map(|corner| corner - Vec3::Y * 6.0));
    app.world_mut().write_message(cut);
    step(&mut app, 2);
    for post in posts {
        get_mut::<Transform>(&mut app, post).translation.y += 0.3;
    }
    run(&mut app, 0.5);
    let mut query = app.world_mut().query::<(Entity, &Particles, &Attachment)>();
    let pieces: Vec<_> = query.iter(app.world()).map(|(entity, ..)| entity).collect();
    assert_eq!(pieces.len(), 2);
    assert!(pieces.contains(&cloth));
    for piece in pieces {
        let particles = get::<Particles>(&app, piece);
        let held: Vec<Vec3> =
            (0..particles.len()).filter(|&i| particles.is_pinned(i)).map(|i| particles.position(i)).collect();
        assert_eq!(held.len(), 1);
        assert!((held[0].y - 0.8).abs() < 1e-4 && (held[0].x.abs() - 0.5).abs() < 1e-4, "{held:?}");
    }
}

#[test]
fn a_restored_world_goes_on_with_the_same_bits() {
    let (mut app, rope, hooks) = bridge();
    let swing = |app: &mut App, count: usize| {
        for _ in 0..count {
            get_mut::<Transform>(app, hooks[1]).translation.y += 0.01;
            step(app, 1);
        }
    };
    swing(&mut app, 20);
    let snapshot = Snapshot::take(app.world_mut());
    let there = *get::<Transform>(&app, hooks[1]);
    swing(&mut app, 20);
    let expected = hash(&app, &[rope]);
    snapshot.restore(app.world_mut()).expect("the same scene");
    *get_mut::<Transform>(&mut app, hooks[1]) = there;
    swing(&mut app, 20);
    assert_eq!(hash(&app, &[rope]), expected);
}

#[test]
fn a_lamp_follows_the_end_of_a_rope_and_turns_with_it() {
    let mut app = app();
    let rope = app.world_mut().spawn((Rope::default(), quiet())).id();
    let room = app.world_mut().spawn(Transform::from_xyz(5.0, 0.0, 0.0)).id();
    let lamp = app.world_mut().spawn((FollowParticle::last(rope).turning(), ChildOf(room))).id();
    step(&mut app, 2);
    let last = get::<Particles>(&app, rope).len() - 1;
    get_mut::<Particles>(&mut app, rope).set_velocity(last, Vec3::X * 8.0);
    let mut lowest = 1.0_f32;
    for _ in 0..30 {
        step(&mut app, 1);
        let lamp = get::<Transform>(&app, lamp);
        let [end, neighbour] = [last, last - 1].map(|i| place(&app, rope, i));
        assert!((lamp.translation + Vec3::X * 5.0).distance(end) < 1e-5);
        let up = lamp.rotation * Vec3::Y;
        assert!(up.distance((neighbour - end).normalize()) < 1e-4, "{up}");
        lowest = lowest.min(up.y);
    }
    assert!(lowest < 0.9, "it swung: {lowest}");
    app.world_mut().despawn(rope);
    let before = *get::<Transform>(&app, lamp);
    step(&mut app, 2);
    assert_eq!(*get::<Transform>(&app, lamp), before, "it stays where it was");
}

#[test]
fn a_follower_of_a_particle_that_is_not_there_stays() {
    let mut app = app();
    let rope = app.world_mut().spawn(Rope::default()).id();
    let lamp = app.world_mut().spawn(FollowParticle::index(rope, 99)).id();
    step(&mut app, 5);
    assert_eq!(*get::<Transform>(&app, lamp), Transform::IDENTITY);
}
