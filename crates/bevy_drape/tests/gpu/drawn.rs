//! The vertices that the renderer draws are those of the last step on the GPU.

use bevy::log::LogPlugin;
use bevy::render::mesh::allocator::MeshAllocator;
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::{RenderApp, RenderPlugin};
use bevy::window::ExitCondition;
use bevy_drape::body::Activity;
use bevy_drape::clock::DrapeClock;
use bevy_drape::detail::{DetailLevel, LevelOfDetail};
use bevy_drape::gpu::drape_gpu::wgpu;
use bevy_drape::viewer::Viewer;

use crate::*;

/// An app with a renderer and no window.
fn drawing_app() -> App {
    let mut app = App::new();
    let plugins = DefaultPlugins
        .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
        .set(RenderPlugin { synchronous_pipeline_compilation: true, ..default() })
        .disable::<LogPlugin>();
    app.add_plugins((plugins, DrapePlugins::default()));
    while app.plugins_state() == bevy::app::PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    start(&mut app);
    app
}

/// Positions and normals of a body as the renderer has them.
fn drawn(app: &App, body: Entity) -> Vec<[Vec3; 2]> {
    let mesh = app.world().entity(body).get::<Mesh3d>().expect("a mesh");
    let render_world = app.sub_app(RenderApp).world();
    let slice =
        render_world.resource::<MeshAllocator>().mesh_vertex_slice(&mesh.id()).expect("it is uploaded");
    let device = render_world.resource::<RenderDevice>().wgpu_device();
    let staging = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: slice.buffer.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(slice.buffer, 0, &staging, 0, slice.buffer.size());
    render_world.resource::<RenderQueue>().submit([encoder.finish()]);
    staging.slice(..).map_async(wgpu::MapMode::Read, |mapped| mapped.expect("mapped"));
    device.poll(wgpu::PollType::wait_indefinitely()).expect("a device");
    let view = staging.slice(..).get_mapped_range().expect("mapped");
    // Position, normal, texture coordinates.
    let word = |i: usize| f32::from_le_bytes(view[4 * i..4 * i + 4].try_into().expect("four bytes"));
    let vector = |i: usize| Vec3::new(word(i), word(i + 1), word(i + 2));
    slice.range.map(|vertex| [8 * vertex as usize, 8 * vertex as usize + 3].map(vector)).collect()
}

/// Checks that a body is drawn as it was a quarter of a step after `before`, in the coordinates of its entity.
fn assert_drawn(app: &App, body: Entity, before: &[Vec3]) {
    let to_local = app.world().entity(body).get::<GlobalTransform>().expect("a place").affine().inverse();
    let after = positions(app, body);
    let drawn = drawn(app, body);
    assert_eq!(drawn.len(), after.len());
    for (i, ([place, normal], (a, b))) in drawn.into_iter().zip(before.iter().zip(&after)).enumerate() {
        let expected = to_local.transform_point3(a.lerp(*b, 0.25));
        assert!(place.distance(expected) < 1e-4, "vertex {i} is at {place} instead of {expected}");
        assert!((normal.length() - 1.0).abs() < 1e-3, "the normal of {i} is {normal}");
    }
}

/// One step, and a frame that shows a quarter of it. Returns the positions before it.
fn step(app: &mut App, body: Entity) -> Vec<Vec3> {
    let before = positions(app, body);
    frame(app, 1.0);
    frame(app, 0.25);
    before
}

/// The frame after [`step`] makes the time whole again.
fn go_on(app: &mut App, frames: usize) {
    frame(app, 0.75);
    run(app, frames);
}

