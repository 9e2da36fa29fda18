//! Cloths of bones: joints that hang and swing.

use std::f32::consts::{FRAC_PI_2, PI};

use bevy::prelude::*;
use bevy_drape::bones::{BoneCloth, BoneWeave, SpringBones, SpringCollider, SpringJoint};
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;
use bevy_drape::transform::MovedByFrame;

use crate::common::{app, app_in, frame_time, run, step};

/// Length of each bone in metres.
const BONE: f32 = 0.2;

/// A head at `place`, and a chain of this many joints on it that points along X.
fn spawn_chain(app: &mut App, place: Vec3, count: usize) -> (Entity, Vec<Entity>) {
    let head = app.world_mut().spawn(Transform::from_translation(place)).id();
    (head, spawn_chain_on(app, head, Vec3::ZERO, Vec3::X, count))
}

/// A head a metre up, and a joint on it whose Y axis, along which a single bone lies, points along X.
fn spawn_level_bone(app: &mut App) -> Vec<Entity> {
    let (_, joints) = spawn_chain(app, Vec3::Y, 1);
    let mut place = app.world_mut().get_mut::<Transform>(joints[0]).expect("a joint");
    place.rotation = Quat::from_rotation_z(-FRAC_PI_2);
    joints
}

/// The joints of a chain from `start` along `way`, in the coordinates of `parent`.
fn spawn_chain_on(app: &mut App, parent: Entity, start: Vec3, way: Vec3, count: usize) -> Vec<Entity> {
    let mut joints: Vec<Entity> = Vec::new();
    for index in 0..count {
        let local = if index == 0 { start } else { way * BONE };
        let parent = joints.last().copied().unwrap_or(parent);
        joints.push(app.world_mut().spawn((Transform::from_translation(local), ChildOf(parent))).id());
    }
    joints
}

fn place(app: &App, joint: Entity) -> GlobalTransform {
    *app.world().get::<GlobalTransform>(joint).expect("a place")
}

/// The places of a chain's joints, and of its tip, as they are drawn.
fn drawn(app: &App, joints: &[Entity]) -> Vec<Vec3> {
    let tip = place(app, *joints.last().expect("joints")).transform_point(Vec3::X * BONE);
    joints.iter().map(|&joint| place(app, joint).translation()).chain([tip]).collect()
}

fn particles(app: &App, cloth: Entity) -> Vec<Vec3> {
    let particles = app.world().get::<Particles>(cloth).expect("a body");
    (0..particles.len()).map(|i| particles.position(i)).collect()
}

fn bones_app() -> App {
    let mut app = app();
    app.add_plugins(TransformPlugin);
    app
}

