//! Spring bones beside the equations of their specification, `VRMC_springBone` 1.0, written down once more in doubles.

use bevy::math::{DAffine3, DQuat, DVec3};
use bevy::prelude::*;
use bevy_drape::attach::TeleportCloth;
use bevy_drape::bones::{SpringBones, SpringCollider, SpringJoint};
use bevy_drape::origin::ShiftOrigin;
use bevy_drape::prelude::*;

use crate::common::{STEP, app_in, step};

/// The place of the head at the beginning of a frame: it runs, turns and nods.
fn head_at(frame: usize) -> Transform {
    let t = frame as f32 * STEP;
    Transform::from_xyz(2.0 * t, 1.5 + 0.1 * (6.0 * t).sin(), 0.0).with_rotation(Quat::from_euler(
        EulerRot::YXZ,
        2.0 * t.sin(),
        0.4 * (9.0 * t).sin(),
        0.0,
    ))
}

/// The transform of each joint on the one above it at rest. The last is the end of the bone before it.
fn local(index: usize) -> Transform {
    let place = if index == 0 { Vec3::new(0.0, 0.1, 0.1) } else { Vec3::new(0.01, 0.12, -0.02) };
    Transform::from_translation(place).with_rotation(Quat::from_rotation_x(if index == 0 {
        2.2
    } else {
        0.15
    }))
}

/// The numbers of each joint.
fn numbers(index: usize, joint: Entity) -> SpringJoint {
    SpringJoint {
        hit_radius: 0.02,
        stiffness: 1.2 - 0.2 * index as f32,
        gravity_power: 0.8,
        gravity_dir: Vec3::new(0.1, -1.0, 0.0),
        drag_force: 0.2 + 0.05 * index as f32,
        ..SpringJoint::new(joint)
    }
}

const JOINTS: usize = 5;
/// A ball and a capsule on the head: place, tail on the capsule's own place, radius.
const COLLIDERS: [(Vec3, Vec3, f32); 2] = [
    (Vec3::new(0.0, -0.1, 0.22), Vec3::ZERO, 0.12),
    (Vec3::new(-0.3, -0.35, 0.1), Vec3::new(0.6, 0.0, 0.05), 0.08),
];

/// A head that moves by itself, and a chain of joints on it with two colliders beside.
struct Avatar {
    app: App,
    joints: Vec<Entity>,
    springs: Entity,
}

#[derive(Resource)]
struct Head {
    entity: Entity,
    frame: usize,
    origin: Vec3,
}

fn move_head(mut head: ResMut<Head>, mut transforms: Query<&mut Transform>) {
    head.frame += 1;
    let mut place = head_at(head.frame);
    place.translation -= head.origin;
    *transforms.get_mut(head.entity).expect("a head") = place;
}

fn avatar(has_center: bool, has_colliders: bool) -> Avatar {
    // Joints show the last step where steps are taken once a frame.
    let mut app = app_in(Update);
    app.add_plugins(TransformPlugin).add_systems(PreUpdate, move_head);
    let head = app.world_mut().spawn(head_at(0)).id();
    app.insert_resource(Head { entity: head, frame: 0, origin: Vec3::ZERO });
    let mut joints = vec![];
    for index in 0..JOINTS {
        let parent = joints.last().copied().unwrap_or(head);
        joints.push(app.world_mut().spawn((local(index), ChildOf(parent))).id());
    }
    let colliders = COLLIDERS.map(|(place, tail, radius)| {
        let collider = SpringCollider { radius, tail };
        app.world_mut().spawn((collider, Transform::from_translation(place), ChildOf(head))).id()
    });
    let springs = SpringBones {
        joints: joints.iter().enumerate().map(|(index, &joint)| numbers(index, joint)).collect(),
        colliders: if has_colliders { colliders.to_vec() } else { Vec::new() },
        center: has_center.then_some(head),
    };
    let springs = app.world_mut().spawn(springs).id();
    Avatar { app, joints, springs }
}

/// One joint of the specification's state.
struct State {
    previous: DVec3,
    current: DVec3,
    axis: DVec3,
    length: f64,
    matrix: DAffine3,
    rotation: DQuat,
}

