//! A change of the level of detail is not seen.

use super::*;
use bevy_drape::detail::LevelOfDetail;
use bevy_drape::environment::Gusts;
use bevy_drape::viewer::Viewer;

/// Size of a pixel at a distance of one metre, in metres: 1080 of them in a field of view of 45 degrees, which is Bevy's default.
const PIXEL: f32 = 2.0 * 0.414_213_56 / 1080.0;

/// Particles along a side of the flags in full.
const SIDE: usize = 33;

/// A flag in the wind that is seen from `distance` metres, a second after it was spawned.
fn flag_seen_from(distance: f32) -> (App, Entity, Entity) {
    let mut app = app();
    app.insert_resource(Wind {
        gusts: Gusts { speed: 2.0, ..default() },
        lift_coefficient: 1.0,
        ..Wind::new(Vec3::new(7.0, 0.0, 1.0))
    });
    let viewer = app.world_mut().spawn((Viewer, Transform::from_xyz(0.0, 0.0, distance))).id();
    let cloth = Cloth::new(1.5, 1.0).with_particles(SIDE as u32, SIDE as u32).with_pins(ClothPins::Left);
    let flag = app.world_mut().spawn((cloth, Transform::default(), LevelOfDetail::default())).id();
    start(&mut app);
    (0..192).for_each(|_| frame(&mut app, 1.0));
    (app, flag, viewer)
}

/// Points all over what is shown, the same ones whatever the number of vertices.
fn shown(app: &App, flag: Entity) -> Vec<Vec3> {
    let vertices = world_vertices(app, flag);
    let side = vertices.len().isqrt();
    let step = (SIDE - 1) / (side - 1);
    let at = |row: usize, column: usize| {
        let (r, c) = ((row / step).min(side - 2), (column / step).min(side - 2));
        let (down, right) = ((row - r * step) as f32 / step as f32, (column - c * step) as f32 / step as f32);
        let corner = |r: usize, c: usize| vertices[r * side + c];
        let upper = corner(r, c).lerp(corner(r, c + 1), right);
        upper.lerp(corner(r + 1, c).lerp(corner(r + 1, c + 1), right), down)
    };
    (0..SIDE)
        .flat_map(|row| (0..SIDE).map(move |column| (row, column)))
        .map(|(row, column)| at(row, column))
        .collect()
}

/// How far points of what is shown jump because the level changes between two frames, beside a flag that does not change: root mean
/// square and greatest, and how far the flag itself moves in a frame at most; in pixels.
fn jump(from: f32, to: f32) -> [f32; 3] {
    let (mut one, flag, viewer) = flag_seen_from(from);
    let (mut other, same, _) = flag_seen_from(from);
    one.world_mut().get_mut::<Transform>(viewer).expect("the viewer").translation.z = to;
    let vertices = mesh_of(&one, flag).count_vertices();
    // Half a step further: the level changes with the next step, and half of what the step did is shown.
    for app in [&mut one, &mut other] {
        frame(app, 0.5);
        frame(app, 1.0);
    }
    assert_ne!(mesh_of(&one, flag).count_vertices(), vertices, "it changes from {from} to {to} m");
    let (changed, kept) = (shown(&one, flag), shown(&other, same));
    let squares = changed.iter().zip(&kept).map(|(a, b)| a.distance_squared(*b));
    let mean = (squares.sum::<f32>() / kept.len() as f32).sqrt();
    frame(&mut other, 1.0);
    [mean, farthest(&changed, &kept), farthest(&kept, &shown(&other, same))].map(|way| way / (PIXEL * to))
}

#[test]
fn a_change_of_level_is_less_than_the_flag_moves_in_a_frame() {
    for (from, to) in [(26.5, 28.5), (64.5, 67.0), (29.0, 24.0), (68.0, 59.0)] {
        let [mean, greatest, motion] = jump(from, to);
        println!("from {from} to {to} m: {mean:.2} pixels, {greatest:.2} at most; in a frame {motion:.2}");
        assert!(mean < 0.5, "from {from} to {to} m it jumps by {mean} pixels");
        assert!(
            greatest < 2.0 && greatest < motion,
            "from {from} to {to} m: {greatest} pixels, {motion} in a frame"
        );
    }
}

/// What is shown lies between the last two steps. A surface that began anew would show the last one at once: centimetres ahead.
#[test]
fn a_finer_mesh_begins_where_the_coarser_one_was_shown() {
    let (mut app, flag, viewer) = flag_seen_from(68.0);
    frame(&mut app, 0.25);
    let before = shown(&app, flag);
    app.world_mut().get_mut::<Transform>(viewer).expect("the viewer").translation.z = 1.0;
    // A step is taken at its very end.
    frame(&mut app, 0.75);
    let moved = farthest(&before, &shown(&app, flag));
    frame(&mut app, 1.0);
    let in_a_step = farthest(&before, &shown(&app, flag));
    assert!(in_a_step > 0.01, "the flag moves: {in_a_step} m");
    assert!(
        moved < 0.9 * in_a_step,
        "{moved} m in three quarters of a step, {in_a_step} m in one and three quarters"
    );
}

#[test]
fn meshes_come_back_with_their_texture_coordinates() {
    let (mut app, flag, viewer) = flag_seen_from(1.0);
    let fine = app.world().get::<Mesh3d>(flag).expect("a mesh").id();
    let uv = |app: &App| match mesh_of(app, flag).attribute(Mesh::ATTRIBUTE_UV_0) {
        Some(VertexAttributeValues::Float32x2(values)) => values.clone(),
        other => panic!("not two numbers a vertex: {other:?}"),
    };
    let handle = app.world().get::<Mesh3d>(flag).expect("a mesh").0.clone();
    let painted: Vec<[f32; 2]> = uv(&app).into_iter().map(|[u, v]| [3.0 * u, 1.0 - v]).collect();
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    meshes.get_mut(&handle).expect("the mesh").insert_attribute(Mesh::ATTRIBUTE_UV_0, painted.clone());
    drop(handle);
    let go = |app: &mut App, distance: f32| {
        app.world_mut().get_mut::<Transform>(viewer).expect("the viewer").translation.z = distance;
        (0..3).for_each(|_| frame(app, 1.0));
    };
    go(&mut app, 30.0);
    assert_eq!(mesh_of(&app, flag).count_vertices(), 17 * 17);
    let coarse = uv(&app);
    assert_eq!([coarse[0], coarse[16], coarse[16 * 17]], [painted[0], painted[32], painted[32 * 33]]);
    go(&mut app, 1.0);
    assert_eq!(app.world().get::<Mesh3d>(flag).expect("a mesh").id(), fine);
    assert_eq!(uv(&app), painted);
    let meshes = app.world().resource::<Assets<Mesh>>().len();
    for _ in 0..5 {
        go(&mut app, 30.0);
        go(&mut app, 1.0);
    }
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), meshes, "meshes are used again");
    app.world_mut().despawn(flag);
    (0..3).for_each(|_| frame(&mut app, 1.0));
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), 0, "none is left behind");
}
