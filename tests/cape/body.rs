//! A cape over its wearer's body: capsules that are fitted to its skin keep it out of the skin itself.

use bevy::mesh::VertexAttributeValues;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy_drape::drape_solver::Shape;
use bevy_drape::drape_solver::parry3d::shape::SharedShape;
use bevy_drape::prelude::*;
use bevy_drape::render::{
    BackstopPaint, BodyCollider, BodyCollidersReport, MeshFault, SkinJoint, WeldedVertices,
};

use crate::*;
use drape_examples::character::gltf_file::figure;
use drape_examples::character::{self, BONES, Character, capsule, inverse_bind_poses};

/// The colliders of a character.
fn colliders() -> BodyColliders {
    BodyColliders { friction: 0.3, ..default() }
}

fn joints() -> Vec<SkinJoint> {
    let joints = BONES.iter().zip(inverse_bind_poses());
    let joints = joints.map(|(&(name, parent, ..), inverse_bind_pose)| SkinJoint {
        name: name.into(),
        parent,
        inverse_bind_pose,
    });
    joints.collect()
}

/// Gives a character its figure, with `colliders` in place of its own capsules.
fn embody(app: &mut App, character: &Character, colliders: BodyColliders) -> Entity {
    for &capsule in &character.capsules {
        app.world_mut().despawn(capsule);
    }
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(figure());
    let poses: SkinnedMeshInverseBindposes = inverse_bind_poses().into();
    let inverse_bindposes = app.world_mut().resource_mut::<Assets<SkinnedMeshInverseBindposes>>().add(poses);
    let skin = SkinnedMesh { inverse_bindposes, joints: character.joints.clone() };
    let body = (Name::new("Figure"), Mesh3d(mesh), skin, colliders, ChildOf(character.root));
    app.world_mut().spawn(body).id()
}

fn colliders_of(app: &mut App, body: Entity) -> Vec<(Entity, Entity)> {
    let mut found = app.world_mut().query::<(Entity, &BodyCollider, &ChildOf)>();
    let found = found.iter(app.world()).filter(|(_, collider, _)| collider.body == body);
    found.map(|(entity, _, joint)| (entity, joint.parent())).collect()
}

/// The closed parts of the figure's skin, each with the joint that it follows, in the joint's coordinates.
pub fn parts() -> Vec<(usize, Shape)> {
    let mesh = figure();
    let read = |attribute| mesh.attribute(attribute).expect("an attribute");
    let (VertexAttributeValues::Float32x3(places), VertexAttributeValues::Uint16x4(joints)) =
        (read(Mesh::ATTRIBUTE_POSITION), read(Mesh::ATTRIBUTE_JOINT_INDEX))
    else {
        panic!("another mesh");
    };
    let mut part: Vec<usize> = (0..places.len()).collect();
    let corners: Vec<usize> = mesh.indices().expect("indices").iter().collect();
    loop {
        let before = part.clone();
        for &face in corners.as_chunks::<3>().0 {
            let least = face.map(|corner| part[corner]).into_iter().min().expect("three corners");
            face.into_iter().for_each(|corner| part[corner] = least);
        }
        if part == before {
            break;
        }
    }
    let mut first: Vec<usize> = part.clone();
    first.sort_unstable();
    first.dedup();
    let of_part = first.into_iter().map(|first| {
        let joint = usize::from(joints[first][0]);
        let pose = inverse_bind_poses()[joint];
        let mine = (0..places.len()).filter(|&vertex| part[vertex] == first);
        let points: Vec<Vec3> = mine.map(|vertex| pose.transform_point3(places[vertex].into())).collect();
        let hull = SharedShape::convex_hull(&points).expect("a closed part");
        (joint, Shape::from_parry(hull).expect("valid"))
    });
    of_part.collect()
}

