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
//! At the start of a step parry finds the point of the face that is nearest to the shape. If the two overlap, a descent
//! along the surface normal finds the deepest point (after Macklin et al. 2020, "Local optimization for robust signed
//! distance field collision"). Substeps follow it by alternating projections onto face and shape. A face whose corners
//! all lie next to about the same plane needs none of this and is left to its particles.
//!
//! Design: `docs/design/obstacles.md`.

use glam::{DVec3, Vec3};

use crate::constants::{DESCENT_ROUNDS, FACE_THICKNESS, INTRUSION, LOOKS_AGAIN, POKING, VERTEX_WEIGHT};
use crate::contact::ball_cloth::FaceOrLink;
use crate::contact::carried_point::{CarriedPoint, PoseCache, Poses, SurfaceBelow};
use crate::contact::depenetration::PushOutRate;
use crate::contact::face_sides::{FaceSide, FaceSides};
use crate::contact::mover::{Mover, mover};
use crate::contact::obstacle_push::ObstaclePush;
use crate::geometry::nearest::{FaceOrEdge, Nearest};
use crate::geometry::nearest_triangle::weighted;
use crate::geometry::pose::Pose;
use crate::geometry::shape::{Plane, Shape, Surface};
use crate::state::body::Body;
use crate::state::friction::Friction;
use crate::state::obstacle::Obstacle;
use crate::state::particles::Particles;
use crate::state::settings::BodySettings;
use crate::state::substep::Substep;
use crate::state::topology::Topology;

/// Faces and segments of one body that may touch obstacles in this step, obstacle by obstacle.
#[derive(Clone, Debug, Default)]
pub(crate) struct FaceContacts {
    contacts: Vec<FaceContact>,
    /// Sides of the faces that may touch the obstacle that is searched.
    sides: FaceSides,
    /// For each slot, the nearest surface of the obstacle that is searched, in the obstacle's coordinates.
    surfaces: Vec<Surface>,
}

#[derive(Clone, Copy, Debug)]
struct FaceContact {
    /// A face, a side of one, or a segment.
    element: FaceOrLink,
    /// Index of the face; none for a segment.
    face: Option<usize>,
    /// The deepest point that the last search found.
    point: CarriedPoint<3>,
    /// The surface there, in the obstacle's coordinates, for shapes that are slow to query.
    plane: Option<Plane>,
    /// True if one may pass through the other within a substep.
    is_fast: bool,
    /// The surface that the element runs into in this substep, if it could otherwise pass through the obstacle.
    ahead: Option<Plane>,
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

/// An obstacle that is searched, in its own coordinates at the start of the step.
#[derive(Clone, Copy)]
pub(crate) struct SearchedObstacle<'a> {
    pub shape: &'a Shape,
    /// By index in the environment.
    pub obstacle: usize,
    pub friction: Friction,
    pub pose: Pose,
    /// Metres between body and obstacle up to which they may touch within the step.
    pub reach: f32,
    /// True if one may pass through the other within a substep.
    pub is_fast: bool,
    /// True if contacts move it.
    pub is_dynamic: bool,
}

/// The depth in metres to which a shape can reach between the corners of a face with sides of `side` metres, all of
/// them equally far from it. `None` if the depth depends on the place.
fn poke(shape: &Shape, side: f32) -> Option<f32> {
    match shape {
        Shape::HalfSpace { .. } | Shape::Container { .. } => Some(0.0),
        // The rise of an arc over its chord.
        Shape::Sphere { .. } | Shape::Capsule { .. } | Shape::TaperedCapsule { .. } => {
            let radius = shape.least_half_extent();
            (side < radius).then(|| side * side / (4.0 * radius))
        }
        Shape::Cuboid { .. } | Shape::Mesh(_) | Shape::Compound(_) | Shape::Parry(_) => None,
    }
}

