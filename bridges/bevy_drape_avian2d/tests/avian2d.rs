//! Colliders of Avian 2D as obstacles of ropes and cloth in the plane.

use std::time::Duration;

use avian2d::prelude::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::attach::PlaneLock;
use bevy_drape::prelude::*;
use bevy_drape_avian2d::{Avian2dDrapePlugin, ColliderObstacle, NoObstacle};

/// Bevy's default fixed step.
const TIMESTEP: Duration = Duration::from_micros(15_625);

fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .insert_resource(TimeUpdateStrategy::ManualDuration(TIMESTEP))
        .add_plugins((PhysicsPlugins::default(), DrapePlugins::default(), Avian2dDrapePlugin::default()))
        .insert_resource(Gravity(Vec2::NEG_Y * 9.81));
    app.finish();
    app.cleanup();
    app.update();
    app
}

fn run(app: &mut App, seconds: f32) {
    for _ in 0..(seconds / TIMESTEP.as_secs_f32()).round() as usize {
        app.update();
    }
}

/// Parry cannot tell if voxels touch a half-space, and panics.
fn ground(app: &mut App) {
    let place = Transform::from_xyz(0.0, -0.5, 0.0);
    app.world_mut().spawn((RigidBody::Static, Collider::rectangle(500.0, 1.0), place));
}

/// Spawns something at this X and height in metres.
type Hang = fn(&mut App, f32, f32) -> Entity;

/// A rope of 0.8 m that lies in the air, about a point.
fn rope(app: &mut App, x: f32, height: f32) -> Entity {
    let middle = Vec3::new(x, height, 0.0);
    let rope = Rope::new(middle - Vec3::X * 0.4, middle + Vec3::X * 0.4, 33);
    app.world_mut().spawn((Rope { pin_start: false, ..rope }, PlaneLock::default())).id()
}

/// A strip of cloth of the same length.
fn strip(app: &mut App, x: f32, height: f32) -> Entity {
    let strip = Cloth::new(0.8, 0.05).with_particles(33, 3).with_pins(ClothPins::None);
    app.world_mut().spawn((strip, PlaneLock::default(), Transform::from_xyz(x, height + 0.025, 0.0))).id()
}

fn places(app: &App, body: Entity) -> Vec<Vec3> {
    app.world().get::<Particles>(body).expect("the body is built").positions().collect()
}

fn least(app: &App, body: Entity) -> f32 {
    places(app, body).iter().map(|place| place.y).fold(f32::INFINITY, f32::min)
}

fn greatest(app: &App, body: Entity) -> f32 {
    places(app, body).iter().map(|place| place.y).fold(f32::NEG_INFINITY, f32::max)
}

fn assert_in_plane(app: &App, body: Entity, about: &str) {
    for place in places(app, body) {
        assert!(place.is_finite() && place.z.abs() < 1.1e-5, "{about}: a particle is at {place}");
    }
}

/// True if a particle is inside the collider, as Avian sees it.
fn is_any_inside(app: &App, collider: Entity, body: Entity) -> bool {
    let entity = app.world().entity(collider);
    let placed = entity.get_components::<(&Collider, &Position, &Rotation)>();
    let (collider, position, rotation) = placed.expect("it is one, in its place");
    places(app, body).iter().any(|place| collider.contains_point(position.0, *rotation, place.truncate()))
}

/// Height of the collider within the length of a rope, as Avian sees it.
fn top(app: &App, collider: Entity) -> f32 {
    let entity = app.world().entity(collider);
    let placed = entity.get_components::<(&Collider, &Position, &Rotation)>();
    let (collider, position, rotation) = placed.expect("it is one, in its place");
    let columns = (-40..=40).map(|step| position.x + step as f32 * 0.01);
    let height = |x| {
        let above = Vec2::new(x, 2.0);
        let contains = |y: f32| collider.contains_point(position.0, *rotation, Vec2::new(x, y));
        let solid = (0..300).map(|step| 2.0 - 0.005 * step as f32).find(|&y| contains(y));
        let thin = || collider.cast_ray(position.0, *rotation, above, Vec2::NEG_Y, 3.0, true);
        solid.or_else(|| Some(above.y - thin()?.0))
    };
    columns.filter_map(height).fold(f32::NEG_INFINITY, f32::max)
}

