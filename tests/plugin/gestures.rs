//! Swords, bullets and hands: what each does, and ten thousand of them at random.

use bevy::prelude::*;
use bevy_drape::attach::{Grab, Winch};
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::Sticks;
use bevy_drape::gestures::Gestures;
use bevy_drape::prelude::*;
use bevy_drape::tear::BodySplit;

use crate::common::*;
use crate::operations::{Dice, cloth, settings};

/// Gestures, a few between one step and the next.
const OPERATIONS: usize = 10_000;
const PER_STEP: usize = 4;
/// Bodies that are there at once; the oldest go first.
const MOST: usize = 14;

/// Everything that has come off something.
#[derive(Resource, Default)]
struct Pieces(Vec<Entity>);

fn note_pieces(split: On<BodySplit>, mut pieces: ResMut<Pieces>) {
    pieces.0.extend(split.piece);
}

fn gesture(app: &mut App, make: impl FnOnce(&mut Commands)) {
    make(&mut app.world_mut().commands());
    app.world_mut().flush();
}

#[test]
fn a_sword_parts_a_cloth_along_its_path_and_a_bullet_leaves_a_hole() {
    let mut app = app();
    app.init_resource::<Pieces>().add_observer(note_pieces);
    let curtain = app.world_mut().spawn(Cloth::new(1.0, 1.0).with_particles(21, 21)).id();
    step(&mut app, 1);
    let count = get::<Particles>(&app, curtain).len();
    gesture(&mut app, |commands| {
        commands.pierce(Vec3::new(0.26, 0.26, 0.0), Dir3::NEG_Z, 0.12);
    });
    step(&mut app, 1);
    assert!(get::<Particles>(&app, curtain).len() > count, "the bullet has split particles");
    assert!(app.world().resource::<Pieces>().0.is_empty(), "and nothing came off");
    // Up and to the right, each a little farther than the corner: cracks run along edges. The lower right comes off.
    let up = [Vec3::new(-0.026, -1.0, 0.0), Vec3::new(-0.026, 0.06, 0.0)];
    let right = [Vec3::new(-0.12, -0.026, 0.0), Vec3::new(1.0, -0.026, 0.0)];
    gesture(&mut app, |commands| {
        commands.cut_along(up, Vec3::Z * 0.2).cut_along(right, Vec3::Z * 0.2);
    });
    step(&mut app, 1);
    let &[piece] = app.world().resource::<Pieces>().0.as_slice() else {
        panic!("one piece, not {}", app.world().resource::<Pieces>().0.len())
    };
    let (low, high) = get::<Particles>(&app, piece).bounds();
    let size = high - low;
    assert!((size.x - 0.5).abs() < 0.08 && (size.y - 0.5).abs() < 0.08, "{size}");
}

#[test]
fn hands_pull_with_their_own_force_and_let_go_one_by_one() {
    let mut app = app();
    let sheet =
        app.world_mut().spawn(Cloth::new(1.0, 1.0).with_particles(11, 11).with_pins(ClothPins::None)).id();
    step(&mut app, 1);
    let corners = [Vec3::new(-0.5, 0.5, 0.0), Vec3::new(0.5, 0.5, 0.0)];
    gesture(&mut app, |commands| {
        for (hand, corner) in (1..).zip(corners) {
            commands.grab(sheet, hand, corner, 0.4).pull(sheet, hand, corner, 50.0);
        }
        // Nothing holds this.
        commands.pull(sheet, 7, Vec3::ONE, 1.0).release(sheet, 7).grab(
            Entity::PLACEHOLDER,
            1,
            Vec3::ZERO,
            1.0,
        );
    });
    run(&mut app, 1.0);
    let place = |app: &App, i: usize| get::<Particles>(app, sheet).position(i);
    assert!(place(&app, 0).distance(corners[0]) < 0.1 && place(&app, 10).distance(corners[1]) < 0.1);
    gesture(&mut app, |commands| {
        commands.release(sheet, 2);
    });
    run(&mut app, 1.0);
    assert!(place(&app, 0).distance(corners[0]) < 0.3, "the left hand holds on");
    assert!(place(&app, 10).y < 0.0, "the right has let go");
    gesture(&mut app, |commands| {
        commands.release(sheet, 1);
    });
    assert!(app.world().get::<Grab>(sheet).is_none());
}

fn spawn(world: &mut World, dice: &mut Dice) -> Entity {
    let place = dice.place();
    match dice.below(6) {
        0..=2 => world.spawn((cloth(dice), settings(dice), place)).id(),
        3 => {
            let rope = Rope::new(dice.vector(1.0), dice.vector(1.0), 2 + dice.below(20) as u32);
            world.spawn((rope, Winch::default(), settings(dice), place)).id()
        }
        4 => {
            let rings = 1 + dice.below(3) as u32;
            world.spawn((SoftBall { rings, ..SoftBall::new(0.3) }, settings(dice), place)).id()
        }
        _ => {
            let radius = dice.of(&[0.05, 0.2]);
            world.spawn((Projectile { radius, velocity: dice.vector(20.0), ..default() }, place)).id()
        }
    }
}

