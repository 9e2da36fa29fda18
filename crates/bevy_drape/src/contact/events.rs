//! Messages about contacts: begun, ended, hard hits.

use bevy::prelude::*;
use drape_solver::{Contact, Feature, Other, Party};

use crate::body::activity::Activity;
use crate::clock::DrapeClock;
use crate::contact::hit::APART;
use crate::environment::solver_environment::SolverEnvironment;
use crate::step::island_run::IslandRun;
use crate::step::islands::Islands;

/// Marks a body, ball or obstacle whose contacts are told by [`DrapeContactStarted`], [`DrapeContactHit`] and
/// [`DrapeContactEnded`]. One of two that touch is enough.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// fn set_up(mut commands: Commands) {
///     commands.spawn((Obstacle::cuboid(4.0, 0.1, 4.0).as_sensor(), ContactEvents));
/// }
///
/// fn listen(mut started: MessageReader<DrapeContactStarted>) {
///     for contact in started.read() {
///         println!("{} touches {} at {}", contact.body, contact.other, contact.point);
///     }
/// }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Debug, Clone)]
pub struct ContactEvents;

/// The part of a body that touches, by index.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[reflect(Debug, Clone, PartialEq)]
pub enum ContactFeature {
    /// A particle of a cloth or rope.
    Particle(usize),
    /// A face of a cloth.
    Face(usize),
}

impl From<Feature> for ContactFeature {
    fn from(feature: Feature) -> Self {
        match feature {
            Feature::Particle(index) => Self::Particle(index),
            Feature::Face(index) => Self::Face(index),
        }
    }
}

/// How two touch in one step. All the particles of a cloth that touch one thing are one contact.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct DrapeContact {
    /// The body or ball that touches something; of a ball and a cloth, the ball.
    pub body: Entity,
    /// What it touches.
    pub other: Entity,
    /// Simulated time in seconds at which they first touched in this step: interpolated for balls, to the substep for
    /// particles and sensors.
    pub time: f64,
    /// Point of the other's surface: where a cloth was pushed the hardest, or a ball first touched; in a sensor, where a
    /// particle or the ball's centre was found.
    pub point: Vec3,
    /// Unit normal there, from the other towards the body. In a sensor, from its middle to the point.
    pub normal: Vec3,
    /// Sum of the sizes of all normal impulses in this step, in newton seconds; 0 for a sensor.
    pub impulse: f32,
    /// The particle or face at that point. None between a ball and another or an obstacle.
    pub feature: Option<ContactFeature>,
}

/// Sent in the step in which two begin to touch.
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq, Deref)]
#[reflect(Debug, Clone, PartialEq)]
pub struct DrapeContactStarted(pub DrapeContact);

/// Sent in the step in which the impulse of a contact, new or lasting, rises to
/// [`hit_impulse`](DrapeContactSettings::hit_impulse). It is sent again once the impulse has been below half of that.
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq, Deref)]
#[reflect(Debug, Clone, PartialEq)]
pub struct DrapeContactHit(pub DrapeContact);

/// Sent when two have not touched for a tenth of a second. What rests goes on touching. An entity may have been despawned
/// by then.
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct DrapeContactEnded {
    /// The body or ball that touched something.
    pub body: Entity,
    /// What it touched.
    pub other: Entity,
    /// Simulated time in seconds of the end of the last step in which they touched.
    pub time: f64,
}

/// What is told of contacts.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DrapeContactSettings {
    /// The most messages of the three kinds together that are sent in one step; 256 by default. The start and the end of
    /// a contact then wait for the next step; hits are lost.
    pub max_messages: usize,
    /// The impulse in newton seconds that makes a hit; 0.1 by default: what stops 100 grams at 1 m/s.
    pub hit_impulse: f32,
}

impl Default for DrapeContactSettings {
    fn default() -> Self {
        Self { max_messages: 256, hit_impulse: 0.1 }
    }
}

/// What was told of contacts in the last step.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct DrapeContactCounts {
    /// Contacts that last.
    pub touching: usize,
    /// Messages that were sent.
    pub sent: usize,
    /// Messages that were not sent, as there were too many.
    pub held_back: usize,
}

/// Pairs that touch or have just done so, in order.
#[derive(Resource, Default)]
pub(crate) struct ContactPairs(Vec<Pair>);