fn shapes() -> Vec<(&'static str, Collider)> {
    let vertices =
        [[-0.3, -0.2], [0.3, -0.2], [0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, 0.2]].map(Vec2::from);
    let roof = [[-0.5, -0.1], [0.0, 0.0], [0.5, -0.1]].map(Vec2::from);
    let hexagon =
        [[0.3, 0.1], [0.0, 0.2], [-0.3, 0.1], [-0.3, -0.1], [0.0, -0.2], [0.3, -0.1]].map(Vec2::from);
    let [left, top, right] = [[-0.4, -0.2], [0.0, 0.2], [0.4, -0.2]].map(Vec2::from);
    let voxels = [[-2, 0], [-1, 0], [0, 0], [1, 0], [-1, -1], [1, -2]].map(IVec2::from);
    let part = |x| (Vec2::X * x, Rotation::degrees(90.0), Collider::capsule(0.15, 0.1));
    vec![
        ("circle", Collider::circle(0.3)),
        ("ellipse", Collider::ellipse(0.4, 0.2)),
        ("rectangle", Collider::rectangle(0.6, 0.4)),
        ("round rectangle", Collider::round_rectangle(0.5, 0.3, 0.05)),
        ("capsule", Collider::capsule(0.2, 0.3)),
        ("triangle", Collider::triangle(left, top, right)),
        // Clockwise.
        ("unchecked triangle", Collider::triangle_unchecked(left, top, right)),
        ("regular polygon", Collider::regular_polygon(0.3, 7)),
        ("convex hull", Collider::convex_hull(&hexagon).expect("it has an area")),
        ("segment", Collider::segment(Vec2::NEG_X * 0.5, Vec2::X * 0.5)),
        ("polyline", Collider::polyline(roof.to_vec(), None)),
        // The triangles share no vertices, and the second is clockwise.
        ("trimesh", Collider::trimesh(vertices.to_vec(), vec![[0, 1, 2], [3, 5, 4]])),
        ("height field", Collider::heightfield(vec![0.0, 0.05, 0.1, 0.05, 0.0], Vec2::new(2.0, 1.0))),
        ("voxels", Collider::voxels(Vec2::splat(0.2), &voxels)),
        ("compound", Collider::compound(vec![part(-0.16), part(0.16)])),
    ]
}

#[test]
fn ropes_and_cloth_come_to_rest_on_every_shape_of_static_and_kinematic_bodies() {
    for (body, scale) in [(RigidBody::Static, Vec3::ONE), (RigidBody::Kinematic, Vec3::new(1.2, 0.7, 1.0))] {
        let mut app = app();
        // Whatever slips off is caught.
        ground(&mut app);
        let mut cases = Vec::new();
        for (name, collider) in shapes() {
            for hang in [rope as Hang, strip] {
                let x = 3.0 * (cases.len() as f32 - 15.0);
                let place = Transform::from_xyz(x, 1.0, 0.0).with_scale(scale);
                let obstacle = app.world_mut().spawn((body, collider.clone(), place)).id();
                cases.push((format!("{name}, {body:?}, at {x}"), x, obstacle, hang));
            }
        }
        run(&mut app, 0.1);
        let hang = |(about, x, obstacle, hang): (String, f32, Entity, Hang)| {
            let top = top(&app, obstacle);
            (about, obstacle, top, hang(&mut app, x, top + 0.1))
        };
        let cases: Vec<_> = cases.into_iter().map(hang).collect();
        run(&mut app, 4.0);
        for (about, obstacle, top, cloth) in cases {
            let highest = greatest(&app, cloth);
            assert!((-0.005..0.06).contains(&(highest - top)), "{about}: it lies at {highest}, not {top}");
            assert!(least(&app, cloth) > -1e-3, "{about}: it is below the ground");
            assert!(!is_any_inside(&app, obstacle, cloth), "{about}: it is inside");
            assert_in_plane(&app, cloth, &about);
        }
    }
}

