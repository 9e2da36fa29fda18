//! Local winds: fans, draughts, explosions.

use core::cmp::Ordering;

use bevy::prelude::*;
use drape_solver::Placement;

use crate::refusal::Refusals;

/// A wind around its entity, in addition to the [`Wind`](crate::environment::wind::Wind) that blows everywhere.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// use bevy_drape::environment::{WindFlow, WindRegion};
/// # fn spawn(mut commands: Commands) {
/// // A fan at the left, that blows 3 m far.
/// let region = WindRegion::Cuboid(Vec3::new(1.5, 0.5, 0.5));
/// let fan = WindZone { region, flow: WindFlow::Along(Vec3::X * 6.0), falloff: 0.5 };
/// commands.spawn((fan, Transform::from_xyz(-1.5, 1.0, 0.0)));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform)]
pub struct WindZone {
    /// Region in the entity's coordinates, scale included.
    pub region: WindRegion,
    /// Motion of the air.
    pub flow: WindFlow,
    /// Outer part of the region, from 0 to 1, in which the wind falls to zero; 0.5 by default.
    pub falloff: f32,
}

/// The shape of a [`WindZone`].
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub enum WindRegion {
    /// A ball of this radius in metres.
    Sphere(f32),
    /// A box of these half extents in metres.
    Cuboid(Vec3),
}

/// Motion of the air in a [`WindZone`].
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub enum WindFlow {
    /// Velocity in m/s in the entity's coordinates, without its scale.
    Along(Vec3),
    /// Speed in m/s away from the entity, or towards it if negative.
    Outwards(f32),
}

impl Default for WindZone {
    /// A breeze of 5 m/s along -Z within 2 m.
    fn default() -> Self {
        Self { region: WindRegion::Sphere(2.0), flow: WindFlow::Along(Vec3::NEG_Z * 5.0), falloff: 0.5 }
    }
}

impl WindZone {
    fn placed(&self, transform: &GlobalTransform) -> drape_solver::WindZone {
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        let region = match self.region {
            WindRegion::Sphere(radius) => {
                drape_solver::WindRegion::Sphere(radius * scale.abs().max_element())
            }
            WindRegion::Cuboid(half_extents) => drape_solver::WindRegion::Cuboid(half_extents * scale.abs()),
        };
        let flow = match self.flow {
            WindFlow::Along(velocity) => drape_solver::WindFlow::Along(velocity),
            WindFlow::Outwards(speed) => drape_solver::WindFlow::Outwards(speed),
        };
        drape_solver::WindZone {
            region,
            placement: Placement { translation, rotation },
            flow,
            falloff: self.falloff,
        }
    }
}

/// Updates the zones; true if one was added, removed or changed. Invalid zones are left out.
pub(crate) fn read_zones(
    zones: &Query<(Entity, &WindZone, &GlobalTransform)>,
    known: &mut Vec<drape_solver::WindZone>,
    found: &mut Vec<drape_solver::WindZone>,
    refusals: &mut Refusals,
) -> bool {
    if zones.is_empty() && known.is_empty() {
        return false;
    }
    found.clear();
    for (entity, zone, transform) in zones {
        let zone = zone.placed(transform);
        if zone.validate().is_ok() {
            refusals.forget_component(entity, "WindZone");
            found.push(zone);
        } else {
            let reason = "its size must be above zero, its falloff from 0 to 1, and all of it finite";
            refusals.entity(entity, "WindZone", reason);
        }
    }
    // Winds are added up in this order, so that entity ids do not matter.
    found.sort_by(order);
    core::mem::swap(found, known);
    found != known
}

fn order(p: &drape_solver::WindZone, q: &drape_solver::WindZone) -> Ordering {
    let numbers = |zone: &drape_solver::WindZone| {
        let flow = match zone.flow {
            drape_solver::WindFlow::Along(velocity) => velocity.to_array(),
            drape_solver::WindFlow::Outwards(speed) => [speed, 0.0, 0.0],
        };
        let place = zone.placement.translation.to_array();
        place.into_iter().chain(flow)
    };
    numbers(p)
        .zip(numbers(q))
        .map(|(a, b)| a.total_cmp(&b))
        .find(|order| order.is_ne())
        .unwrap_or(Ordering::Equal)
}