impl ContactPairs {
    /// All pairs.
    pub fn iter(&self) -> impl Iterator<Item = ((Entity, Entity), ContactPair)> + '_ {
        self.0.iter().map(|pair| (pair.entities, pair.state))
    }

    /// Knows these instead of all others.
    pub fn replace(&mut self, pairs: Vec<((Entity, Entity), ContactPair)>) {
        self.0 = pairs.into_iter().map(|(entities, state)| Pair { entities, state }).collect();
        self.0.sort_unstable_by_key(|pair| pair.entities);
    }
}

#[derive(Clone, Copy)]
struct Pair {
    entities: (Entity, Entity),
    state: ContactPair,
}

/// What is known of two that touch or have just done so.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ContactPair {
    /// Simulated time in seconds of the end of the last step in which they touched.
    touched: f64,
    /// Until when the contact lasts.
    until: f64,
    /// Whether its start was sent.
    is_told: bool,
    /// Whether the impulse has not fallen since the last hit.
    is_hitting: bool,
}

/// Tells of the contacts of this step.
pub(crate) fn send_contacts(
    islands: Res<Islands>,
    solver: Res<SolverEnvironment>,
    activities: Query<&Activity>,
    asking: Query<(), With<ContactEvents>>,
    clock: Res<DrapeClock>,
    settings: Res<DrapeContactSettings>,
    mut pairs: ResMut<ContactPairs>,
    mut counts: ResMut<DrapeContactCounts>,
    mut started: MessageWriter<DrapeContactStarted>,
    mut hits: MessageWriter<DrapeContactHit>,
    mut ended: MessageWriter<DrapeContactEnded>,
) {
    let pairs = &mut pairs.0;
    let now = clock.elapsed();
    let end = now + f64::from(clock.delta());
    let mut tally = DrapeContactCounts::default();
    // Whether there is room for one more message.
    let may_send = |tally: &mut DrapeContactCounts| {
        let is_room = tally.sent < settings.max_messages;
        let count = if is_room { &mut tally.sent } else { &mut tally.held_back };
        *count += 1;
        is_room
    };
    for island in islands.live() {
        for contact in &island.solver.contacts {
            let contact = told(contact, island, &solver, now);
            let entities = (contact.body, contact.other);
            let place = pairs.binary_search_by_key(&entities, |pair| pair.entities).unwrap_or_else(|place| {
                let state = ContactPair { touched: end, until: end, is_told: false, is_hitting: false };
                pairs.insert(place, Pair { entities, state });
                place
            });
            let pair = &mut pairs[place].state;
            pair.touched = end;
            pair.until = end + APART;
            if !pair.is_told && may_send(&mut tally) {
                pair.is_told = true;
                started.write(DrapeContactStarted(contact));
            }
            if contact.impulse >= settings.hit_impulse && contact.impulse > 0.0 {
                if !pair.is_hitting && may_send(&mut tally) {
                    hits.write(DrapeContactHit(contact));
                }
                pair.is_hitting = true;
            } else if contact.impulse < 0.5 * settings.hit_impulse {
                pair.is_hitting = false;
            }
        }
    }
    pairs.retain_mut(|Pair { entities: (body, other), state: pair }| {
        let (body, other) = (*body, *other);
        let is_asked = asking.contains(body) || asking.contains(other);
        if is_asked && activities.get(body).is_ok_and(|activity| *activity != Activity::Active) {
            pair.until = end + APART;
        }
        let lasts = is_asked && pair.until > end;
        if !lasts && pair.is_told && !may_send(&mut tally) {
            return true;
        }
        if !lasts && pair.is_told {
            ended.write(DrapeContactEnded { body, other, time: pair.touched });
        }
        tally.touching += usize::from(lasts);
        lasts
    });
    counts.set_if_neq(tally);
}

/// A contact of the solver in terms of entities.
fn told(contact: &Contact, island: &IslandRun, solver: &SolverEnvironment, now: f64) -> DrapeContact {
    let Contact { party, other, time, point, normal, impulse, feature } = *contact;
    DrapeContact {
        body: match party {
            Party::Body(i) => island.bodies[i],
            Party::Ball(i) => island.balls[i],
        },
        other: match other {
            Other::Body(i) => island.bodies[i],
            Other::Ball(i) => island.balls[i],
            Other::Obstacle(i) => solver.obstacles.entity(i),
        },
        time: now + f64::from(time),
        point,
        normal,
        impulse,
        feature: feature.map(ContactFeature::from),
    }
}
