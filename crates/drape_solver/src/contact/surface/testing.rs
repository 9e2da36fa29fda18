//! Bodies for the tests of surfaces.

use glam::{Quat, Vec3, Vec4};

use crate::build::cloth::ClothBuilder;
use crate::build::rope::RopeBuilder;
use crate::constants::BLUNT_EDGES;
use crate::contact::surface::pair::{Kind, Pair};
use crate::contact::surface::placed::PlacedSurfaces;
use crate::contact::surface::points::Points;
use crate::geometry::nearest_triangle::weighted;
use crate::state::body::Body;
use crate::state::settings::{BodySettings, SelfContact};
use crate::state::star::Star;

/// Of all bodies, in metres.
pub(crate) const THICKNESS: f32 = 0.005;
/// That bodies keep, in metres.
pub(crate) const DISTANCE: f32 = 2.0 * THICKNESS;

/// Numbers from -1 to 1.
pub(crate) struct Numbers(pub u32);

impl Numbers {
    pub fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

/// Two cloths and a rope askew, up to `spread` metres from the middle along each axis, and each particle up to `crumple` metres
/// out of its place.
pub(crate) fn bodies(numbers: &mut Numbers, spread: f32, crumple: f32) -> Vec<Body> {
    let settings =
        BodySettings { thickness: THICKNESS, self_contact: SelfContact::On, ..BodySettings::default() };
    let cloth = || ClothBuilder::new(0.1, 0.1, 6, 6).build(settings).expect("valid");
    let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X * 0.1, 8).build(settings).expect("valid");
    let mut bodies = vec![cloth(), cloth(), rope];
    for body in &mut bodies {
        body.particles.arrange(&body.topology.layout);
        let turn = Quat::from_scaled_axis(numbers.vector());
        let centre = numbers.vector() * spread;
        for i in 0..body.particles.len() {
            let place = turn * body.particles.position(i) + centre + numbers.vector() * crumple;
            body.particles.set_position(i, place);
        }
    }
    bodies
}

/// Points that fly on, each body at its own speed of up to `speed` metres a substep, and each point up to `crumple` metres more.
pub(crate) fn flying(bodies: &[Body], numbers: &mut Numbers, speed: f32, crumple: f32) -> Points {
    let mut points = Points::default();
    points.begin_substep(bodies);
    points.read_starts(bodies);
    let ways = [numbers.vector(), numbers.vector(), numbers.vector()].map(|way| way * speed);
    points.flight = points.start.clone();
    for (flight, &body) in points.flight.iter_mut().zip(&points.body) {
        *flight += (ways[body as usize] + numbers.vector() * crumple).extend(0.0);
    }
    points.end = points.flight.clone();
    points
}

/// The parts of different bodies that are nearer than the distance that they keep, at these places.
pub(crate) fn touching(surfaces: &PlacedSurfaces, points: &Points, at: &[Vec4]) -> Vec<Pair> {
    let stars = || surfaces.stars.iter();
    let body = |id: u32| points.body[id as usize];
    let mut pairs = Vec::new();
    for a in stars() {
        for b in stars().filter(|b| body(a.centre) != body(b.centre)) {
            for k in (0..b.face_count as usize).filter(|_| a.has_centre) {
                let [q, r, s] = b.face(k);
                pairs.push((Kind::CornerFace, [a.centre, q, r, s], DISTANCE));
            }
            let edges = |star: &Star| 0..star.edge_count as usize;
            for (i, k) in edges(a).flat_map(|i| edges(b).map(move |k| (i, k))) {
                let [[p, q], [r, s]] = [a.edge(i), b.edge(k)];
                if p < r {
                    // As blunt edges do, at least.
                    pairs.push((Kind::EdgeEdge, [p, q, r, s], BLUNT_EDGES * DISTANCE));
                }
            }
        }
    }
    let is_near = |&(kind, ids, distance): &(Kind, [u32; 4], f32)| {
        let corners = ids.map(|id| at[id as usize].truncate());
        weighted(kind.nearest(corners), corners).length() < distance
    };
    let pair = |(kind, ids, distance)| Pair { kind, ids, distance, ..Pair::default() };
    pairs.into_iter().filter(is_near).map(pair).collect()
}
