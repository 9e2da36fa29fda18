//! Sends the messages about contacts.

use bevy::prelude::*;
use drape_solver::{Contact, Other, Party};

use crate::body::activity::Activity;
use crate::body::contact_events::ContactEvents;
use crate::clock::DrapeClock;
use crate::contact::contact_pairs::{ContactPair, ContactPairs, Pair};
use crate::contact::events::{
    ContactFeature, DrapeContact, DrapeContactCounts, DrapeContactEnded, DrapeContactHit,
    DrapeContactSettings, DrapeContactStarted,
};
use crate::contact::hit::APART;
use crate::environment::solver_environment::SolverEnvironment;
use crate::step::island_run::IslandRun;
use crate::step::islands::Islands;

/// Sends messages about the contacts of this step.
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
    // Counts a message; true if it may be sent.
    let may_send = |tally: &mut DrapeContactCounts| {
        let is_room = tally.sent < settings.max_messages;
        let count = if is_room { &mut tally.sent } else { &mut tally.held_back };
        *count += 1;
        is_room
    };
    for island in islands.live() {
        for contact in &island.solver().contacts {
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

/// Translates a contact of the solver into entities.
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
