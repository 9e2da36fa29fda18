//! Builds cloths of bones from their descriptions.

use core::iter::successors;

use bevy::math::Affine3A;
use bevy::prelude::*;

use crate::attach::animated_pose::{AnimatedPose, PosedParticle};
use crate::body::body_state::{BodyState, CreationOrder};
use crate::body::tearable::Untearable;
use crate::bones::bone_cloth::BoneCloth;
use crate::bones::chain::{BoneChain, PosedChains};
use crate::bones::show::{ShownBones, claim, find_taken};
use crate::bones::spring_bones::SpringCollider;
use crate::build::description::{insert_body, remove_body};
use crate::change_detection::collect_changed;
use crate::environment::obstacle::Obstacle;
use crate::refusal::{Cause, Refusals};
use crate::transform::moved_by_frame::move_by_frames;

/// All entities that may be joints.
type Joints<'w, 's> = Query<'w, 's, &'static GlobalTransform, (Without<Obstacle>, Without<SpringCollider>)>;

/// The components of a cloth of bones besides its body.
type Parts = (AnimatedPose, ShownBones, Untearable);

/// Builds the bodies of cloths of bones that were inserted or changed since the last step.
pub(crate) fn build_bone_cloths(
    mut commands: Commands,
    described: Query<(Entity, Ref<BoneCloth>)>,
    cloths: Query<(&BoneCloth, &GlobalTransform)>,
    children: Query<&Children>,
    parents: Query<&ChildOf>,
    places: Joints,
    shown: Query<(Entity, &ShownBones)>,
    mut order: ResMut<CreationOrder>,
    mut refusals: ResMut<Refusals>,
    mut to_build: Local<Vec<Entity>>,
) {
    to_build.clear();
    let mut claimed = Vec::new();
    collect_changed(&described, &mut to_build);
    for entity in to_build.drain(..) {
        let Ok((cloth, transform)) = cloths.get(entity) else { continue };
        let built = pose(cloth, &children, &places).and_then(|posed| {
            for chain in &posed.chains {
                claim(&chain.joints, (entity, "roots"), &shown, &mut claimed)?;
            }
            let above = posed.chains.iter().flat_map(|chain| parents.iter_ancestors(chain.joints[0]));
            if let Some(above) = find_taken(above, entity, &shown, &claimed) {
                return Err(format!(
                    "a chain of `roots` hangs on the joint {above}, which is in a chain itself"
                )
                .into());
            }
            let parts = posed.build(cloth)?;
            let main = parents.get(cloth.roots[0]).map(ChildOf::parent).ok();
            Ok((parts, animated_pose(&posed.chains, main, &places)?, posed.chains))
        });
        match built {
            Ok((parts, pose, chains)) => {
                refusals.forget(entity);
                pose.joints.iter().for_each(|&joint| move_by_frames(&mut commands, joint, &parents));
                insert_body(&mut commands, entity, order.next(), transform, parts, None);
                let mut body = commands.entity(entity);
                body.insert((pose, ShownBones::new(chains, &parents), Untearable));
                // Pins follow the joints instead of the entity.
                body.entry::<BodyState>().and_modify(|mut state| state.pins.clear());
            }
            Err(reason) => {
                refusals.entity(entity, "BoneCloth", reason);
                remove_body(&mut commands, entity);
                commands.entity(entity).try_remove::<Parts>();
            }
        }
    }
}

/// Follows the chains of `cloth` down, and notes where they stand.
fn pose(cloth: &BoneCloth, children: &Query<&Children>, places: &Joints) -> Result<PosedChains, Cause> {
    if cloth.roots.is_empty() {
        return Err("`roots` names no joint".into());
    }
    let next = |&joint: &Entity| {
        let at = places.get(joint).ok()?.translation();
        let is_next = |&child: &Entity| places.get(child).is_ok_and(|place| place.translation() != at);
        children.get(joint).ok()?.iter().find(is_next)
    };
    let mut posed = PosedChains::default();
    for &root in &cloth.roots {
        if !places.contains(root) {
            return Err(format!(
                "the joint {root} in `roots` does not exist, has no Transform, or is an obstacle"
            )
            .into());
        }
        let joints: Vec<Entity> = successors(Some(root), next).collect();
        let stand: Vec<GlobalTransform> =
            joints.iter().filter_map(|&joint| places.get(joint).ok().copied()).collect();
        if let Some(place) = stand.iter().position(|place| !place.affine().is_finite()) {
            return Err(format!("the Transform of joint {} must be finite", joints[place]).into());
        }
        posed.push(joints, &stand, cloth.tip)?;
    }
    Ok(posed)
}

/// The pose that the joints give to the particles: a particle at each joint, and the tips. The character's motion is that of `main`,
/// on which the chains hang.
fn animated_pose(chains: &[BoneChain], main: Option<Entity>, places: &Joints) -> Result<AnimatedPose, Cause> {
    let all = chains.iter().flat_map(|chain| &chain.joints).copied();
    let joints: Vec<Entity> = main.filter(|&main| places.contains(main)).into_iter().chain(all).collect();
    let mut posed = AnimatedPose {
        source: "BoneCloth",
        inverse_bind_poses: vec![Affine3A::IDENTITY; joints.len()],
        ..AnimatedPose::default()
    };
    let mut first = joints.len() - chains.iter().map(|chain| chain.joints.len()).sum::<usize>();
    for chain in chains {
        let last = chain.joints.len() - 1;
        let ends = (0..=last).map(|place| (place, Vec3::ZERO)).chain([(last, chain.tip)]);
        for ((place, local), particle) in ends.zip(chain.first as u32..) {
            let joint = u16::try_from(first + place).map_err(|_| "there are more than 65 536 joints")?;
            posed.particles.push(PosedParticle {
                particle,
                local,
                normal: Vec3::ZERO,
                joints: [joint, 0, 0, 0],
                weights: [1.0, 0.0, 0.0, 0.0],
            });
        }
        first += chain.joints.len();
    }
    posed.joints = joints;
    let mut now = Vec::new();
    posed
        .matrices(|joint| places.get(joint).ok(), &mut now)
        .map_err(|joint| format!("joint {joint} is gone"))?;
    posed.last = now;
    Ok(posed)
}

/// Removes everything but the body from an entity that loses its [`BoneCloth`].
pub(crate) fn remove_bone_cloth(removed: On<Remove<BoneCloth>>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<Parts>();
}
