//! Pointers on cloth, ropes and balls: what is under them, and what they drag. There is no window: rays are put where Bevy has
//! those of its cameras.

use bevy::camera::{Camera, NormalizedRenderTarget};
use bevy::picking::backend::ray::{RayId, RayMap};
use bevy::picking::events::{PointerClick, PointerDrag, PointerPress};
use bevy::picking::pointer::{Location, PointerAction, PointerButton, PointerId, PointerInput};
use bevy::picking::{InteractionPlugin, Pickable, PickingPlugin, PickingSystems};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::attach::Grab;
use bevy_drape::prelude::*;
use bevy_drape::tear::CutCloth;

/// Where pointers look along, by pointer.
#[derive(Resource, Default)]
struct Rays {
    camera: Option<Entity>,
    rays: Vec<(PointerId, Ray3d)>,
}

/// What observers have heard of.
#[derive(Resource, Default)]
struct Heard(Vec<String>);

fn app() -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        PickingPlugin,
        InteractionPlugin,
        DrapePlugins::default(),
    ))
    .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
    .insert_resource(Time::<Fixed>::from_hz(60.0))
    .init_resource::<Rays>()
    .init_resource::<Heard>()
    .add_systems(PreUpdate, put_rays.after(PickingSystems::ProcessInput).before(PickingSystems::Backend));
    let camera = app.world_mut().spawn((Camera::default(), Transform::default())).id();
    app.world_mut().resource_mut::<Rays>().camera = Some(camera);
    for pointer in [PointerId::Mouse, PointerId::Touch(1), PointerId::Touch(2)] {
        app.world_mut().spawn(pointer);
    }
    app.finish();
    app.cleanup();
    app.update();
    app
}

fn put_rays(rays: Res<Rays>, mut map: ResMut<RayMap>) {
    let Some(camera) = rays.camera else { return };
    for &(pointer, ray) in &rays.rays {
        map.map.insert(RayId::new(camera, pointer), ray);
    }
}

/// Points along -Z at (x, y), from 5 m away, as an orthographic camera sees it.
fn point(app: &mut App, pointer: PointerId, x: f32, y: f32) {
    look(app, pointer, Ray3d::new(Vec3::new(x, y, 5.0), Dir3::NEG_Z));
}

fn look(app: &mut App, pointer: PointerId, ray: Ray3d) {
    let mut rays = app.world_mut().resource_mut::<Rays>();
    rays.rays.retain(|other| other.0 != pointer);
    rays.rays.push((pointer, ray));
}

fn act(app: &mut App, pointer: PointerId, action: PointerAction, position: Vec2) {
    let target = NormalizedRenderTarget::None { width: 100, height: 100 };
    let location = Location { target, position };
    app.world_mut().write_message(PointerInput::new(pointer, location, action));
    app.update();
}

fn press(app: &mut App, pointer: PointerId) {
    // It is seen what is under the pointer before it is pressed.
    app.update();
    act(app, pointer, PointerAction::Press(PointerButton::Primary), Vec2::ZERO);
    act(app, pointer, PointerAction::Move { delta: Vec2::ONE }, Vec2::ONE);
}

fn release(app: &mut App, pointer: PointerId) {
    act(app, pointer, PointerAction::Release(PointerButton::Primary), Vec2::ONE);
}

fn run(app: &mut App, updates: usize) {
    (0..updates).for_each(|_| app.update());
}

/// A curtain of 1 m x 1 m in the plane of X and Y, without weight.
fn curtain(app: &mut App) -> Entity {
    app.insert_resource(DrapeGravity(Vec3::ZERO));
    let curtain = app.world_mut().spawn(Cloth::new(1.0, 1.0).with_particles(11, 11)).id();
    app.update();
    curtain
}

fn nearest(app: &App, body: Entity, place: Vec3) -> (usize, f32) {
    let particles = app.world().get::<Particles>(body).expect("built");
    let away = |i: &usize| particles.position(*i).distance(place);
    let nearest = (0..particles.len()).min_by(|a, b| away(a).total_cmp(&away(b))).expect("some");
    (nearest, away(&nearest))
}

#[test]
fn pointers_press_what_they_see_of_a_body_as_it_is_now() {
    let mut app = app();
    let curtain = curtain(&mut app);
    let rope = app.world_mut().spawn(Rope::new(Vec3::new(2.0, 0.5, 0.0), Vec3::new(2.0, -0.5, 0.0), 8)).id();
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(0.0, 0.0, -1.0))).id();
    app.world_mut().add_observer(|press: On<PointerPress>, mut heard: ResMut<Heard>| {
        let (position, normal) = (press.hit.position.expect("a place"), press.hit.normal.expect("a normal"));
        assert!((press.hit.depth - (5.0 - position.z)).abs() < 1e-4);
        heard.0.push(format!("{} {:.2} {:.1}", press.entity, position.z, normal.z));
    });
    // The lower edge is bent to the viewer and up: what was there is empty, and what is there was.
    let mut particles = app.world_mut().get_mut::<Particles>(curtain).expect("built");
    for i in 66..121 {
        let place = particles.position(i);
        particles.set_position(i, Vec3::new(place.x, -place.y, place.z + 0.5));
        particles.set_inverse_mass(i, 0.0);
    }
    let mouse = PointerId::Mouse;
    let heard = |app: &mut App, x: f32, y: f32| {
        point(app, mouse, x, y);
        press(app, mouse);
        release(app, mouse);
        core::mem::take(&mut app.world_mut().resource_mut::<Heard>().0)
    };
    assert_eq!(heard(&mut app, 0.2, 0.3), [format!("{curtain} 0.50 1.0")], "the fold in front");
    assert_eq!(
        heard(&mut app, 0.0, -0.13),
        [format!("{ball} -0.93 0.5")],
        "the ball that was behind the cloth"
    );
    assert_eq!(heard(&mut app, 2.01, 0.1), [format!("{rope} 0.03 0.9")], "a rope is as thick as a finger");
    assert!(heard(&mut app, 0.3, -0.3).is_empty(), "where the cloth was");
    app.world_mut().entity_mut(curtain).insert(Pickable::IGNORE);
    assert_eq!(heard(&mut app, 0.0, 0.0), [format!("{ball} -0.85 1.0")], "through what is not to be picked");
}