/// One gesture, or a change in the middle of one.
fn operate(world: &mut World, dice: &mut Dice, things: &mut Vec<Entity>) {
    if things.len() < 3 || (things.len() < MOST && dice.below(8) == 0) {
        things.push(spawn(world, dice));
        return;
    }
    let chosen = dice.below(things.len());
    let entity = things[chosen];
    let hand = dice.below(3) as u64;
    match dice.below(20) {
        0 => {
            world.despawn(entity);
            things.swap_remove(chosen);
        }
        1..=4 => {
            let (place, radius) = (dice.vector(1.5), dice.of(&[0.0, 0.2, 5.0]));
            world.commands().grab(entity, hand, place, radius);
        }
        5..=8 => {
            let force = dice.of(&[f32::INFINITY, 100.0, 1.0, 0.0, -1.0, f32::NAN]);
            let somewhere = dice.vector(2.0);
            let target = dice.of(&[somewhere, somewhere, Vec3::NAN, Vec3::splat(1e5)]);
            world.commands().pull(entity, hand, target, force);
        }
        9 => {
            world.commands().release(entity, hand);
        }
        10 | 11 => {
            let path: Vec<Vec3> = (0..dice.below(4)).map(|_| dice.vector(1.5)).collect();
            let depth = dice.of(&[Vec3::Z, Vec3::ZERO, Vec3::splat(0.3)]);
            world.commands().cut_along(path, depth);
        }
        12 => {
            let (place, radius) = (dice.vector(1.0), dice.of(&[0.0, 0.1, 1.0]));
            world.commands().pierce(place, Dir3::Z, radius);
        }
        13 => {
            let strain = dice.of(&[0.02, 0.3, 2.0, -1.0]);
            let most_at_once = dice.of(&[1, 16, 1000]);
            world.entity_mut(entity).insert(Tearable { strain, most_at_once, ..default() });
        }
        14 => {
            world.entity_mut(entity).remove::<Tearable>();
        }
        15 => {
            if let Some(mut winch) = world.get_mut::<Winch>(entity) {
                *winch = Winch { speed: dice.about(3.0), least: dice.of(&[0.05, 0.5, -1.0]), greatest: 3.0 };
            }
        }
        16 => {
            let settings = settings(dice);
            world.entity_mut(entity).insert(settings);
        }
        17 => {
            if let Some(mut transform) = world.get_mut::<Transform>(entity) {
                *transform = dice.place();
            }
        }
        // The description goes, and the body with it.
        18 => drop(world.entity_mut(entity).remove::<Cloth>()),
        _ => {
            if let Some(mut particles) = world.get_mut::<Particles>(entity)
                && !particles.is_empty()
            {
                let i = dice.below(particles.len());
                particles.set_inverse_mass(i, dice.of(&[0.0, 0.1, 1000.0]));
            }
        }
    }
    world.flush();
}

#[test]
#[ignore = "takes minutes; it has not been run to its end"]
fn ten_thousand_random_gestures_break_nothing() {
    let mut app = app();
    app.init_resource::<Pieces>().add_observer(note_pieces);
    app.world_mut().spawn(Obstacle::sphere(0.4));
    let before = app.world().entities().count_spawned();
    let mut dice = Dice::new(6);
    let mut things = Vec::new();
    let mut came_off = 0;
    for turn in 0..OPERATIONS / PER_STEP {
        for _ in 0..PER_STEP {
            operate(app.world_mut(), &mut dice, &mut things);
        }
        app.update();
        let pieces = core::mem::take(&mut app.world_mut().resource_mut::<Pieces>().0);
        came_off += pieces.len();
        things.extend(pieces);
        // Balls that fall out of the world are taken out of it.
        things.retain(|&thing| app.world().get_entity(thing).is_ok());
        while things.len() > 2 * MOST {
            app.world_mut().despawn(things.remove(0));
        }
        for &thing in &things {
            if let Some(particles) = app.world().get::<Particles>(thing) {
                assert!(particles.is_finite(), "{thing} in turn {turn}");
                assert_eq!(particles.len(), get::<Sticks>(&app, thing).particle_count(), "in turn {turn}");
            }
            if let Some(ball) = app.world().get::<ProjectileState>(thing) {
                assert!(ball.is_finite(), "{thing} in turn {turn}");
            }
        }
        assert_eq!(app.world().entities().count_spawned(), before + things.len() as u32, "in turn {turn}");
    }
    println!("{came_off} pieces came off");
    assert!(came_off > 100, "only {came_off} pieces came off");
    things.drain(..).for_each(|thing| {
        app.world_mut().despawn(thing);
    });
    app.update();
    assert_eq!(counts(&app), (0, 0, 0));
    assert_eq!(app.world().entities().count_spawned(), before, "nothing is left");
}
