//! Queries find bodies in any state, and only those that are there.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_drape::body::{Activity, Sticks};
use bevy_drape::prelude::*;
use bevy_drape::ray_cast::BodyHit;
use bevy_drape::sleep::SceneManager;
use bevy_drape::spatial_query::{DrapeQueryFilter, DrapeSpatialQuery};
use drape_solver::ClothBuilder;

use crate::common::*;

/// The first hit of a ray along -Z from two metres before `at`.
fn look(app: &mut App, at: Vec3) -> Option<(Entity, BodyHit)> {
    let ray = Ray3d::new(at + Vec3::Z * 2.0, Dir3::NEG_Z);
    let look = move |bodies: DrapeSpatialQuery| bodies.cast_ray(ray, 10.0, &DrapeQueryFilter::default());
    app.world_mut().run_system_once(look).expect("it runs")
}

/// The body that a ray along -Z, a nearest point and a sphere at `at` find.
fn found(app: &mut App, at: Vec3) -> Option<Entity> {
    let seen = look(app, at).map(|hit| hit.0);
    let look = move |bodies: DrapeSpatialQuery| {
        let all = DrapeQueryFilter::default();
        let near = bodies.project_point(at, 0.3, &all).map(|hit| hit.0);
        (near, bodies.sphere_intersections(at, 0.3, &all).first().copied())
    };
    let others = app.world_mut().run_system_once(look).expect("it runs");
    assert_eq!(others, (seen, seen));
    seen
}

/// A curtain without weight, where its entity is.
fn place(app: &mut App, at: Vec3) -> Entity {
    weightless(app);
    let curtain = app.world_mut().spawn((curtain(), Transform::from_translation(at))).id();
    step(app, 1);
    curtain
}

#[test]
fn a_sleeping_curtain_is_found_where_it_hangs() {
    let mut app = app();
    let curtain = app.world_mut().spawn((curtain(), quiet())).id();
    settle(&mut app, curtain);
    let at = centre(&app, curtain);
    assert_eq!(found(&mut app, at), Some(curtain));
    assert_eq!(activity(&app, curtain), Activity::Resting, "looking does not wake it");
    assert_eq!(found(&mut app, at + Vec3::X * 2.0), None);
}

#[test]
fn a_body_is_found_as_exactly_as_single_precision_has_its_place() {
    for far in [Vec3::new(-800.0, 600.0, 900.0), Vec3::new(2e4, 1e4, -3e4)] {
        let mut app = app();
        app.insert_resource(SceneManager {
            play_area_min: Vec3::splat(-1e6),
            play_area_max: Vec3::splat(1e6),
            ..default()
        });
        let curtain = place(&mut app, far);
        let (body, hit) = look(&mut app, far + Vec3::new(0.2, -0.1, 0.0)).expect("a hit");
        let rounding = far.abs().max_element() * f32::EPSILON;
        assert_eq!(body, curtain);
        assert!((hit.distance - 2.0).abs() < 2.0 * rounding, "{hit:?}");
        assert!(hit.normal.distance(Vec3::Z) < 1e-3, "{hit:?}");
        assert_eq!(look(&mut app, far + Vec3::X * 0.6), None);
        // From a kilometre away, too.
        let ray = Ray3d::new(far + Vec3::Z * 1000.0, Dir3::NEG_Z);
        let look = move |bodies: DrapeSpatialQuery| bodies.cast_ray(ray, f32::INFINITY, &default());
        let (_, hit) = app.world_mut().run_system_once(look).expect("it runs").expect("a hit");
        assert!((hit.distance - 1000.0).abs() < 1e-3 + 2.0 * rounding, "{hit:?}");
    }
}

#[test]
fn what_is_despawned_or_no_longer_a_body_is_not_found() {
    for keep_entity in [false, true] {
        let mut app = app();
        let curtain = place(&mut app, Vec3::ZERO);
        assert_eq!(found(&mut app, Vec3::ZERO), Some(curtain));
        if keep_entity {
            app.world_mut().entity_mut(curtain).remove::<Cloth>();
        } else {
            app.world_mut().despawn(curtain);
        }
        assert_eq!(found(&mut app, Vec3::ZERO), None);
        step(&mut app, 1);
        assert_eq!(found(&mut app, Vec3::ZERO), None);
    }
}

#[test]
fn a_hidden_mesh_hides_nothing_and_a_disabled_entity_is_not_there() {
    let mut app = app();
    let curtain = place(&mut app, Vec3::ZERO);
    app.world_mut().entity_mut(curtain).insert((Mesh3d::default(), Visibility::Hidden));
    assert_eq!(found(&mut app, Vec3::ZERO), Some(curtain));
    app.world_mut().entity_mut(curtain).remove::<Mesh3d>();
    assert_eq!(found(&mut app, Vec3::ZERO), Some(curtain));
    app.world_mut().entity_mut(curtain).insert(Disabled);
    assert_eq!(found(&mut app, Vec3::ZERO), None);
    app.world_mut().entity_mut(curtain).remove::<Disabled>();
    assert_eq!(found(&mut app, Vec3::ZERO), Some(curtain));
}