fn affine(transform: Transform) -> DAffine3 {
    DAffine3::from_rotation_translation(
        transform.rotation.as_dquat().normalize(),
        transform.translation.as_dvec3(),
    )
}

/// The specification's states in the first frame.
fn initialize(center: &DAffine3, head: DAffine3) -> Vec<State> {
    let mut world = head;
    (0..JOINTS - 1)
        .map(|index| {
            let matrix = affine(local(index));
            world *= matrix;
            let end = local(index + 1).translation.as_dvec3();
            let tail = center.inverse().transform_point3(world.transform_point3(end));
            let rotation = local(index).rotation.as_dquat().normalize();
            let (axis, length) = (end.normalize(), end.length());
            State { previous: tail, current: tail, axis, length, matrix, rotation }
        })
        .collect()
}

/// The specification's update of a frame. Returns the world matrices of the joints.
fn update(states: &mut [State], center: &DAffine3, head: DAffine3, has_colliders: bool) -> Vec<DAffine3> {
    let mut parent = head;
    let mut all = vec![];
    for (index, state) in states.iter_mut().enumerate() {
        let numbers = numbers(index, Entity::PLACEHOLDER);
        let position = (parent * state.matrix).transform_point3(DVec3::ZERO);
        let (_, parent_rotation, _) = parent.to_scale_rotation_translation();
        let lost = f64::from(numbers.drag_force);
        let inertia = center.transform_vector3(state.current - state.previous) * (1.0 - lost);
        let dt = 1.0 / 60.0;
        let stiffness = parent_rotation * state.rotation * state.axis * (dt * f64::from(numbers.stiffness));
        let external = numbers.gravity_dir.as_dvec3() * (dt * f64::from(numbers.gravity_power));
        let mut next = center.transform_point3(state.current) + inertia + stiffness + external;
        next = position + (next - position).normalize() * state.length;
        for (place, tail, radius) in COLLIDERS.into_iter().filter(|_| has_colliders) {
            let start = head.transform_point3(place.as_dvec3());
            let end = head.transform_point3((place + tail).as_dvec3());
            let (axis, mut delta) = (end - start, next - start);
            let along = delta.dot(axis);
            if along > axis.length_squared() {
                delta -= axis;
            } else if along > 0.0 {
                delta -= axis * (along / axis.length_squared());
            }
            let distance = delta.length() - f64::from(radius) - f64::from(numbers.hit_radius);
            if distance < 0.0 {
                next -= delta.normalize() * distance;
                next = position + (next - position).normalize() * state.length;
            }
        }
        state.previous = state.current;
        state.current = center.inverse().transform_point3(next);
        let to = (parent * state.matrix).inverse().transform_point3(next).normalize();
        let rotation = state.rotation * DQuat::from_rotation_arc(state.axis, to);
        parent *= DAffine3::from_rotation_translation(rotation, state.matrix.translation);
        all.push(parent);
    }
    all
}

#[test]
fn joints_move_as_the_specification_says_step_by_step() {
    for (has_center, has_colliders) in [(false, false), (true, false), (false, true), (true, true)] {
        let Avatar { mut app, joints, .. } = avatar(has_center, has_colliders);
        let center = |frame: usize| if has_center { affine(head_at(frame)) } else { DAffine3::IDENTITY };
        let mut states = initialize(&center(1), affine(head_at(1)));
        let mut swing: f64 = 0.0;
        for frame in 1..=400 {
            step(&mut app, 1);
            let places = update(&mut states, &center(frame), affine(head_at(frame)), has_colliders);
            for (&joint, wanted) in joints.iter().zip(&places) {
                let place = app.world().get::<GlobalTransform>(joint).expect("a place");
                let (_, rotation, translation) = place.to_scale_rotation_translation();
                let (_, turned, moved) = wanted.to_scale_rotation_translation();
                assert!(
                    translation.as_dvec3().distance(moved) < 2e-4,
                    "frame {frame}: {translation} {moved}"
                );
                assert!(
                    rotation.as_dquat().angle_between(turned) < 2e-3,
                    "{has_center} {has_colliders} frame {frame}, {joint}: {rotation} {turned}"
                );
            }
            let rest = states[0].rotation * states[0].axis;
            let bone = affine(head_at(frame))
                .inverse()
                .transform_vector3(places[1].translation - places[0].translation);
            swing = swing.max(bone.angle_between(rest));
        }
        assert!(swing > 0.1, "it swings: {swing}");
    }
}