#[test]
fn the_renderer_has_the_vertices_of_the_gpu() {
    let mut app = drawing_app();
    let turned = Transform::from_xyz(3.0, 1.0, -2.0).with_rotation(Quat::from_rotation_y(0.7));
    let first = spawn(&mut app, swinging());
    let second =
        spawn(&mut app, (Cloth::new(1.0, 0.5).with_particles(40, 30).with_pins(ClothPins::Left), turned));
    run(&mut app, 12);
    assert!(is_on_gpu(&app, first) && is_on_gpu(&app, second));
    for body in [first, second] {
        let before = step(&mut app, body);
        assert_drawn(&app, body, &before);
        let moved =
            positions(&app, body).iter().zip(&before).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(moved > 1e-3, "there is something to see between two steps: {moved} m");
        go_on(&mut app, 2);
    }

    // More meshes: the buffer grows, and is another one.
    let many: Vec<_> =
        (0..40).map(|_| spawn(&mut app, Cloth::new(1.0, 1.0).with_particles(64, 64))).collect();
    run(&mut app, 3);
    for body in [first, many[39]] {
        let before = step(&mut app, body);
        assert_drawn(&app, body, &before);
        go_on(&mut app, 1);
    }

    // Others' meshes: it grows again.
    for _ in 0..80 {
        let other = app.world_mut().resource_mut::<Assets<Mesh>>().add(Sphere::new(1.0).mesh().uv(64, 64));
        app.world_mut().spawn(Mesh3d(other));
    }
    run(&mut app, 3);
    let before = step(&mut app, first);
    assert_drawn(&app, first, &before);
    go_on(&mut app, 1);

    // Uploaded anew, from what the processor has.
    let mesh = app.world().entity(second).get::<Mesh3d>().expect("a mesh").id();
    let before = step(&mut app, second);
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    meshes.get_mut(mesh).expect("it is there").asset_usage |= default();
    frame(&mut app, 0.0);
    assert_drawn(&app, second, &before);
}

/// While the clock stands still the fixed loop goes on. Bodies once oscillated between their last two states.
#[test]
fn a_clock_that_stands_still_shows_one_state() {
    let mut app = drawing_app();
    let cloth = spawn(&mut app, swinging());
    run(&mut app, 12);
    app.world_mut().resource_mut::<DrapeClock>().paused = true;
    for fraction in [1.0, 0.25, 0.5] {
        frame(&mut app, fraction);
        for ([place, _], expected) in drawn(&app, cloth).into_iter().zip(positions(&app, cloth)) {
            assert!(place.distance(expected) < 1e-4, "{place} instead of {expected}");
        }
    }
}

#[test]
fn a_hidden_body_is_drawn_as_it_is_when_it_is_shown_again() {
    let mut app = drawing_app();
    let cloth = spawn(&mut app, swinging());
    run(&mut app, 4);
    app.world_mut().entity_mut(cloth).insert(Visibility::Hidden);
    run(&mut app, 8);
    app.world_mut().entity_mut(cloth).insert(Visibility::Inherited);
    let before = positions(&app, cloth);
    frame(&mut app, 1.25);
    assert_drawn(&app, cloth, &before);
}

#[test]
fn the_renderer_has_the_vertices_of_a_mesh_on_its_particles() {
    let mut app = drawing_app();
    // Of a box, whose corners are three vertices each, with a normal of their own.
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(Cuboid::new(0.6, 0.4, 0.8));
    let place = Transform::from_xyz(1.0, 2.0, -1.0).with_scale(Vec3::new(-1.0, 1.0, 2.0));
    let parts = || (Mesh3d(mesh.clone()), ClothMesh::default().with_pins([0]), place);
    let here = app.world_mut().spawn(parts()).id();
    let there = spawn(&mut app, parts());
    run(&mut app, 16);
    assert!(is_on_gpu(&app, there) && !is_on_gpu(&app, here));
    let [expected, written] = [here, there].map(|body| drawn(&app, body));
    let lowest = written.iter().map(|[place, _]| place.y).fold(9.0, f32::min);
    assert!(lowest < -0.3, "it swings: its lowest vertex is at {lowest}");
    assert_eq!(written.len(), 24);
    for (i, ([place, normal], [there, looks])) in expected.into_iter().zip(written).enumerate() {
        assert!(place.distance(there) < 1e-3, "vertex {i} is at {there} instead of {place}");
        assert!(normal.distance(looks) < 0.01, "the normal of {i} is {looks} instead of {normal}");
    }
}

