//! Smooth normals.

use core::f32::consts::PI;

use bevy::prelude::*;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;

use crate::*;

fn assert_unit(normals: &[Vec3]) {
    for normal in normals {
        assert!((normal.length() - 1.0).abs() < 1e-5, "{normal} is not of unit length");
    }
}

#[test]
fn a_hanging_sheet_faces_forwards() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::new(1.0, 1.0).with_particles(16, 16)).id();
    start(&mut app);
    for _ in 0..64 {
        frame(&mut app, 1.0);
    }
    let normals = normals_of(&app, cloth);
    assert_unit(&normals);
    for normal in normals {
        assert!(normal.angle_between(Vec3::Z).to_degrees() < 3.0, "{normal}");
    }
}

/// Bends a sheet into a half cylinder about the Y axis and gives the angle between each normal and the cylinder's,
/// in degrees: the greatest inside, and the greatest at the edges.
fn bent(transform: Transform) -> [f32; 2] {
    let (columns, rows) = (33, 17);
    let mut app = app();
    let sheet = Cloth::new(PI, 1.0).with_particles(columns, rows);
    let cloth = app.world_mut().spawn((sheet, transform)).id();
    start(&mut app);
    frame(&mut app, 1.0);
    app.world_mut().resource_mut::<DrapeClock>().paused = true;
    let radial = |column: u32| {
        let angle = PI * column as f32 / (columns - 1) as f32;
        Vec3::new(-angle.cos(), 0.0, angle.sin())
    };
    let world = transform.compute_affine();
    let mut body = app.world_mut().get_mut::<Particles>(cloth).expect("built");
    for row in 0..rows {
        for column in 0..columns {
            let y = 0.5 - row as f32 / (rows - 1) as f32;
            let point = world.transform_point3(radial(column) + Vec3::Y * y);
            body.set_position((row * columns + column) as usize, point);
        }
    }
    frame(&mut app, 1.0);
    frame(&mut app, 1.0);
    let normals = normals_of(&app, cloth);
    assert_unit(&normals);
    let mut worst = [0.0_f32; 2];
    for (i, normal) in normals.iter().enumerate() {
        let (row, column) = (i as u32 / columns, i as u32 % columns);
        let is_edge = row == 0 || column == 0 || row + 1 == rows || column + 1 == columns;
        let angle = normal.angle_between(radial(column)).to_degrees();
        worst[usize::from(is_edge)] = worst[usize::from(is_edge)].max(angle);
    }
    worst
}

#[test]
fn a_bent_sheet_has_the_normals_of_the_cylinder() {
    let [inside, edge] = bent(Transform::IDENTITY);
    // A face turns by 5.6 degrees from column to column; at an edge the faces on one side only count.
    assert!(inside < 0.1, "{inside} degrees");
    assert!(edge < 3.0, "{edge} degrees");
}

#[test]
fn normals_are_those_of_the_entity_and_not_of_the_world() {
    let turned = Transform::from_xyz(3.0, 1.0, 0.0)
        .with_rotation(Quat::from_euler(EulerRot::YXZ, 2.0, 1.0, 0.3))
        .with_scale(Vec3::splat(0.5));
    let [inside, edge] = bent(turned);
    assert!(inside < 0.1 && edge < 3.0, "{inside}, {edge} degrees");
}