/// Joints between two of a chain hang on the upper one, as if they and the lower one were one.
#[test]
fn joints_in_between_hang_on_and_the_end_may_be_any_descendant() {
    let Avatar { mut app, joints, springs } = avatar(false, false);
    let chain = [joints[0], joints[2], joints[4]];
    let head = app.world().resource::<Head>().entity;
    let mut parent = head;
    let twins = [local(0), local(1) * local(2), local(3) * local(4)].map(|place| {
        parent = app.world_mut().spawn((place, ChildOf(parent))).id();
        parent
    });
    let numbers =
        |joints: [Entity; 3]| joints.into_iter().enumerate().map(|(index, joint)| numbers(index, joint));
    app.world_mut().get_mut::<SpringBones>(springs).expect("springs").joints = numbers(chain).collect();
    app.world_mut().spawn(SpringBones { joints: numbers(twins).collect(), ..default() });
    step(&mut app, 200);
    for (joint, twin) in chain.into_iter().zip(twins) {
        let [here, there] =
            [joint, twin].map(|joint| *app.world().get::<GlobalTransform>(joint).expect("a place"));
        assert!(here.translation().distance(there.translation()) < 1e-4, "{here:?} {there:?}");
    }
    assert_eq!(app.world().get::<Transform>(joints[1]).expect("a joint").rotation, local(1).rotation);
    assert_ne!(app.world().get::<Transform>(joints[0]).expect("a joint").rotation, local(0).rotation);
}

#[test]
fn springs_that_cannot_swing_are_refused_by_name() {
    let of = |change: fn(&mut SpringBones)| -> Option<String> {
        let Avatar { mut app, springs, .. } = avatar(false, true);
        change(&mut app.world_mut().get_mut::<SpringBones>(springs).expect("springs"));
        step(&mut app, 2);
        let refusals: Vec<String> =
            app.world().resource::<Refusals>().of(springs).map(ToString::to_string).collect();
        assert!(refusals.len() < 2, "{refusals:?}");
        refusals.into_iter().next()
    };
    assert_eq!(of(|_| ()), None);
    let changes: [(&str, fn(&mut SpringBones)); 8] = [
        ("joints", |springs| springs.joints.clear()),
        ("joints", |springs| springs.joints.truncate(1)),
        ("joints", |springs| springs.joints.reverse()),
        ("joints", |springs| springs.joints[2].joint = Entity::PLACEHOLDER),
        ("hit_radius", |springs| springs.joints[1].hit_radius = -0.1),
        ("stiffness", |springs| springs.joints[1].stiffness = f32::NAN),
        ("drag_force", |springs| springs.joints[1].drag_force = 1.5),
        ("gravity_dir", |springs| springs.joints[1].gravity_dir.x = f32::INFINITY),
    ];
    for (field, change) in changes {
        let refusal = of(change).expect("a refusal");
        assert!(refusal.contains(field) && refusal.contains("SpringBones"), "{refusal}");
    }
}

/// Spring bones without a centre remember places in the world: after a shift they once flew back to the old origin.
#[test]
fn a_shift_of_the_origin_leaves_springs_as_they_are() {
    for has_center in [false, true] {
        let [mut shifted, mut other] = [avatar(has_center, true), avatar(has_center, true)];
        let origin = Vec3::new(64.0, 0.0, -32.0);
        for frame in 0..100 {
            if frame == 50 {
                ShiftOrigin(origin).apply(shifted.app.world_mut());
                shifted.app.world_mut().resource_mut::<Head>().origin = origin;
            }
            for avatar in [&mut shifted, &mut other] {
                step(&mut avatar.app, 1);
            }
            let origin = if frame < 50 { Vec3::ZERO } else { origin };
            assert!(
                distance(&shifted, &other, origin) < 2e-4,
                "frame {frame}: {}",
                distance(&shifted, &other, origin)
            );
        }
    }
}

