//! Particles and their transforms.

use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::prelude::*;
use bevy_drape::rig::{InRig, Particle};
use bevy_drape::sleep::SceneManager;

use crate::support::{Rigs, STEP, assert_near};

fn parent_transform() -> Transform {
    Transform::from_xyz(3.0, -2.0, 1.0).with_rotation(Quat::from_rotation_z(0.7)).with_scale(Vec3::splat(2.0))
}

/// Spawns a swinging chain; with a parent, at the same places in the world.
fn swinging(rigs: &mut Rigs, parent: Option<Transform>) -> Vec<Entity> {
    let chain = rigs.chain(Vec3::new(0.0, 3.0, 0.0), Vec3::new(1.5, 3.0, 0.0), 4, [true, false]);
    if let Some(transform) = parent {
        let parent = rigs.spawn(transform);
        let to_local = transform.compute_affine().inverse();
        for &particle in &chain {
            rigs.edit::<Transform>(particle, |transform| {
                transform.translation = to_local.transform_point3(transform.translation);
            });
            rigs.app.world_mut().entity_mut(particle).insert(ChildOf(parent));
        }
    }
    chain
}

#[test]
fn a_parent_changes_nothing_about_the_motion() {
    let (mut plain, mut with_parent) = (Rigs::new(), Rigs::new());
    let chain = swinging(&mut plain, None);
    let children = swinging(&mut with_parent, Some(parent_transform()));
    let mut lowest = f32::INFINITY;
    for _ in 0..60 {
        plain.steps(1);
        with_parent.steps(1);
        for (&particle, &child) in chain.iter().zip(&children) {
            assert_near(with_parent.global(child), plain.place(particle), 2e-3);
        }
        lowest = lowest.min(plain.place(chain[3]).y);
    }
    assert!(lowest < 1.6, "it swings: {lowest}");
    let rotation = with_parent.app.world().get::<Transform>(children[3]).expect("a transform").rotation;
    assert_eq!(rotation, Quat::IDENTITY, "only the translation is written");
}

#[test]
fn a_moving_parent_takes_pins_along_and_not_free_particles() {
    let mut rigs = Rigs::weightless();
    let parent = rigs.spawn(Transform::default());
    let free = rigs.spawn((Particle::new(1.0), Transform::from_xyz(0.0, 1.0, 0.0), ChildOf(parent)));
    let pin = rigs.spawn((Particle::pinned(), Transform::from_xyz(0.0, 2.0, 0.0), ChildOf(parent)));
    rigs.steps(2);
    for _ in 0..30 {
        rigs.edit::<Transform>(parent, |transform| transform.translation.x += 0.1);
        rigs.steps(1);
        assert_near(rigs.global(free), Vec3::Y, 1e-4);
        let InRig { body, index } = rigs.in_rig(pin).expect("simulated");
        let simulated = rigs.app.world().get::<Particles>(body).expect("columns").position(index);
        assert_near(simulated, rigs.global(pin), 1e-4);
    }
    assert_near(rigs.global(pin), Vec3::new(3.0, 2.0, 0.0), 1e-4);
}

#[test]
fn a_particle_at_rest_stays_where_it_is_when_its_parent_moves() {
    let mut rigs = Rigs::weightless();
    let parent = rigs.spawn(Transform::default());
    let free = rigs.spawn((Particle::new(1.0), Transform::from_xyz(0.0, 1.0, 0.0), ChildOf(parent)));
    rigs.seconds(3.0);
    assert_eq!(rigs.activity(free), Activity::Resting);
    rigs.edit::<Transform>(parent, |transform| transform.translation.x = 5.0);
    rigs.steps(1);
    assert_near(rigs.global(free), Vec3::Y, 1e-5);
    assert_eq!(rigs.activity(free), Activity::Resting);
}

#[test]
fn particles_may_be_children_of_particles() {
    let mut rigs = Rigs::new();
    let parent = rigs.spawn((
        Particle { velocity: Vec3::new(4.0, 0.0, 0.0), ..Particle::new(1.0) },
        Transform::from_rotation(Quat::from_rotation_x(0.4)),
    ));
    let bone = rigs.spawn((Transform::from_xyz(0.0, 1.0, 0.0), ChildOf(parent)));
    let child = rigs.spawn((Particle::new(1.0), Transform::from_xyz(0.0, 1.0, 0.0), ChildOf(bone)));
    rigs.steps(1);
    for _ in 0..30 {
        rigs.steps(1);
        let InRig { body, index } = rigs.in_rig(child).expect("simulated");
        let simulated = rigs.app.world().get::<Particles>(body).expect("columns").position(index);
        assert_near(rigs.global(child), simulated, 1e-4);
    }
    assert!(rigs.place(parent).x > 1.5, "the parent flies away");
    assert!(rigs.global(child).x.abs() < 1e-4, "the child falls straight");
}

