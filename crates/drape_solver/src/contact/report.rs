//! Contact reports: the contacts of bodies and balls over a step, pair by pair, for those that ask for reports.
//!
//! Contacts keep the last substep only. After each substep its pushes are added up here; bodies and balls that ask for
//! no report cost nothing. Sensors, which push nothing, are tested here alone.
//!
//! Design: `docs/design/contact_reports.md`.

use glam::Vec3;

use crate::contact::ball_cloth::BallCloth;
use crate::contact::body_contacts::BodyContacts;
use crate::contact::event::{Contact, Feature, Other, Party, Touch, pair_without};
use crate::contact::face_obstacle::PushedElement;
use crate::contact::island_contacts::IslandContacts;
use crate::contact::surface::SurfaceContacts;
use crate::geometry::nearest_triangle::weighted;
use crate::geometry::shape::Shape;
use crate::simd::columns::LANES;
use crate::state::ball::Ball;
use crate::state::body::Body;
use crate::state::obstacle::Obstacle;
use crate::state::substep::Substep;

/// The report of one step.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactReport {
    /// True if there is something to gather after each substep.
    is_on: bool,
    /// One for each pair, in order of the pairs.
    accounts: Vec<Account>,
    /// Bodies and balls that may touch sensors.
    watches: Vec<Watch>,
    /// The cells of bodies that may touch sensors.
    watched_cells: Vec<u32>,
    /// Obstacles near balls that ask for a report, in order.
    reporting: Vec<usize>,
}

/// The contact of one pair since the step began.
#[derive(Clone, Copy, Debug)]
struct Account {
    pair: (Party, Other),
    contact: Contact,
    /// Corners of the face that the contact is on.
    face: Option<[u32; 3]>,
    /// The hardest push on one particle or face so far, in newton seconds: its place is that of the contact.
    hardest: f32,
}

/// A body or ball that may touch a sensor in this step.
#[derive(Clone, Copy, Debug)]
struct Watch {
    party: Party,
    sensor: usize,
    /// The range of a body's cells in the list: the first, and one past the last.
    cells: [usize; 2],
}

/// A push on a particle or face.
struct ReportedPush {
    pair: (Party, Other),
    point: Vec3,
    normal: Vec3,
    /// Impulse in newton seconds.
    impulse: f32,
    feature: Option<Feature>,
    face: Option<[u32; 3]>,
}

impl ContactReport {
    /// Clears the report for a new step.
    pub fn clear(&mut self) {
        self.is_on = false;
        self.accounts.clear();
        self.watches.clear();
        self.watched_cells.clear();
        self.reporting.clear();
    }

    /// True if the step must go substep by substep.
    pub fn is_on(&self) -> bool {
        self.is_on
    }

    /// Drops a body or ball that was taken out of the island.
    pub fn forget(&mut self, gone: Other) {
        self.watches.clear();
        self.accounts.retain_mut(|account| {
            let left = pair_without(account.pair, gone);
            if let Some(pair) = left {
                account.pair = pair;
                (account.contact.party, account.contact.other) = pair;
            }
            left.is_some()
        });
    }

    /// Drops a body that is empty from now on.
    pub fn vacate(&mut self, body: usize) {
        let is_it = |party: Party| party == Party::Body(body);
        self.watches.retain(|watch| !is_it(watch.party));
        self.accounts.retain(|account| !is_it(account.pair.0) && account.pair.1 != Other::Body(body));
    }

    fn is_known(&self, pair: (Party, Other)) -> bool {
        self.accounts.binary_search_by_key(&pair, |account| account.pair).is_ok()
    }

