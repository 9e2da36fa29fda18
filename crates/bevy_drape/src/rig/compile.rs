//! Compiles hand-built rigs into bodies.
//!
//! After an edit all particles and sticks are grouped anew, and the bodies that the edit touched are rebuilt. Without
//! an edit a step only checks for changes.

use std::collections::BTreeMap;

use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::prelude::*;
use drape_solver::constants::MAX_MAGNITUDE;
use drape_solver::world::extent::Extent;

use crate::body::body_state::{BodyState, CreationOrder};
use crate::body::particles::{BodyParts, Particles, Sticks};
use crate::body::settings::SolverSettings;
use crate::body::surface::BodySurface;
use crate::build::built::BodyBuilt;
use crate::refusal::{Cause, Refusals};
use crate::rig::body::{CompiledRig, Link, RigMember, connected};
use crate::rig::components::{
    InRig, Particle, ParticleRecord, Rig, RigEdits, Stick, StickBound, StickRecord,
};

type ParticleQuery<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        Ref<'static, Particle>,
        &'static Transform,
        &'static GlobalTransform,
        &'static mut ParticleRecord,
        Option<&'static InRig>,
        Option<Ref<'static, SolverSettings>>,
        Option<Ref<'static, BodySurface>>,
    ),
>;
type StickQuery<'w, 's> = Query<'w, 's, (Entity, Ref<'static, Stick>, &'static mut StickRecord)>;
type RigQuery<'w, 's> = Query<
    'w,
    's,
    (Entity, &'static mut Rig, &'static mut Particles, &'static mut Sticks, &'static mut BodyState),
>;

/// Rebuilds the bodies of all rigs that were edited since the last step.
pub(crate) fn compile_rigs(
    mut commands: Commands,
    mut edits: ResMut<RigEdits>,
    mut particles: ParticleQuery,
    mut sticks: StickQuery,
    mut rigs: RigQuery,
    all: Query<(Entity, Has<Particle>)>,
    mut order: ResMut<CreationOrder>,
    mut refusals: ResMut<Refusals>,
) {
    if !is_edited(&edits, &particles, &sticks, &rigs) {
        return;
    }
    let removed: EntityHashSet = edits.removed.iter().copied().collect();
    for &entity in &edits.removed {
        refusals.forget(entity);
        if let Ok((_, false)) = all.get(entity)
            && let Ok(mut entity) = commands.get_entity(entity)
        {
            entity.try_remove::<InRig>();
        }
    }
    let members = collect_members(&mut commands, &mut edits, &removed, &mut particles, &rigs, &mut refusals);
    let links = collect_links(&mut edits, &members, &mut sticks, &all, &mut refusals);
    edits.removed.clear();
    edits.lost_rig = false;

    let mut claimed = EntityHashSet::default();
    for group in connected(&members, &links) {
        // The piece of a split body with the oldest particle keeps the entity, and so does the oldest of joined bodies.
        let mut homes = group.members.iter().filter_map(|&i| members[i].body);
        let body = homes.find(|body| !claimed.contains(body));
        let compiled = CompiledRig::new(&group, &members, &links);
        let is_same = body
            .and_then(|body| rigs.get(body).ok())
            .is_some_and(|(body, rig, ..)| !compiled.is_changed && compiled.is_of(body, rig));
        if is_same {
            claimed.extend(body);
            continue;
        }
        let (columns, topology) = match compiled.build() {
            Ok(parts) => parts,
            Err(error) => {
                refusals.entity(compiled.rig.particles[0], "the rig", error);
                continue;
            }
        };
        claimed.extend(body);
        let body = update_body(&mut commands, &mut rigs, &mut order, body, compiled, (columns, topology));
        for (index, &i) in group.members.iter().enumerate() {
            let in_rig = InRig { body, index };
            if members[i].in_rig != Some(in_rig) {
                commands.entity(members[i].entity).try_insert(in_rig);
            }
        }
    }
    for (body, mut rig, ..) in &mut rigs {
        if !claimed.contains(&body) {
            rig.particles.clear();
            commands.entity(body).try_despawn();
        }
    }
}

