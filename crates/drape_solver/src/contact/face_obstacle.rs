//! Faces and segments against obstacles that would slip between particles.
//!
//! A pole that is thinner than the spacing slides between particles; the edge of a box pokes through a coarse cloth whose
//! particles lie on either side of it. There the point of the face that is deepest in the obstacle is a contact of its
//! own, with barycentric weights `b_i`:
//!
//! ```text
//!     x1 o--------p--------o x2      C = n . (sum b_i x_i - q) - t
//!         \      _|_      /          if C < 0:  x_i -= b_i w_i C n / sum(b_i^2 w_i)
//!          o    / q \    o
//!              |     |  obstacle
//! ```
//!
//! Sides of faces are contacts too where the obstacle has straight lines (`face_sides.rs`).
//!
//! A search at the start of a step finds the deepest point (`face_search.rs`). Substeps follow it by alternating projections onto
//! face and shape. Few of the faces that may touch an obstacle do: those next to shapes with a formula are looked at
//! sixteen at a time (`face_lanes.rs`), and only the ones that touch take more than that.
//!
//! Design: `docs/design/obstacles.md`.

use core::ops::Range;

use glam::{DVec3, Vec3};

use crate::constants::{FACE_THICKNESS, INTRUSION, LOOKS_AGAIN, VERTEX_WEIGHT};
use crate::contact::ball_cloth::FaceOrLink;
use crate::contact::carried_point::{CarriedPoint, PoseCache, Poses, SurfaceBelow};
use crate::contact::depenetration::PushOutRate;
use crate::contact::face_lanes::FaceLanes;
use crate::contact::face_sides::FaceSides;
use crate::contact::mover::{Mover, mover};
use crate::contact::obstacle_push::ObstaclePush;
use crate::contact::surfaces_nearby::SurfacesNearby;
use crate::geometry::nearest::{FaceOrEdge, Nearest};
use crate::geometry::nearest_triangle::weighted;
use crate::geometry::shape::{Plane, Shape, Surface};
use crate::simd::columns::LANES;
use crate::state::body::Body;
use crate::state::obstacle::Obstacle;
use crate::state::particles::Particles;
use crate::state::substep::Substep;

/// Faces and segments of one body that may touch obstacles in this step, obstacle by obstacle.
#[derive(Clone, Debug, Default)]
pub(crate) struct FaceContacts {
    pub(super) contacts: Vec<FaceContact>,
    /// All contacts, in their order.
    blocks: Vec<FaceBlock>,
    /// Faces, and sides of faces, that may touch the obstacle that is searched.
    pub(super) candidates: Vec<(FaceOrLink, Option<usize>)>,
    pub(super) sides: FaceSides,
    pub(super) surfaces: SurfacesNearby,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct FaceContact {
    /// A face, a side of one, or a segment.
    pub element: FaceOrLink,
    /// Index of the face; none for a segment.
    pub face: Option<usize>,
    /// The deepest point that the last search found. Where the block has lanes, its weights are those of the last projection.
    pub point: CarriedPoint<3>,
    /// The surface there, in the obstacle's coordinates, for shapes that are slow to query.
    pub plane: Option<Plane>,
    /// True if one may pass through the other within a substep.
    pub is_fast: bool,
    /// The surface that the element runs into in this substep, if it could otherwise pass through the obstacle.
    pub ahead: Option<Plane>,
}

/// Contacts that follow each other, all with one obstacle.
#[derive(Clone, Debug)]
struct FaceBlock {
    /// By index.
    contacts: Range<usize>,
    /// None if each has to be looked at by itself.
    lanes: Option<FaceLanes>,
}

/// A face, or a side of one, or a segment that an obstacle has pushed.
pub(crate) struct PushedElement {
    /// Slots of its corners; a side or a segment repeats its last one.
    pub corners: [usize; 3],
    /// Index of the face; none for a segment.
    pub face: Option<usize>,
    pub obstacle: usize,
    /// Weights of the point that was pushed.
    pub weights: [f32; 3],
    /// Unit normal, in the world.
    pub normal: Vec3,
    /// Penetration depth in metres, summed over the projections of the substep.
    pub depth: f32,
}

impl FaceContacts {
    pub fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    /// Obstacles that have contacts, by index.
    pub fn obstacles(&self) -> impl Iterator<Item = usize> + '_ {
        self.contacts.iter().map(|contact| contact.point.obstacle)
    }

