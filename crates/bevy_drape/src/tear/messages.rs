//! Messages: requested cuts, torn sticks, pieces that come off.

use bevy::prelude::*;
use drape_solver::world::bounds::Bounds;

use crate::entity_events::EntityMessage;

/// Cuts everything that a blade passes through. Send it at any time; the next step cuts first.
#[derive(Message, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Debug, Default, Clone, PartialEq)]
pub struct CutCloth {
    /// Triangles of the blade in the world, in metres.
    pub blade: Vec<[Vec3; 3]>,
    /// The only body that is cut; all by default.
    pub only: Option<Entity>,
}

impl CutCloth {
    /// A cut by a straight edge that moves from one place to another: a sword's hilt and tip, then and now.
    pub fn sweep([hilt, tip]: [Vec3; 2], [new_hilt, new_tip]: [Vec3; 2]) -> Self {
        Self { blade: vec![[hilt, tip, new_tip], [hilt, new_tip, new_hilt]], only: None }
    }

    /// A cut by a blade that moves along `path` and reaches `depth` to both sides of it: both in the world, in metres.
    pub fn along(path: impl IntoIterator<Item = Vec3>, depth: Vec3) -> Self {
        let mut blade = Vec::new();
        let mut path = path.into_iter();
        let mut from = path.next();
        for to in path {
            if let Some(from) = from {
                blade.extend(Self::sweep([from - depth, from + depth], [to - depth, to + depth]).blade);
            }
            from = Some(to);
        }
        Self { blade, only: None }
    }

    /// A cut of everything between two rays, up to `length` metres away: a stroke of the pointer across the screen.
    pub fn between(from: Ray3d, to: Ray3d, length: f32) -> Self {
        Self::sweep([from.origin, from.get_point(length)], [to.origin, to.get_point(length)])
    }

    /// A star of three slits of `radius` metres around `centre`, along `direction`: the hole of a bullet.
    pub fn star(centre: Vec3, direction: Dir3, radius: f32) -> Self {
        let (along, aside) = (direction * radius, direction.any_orthonormal_vector());
        let mut star = Self::default();
        for turn in 0..3_u8 {
            let turned = Quat::from_axis_angle(*direction, core::f32::consts::FRAC_PI_3 * f32::from(turn));
            let reach = turned * aside * radius;
            let slit = Self::sweep(
                [centre - reach - along, centre - reach + along],
                [centre + reach - along, centre + reach + along],
            );
            star.blade.extend(slit.blade);
        }
        star
    }

    /// Cuts this body only.
    pub fn only(mut self, body: Entity) -> Self {
        self.only = Some(body);
        self
    }

    pub(crate) fn bounds(&self) -> Bounds {
        let corners = self.blade.as_flattened().iter();
        let nothing = Bounds::new(Vec3::INFINITY, Vec3::NEG_INFINITY);
        corners.fold(nothing, |Bounds { low, high }, &c| Bounds::new(low.min(c), high.max(c)))
    }
}

/// Written for each stick that tears or is cut, and triggered on the body.
#[derive(EntityEvent, Message, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct StickTorn {
    /// The body.
    #[event_target]
    pub body: Entity,
    /// Middle of the stick when it parted, in the world, in metres.
    pub position: Vec3,
    /// Length when it parted, in metres.
    pub length: f32,
    /// Rest length in metres.
    pub rest_length: f32,
    /// True if it was cut, false if it tore.
    pub is_cut: bool,
    /// Simulated time in seconds.
    pub time: f64,
}

impl EntityMessage for StickTorn {}

/// Written for each piece that comes off a body, and triggered on the body at once.
#[derive(EntityEvent, Message, Reflect, Clone, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct BodySplit {
    /// The body that the piece was part of.
    #[event_target]
    pub body: Entity,
    /// The piece, now a body of its own; none if it was too small and vanished.
    pub piece: Option<Entity>,
    /// For each particle of the piece, its index in the body.
    pub origins: Vec<u32>,
    /// Simulated time in seconds.
    pub time: f64,
}