/// Puts a compiled rig on the entity of its body, or on a new one.
fn update_body(
    commands: &mut Commands,
    rigs: &mut RigQuery,
    order: &mut CreationOrder,
    body: Option<Entity>,
    compiled: CompiledRig,
    (columns, topology): BodyParts,
) -> Entity {
    let (settings, surface) = (compiled.settings, compiled.surface);
    let body = match body.and_then(|body| rigs.get_mut(body).ok()) {
        Some((body, mut rig, mut particles, mut sticks, mut state)) => {
            if rig.particles == compiled.rig.particles && compiled.is_all_from(body) {
                // The columns stay, with everything that users wrote into them since the last step.
                for (i, &inverse_mass) in compiled.inverse_masses.iter().enumerate() {
                    particles.set_inverse_mass(i, inverse_mass);
                }
            } else {
                particles.0 = columns;
            }
            state.extent = Extent::of(&particles, &topology);
            state.context = default();
            state.scratch = default();
            sticks.0 = topology;
            *rig = compiled.rig;
            body
        }
        None => {
            let extent = Extent::of(&columns, &topology);
            let state = BodyState { order: order.next(), extent, ..default() };
            let name = Name::new("Rig");
            commands.spawn((name, compiled.rig, Particles(columns), Sticks(topology), state)).id()
        }
    };
    commands.write_message(BodyBuilt { body });
    put(commands, body, settings);
    put(commands, body, surface);
    body
}

/// Gives an entity this component, or takes it away.
fn put<C: Component>(commands: &mut Commands, entity: Entity, component: Option<C>) {
    match component {
        Some(component) => commands.entity(entity).try_insert(component),
        None => commands.entity(entity).try_remove::<C>(),
    };
}

fn is_edited(edits: &RigEdits, particles: &ParticleQuery, sticks: &StickQuery, rigs: &RigQuery) -> bool {
    let has_settings = |particle| particles.get(particle).is_ok_and(|(.., settings, _)| settings.is_some());
    let has_surface = |particle| particles.get(particle).is_ok_and(|(.., surface)| surface.is_some());
    edits.lost_rig
        || !edits.removed.is_empty()
        || edits.misplaced.iter().any(|&entity| {
            particles.get(entity).is_ok_and(|(_, _, _, global, ..)| is_placed(global.translation()))
        })
        || sticks.iter().any(|(_, stick, _)| stick.is_changed())
        || particles.iter().any(|(_, particle, .., settings, surface)| {
            particle.is_changed()
                || settings.is_some_and(|settings| settings.is_changed())
                || surface.is_some_and(|surface| surface.is_changed())
        })
        || rigs.iter().any(|(_, rig, ..)| {
            rig.settings_from.is_some_and(|from| !has_settings(from))
                || rig.surface_from.is_some_and(|from| !has_surface(from))
        })
}

fn is_placed(place: Vec3) -> bool {
    // False for NaN.
    place.abs().cmple(Vec3::splat(MAX_MAGNITUDE)).all()
}

/// All particles that can be simulated, in the order of their insertion.
fn collect_members(
    commands: &mut Commands,
    edits: &mut RigEdits,
    removed: &EntityHashSet,
    particles: &mut ParticleQuery,
    rigs: &RigQuery,
    refusals: &mut Refusals,
) -> Vec<RigMember> {
    edits.misplaced.clear();
    let mut members = Vec::new();
    for (entity, particle, transform, global, mut record, in_rig, settings, surface) in particles {
        if record.order == 0 {
            record.order = edits.next_order();
        }
        let state = in_rig.filter(|_| !removed.contains(&entity)).and_then(|in_rig| {
            let (body, rig, columns, ..) = rigs.get(in_rig.body).ok()?;
            let is_there = rig.particles.get(in_rig.index) == Some(&entity) && in_rig.index < columns.len();
            let state = is_there.then(|| (columns.position(in_rig.index), columns.velocity(in_rig.index)));
            let (position, velocity) = state?;
            (is_placed(position) && velocity.is_finite()).then_some((body, position, velocity))
        });
        let fault: Option<Cause> = match particle.validate() {
            Err(error) => Some(error.into()),
            Ok(()) if state.is_none() && !is_placed(global.translation()) => {
                edits.misplaced.push(entity);
                let place = global.translation();
                Some(
                    format!("the translation of its Transform must be finite and below 1e6, but is {place}")
                        .into(),
                )
            }
            Ok(()) => None,
        };
        if record.refused && (particle.is_changed() || fault.is_none()) {
            refusals.forget(entity);
        }
        record.refused = fault.is_some();
        if let Some(fault) = fault {
            refusals.entity(entity, "Particle", fault);
            if in_rig.is_some() {
                commands.entity(entity).try_remove::<InRig>();
            }
            continue;
        }
        let (body, position, velocity) = match state {
            Some((body, position, velocity)) => (Some(body), position, velocity),
            None => {
                record.written = transform.translation;
                record.placed = global.translation();
                (None, global.translation(), particle.velocity)
            }
        };
        members.push(RigMember {
            entity,
            order: record.order,
            position,
            velocity,
            inverse_mass: particle.inverse_mass(),
            body,
            in_rig: in_rig.copied(),
            is_changed: particle.is_changed()
                || settings.as_ref().is_some_and(Ref::is_changed)
                || surface.as_ref().is_some_and(Ref::is_changed),
            settings: settings.map(|settings| *settings),
            surface: surface.map(|surface| *surface),
        });
    }
    members.sort_by_key(|member| member.order);
    members
}