#[test]
fn solids_have_the_outlines_that_avian_has() {
    for scale in [Vec2::ONE, Vec2::new(1.2, 0.7), Vec2::splat(2.0)] {
        let mut app = app();
        let place = Transform::from_scale(scale.extend(1.0));
        let spawn =
            |(name, collider)| (name, app.world_mut().spawn((RigidBody::Static, collider, place)).id());
        let cases: Vec<_> = shapes().into_iter().map(spawn).collect();
        run(&mut app, 0.1);
        for (name, entity) in cases {
            let mut collider = app.world().get::<Collider>(entity).expect("it has one").clone();
            if name == "trimesh" {
                // Parry's is hollow where a triangle is clockwise.
                collider = Collider::rectangle(0.6 * scale.x, 0.4 * scale.y);
            }
            let obstacle = app.world().get::<Obstacle>(entity).expect("it is one");
            let solid = obstacle.shape.solid(None).expect("valid").expect("made in code");
            let solid = solid.scaled(scale.extend(1.0)).expect("valid");
            for point in (0..1600).map(|i| Vec2::new((i % 40) as f32 - 19.7, (i / 40) as f32 - 19.3) * 0.04) {
                let is_inside = collider.contains_point(Vec2::ZERO, 0.0, point);
                let avian = collider.distance_to_point(Vec2::ZERO, 0.0, point, true);
                let ours = solid.distance(point.extend(0.0));
                if name == "height field" {
                    // Avian's is a line.
                    assert!(
                        point.x.abs() > scale.x || ours.abs() < avian + 1e-3,
                        "{name} at {point}: {ours}"
                    );
                } else if is_inside {
                    assert!(ours < 1e-3, "{name} at {point}, scaled by {scale}: {ours} inside");
                } else {
                    let error = (ours - avian).abs();
                    assert!(
                        error < 2e-3 * scale.x,
                        "{name} at {point}, scaled by {scale}: {ours}, not {avian}"
                    );
                }
            }
        }
    }
}

#[test]
fn fast_bodies_push_a_rope_along_and_feel_nothing() {
    for body in [RigidBody::Kinematic, RigidBody::Dynamic] {
        for (collider, speed) in [(Collider::circle(0.2), 12.0), (Collider::rectangle(0.4, 0.4), 6.0)] {
            let mut app = app();
            let hanging = (Rope::new(Vec3::Y * 2.0, Vec3::Y * 0.5, 61), PlaneLock::default());
            let rope = app.world_mut().spawn(hanging).id();
            let velocity = Vec2::X * speed;
            let start = Transform::from_xyz(-0.5, 1.0, 0.0);
            let ball = (
                body,
                collider,
                start,
                LinearVelocity(velocity),
                GravityScale(0.0),
                LockedAxes::ROTATION_LOCKED,
            );
            let ball = app.world_mut().spawn(ball).id();
            run(&mut app, 0.8 / speed);
            let at = app.world().get::<Transform>(ball).expect("it is there").translation;
            assert!(at.x > 0.15, "it has gone to {at}");
            assert!(!is_any_inside(&app, ball, rope), "{body:?}: the rope is inside");
            let near = places(&app, rope).into_iter().filter(|place| (place.y - at.y).abs() < 0.1);
            let near: Vec<_> = near.collect();
            assert!(
                !near.is_empty() && near.iter().all(|place| place.x > at.x),
                "{body:?} at {at}: {near:?}"
            );
            assert_in_plane(&app, rope, "pushed");
            assert_eq!(app.world().get::<LinearVelocity>(ball).expect("it moves").0, velocity);
        }
    }
}

/// How high a rope lies above the ground after two seconds, if it fell on a slab whose top is at 1 m.
fn falls_on(prepare: impl FnOnce(&mut EntityWorldMut)) -> f32 {
    let mut app = app();
    ground(&mut app);
    let place = Transform::from_xyz(0.0, 0.9, 0.0);
    let mut slab = app.world_mut().spawn((RigidBody::Static, Collider::rectangle(1.0, 0.2), place));
    prepare(&mut slab);
    let rope = rope(&mut app, 0.0, 1.1);
    run(&mut app, 2.0);
    greatest(&app, rope)
}

#[test]
fn a_collider_can_be_left_out_and_sensors_stop_nothing() {
    assert!(falls_on(|_| {}) > 0.99);
    assert!(falls_on(|slab| _ = slab.insert(NoObstacle)) < 0.1);
    assert!(falls_on(|slab| _ = slab.insert(Sensor)) < 0.1);
    assert!(falls_on(|slab| _ = slab.insert(ColliderDisabled)) < 0.1);
    assert!(falls_on(|slab| _ = slab.insert(RigidBodyDisabled)) < 0.1);
    assert!(falls_on(|slab| _ = slab.insert(CollisionLayers::NONE)) < 0.1);
}

#[test]
fn the_z_of_a_collider_may_order_sprites() {
    assert!(falls_on(|slab| _ = slab.insert(Transform::from_xyz(0.0, 0.9, -5.0))) > 0.99);
    let circle = (Collider::circle(0.3), Transform::from_xyz(0.0, 0.7, 5.0));
    assert!(falls_on(|slab| _ = slab.insert(circle)) > 0.99);
}