    fn add(&mut self, push: ReportedPush, time: f32) {
        let ReportedPush { pair, point, normal, impulse, feature, face } = push;
        let place = match self.accounts.binary_search_by_key(&pair, |account| account.pair) {
            Ok(place) => place,
            Err(place) => {
                let (party, other) = pair;
                let contact = Contact { party, other, time, point, normal, impulse: 0.0, feature };
                self.accounts.insert(place, Account { pair, contact, face, hardest: impulse });
                place
            }
        };
        let account = &mut self.accounts[place];
        account.contact.impulse += impulse;
        if impulse > account.hardest {
            account.hardest = impulse;
            account.face = face;
            account.contact = Contact { point, normal, feature, ..account.contact };
        }
    }
}

/// Finds the pairs to be reported in this step, in which no particle moves more than `reach` metres.
pub(crate) fn detect(
    report: &mut ContactReport,
    contacts: &IslandContacts,
    bodies: &[Body],
    balls: &[Ball],
    obstacles: &[Obstacle],
    reach: f32,
) {
    for (index, (body, of_body)) in bodies.iter().zip(&contacts.bodies).enumerate() {
        let is_reported = |obstacle: &Obstacle| body.reports_contacts || obstacle.reports_contacts();
        let mut near = of_body.obstacles.obstacles().chain(of_body.faces.obstacles());
        let is_touched = near.any(|index| is_reported(&obstacles[index]));
        report.is_on |= is_touched || (body.reports_contacts && !balls.is_empty());
        let reach = reach + body.settings.thickness;
        for sensor in of_body.obstacles.near.iter().map(|&index| index as usize) {
            let obstacle = &obstacles[sensor];
            if !(obstacle.senses(body.layers) && is_reported(obstacle)) {
                continue;
            }
            let pose = obstacle.pose_at(0.0, body.particles.origin);
            let (low, high) = obstacle.shape().local_bounds();
            let reach = reach + obstacle.travel();
            let is_near = |position: Vec3| {
                let local = pose.to_local(position);
                local.cmpge(low - reach).all() && local.cmple(high + reach).all()
            };
            let first = report.watched_cells.len();
            let cells = body.particles.position.cells.iter().enumerate();
            let near = cells.filter(|(_, cell)| (0..LANES).any(|lane| is_near(cell.get(lane))));
            report.watched_cells.extend(near.map(|(cell, _)| cell as u32));
            let cells = [first, report.watched_cells.len()];
            report.watches.push(Watch { party: Party::Body(index), sensor, cells });
        }
    }
    for &(index, sensor) in &contacts.ball_obstacle.passable {
        let (ball, obstacle) = (&balls[index], &obstacles[sensor]);
        if obstacle.senses(ball.layers) && (ball.reports_contacts || obstacle.reports_contacts()) {
            report.watches.push(Watch { party: Party::Ball(index), sensor, cells: [0; 2] });
        }
    }
    let is_in_company = bodies.iter().filter(|body| body.has_self_contact()).nth(1).is_some();
    report.is_on |= is_in_company && bodies.iter().any(|body| body.reports_contacts);
    let near_balls = contacts.ball_obstacle.obstacles();
    report.reporting.extend(near_balls.filter(|&index| obstacles[index].reports_contacts()));
    report.reporting.sort_unstable();
    report.is_on |= !report.watches.is_empty() || balls.iter().any(|ball| ball.reports_contacts);
}

/// Adds the pushes of the substep that has just ended.
pub(crate) fn gather(
    report: &mut ContactReport,
    contacts: &IslandContacts,
    bodies: &[Body],
    balls: &[Ball],
    substep: Substep,
) {
    if !report.is_on {
        return;
    }
    gather_particles(report, &contacts.bodies, bodies, substep);
    gather_bodies(report, &contacts.surfaces, bodies, substep);
    gather_faces(report, &contacts.ball_cloth.pairs, bodies, balls);
    sense(report, bodies, balls, substep);
}