/// The list of what is drawn is kept from frame to frame: a change of one body must not be given to another one.
#[test]
fn bodies_that_come_go_move_and_rest_are_drawn_where_they_are() {
    let mut app = drawing_app();
    let at = |x: f32| (swinging(), Transform::from_xyz(x, 0.0, 0.0));
    let [gone, moved, stays] = [0.0, 2.0, 4.0].map(|x| spawn(&mut app, at(x)));
    run(&mut app, 4);
    app.world_mut().despawn(gone);
    let late = spawn(&mut app, at(6.0));
    run(&mut app, 2);
    for body in [moved, stays, late] {
        let before = step(&mut app, body);
        assert_drawn(&app, body, &before);
        go_on(&mut app, 1);
    }
    for (body, x) in [(moved, 2.05), (stays, 4.05), (late, 6.05)] {
        app.world_mut().entity_mut(body).insert(Transform::from_xyz(x, 0.0, 0.0));
        for body in [moved, stays, late] {
            let before = step(&mut app, body);
            assert_drawn(&app, body, &before);
            go_on(&mut app, 1);
        }
    }
    app.world_mut().entity_mut(stays).insert(Activity::Resting);
    for body in [moved, stays, late] {
        let before = step(&mut app, body);
        assert_drawn(&app, body, &before);
        go_on(&mut app, 1);
    }
}

/// A frozen body moves rigidly with its entity.
#[test]
fn a_frozen_body_is_drawn_where_its_entity_is() {
    let mut app = drawing_app();
    let viewer = app.world_mut().spawn((Viewer, Transform::default())).id();
    let level = DetailLevel { distance: 20.0, frozen: true, ..default() };
    let cloth = spawn(&mut app, (swinging(), LevelOfDetail { levels: vec![level], ..default() }));
    run(&mut app, 12);
    app.world_mut().entity_mut(viewer).insert(Transform::from_xyz(0.0, 0.0, 50.0));
    run(&mut app, 3);
    assert_eq!(app.world().get::<Activity>(cloth), Some(&Activity::Frozen));
    let before = drawn(&app, cloth);
    let place = Transform::from_xyz(3.0, 1.0, 0.0).with_rotation(Quat::from_rotation_y(1.0));
    app.world_mut().entity_mut(cloth).insert(place);
    run(&mut app, 2);
    // In the coordinates of its entity.
    assert_eq!(drawn(&app, cloth), before);
}

/// A rope that gets another tube is drawn with that.
#[test]
fn the_renderer_has_the_tubes_of_ropes() {
    let mut app = drawing_app();
    let place = Transform::from_xyz(1.0, 2.0, -1.0).with_rotation(Quat::from_rotation_y(0.5));
    let rope = || Rope::new(Vec3::ZERO, Vec3::X, 80);
    let first = spawn(&mut app, (rope(), RopeMesh { radius: 0.03, sides: 5 }, place));
    let second = spawn(&mut app, (rope(), RopeMesh { radius: 0.02, sides: 9 }, place));
    run(&mut app, 12);
    let other = RopeMesh { radius: 0.04, sides: 7 };
    for tube in [RopeMesh { radius: 0.02, sides: 9 }, other] {
        app.world_mut().entity_mut(second).insert(tube);
        run(&mut app, 3);
        for (body, RopeMesh { radius, sides }) in
            [(first, RopeMesh { radius: 0.03, sides: 5 }), (second, tube)]
        {
            let before = step(&mut app, body);
            let (after, vertices) = (positions(&app, body), drawn(&app, body));
            let corners = sides as usize + 1;
            assert_eq!(vertices.len(), 82 * corners + 2);
            let to_local =
                app.world().entity(body).get::<GlobalTransform>().expect("a place").affine().inverse();
            let ends = before.iter().zip(&after);
            let centres: Vec<Vec3> = ends.map(|(a, b)| to_local.transform_point3(a.lerp(*b, 0.25))).collect();
            for (i, (ring, centre)) in vertices.chunks(corners).zip(&centres).enumerate() {
                let middle = ring[1..].iter().map(|[place, _]| place).sum::<Vec3>() / sides as f32;
                assert!(middle.distance(*centre) < 1e-4, "ring {i} is at {middle} instead of {centre}");
                for [place, normal] in ring {
                    assert!(
                        place.distance(centre + normal * radius) < 1e-4,
                        "{place} is not around {centre}"
                    );
                }
            }
            for (cap, centre) in vertices[80 * corners..].chunks(corners + 1).zip([centres[0], centres[79]]) {
                assert!(
                    cap[corners][0].distance(centre) < 1e-4,
                    "the middle of a cap is at {}",
                    cap[corners][0]
                );
            }
            assert!(before[79].distance(after[79]) > 1e-3, "there is something to see between two steps");
            go_on(&mut app, 1);
        }
    }
}
