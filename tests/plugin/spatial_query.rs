//! Queries for bodies by place. Nothing here has a mesh, and nothing but the first scene has weight.

use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_drape::body::Sticks;
use bevy_drape::prelude::*;
use bevy_drape::ray_cast::{BodyHit, cast_ray};
use bevy_drape::spatial_query::{DrapeQueryFilter, DrapeSpatialQuery};

use crate::common::*;
use crate::operations::Dice;

/// Thickness of everything here, in metres.
const THICKNESS: f32 = 0.02;
/// Layer of what stands at the back.
const BACK: u32 = 1 << 4;

fn thick() -> BodySurface {
    BodySurface { thickness: THICKNESS, ..quiet() }
}

/// A square of one metre in the plane z = 0, another at z = -1 of the layer [`BACK`], and an upright rope of two metres
/// at x = 3, all without weight.
fn scene() -> (App, [Entity; 3]) {
    let mut app = app();
    weightless(&mut app);
    let world = app.world_mut();
    let front = world.spawn((curtain(), thick())).id();
    let layers = DrapeLayers::new(BACK, DrapeLayers::ALL_LAYERS);
    let back = world.spawn((curtain(), thick(), layers, Transform::from_xyz(0.0, 0.0, -1.0))).id();
    let rope =
        world.spawn((Rope::new(Vec3::new(3.0, 1.0, 0.0), Vec3::new(3.0, -1.0, 0.0), 21), thick())).id();
    step(&mut app, 1);
    (app, [front, back, rope])
}

/// The answer to a question.
fn ask<T: 'static>(app: &mut App, question: impl Fn(&DrapeSpatialQuery) -> T + Send + Sync + 'static) -> T {
    app.world_mut().run_system_once(move |bodies: DrapeSpatialQuery| question(&bodies)).expect("it runs")
}

fn all() -> DrapeQueryFilter<'static> {
    DrapeQueryFilter::default()
}

/// Along -Z.
fn ray(from: Vec3) -> Ray3d {
    Ray3d::new(from, Dir3::NEG_Z)
}

/// The hit of a ray along -Z of ten metres.
fn seen(app: &mut App, from: Vec3) -> Option<(Entity, BodyHit)> {
    ask(app, move |bodies| bodies.cast_ray(ray(from), 10.0, &all()))
}

fn is_near(a: f32, b: f32) -> bool {
    (a - b).abs() < 1e-5
}

#[test]
fn rays_through_folds_hit_what_casts_on_each_body_hit() {
    let mut app = app();
    app.insert_resource(Wind { velocity: Vec3::new(1.0, 0.5, 4.0), ..default() });
    let world = app.world_mut();
    let bodies = [
        world.spawn((curtain(), thick())).id(),
        world.spawn((free_cloth(), thick(), Transform::from_xyz(0.3, 0.5, 0.5))).id(),
        world.spawn((Rope::new(Vec3::new(-0.6, 0.5, 0.2), Vec3::new(0.6, 0.5, 0.2), 30), thick())).id(),
        world.spawn((SoftBall::new(0.3), thick(), Transform::from_xyz(-0.3, 0.4, 0.3))).id(),
    ];
    run(&mut app, 0.4);
    let mut dice = Dice::new(21);
    let mut hits = [0; 4];
    for _ in 0..3000 {
        let (from, to) = (dice.vector(3.0), dice.vector(0.6));
        let ray = Ray3d::new(from, Dir3::new(to - from).expect("a length"));
        let reach = dice.of(&[9.0, 9.0, 3.0, -1.0]);
        let apart = bodies.map(|body| {
            let (particles, sticks) = (get::<Particles>(&app, body), get::<Sticks>(&app, body));
            cast_ray(ray, reach, particles, sticks, THICKNESS).map(|hit| (body, hit))
        });
        let mut apart: Vec<_> = apart.into_iter().flatten().collect();
        apart.sort_by(|(_, one), (_, other)| one.distance.total_cmp(&other.distance));
        let (first, all) = ask(&mut app, move |bodies| {
            (bodies.cast_ray(ray, reach, &all()), bodies.ray_hits(ray, reach, &all()))
        });
        assert_eq!(all, apart);
        assert_eq!(first, apart.first().copied());
        for (body, count) in bodies.iter().zip(&mut hits) {
            *count += usize::from(all.iter().any(|hit| hit.0 == *body));
        }
    }
    assert!(hits.iter().all(|&count| count > 10), "{hits:?}");
}