#[test]
fn capsules_lie_on_the_skin_that_they_are_fitted_to() {
    let (capsules, report) = colliders().fit(&figure(), &joints()).expect("a figure");
    println!("fitted: {report:?}");
    for fitted in &capsules {
        println!("{}: {:?} at {}", BONES[fitted.joint].0, fitted.shape, fitted.transform.translation);
    }
    assert_eq!(capsules.len(), BONES.len());
    assert_eq!(report.capsules, BONES.len());
    // Limbs of the figure are capsules with corners, a little thinner than those of the character.
    for fitted in capsules.iter().filter(|fitted| fitted.joint >= 4) {
        let (radius, half, middle) = capsule(fitted.joint);
        let ObstacleShape::TaperedCapsule { bottom_radius, top_radius, length } = fitted.shape else {
            panic!("{:?}", fitted.shape);
        };
        for fitted in [bottom_radius, top_radius] {
            assert!((fitted / radius - 0.97).abs() < 0.03, "{fitted}, not {radius}");
        }
        assert!((length - 2.0 * half).abs() < 0.02, "{length}, not {}", 2.0 * half);
        assert!(fitted.transform.translation.distance(middle) < 0.01);
    }
    assert!(report.outside.median == 0.0 && report.outside.percentile_99 < 4e-3, "{report:?}");
    let all = BodyColliders { coverage: 1.0, ..colliders() };
    let (_, report) = all.fit(&figure(), &joints()).expect("a figure");
    assert!(report.outside.percentile_99 < 1e-3, "{report:?}");
}

#[test]
fn joints_are_chosen_by_names_and_by_how_much_they_move() {
    let chosen = |colliders: BodyColliders| -> Vec<usize> {
        let (capsules, _) = colliders.fit(&figure(), &joints()).expect("a figure");
        capsules.iter().map(|fitted| fitted.joint).collect()
    };
    assert_eq!(chosen(colliders().and_named("left*").except_named("left arm")), [6, 8]);
    assert_eq!(chosen(colliders().except_named("right*").except_named("head")), [0, 1, 2, 4, 6, 8]);
    // The skin of lesser joints goes with the joint above, unless that gets none.
    let greater = chosen(BodyColliders { least_share: 0.11, ..colliders() });
    assert!(greater.first() == Some(&0) && greater.len() < BONES.len(), "{greater:?}");
    let fault = colliders().and_named("tail").fit(&figure(), &joints()).expect_err("no tail");
    assert_eq!(fault, MeshFault::NoColliders);
    for (bad, field) in [
        (BodyColliders { coverage: 0.0, ..default() }, "coverage"),
        (BodyColliders { least_share: f32::NAN, ..default() }, "least_share"),
        (BodyColliders { margin: f32::INFINITY, ..default() }, "margin"),
        (BodyColliders { friction: -1.0, ..default() }, "friction"),
    ] {
        let fault = bad.fit(&figure(), &joints()).expect_err(field).to_string();
        assert!(fault.contains(field), "{fault}");
    }
    let fault = colliders().fit(&figure(), &joints()[..5]).expect_err("joints are missing");
    assert_eq!(fault, MeshFault::NoSuchJoint { joint: 9, count: 5 });
    assert_eq!(colliders().fit(&Mesh::from(Cuboid::default()), &joints()).unwrap_err(), MeshFault::NoSkin);
}

