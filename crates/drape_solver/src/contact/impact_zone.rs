//! Impact zones: the last stage for balls and cloth, after which no ball's centre has passed through a face.
//!
//! In a substep that asks too much of contacts and sticks, sticks can pull a cloth past the middle of a ball. The ball
//! and the corners of each face that its centre has passed through then move as one rigid piece instead, from their
//! places at the start of the substep, with their common momentum (Provot 1997, "Collision and self-collision handling
//! in cloth model dedicated to design garments"; without rotation, which the next substep brings). Nothing can pass
//! through anything within a piece. If the piece passes through another face, that face joins it.
//!
//! ```text
//!     start      contacts and sticks      zone: all by V = sum(m_i d_i) / sum(m_i)
//!
//!       o             __                          o
//!     _____          /  \ cloth                 _____
//!    /     \           o                       /     \
//! ```
//!
//! Momentum is kept; the loss of kinetic energy is that of a perfectly inelastic impact.
//!
//! Design: `docs/design/ball_cloth.md`.

use glam::{DVec3, Vec3};

use crate::constants::{CLEARANCE, PASSAGE_HALVINGS};
use crate::contact::ball_cloth::{BallCloth, FaceOrLink};
use crate::contact::event::{Other, Touch, add_impulse};
use crate::geometry::nearest_triangle::on_triangle;
use crate::geometry::nearest_triangle::weighted;
use crate::state::ball::Ball;
use crate::state::body::Body;

/// A ball's centre and the corners of a face, relative to the body's origin, in metres.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BallAndFace {
    pub centre: Vec3,
    pub corners: [Vec3; 3],
}

impl BallAndFace {
    pub fn of(contact: &BallCloth, ball: &Ball, body: &Body) -> Self {
        let particles = &body.particles;
        Self {
            centre: ball.position - particles.origin,
            corners: contact.element.corners().map(|slot| particles.position.get(slot)),
        }
    }

    /// The vector from the nearest point of the face to the centre.
    fn offset(&self) -> Vec3 {
        self.centre - weighted(on_triangle(self.corners, self.centre), self.corners)
    }

    fn middle(&self, other: &Self) -> Self {
        let corners = [0, 1, 2].map(|k| (self.corners[k] + other.corners[k]) * 0.5);
        Self { centre: (self.centre + other.centre) * 0.5, corners }
    }
}

/// True if the centre may pass through the face on its way from `start` to `end`, with all points in straight and even
/// motion.
///
/// It does not pass if a plane through the centre keeps the face's corners on one side all the way. If no such plane is
/// found, each half of the way is tested; a way that is still undecided after this many `halvings` counts as a passage.
fn may_pass(start: &BallAndFace, end: &BallAndFace, clearance: f32, halvings: u32) -> bool {
    let middle = start.middle(end);
    let offset = middle.offset();
    let nearest = [start, end].map(|placed| {
        placed
            .corners
            .map(|corner| offset.dot(placed.centre - corner))
            .into_iter()
            .fold(f32::INFINITY, f32::min)
    });
    if nearest[0].min(nearest[1]) > clearance * offset.length() {
        return false;
    }
    halvings == 0
        || may_pass(start, &middle, clearance, halvings - 1)
        || may_pass(&middle, end, clearance, halvings - 1)
}

impl BallCloth {
    /// True if the ball's centre has passed through the face since the substep began.
    fn has_passed(&self, ball: &Ball, body: &Body) -> bool {
        let FaceOrLink::Face(_) = self.element else { return false };
        let (start, end) = (&self.start, &BallAndFace::of(self, ball, body));
        // A centre that is farther from the face than its own way has not passed: stretched or not, a face lies within
        // its longest side of its first corner.
        let ways = [0, 1, 2].map(|k| (end.centre - end.corners[k]) - (start.centre - start.corners[k]));
        let way = ways.map(Vec3::length_squared).into_iter().fold(0.0, f32::max).sqrt();
        let [a, b, c] = end.corners;
        let far = a.distance_squared(b).max(a.distance_squared(c)).sqrt() + way + CLEARANCE;
        if a.distance_squared(end.centre) > far * far {
            return false;
        }
        // A centre that starts nearer than the clearance may still move away.
        let clearance = CLEARANCE.min(0.5 * start.offset().length());
        may_pass(start, end, clearance, PASSAGE_HALVINGS)
    }
}

/// The rigid pieces of a substep: none, but in the rare substep that needs one.
#[derive(Clone, Debug, Default)]
pub(crate) struct ImpactZones {
    /// Positions of the balls at the start of the substep, in the world.
    ball_starts: Vec<Vec3>,
    /// The zone of each ball, if it is in one. The index of one of its balls names a zone.
    zone_of_ball: Vec<Option<usize>>,
    members: Vec<Member>,
}