#[test]
fn a_ray_goes_as_far_as_it_reaches_and_hits_the_nearest() {
    let (mut app, [front, back, _]) = scene();
    let from = Vec3::new(0.1, 0.2, 2.0);
    let (body, hit) = seen(&mut app, from).expect("a hit");
    assert_eq!(body, front);
    assert!(is_near(hit.distance, 2.0) && hit.position.distance(from.with_z(0.0)) < 1e-5, "{hit:?}");
    assert!(hit.normal.distance(Vec3::Z) < 1e-5, "{hit:?}");
    let both = ask(&mut app, move |bodies| bodies.ray_hits(ray(from), 10.0, &all()));
    assert_eq!(both.iter().map(|hit| hit.0).collect::<Vec<_>>(), [front, back]);
    let from_behind = Ray3d::new(Vec3::new(0.1, 0.2, -2.0), Dir3::Z);
    let (body, hit) = ask(&mut app, move |bodies| bodies.cast_ray(from_behind, 10.0, &all())).expect("a hit");
    assert_eq!(body, back);
    assert!(hit.normal.distance(Vec3::NEG_Z) < 1e-5, "{hit:?}");

    let cut_off = ask(&mut app, move |bodies| bodies.cast_ray(ray(from), 1.99, &all()));
    assert_eq!(cut_off, None);
    assert_eq!(seen(&mut app, Vec3::new(0.6, 0.0, 2.0)), None, "beside it");
    assert_eq!(seen(&mut app, Vec3::new(0.0, 0.0, -1.1)), None, "with its back to them");
}

#[test]
fn a_ray_hits_a_rope_within_its_thickness() {
    let (mut app, [.., rope]) = scene();
    let aside = 0.6 * THICKNESS;
    let (body, hit) = seen(&mut app, Vec3::new(3.0 + aside, 0.03, 2.0)).expect("a hit");
    assert_eq!(body, rope);
    assert!(is_near(hit.distance, 2.0 - 0.8 * THICKNESS), "{hit:?}");
    assert!(hit.normal.distance(Vec3::new(0.6, 0.0, 0.8)) < 1e-3, "{hit:?}");
    assert_eq!(hit.particle, 10, "that at the origin");
    assert_eq!(seen(&mut app, Vec3::new(3.0 + 1.1 * THICKNESS, 0.03, 2.0)), None);
    // Along the rope it hits the round end.
    let down = Ray3d::new(Vec3::new(3.0, 2.0, 0.0), Dir3::NEG_Y);
    let (_, hit) = ask(&mut app, move |bodies| bodies.cast_ray(down, 10.0, &all())).expect("a hit");
    assert!(is_near(hit.distance, 1.0 - THICKNESS) && hit.particle == 0, "{hit:?}");
}

#[test]
fn of_bodies_in_one_place_the_oldest_is_hit() {
    let mut app = app();
    weightless(&mut app);
    let twins = [0; 2].map(|_| app.world_mut().spawn(curtain()).id());
    step(&mut app, 1);
    for moved in twins {
        // A further component puts the entity behind all others in the tables of Bevy.
        app.world_mut().entity_mut(moved).insert(DrapeLayers::default());
        let from = Vec3::new(0.1, 0.2, 2.0);
        assert_eq!(seen(&mut app, from).expect("a hit").0, twins[0]);
        let (hits, touched) = ask(&mut app, move |bodies| {
            (bodies.ray_hits(ray(from), 10.0, &all()), bodies.sphere_intersections(Vec3::ZERO, 0.1, &all()))
        });
        assert_eq!(hits.iter().map(|hit| hit.0).collect::<Vec<_>>(), twins);
        assert_eq!(touched, twins);
        app.world_mut().entity_mut(moved).remove::<DrapeLayers>();
    }
}

