//! Turns joints so that their bones lie as they have been solved.
//!
//! ```text
//!   First, step    joints get their animated rotations back
//!   steps          see the animated pose, by which pins, drives and limits go
//!   PostUpdate     animations write a new pose; then each joint, from the root on, is turned
//!                  by the least turn that lays its bone along the line between two particles
//! ```

use bevy::math::Affine3A;
use bevy::prelude::*;

use crate::body::particles::Particles;
use crate::bones::chain::BoneChain;
use crate::rigid_motion::ahead;
use crate::transform::interpolation::{ShowsBetweenSteps, step_fraction};

/// Chains of joints, as they are shown.
#[derive(Component, Clone, Debug)]
pub(crate) struct ShownBones {
    pub chains: Vec<BoneChain>,
    /// The number of entities that the first joint hangs on: chains on joints of others are shown after these.
    pub depth: usize,
    /// For each bone, the way from its joint to its end after the last two steps.
    ways: [Vec<Vec3>; 2],
    /// The place of what the first chain hangs on, in the last two steps.
    bases: [Affine3A; 2],
    /// True if the bones have been recorded since the last run of the schedule.
    is_fresh: bool,
    turned: Vec<TurnedJoint>,
}

/// A joint that shows something else than its animated pose.
#[derive(Clone, Copy, Debug)]
struct TurnedJoint {
    joint: Entity,
    animated: Quat,
    shown: Quat,
}

impl ShownBones {
    /// Chains that show their animated pose so far.
    pub fn new(chains: Vec<BoneChain>, parents: &Query<&ChildOf>) -> Self {
        let root = chains.iter().find_map(|chain| chain.joints.first());
        Self {
            depth: root.map_or(0, |&root| parents.iter_ancestors(root).count()),
            chains,
            ways: default(),
            bases: default(),
            is_fresh: false,
            turned: Vec::new(),
        }
    }

    /// All joints that it turns.
    pub fn joints(&self) -> impl Iterator<Item = Entity> {
        self.chains.iter().flat_map(|chain| &chain.joints).copied()
    }

    /// Notes where the bones point after a step, all of one chain, then those of the next, and the place of what the first chain hangs on.
    pub fn record(&mut self, base: Affine3A, bones: impl Iterator<Item = Vec3>) {
        let [before, now] = &mut self.ways;
        core::mem::swap(before, now);
        now.clear();
        now.extend(bones);
        if before.len() != now.len() {
            before.clone_from(now);
            self.bases = [base; 2];
        }
        self.bases = [self.bases[1], base];
        self.is_fresh = true;
    }

    /// Notes where the bones of a body point after a step. Others may have put other particles in their place.
    fn record_body(&mut self, base: Affine3A, particles: &drape_solver::Particles) {
        let chains = core::mem::take(&mut self.chains);
        let count: usize = chains.iter().map(|chain| chain.joints.len() + 1).sum();
        if count == particles.len() {
            let joints = chains.iter().flat_map(|chain| chain.first..chain.first + chain.joints.len());
            self.record(base, joints.map(|i| particles.local_position(i + 1) - particles.local_position(i)));
        }
        self.chains = chains;
    }

    /// Ends a run of the schedule. What was not recorded since the last one has come to rest, or the clock stands.
    fn finish(&mut self) {
        let [before, now] = &mut self.ways;
        if !core::mem::take(&mut self.is_fresh) {
            before.clone_from(now);
            self.bases[0] = self.bases[1];
        }
    }

    /// Gives joints that nobody else has turned since their animated rotations back.
    fn restore(&mut self, joints: &mut Query<&mut Transform>) {
        for TurnedJoint { joint, animated, shown } in self.turned.drain(..) {
            if let Ok(mut transform) = joints.get_mut(joint)
                && transform.rotation == shown
            {
                transform.rotation = animated;
            }
        }
    }
}

/// Records all bones after a step, and settles those that were not solved.
pub(crate) fn record_bones(
    mut all: Query<(&mut ShownBones, Option<Ref<Particles>>)>,
    parents: Query<&ChildOf>,
    places: Query<&GlobalTransform>,
) {
    for (mut shown, particles) in &mut all {
        if let Some(particles) = particles.filter(DetectChanges::is_changed) {
            let base = base_of(&shown, &parents).and_then(|base| places.get(base).ok());
            shown.record_body(base.map_or(Affine3A::IDENTITY, GlobalTransform::affine), &particles);
        }
        shown.finish();
    }
}

/// Gives joints their animated rotations back, for the frame or the step to come.
pub(crate) fn restore_bones(mut bodies: Query<&mut ShownBones>, mut joints: Query<&mut Transform>) {
    bodies.iter_mut().for_each(|mut shown| shown.restore(&mut joints));
}

/// Gives joints their animated rotations back when their cloth or spring is gone.
pub(crate) fn restore_lost_bones(
    lost: On<Remove<ShownBones>>,
    mut bodies: Query<&mut ShownBones>,
    mut joints: Query<&mut Transform>,
) {
    if let Ok(mut shown) = bodies.get_mut(lost.entity) {
        shown.restore(&mut joints);
    }
}

