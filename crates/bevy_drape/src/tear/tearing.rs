//! Cuts bodies that blades pass through, and tears bodies that are stretched too far.

use bevy::prelude::*;
use drape_solver::TearLimits;

use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::tearable::{Tearable, Untearable};
use crate::clock::DrapeClock;
use crate::pending_messages::Pending;
use crate::rig::components::Rig;
use crate::tear::messages::CutCloth;
use crate::tear::part::{Tearing, TornQuery};

/// Makes the requested cuts. If a piece comes off, the rest of them follows once the piece is a body, so that they cut
/// it too.
pub(crate) fn cut_bodies(
    mut cuts: ResMut<Pending<CutCloth>>,
    mut bodies: TornQuery,
    clock: Res<DrapeClock>,
    mut tearing: Tearing,
) {
    let mut made = 0;
    for cut in &cuts.waiting {
        made += 1;
        if !cut.blade.as_flattened().iter().all(|corner| corner.is_finite()) {
            tearing.refusals.resource("CutCloth", "a corner of its blade is not finite");
            continue;
        }
        let bounds = cut.bounds();
        let is_near = |entity: Entity, state: &BodyState| {
            cut.only.is_none_or(|only| only == entity) && !state.refused && bounds.overlaps(state.bounds())
        };
        // In order of creation, so that entity ids do not matter to the order of the pieces.
        let mut near: Vec<(u64, Entity)> =
            bodies.iter().filter(|body| is_near(body.0, body.3)).map(|body| (body.3.order, body.0)).collect();
        near.sort_unstable();
        for (_, entity) in near {
            tearing.part(entity, &mut bodies, clock.elapsed(), true, |body| body.cut(&cut.blade));
        }
        if !tearing.splits.is_empty() {
            break;
        }
    }
    cuts.waiting.drain(..made);
    tearing.trigger_splits();
    if !cuts.waiting.is_empty() {
        tearing.commands.run_system_cached(cut_bodies);
    }
}

/// Tears bodies that this step has stretched too far.
pub(crate) fn tear_bodies(
    mut bodies: TornQuery,
    // A query of its own, so that only tearable bodies are checked.
    tearable: Query<(Entity, Ref<Tearable>, &Activity), Without<Rig>>,
    clock: Res<DrapeClock>,
    whole: Query<(Entity, Ref<Tearable>, Ref<Untearable>)>,
    mut tearing: Tearing,
    mut awake: Local<Vec<(u64, Entity, TearLimits)>>,
) {
    awake.clear();
    for (entity, tearable, untearable) in &whole {
        if tearable.is_changed() || untearable.is_added() {
            tearing.refusals.entity(entity, "Tearable", "solids and bones do not tear");
        }
    }
    for (entity, tearable, activity) in &tearable {
        let Ok((_, _, _, state, _)) = bodies.get(entity) else { continue };
        let Tearable { strain, most_at_once, .. } = *tearable;
        if tearable.is_changed() {
            tearing.refusals.forget_component(entity, "Tearable");
        }
        if !(strain > 0.0 && strain.is_finite()) {
            tearing.refusals.entity(
                entity,
                "Tearable",
                format!("strain must be finite and above zero, but is {strain}"),
            );
        } else if *activity == Activity::Active && !state.refused {
            awake.push((state.order, entity, TearLimits { strain, most: most_at_once }));
        }
    }
    awake.sort_unstable_by_key(|&(order, ..)| order);
    let now = clock.elapsed() + f64::from(clock.delta());
    for (_, entity, limits) in awake.drain(..) {
        tearing.part(entity, &mut bodies, now, false, |body| body.tear(&limits));
    }
    tearing.trigger_splits();
}
