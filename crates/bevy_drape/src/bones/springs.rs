//! Systems of spring bones.

use bevy::math::Affine3A;
use bevy::prelude::*;

use crate::bones::chain::BoneChain;
use crate::bones::show::{ShownBones, place_below, turned};
use crate::bones::spring_bones::{SpringBones, SpringCollider, SpringJoint};
use crate::bones::swing::{Bone, PlacedCollider};
use crate::change_detection::collect_changed;
use crate::clock::DrapeClock;
use crate::refusal::{Cause, Refusals};
use crate::transform::moved_by_frame::move_by_frames;

/// The ends of the bones of a spring, after the last two steps, in the coordinates of its centre. Empty before the first step.
#[derive(Component, Clone, Debug, Default)]
pub(crate) struct SwingingTails(pub Vec<[Vec3; 2]>);

/// Checks springs that were inserted or changed since the last step, and lets them swing.
pub(crate) fn prepare_springs(
    mut commands: Commands,
    changed: Query<(Entity, Ref<SpringBones>)>,
    springs: Query<&SpringBones>,
    transforms: Query<&Transform>,
    parents: Query<&ChildOf>,
    mut refusals: ResMut<Refusals>,
    mut found: Local<Vec<Entity>>,
) {
    found.clear();
    collect_changed(&changed, &mut found);
    for entity in found.drain(..) {
        let Ok(spring) = springs.get(entity) else { continue };
        match chain(spring, &transforms, &parents) {
            Ok(chain) => {
                refusals.forget(entity);
                chain.joints.iter().for_each(|&joint| move_by_frames(&mut commands, joint, &parents));
                commands.entity(entity).insert((ShownBones::new(vec![chain]), SwingingTails::default()));
            }
            Err(reason) => {
                refusals.entity(entity, "SpringBones", reason);
                commands.entity(entity).try_remove::<(ShownBones, SwingingTails)>();
            }
        }
    }
}

/// The chain of a spring: its last joint is the tip.
fn chain(
    spring: &SpringBones,
    transforms: &Query<&Transform>,
    parents: &Query<&ChildOf>,
) -> Result<BoneChain, Cause> {
    let [joints @ .., tail] = spring.joints.as_slice() else { return Err("`joints` names no joint".into()) };
    let Some(last) = joints.last() else {
        return Err("`joints` needs two: the second is the end of the first".into());
    };
    spring.joints.iter().try_for_each(SpringJoint::validate)?;
    for pair in spring.joints.windows(2) {
        let [above, below] = [pair[0].joint, pair[1].joint];
        let hangs = parents.iter_ancestors(below).any(|ancestor| ancestor == above);
        if !(hangs && transforms.contains(above) && transforms.contains(below)) {
            return Err(format!("the joint {below} in `joints` does not hang on {above}").into());
        }
    }
    let tip = place_below(tail.joint, Some(last.joint), |joint| transforms.get(joint).ok().copied(), parents);
    Ok(BoneChain {
        joints: joints.iter().map(|joint| joint.joint).collect(),
        tip: tip.translation.into(),
        first: 0,
    })
}

/// Takes all springs through a step, from their roots on.
pub(crate) fn swing_springs(
    mut springs: Query<(&SpringBones, &mut SwingingTails, &mut ShownBones)>,
    transforms: Query<&Transform>,
    places: Query<&GlobalTransform>,
    parents: Query<&ChildOf>,
    colliders: Query<(&SpringCollider, &GlobalTransform)>,
    clock: Res<DrapeClock>,
    mut placed: Local<Vec<PlacedCollider>>,
) {
    let transform_of = |joint| transforms.get(joint).ok().copied();
    for (spring, mut tails, mut shown) in &mut springs {
        placed.clear();
        placed.extend(
            colliders
                .iter_many(&spring.colliders)
                .flatten()
                .map(|(it, place)| PlacedCollider::new(it, place)),
        );
        let affine = |entity: Option<Entity>| {
            entity
                .and_then(|entity| places.get(entity).ok())
                .map_or(Affine3A::IDENTITY, GlobalTransform::affine)
        };
        let center = affine(spring.center);
        let root = spring.joints.first().and_then(|root| parents.get(root.joint).ok()).map(ChildOf::parent);
        let mut parent = affine(root);
        if tails.0.is_empty() {
            let ends = spring.joints.iter().skip(1).map(|end| {
                let end = parent * place_below(end.joint, root, transform_of, &parents);
                [center.inverse().transform_point3(end.translation.into()); 2]
            });
            tails.0.extend(ends);
        }
        shown.record(spring.joints.windows(2).zip(&mut tails.0).map(|(pair, tails)| {
            let [joint, next] = [&pair[0], &pair[1]];
            let Some(transform) = transform_of(joint.joint) else { return Vec3::ZERO };
            let end = place_below(next.joint, Some(joint.joint), transform_of, &parents).translation.into();
            let at = parent * transform.compute_affine();
            let head = at.translation.into();
            let bone = Bone { head, rest: at.transform_point3(end) - head };
            let way = bone.swing(tails, &center, joint, &placed, clock.delta()) - head;
            let rotation = turned(&parent, &transform, end, way).unwrap_or(transform.rotation);
            let between = parents.get(next.joint).map_or(Affine3A::IDENTITY, |above| {
                place_below(above.parent(), Some(joint.joint), transform_of, &parents)
            });
            parent *= transform.with_rotation(rotation).compute_affine() * between;
            way
        }));
    }
}

/// Removes everything from an entity that loses its [`SpringBones`].
pub(crate) fn remove_springs(removed: On<Remove<SpringBones>>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<(ShownBones, SwingingTails)>();
}