#[test]
fn an_obstacle_comes_goes_and_changes_with_its_collider() {
    let mut app = app();
    ground(&mut app);
    let slab = app.world_mut().spawn((RigidBody::Static, Transform::from_xyz(0.0, 0.9, 0.0))).id();
    run(&mut app, 0.1);
    assert!(app.world().get::<Obstacle>(slab).is_none());

    app.world_mut().entity_mut(slab).insert(Collider::rectangle(1.0, 0.2));
    let rope = rope(&mut app, 0.0, 1.1);
    run(&mut app, 2.0);
    assert!((greatest(&app, rope) - 1.0).abs() < 0.03);

    *app.world_mut().get_mut::<Collider>(slab).expect("it has one") = Collider::rectangle(1.0, 0.4);
    run(&mut app, 1.0);
    let height = greatest(&app, rope);
    assert!((height - 1.1).abs() < 0.03, "a thicker slab lifts it to {height}");

    app.world_mut().get_mut::<Transform>(slab).expect("it has one").scale = Vec3::new(1.0, 0.5, 1.0);
    run(&mut app, 1.0);
    let height = greatest(&app, rope);
    assert!((height - 1.0).abs() < 0.03, "on a flat slab it lies at {height}");

    app.world_mut().entity_mut(slab).remove::<Collider>();
    run(&mut app, 2.0);
    let slab = app.world().entity(slab);
    assert!(!slab.contains::<Obstacle>() && !slab.contains::<ColliderObstacle>());
    assert!(greatest(&app, rope) < 0.1, "it has fallen to the ground");
}

#[test]
fn colliders_below_a_body_have_their_own_places_and_scales() {
    let mut app = app();
    let child = Transform::from_xyz(0.0, 0.5, 0.0).with_scale(Vec3::new(1.0, 0.2, 1.0));
    let body = (RigidBody::Static, Transform::from_xyz(0.0, 0.5, 0.0));
    app.world_mut().spawn((body, children![(Collider::round_rectangle(1.0, 0.8, 0.1), child)]));
    let rope = rope(&mut app, 0.0, 1.4);
    run(&mut app, 3.0);
    // The border keeps its width.
    assert!((greatest(&app, rope) - 1.18).abs() < 0.03, "it lies at {}", greatest(&app, rope));
}

#[test]
fn friction_and_restitution_are_those_of_the_collider_else_of_the_body_else_of_the_world() {
    let mut app = app();
    app.insert_resource(DefaultFriction(Friction::new(0.1)));
    let ours = |app: &App, entity| {
        let obstacle = app.world().get::<Obstacle>(entity).expect("it is an obstacle");
        (obstacle.friction, obstacle.restitution)
    };
    let collider = app.world_mut().spawn(Collider::circle(0.5)).id();
    let body = app.world_mut().spawn((RigidBody::Static, Restitution::new(0.4))).add_child(collider).id();
    run(&mut app, 0.1);
    assert_eq!(ours(&app, collider), (0.1, 0.4));
    app.world_mut().entity_mut(body).insert(Friction::new(0.7));
    run(&mut app, 0.1);
    assert_eq!(ours(&app, collider), (0.7, 0.4));
    app.world_mut().entity_mut(collider).insert(Friction::new(0.9));
    run(&mut app, 0.1);
    assert_eq!(ours(&app, collider), (0.9, 0.4));
}

#[test]
fn what_cannot_be_a_solid_is_refused_and_an_obstacle_of_your_own_stays() {
    let mut app = app();
    let endless = (Vec2::Y, Rotation::IDENTITY, Collider::half_space(Vec2::Y));
    let endless = app.world_mut().spawn((RigidBody::Static, Collider::compound(vec![endless]))).id();
    let own = (RigidBody::Static, Collider::circle(0.3), Obstacle::cuboid(1.0, 1.0, 1.0));
    let own = app.world_mut().spawn(own).id();
    run(&mut app, 0.1);
    assert!(!app.world().entity(endless).contains::<Obstacle>());
    let obstacle = app.world().get::<Obstacle>(own).expect("it is there");
    assert!(matches!(obstacle.shape, ObstacleShape::Cuboid { .. }));
    assert!(!app.world().entity(own).contains::<ColliderObstacle>());
}