/// True if a shape may have straight lines in its surface. Any point of a face that lies along one may be the deepest: held
/// there alone, the face turns about it, another point is found in the next step, and the cloth trembles. So the sides of the face
/// are held too, where they cross the line.
fn has_lines(shape: &Shape) -> bool {
    !matches!(shape, Shape::Sphere { .. })
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
    }

    /// Lists the faces and segments that may touch an obstacle between their particles.
    pub fn search(
        &mut self,
        particles: &Particles,
        topology: &Topology,
        settings: &BodySettings,
        searched: SearchedObstacle,
    ) {
        let side = topology.longest_edge;
        let most = POKING * settings.thickness;
        // A body without thickness is searched at its particles alone.
        let is_fine = || poke(searched.shape, side).is_some_and(|depth| depth <= most);
        if most == 0.0 || side == 0.0 || is_fine() {
            return;
        }
        // If an obstacle has appeared around particles, the particles leave it first.
        let nearest = self.find_surfaces(particles, searched, searched.reach + side);
        if nearest >= searched.reach + side || nearest < -INTRUSION * side {
            return;
        }
        let slot = |i: u32| particles.layout.slot(i as usize) as u32;
        let faces = topology.faces.iter().map(|face| face.map(slot));
        // Cloth throws back what moves, if its faces and their sides push it at once.
        let has_sides = has_lines(searched.shape) && !searched.is_fast && !searched.is_dynamic;
        // Reserves for all elements at once, so that elements that come near one by one do not allocate one by one.
        let most_sides = if has_sides { 3 * faces.len() } else { 0 };
        self.contacts.reserve(faces.len() + most_sides + topology.segments.len());
        let mut sides = core::mem::take(&mut self.sides);
        sides.begin(most_sides);
        let first = self.contacts.len();
        for (place, face) in faces.enumerate() {
            let is_near = self.add(FaceOrLink::Face(face), Some(place), particles, searched, side, most);
            if is_near && has_sides {
                sides.note(face, place);
            }
        }
        let near_faces = self.contacts.len() - first;
        for &FaceSide { ends, face } in sides.once() {
            self.add(FaceOrLink::Link(ends), Some(face), particles, searched, side, most);
        }
        self.sides = sides;
        // Sides come first, and leave nothing to a face that they hold at both ends of a line.
        self.contacts[first..].rotate_left(near_faces);
        for ends in &topology.segments {
            self.add(FaceOrLink::Link(ends.map(slot)), None, particles, searched, side, most);
        }
    }

    /// Finds the surface next to every particle within `reach`, and returns the least distance in metres.
    fn find_surfaces(&mut self, particles: &Particles, searched: SearchedObstacle, reach: f32) -> f32 {
        let (low, high) = searched.shape.local_bounds();
        let (low, high) = (low - reach, high + reach);
        let away = Surface { distance: f32::INFINITY, normal: Vec3::ZERO };
        self.surfaces.clear();
        self.surfaces.resize(particles.inverse_mass.len(), away);
        let mut nearest = f32::INFINITY;
        for slot in particles.layout.slots() {
            let local = searched.pose.to_local(particles.position.get(slot));
            if local.cmpge(low).all() && local.cmple(high).all() {
                let surface = searched.shape.surface(local);
                nearest = nearest.min(surface.distance);
                self.surfaces[slot] = surface;
            }
        }
        nearest
    }

    /// Adds an element if it may touch the obstacle between its corners. Returns true if so.
    fn add(
        &mut self,
        element: FaceOrLink,
        face: Option<usize>,
        particles: &Particles,
        searched: SearchedObstacle,
        side: f32,
        most: f32,
    ) -> bool {
        let corners = element.corners();
        let surfaces = corners.map(|slot| self.surfaces[slot]);
        let nearest = surfaces.map(|surface| surface.distance).into_iter().fold(f32::INFINITY, f32::min);
        let is_held = corners.iter().all(|&slot| particles.inverse_mass[slot] == 0.0);
        // A particle that is already inside leaves first.
        if nearest < 0.0
            || nearest >= searched.reach + side
            || is_held
            || !searched.is_fast && !may_poke(surfaces.map(|s| s.normal), side, most)
        {
            return false;
        }
        let local = corners.map(|slot| searched.pose.to_local(particles.position.get(slot)));
        if searched.shape.is_convex() && least_distance(surfaces, local) >= searched.reach {
            return false;
        }
        let (weights, surface) = match searched.shape.nearest_on(element.piece(local), searched.reach) {
            Nearest::Apart => return false,
            Nearest::At(_, point) => {
                let weights = element.nearest(local, point);
                (weights, searched.shape.surface(weighted(weights, local)))
            }
            Nearest::Through => {
                deepest(searched.shape, element, local, element.middle(), 0.5 * side, DESCENT_ROUNDS)
            }
        };
        if surface.distance >= searched.reach {
            return false;
        }
        let plane = surface.plane_at(weighted(weights, local));
        self.contacts.push(FaceContact {
            element,
            face,
            point: CarriedPoint::new(corners, weights, searched.obstacle, searched.friction),
            plane: (!searched.shape.has_formula()).then_some(plane),
            is_fast: searched.is_fast,
            ahead: None,
        });
        true
    }
}