#[test]
fn moving_a_free_particle_teleports_it_and_keeps_its_velocity() {
    let mut rigs = Rigs::weightless();
    let velocity = Vec3::new(1.0, 2.0, 0.0);
    let particle = rigs.spawn(Particle { velocity, ..Particle::new(1.0) });
    rigs.steps(30);
    rigs.edit::<Transform>(particle, |transform| transform.translation = Vec3::new(50.0, 0.0, 0.0));
    rigs.steps(1);
    assert_near(rigs.place(particle), Vec3::new(50.0, 0.0, 0.0) + velocity * STEP, 1e-4);
    assert_near(rigs.velocity(particle), velocity, 1e-3);
}

#[test]
fn moving_a_particle_of_a_rig_at_rest_wakes_it() {
    let mut rigs = Rigs::with_drag(2.0);
    let chain = rigs.chain(Vec3::Y * 5.0, Vec3::Y * 4.0, 3, [true, false]);
    rigs.seconds(5.0);
    assert_eq!(rigs.activity(chain[2]), Activity::Resting);
    rigs.edit::<Transform>(chain[2], |transform| transform.translation.x = 0.3);
    rigs.steps(1);
    assert_eq!(rigs.activity(chain[2]), Activity::Active);
    assert!((0.1..0.35).contains(&rigs.place(chain[2]).x), "{}", rigs.place(chain[2]));
}

#[test]
fn a_teleport_brings_a_culled_rig_back() {
    let mut rigs = Rigs::weightless();
    rigs.app.world_mut().resource_mut::<SceneManager>().play_area_max = Vec3::splat(2.0);
    let particle = rigs.spawn(Particle { velocity: Vec3::X * 5.0, ..Particle::new(1.0) });
    rigs.seconds(1.0);
    assert_eq!(rigs.activity(particle), Activity::Culled);
    let left = rigs.place(particle);
    rigs.steps(5);
    assert_eq!(rigs.place(particle), left, "a culled particle stands still");
    rigs.edit::<Transform>(particle, |transform| transform.translation = Vec3::ZERO);
    rigs.steps(10);
    assert_eq!(rigs.activity(particle), Activity::Active);
    assert!((0.2..1.0).contains(&rigs.place(particle).x), "{}", rigs.place(particle));
}

#[test]
fn a_pin_follows_its_transform_evenly() {
    let mut rigs = Rigs::weightless();
    let pin = rigs.pin(Vec3::ZERO);
    let bob = rigs.free(1.0, Vec3::NEG_X);
    rigs.join(pin, bob);
    rigs.steps(1);
    // Towed at 3 m/s, with the stick taut all the way.
    for step in 1..=20 {
        let target = Vec3::X * (step as f32 * 0.05);
        rigs.edit::<Transform>(pin, |transform| transform.translation = target);
        rigs.steps(1);
        let InRig { body, index } = rigs.in_rig(pin).expect("simulated");
        let particles = rigs.app.world().get::<Particles>(body).expect("columns");
        assert_near(particles.position(index), target, 1e-5);
        // The velocity over the last substep is that over the whole step: no jump within it.
        assert_near(particles.velocity(index), Vec3::X * 3.0, 0.01);
        assert_near(rigs.place(pin), target, 0.0);
        assert!((rigs.place(bob).distance(target) - 1.0).abs() < 1e-3);
    }
    rigs.steps(1);
    assert_near(rigs.velocity(pin), Vec3::ZERO, 1e-6);
}

#[test]
fn a_rig_at_rest_does_not_touch_its_transforms() {
    #[derive(Resource, Default)]
    struct Writes(usize);
    fn count_writes(mut writes: ResMut<Writes>, written: Query<(), (With<Particle>, Changed<Transform>)>) {
        writes.0 += written.iter().count();
    }
    let mut rigs = Rigs::with_drag(2.0);
    rigs.app.init_resource::<Writes>().add_systems(Last, count_writes);
    let chain = rigs.chain(Vec3::Y * 5.0, Vec3::new(0.5, 4.0, 0.0), 4, [true, false]);
    rigs.steps(10);
    assert!(rigs.app.world().resource::<Writes>().0 > 10);
    rigs.seconds(15.0);
    assert_eq!(rigs.activity(chain[0]), Activity::Resting);
    rigs.app.world_mut().resource_mut::<Writes>().0 = 0;
    rigs.steps(10);
    assert_eq!(rigs.app.world().resource::<Writes>().0, 0);
}
