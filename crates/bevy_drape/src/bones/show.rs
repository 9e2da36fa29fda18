//! Turns joints so that their bones lie as they have been solved.
//!
//! ```text
//!   First          joints get their animated rotations back
//!   fixed steps    see the animated pose, by which pins, drives and limits go
//!   PostUpdate     animations write a new pose; then each joint, from the root on, is turned
//!                  by the least turn that lays its bone along the line between two particles
//! ```

use bevy::math::Affine3A;
use bevy::prelude::*;

use crate::attach::animated_pose::AnimatedPose;
use crate::body::particles::Particles;
use crate::bones::chain::BoneChain;
use crate::transform::interpolation::{ShowsBetweenSteps, step_fraction};

/// Chains of joints, as they are shown.
#[derive(Component, Clone, Debug)]
pub(crate) struct ShownBones {
    chains: Vec<BoneChain>,
    /// For each bone, the way from its joint to its end after the last two steps.
    ways: [Vec<Vec3>; 2],
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
    pub fn new(chains: Vec<BoneChain>) -> Self {
        Self { chains, ways: default(), turned: Vec::new() }
    }

    /// Notes where the bones point after a step: all of one chain, then those of the next.
    pub fn record(&mut self, bones: impl Iterator<Item = Vec3>) {
        let [before, now] = &mut self.ways;
        core::mem::swap(before, now);
        now.clear();
        now.extend(bones);
        if before.len() != now.len() {
            before.clone_from(now);
        }
    }

    /// Notes where the bones of a body point after a step.
    fn record_body(&mut self, particles: &drape_solver::Particles) {
        let chains = core::mem::take(&mut self.chains);
        let joints = chains.iter().flat_map(|chain| chain.first..chain.first + chain.joints.len());
        self.record(joints.map(|i| particles.position(i + 1) - particles.position(i)));
        self.chains = chains;
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

/// Records cloths of bones after a step.
pub(crate) fn record_bones(mut bodies: Query<(Ref<Particles>, &mut ShownBones, &mut AnimatedPose)>) {
    for (particles, mut shown, mut posed) in &mut bodies {
        posed.record();
        let [before, now] = &shown.ways;
        if particles.is_changed() || before != now || now.is_empty() {
            shown.record_body(&particles);
        }
    }
}

/// Gives joints their animated rotations back, for the frame to come.
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
    mut bodies: Query<(&mut ShownBones, Option<&AnimatedPose>)>,
    mut joints: Query<&mut Transform>,
    parents: Query<&ChildOf>,
    between: Res<ShowsBetweenSteps>,
    time: Option<Res<Time<Fixed>>>,
) {
    let fraction = if between.0 { step_fraction(time.as_deref()) } else { 1.0 };
    for (mut shown, posed) in &mut bodies {
        let ShownBones { chains, ways: [before, now], turned: all } = &mut *shown;
        let ahead = posed.and_then(|posed| {
            // Steps see an older pose than the one that the rest of the character is drawn in.
            let main = place_below(
                *posed.joints.get(posed.main)?,
                None,
                |at| joints.get(at).ok().copied(),
                &parents,
            );
            let main = GlobalTransform::from(main);
            posed.ahead(fraction, |_| Some(&main))
        });
        let ahead = ahead.unwrap_or(Affine3A::IDENTITY);
        let mut ways = before.iter().zip(&*now).map(|(before, now)| before.lerp(*now, fraction));
        for chain in &*chains {
            let above = |joint: Option<&Entity>, below: Option<Entity>, joints: &Query<&mut Transform>| {
                let parent = joint.and_then(|&joint| parents.get(joint).ok());
                parent.map_or(Affine3A::IDENTITY, |parent| {
                    place_below(parent.parent(), below, |at| joints.get(at).ok().copied(), &parents)
                })
            };
            let mut parent = above(chain.joints.first(), None, &joints);
            for (index, &joint) in chain.joints.iter().enumerate() {
                let Some(way) = ways.next() else { break };
                let next = chain.joints.get(index + 1);
                let end = next.map_or(chain.tip, |&next| {
                    place_below(next, Some(joint), |at| joints.get(at).ok().copied(), &parents)
                        .translation
                        .into()
                });
                let between = above(next, Some(joint), &joints);
                let Ok(mut transform) = joints.get_mut(joint) else { continue };
                let animated = transform.rotation;
                if let Some(shown) = turned(&parent, &transform, end, ahead.transform_vector3(way)) {
                    transform.rotation = shown;
                    all.push(TurnedJoint { joint, animated, shown });
                }
                parent *= transform.compute_affine() * between;
            }
        }
    }
}

/// The rotation of a joint of this transform, on `parent`, whose bone ends at `end` in its coordinates, that lays the bone along `way` in
/// the world by the least turn. None if one of them has no length.
pub(crate) fn turned(parent: &Affine3A, transform: &Transform, end: Vec3, way: Vec3) -> Option<Quat> {
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