/// Adds particles and faces that obstacles have pushed.
fn gather_particles(
    report: &mut ContactReport,
    contacts: &[BodyContacts],
    bodies: &[Body],
    substep: Substep,
) {
    for (index, (body, contacts)) in bodies.iter().zip(contacts).enumerate() {
        let particles = &body.particles;
        for (obstacle, slot, normal, depth) in contacts.obstacles.pushed() {
            if !(body.reports_contacts || substep.obstacles[obstacle].reports_contacts()) {
                continue;
            }
            let surface = particles.position.get(slot) - normal * body.settings.thickness;
            let push = ReportedPush {
                pair: (Party::Body(index), Other::Obstacle(obstacle)),
                point: surface + particles.origin,
                normal,
                // Mass times the velocity that the push has changed.
                impulse: depth / (particles.inverse_mass[slot] * substep.duration),
                feature: particles.layout.index(slot).map(Feature::Particle),
                face: None,
            };
            report.add(push, substep.start());
        }
        for PushedElement { corners, face, obstacle, weights, normal, depth } in contacts.faces.pushed() {
            if !(body.reports_contacts || substep.obstacles[obstacle].reports_contacts()) {
                continue;
            }
            let point = weighted(weights, corners.map(|slot| particles.position.get(slot)));
            let inverse_mass =
                corners.iter().zip(weights).map(|(&slot, b)| b * b * particles.inverse_mass[slot]);
            let feature = face.map(Feature::Face).or_else(|| {
                let nearest_end = if weights[0] >= weights[1] { corners[0] } else { corners[1] };
                particles.layout.index(nearest_end).map(Feature::Particle)
            });
            let push = ReportedPush {
                pair: (Party::Body(index), Other::Obstacle(obstacle)),
                point: point - normal * body.settings.thickness + particles.origin,
                normal,
                impulse: depth / (inverse_mass.sum::<f32>() * substep.duration),
                feature,
                face: None,
            };
            report.add(push, substep.start());
        }
    }
}

/// Adds particles of bodies that have pushed each other.
fn gather_bodies(report: &mut ContactReport, contacts: &SurfaceContacts, bodies: &[Body], substep: Substep) {
    for (ends, normal, depth) in contacts.pushed_bodies() {
        if !ends.iter().any(|&(body, _)| bodies[body].reports_contacts) {
            continue;
        }
        // The body that comes first is the party.
        let is_turned = ends[0].0 > ends[1].0;
        let [(first, slot), (second, other_slot)] = if is_turned { [ends[1], ends[0]] } else { ends };
        let normal = if is_turned { -normal } else { normal };
        let (particles, other) = (&bodies[first].particles, &bodies[second]);
        let surface = other.particles.position.get(other_slot) + normal * other.settings.thickness;
        let inverse_mass = particles.inverse_mass[slot] + other.particles.inverse_mass[other_slot];
        let push = ReportedPush {
            pair: (Party::Body(first), Other::Body(second)),
            point: surface + other.particles.origin,
            normal,
            impulse: depth / (inverse_mass * substep.duration),
            feature: particles.layout.index(slot).map(Feature::Particle),
            face: None,
        };
        report.add(push, substep.start());
    }
}

/// Adds faces and segments that balls have pushed. The ball's [touch](Touch) has the rest of the contact.
fn gather_faces(report: &mut ContactReport, contacts: &[BallCloth], bodies: &[Body], balls: &[Ball]) {
    for contact in contacts {
        let (ball, body) = (contact.ball, contact.body);
        let Some((corners, weights, depth)) = contact.pushed() else { continue };
        if !(balls[ball].reports_contacts || bodies[body].reports_contacts) {
            continue;
        }
        let corners = corners.map(|slot| bodies[body].particles.layout.index(slot));
        let [Some(a), Some(b), Some(c)] = corners else { continue };
        let is_face = b != c;
        let nearest_end = if weights[0] >= weights[1] { a } else { b };
        report.add(
            ReportedPush {
                pair: (Party::Ball(ball), Other::Body(body)),
                point: Vec3::ZERO,
                normal: Vec3::ZERO,
                impulse: depth,
                feature: (!is_face).then_some(Feature::Particle(nearest_end)),
                face: is_face.then_some([a, b, c].map(|corner| corner as u32)),
            },
            0.0,
        );
    }
}