    /// The points of all contacts.
    pub fn points(&self) -> impl ExactSizeIterator<Item = &CarriedPoint<3>> {
        self.contacts.iter().map(|contact| &contact.point)
    }

    /// Adds a push (kg m) to the account of a contact, and its part along the normal to the depth.
    pub fn add_push(&mut self, index: usize, push: Vec3, normal_push: f32, particles: &Particles) {
        self.contacts[index].point.add_push(push, normal_push, particles);
    }

    /// The elements that were pushed in the last substep.
    pub fn pushed(&self) -> impl Iterator<Item = PushedElement> + '_ {
        self.contacts.iter().filter(|contact| contact.point.depth > 0.0).map(|contact| {
            let &FaceContact { face, point, .. } = contact;
            let CarriedPoint { carriers: corners, obstacle, weights, normal, depth, .. } = point;
            PushedElement { corners, face, obstacle, weights, normal, depth }
        })
    }

    /// The pushes of obstacles in the last substep on the corners that are not pinned, by their weights.
    pub fn given<'a>(&'a self, particles: &'a Particles) -> impl Iterator<Item = ObstaclePush> + 'a {
        self.contacts.iter().filter(|contact| contact.point.given != Vec3::ZERO).map(|contact| {
            let (mut free, mut moment) = (0.0, DVec3::ZERO);
            for (slot, weight) in contact.point.carriers.into_iter().zip(contact.point.weights) {
                if particles.inverse_mass[slot] > 0.0 {
                    free += weight;
                    moment += particles.position.get(slot).as_dvec3() * f64::from(weight);
                }
            }
            ObstaclePush {
                obstacle: contact.point.obstacle,
                point: particles.origin.as_dvec3() + moment / f64::from(free),
                push: contact.point.given * free,
                moment: Vec3::ZERO,
            }
        })
    }

    pub fn clear(&mut self) {
        self.contacts.clear();
        self.blocks.clear();
    }

    /// Makes room for this many more contacts.
    pub(super) fn reserve(&mut self, contacts: usize) {
        self.contacts.reserve(contacts);
        // One block may be left unfilled of sides, of faces and of segments.
        self.blocks.reserve(contacts / LANES + 3);
    }

    /// Puts these contacts, which are with one obstacle, and all faces or all links, into blocks.
    pub(super) fn add_blocks(&mut self, contacts: Range<usize>, in_lanes: bool) {
        let size = if in_lanes { LANES } else { contacts.len() };
        for first in contacts.clone().step_by(size.max(1)) {
            let contacts = first..(first + size).min(contacts.end);
            let points = self.contacts[contacts.clone()].iter();
            let points = points.map(|contact| (contact.point.carriers, contact.point.weights));
            let is_link = matches!(self.contacts[first].element, FaceOrLink::Link(_));
            let lanes = in_lanes.then(|| FaceLanes::new(points, is_link));
            self.blocks.push(FaceBlock { contacts, lanes });
        }
    }
}

impl FaceOrLink {
    pub(super) fn piece(self, corners: [Vec3; 3]) -> FaceOrEdge {
        match self {
            Self::Face(_) => FaceOrEdge::Triangle(corners),
            Self::Link(_) => FaceOrEdge::Segment([corners[0], corners[1]]),
        }
    }
}

/// Weights of the point of an element that is deepest in a shape, and the surface next to it. `corners` are in the
/// shape's coordinates; `stride` is the length of the first round's step in metres.
pub(super) fn deepest(
    shape: &Shape,
    element: FaceOrLink,
    corners: [Vec3; 3],
    mut weights: [f32; 3],
    mut stride: f32,
    rounds: u32,
) -> ([f32; 3], Surface) {
    if let Shape::Sphere { .. } = shape {
        weights = element.nearest(corners, Vec3::ZERO);
        return (weights, shape.surface(weighted(weights, corners)));
    }
    let mut best = shape.surface(weighted(weights, corners));
    for round in 0..rounds {
        // First gradient descent; then alternating projections, as for the nearest points of two convex bodies.
        let is_late = 2 * round >= rounds || stride == 0.0;
        let way = if is_late { best.distance.abs() } else { stride };
        let inwards = weighted(weights, corners) - best.normal * way;
        let trial = element.nearest(corners, inwards);
        let surface = shape.surface(weighted(trial, corners));
        if surface.distance < best.distance {
            (weights, best) = (trial, surface);
        } else {
            stride *= 0.5;
        }
    }
    (weights, best)
}

