//! Bodies that tears and cuts have changed.

use std::sync::Arc;

use bevy::prelude::*;
use drape_solver::{BuildError, ParticlesSnapshot, Topology, TornTopology};

use crate::attach::animated_pose::{AnimatedPose, WholePose};
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::particles::{Particles, Sticks};
use crate::body::tearable::{RestoredMesh, TornMesh};
use crate::body::torn_from::{TornFrom, WholeBody};
use crate::snapshot::key::{Key, Keys};
use crate::tear::part::{leave_out_body, state_of_piece};

/// The past and present of a torn body, or of a piece of one.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "PlainTear", into = "PlainTear"))]
pub(super) enum TearSnapshot {
    /// Shared with the running world that it was taken of.
    Shared(TornFrom, Arc<Topology>),
    /// As read from a file.
    Plain(Box<PlainTear>),
}

/// The same as plain numbers.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct PlainTear {
    /// The order of creation of the whole body.
    whole: u64,
    /// For each particle, that of the whole body.
    origins: Vec<u32>,
    /// The edges along which the whole body has torn.
    torn_edges: Vec<[u32; 2]>,
    topology: TornTopology,
}

impl From<TearSnapshot> for PlainTear {
    fn from(tear: TearSnapshot) -> Self {
        match tear {
            TearSnapshot::Shared(TornFrom { whole, origins, torn_edges }, topology) => Self {
                whole: whole.order,
                origins: origins.to_vec(),
                torn_edges: torn_edges.to_vec(),
                topology: TornTopology::new(&topology, &whole.topology),
            },
            TearSnapshot::Plain(plain) => *plain,
        }
    }
}

impl From<PlainTear> for TearSnapshot {
    fn from(plain: PlainTear) -> Self {
        Self::Plain(plain.into())
    }
}

impl PartialEq for TearSnapshot {
    fn eq(&self, other: &Self) -> bool {
        PlainTear::from(self.clone()) == PlainTear::from(other.clone())
    }
}

impl TearSnapshot {
    pub fn take(state: &BodyState, sticks: &Sticks) -> Option<Self> {
        Some(Self::Shared(state.torn_from.clone()?, Arc::clone(&sticks.0)))
    }

    /// The order of creation of the whole body.
    pub fn whole(&self) -> u64 {
        match self {
            Self::Shared(TornFrom { whole, .. }, _) => whole.order,
            Self::Plain(plain) => plain.whole,
        }
    }

    /// The past and present of the body, if it comes of this whole body and has `particles`.
    ///
    /// # Errors
    /// [`BuildError`] if the snapshot contradicts itself, or the whole body is another.
    pub fn of(
        &self,
        whole: &Arc<WholeBody>,
        particles: &ParticlesSnapshot,
    ) -> Result<(TornFrom, Arc<Topology>), BuildError> {
        let whole = Arc::clone(whole);
        let (torn_from, topology) = match self {
            Self::Shared(torn_from, topology) => {
                (TornFrom { whole, ..torn_from.clone() }, Arc::clone(topology))
            }
            Self::Plain(plain) => {
                let PlainTear { origins, torn_edges, topology, .. } = &**plain;
                let topology = topology.build(&whole.topology)?.into();
                let (origins, torn_edges) = (origins.as_slice().into(), torn_edges.as_slice().into());
                (TornFrom { whole, origins, torn_edges }, topology)
            }
        };
        let TornFrom { whole, origins, torn_edges } = &torn_from;
        let count = whole.topology.particle_count();
        let mut named = origins.iter().chain(torn_edges.as_flattened());
        if let Some(&index) = named.find(|&&particle| particle as usize >= count) {
            return Err(BuildError::NoSuchParticle { what: "a torn body", index, count: count as u32 });
        }
        if origins.len() != topology.particle_count() {
            return Err(BuildError::BadTopology { reason: "it has other particles than its sticks join" });
        }
        particles.validate(topology.particle_count())?;
        Ok((torn_from, topology))
    }
}

