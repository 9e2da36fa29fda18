//! The search for the faces and segments that may touch an obstacle between their particles, once a step.
//!
//! Next to shapes made of balls the deepest point is found by halving their axis, sixteen faces at a time (`face_lanes.rs`). For
//! others parry finds the point of the face that is nearest to the shape; if the two overlap, a descent along the surface normal finds
//! the deepest one (after Macklin et al. 2020, "Local optimization for robust signed distance field collision"). A face
//! whose corners all lie next to about the same plane needs none of this and is left to its particles.
//!
//! Design: `docs/design/obstacles.md`.

use glam::Vec3;

use crate::constants::{DESCENT_ROUNDS, INTRUSION, POKING};
use crate::contact::ball_cloth::FaceOrLink;
use crate::contact::carried_point::CarriedPoint;
use crate::contact::face_lanes::FaceLanes;
use crate::contact::face_obstacle::{FaceContact, FaceContacts, deepest};
use crate::contact::face_sides::FaceSide;
use crate::contact::surfaces_nearby::SurfacesNearby;
use crate::geometry::nearest::Nearest;
use crate::geometry::nearest_triangle::weighted;
use crate::geometry::pose::Pose;
use crate::geometry::shape::{Plane, Shape, Surface};
use crate::geometry::taper::Taper;
use crate::simd::columns::LANES;
use crate::simd::isa::Isa;
use crate::state::friction::Friction;
use crate::state::particles::Particles;
use crate::state::settings::BodySettings;
use crate::state::topology::Topology;

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

/// True if a shape may touch a body between its particles.
pub(crate) fn may_touch_faces(shape: &Shape, topology: &Topology, settings: &BodySettings) -> bool {
    let side = topology.longest_edge;
    let most = POKING * settings.thickness;
    let is_fine = || poke(shape, side).is_some_and(|depth| depth <= most);
    // A body without thickness is searched at its particles alone.
    !(most == 0.0 || side == 0.0 || is_fine())
}

impl FaceContacts {
    /// Lists the faces and segments that may touch an obstacle between their particles, if [any may](may_touch_faces).
    pub fn search(
        &mut self,
        particles: &Particles,
        topology: &Topology,
        settings: &BodySettings,
        searched: SearchedObstacle,
        isa: Isa,
    ) {
        let side = topology.longest_edge;
        let most = POKING * settings.thickness;
        // If an obstacle has appeared around particles, the particles leave it first.
        let SearchedObstacle { shape, ref pose, reach, .. } = searched;
        let nearest = self.surfaces.find(particles, shape, pose, reach + side, isa);
        if nearest >= reach + side || nearest < -INTRUSION * side {
            return;
        }
        let slot = |i: u32| particles.layout.slot(i as usize) as u32;
        // Cloth throws back what moves, if its faces and their sides push it at once.
        let has_sides = has_lines(shape) && !searched.is_fast && !searched.is_dynamic;
        // Reserves for all elements at once, so that elements that come near one by one do not allocate one by one.
        let most_sides = if has_sides { 3 * topology.faces.len() } else { 0 };
        let [faces, segments] = [topology.faces.len(), topology.segments.len()];
        self.reserve(faces + most_sides + segments);
        self.candidates.clear();
        self.candidates.reserve(faces.max(most_sides).max(segments));
        let search = ElementSearch { particles, searched, side, most, isa };
        let first = self.contacts.len();
        let faces = topology.faces.iter().map(|face| FaceOrLink::Face(face.map(slot)));
        self.add(faces.zip((0..).map(Some)), search);
        let near_faces = self.contacts.len() - first;
        if has_sides {
            let mut sides = core::mem::take(&mut self.sides);
            sides.begin(most_sides);
            for contact in &self.contacts[first..] {
                if let (FaceOrLink::Face(corners), Some(face)) = (contact.element, contact.face) {
                    sides.note(corners, face);
                }
            }
            let once = sides.once().iter();
            self.add(once.map(|&FaceSide { ends, face }| (FaceOrLink::Link(ends), Some(face))), search);
            self.sides = sides;
            // Sides come first, and leave nothing to a face that they hold at both ends of a line.
            self.contacts[first..].rotate_left(near_faces);
        }
        let first_face = self.contacts.len() - near_faces;
        let segments = topology.segments.iter().map(|ends| (FaceOrLink::Link(ends.map(slot)), None));
        self.add(segments, search);
        let first_segment = first_face + near_faces;
        // Contacts move a dynamic obstacle one after another: no two find it in the same place.
        let in_lanes = shape.has_formula() && !searched.is_fast && !searched.is_dynamic;
        for contacts in [first..first_face, first_face..first_segment, first_segment..self.contacts.len()] {
            self.add_blocks(contacts, in_lanes);
        }
    }

