//! Registers the messages about contacts.

use bevy::prelude::*;

use crate::contact::contact_pairs::ContactPairs;
use crate::contact::events::{
    ContactFeature, DrapeContact, DrapeContactCounts, DrapeContactEnded, DrapeContactHit,
    DrapeContactSettings, DrapeContactStarted,
};
use crate::contact::hit::{BallHit, Touching};
use crate::contact::reactions::give_reactions;
use crate::contact::report_hits::report_hits;
use crate::contact::send_contacts::send_contacts;
use crate::entity_events::trigger_written;
use crate::schedule::{DrapeSchedule, FinishPhase};

/// Hits of balls.
pub(crate) struct HitPlugin;

impl Plugin for HitPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<BallHit>()
            .init_resource::<Touching>()
            .add_message::<BallHit>()
            .add_systems(DrapeSchedule, report_hits.in_set(FinishPhase::ReportHits))
            .add_systems(DrapeSchedule, trigger_written::<BallHit>.in_set(FinishPhase::TriggerObservers));
    }
}

/// Beginnings and ends of contacts, and hard hits.
pub(crate) struct ContactEventsPlugin;

impl Plugin for ContactEventsPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(ContactFeature, DrapeContact, DrapeContactSettings, DrapeContactCounts)>()
            .register_type::<(DrapeContactStarted, DrapeContactHit, DrapeContactEnded)>()
            .init_resource::<ContactPairs>()
            .init_resource::<DrapeContactCounts>()
            .init_resource::<DrapeContactSettings>()
            .add_message::<DrapeContactEnded>()
            .add_message::<DrapeContactHit>()
            .add_message::<DrapeContactStarted>()
            .add_systems(
                DrapeSchedule,
                (
                    send_contacts.in_set(FinishPhase::SendContacts),
                    (
                        trigger_written::<DrapeContactStarted>,
                        trigger_written::<DrapeContactHit>,
                        trigger_written::<DrapeContactEnded>,
                    )
                        .chain()
                        .in_set(FinishPhase::TriggerObservers),
                ),
            );
    }
}

/// Reactions of obstacles to what they did in a step.
pub(crate) struct ReactionPlugin;

impl Plugin for ReactionPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(DrapeSchedule, give_reactions.in_set(FinishPhase::GiveReactions));
    }
}
