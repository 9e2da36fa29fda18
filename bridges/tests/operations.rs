//! A thousand random operations on a running world: nothing panics, nothing stays behind, nothing is lost in space.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_drape::drape_solver::splitmix::SplitMix64;
use bevy_drape::prelude::*;

use crate::engine::*;
use crate::scene::*;

const OPERATIONS: usize = 1000;
/// Operations between one step and the next.
const PER_STEP: usize = 4;
/// Bodies, and cloths, that are there at once.
const MOST: usize = 12;

/// Numbers that look random and are the same each time.
struct Dice(SplitMix64);

impl Dice {
    fn below(&mut self, count: usize) -> usize {
        (self.0.bits() % count as u64) as usize
    }

    /// From -reach to reach.
    fn about(&mut self, reach: f32) -> f32 {
        (self.below(20_001) as f32 / 10_000.0 - 1.0) * reach
    }

    fn vector(&mut self, reach: f32) -> Vec3 {
        Vec3::new(self.about(reach), self.about(reach), self.about(reach))
    }

    fn of<T: Clone>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())].clone()
    }

    fn place(&mut self) -> Transform {
        Transform::from_translation(self.vector(1.5) + Vec3::Y * 1.6)
            .with_rotation(Quat::from_scaled_axis(self.vector(3.0)))
    }

    fn collider(&mut self) -> Collider {
        // Parry panics where voxels or height fields meet a shape of parts, with or without cloth.
        let known = |(name, ..): &(&str, Collider, f32)| !["voxels", "height field"].contains(name);
        let colliders: Vec<_> = shapes().into_iter().filter(known).collect();
        self.of(&colliders).1
    }

    fn body(&mut self) -> RigidBody {
        self.of(&[STATIC, KINEMATIC, DYNAMIC, DYNAMIC])
    }
}

/// The entities that operations choose from; some have gone with a parent.
#[derive(Default)]
struct Made {
    bodies: Vec<Entity>,
    cloths: Vec<Entity>,
}

/// Ties one end of a rope, or both.
fn tied(bodies: &[Entity], dice: &mut Dice) -> Option<Attachment> {
    if bodies.is_empty() {
        return None;
    }
    let tied = Attachment::first(dice.of(bodies));
    Some(if dice.below(2) == 0 { tied } else { tied.and(Tie::last(dice.of(bodies))) })
}

fn spawn(app: &mut App, made: &mut Made, dice: &mut Dice) {
    let world = app.world_mut();
    if made.bodies.len() < MOST && dice.below(2) == 0 {
        let mass = mass(dice.of(&[0.01, 1.0, 100.0]), 0.1);
        let motion = moving(dice.vector(5.0), dice.vector(5.0));
        made.bodies.push(world.spawn((dice.body(), dice.collider(), mass, dice.place(), motion)).id());
    } else if made.cloths.len() < MOST {
        let place = dice.place();
        let cloth = match dice.below(3) {
            0 => world.spawn((Cloth::new(0.6, 0.6).with_particles(9, 9).with_pins(ClothPins::None), place)),
            1 => {
                let rope = world.spawn((Rope::new(Vec3::ZERO, Vec3::X, 12), place)).id();
                if let Some(tied) = tied(&made.bodies, dice) {
                    world.entity_mut(rope).insert(tied);
                }
                world.entity_mut(rope)
            }
            _ => world.spawn((Projectile { velocity: dice.vector(10.0), ..default() }, place)),
        };
        made.cloths.push(cloth.id());
    }
}

fn operate(app: &mut App, made: &mut Made, dice: &mut Dice) {
    let kind = dice.below(16);
    if kind < 4 || made.bodies.is_empty() {
        return spawn(app, made, dice);
    }
    if kind == 4 && !made.cloths.is_empty() {
        let cloth = made.cloths.swap_remove(dice.below(made.cloths.len()));
        app.world_mut().despawn(cloth);
        return;
    }
    if kind == 5 {
        pause(app);
        return;
    }
    if kind == 6
        && !made.cloths.is_empty()
        && let Ok(mut rope) = app.world_mut().get_entity_mut(dice.of(&made.cloths))
        && rope.contains::<Rope>()
    {
        match tied(&made.bodies, dice).filter(|_| dice.below(3) > 0) {
            Some(tied) => _ = rope.insert(tied),
            None => _ = rope.remove::<Attachment>(),
        }
    }
    let index = dice.below(made.bodies.len());
    let (body, other) = (made.bodies[index], dice.of(&made.bodies));
    let Ok(mut entity) = app.world_mut().get_entity_mut(body) else {
        made.bodies.swap_remove(index);
        return;
    };
    match kind {
        6 => {
            entity.despawn();
            made.bodies.swap_remove(index);
        }
        7 => _ = entity.insert(dice.body()),
        8 => _ = entity.insert(dice.collider()),
        9 => _ = entity.insert(dice.place()),
        10 => {
            if let Some(mut place) = entity.get_mut::<Transform>() {
                place.scale = Vec3::splat(0.5 + dice.about(0.4));
            }
        }
        11 => {
            let all = [u32::MAX, 2, 0];
            entity.insert(layers(dice.of(&all), dice.of(&all)));
        }
        12 if entity.contains::<Sensor>() => _ = entity.remove::<Sensor>(),
        12 => _ = entity.insert(Sensor),
        13 if entity.contains::<NoObstacle>() => _ = entity.remove::<NoObstacle>(),
        13 => _ = entity.insert(NoObstacle),
        14 if entity.contains::<RigidBodyDisabled>() => _ = entity.remove::<RigidBodyDisabled>(),
        14 => _ = entity.insert(RigidBodyDisabled),
        _ if entity.contains::<ChildOf>() => _ = entity.remove::<ChildOf>(),
        _ if other != body => {
            let is_below = |world: &World, mut of: Entity| loop {
                match world.get::<ChildOf>(of) {
                    Some(parent) if parent.parent() == body => return true,
                    Some(parent) => of = parent.parent(),
                    None => return false,
                }
            };
            // Half of those that get a parent become one of its colliders.
            if dice.below(2) == 0 {
                entity.remove::<RigidBody>();
            }
            let world = app.world_mut();
            if world.get_entity(other).is_ok() && !is_below(world, other) {
                world.entity_mut(body).insert(ChildOf(other));
            }
        }
        _ => {}
    }
}

#[test]
fn a_thousand_random_operations_leave_a_sound_world() {
    let mut app = app();
    ground(&mut app);
    let (mut made, mut dice) = (Made::default(), Dice(SplitMix64(21)));
    for number in 0..OPERATIONS {
        operate(&mut app, &mut made, &mut dice);
        if number % PER_STEP == 0 {
            app.update();
            let world = app.world_mut();
            for (body, place) in world.query::<(Entity, &Transform)>().iter(world) {
                assert!(
                    place.is_finite() && place.translation.length() < 1e4,
                    "{body} at {number}: {place:?}"
                );
            }
            for (body, particles) in world.query::<(Entity, &Particles)>().iter(world) {
                assert!(particles.positions().all(Vec3::is_finite), "{body} at {number}");
            }
        }
    }
    for entity in made.bodies.into_iter().chain(made.cloths) {
        if let Ok(entity) = app.world_mut().get_entity_mut(entity) {
            entity.despawn();
        }
    }
    app.update();
    let world = app.world_mut();
    let count = world.query_filtered::<&ObstacleOf, Allow<Disabled>>().iter(world).count();
    assert_eq!(count, 0, "no obstacle outlives its body");
    let count = world.query_filtered::<&Obstacle, Allow<Disabled>>().iter(world).count();
    assert_eq!(count, 1, "the ground is left");
}
