//! The simulated state of a body, as components.

use std::sync::Arc;

use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::constants::TELEPORT_SPEED;
use drape_solver::{BodyContext, Topology};

use crate::attach::animated_pose::{AnimatedPose, placement, teleport};
use crate::attach::attachment_state::AttachmentState;
use crate::body::activity::Activity;
use crate::change_detection::collect_changed;
use crate::clock::DrapeClock;
use crate::refusal::Refusals;

/// Where a body's particles are and how they move: the solver's columns, in world coordinates.
///
/// Read it for positions and velocities; write to it (forces, impulses, pins) at any time outside the substeps.
#[derive(Component, Reflect, Clone, Debug, Default, Deref, DerefMut)]
#[reflect(opaque)]
#[reflect(Component, Default, Debug, Clone)]
#[require(Activity, BodyState)]
pub struct Particles(pub drape_solver::Particles);

/// How a body's particles are joined. Shared: equal bodies may hold the same one.
#[derive(Component, Reflect, Clone, Debug, Default, Deref)]
#[reflect(opaque)]
#[reflect(Component, Default, Debug, Clone)]
pub struct Sticks(pub Arc<Topology>);

/// What the plugin keeps about a body between steps.
#[derive(Component, Default)]
pub(crate) struct BodyState {
    /// Order of creation: what bodies are sorted by, so that entity ids do not matter to the result.
    pub order: u64,
    /// The solver's scratch for the body.
    pub context: BodyContext,
    /// The transform that pins are attached to, as it was when they were last brought there.
    pub anchor: Affine3A,
    /// What took the entity's own coordinates to where its particles rest, when the body was built.
    pub rest: Affine3A,
    /// Places of the pinned particles in the entity's own coordinates.
    pub pins: Vec<(u32, Vec3)>,
    /// Where the particles are and how fast, as of the last step or edit.
    pub extent: Extent,
    /// Whether the body cannot be simulated; see the log for why.
    pub refused: bool,
    /// Settings of the last step; a change wakes the body.
    pub settings: drape_solver::SolverSettings,
    /// Layers of the last step, likewise.
    pub layers: drape_solver::Layers,
}

/// Where the particles of a body are, and how fast.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Extent {
    /// Least and greatest corner of their box, and of what they carry.
    pub bounds: (Vec3, Vec3),
    /// Greatest speed of one of them in m/s.
    pub greatest_speed: f32,
}

impl Extent {
    pub fn of(particles: &drape_solver::Particles, topology: &Topology) -> Self {
        let (low, high) = particles.bounds();
        let overhang = topology.overhang();
        Self { bounds: (low - overhang, high + overhang), greatest_speed: particles.greatest_speed() }
    }
}

/// Hands out creation numbers.
#[derive(Resource, Default)]
pub(crate) struct CreationOrder(u64);

impl CreationOrder {
    pub fn next(&mut self) -> u64 {
        self.0 += 1;
        self.0
    }

    /// The number that was handed out last.
    pub fn last(&self) -> u64 {
        self.0
    }

    /// Hands out the numbers after `last` from now on.
    pub fn go_on_from(&mut self, last: u64) {
        self.0 = last;
    }
}

/// Pins are fixed to their entity: where it goes, they go, and pull the cloth along. A jump faster than anything moves is a
/// teleport: it takes the whole body along, and so does every move of a culled body.
pub(crate) fn move_pins(
    anchors: Query<(Entity, Ref<GlobalTransform>), With<BodyState>>,
    mut bodies: Query<
        (&GlobalTransform, &Activity, &mut Particles, &mut BodyState, Option<&mut AttachmentState>),
        Without<AnimatedPose>,
    >,
    clock: Res<DrapeClock>,
    mut refusals: ResMut<Refusals>,
    mut moved: Local<Vec<Entity>>,
) {
    let longest_pull = TELEPORT_SPEED * clock.delta();
    collect_changed(&anchors, &mut moved);
    for entity in moved.drain(..) {
        let Ok((transform, activity, mut particles, mut state, mut tied)) = bodies.get_mut(entity) else {
            continue;
        };
        let anchor = transform.affine();
        if anchor == state.anchor || state.pins.is_empty() {
            continue;
        }
        if !anchor.is_finite() {
            refusals.entity(entity, "the new Transform", "it must be finite; the pins stay where they were");
            continue;
        }
        let is_own = |tied: Option<&AttachmentState>, pin: u32| tied.is_none_or(|tied| !tied.holds(pin));
        let is_pull = |&(_, local): &(u32, Vec3)| {
            let [from, to] = [state.anchor, anchor].map(|anchor| anchor.transform_point3(local));
            from.distance(to) <= longest_pull
        };
        let mut own = state.pins.iter().filter(|&&(pin, _)| is_own(tied.as_deref(), pin)).peekable();
        let has_own = own.peek().is_some();
        let is_jump = has_own && (activity.is_carried() || !own.all(is_pull));
        if is_jump && let (Some(from), Some(to)) = (placement(&state.anchor), placement(&anchor)) {
            teleport(&mut particles, &mut state, tied.as_deref_mut(), None, (&from, &to));
        }
        for &(pin, local) in &state.pins {
            let i = pin as usize;
            if i < particles.len() && is_own(tied.as_deref(), pin) {
                particles.set_pin_target(i, anchor.transform_point3(local));
            }
        }
        state.anchor = anchor;
    }
}