/// Forgets the last substep's depths, and follows the deepest points.
pub(crate) fn begin_substep(contacts: &mut FaceContacts, body: &Body, substep: Substep, movers: &[Mover]) {
    let particles = &body.particles;
    let mut poses = PoseCache::default();
    let FaceContacts { contacts, blocks, .. } = contacts;
    for FaceBlock { contacts: range, lanes } in blocks {
        let contacts = &mut contacts[range.clone()];
        let obstacle = contacts[0].point.obstacle;
        let shape = substep.obstacles[obstacle].shape();
        if let Some(lanes) = lanes {
            let poses = poses.of(obstacle, None, substep, particles.origin);
            for lane in lanes.take_projected() {
                contacts[lane].point.begin_substep();
            }
            lanes.follow(substep.isa, &particles.position, shape, &poses.now);
            continue;
        }
        for contact in contacts {
            let poses = poses.of(obstacle, mover(movers, obstacle), substep, particles.origin);
            contact.follow(particles, shape, poses);
            contact.point.begin_substep();
        }
    }
}

/// Moves the faces that an obstacle pokes into out to its surface.
pub(crate) fn project(contacts: &mut FaceContacts, body: &mut Body, substep: Substep, movers: &mut [Mover]) {
    let rate = PushOutRate::gentle(substep.duration);
    let mut poses = PoseCache::default();
    let FaceContacts { contacts, blocks, .. } = contacts;
    for FaceBlock { contacts: range, lanes } in blocks {
        let contacts = &mut contacts[range.clone()];
        let obstacle = contacts[0].point.obstacle;
        if let Some(lanes) = lanes {
            let poses = poses.of(obstacle, None, substep, body.particles.origin);
            project_lanes(lanes, contacts, body, substep, poses, rate);
            continue;
        }
        for contact in contacts {
            let (mover, poses) = poses.with_mover(obstacle, movers, substep, body.particles.origin);
            contact.project(body, substep.obstacles, poses, mover, rate);
        }
    }
}

/// Projects the contacts of a block that are too near, and those that earlier pushes in the block may have brought too near.
fn project_lanes(
    lanes: &mut FaceLanes,
    contacts: &mut [FaceContact],
    body: &mut Body,
    substep: Substep,
    poses: &Poses,
    rate: PushOutRate,
) {
    let shape = substep.obstacles[contacts[0].point.obstacle].shape();
    let keeps = FACE_THICKNESS * body.settings.thickness;
    let depths = lanes.depths(substep.isa, &body.particles.position, shape, &poses.now, keeps);
    let mut moved = 0.0;
    for (lane, (contact, depth)) in contacts.iter_mut().zip(depths).enumerate() {
        if depth + moved <= 0.0 {
            continue;
        }
        contact.point.weights = lanes.weights(lane);
        lanes.note_projected(lane);
        let corners = contact.element.corners();
        let before = corners.map(|slot| body.particles.position.get(slot));
        contact.project(body, substep.obstacles, poses, None, rate);
        let ways = [0, 1, 2].map(|k| body.particles.position.get(corners[k]).distance(before[k]));
        // No point moves farther than the corners that carry it.
        moved += ways[0].max(ways[1]).max(ways[2]);
    }
}

impl FaceContact {
    /// Follows the deepest point, and keeps the surface there as a plane.
    fn follow(&mut self, particles: &Particles, shape: &Shape, poses: &Poses) {
        self.ahead = None;
        if self.is_fast && self.sweep(particles, shape, poses) {
            return;
        }
        let corners = self.element.corners().map(|slot| poses.now.to_local(particles.position.get(slot)));
        let (weights, surface) = deepest(shape, self.element, corners, self.point.weights, 0.0, LOOKS_AGAIN);
        self.point.weights = weights;
        if let Some(plane) = &mut self.plane {
            *plane = surface.plane_at(weighted(weights, corners));
        }
    }