#[test]
fn the_filter_leaves_out_layers_entities_and_what_the_predicate_refuses() {
    let (mut app, [front, back, _]) = scene();
    let only = |app: &mut App, filter: DrapeQueryFilter<'static>| {
        let point = Vec3::new(0.1, 0.2, 0.3);
        ask(app, move |bodies| {
            let found = [
                bodies.cast_ray(ray(point), 10.0, &filter).map(|hit| hit.0),
                bodies.cast_sphere(ray(point), 0.1, 10.0, &filter).map(|hit| hit.0),
                bodies.project_point(point, 2.0, &filter).map(|hit| hit.0),
                bodies.ray_hits(ray(point), 10.0, &filter).first().map(|hit| hit.0),
                bodies.sphere_intersections(point, 2.0, &filter).first().copied(),
            ];
            assert!(found.iter().all(|&other| other == found[0]), "{found:?}");
            found[0]
        })
    };
    assert_eq!(only(&mut app, all()), Some(front));
    // The one in front belongs to all layers.
    assert_eq!(only(&mut app, DrapeQueryFilter::from_mask(BACK)), Some(front));
    app.world_mut().entity_mut(front).insert(DrapeLayers::new(1, DrapeLayers::ALL_LAYERS));
    assert_eq!(only(&mut app, DrapeQueryFilter::from_mask(BACK)), Some(back));
    assert_eq!(only(&mut app, DrapeQueryFilter::from_mask(1 | BACK)), Some(front));
    assert_eq!(only(&mut app, DrapeQueryFilter::from_mask(2)), None);
    assert_eq!(only(&mut app, DrapeQueryFilter::from_excluded_entities([front])), Some(back));
    assert_eq!(only(&mut app, DrapeQueryFilter::from_excluded_entities([back])), Some(front));
    assert_eq!(only(&mut app, all().with_excluded_entities([back]).with_mask(BACK)), None);
    assert_eq!(only(&mut app, DrapeQueryFilter { predicate: Some(&|_| false), ..all() }), None);
    let nearest = ask(&mut app, move |bodies| {
        let is_back = |body| body == back;
        let filter = all().with_predicate(&is_back);
        bodies.project_point(Vec3::new(0.1, 0.2, 0.3), 2.0, &filter)
    });
    assert_eq!(nearest.expect("the one at the back").0, back);
}

#[test]
fn the_nearest_point_is_that_of_a_square_or_of_a_capsule() {
    let (mut app, [front, _, rope]) = scene();
    let mut dice = Dice::new(3);
    for _ in 0..500 {
        let point = dice.vector(0.9).with_z(dice.about(0.4).abs());
        let on_square = point.clamp(Vec3::new(-0.5, -0.5, 0.0), Vec3::new(0.5, 0.5, 0.0));
        let near = point + Vec3::X * 3.0;
        let on_axis = Vec3::new(3.0, near.y.clamp(-1.0, 1.0), 0.0);
        let (square, capsule) = ask(&mut app, move |bodies| {
            let without_rope = DrapeQueryFilter::from_excluded_entities([rope]);
            (bodies.project_point(point, 5.0, &without_rope), bodies.project_point(near, 5.0, &all()))
        });
        let (body, hit) = square.expect("the square");
        assert_eq!(body, front);
        assert!(is_near(hit.distance, point.distance(on_square)), "{point}: {hit:?}");
        assert!(hit.position.distance(on_square) < 1e-4, "{point}: {hit:?}");
        assert!((hit.position + hit.normal * hit.distance).distance(point) < 1e-4, "{point}: {hit:?}");
        let (body, hit) = capsule.expect("the rope");
        let depth = THICKNESS - near.distance(on_axis);
        assert_eq!(body, rope);
        assert!(is_near(hit.distance, (-depth).max(0.0)), "{near}: {hit:?}");
        let on_capsule = if depth > 0.0 { near } else { near + hit.normal * depth };
        assert!(hit.position.distance(on_capsule) < 1e-4, "{near}: {hit:?}");
    }
    let inside = Vec3::new(3.0 + 0.3 * THICKNESS, 0.33, -0.4 * THICKNESS);
    let (_, hit) = ask(&mut app, move |bodies| bodies.project_point(inside, 5.0, &all())).expect("the rope");
    assert_eq!((hit.distance, hit.position), (0.0, inside), "a point in a rope is its own nearest");
    assert!(hit.normal.distance(Vec3::new(0.6, 0.0, -0.8)) < 1e-3, "{hit:?}");
    let [beyond, within] = ask(&mut app, |bodies| {
        [0.19, 0.21].map(|reach| bodies.project_point(Vec3::Z * 0.2, reach, &all()).is_some())
    });
    assert!(!beyond && within);
}