/// A particle of a zone.
#[derive(Clone, Copy, Debug)]
struct Member {
    zone: usize,
    body: usize,
    slot: usize,
    /// Its place at the start of the substep, relative to the body's origin.
    start: Vec3,
}

impl ImpactZones {
    /// Joins a ball and the corners of a face; false if they were in one zone already.
    fn join(&mut self, contact: &BallCloth) -> bool {
        let mut is_new = self.zone_of_ball[contact.ball].is_none();
        let zone = *self.zone_of_ball[contact.ball].get_or_insert(contact.ball);
        for (slot, start) in contact.element.corners().into_iter().zip(contact.start.corners) {
            let of_corner = |member: &&Member| member.body == contact.body && member.slot == slot;
            match self.members.iter().find(of_corner).map(|member| member.zone) {
                Some(known) if known == zone => {}
                Some(other) => {
                    is_new = true;
                    self.members.iter_mut().filter(|m| m.zone == other).for_each(|m| m.zone = zone);
                    let balls = self.zone_of_ball.iter_mut().filter(|known| **known == Some(other));
                    balls.for_each(|known| *known = Some(zone));
                }
                None => {
                    is_new = true;
                    self.members.push(Member { zone, body: contact.body, slot, start });
                }
            }
        }
        is_new
    }

    fn balls(&self, zone: usize) -> impl Iterator<Item = usize> + '_ {
        let balls = self.zone_of_ball.iter().enumerate();
        balls.filter(move |(_, known)| **known == Some(zone)).map(|(ball, _)| ball)
    }

    fn members(&self, zone: usize) -> impl Iterator<Item = &Member> {
        self.members.iter().filter(move |member| member.zone == zone)
    }

    /// The common displacement of a zone: that of its pin, if it holds one.
    fn displacement(&self, zone: usize, bodies: &[Body], balls: &[Ball]) -> Vec3 {
        let (mut momentum, mut mass) = (DVec3::ZERO, 0.0);
        for ball in self.balls(zone).map(|ball| &balls[ball]) {
            momentum += ball.displacement.as_dvec3() * f64::from(ball.material.mass);
            mass += f64::from(ball.material.mass);
        }
        for member in self.members(zone) {
            let particles = &bodies[member.body].particles;
            let displacement = particles.displacement.get(member.slot);
            let inverse_mass = particles.inverse_mass[member.slot];
            if inverse_mass == 0.0 {
                return displacement;
            }
            let own = 1.0 / f64::from(inverse_mass);
            momentum += displacement.as_dvec3() * own;
            mass += own;
        }
        (momentum / mass).as_vec3()
    }

    /// Moves each zone as one piece, from its place at the start of the substep.
    fn carry(&self, bodies: &mut [Body], balls: &mut [Ball], touches: &mut [Touch], substep: f32) {
        for zone in (0..balls.len()).filter(|&zone| self.balls(zone).next().is_some()) {
            let together = self.displacement(zone, bodies, balls);
            for index in self.balls(zone) {
                let ball = &mut balls[index];
                let change = (together - ball.displacement).length() * ball.material.mass;
                ball.position = self.ball_starts[index] + together;
                ball.displacement = together;
                if let Some(member) = self.members(zone).next() {
                    add_impulse(touches, index, Other::Body(member.body), change / substep);
                }
            }
            for member in self.members(zone) {
                let particles = &mut bodies[member.body].particles;
                if particles.inverse_mass[member.slot] > 0.0 {
                    particles.position.set(member.slot, member.start + together);
                    particles.displacement.set(member.slot, together);
                }
            }
        }
    }
}

/// Records the places of balls and faces that may touch, at the start of the step.
pub(crate) fn begin_step(
    zones: &mut ImpactZones,
    contacts: &mut [BallCloth],
    bodies: &[Body],
    balls: &[Ball],
) {
    note_starts(zones, contacts, bodies, balls);
    zones.zone_of_ball.clear();
    zones.zone_of_ball.resize(balls.len(), None);
}

/// Ends the substep: a ball and a face that its centre has passed through move on as one.
pub(crate) fn enforce(
    zones: &mut ImpactZones,
    contacts: &mut [BallCloth],
    bodies: &mut [Body],
    balls: &mut [Ball],
    touches: &mut [Touch],
    substep: f32,
) {
    loop {
        let mut has_grown = false;
        for contact in &*contacts {
            if contact.has_passed(&balls[contact.ball], &bodies[contact.body]) {
                has_grown |= zones.join(contact);
            }
        }
        // All that is left has moved as one piece; rounding alone makes it look like a passage.
        if !has_grown {
            break;
        }
        zones.carry(bodies, balls, touches, substep);
    }
    if !zones.members.is_empty() {
        zones.members.clear();
        zones.zone_of_ball.fill(None);
    }
    note_starts(zones, contacts, bodies, balls);
}