#[test]
fn colliders_come_go_and_change_with_their_component() {
    let mut app = app();
    let character = character::spawn(app.world_mut(), ());
    let body = embody(&mut app, &character, colliders());
    app.finish();
    app.cleanup();
    one_step_a_frame(&mut app);
    let found = colliders_of(&mut app, body);
    assert_eq!(found.len(), BONES.len());
    assert!(found.iter().all(|(_, joint)| character.joints.contains(joint)));
    let report = app.world().get::<BodyCollidersReport>(body).expect("fitted");
    assert_eq!(report.capsules, found.len());
    let mut arm = found.iter().filter(|&&(_, joint)| joint == character.joints[4]);
    let name = app.world().get::<Name>(arm.next().expect("a capsule").0).expect("a name");
    assert_eq!(name.as_str(), "left arm collider");

    app.world_mut().entity_mut(body).insert(colliders().except_named("left arm"));
    app.update();
    let fewer = colliders_of(&mut app, body);
    assert_eq!(fewer.len(), BONES.len() - 1);
    assert!(
        found.iter().all(|&(entity, _)| app.world().get_entity(entity).is_err()),
        "the old ones are gone"
    );

    app.world_mut().entity_mut(body).insert(BodyColliders { coverage: 2.0, ..default() });
    app.update();
    assert!(colliders_of(&mut app, body).is_empty());
    let refused: Vec<_> = app.world().resource::<Refusals>().of(body).map(ToString::to_string).collect();
    assert!(refused.len() == 1 && refused[0].contains("coverage"), "{refused:?}");

    app.world_mut().entity_mut(body).insert(colliders());
    app.update();
    assert!(app.world().resource::<Refusals>().is_empty());
    assert_eq!(colliders_of(&mut app, body).len(), BONES.len());
    app.world_mut().entity_mut(body).remove::<BodyColliders>();
    app.update();
    assert!(colliders_of(&mut app, body).is_empty());
    assert!(app.world().get::<BodyCollidersReport>(body).is_none());
}

/// Greatest depths of free particles of the cape in the skin of its wearer, in metres.
#[derive(Resource, Default)]
struct Depth {
    parts: Vec<(usize, Shape)>,
    steps: usize,
    /// Of any particle, and the joint of the part that it is in.
    most: f32,
    joint: usize,
    /// Of particles that are not at the limit of their motion, which wins against obstacles.
    within_limits: f32,
    /// The number of frames in which one of their vertices is drawn more than 3 mm deep in the skin as it is drawn.
    drawn: usize,
}

fn measure_depth(
    character: Res<Character>,
    places: Query<&GlobalTransform>,
    capes: Query<&Particles>,
    mut depth: ResMut<Depth>,
) {
    let Ok(particles) = capes.get(character.cape) else { return };
    let Depth { parts, steps, most, joint, within_limits, .. } = &mut *depth;
    *steps += 1;
    for (of, shape) in parts {
        let to_part = places.get(character.joints[*of]).expect("placed").affine().inverse();
        for i in (0..particles.len()).filter(|&i| !particles.is_pinned(i)) {
            let deep = depth_in(shape, to_part.transform_point3(particles.position(i)));
            if !is_at_limit(particles, i) {
                *within_limits = within_limits.max(deep);
            }
            if deep > *most {
                (*most, *joint) = (deep, *of);
            }
        }
    }
}

/// The depth in metres of a point in a part of the skin, in its coordinates; 0 outside.
pub fn depth_in(part: &Shape, local: Vec3) -> f32 {
    let (low, high) = part.local_bounds();
    let is_near = local.cmpge(low).all() && local.cmple(high).all();
    if is_near { (-part.distance(local)).max(0.0) } else { 0.0 }
}

fn is_at_limit(particles: &Particles, i: usize) -> bool {
    let limit = particles.motion_limit(i);
    limit.is_some_and(|(centre, distance)| centre.distance(particles.position(i)) >= distance - 1e-4)
}

/// The greatest depth of a vertex in the skin, as both are drawn.
fn drawn_depth(app: &App, character: &Character) -> f32 {
    let welded = app.world().get::<WeldedVertices>(character.cape).expect("built");
    let (particles, place) = (particles(app, character.cape), global(app, character.cape));
    let vertices = vertices(app, character.cape).into_iter().enumerate();
    let free = vertices.filter(|&(vertex, _)| {
        let i = welded.particle(vertex).expect("a corner");
        !particles.is_pinned(i) && !is_at_limit(particles, i)
    });
    let places: Vec<Vec3> = free.map(|(_, vertex)| place.transform_point(vertex)).collect();
    let depths = app.world().resource::<Depth>().parts.iter().flat_map(|(of, part)| {
        let to_part = global(app, character.joints[*of]).affine().inverse();
        places.iter().map(move |&place| depth_in(part, to_part.transform_point3(place)))
    });
    depths.fold(0.0, f32::max)
}

