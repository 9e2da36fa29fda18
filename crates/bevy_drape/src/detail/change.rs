//! Chooses the level of detail of each body, and makes cloths coarser and finer.
//!
//! A cloth of another coarseness is rebuilt from its description. Each new particle takes position and velocity from
//! its place on the old cloth, so that no jump is seen.

use core::ops::Range;

use bevy::ecs::change_detection::ContiguousRef;
use bevy::ecs::query::QueryData;
use bevy::prelude::*;
use drape_solver::state::measure;
use drape_solver::world::extent::Extent;
use drape_solver::{BodyContext, BuildError};

use crate::attach::attachment::Attachment;
use crate::attach::follow_particle::ParticleFollowers;
use crate::attach::grab::Grab;
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::fabric::Fabric;
use crate::body::particles::{BodyParts, Particles, Sticks};
use crate::body::tearable::Tearable;
use crate::build::cloth::Cloth;
use crate::build::description::pins_at;
use crate::change_detection::{collect_changed, collect_rows, is_any_changed};
use crate::detail::level::{CurrentDetail, DetailLevel, LevelOfDetail};
use crate::detail::resampling::resample;
use crate::refusal::Refusals;
use crate::viewer::View;

/// The most cloths that change their particles in one step, the nearest first. A viewer that jumps to another place
/// must not stall the game.
const CHANGES_IN_A_STEP: usize = 8;

/// Bodies that lost their [`LevelOfDetail`] and go back to full detail.
#[derive(Resource, Default)]
pub(crate) struct LostDetail(Vec<Entity>);

/// Components of a body that its level changes or depends on.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Detailed {
    detail: Option<&'static LevelOfDetail>,
    current: &'static mut CurrentDetail,
    activity: &'static mut Activity,
    particles: &'static mut Particles,
    sticks: &'static mut Sticks,
    state: &'static mut BodyState,
    transform: &'static GlobalTransform,
    cloth: Option<&'static Cloth>,
    fabric: Option<&'static Fabric>,
    grab: Option<&'static Grab>,
    is_attached: Has<Attachment>,
    is_tearable: Has<Tearable>,
}

/// A cloth that will get other particles.
#[derive(Clone, Copy)]
pub(crate) struct Change {
    distance: f32,
    order: u64,
    entity: Entity,
    coarseness: u32,
}

/// Gives each body the level that its distance asks for.
pub(crate) fn choose_detail(
    mut view: View,
    mut bodies: ParamSet<(Query<(Entity, &Activity, Ref<Particles>), With<CurrentDetail>>, Query<Detailed>)>,
    levels: Query<(Entity, Ref<LevelOfDetail>)>,
    followed: Query<(), With<ParticleFollowers>>,
    mut lost: ResMut<LostDetail>,
    mut refusals: ResMut<Refusals>,
    mut to_look_at: Local<Vec<Entity>>,
    mut changes: Local<Vec<Change>>,
    mut is_behind: Local<bool>,
) {
    collect_changed(&levels, &mut to_look_at);
    to_look_at.append(&mut lost.0);
    for entity in &to_look_at {
        refusals.forget_component(*entity, "LevelOfDetail");
    }
    let is_all = view.is_new() || *is_behind;
    for (entities, activities, particles) in bodies.p0().contiguous_iter().into_iter().flatten() {
        // A frozen body may be carried near a viewer.
        let (_, ticks) = ContiguousRef::split(particles);
        let is_any = |rows: Range<usize>| {
            is_all || Activity::is_any_active(&activities[rows.clone()]) || is_any_changed(&ticks, rows)
        };
        collect_rows(entities, is_any, &mut to_look_at);
    }
    let mut bodies = bodies.p1();
    for entity in to_look_at.drain(..) {
        let Ok(body) = bodies.get_mut(entity) else { continue };
        let detail = body.detail.filter(|detail| is_valid(detail, entity, &mut refusals));
        changes.extend(choose_level(entity, body, detail, &view));
    }
    changes.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.order.cmp(&b.order)));
    changes.dedup_by_key(|change| change.entity);
    let mut left = CHANGES_IN_A_STEP;
    *is_behind = false;
    for change in changes.drain(..) {
        let Ok(mut body) = bodies.get_mut(change.entity) else { continue };
        if !may_change(&body) || followed.contains(change.entity) {
            continue;
        }
        if left == 0 {
            *is_behind = true;
            break;
        }
        left -= 1;
        if let Err(error) = change_particles(&mut body, change.coarseness) {
            refusals.entity(change.entity, "LevelOfDetail", error);
        }
    }
}

/// True if a level of detail can be used. Else it is noted why not.
pub(crate) fn is_valid(detail: &LevelOfDetail, entity: Entity, refusals: &mut Refusals) -> bool {
    let fault = detail.validate().err();
    if let Some(error) = fault {
        refusals.entity(entity, "LevelOfDetail", error);
    }
    fault.is_none()
}