    /// Adds those of these elements, all faces or all links, that may touch the obstacle between their corners.
    fn add(&mut self, elements: impl Iterator<Item = (FaceOrLink, Option<usize>)>, search: ElementSearch) {
        let mut candidates = core::mem::take(&mut self.candidates);
        candidates.clear();
        candidates.extend(elements.filter(|(element, _)| search.may_touch(*element, &self.surfaces)));
        match search.searched.shape.balls() {
            Some(balls) => {
                for candidates in candidates.chunks(LANES) {
                    let (lanes, depths) = search.deepest_in_balls(candidates, balls);
                    for (lane, (&(element, face), depth)) in candidates.iter().zip(depths).enumerate() {
                        if depth > 0.0 {
                            self.add_point(element, face, lanes.weights(lane), None, search);
                        }
                    }
                }
            }
            None => {
                for &(element, face) in &candidates {
                    if let Some((weights, plane)) = search.deepest(element) {
                        self.add_point(element, face, weights, plane, search);
                    }
                }
            }
        }
        self.candidates = candidates;
    }

    /// Adds an element with these weights of its deepest point, and the plane there for shapes that are slow to query.
    fn add_point(
        &mut self,
        element: FaceOrLink,
        face: Option<usize>,
        weights: [f32; 3],
        plane: Option<Plane>,
        search: ElementSearch,
    ) {
        let SearchedObstacle { obstacle, friction, is_fast, .. } = search.searched;
        let point = CarriedPoint::new(element.corners(), weights, obstacle, friction);
        self.contacts.push(FaceContact { element, face, point, plane, is_fast, ahead: None });
    }
}

/// The search for elements of one body next to one obstacle.
#[derive(Clone, Copy)]
struct ElementSearch<'a> {
    particles: &'a Particles,
    searched: SearchedObstacle<'a>,
    /// The longest side of a face in metres.
    side: f32,
    /// The most that a surface may rise between corners, in metres.
    most: f32,
    isa: Isa,
}