/// The greatest distance of two avatars' joints, if the first has this origin.
fn distance(avatar: &Avatar, other: &Avatar, origin: Vec3) -> f32 {
    let place = |avatar: &Avatar, joint| {
        avatar.app.world().get::<GlobalTransform>(joint).expect("a place").translation()
    };
    let joints = avatar.joints.iter().zip(&other.joints);
    joints
        .map(|(&joint, &twin)| (place(avatar, joint) + origin).distance(place(other, twin)))
        .fold(0.0, f32::max)
}

/// A chain on the end of another is as one with it, whichever was spawned first.
#[test]
fn chains_that_hang_on_others_swing_after_them() {
    for upper_first in [true, false] {
        let [mut whole, mut parted] = [avatar(false, true), avatar(false, true)];
        let springs = parted.app.world().get::<SpringBones>(parted.springs).expect("springs").clone();
        let part = |joints: &[SpringJoint]| SpringBones { joints: joints.to_vec(), ..springs.clone() };
        let mut parts = [part(&springs.joints[..3]), part(&springs.joints[2..])];
        if !upper_first {
            parts.reverse();
        }
        let [first, second] = parts;
        *parted.app.world_mut().get_mut::<SpringBones>(parted.springs).expect("springs") = first;
        parted.app.world_mut().spawn(second);
        for frame in 0..100 {
            step(&mut whole.app, 1);
            step(&mut parted.app, 1);
            assert!(distance(&whole, &parted, Vec3::ZERO) < 1e-5, "frame {frame}, {upper_first}");
        }
    }
}

/// A jump begins the swing anew. Hair was once dragged behind for a hundred metres, and flung ahead by as much.
#[test]
fn springs_stay_calm_when_their_head_jumps_or_is_teleported() {
    for by in [100.0, 2.0] {
        let mut jumping = avatar(false, false);
        step(&mut jumping.app, 60);
        let origin = Vec3::X * by;
        jumping.app.world_mut().resource_mut::<Head>().origin = origin;
        if by < 25.0 {
            jumping.app.world_mut().entity_mut(jumping.springs).insert(TeleportCloth);
        }
        step(&mut jumping.app, 1);
        // A step after their rest.
        let mut rest = head_at(61).with_translation(head_at(61).translation - origin);
        for (index, &joint) in jumping.joints.iter().enumerate() {
            rest = rest * local(index);
            let place = jumping.app.world().get::<GlobalTransform>(joint).expect("a place").translation();
            assert!(place.distance(rest.translation) < 0.1, "{place} {}", rest.translation);
        }
        assert!(jumping.app.world().get::<TeleportCloth>(jumping.springs).is_none());
    }
}

/// New numbers do not begin the swing anew: gusts may change them in each frame.
#[test]
fn springs_whose_numbers_change_go_on_as_they_swing() {
    let [mut changed, mut other] = [avatar(false, true), avatar(false, true)];
    for _ in 0..60 {
        changed.app.world_mut().get_mut::<SpringBones>(changed.springs).expect("springs").set_changed();
        step(&mut changed.app, 1);
        step(&mut other.app, 1);
        assert!(distance(&changed, &other, Vec3::ZERO) < 1e-6);
    }
}

/// Colliders that are gone push nothing, and springs that are gone leave the joints to the animation.
#[test]
fn colliders_and_springs_may_go() {
    let [mut bare, mut without] = [avatar(false, true), avatar(false, false)];
    for collider in bare.app.world().get::<SpringBones>(bare.springs).expect("springs").colliders.clone() {
        bare.app.world_mut().despawn(collider);
    }
    for _ in 0..100 {
        step(&mut bare.app, 1);
        step(&mut without.app, 1);
        assert!(distance(&bare, &without, Vec3::ZERO) < 1e-6);
    }
    let Avatar { mut app, joints, springs } = bare;
    app.world_mut().despawn(springs);
    step(&mut app, 1);
    for (index, &joint) in joints.iter().enumerate() {
        assert_eq!(app.world().get::<Transform>(joint), Some(&local(index)));
    }
}
