//! Outlines of obstacles.

use core::f32::consts::{FRAC_PI_2, TAU};

use bevy::color::Color;
use bevy::math::ops::{asin, sin_cos};
use bevy::prelude::*;

use crate::environment::obstacle::Obstacle;
use crate::environment::obstacle_shape::ObstacleShape;
use crate::tools::gizmos::DrapeGizmos;

const OBSTACLE_COLOR: Color = Color::srgb(0.3, 0.7, 1.0);

/// Lines along a round shape, and points of each from pole to pole.
const MERIDIANS: usize = 8;
const ARC: usize = 12;

pub(crate) fn draw_obstacles(
    mut gizmos: Gizmos<DrapeGizmos>,
    obstacles: Query<(&Obstacle, &GlobalTransform)>,
) {
    if !gizmos.config.enabled || !gizmos.config_ext.obstacles {
        return;
    }
    for (obstacle, place) in &obstacles {
        match obstacle.shape {
            ObstacleShape::Sphere { radius } => round(&mut gizmos, place, 0.0, [radius; 2]),
            ObstacleShape::Capsule { radius, length } => round(&mut gizmos, place, 0.5 * length, [radius; 2]),
            ObstacleShape::TaperedCapsule { bottom_radius, top_radius, length } => {
                round(&mut gizmos, place, 0.5 * length, [bottom_radius, top_radius]);
            }
            ObstacleShape::Cuboid { size } | ObstacleShape::Container { size } => {
                edges(&mut gizmos, place, 0.5 * size);
            }
            ObstacleShape::Cylinder { radius, height } => {
                let half = 0.5 * height;
                revolve(&mut gizmos, place, &[Vec2::new(radius, -half), Vec2::new(radius, half)]);
            }
            ObstacleShape::Cone { radius, height } => {
                let half = 0.5 * height;
                revolve(&mut gizmos, place, &[Vec2::new(radius, -half), Vec2::new(0.0, half)]);
            }
            _ => {}
        }
    }
}

/// The hull of two balls on the Y axis, one `half` below the origin, the other as far above.
fn round(gizmos: &mut Gizmos<DrapeGizmos>, place: &GlobalTransform, half: f32, [bottom, top]: [f32; 2]) {
    // The side touches both where their normals rise by this sine; one ball that holds the other touches itself only.
    let rise = if half > 0.0 { ((bottom - top) / (2.0 * half)).clamp(-1.0, 1.0) } else { 0.0 };
    let touching = asin(rise);
    let mut outline = Vec::with_capacity(2 * ARC + 2);
    for (height, radius, from, to) in
        [(-half, bottom, -FRAC_PI_2, touching), (half, top, touching, FRAC_PI_2)]
    {
        outline.extend((0..=ARC).map(|index| {
            let (sin, cos) = sin_cos(from + (to - from) * index as f32 / ARC as f32);
            Vec2::new(radius * cos, height + radius * sin)
        }));
    }
    revolve(gizmos, place, &outline);
}

/// Draws an outline of (distance from the Y axis, height) in several planes, and circles at its corners that turn most.
fn revolve(gizmos: &mut Gizmos<DrapeGizmos>, place: &GlobalTransform, outline: &[Vec2]) {
    let at = |point: Vec2, angle: f32| {
        let (sin, cos) = sin_cos(angle);
        place.transform_point(Vec3::new(point.x * cos, point.y, point.x * sin))
    };
    for meridian in 0..MERIDIANS {
        let angle = TAU * meridian as f32 / MERIDIANS as f32;
        line(gizmos, outline.iter().map(|&point| at(point, angle)));
    }
    let middle = outline.len() / 2;
    for &point in [outline.get(middle - 1), outline.get(middle)].into_iter().flatten() {
        let circle = (0..=2 * ARC).map(|index| at(point, TAU * index as f32 / (2 * ARC) as f32));
        line(gizmos, circle);
    }
}

fn line(gizmos: &mut Gizmos<DrapeGizmos>, points: impl Iterator<Item = Vec3> + Clone) {
    for (from, to) in points.clone().zip(points.skip(1)) {
        gizmos.line(from, to, OBSTACLE_COLOR);
    }
}

/// The edges of a box.
fn edges(gizmos: &mut Gizmos<DrapeGizmos>, place: &GlobalTransform, half: Vec3) {
    for axis in 0..3 {
        for (one, other) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let ends = [-1.0, 1.0].map(|end| {
                let mut corner = half;
                corner[axis] *= end;
                corner[(axis + 1) % 3] *= one;
                corner[(axis + 2) % 3] *= other;
                place.transform_point(corner)
            });
            gizmos.line(ends[0], ends[1], OBSTACLE_COLOR);
        }
    }
}