/// Turns joints, after animations and before transforms are propagated.
pub(crate) fn show_bones(
    mut bodies: Query<(Entity, &mut ShownBones)>,
    mut joints: Query<&mut Transform>,
    parents: Query<&ChildOf>,
    between: Res<ShowsBetweenSteps>,
    time: Option<Res<Time<Fixed>>>,
    mut order: Local<Vec<(usize, Entity)>>,
) {
    let fraction = if between.0 { step_fraction(time.as_deref()) } else { 1.0 };
    order.clear();
    order.extend(bodies.iter().map(|(entity, shown)| (shown.depth, entity)));
    order.sort_unstable();
    for (_, entity) in order.drain(..) {
        let Ok((_, mut shown)) = bodies.get_mut(entity) else { continue };
        show(&mut shown, &mut joints, &parents, fraction);
    }
}

fn show(
    shown: &mut ShownBones,
    joints: &mut Query<&mut Transform>,
    parents: &Query<&ChildOf>,
    fraction: f32,
) {
    let place = |joints: &Query<&mut Transform>, entity: Entity| {
        place_below(entity, None, |at| joints.get(at).ok().copied(), parents)
    };
    // Steps see an older pose than the one that the rest of the character is drawn in.
    let now = base_of(shown, parents).map_or(Affine3A::IDENTITY, |base| place(joints, base));
    let ahead = ahead(shown.bases, fraction, now).unwrap_or(Affine3A::IDENTITY);
    let ShownBones { chains, ways: [before, now], turned, .. } = shown;
    let mut ways = before.iter().zip(&*now).map(|(before, now)| before.lerp(*now, fraction));
    for chain in &*chains {
        let base = chain.joints.first().and_then(|&root| parents.get(root).ok());
        let mut parent = base.map_or(Affine3A::IDENTITY, |base| place(joints, base.parent()));
        for (index, &joint) in chain.joints.iter().enumerate() {
            let Some(way) = ways.next() else { break };
            let (between, end) = match chain.joints.get(index + 1) {
                Some(&next) => link(joint, next, |at| joints.get(at).ok().copied(), parents),
                None => (Affine3A::IDENTITY, chain.tip),
            };
            let Ok(mut transform) = joints.get_mut(joint) else { continue };
            let animated = transform.rotation;
            if let Some(shown) = aimed(&parent, &transform, end, ahead.transform_vector3(way)) {
                transform.rotation = shown;
                turned.push(TurnedJoint { joint, animated, shown });
            }
            parent *= transform.compute_affine() * between;
        }
    }
}

/// The entity that the first chain hangs on.
fn base_of(shown: &ShownBones, parents: &Query<&ChildOf>) -> Option<Entity> {
    shown.joints().next().and_then(|root| parents.get(root).ok()).map(ChildOf::parent)
}

/// The rotation of a joint of this transform, on `parent`, whose bone ends at `end` in its coordinates, that lays the bone along `way` in
/// the world by the least turn. None if one of them has no length.
pub(crate) fn aimed(parent: &Affine3A, transform: &Transform, end: Vec3, way: Vec3) -> Option<Quat> {
    let bone = (transform.rotation * (transform.scale * end)).try_normalize()?;
    let wanted = parent.inverse().transform_vector3(way).try_normalize()?;
    Some((Quat::from_rotation_arc(bone, wanted) * transform.rotation).normalize())
}

/// The place of an entity in the coordinates of one `below` which it hangs, or in the world, by the transforms of now: global ones are
/// those of the last step or frame.
pub(crate) fn place_below(
    entity: Entity,
    below: Option<Entity>,
    transform: impl Fn(Entity) -> Option<Transform>,
    parents: &Query<&ChildOf>,
) -> Affine3A {
    let all = core::iter::once(entity).chain(parents.iter_ancestors(entity));
    all.take_while(|&at| Some(at) != below)
        .filter_map(transform)
        .fold(Affine3A::IDENTITY, |place, transform| transform.compute_affine() * place)
}

/// What `next` hangs on, and its end, in the coordinates of the joint above it in a chain: others may lie between the two.
pub(crate) fn link(
    joint: Entity,
    next: Entity,
    transform: impl Fn(Entity) -> Option<Transform>,
    parents: &Query<&ChildOf>,
) -> (Affine3A, Vec3) {
    let above = parents.get(next).map_or(joint, ChildOf::parent);
    let end = transform(next).unwrap_or_default().translation;
    let between = place_below(above, Some(joint), transform, parents);
    (between, between.transform_point3(end))
}

/// Claims joints for a chain of the component `by`. Each joint has one master.
///
/// # Errors
/// A sentence about the `field` that names a joint of another chain.
pub(crate) fn claim(
    joints: &[Entity],
    (by, field): (Entity, &str),
    shown: &Query<(Entity, &ShownBones)>,
    claimed: &mut Vec<Entity>,
) -> Result<(), String> {
    if let Some(taken) = find_taken(joints.iter().copied(), by, shown, claimed) {
        return Err(format!("the joint {taken} of `{field}` is in another chain already"));
    }
    claimed.extend(joints);
    Ok(())
}

/// A joint of `joints` that a chain of another component than `by` turns, or that is claimed.
pub(crate) fn find_taken(
    mut joints: impl Iterator<Item = Entity>,
    by: Entity,
    shown: &Query<(Entity, &ShownBones)>,
    claimed: &[Entity],
) -> Option<Entity> {
    joints.find(|joint| {
        let is_of_other =
            |(other, chains): (Entity, &ShownBones)| other != by && chains.joints().any(|of| of == *joint);
        claimed.contains(joint) || shown.iter().any(is_of_other)
    })
}