    /// Sweeps the element through the obstacle's coordinates, all of it by the way of its middle, and keeps the plane
    /// that it runs into. An element that touched the obstacle at the start of the substep is held by the surface
    /// there. Returns false if there is no plane to keep.
    fn sweep(&mut self, particles: &Particles, shape: &Shape, poses: &Poses) -> bool {
        let was_touching = self.point.depth > 0.0;
        let corners = self.element.corners();
        let end = corners.map(|slot| poses.now.to_local(particles.position.get(slot)));
        let start = corners.map(|slot| {
            poses.before.to_local(particles.position.get(slot) - particles.displacement.get(slot))
        });
        let places = || start.iter().chain(&end).copied();
        let (low, high) = shape.local_bounds();
        let (least, most) = places().fold((start[0], start[0]), |(a, b), place| (a.min(place), b.max(place)));
        if least.cmpgt(high).any() || most.cmplt(low).any() {
            return false;
        }
        let middle = self.element.middle();
        let way = weighted(middle, end) - weighted(middle, start);
        let is_outside = || shape.surface(weighted(middle, start)).distance > 0.0;
        let piece = self.element.piece(start);
        // An element that already intersects the shape has no side to be swept from, and makes parry allocate.
        let is_before = matches!(shape.nearest_on(piece, way.length()), Nearest::At(..));
        let searched = if is_before { shape.sweep_piece(piece, way) } else { None };
        let (weights, plane) = match searched {
            Some(meeting) if is_outside() => {
                let there = start.map(|corner| corner + way * meeting.fraction);
                (self.element.nearest(there, meeting.point), meeting.plane)
            }
            _ if was_touching => {
                let (weights, surface) =
                    deepest(shape, self.element, start, self.point.weights, 0.0, LOOKS_AGAIN);
                (weights, surface.plane_at(weighted(weights, start)))
            }
            _ => return false,
        };
        self.point.weights = weights;
        self.ahead = Some(plane);
        true
    }

    fn project(
        &mut self,
        body: &mut Body,
        obstacles: &[Obstacle],
        poses: &Poses,
        mover: Option<&mut Mover>,
        rate: PushOutRate,
    ) {
        let thickness = FACE_THICKNESS * body.settings.thickness;
        let local = self.point.mean(|slot| poses.now.to_local(body.particles.position.get(slot)));
        let shape = obstacles[self.point.obstacle].shape();
        let plane = self.ahead.or(self.plane);
        let surface_at = |local: Vec3| shape.surface_or(plane, local);
        let surface = surface_at(local);
        let depth = thickness - surface.distance;
        // Particles have contacts of their own at corners. An element that is deeper than this lies across an obstacle
        // that has appeared in the cloth.
        let most = INTRUSION * body.topology.longest_edge;
        let is_corner = || self.point.weights.iter().any(|&weight| weight > VERTEX_WEIGHT);
        if depth <= 0.0 || self.ahead.is_none() && (depth > most + thickness || is_corner()) {
            return;
        }
        self.point.project(
            body,
            SurfaceBelow { surface, thickness, surface_at },
            poses,
            mover,
            rate,
            reaction,
        );
    }
}

/// A push on the deepest point acts where the point's displacement of the substep began.
fn reaction(point: &CarriedPoint<3>, _: &Particles, begun: Vec3, push: Vec3) -> ObstaclePush {
    ObstaclePush::at(begun.as_dvec3(), point.obstacle, push)
}