/// Freezes a body, or sets it going again.
pub(crate) fn freeze(activity: &mut Mut<Activity>, frozen: bool) {
    match **activity {
        Activity::Active if frozen => **activity = Activity::Frozen,
        Activity::Frozen if !frozen => **activity = Activity::Active,
        _ => {}
    }
}

/// Sets level, substeps and activity. Returns a change if the body needs other particles.
fn choose_level(
    entity: Entity,
    mut body: DetailedItem,
    detail: Option<&LevelOfDetail>,
    view: &View,
) -> Option<Change> {
    if *body.activity == Activity::Culled {
        return None;
    }
    let distance = view.distance(body.state.extent.bounds);
    let (level, spent) = LevelOfDetail::spent_at(detail, distance, body.current.level);
    let DetailLevel { most_substeps, coarseness, frozen, .. } = spent;
    let is_full =
        |cloth: &Cloth| body.particles.len() as u64 == cloth.particles.as_u64vec2().element_product();
    let mut known = *body.current;
    if body.cloth.is_some_and(is_full) {
        // Rebuilt in full after a change of its description.
        known.coarseness = 1;
    }
    if *body.activity == Activity::Resting && coarseness >= known.coarseness {
        return None;
    }
    body.current.set_if_neq(CurrentDetail { level, most_substeps, ..known });
    freeze(&mut body.activity, frozen);
    let is_other = coarseness != known.coarseness;
    is_other.then_some(Change { distance, order: body.state.order, entity, coarseness })
}

/// True if nothing refers to particles by index, and the cloth is whole and pinned as described.
fn may_change(body: &DetailedItem) -> bool {
    let DetailedItem { particles, sticks, state, current, grab, .. } = body;
    let Some(cloth) = body.cloth else { return false };
    let [columns, rows] = cloth.particles_at(current.coarseness).to_array().map(u64::from);
    // A torn cloth has other numbers of particles or faces, a cut one parts of faces.
    let is_whole = sticks.face_parts().is_empty()
        && particles.len() as u64 == columns * rows
        && sticks.faces().len() as u64 == 2 * columns.saturating_sub(1) * rows.saturating_sub(1);
    let is_held = grab.is_some_and(|grab| !grab.hands.is_empty()) || body.is_attached || body.is_tearable;
    let pinned = (0..particles.len()).filter(|&i| particles.is_pinned(i));
    let is_pinned_as_built = || pinned.eq(state.pins.iter().map(|&(pin, _)| pin as usize));
    is_whole && !is_held && is_pinned_as_built() && !particles.follows_pose()
}

/// Rebuilds the cloth with other particles, in place and in motion.
fn change_particles(body: &mut DetailedItem, coarseness: u32) -> Result<(), BuildError> {
    let Some(cloth) = body.cloth else { return Ok(()) };
    let [from, to] =
        [body.current.coarseness, coarseness].map(|coarseness| cloth.particles_at(coarseness).to_array());
    let fabric = body.fabric.copied().unwrap_or_default();
    let (mut particles, topology) = cloth.build_coarsened(coarseness, &fabric, body.transform)?;
    body.state.pins = pins_at(&body.transform.affine(), &particles);
    move_over(&body.particles, from, &mut particles, to);
    body.state.extent = Extent::of(&particles, &topology);
    body.state.rest = body.transform.affine();
    body.state.context = BodyContext::default();
    body.state.scratch = default();
    body.particles.0 = particles;
    body.sticks.0 = topology;
    body.current.coarseness = coarseness;
    Ok(())
}

/// Resamples positions and velocities of one grid onto another. A free cloth keeps its momentum.
fn move_over(old: &drape_solver::Particles, from: [u32; 2], new: &mut drape_solver::Particles, to: [u32; 2]) {
    let positions: Vec<Vec3> = old.positions().collect();
    let velocities: Vec<Vec3> = old.velocities().collect();
    let positions = resample(&positions, from, to);
    let velocities = resample(&velocities, from, to);
    for (i, (position, velocity)) in positions.into_iter().zip(velocities).enumerate() {
        new.set_position(i, position);
        if !new.is_pinned(i) {
            new.set_velocity(i, velocity);
        }
    }
    if (0..new.len()).all(|i| !new.is_pinned(i)) {
        let lost = (measure::momentum(old) - measure::momentum(new)) / measure::mass(new);
        (0..new.len()).for_each(|i| new.set_velocity(i, new.velocity(i) + lost.as_vec3()));
    }
}

/// Returns the body to full detail in the next step.
pub(crate) fn note_lost_detail(lost: On<Remove<LevelOfDetail>>, mut bodies: ResMut<LostDetail>) {
    bodies.0.push(lost.entity);
}

/// Builds the particles and sticks of an entity's cloth at `coarseness`; none without a cloth.
pub(crate) fn parts_at(entity: EntityRef, coarseness: u32) -> Option<BodyParts> {
    let (cloth, transform) = (entity.get::<Cloth>()?, entity.get::<GlobalTransform>()?);
    let fabric = entity.get::<Fabric>().copied().unwrap_or_default();
    cloth.build_coarsened(coarseness, &fabric, transform).ok()
}
