//! Ten thousand random edits of a running world: nothing panics, nothing is lost, nothing runs away.

use bevy::prelude::*;
use bevy_drape::attach::Grab;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::StructuralSolve;
use bevy_drape::drape_solver::splitmix::SplitMix64;
use bevy_drape::prelude::*;
use bevy_drape::sleep::SceneManager;

use crate::common::*;

/// Edits, a few between one step and the next.
const OPERATIONS: usize = 10_000;
const PER_STEP: usize = 4;
/// Things that are there at once.
const MOST: usize = 12;

/// Numbers that look random and are the same each time.
pub struct Dice(SplitMix64);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Self(SplitMix64(seed))
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.0.bits() % count as u64) as usize
    }

    /// From -reach to reach.
    pub fn about(&mut self, reach: f32) -> f32 {
        self.0.signed() * reach
    }

    pub fn vector(&mut self, reach: f32) -> Vec3 {
        Vec3::new(self.about(reach), self.about(reach), self.about(reach))
    }

    pub fn of<T: Clone>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())].clone()
    }

    pub fn place(&mut self) -> Transform {
        Transform::from_translation(self.vector(1.5)).with_rotation(Quat::from_scaled_axis(self.vector(3.0)))
    }
}

pub fn settings(dice: &mut Dice) -> SolverSettings {
    SolverSettings {
        substeps: 1 + dice.below(16) as u32,
        iterations: 1 + dice.below(4) as u32,
        structural: dice.of(&[StructuralSolve::Sweeps, StructuralSolve::Lines]),
        self_contact: dice.of(&[SelfContact::Off, SelfContact::On]),
        tethers: dice.below(2) == 0,
        ..default()
    }
}

pub fn surface(dice: &mut Dice) -> BodySurface {
    BodySurface {
        drag: dice.of(&[0.0, 0.6, 20.0]),
        friction: dice.of(&[0.0, 0.5, 3.0]),
        thickness: dice.of(&[0.0, 0.005, 0.05]),
        ..default()
    }
}

pub fn fabric(dice: &mut Dice) -> Fabric {
    Fabric {
        areal_density: dice.of(&[0.01, 0.25, 10.0]),
        bend_stiffness: dice.of(&[0.0, 0.1, 1.0]),
        damping: dice.of(&[0.0, 5.0]),
        friction: dice.of(&[0.0, 0.5]),
        ..default()
    }
}

pub fn cloth(dice: &mut Dice) -> Cloth {
    let pins = [
        ClothPins::None,
        ClothPins::Top,
        ClothPins::TopCorners,
        ClothPins::Left,
        ClothPins::Corners,
        // There may be no such particle.
        ClothPins::Indices(vec![0, 7]),
    ];
    Cloth {
        // Now and then one that is refused.
        size: Vec2::new(dice.of(&[0.3, 1.0, 2.0, -1.0]), 1.0),
        particles: UVec2::new(2 + dice.below(8) as u32, 2 + dice.below(8) as u32),
        pins: dice.of(&pins),
    }
}

fn spawn(world: &mut World, dice: &mut Dice) -> Entity {
    let place = dice.place();
    match dice.below(5) {
        0 | 1 => world.spawn((cloth(dice), fabric(dice), settings(dice), place)).id(),
        2 => world
            .spawn((Rope::new(dice.vector(1.0), dice.vector(1.0), 2 + dice.below(20) as u32), place))
            .id(),
        3 => {
            let (radius, mass) = (dice.of(&[0.03, 0.1, 0.4]), dice.of(&[0.01, 1.0, 100.0]));
            let velocity = dice.vector(20.0);
            world.spawn((Projectile { radius, mass, velocity, ..default() }, place)).id()
        }
        _ => {
            let shapes = [
                Obstacle::ground(),
                Obstacle::sphere(0.4),
                Obstacle::capsule(0.2, 0.6),
                Obstacle::cuboid(0.5, 0.4, 0.3),
                Obstacle::cuboid(0.5, 0.5, 0.5).as_sensor(),
            ];
            world.spawn((dice.of(&shapes), place)).id()
        }
    }
}