/// Friction at the deepest points, against their slip in this substep. The corners that move along may lie around an
/// edge, so the depth counts up to one thickness only.
pub(crate) fn apply_friction(
    contacts: &mut FaceContacts,
    body: &mut Body,
    substep: Substep,
    movers: &mut [Mover],
) {
    let Body { particles, settings, .. } = body;
    let mut poses = PoseCache::default();
    let FaceContacts { contacts, blocks, .. } = contacts;
    for FaceBlock { contacts: range, lanes } in blocks {
        if lanes.as_ref().is_some_and(|lanes| !lanes.is_projected()) {
            continue;
        }
        let contacts = &mut contacts[range.clone()];
        for FaceContact { point, .. } in contacts.iter_mut().filter(|contact| contact.point.depth > 0.0) {
            let (mover, poses) = poses.with_mover(point.obstacle, movers, substep, particles.origin);
            let depth = point.depth.min(settings.thickness);
            point.apply_friction(particles, depth, poses, mover, substep, reaction);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::cloth::ClothBuilder;
    use crate::contact::surface::testing::Numbers;
    use crate::geometry::pose::Placement;
    use crate::island::Island;
    use crate::motion::environment::Environment;
    use crate::state::settings::BodySettings;
    use crate::step;

    /// A push on one face may press its neighbour in the same block into the obstacle.
    #[test]
    fn faces_of_a_block_are_projected_as_if_each_were_looked_at_by_itself() {
        // A sheet of four columns, folded to a prism of three sides round a pole, which they just touch: a push on one side pulls
        // its neighbours inwards.
        const RADIUS: f32 = 0.05;
        const SUBSTEP: f32 = 1.0 / 480.0;
        let settings = BodySettings { thickness: 0.002, ..BodySettings::default() };
        let sheet = ClothBuilder::new(0.52, 0.8, 4, 9).build(settings).expect("valid");
        let mut island = Island::of_body(sheet);
        let pole = Shape::Capsule { half_length: 1.0, radius: RADIUS };
        let pole = Obstacle::new(pole, Placement::default(), 0.3).expect("valid");
        let environment = Environment { obstacles: [pole].into(), ..Environment::default() };
        let mut numbers = Numbers(3);
        let (mut projected, mut pressed_in) = (0, 0);
        for _ in 0..20 {
            for i in 0..36 {
                let (row, column) = ((i / 4) as f32, (i % 4) as f32);
                let (sin, cos) = libm::sincosf(column * core::f32::consts::TAU / 3.0);
                let (out, axis) = (Vec3::new(cos, 0.0, sin), Vec3::Y * (0.1 * row - 0.4));
                let particles = &mut island.bodies[0].particles;
                // From a centimetre outside it gets about there within a substep.
                particles.set_position(i, axis + out * (2.0 * RADIUS + 0.012));
                particles.set_velocity(i, out * ((-0.01 + 0.001 * numbers.next()) / SUBSTEP));
            }
            step::begin(&mut island, &environment).expect("finite");
            step::accumulate_forces(&mut island, &environment);
            step::detect_collisions(&mut island, &environment);
            assert!((island.context.substep - SUBSTEP).abs() < 1e-6);
            step::integrate(&mut island, &environment);
            let substep = island.context.now(island.isa, &environment);
            let contacts = &mut island.context.contacts.bodies[0].faces;
            begin_substep(contacts, &island.bodies[0], substep, &[]);
            let (mut alone, mut body) = (contacts.clone(), island.bodies[0].clone());
            let mut first_depths = Vec::new();
            for FaceBlock { contacts: range, lanes } in &mut alone.blocks {
                let lanes = lanes.take().expect("a shape with a formula");
                let depths = lanes.depths(
                    substep.isa,
                    &body.particles.position,
                    substep.obstacles[0].shape(),
                    &PoseCache::default().of(0, None, substep, body.particles.origin).now,
                    FACE_THICKNESS * settings.thickness,
                );
                first_depths.extend_from_slice(&depths[..range.len()]);
                for (lane, contact) in range.clone().enumerate() {
                    alone.contacts[contact].point.weights = lanes.weights(lane);
                }
            }
            project(contacts, &mut island.bodies[0], substep, &mut []);
            project(&mut alone, &mut body, substep, &mut []);
            assert_eq!(island.bodies[0].particles.position, body.particles.position);
            assert_eq!(contacts.pushed().count(), alone.pushed().count());
            projected += contacts.pushed().count();
            let pairs = contacts.contacts.iter().zip(first_depths);
            pressed_in += pairs.filter(|(contact, first)| contact.point.depth > 0.0 && *first <= 0.0).count();
        }
        assert!(projected > 100, "{projected}");
        assert!(pressed_in > 0, "no face was pressed in by another");
    }
}