#[test]
fn a_sphere_touches_the_bodies_that_reach_into_it() {
    let (mut app, [front, back, rope]) = scene();
    let touched = |app: &mut App, centre: Vec3, radius: f32| {
        ask(app, move |bodies| bodies.sphere_intersections(centre, radius, &all()))
    };
    let point = Vec3::new(0.03, 0.04, 0.2);
    assert_eq!(touched(&mut app, point, 0.199), []);
    assert_eq!(touched(&mut app, point, 0.201), [front]);
    assert_eq!(touched(&mut app, point, 1.199), [front]);
    assert_eq!(touched(&mut app, point, 1.201), [front, back]);
    // Its box reaches into the square's at the corner, the sphere does not.
    let corner = Vec3::new(0.58, 0.58, 0.0);
    assert_eq!(touched(&mut app, corner, 0.11), []);
    assert_eq!(touched(&mut app, corner, 0.12), [front]);
    let beside = Vec3::new(3.3, 0.0, 0.0);
    assert_eq!(touched(&mut app, beside, 0.299 - THICKNESS), []);
    assert_eq!(touched(&mut app, beside, 0.301 - THICKNESS), [rope]);
    assert_eq!(touched(&mut app, Vec3::ZERO, 0.0), [front], "a point on it");
}

#[test]
fn a_sphere_moves_until_it_touches_a_face_an_edge_or_a_rope() {
    let (mut app, [front, back, rope]) = scene();
    let cast = |app: &mut App, from: Vec3, radius: f32| {
        ask(app, move |bodies| bodies.cast_sphere(ray(from), radius, 10.0, &all()))
    };
    let (body, hit) = cast(&mut app, Vec3::new(0.1, 0.2, 2.0), 0.25).expect("the face");
    assert_eq!(body, front);
    assert!(is_near(hit.distance, 1.75), "{hit:?}");
    assert!(hit.position.distance(Vec3::new(0.1, 0.2, 0.0)) < 1e-4 && hit.normal.distance(Vec3::Z) < 1e-4);
    // The centre passes 15 cm beside the edge, and then beside the corner, 15 cm in each direction.
    for from in [Vec3::new(0.65, 0.2, 2.0), Vec3::new(-0.65, -0.65, 2.0)] {
        let edge = from.clamp(Vec3::new(-0.5, -0.5, 0.0), Vec3::new(0.5, 0.5, 0.0));
        let aside = from.distance_squared(edge) - 4.0;
        let (body, hit) = cast(&mut app, from, 0.25).expect("the edge");
        assert_eq!(body, front);
        assert!(is_near(hit.distance, 2.0 - (0.0625 - aside).sqrt()), "{hit:?}");
        assert!(hit.position.distance(edge) < 1e-4, "{hit:?}");
        assert_eq!(cast(&mut app, from, aside.sqrt() - 1e-3), None);
    }
    let (body, hit) = cast(&mut app, Vec3::new(3.06, 0.0, 2.0), 0.1 - THICKNESS).expect("the rope");
    assert_eq!(body, rope);
    assert!(is_near(hit.distance, 2.0 - 0.08), "{hit:?}");
    let touch = Vec3::new(3.0, 0.0, 0.0) + Vec3::new(0.6, 0.0, 0.8) * THICKNESS;
    assert!(hit.position.distance(touch) < 1e-4, "{hit:?}");
    // Within its radius of a body it is there already, wherever it goes.
    let (body, hit) = cast(&mut app, Vec3::new(0.1, 0.2, -0.8), 0.25).expect("it touches");
    assert_eq!((body, hit.distance), (back, 0.0));
    assert!(hit.position.distance(Vec3::new(0.1, 0.2, -1.0)) < 1e-4 && hit.normal.distance(Vec3::Z) < 1e-4);
    let along = Ray3d::new(Vec3::new(0.0, 0.0, 0.05), Dir3::X);
    let hit = ask(&mut app, move |bodies| bodies.cast_sphere(along, 0.1, 0.0, &all()));
    assert_eq!(hit.expect("it touches").0, front);
}

