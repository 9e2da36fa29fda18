//! Obstacles, as the shaders read them.

use drape_solver::glam::Vec3;
use drape_solver::{CombineRule, Obstacle, Obstacles, Shape};

use crate::distance_field::Field;
use crate::error::GpuError;
use crate::layout::{FIELD, ObstacleData};
use crate::source::MAX_OBSTACLES;

/// Coordinates that stand for infinity: a shader need not know it.
const FAR: f32 = 1e30;

/// The obstacles that move cloth in a step.
#[derive(Debug, Default)]
pub(crate) struct List {
    pub obstacles: Vec<ObstacleData>,
    /// The index of each in the environment.
    pub indices: Vec<u32>,
    /// Indices of those that cannot be sampled, or are too many, and why.
    pub left_out: Vec<(usize, GpuError)>,
}

/// Lists the obstacles that move cloth, which sensors do not. `field_of` finds the field of a shape without a formula.
///
/// # Errors
/// What `field_of` returns, unless it is [`GpuError::Unsupported`].
pub(crate) fn list(
    obstacles: &Obstacles,
    mut field_of: impl FnMut(&Shape) -> Result<Field, GpuError>,
) -> Result<List, GpuError> {
    let is_met = |obstacle: &&Obstacle| !obstacle.is_sensor() && !obstacle.is_out_of_reach();
    let mut list = List::default();
    let mut too_many = None;
    for (index, obstacle) in obstacles.iter().enumerate().filter(|(_, obstacle)| is_met(obstacle)) {
        if list.obstacles.len() == MAX_OBSTACLES {
            // All are counted only if there are too many.
            let too_many = too_many.get_or_insert_with(|| GpuError::Limit {
                what: "the list of obstacles",
                needed: obstacles.iter().filter(is_met).count() as u64,
                limit: MAX_OBSTACLES as u64,
                name: "MAX_OBSTACLES",
            });
            list.left_out.push((index, too_many.clone()));
            continue;
        }
        match data(obstacle, &mut field_of) {
            Ok(data) => {
                list.obstacles.push(data);
                list.indices.push(index as u32);
            }
            Err(reason @ GpuError::Unsupported(_)) => list.left_out.push((index, reason)),
            Err(error) => return Err(error),
        }
    }
    Ok(list)
}

fn data(
    obstacle: &Obstacle,
    field_of: impl FnOnce(&Shape) -> Result<Field, GpuError>,
) -> Result<ObstacleData, GpuError> {
    let mut field = Field::default();
    let (shape, size) = match *obstacle.shape() {
        Shape::HalfSpace { normal } => (0, [normal.x, normal.y, normal.z, 0.0]),
        Shape::Sphere { radius } => (1, [radius, 0.0, 0.0, 0.0]),
        Shape::Capsule { half_length, radius } => (2, [half_length, radius, 0.0, 0.0]),
        Shape::TaperedCapsule { half_length, bottom_radius, top_radius } => {
            (3, taper(half_length, bottom_radius, top_radius))
        }
        Shape::Cuboid { half_extents: h } => (4, [h.x, h.y, h.z, 0.0]),
        Shape::Container { half_extents: h } => (5, [h.x, h.y, h.z, 0.0]),
        Shape::Mesh(_) | Shape::Compound(_) | Shape::Parry(_) => {
            field = field_of(obstacle.shape())?;
            let low = field.lattice.low;
            (FIELD, [low.x, low.y, low.z, f32::from(u8::from(field.is_bottomless))])
        }
    };
    let (from, to) = (obstacle.previous_placement(), obstacle.placement());
    let (mut low, mut high) = obstacle.swept_bounds();
    if field.is_bottomless {
        for down in [from, to].map(|place| place.rotation * Vec3::NEG_Y) {
            // Less is rounding of the rotation.
            low = Vec3::select(down.cmplt(Vec3::splat(-1e-6)), Vec3::splat(-FAR), low);
            high = Vec3::select(down.cmpgt(Vec3::splat(1e-6)), Vec3::splat(FAR), high);
        }
    }
    let (start, end) = (from.rotation.normalize(), to.rotation.normalize());
    // Opposite quaternions are the same rotation: the nearer one.
    let start = if start.dot(end) < 0.0 { -start } else { start };
    Ok(ObstacleData {
        low: low.to_array().map(|c| c.max(-FAR)),
        shape,
        high: high.to_array().map(|c| c.min(FAR)),
        friction: obstacle.friction(),
        start: from.translation.to_array(),
        static_friction: obstacle.static_friction(),
        end: to.translation.to_array(),
        combine_rule: match obstacle.friction_rule() {
            CombineRule::Average => 0,
            CombineRule::GeometricMean => 1,
            CombineRule::Min => 2,
            CombineRule::Multiply => 3,
            CombineRule::Max => 4,
            CombineRule::ClampedSum => 5,
        },
        start_rotation: start.to_array(),
        end_rotation: end.to_array(),
        size,
        memberships: obstacle.layers().memberships,
        filters: obstacle.layers().filters,
        is_moving: u32::from(obstacle.is_moving()),
        is_asking: u32::from(obstacle.reports_reaction()),
        cell: field.lattice.cell.to_array(),
        first_pair: field.first_pair,
        corners: field.lattice.corners,
        unused: 0,
    })
}

/// Lowest and highest centre of a tapered capsule's balls, lowest radius, growth of the radius by the height.
fn taper(half_length: f32, bottom: f32, top: f32) -> [f32; 4] {
    let narrowing = bottom - top;
    if narrowing.abs() < 2.0 * half_length {
        return [-half_length, half_length, bottom, -narrowing / (2.0 * half_length)];
    }
    // One ball holds the other.
    let (height, radius) = if narrowing > 0.0 { (-half_length, bottom) } else { (half_length, top) };
    [height, height, radius, 0.0]
}