impl ElementSearch<'_> {
    /// The corners, in the obstacle's coordinates.
    fn corners(self, element: FaceOrLink) -> [Vec3; 3] {
        element.corners().map(|slot| self.searched.pose.to_local(self.particles.position.get(slot)))
    }

    /// False if the element certainly does not touch the obstacle between its corners, by the surfaces next to all slots.
    fn may_touch(self, element: FaceOrLink, surfaces: &SurfacesNearby) -> bool {
        let Self { particles, searched: SearchedObstacle { shape, reach, is_fast, .. }, side, most, .. } =
            self;
        let corners = element.corners();
        let surfaces = corners.map(|slot| surfaces.at(slot));
        let nearest = surfaces.map(|surface| surface.distance).into_iter().fold(f32::INFINITY, f32::min);
        // A particle that is already inside leaves first.
        nearest >= 0.0
            && nearest < reach + side
            && !corners.iter().all(|&slot| particles.inverse_mass[slot] == 0.0)
            && (is_fast || may_poke(surfaces.map(|s| s.normal), side, most))
            && !(shape.is_convex() && least_distance(surfaces, self.corners(element)) >= reach)
    }

    /// The deepest points of at most sixteen elements, all faces or all links, in balls; and how far they are within reach, in metres.
    fn deepest_in_balls(
        self,
        elements: &[(FaceOrLink, Option<usize>)],
        balls: Taper,
    ) -> (FaceLanes, [f32; LANES]) {
        let Self { particles, searched: SearchedObstacle { shape, ref pose, reach, .. }, isa, .. } = self;
        let is_link = matches!(elements[0].0, FaceOrLink::Link(_));
        let points = elements.iter().map(|(element, _)| (element.corners(), [0.0; 3]));
        let mut lanes = FaceLanes::new(points, is_link);
        lanes.find(isa, &particles.position, balls, pose);
        let depths = lanes.depths(isa, &particles.position, shape, pose, reach);
        (lanes, depths)
    }

    /// Weights of the deepest point of one element, and the plane there if the shape is slow to query; none if it is out of reach.
    fn deepest(self, element: FaceOrLink) -> Option<([f32; 3], Option<Plane>)> {
        let SearchedObstacle { shape, reach, .. } = self.searched;
        let corners = self.corners(element);
        let (weights, surface) = match shape.nearest_on(element.piece(corners), reach) {
            Nearest::Apart => return None,
            Nearest::At(_, point) => {
                let weights = element.nearest(corners, point);
                (weights, shape.surface(weighted(weights, corners)))
            }
            Nearest::Through => {
                deepest(shape, element, corners, element.middle(), 0.5 * self.side, DESCENT_ROUNDS)
            }
        };
        let plane = || surface.plane_at(weighted(weights, corners));
        (surface.distance < reach).then(|| (weights, (!shape.has_formula()).then(plane)))
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

#[cfg(test)]
mod tests {
    use glam::Quat;

    use crate::build::cloth::ClothBuilder;
    use crate::geometry::pose::Placement;
    use crate::geometry::shape::Shape;
    use crate::island::Island;
    use crate::motion::environment::Environment;
    use crate::state::obstacle::Obstacle;
    use crate::state::settings::BodySettings;
    use crate::step::{accumulate_forces, begin, detect_collisions};

    use super::*;

    /// The number of face contacts of a thin sheet that stands two centimetres beside a pole, if both travel at this velocity,
    /// and the sheet besides at this one towards the pole.
    fn contacts_beside_a_pole(velocity: Vec3, towards: f32) -> usize {
        let settings = BodySettings { thickness: 0.002, ..BodySettings::default() };
        let sheet =
            ClothBuilder::new(0.4, 0.4, 9, 9).placed(Vec3::new(-0.2, 0.2, 0.07), Vec3::X, Vec3::NEG_Y);
        let mut island = Island::of_body(sheet.build(settings).expect("valid"));
        let particles = &mut island.bodies[0].particles;
        for i in 0..particles.len() {
            particles.set_velocity(i, velocity - Vec3::Z * towards);
        }
        let mut environment = Environment { gravity: Vec3::ZERO, ..Environment::default() };
        let turned = Placement { rotation: Quat::from_rotation_z(0.3), ..Placement::default() };
        let pole = Shape::Capsule { half_length: 0.5, radius: 0.05 };
        let mut pole = Obstacle::new(pole, turned, 0.3).expect("valid");
        pole.move_to(Placement { translation: velocity * environment.dt, ..turned }, environment.dt);
        environment.obstacles = [pole].into();
        begin(&mut island, &environment).expect("valid");
        accumulate_forces(&mut island, &environment);
        detect_collisions(&mut island, &environment);
        island.context.contacts.bodies[0].faces.points().len()
    }

    /// Else all faces of a runner's cape within the way of the run would be contacts of every bone.
    #[test]
    fn what_travels_with_an_obstacle_is_searched_as_if_both_were_at_rest() {
        assert_eq!(contacts_beside_a_pole(Vec3::ZERO, 0.0), 0);
        let near = contacts_beside_a_pole(Vec3::ZERO, 3.0);
        assert!(near > 0);
        for velocity in [Vec3::X * 8.0, Vec3::new(3.0, -4.0, 6.0)] {
            assert_eq!(contacts_beside_a_pole(velocity, 0.0), 0, "{velocity}");
            assert_eq!(contacts_beside_a_pole(velocity, 3.0), near, "{velocity}");
        }
    }
}