/// The whole body of which a body or piece is left; none for an entity without a body.
pub(super) fn whole_of(entity: EntityRef) -> Option<Arc<WholeBody>> {
    let state = entity.get::<BodyState>()?;
    if let Some(torn_from) = &state.torn_from {
        return Some(Arc::clone(&torn_from.whole));
    }
    let topology = Arc::clone(&entity.get::<Sticks>()?.0);
    Some(Arc::new(WholeBody { order: state.order, topology }))
}

/// An entity that is left of a whole body, or that is whole: the oldest.
pub(super) fn left_of(whole: u64, world: &World, keys: &Keys) -> Option<Entity> {
    let is_left = |state: &BodyState| {
        state.torn_from.as_ref().map_or(state.order, |torn_from| torn_from.whole.order) == whole
    };
    let bodies = keys.iter().filter(|(key, _)| matches!(key, Key::Body(_)));
    bodies.map(|&(_, entity)| entity).find(|&entity| world.get::<BodyState>(entity).is_some_and(is_left))
}

/// Spawns a missing piece as a clone of another entity that is left of its whole body. It has no particles yet.
pub(super) fn spawn(order: u64, whole: &Arc<WholeBody>, other: Entity, world: &mut World) -> Option<Entity> {
    #[cfg(feature = "mesh")]
    crate::render::torn_mesh::keep_whole_mesh(world, other, &whole.topology);
    let torn_from = Some(TornFrom { whole: Arc::clone(whole), origins: [].into(), torn_edges: [].into() });
    let state = BodyState { order, torn_from, ..state_of_piece(world.get(other)?) };
    let piece = world.entity_mut(other).clone_and_spawn_with_opt_out(leave_out_body);
    let parts = (Particles::default(), Sticks::default(), Activity::default());
    world.entity_mut(piece).insert((parts, state));
    Some(piece)
}

/// Gives a body the sticks that it had, and particles for them. `torn_from` is none for a body that was whole.
///
/// # Errors
/// [`BuildError`] as [`Particles::from_snapshot`](drape_solver::Particles::from_snapshot).
pub(super) fn restore(
    torn_from: Option<&TornFrom>,
    topology: &Arc<Topology>,
    snapshot: &ParticlesSnapshot,
    entity: &mut EntityWorldMut,
) -> Result<Restored, BuildError> {
    let Some(mut state) = entity.get_mut::<BodyState>() else { return Ok(Restored::AsItIs) };
    let was_torn = state.torn_from.is_some();
    state.torn_from = torn_from.cloned();
    let Some(mut sticks) = entity.get_mut::<Sticks>() else { return Ok(Restored::AsItIs) };
    if Arc::ptr_eq(&sticks.0, topology) {
        return Ok(Restored::AsItIs);
    }
    // Not marked as changed, which would rouse a body at rest.
    sticks.bypass_change_detection().0 = Arc::clone(topology);
    if let Some(mut particles) = entity.get_mut::<Particles>() {
        particles.0 = drape_solver::Particles::from_snapshot(snapshot, topology)?;
    }
    if !was_torn && torn_from.is_none() {
        return Ok(Restored::WithOtherParticles);
    }
    restore_pose(was_torn, torn_from.map(|torn_from| &*torn_from.origins), entity);
    entity.remove::<TornMesh>().insert(RestoredMesh);
    Ok(Restored::FromTear)
}

/// The way in which a body was given its particles.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Restored {
    /// It has the particles that it had.
    AsItIs,
    /// At another level of detail.
    WithOtherParticles,
    /// It has become whole, or torn otherwise.
    FromTear,
}

/// Has an animation move the particles that it moved, which come from these of the whole body; from all if it is whole.
fn restore_pose(was_torn: bool, origins: Option<&[u32]>, entity: &mut EntityWorldMut) {
    let before_tear = entity.get::<WholePose>().filter(|_| was_torn).map(|whole| &whole.0);
    let Some(whole) = before_tear.or(entity.get::<AnimatedPose>()).cloned() else { return };
    match origins {
        Some(origins) => entity.insert((whole.torn(origins), WholePose(whole))),
        None => entity.insert(whole).remove::<WholePose>(),
    };
}
