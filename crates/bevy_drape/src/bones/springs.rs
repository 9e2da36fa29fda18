//! Systems of spring bones.

use bevy::ecs::entity::EntityHashMap;
use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::constants::TELEPORT_SPEED;

use crate::attach::world_motion::TeleportCloth;
use crate::bones::chain::BoneChain;
use crate::bones::show::{ShownBones, aimed, claim, link, place_below};
use crate::bones::spring_bones::{SpringBones, SpringCollider, SpringJoint};
use crate::bones::swing::{Bone, PlacedCollider};
use crate::change_detection::collect_changed;
use crate::clock::DrapeClock;
use crate::refusal::{Cause, Refusals};
use crate::transform::moved_by_frame::move_by_frames;

/// The ends of the bones of a spring.
#[derive(Component, Clone, Debug, Default)]
pub(crate) struct SwingingTails {
    /// The joint in whose coordinates they are; the world without one.
    pub center: Option<Entity>,
    /// Their places after the last two steps. Empty before the first step, and after a teleport.
    pub ends: Vec<[Vec3; 2]>,
    /// The place of the first joint in the last step.
    pub head: Vec3,
}

/// The components of a spring that swings.
type Parts = (ShownBones, SwingingTails);

/// Checks springs that were inserted or changed since the last step, and lets them swing. New numbers leave them as they swing.
pub(crate) fn prepare_springs(
    mut commands: Commands,
    changed: Query<(Entity, Ref<SpringBones>)>,
    springs: Query<&SpringBones>,
    shown: Query<(Entity, &ShownBones)>,
    transforms: Query<&Transform>,
    parents: Query<&ChildOf>,
    mut refusals: ResMut<Refusals>,
    mut found: Local<Vec<Entity>>,
) {
    found.clear();
    collect_changed(&changed, &mut found);
    let mut claimed = Vec::new();
    for entity in found.drain(..) {
        let Ok(spring) = springs.get(entity) else { continue };
        let chain = chain(spring, &transforms, &parents).and_then(|chain| {
            claim(&chain.joints, (entity, "joints"), &shown, &mut claimed)?;
            Ok(chain)
        });
        match chain {
            Ok(chain) => {
                refusals.forget(entity);
                let of_frames = chain.joints.iter().chain(&spring.colliders).chain(&spring.center);
                of_frames.for_each(|&joint| move_by_frames(&mut commands, joint, &parents));
                let is_known =
                    shown.get(entity).is_ok_and(|(_, shown)| shown.joints().eq(chain.joints.iter().copied()));
                if !is_known {
                    let shown = ShownBones::new(vec![chain], &parents);
                    commands.entity(entity).insert((shown, SwingingTails::default()));
                }
            }
            Err(reason) => {
                refusals.entity(entity, "SpringBones", reason);
                commands.entity(entity).try_remove::<Parts>();
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
    let (_, tip) = link(last.joint, tail.joint, |joint| transforms.get(joint).ok().copied(), parents);
    let joints = joints.iter().map(|joint| joint.joint).collect();
    Ok(BoneChain { joints, tip, first: 0 })
}

/// Takes all springs through a step, those that hang on others after these, and each from its root on.
pub(crate) fn swing_springs(
    mut commands: Commands,
    mut springs: Query<(Entity, &SpringBones, &mut SwingingTails, &mut ShownBones, Has<TeleportCloth>)>,
    transforms: Query<&Transform>,
    parents: Query<&ChildOf>,
    colliders: Query<&SpringCollider>,
    clock: Res<DrapeClock>,
    mut placed: Local<Vec<PlacedCollider>>,
    (mut order, mut swung): (Local<Vec<(usize, Entity)>>, Local<EntityHashMap<Quat>>),
    mut turned: Local<Vec<(Entity, Quat)>>,
) {
    order.clear();
    order.extend(springs.iter().map(|(entity, _, _, shown, _)| (shown.depth, entity)));
    order.sort_unstable();
    swung.clear();
    for (_, entity) in order.drain(..) {
        let Ok((_, spring, mut tails, mut shown, is_teleport)) = springs.get_mut(entity) else { continue };
        // Joints that have swung in this step are where they have swung to.
        let transform_of = |joint: Entity| {
            let transform = transforms.get(joint).ok().copied()?;
            Some(swung.get(&joint).map_or(transform, |&rotation| transform.with_rotation(rotation)))
        };
        let place = |entity: Entity| place_below(entity, None, transform_of, &parents);
        placed.clear();
        placed.extend(spring.colliders.iter().filter_map(|&entity| {
            colliders.get(entity).ok().map(|collider| PlacedCollider::new(collider, &place(entity)))
        }));
        // One that is gone is none.
        let center = spring.center.filter(|&center| transforms.contains(center));
        let to_world = center.map_or(Affine3A::IDENTITY, place);
        let to_center = to_world.inverse();
        let Some(root) = spring.joints.first().map(|root| root.joint) else { continue };
        let base = parents.get(root).map(ChildOf::parent).ok();
        let mut parent = base.map_or(Affine3A::IDENTITY, place);
        let head = parent.transform_point3(transform_of(root).unwrap_or_default().translation);
        let is_jump = tails.head.distance(head) > TELEPORT_SPEED * clock.delta();
        if is_teleport {
            commands.entity(entity).remove::<TeleportCloth>();
        }
        if tails.center != center || is_jump || is_teleport {
            tails.ends.clear();
        }
        (tails.center, tails.head) = (center, head);
        if tails.ends.is_empty() {
            // In the animated pose, before any joint has swung.
            let ends = spring.joints.iter().skip(1).map(|end| {
                let end = place_below(end.joint, None, |at| transforms.get(at).ok().copied(), &parents);
                [to_center.transform_point3(end.translation.into()); 2]
            });
            tails.ends.extend(ends);
        }
        turned.clear();
        shown.record(
            parent,
            spring.joints.windows(2).zip(&mut tails.ends).map(|(pair, tails)| {
                let [joint, next] = [&pair[0], &pair[1]];
                let Some(transform) = transform_of(joint.joint) else { return Vec3::ZERO };
                let (between, end) = link(joint.joint, next.joint, transform_of, &parents);
                let at = parent * transform.compute_affine();
                let head = at.translation.into();
                let bone = Bone { head, rest: at.transform_point3(end) - head };
                let way = bone.swing(tails, [&to_world, &to_center], joint, &placed, clock.delta()) - head;
                let rotation = aimed(&parent, &transform, end, way).unwrap_or(transform.rotation);
                turned.push((joint.joint, rotation));
                parent *= transform.with_rotation(rotation).compute_affine() * between;
                way
            }),
        );
        swung.extend(turned.drain(..));
    }
}

/// Removes everything from an entity that loses its [`SpringBones`].
pub(crate) fn remove_springs(removed: On<Remove<SpringBones>>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<Parts>();
}