/// It touches nothing before the distance, and something there.
#[test]
fn a_sphere_cast_at_folds_ends_where_the_nearest_point_is_its_radius_away() {
    let mut app = app();
    app.insert_resource(Wind { velocity: Vec3::new(1.0, 0.5, 4.0), ..default() });
    app.world_mut().spawn((curtain(), thick()));
    app.world_mut().spawn((Rope::new(Vec3::new(-0.6, 0.2, 0.4), Vec3::new(0.6, 0.2, 0.4), 30), thick()));
    run(&mut app, 0.4);
    let mut dice = Dice::new(8);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..1000 {
        let (from, to, radius) = (dice.vector(1.5), dice.vector(1.0), dice.of(&[0.001, 0.03, 0.3]));
        let ray = Ray3d::new(from, Dir3::new(to - from).expect("a length"));
        let hit = ask(&mut app, move |bodies| bodies.cast_sphere(ray, radius, 2.0, &all()));
        let way = hit.map_or(2.0, |(_, hit)| hit.distance);
        let nearest = ask(&mut app, move |bodies| {
            let on_way = (0..=100).map(|i| ray.get_point(way * i as f32 / 100.0));
            let away = on_way.map(|point| bodies.project_point(point, 9.0, &all()).expect("both are near"));
            let away: Vec<_> = away.map(|(_, nearest)| nearest.distance - radius).collect();
            away
        });
        let least = nearest.iter().copied().fold(f32::INFINITY, f32::min);
        if let Some((_, hit)) = hit {
            hits += 1;
            let at_end = nearest[100];
            assert!(at_end.abs() < 1e-4 || (way == 0.0 && at_end < 0.0), "{at_end} m away, {hit:?}");
            assert!(way == 0.0 || least > -1e-4, "{least} m inside on its way, {hit:?}");
        } else {
            misses += 1;
            assert!(least > -1e-4, "{least} m inside, and no hit");
        }
    }
    assert!(hits > 200 && misses > 200, "{hits} hits, {misses} misses");
}

#[test]
fn a_sphere_without_a_radius_hits_what_a_ray_hits() {
    let (mut app, _) = scene();
    let mut dice = Dice::new(5);
    for _ in 0..300 {
        let (from, to) = (dice.vector(2.0).with_z(1.5), dice.vector(0.6));
        let ray = Ray3d::new(from, Dir3::new(to - from).expect("a length"));
        let (sphere, ray) = ask(&mut app, move |bodies| {
            (bodies.cast_sphere(ray, 0.0, 9.0, &all()), bodies.cast_ray(ray, 9.0, &all()))
        });
        let distance = |hit: Option<(Entity, BodyHit)>| hit.map_or(-1.0, |(_, hit)| hit.distance);
        assert_eq!(sphere.map(|hit| hit.0), ray.map(|hit| hit.0));
        assert!(is_near(distance(sphere), distance(ray)), "{sphere:?}, {ray:?}");
    }
}