fn note_starts(zones: &mut ImpactZones, contacts: &mut [BallCloth], bodies: &[Body], balls: &[Ball]) {
    for contact in contacts {
        contact.start = BallAndFace::of(contact, &balls[contact.ball], &bodies[contact.body]);
    }
    zones.ball_starts.clear();
    zones.ball_starts.extend(balls.iter().map(|ball| ball.position));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::cloth::ClothBuilder;
    use crate::contact::island_contacts::IslandContacts;
    use crate::island::Island;
    use crate::motion::environment::Environment;
    use crate::state::ball::BallMaterial;
    use crate::state::measure;
    use crate::state::settings::BodySettings;
    use crate::step;

    const FRONT: BallAndFace = BallAndFace {
        centre: Vec3::new(0.2, 0.2, 0.5),
        corners: [Vec3::ZERO, Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)],
    };

    fn passes(start: BallAndFace, end: BallAndFace) -> bool {
        may_pass(&start, &end, CLEARANCE, PASSAGE_HALVINGS)
    }

    #[test]
    fn a_way_through_the_face_is_a_passage_and_a_way_beside_it_is_not() {
        let behind = BallAndFace { centre: Vec3::new(0.3, 0.1, -0.5), ..FRONT };
        assert!(passes(FRONT, behind) && passes(behind, FRONT));
        assert!(!passes(FRONT, FRONT));
        let beside = BallAndFace { centre: Vec3::new(1.5, 1.5, -0.5), ..FRONT };
        assert!(!passes(FRONT, beside), "past the longest side");
        // The face moves away faster than the centre follows, or the centre before the face.
        let by = |z: f32| FRONT.corners.map(|corner| corner + Vec3::Z * z);
        assert!(!passes(FRONT, BallAndFace { corners: by(-2.0), ..behind }));
        assert!(passes(FRONT, BallAndFace { corners: by(2.0), ..FRONT }));
        assert!(!passes(FRONT, BallAndFace { centre: Vec3::new(0.2, 0.2, 3.0), corners: by(2.0) }));
    }

    /// A way that comes close to the face within one substep, with both ends in front, is not a passage.
    #[test]
    fn a_centre_that_comes_near_and_goes_has_not_passed() {
        let near = BallAndFace { centre: Vec3::new(0.2, 0.2, 1e-6), ..FRONT };
        let clearance = 0.5 * near.offset().length();
        assert!(!may_pass(&near, &FRONT, clearance, PASSAGE_HALVINGS));
    }

    /// Sticks have pulled the middle of a sheet through a ball: both go back, and then move on together.
    #[test]
    fn ball_and_sheet_go_on_together_with_the_momentum_that_they_have() {
        let settings = BodySettings { drag: 0.0, ..BodySettings::default() };
        let sheet = ClothBuilder::new(1.0, 1.0, 9, 9).placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y);
        let mut island = Island::of_body(sheet.build(settings).expect("valid"));
        let material = BallMaterial { friction: 0.0, ..BallMaterial::default() };
        let start = Vec3::new(0.03, 0.04, 0.1);
        island.balls.push(Ball::new(material, start, Vec3::NEG_Z).expect("valid"));
        let environment = Environment { gravity: Vec3::ZERO, ..Environment::default() };
        step::begin(&mut island, &environment).expect("valid");
        step::accumulate_forces(&mut island, &environment);
        step::detect_collisions(&mut island, &environment);
        let moved = Vec3::NEG_Z * 0.3;
        island.balls[0].position += moved;
        island.balls[0].displacement = moved;
        let momentum = |island: &Island| {
            let ball = &island.balls[0];
            measure::momentum(&island.bodies[0].particles).z
                + f64::from(ball.velocity().z * ball.material.mass)
        };
        let before = momentum(&island);
        let Island { bodies, balls, touches, context, .. } = &mut island;
        let IslandContacts { impact_zones, ball_cloth, .. } = &mut context.contacts;
        enforce(impact_zones, &mut ball_cloth.pairs, bodies, balls, touches, context.substep);
        let ball = island.balls[0].clone();
        assert!((momentum(&island) - before).abs() < 1e-6 * before.abs());
        let sheet = &island.bodies[0].particles;
        let moving: Vec<usize> = (0..sheet.len()).filter(|&i| sheet.velocity(i) != Vec3::ZERO).collect();
        assert!((3..=12).contains(&moving.len()), "the face, and those that it met: {moving:?}");
        for i in moving {
            assert!((sheet.velocity(i) - ball.velocity()).length() < 1e-4);
            assert!((sheet.position(i).z - (ball.position.z - start.z)).abs() < 1e-6, "from where it was");
        }
    }
}