#[test]
fn a_pointer_drags_cloth_at_the_distance_at_which_it_took_it() {
    for perspective in [false, true] {
        let mut app = app();
        let curtain = curtain(&mut app);
        app.world_mut().entity_mut(curtain).insert(Draggable::default());
        let ray = |x: f32, y: f32| {
            if perspective {
                let eye = Vec3::new(0.0, 0.0, 5.0);
                Ray3d::new(eye, Dir3::new(Vec3::new(x, y, 0.0) - eye).expect("a length"))
            } else {
                Ray3d::new(Vec3::new(x, y, 5.0), Dir3::NEG_Z)
            }
        };
        look(&mut app, PointerId::Mouse, ray(0.0, -0.3));
        press(&mut app, PointerId::Mouse);
        let target = ray(0.12, -0.29);
        look(&mut app, PointerId::Mouse, target);
        run(&mut app, 60);
        let place = target.get_point(ray(0.0, -0.3).origin.distance(Vec3::new(0.0, -0.3, 0.0)));
        // That was at (0, -0.3).
        let miss = app.world().get::<Particles>(curtain).expect("built").position(93).distance(place);
        assert!(miss < 0.05, "{miss} m off");
        release(&mut app, PointerId::Mouse);
        assert!(app.world().get::<Grab>(curtain).is_none(), "it lets go");
        look(&mut app, PointerId::Mouse, ray(-0.4, -0.4));
        run(&mut app, 10);
        assert!(app.world().get::<Grab>(curtain).is_none());
    }
}

#[test]
fn two_fingers_hold_one_cloth_and_keep_what_they_tear_off() {
    let mut app = app();
    let curtain = curtain(&mut app);
    app.world_mut().entity_mut(curtain).insert(Draggable { radius: 0.15, ..default() });
    let fingers = [PointerId::Touch(1), PointerId::Touch(2)];
    for (finger, x) in fingers.into_iter().zip([-0.3, 0.3]) {
        point(&mut app, finger, x, -0.4);
        press(&mut app, finger);
    }
    assert_eq!(app.world().get::<Grab>(curtain).expect("held").hands.len(), 2);
    point(&mut app, fingers[0], -0.45, -0.4);
    point(&mut app, fingers[1], 0.45, -0.4);
    run(&mut app, 60);
    for x in [-0.45, 0.45] {
        let (_, miss) = nearest(&app, curtain, Vec3::new(x, -0.4, 0.0));
        assert!(miss < 0.06, "{miss} m off at {x}");
    }
    // A blade between the pins and the left finger: the lower left goes with that finger.
    let corner = Vec3::new(-1.0, -0.21, 0.0);
    app.world_mut()
        .write_message(CutCloth::along([corner, corner.with_x(0.02), Vec3::new(0.02, -1.0, 0.0)], Vec3::Z));
    point(&mut app, fingers[0], -1.5, -0.4);
    run(&mut app, 90);
    let pieces: Vec<Entity> =
        app.world_mut().query_filtered::<Entity, With<Grab>>().iter(app.world()).collect();
    assert_eq!(pieces.len(), 2, "each finger has its piece");
    let piece = *pieces.iter().find(|&&piece| piece != curtain).expect("came off");
    let (_, miss) = nearest(&app, piece, Vec3::new(-1.5, -0.4, 0.0));
    assert!(miss < 0.05, "the piece is {miss} m from its finger");
    for finger in fingers {
        release(&mut app, finger);
    }
    assert_eq!(app.world_mut().query::<&Grab>().iter(app.world()).count(), 0);
}

#[test]
fn a_body_that_goes_away_in_the_middle_of_a_drag_is_let_go() {
    let mut app = app();
    let curtain = curtain(&mut app);
    app.world_mut().entity_mut(curtain).insert(Draggable::default());
    point(&mut app, PointerId::Mouse, 0.0, -0.3);
    press(&mut app, PointerId::Mouse);
    assert!(app.world().get::<Grab>(curtain).is_some());
    app.world_mut().despawn(curtain);
    run(&mut app, 3);
    release(&mut app, PointerId::Mouse);
    run(&mut app, 3);
}

#[test]
fn what_is_not_draggable_hears_of_drags_and_stays() {
    let mut app = app();
    let curtain = curtain(&mut app);
    app.world_mut().entity_mut(curtain).observe(|_: On<PointerDrag>, mut heard: ResMut<Heard>| {
        heard.0.push("drag".to_string());
    });
    app.world_mut().entity_mut(curtain).observe(|_: On<PointerClick>, mut heard: ResMut<Heard>| {
        heard.0.push("click".to_string());
    });
    point(&mut app, PointerId::Mouse, 0.0, -0.3);
    press(&mut app, PointerId::Mouse);
    release(&mut app, PointerId::Mouse);
    assert!(app.world().get::<Grab>(curtain).is_none());
    assert_eq!(app.world().resource::<Heard>().0, ["drag", "click"]);
}