#[test]
fn what_is_culled_is_not_found_and_what_is_frozen_is() {
    let mut app = app();
    let curtain = place(&mut app, Vec3::ZERO);
    *get_mut::<Activity>(&mut app, curtain) = Activity::Frozen;
    assert_eq!(found(&mut app, Vec3::ZERO), Some(curtain));
    *get_mut::<Activity>(&mut app, curtain) = Activity::Active;
    app.insert_resource(SceneManager { play_area_min: Vec3::splat(5.0), ..default() });
    step(&mut app, 1);
    assert_eq!(activity(&app, curtain), Activity::Culled);
    assert_eq!(found(&mut app, Vec3::ZERO), None);
    app.insert_resource(SceneManager::default());
    step(&mut app, 1);
    assert_eq!(found(&mut app, Vec3::ZERO), Some(curtain));
}

#[test]
fn an_edit_counts_before_the_next_step() {
    let mut app = app();
    let curtain = place(&mut app, Vec3::ZERO);
    get_mut::<Particles>(&mut app, curtain).translate(Vec3::new(5.0, 0.0, 1.0));
    assert_eq!(found(&mut app, Vec3::new(5.0, 0.0, 1.0)), Some(curtain));
    assert_eq!(found(&mut app, Vec3::ZERO), None);
}

#[test]
fn particles_that_the_game_made_are_found_before_their_first_step() {
    let mut app = app();
    let builder = ClothBuilder::new(1.0, 1.0, 5, 5).placed(Vec3::new(7.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y);
    let (particles, sticks) = builder.build_parts().expect("valid");
    let body = app.world_mut().spawn((Particles(particles), Sticks(sticks.into()))).id();
    assert_eq!(found(&mut app, Vec3::X * 8.0), Some(body));
}

#[test]
fn numbers_that_are_none_find_nothing_and_hide_nothing() {
    let mut app = app();
    let broken = place(&mut app, Vec3::new(0.0, 0.0, 0.5));
    let curtain = place(&mut app, Vec3::ZERO);
    let rope = app.world_mut().spawn(Rope::new(Vec3::new(2.0, 0.5, 0.0), Vec3::new(2.0, -0.5, 0.0), 5)).id();
    step(&mut app, 1);
    let mut particles = get_mut::<Particles>(&mut app, broken);
    (0..particles.len()).for_each(|i| particles.set_position(i, Vec3::NAN));
    let mut particles = get_mut::<Particles>(&mut app, rope);
    (1..5).for_each(|i| particles.set_position(i, Vec3::new(2.0, 0.0, 0.0)));
    let ask = move |bodies: DrapeSpatialQuery| {
        let all = DrapeQueryFilter::default();
        let ray = |from: Vec3| Ray3d::new(from, Dir3::NEG_Z);
        let good = Vec3::new(0.1, 0.2, 1.0);
        let hits = |from: Vec3, radius: f32, reach: f32| {
            [
                bodies.cast_ray(ray(from), reach, &all).map(|hit| hit.0),
                bodies.ray_hits(ray(from), reach, &all).first().map(|hit| hit.0),
                bodies.cast_sphere(ray(from), radius, reach, &all).map(|hit| hit.0),
                bodies.project_point(from, reach, &all).map(|hit| hit.0),
                bodies.sphere_intersections(from, reach, &all).first().copied(),
            ]
        };
        assert_eq!(hits(good, 0.1, 3.0), [Some(curtain); 5]);
        assert_eq!(hits(good, 0.0, f32::INFINITY), [Some(curtain); 5]);
        for bad in BAD {
            for axis in Vec3::AXES {
                assert_eq!(hits(good + axis * bad, 0.1, 3.0), [None; 5]);
            }
        }
        for reach in [f32::NAN, f32::NEG_INFINITY, -1.0, -f32::MIN_POSITIVE] {
            assert_eq!(hits(good, 0.1, reach), [None; 5], "{reach}");
            assert_eq!(hits(good.with_z(0.05), 0.1, reach), [None; 5], "{reach}, in touch");
        }
        for radius in [f32::NAN, f32::NEG_INFINITY, -0.1] {
            assert_eq!(bodies.cast_sphere(ray(good), radius, 3.0, &all), None, "{radius}");
        }
        let everything = bodies.cast_sphere(ray(good), f32::INFINITY, 3.0, &all).expect("it touches");
        assert_eq!((everything.0, everything.1.distance), (curtain, 0.0));
        // A link without length is a sphere.
        let knot = Vec3::new(2.0, 0.0, 1.0);
        assert!(bodies.cast_ray(ray(knot), 3.0, &all).is_some_and(|hit| hit.0 == rope));
        assert!(bodies.project_point(Vec3::NAN, 3.0, &all).is_none());
    };
    app.world_mut().run_system_once(ask).expect("it runs");
}