/// One edit of the world, or of one of the `things` in it.
fn operate(world: &mut World, dice: &mut Dice, things: &mut Vec<Entity>) {
    if things.len() < 2 || (things.len() < MOST && dice.below(4) == 0) {
        things.push(spawn(world, dice));
        return;
    }
    let chosen = dice.below(things.len());
    let entity = things[chosen];
    match dice.below(16) {
        0 => {
            world.despawn(entity);
            things.swap_remove(chosen);
        }
        1 => {
            world.insert_resource(DrapeGravity(dice.vector(20.0)));
        }
        2 => {
            world.insert_resource(Wind { velocity: dice.vector(10.0), ..default() });
        }
        3 => {
            world.resource_mut::<SceneManager>().sleeping = dice.below(2) == 0;
        }
        4 => {
            let (settings, surface) = (settings(dice), surface(dice));
            world.entity_mut(entity).insert((settings, surface));
        }
        5 => {
            world.entity_mut(entity).remove::<(SolverSettings, BodySurface)>();
        }
        6 | 7 => {
            if let Some(mut transform) = world.get_mut::<Transform>(entity) {
                *transform = dice.place();
            }
        }
        8 => {
            if let Some(mut described) = world.get_mut::<Cloth>(entity) {
                *described = cloth(dice);
            }
            if let Some(mut woven) = world.get_mut::<Fabric>(entity) {
                *woven = fabric(dice);
            }
        }
        9 => {
            world.entity_mut(entity).insert(DrapeLayers { memberships: 1 << dice.below(3), filters: 3 });
        }
        10 => {
            world.entity_mut(entity).insert(ContactEvents);
        }
        11 => {
            let grab = world.get::<Particles>(entity).map(|particles| {
                let mut grab = Grab::new(particles, dice.below(particles.len()), 0.3);
                grab.pull_to(dice.vector(2.0));
                grab
            });
            match grab {
                Some(grab) if dice.below(2) == 0 => world.entity_mut(entity).insert(grab),
                _ => world.entity_mut(entity).remove::<Grab>(),
            };
        }
        _ => {
            if let Some(mut particles) = world.get_mut::<Particles>(entity) {
                let i = dice.below(particles.len());
                match dice.below(4) {
                    0 => particles.set_inverse_mass(i, 0.0),
                    1 => particles.set_inverse_mass(i, dice.of(&[0.1, 10.0, 1000.0])),
                    2 => particles.apply_impulse(i, dice.vector(0.5)),
                    _ => particles.set_velocity(i, dice.vector(5.0)),
                }
            }
        }
    }
}

#[test]
#[ignore = "two faults that it found are mended; it has not been run to its end since"]
fn ten_thousand_random_edits_break_nothing() {
    let mut app = app();
    let before = app.world().entities().count_spawned();
    let mut dice = Dice::new(5);
    let mut things = Vec::new();
    let mut fastest = 0.0_f32;
    for turn in 0..OPERATIONS / PER_STEP {
        for _ in 0..PER_STEP {
            operate(app.world_mut(), &mut dice, &mut things);
        }
        app.update();
        // Balls that fall out of the world are taken out of it.
        things.retain(|&thing| app.world().get_entity(thing).is_ok());
        for &thing in &things {
            if let Some(particles) = app.world().get::<Particles>(thing) {
                assert!(particles.is_finite(), "{thing} in turn {turn}");
                fastest = fastest.max(particles.greatest_speed());
            }
            if let Some(ball) = app.world().get::<ProjectileState>(thing) {
                assert!(ball.is_finite(), "{thing} in turn {turn}");
            }
        }
        let (active, resting, culled) = counts(&app);
        assert!(active + resting + culled <= things.len(), "in turn {turn}");
    }
    println!("the fastest particle was at {fastest} m/s");
    things.drain(..).for_each(|thing| {
        app.world_mut().despawn(thing);
    });
    app.update();
    assert_eq!(counts(&app), (0, 0, 0));
    assert!(app.world().resource::<Refusals>().is_empty());
    assert_eq!(app.world().entities().count_spawned(), before, "nothing is left");
}