/// All sticks that can be simulated, in the order of their insertion.
fn collect_links(
    edits: &mut RigEdits,
    members: &[RigMember],
    sticks: &mut StickQuery,
    all: &Query<(Entity, Has<Particle>)>,
    refusals: &mut Refusals,
) -> Vec<Link> {
    for (.., mut record) in &mut *sticks {
        if record.order == 0 {
            record.order = edits.next_order();
        }
    }
    let mut by_age: Vec<(u64, Entity)> =
        sticks.iter().map(|(entity, _, record)| (record.order, entity)).collect();
    by_age.sort_unstable();
    let index_of: EntityHashMap<usize> =
        members.iter().enumerate().map(|(i, member)| (member.entity, i)).collect();
    let mut joined: BTreeMap<([usize; 2], StickBound), Entity> = BTreeMap::new();
    let mut links = Vec::new();
    for (_, entity) in by_age {
        let Ok((_, stick, mut record)) = sticks.get_mut(entity) else { continue };
        let link = check_ends(&stick, &index_of, all).map_err(Cause::from).and_then(|ends| {
            stick.validate()?;
            let rest_length =
                rest_length(&stick, stick.is_changed(), &mut record, ends.map(|i| members[i].position))?;
            // A least and a greatest length may join the same ends.
            let pair = ([ends[0].min(ends[1]), ends[0].max(ends[1])], stick.bound);
            if let Some(other) = joined.get(&pair) {
                return Err(format!(
                    "its ends `a` and `b` are joined by the stick of entity {other} already"
                )
                .into());
            }
            joined.insert(pair, entity);
            Ok(Link { entity, ends, rest_length, material: stick.material(), is_changed: stick.is_changed() })
        });
        if record.refused && (stick.is_changed() || link.is_ok()) {
            refusals.forget(entity);
        }
        record.refused = link.is_err();
        match link {
            Ok(link) => links.push(link),
            Err(fault) => refusals.entity(entity, "Stick", fault),
        }
    }
    links
}

/// Returns the indices of the members that `stick` joins.
fn check_ends(
    stick: &Stick,
    index_of: &EntityHashMap<usize>,
    all: &Query<(Entity, Has<Particle>)>,
) -> Result<[usize; 2], String> {
    if stick.a == stick.b && stick.a != Entity::PLACEHOLDER {
        return Err(format!("its ends `a` and `b` are the same entity {}", stick.a));
    }
    let index = |field, end: Entity| {
        index_of.get(&end).copied().ok_or_else(|| match all.get(end) {
            Err(_) => format!("its end `{field}`, entity {end}, does not exist"),
            Ok((_, false)) => format!("its end `{field}`, entity {end}, has no Particle"),
            Ok((_, true)) => format!("its end `{field}`, entity {end}, is left out itself"),
        })
    };
    Ok([index("a", stick.a)?, index("b", stick.b)?])
}

/// Returns the given rest length of a stick, or the distance of its ends when it was first compiled.
fn rest_length(
    stick: &Stick,
    is_changed: bool,
    record: &mut StickRecord,
    [a, b]: [Vec3; 2],
) -> Result<f32, String> {
    if let Some(length) = stick.rest_length {
        return Ok(length);
    }
    let ends = [stick.a, stick.b];
    let length = match record.measured {
        Some((measured, length)) if measured == ends && (length > 0.0 || !is_changed) => length,
        _ => a.distance(b),
    };
    record.measured = Some((ends, length));
    if length > 0.0 {
        Ok(length)
    } else {
        Err("its ends coincide, so that its `rest_length` would be zero".into())
    }
}