/// The depths in a walk of half a minute, with jumps, turns and runs.
fn depth_of_a_walk(
    fps: f64,
    motion: impl Fn(Entity) -> WorldMotion,
    colliders: Option<BodyColliders>,
    has_backstops: bool,
) -> Depth {
    let mut app = app();
    let surface = BodySurface { drag: 1.0, thickness: 0.01, ..default() };
    let mut character = character::spawn(app.world_mut(), surface);
    let mut cape = app.world_mut().get_mut::<ClothMesh>(character.cape).expect("a cape");
    let backstop = BackstopPaint { radius: None, full_radius: 0.4, distance: None, full_distance: 0.02 };
    cape.paint.backstop = has_backstops.then_some(backstop);
    let body = embody(&mut app, &character, default());
    match colliders {
        Some(colliders) => _ = app.world_mut().entity_mut(body).insert(colliders),
        None => _ = app.world_mut().entity_mut(body).remove::<BodyColliders>(),
    }
    app.world_mut().entity_mut(character.cape).insert(motion(character.root));
    app.finish();
    app.cleanup();
    frames(&mut app, 1.0 / fps);
    app.update();
    app.insert_resource(Depth { parts: parts(), ..default() });
    app.insert_resource(character.clone());
    app.add_systems(FixedLast, measure_depth);
    for count in 0..(30.0 * fps) as usize {
        character.advance((count as f64 / fps) as f32);
        character.write(app.world_mut());
        app.update();
        if app.world().resource::<Depth>().steps == 0 {
            continue;
        }
        let drawn = drawn_depth(&app, &character);
        app.world_mut().resource_mut::<Depth>().drawn += usize::from(drawn > 3e-3);
    }
    assert!(app.world().resource::<Refusals>().is_empty());
    let depth = app.world_mut().remove_resource::<Depth>().expect("measured");
    let Depth { steps, most, joint, within_limits, drawn, .. } = depth;
    assert!(steps > 1700, "{steps} steps at {fps} fps");
    let of = BONES[joint].0;
    println!(
        "cape: at {fps} fps {most} m deep, in the {of}; {within_limits} m within limits; drawn so in {drawn} frames"
    );
    depth
}

/// As in the guide.
fn guided(root: Entity) -> WorldMotion {
    WorldMotion::of(root).with_scale(0.8, 0.5)
}

#[test]
fn no_particle_of_a_cape_is_in_the_skin_of_its_wearer() {
    for fps in [10.0, 30.0, 144.0] {
        let Depth { most, drawn, .. } = depth_of_a_walk(fps, guided, Some(colliders()), true);
        assert!(most < 3e-3, "{most} m deep at {fps} fps");
        // At the end of a jump the legs change their pose at once, which only a high frame rate shows.
        let jumps = if fps > 100.0 { 2 } else { 0 };
        assert!(drawn <= jumps, "drawn in the skin in {drawn} frames at {fps} fps");
    }
    let [neither, backstops] = [false, true].map(|has| depth_of_a_walk(30.0, guided, None, has));
    assert!(neither.drawn > 100, "{} frames: nothing to keep it out of", neither.drawn);
    let [neither, backstops] = [neither, backstops].map(|depth| depth.within_limits);
    assert!(neither > 0.03, "{neither} m: nothing to keep it out of");
    assert!(backstops > 3e-3, "{backstops} m with backstops alone: capsules do nothing");
}

/// In an about-turn of 0.4 s an arm meets the hem of a cape that inherits it all, and pushes it beyond its limits.
#[test]
fn a_cape_that_inherits_all_motion_is_in_the_skin_at_its_limits_only() {
    for fps in [10.0, 30.0, 144.0] {
        let Depth { most, within_limits, .. } =
            depth_of_a_walk(fps, WorldMotion::of, Some(colliders()), true);
        assert!(within_limits < 3e-3, "{within_limits} m deep at {fps} fps");
        assert!(most < 0.025, "{most} m deep at {fps} fps");
    }
}