/// Adds bodies and balls that are within a sensor.
fn sense(report: &mut ContactReport, bodies: &[Body], balls: &[Ball], substep: Substep) {
    let fraction = (substep.index + 1) as f32 / substep.count as f32;
    for place in 0..report.watches.len() {
        let Watch { party, sensor, cells } = report.watches[place];
        let pair = (party, Other::Obstacle(sensor));
        if report.is_known(pair) {
            continue;
        }
        let obstacle = &substep.obstacles[sensor];
        let within = |position: Vec3, origin: Vec3, distance: f32| {
            let local = obstacle.pose_at(fraction, origin).to_local(position);
            is_within(obstacle.shape(), local, distance)
        };
        let found = match party {
            Party::Ball(index) => {
                let ball = &balls[index];
                within(ball.position, Vec3::ZERO, ball.material.radius).then_some((ball.position, None))
            }
            Party::Body(index) => {
                let body = &bodies[index];
                let particles = &body.particles;
                let slots = report.watched_cells[cells[0]..cells[1]].iter().flat_map(|&cell| {
                    let first = cell as usize * LANES;
                    first..first + LANES
                });
                let mut known = slots
                    .filter_map(|slot| Some((particles.position.get(slot), particles.layout.index(slot)?)));
                known
                    .find(|&(position, _)| within(position, particles.origin, body.settings.thickness))
                    .map(|(position, index)| (position + particles.origin, Some(Feature::Particle(index))))
            }
        };
        if let Some((point, feature)) = found {
            let normal = (point - obstacle.placement().translation).try_normalize().unwrap_or(Vec3::Y);
            report.add(
                ReportedPush { pair, point, normal, impulse: 0.0, feature, face: None },
                substep.start(),
            );
        }
    }
}

/// True if a point, in the shape's coordinates, is inside it or nearer to it than `distance` metres.
fn is_within(shape: &Shape, point: Vec3, distance: f32) -> bool {
    match shape {
        // Parry's projection onto the surface allocates for points inside.
        Shape::Parry(shape) => shape.distance_to_local_point(point, true) < distance,
        shape => shape.surface(point).distance < distance,
    }
}

/// Puts the contacts of the step into the island, in order of their pairs.
pub(crate) fn finish(
    report: &ContactReport,
    bodies: &[Body],
    balls: &[Ball],
    touches: &[Touch],
    contacts: &mut Vec<Contact>,
) {
    contacts.clear();
    let reports = |other: Other| match other {
        Other::Body(i) => bodies[i].reports_contacts,
        Other::Ball(i) => balls[i].reports_contacts,
        Other::Obstacle(i) => report.reporting.binary_search(&i).is_ok(),
    };
    for touch in touches {
        let Touch { ball, other, time, point, normal, impulse, .. } = *touch;
        // Two balls have a touch each.
        let is_second = matches!(other, Other::Ball(second) if second < ball);
        if is_second || !(balls[ball].reports_contacts || reports(other)) {
            continue;
        }
        let party = Party::Ball(ball);
        contacts.push(Contact { party, other, time, point, normal, impulse, feature: None });
    }
    contacts.sort_unstable_by_key(Contact::pair);
    // Of a ball and a cloth the report has the feature only: the touch has the rest.
    for account in &report.accounts {
        match (account.pair, contacts.binary_search_by_key(&account.pair, Contact::pair)) {
            ((Party::Ball(_), Other::Body(body)), Ok(place)) => {
                let index_of = |face| bodies[body].topology.faces.iter().position(|known| known == face);
                let face = account.face.as_ref().and_then(index_of).map(Feature::Face);
                contacts[place].feature = face.or(account.contact.feature);
            }
            ((Party::Ball(_), Other::Body(_)), Err(_)) | (_, Ok(_)) => {}
            (_, Err(place)) => contacts.insert(place, account.contact),
        }
    }
}