impl FaceOrLink {
    fn piece(self, corners: [Vec3; 3]) -> FaceOrEdge {
        match self {
            Self::Face(_) => FaceOrEdge::Triangle(corners),
            Self::Link(_) => FaceOrEdge::Segment([corners[0], corners[1]]),
        }
    }
}

/// True if a surface with these normals next to the corners may rise between them by more than `most` metres. Two
/// planes that meet at an angle `a` rise by `side / 2 tan(a / 2)`, and any rounder surface by less.
fn may_poke([a, b, c]: [Vec3; 3], side: f32, most: f32) -> bool {
    if a == Vec3::ZERO || b == Vec3::ZERO || c == Vec3::ZERO {
        // One corner is out of reach.
        return true;
    }
    let cosine = a.dot(b).min(b.dot(c)).min(c.dot(a));
    // tan^2 (a / 2) = (1 - cos a) / (1 + cos a)
    0.25 * side * side * (1.0 - cosine) > most * most * (1.0 + cosine)
}

/// A lower bound in metres on the distance between an element and a convex shape, from the `surfaces` next to its
/// corners: the shape lies behind the tangent plane of each.
fn least_distance(surfaces: [Surface; 3], corners: [Vec3; 3]) -> f32 {
    let bounds = [0, 1, 2].map(|k| {
        let Surface { distance, normal } = surfaces[k];
        let rises = corners.map(|corner| normal.dot(corner - corners[k]));
        if distance < f32::INFINITY { distance + rises[0].min(rises[1]).min(rises[2]) } else { 0.0 }
    });
    bounds[0].max(bounds[1]).max(bounds[2])
}

/// Weights of the point of an element that is deepest in a shape, and the surface next to it. `corners` are in the
/// shape's coordinates; `stride` is the length of the first round's step in metres.
fn deepest(
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
    for contact in &mut contacts.contacts {
        let obstacle = contact.point.obstacle;
        let poses = poses.of(obstacle, mover(movers, obstacle), substep, particles.origin);
        contact.follow(particles, substep.obstacles[obstacle].shape(), poses);
        contact.point.begin_substep();
    }
}

/// Moves the faces that an obstacle pokes into out to its surface.
pub(crate) fn project(contacts: &mut FaceContacts, body: &mut Body, substep: Substep, movers: &mut [Mover]) {
    let rate = PushOutRate::gentle(substep.duration);
    let mut poses = PoseCache::default();
    for contact in &mut contacts.contacts {
        let (mover, poses) = poses.with_mover(contact.point.obstacle, movers, substep, body.particles.origin);
        contact.project(body, substep.obstacles, poses, mover, rate);
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
    for FaceContact { point, .. } in contacts.contacts.iter_mut().filter(|contact| contact.point.depth > 0.0)
    {
        let (mover, poses) = poses.with_mover(point.obstacle, movers, substep, particles.origin);
        let depth = point.depth.min(settings.thickness);
        point.apply_friction(particles, depth, poses, mover, substep, reaction);
    }
}