/// The greatest distance between two lists of places.
fn apart(some: &[Vec3], others: &[Vec3]) -> f32 {
    assert_eq!(some.len(), others.len());
    some.iter().zip(others).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn limp_hair_hangs_straight_down_and_its_joints_lie_on_the_particles() {
    let mut app = bones_app();
    let (_, joints) = spawn_chain(&mut app, Vec3::Y, 5);
    let cloth =
        app.world_mut().spawn((BoneCloth::new([joints[0]]), BodySurface { drag: 3.0, ..default() })).id();
    run(&mut app, 10.0);
    let places = drawn(&app, &joints);
    let straight: Vec<Vec3> = (0..=5).map(|i| Vec3::new(0.0, 1.0 - BONE * i as f32, 0.0)).collect();
    assert!(apart(&places, &straight) < 5e-3, "{places:?}");
    assert!(apart(&places, &particles(&app, cloth)) < 2e-3, "{places:?}");
}

#[test]
fn bones_keep_their_lengths_while_they_swing() {
    let mut app = bones_app();
    let (_, joints) = spawn_chain(&mut app, Vec3::Y, 5);
    let cloth = app.world_mut().spawn(BoneCloth::new([joints[0]])).id();
    let mut fastest: f32 = 0.0;
    step(&mut app, 1);
    for _ in 0..120 {
        let before = drawn(&app, &joints);
        // A whole step is drawn as it was before: nothing is left of the time after it.
        let solved = particles(&app, cloth);
        step(&mut app, 1);
        let places = drawn(&app, &joints);
        for pair in places.windows(2) {
            assert!((pair[0].distance(pair[1]) - BONE).abs() < 1e-5, "{places:?}");
        }
        // Sticks give way a little under the load of a swing; bones do not.
        assert!(apart(&places, &solved) < 0.01, "{places:?} {solved:?}");
        fastest = fastest.max(apart(&before, &places));
    }
    assert!(fastest > 0.03, "it swings: {fastest}");
}

/// The rotations that joints show must not become their animated pose: hair on a spring would sag a little further in each frame.
#[test]
fn a_stiff_spring_holds_the_pose_of_joints_that_nothing_animates() {
    for mut app in [app(), app_in(Update), app_in(PostUpdate)] {
        app.add_plugins(TransformPlugin);
        let (_, joints) = spawn_chain(&mut app, Vec3::Y, 5);
        step(&mut app, 1);
        let pose = drawn(&app, &joints);
        let stiff = BoneCloth { drive_frequency: 100.0, ..BoneCloth::new([joints[0]]) };
        app.world_mut().spawn(stiff);
        run(&mut app, 5.0);
        // Gravity bends it by g / w^2, a millimetre.
        assert!(apart(&drawn(&app, &joints)[1..], &pose[1..]) < 2.5e-3, "{:?}", drawn(&app, &joints));
    }
}

#[test]
fn hair_on_a_spring_sags_by_gravity_over_the_square_of_its_frequency() {
    let mut app = bones_app();
    let joints = spawn_level_bone(&mut app);
    let hair = BoneCloth { drive_frequency: 15.0, tip: Some(BONE), ..BoneCloth::new([joints[0]]) };
    let cloth = app.world_mut().spawn(hair).id();
    run(&mut app, 5.0);
    // Along the arc the pull of the spring is its sine times the chord's share: torques of gravity and of the spring are equal where
    // tan(angle) = g / (w^2 BONE).
    let angle = (9.81 / (15.0_f32.powi(2) * BONE)).atan();
    let tip = particles(&app, cloth)[1] - Vec3::Y;
    assert!((tip.y.atan2(tip.x) + angle).abs() < 0.01, "{} of {angle}", tip.y.atan2(tip.x));
}

#[derive(Resource)]
struct Nod(Entity);

/// Turns a joint a fifth of a radian up and down once a second.
fn nod(joint: Res<Nod>, mut transforms: Query<&mut Transform>, time: Res<Time>) {
    let angle = 0.2 * (2.0 * PI * time.elapsed_secs()).sin();
    transforms.get_mut(joint.0).expect("a joint").rotation = Quat::from_rotation_z(angle);
}

#[test]
fn a_stiff_spring_follows_an_animation() {
    let mut app = bones_app();
    let (_, joints) = spawn_chain(&mut app, Vec3::Y, 3);
    app.insert_resource(Nod(joints[1])).add_systems(Update, nod);
    app.world_mut().spawn(BoneCloth { drive_frequency: 300.0, ..BoneCloth::new([joints[0]]) });
    run(&mut app, 0.5);
    for _ in 0..60 {
        step(&mut app, 1);
        let time = app.world().resource::<Time>().elapsed_secs();
        // Steps see the pose of the frame before.
        let wanted = 0.2 * (2.0 * PI * (time - 1.0 / 60.0)).sin();
        let bone = drawn(&app, &joints);
        let way = bone[2] - bone[1];
        assert!((way.y.atan2(way.x) - wanted).abs() < 0.03, "{} of {wanted}", way.y.atan2(way.x));
    }
}

#[test]
fn the_root_stays_on_the_head_that_runs_and_turns() {
    let mut app = bones_app();
    let (head, joints) = spawn_chain(&mut app, Vec3::Y, 4);
    app.world_mut().spawn((BoneCloth::new([joints[0]]), BodySurface { drag: 3.0, ..default() }));
    for frame in 0..90 {
        let t = frame as f32 / 60.0;
        *app.world_mut().get_mut::<Transform>(head).expect("a head") =
            Transform::from_xyz(5.0 * t, 1.0, 0.0).with_rotation(Quat::from_rotation_y(3.0 * t));
        step(&mut app, 1);
        let places = drawn(&app, &joints);
        assert!(places[0].distance(Vec3::new(5.0 * t, 1.0, 0.0)) < 1e-4, "{places:?}");
        let tip = places.last().expect("a tip").distance(places[0]);
        assert!(tip < 4.0 * BONE + 1e-4, "{places:?}");
    }
    let tail = drawn(&app, &joints)[4] - drawn(&app, &joints)[0];
    assert!(tail.x < -0.4, "it trails behind: {tail}");
}

#[test]
fn a_chain_swings_no_farther_than_it_may() {
    let mut app = bones_app();
    let (_, joints) = spawn_chain(&mut app, Vec3::Y, 4);
    app.world_mut().spawn(BoneCloth { max_swing: 0.5, ..BoneCloth::new([joints[0]]) });
    run(&mut app, 3.0);
    let places = drawn(&app, &joints);
    let tip = places[4] - places[0];
    let angle = tip.angle_between(Vec3::X);
    assert!((0.45..0.51).contains(&angle), "{angle}: {places:?}");
}

#[test]
fn bones_bend_no_farther_than_they_may() {
    let mut app = bones_app();
    let (_, joints) = spawn_chain(&mut app, Vec3::Y, 6);
    app.world_mut().spawn(BoneCloth { max_bend: 0.6, ..BoneCloth::new([joints[0]]) });
    // A rail under the second joint, over which the rest would hang straight down.
    app.world_mut().spawn((Obstacle::sphere(0.15), Transform::from_xyz(0.3, 0.84, 0.0)));
    run(&mut app, 3.0);
    let places = drawn(&app, &joints);
    let bends: Vec<f32> = places.windows(3).map(|p| (p[1] - p[0]).angle_between(p[2] - p[1])).collect();
    assert!(bends.iter().all(|&bend| bend < 0.7), "{bends:?}");
    assert!(bends.iter().any(|&bend| bend > 0.55), "{bends:?}");
}

/// The chains of a skirt round a waist of 0.2 m at a height of a metre.
fn spawn_skirt(app: &mut App, chains: usize) -> Vec<Vec<Entity>> {
    let hips = app.world_mut().spawn(Transform::from_xyz(0.0, 1.0, 0.0)).id();
    (0..chains)
        .map(|chain| {
            let out = Quat::from_rotation_y(2.0 * PI * chain as f32 / chains as f32) * Vec3::X;
            let way = (out * 0.4 + Vec3::NEG_Y).normalize();
            spawn_chain_on(app, hips, out * 0.2, way, 4)
        })
        .collect()
}

#[test]
fn a_skirt_keeps_its_circumference_and_stays_off_a_knee() {
    let knee = Vec3::new(0.45, 0.45, 0.0);
    for (weave, keeps) in [(BoneWeave::Tube, true), (BoneWeave::Strands, false)] {
        let mut app = bones_app();
        let chains = spawn_skirt(&mut app, 12);
        let skirt = BoneCloth::new(chains.iter().map(|chain| chain[0])).with_weave(weave);
        let skirt = app.world_mut().spawn((skirt, BodySurface { thickness: 0.01, ..default() })).id();
        step(&mut app, 1);
        let around = |app: &App| -> f32 {
            let places = particles(app, skirt);
            (0..12).map(|i| places[5 * i + 4].distance(places[5 * ((i + 1) % 12) + 4])).sum()
        };
        let at_rest = around(&app);
        app.world_mut().spawn((Obstacle::sphere(0.15), Transform::from_translation(knee)));
        run(&mut app, 3.0);
        let nearest = particles(&app, skirt).iter().map(|p| p.distance(knee)).fold(f32::MAX, f32::min);
        assert!(nearest > 0.155, "{weave:?}: {nearest}");
        let change = (around(&app) / at_rest - 1.0).abs();
        assert_eq!(change < 0.02, keeps, "{weave:?}: {change}");
    }
}

#[test]
fn joints_are_drawn_between_steps_and_after_the_last_one_where_steps_are_not_fixed() {
    // Ten frames a step: the bone turns evenly.
    let mut app = bones_app();
    let joints = spawn_level_bone(&mut app);
    app.world_mut().spawn(BoneCloth { tip: Some(BONE), ..BoneCloth::new([joints[0]]) });
    run(&mut app, 0.3);
    frame_time(&mut app, 1.0 / 600.0);
    step(&mut app, 20);
    let mut turns = Vec::new();
    for _ in 0..20 {
        let before = place(&app, joints[0]).rotation();
        step(&mut app, 1);
        turns.push(place(&app, joints[0]).rotation().angle_between(before));
    }
    let most = turns.iter().copied().fold(0.0, f32::max);
    let least = turns.iter().copied().fold(f32::MAX, f32::min);
    assert!(least > 0.3 * most && most > 1e-3, "{turns:?}");

    let mut app = app_in(Update);
    app.add_plugins(TransformPlugin);
    let (_, joints) = spawn_chain(&mut app, Vec3::Y, 2);
    let cloth = app.world_mut().spawn(BoneCloth::new([joints[0]])).id();
    run(&mut app, 0.3);
    let [way, shown] = [particles(&app, cloth), drawn(&app, &joints)].map(|p| (p[2] - p[1]).normalize());
    assert!(way.distance(shown) < 1e-3, "{way} {shown}");
}

#[test]
fn a_cloth_of_bones_that_is_gone_leaves_its_joints_to_the_animation() {
    let mut app = bones_app();
    let (_, joints) = spawn_chain(&mut app, Vec3::Y, 3);
    step(&mut app, 1);
    let pose = drawn(&app, &joints);
    let cloth = app.world_mut().spawn(BoneCloth::new([joints[0]])).id();
    run(&mut app, 0.5);
    assert!(apart(&drawn(&app, &joints), &pose) > 0.1);
    app.world_mut().entity_mut(cloth).remove::<BoneCloth>();
    step(&mut app, 2);
    assert!(apart(&drawn(&app, &joints), &pose) < 1e-6, "{:?}", drawn(&app, &joints));
    assert!(app.world().get::<Particles>(cloth).is_none());
}

#[test]
fn obstacles_on_joints_are_no_joints_and_all_joints_move_by_frames() {
    let mut app = bones_app();
    let (head, joints) = spawn_chain(&mut app, Vec3::Y, 1);
    let capsule = (Obstacle::sphere(0.01), Transform::from_xyz(0.0, 0.0, 0.05), ChildOf(joints[0]));
    app.world_mut().spawn(capsule);
    let collider = SpringCollider { radius: 0.1, ..default() };
    app.world_mut().spawn((collider, Transform::from_xyz(0.0, 0.1, 0.0), ChildOf(joints[0])));
    // As Bevy's loader spawns the meshes of a node.
    app.world_mut().spawn((Transform::default(), ChildOf(joints[0])));
    let next = app.world_mut().spawn((Transform::from_xyz(BONE, 0.0, 0.0), ChildOf(joints[0]))).id();
    let cloth = app.world_mut().spawn(BoneCloth::new([joints[0]])).id();
    step(&mut app, 1);
    let places = particles(&app, cloth);
    assert!(places.len() == 3 && places[1].distance(Vec3::new(BONE, 1.0, 0.0)) < 0.01, "{places:?}");
    for joint in [head, joints[0], next] {
        assert!(app.world().get::<MovedByFrame>(joint).is_some());
    }
}

#[test]
fn bones_do_not_tear_and_a_joint_that_is_gone_stops_nothing() {
    let mut app = bones_app();
    let (_, joints) = spawn_chain(&mut app, Vec3::Y, 4);
    let weak = Tearable { strain: 1e-4, ..default() };
    let cloth = app.world_mut().spawn((BoneCloth::new([joints[0]]), weak)).id();
    run(&mut app, 1.0);
    assert_eq!(particles(&app, cloth).len(), 5);
    app.world_mut().despawn(joints[2]);
    run(&mut app, 0.5);
    let told: Vec<&str> =
        app.world().resource::<Refusals>().of(cloth).map(|refusal| refusal.component).collect();
    assert_eq!(told, ["BoneCloth", "Tearable"]);
    assert!(particles(&app, cloth)[4].is_finite() && place(&app, joints[1]).affine().is_finite());
}

/// Time goes on while the clock stands: joints were drawn to and fro between the last two steps.
#[test]
fn joints_stand_still_while_the_clock_is_paused() {
    let mut app = bones_app();
    let (_, joints) = spawn_chain(&mut app, Vec3::Y, 4);
    let (_, others) = spawn_chain(&mut app, Vec3::Y, 4);
    app.world_mut().spawn(BoneCloth::new([joints[0]]));
    let falling = |&joint: &Entity| SpringJoint { gravity_power: 3.0, ..SpringJoint::new(joint) };
    app.world_mut().spawn(SpringBones { joints: others.iter().map(falling).collect(), ..default() });
    run(&mut app, 0.1);
    let moving = [drawn(&app, &joints), drawn(&app, &others)];
    step(&mut app, 1);
    assert!(
        apart(&moving[0], &drawn(&app, &joints)) > 1e-3 && apart(&moving[1], &drawn(&app, &others)) > 1e-3
    );
    app.world_mut().resource_mut::<DrapeClock>().paused = true;
    frame_time(&mut app, 1.0 / 144.0);
    step(&mut app, 5);
    let still = [drawn(&app, &joints), drawn(&app, &others)];
    for _ in 0..10 {
        step(&mut app, 1);
        assert!(
            apart(&still[0], &drawn(&app, &joints)) < 1e-6 && apart(&still[1], &drawn(&app, &others)) < 1e-6
        );
    }
}

/// Steps see an older pose than the frame: stiff ears once stood behind a head that turns.
#[test]
fn stiff_bones_are_drawn_on_the_head_as_it_is_drawn() {
    let mut app = bones_app();
    let (head, joints) = spawn_chain(&mut app, Vec3::Y, 3);
    let others = spawn_chain_on(&mut app, head, Vec3::ZERO, Vec3::Z, 3);
    app.world_mut().spawn(BoneCloth { drive_frequency: 2000.0, ..BoneCloth::new([joints[0]]) });
    let stiff = |&joint: &Entity| SpringJoint { stiffness: 1000.0, ..SpringJoint::new(joint) };
    app.world_mut().spawn(SpringBones { joints: others.iter().map(stiff).collect(), ..default() });
    frame_time(&mut app, 1.0 / 144.0);
    for frame in 0..144 {
        let turn = Quat::from_rotation_y(2.0 * PI * frame as f32 / 144.0);
        app.world_mut().get_mut::<Transform>(head).expect("a head").rotation = turn;
        step(&mut app, 1);
        // The first frames have no motion to go on with.
        for (way, joints) in [(Vec3::X, &joints), (Vec3::Z, &others)].into_iter().filter(|_| frame > 20) {
            let places = drawn(&app, joints);
            let angle = (places[2] - places[1]).angle_between(turn * way);
            assert!(angle < 0.03, "frame {frame}, {way}: {angle}");
        }
    }
}

#[test]
fn a_bone_that_hangs_below_its_sheet_is_blown_about_too() {
    let mut app = bones_app();
    let head = app.world_mut().spawn(Transform::from_xyz(0.0, 2.0, 0.0)).id();
    let chains = [1, 5]
        .map(|count| spawn_chain_on(&mut app, head, Vec3::X * 0.1 * count as f32, Vec3::NEG_Y, count)[0]);
    let sheet = BoneCloth { tip: Some(BONE), ..BoneCloth::new(chains) }.with_weave(BoneWeave::Sheet);
    let sheet = app.world_mut().spawn((sheet, BodySurface { drag: 2.0, ..default() })).id();
    app.insert_resource(Wind::new(Vec3::Z * 6.0));
    run(&mut app, 3.0);
    let places = particles(&app, sheet);
    let last = places[places.len() - 1] - places[places.len() - 2];
    assert!(last.angle_between(Vec3::NEG_Y) > 0.15, "{places:?}");
}

/// The words of the only refusal, if there is one.
fn refusal(cloth: impl FnOnce(&mut App) -> BoneCloth) -> Option<String> {
    let mut app = bones_app();
    let cloth = cloth(&mut app);
    let entity = app.world_mut().spawn(cloth).id();
    step(&mut app, 1);
    let refusals: Vec<String> =
        app.world().resource::<Refusals>().of(entity).map(ToString::to_string).collect();
    assert!(refusals.len() < 2, "{refusals:?}");
    assert_eq!(refusals.is_empty(), app.world().get::<Particles>(entity).is_some());
    refusals.into_iter().next()
}

#[test]
fn bones_that_cannot_be_cloth_are_refused_by_name() {
    let of = |change: fn(&mut BoneCloth)| {
        refusal(move |app| {
            let (_, joints) = spawn_chain(app, Vec3::Y, 3);
            let mut cloth = BoneCloth::new([joints[0]]);
            change(&mut cloth);
            cloth
        })
    };
    assert_eq!(of(|_| {}), None);
    let told = |field: &str, refusal: Option<String>| {
        let refusal = refusal.expect("a refusal");
        assert!(refusal.contains(field) && refusal.contains("BoneCloth"), "{refusal}");
    };
    told("roots", of(|cloth| cloth.roots.clear()));
    told("roots", of(|cloth| cloth.roots.push(cloth.roots[0])));
    told("roots", of(|cloth| cloth.roots.push(Entity::PLACEHOLDER)));
    let of_two = |roots: fn(&[Entity]) -> [Entity; 2]| {
        refusal(move |app| {
            let (_, joints) = spawn_chain(app, Vec3::Y, 4);
            let [first, second] = roots(&joints);
            app.world_mut().spawn(BoneCloth::new([first]));
            BoneCloth::new([second])
        })
    };
    told("another chain", of_two(|joints| [joints[0], joints[0]]));
    told("another chain", of_two(|joints| [joints[0], joints[2]]));
    told("another chain", of_two(|joints| [joints[2], joints[0]]));
    let on_another = refusal(|app| {
        let (_, joints) = spawn_chain(app, Vec3::Y, 4);
        let fork = spawn_chain_on(app, joints[1], Vec3::Y * 0.1, Vec3::Y, 3);
        app.world_mut().spawn(BoneCloth::new([joints[0]]));
        BoneCloth::new([fork[0]])
    });
    told("hangs on the joint", on_another);
    told("linear_density", of(|cloth| cloth.linear_density = 0.0));
    told("tip", of(|cloth| cloth.tip = Some(-1.0)));
    told("max_swing", of(|cloth| cloth.max_swing = 2.0 * PI));
    told("max_bend", of(|cloth| cloth.max_bend = f32::NAN));
    told("angular frequency", of(|cloth| cloth.drive_frequency = -1.0));
    told("tip", refusal(|app| BoneCloth::new([spawn_chain(app, Vec3::Y, 1).1[0]])));
    let in_one_place = refusal(|app| {
        let (_, joints) = spawn_chain(app, Vec3::Y, 2);
        app.world_mut().get_mut::<Transform>(joints[1]).expect("a joint").translation = Vec3::ZERO;
        BoneCloth::new([joints[0]])
    });
    // A child at the joint's own place is its mesh.
    told("tip", in_one_place);
    let turned = refusal(|app| {
        let (head, joints) = spawn_chain(app, Vec3::Y, 2);
        app.world_mut().get_mut::<Transform>(head).expect("a head").rotation =
            Quat::from_rotation_z(FRAC_PI_2);
        app.world_mut().get_mut::<Transform>(head).expect("a head").scale = Vec3::splat(2.0);
        BoneCloth::new([joints[0]])
    });
    assert_eq!(turned, None);
}
