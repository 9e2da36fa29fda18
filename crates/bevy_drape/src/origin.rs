//! Large worlds: a floating origin, which follows the player.
//!
//! Single precision knows a place 100 km away to a centimetre. So a game that is larger than some kilometres moves its origin along:
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::origin::ShiftOrigin;
//!
//! /// Shifts the origin to the player by whole kilometres.
//! fn follow(player: Single<&Transform, With<Camera3d>>, mut commands: Commands) {
//!     let offset = (player.translation / 1000.0).round() * 1000.0;
//!     if offset != Vec3::ZERO {
//!         commands.queue(ShiftOrigin(offset));
//!     }
//! }
//! # let mut app = App::new();
//! # app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default())).add_systems(Update, follow);
//! # let player = app.world_mut().spawn((Camera3d::default(), Transform::from_xyz(1200.0, 2.0, 0.0))).id();
//! # app.update();
//! # assert_eq!(app.world().get::<Transform>(player).unwrap().translation, Vec3::new(200.0, 2.0, 0.0));
//! ```
//!
//! Imports all states of the floors below that hold positions in the world.

use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::{Allow, IterQueryData, QueryFilter};
use bevy::math::{Affine3A, Vec3A};
use bevy::prelude::*;
use bevy::transform::systems::{mark_dirty_trees, propagate_parent_transforms, sync_simple_transforms};
use drape_solver::world::bounds::Bounds;

use crate::attach::animated_pose::AnimatedPose;
use crate::attach::attachment_state::AttachmentState;
use crate::attach::grab::Grab;
use crate::attach::plane_lock::PlaneLock;
use crate::attach::world_motion::{WorldMotion, WorldMotionState};
use crate::ball::projectile::{ProjectileRecord, ProjectileState};
use crate::body::body_state::BodyState;
use crate::body::particles::Particles;
#[cfg(feature = "gpu")]
use crate::body::{activity::Activity, on_gpu::OnGpu};
use crate::bones::springs::SwingingTails;
use crate::build::rigid_tetrahedron::RigidPlace;
use crate::environment::dynamic_obstacle::PlannedPlacement;
use crate::environment::solver_environment::SolverEnvironment;
use crate::environment::wind_zone::WindZone;
#[cfg(feature = "gpu")]
use crate::gpu::{GpuBodies, report::LastReport};
#[cfg(feature = "mesh")]
use crate::render::{rope_mesh::RopeSurface, surface::Surface};
use crate::rig::components::ParticleRecord;
use crate::sleep::candidates::Candidates;
use crate::transform::interpolation::InterpolationState;
use crate::transform::moved_by_frame::FramePoses;

/// Makes this place in the world, in metres, its new origin: a command, for between two steps.
///
/// All roots with a [`Transform`] move by the negative of it, also those that have nothing to do with cloth, and with them every place that
/// the plugin keeps. Nothing else changes: whatever rests goes on resting, and motion and interpolation go on.
///
/// Shift by whole metres, which are exact near the origin. Places far from the new origin lose digits, those near it have them all: a body
/// keeps its shape to the last bit either way, as its particles lie relative to a point of its own. Gusts are those of the new coordinates.
/// [`SceneManager`](crate::sleep::SceneManager)'s play area stays around the origin.
///
/// Yours to move are the bodies of another physics engine, and messages that nobody has read yet. A
/// [`Snapshot`](crate::snapshot::Snapshot) of before has the old coordinates: do not restore it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShiftOrigin(pub Vec3);

impl Command for ShiftOrigin {
    type Out = ();

    fn apply(self, world: &mut World) {
        let Self(origin) = self;
        if !origin.is_finite() {
            error!("ShiftOrigin: {origin} is not finite; the origin stays where it is");
            return;
        }
        let shift = Shift::of_transforms(origin, world);
        shift.bodies(world);
        shift.followed_poses(world);
        shift.springs(world);
        shift.written_transforms(world);
        shift.environment(world);
        #[cfg(feature = "mesh")]
        shift.surfaces(world);
        #[cfg(feature = "gpu")]
        shift.bodies_on_gpu(world);
    }
}

/// A shift of the origin for which all transforms have been moved.
struct Shift {
    origin: Vec3,
    moves: EntityHashMap<Moved>,
}

/// The transform of an entity in the world after the shift, and its translation before it.
struct Moved {
    from: Vec3A,
    to: Affine3A,
}

impl Shift {
    /// Moves the transforms of all roots, and all others with them.
    fn of_transforms(origin: Vec3, world: &mut World) -> Self {
        propagate(world);
        let mut moves = EntityHashMap::default();
        each::<(Entity, &GlobalTransform), ()>(world, |(entity, global)| {
            let to = global.affine();
            moves.insert(entity, Moved { from: to.translation, to });
        });
        each::<&mut Transform, Without<ChildOf>>(world, |mut root| root.translation -= origin);
        each::<&mut InterpolationState, Without<ChildOf>>(world, |mut state| state.shift_origin(origin));
        each::<&mut FramePoses, Without<ChildOf>>(world, |mut poses| poses.shift_origin(origin));
        propagate(world);
        each::<(Entity, &mut GlobalTransform), ()>(world, |(entity, mut global)| {
            let Some(moved) = moves.get_mut(&entity) else { return };
            moved.to = global.affine();
            // Bevy leaves out what is disabled.
            if moved.to.translation == moved.from {
                moved.to.translation -= Vec3A::from(origin);
                *global = moved.to.into();
            }
        });
        Self { origin, moves }
    }

    /// A place in the new coordinates.
    fn place(&self, place: Vec3) -> Vec3 {
        place - self.origin
    }

    fn bounds(&self, bounds: Bounds) -> Bounds {
        Bounds::new(self.place(bounds.low), self.place(bounds.high))
    }

    fn pose(&self, pose: Affine3A) -> Affine3A {
        Affine3A { translation: self.place(pose.translation.into()).into(), ..pose }
    }

    /// A place in the new coordinates that may be the place of an entity. Then it is where the entity is now, to the last bit, so that
    /// nothing takes the rounding for a move.
    fn place_of(&self, entity: Entity, place: Vec3) -> Vec3 {
        match self.moves.get(&entity) {
            Some(moved) if moved.from == place.into() => moved.to.translation.into(),
            _ => self.place(place),
        }
    }

    /// The pose, in the new coordinates, of something that may be at `local` in the coordinates of an entity.
    fn pose_of(&self, entity: Entity, pose: Affine3A, local: Affine3A) -> Affine3A {
        match self.moves.get(&entity) {
            Some(&Moved { from, to }) if Affine3A { translation: from, ..to } * local == pose => to * local,
            _ => self.pose(pose),
        }
    }

    fn body(&self, entity: Entity, state: &mut BodyState) {
        state.anchor = self.pose_of(entity, state.anchor, Affine3A::IDENTITY);
        state.extent.bounds = self.bounds(state.extent.bounds);
    }

    fn bodies(&self, world: &mut World) {
        // Marked as changed, so that the next step tells the search for what wakes a sleeper where each is.
        each::<&mut Particles, ()>(world, |mut particles| particles.shift_origin(self.origin));
        each::<(Entity, &mut BodyState), ()>(world, |(entity, mut state)| self.body(entity, &mut state));
        each::<&mut Grab, ()>(world, |mut grab| {
            grab.hands.iter_mut().for_each(|hand| hand.target = self.place(hand.target));
        });
        each::<&mut PlaneLock, ()>(world, |mut lock| {
            lock.distance -= lock.normal.normalize_or_zero().dot(self.origin);
        });
        let mut candidates = world.resource_mut::<Candidates>();
        candidates.left.iter_mut().for_each(|bounds| *bounds = self.bounds(*bounds));
    }

    /// Moves the poses that bodies follow.
    fn followed_poses(&self, world: &mut World) {
        each::<&mut AttachmentState, ()>(world, |mut state| {
            let AttachmentState { made_of, poses, .. } = &mut *state;
            for (tie, pose) in made_of.ties.iter().zip(poses) {
                *pose = pose.map(|pose| self.pose_of(tie.entity, pose, Affine3A::IDENTITY));
            }
        });
        each::<(Entity, &WorldMotion, &mut WorldMotionState), ()>(world, |(entity, motion, mut state)| {
            let reference = motion.reference.unwrap_or(entity);
            state.last = state.last.map(|last| self.pose_of(reference, last, Affine3A::IDENTITY));
        });
        each::<&mut AnimatedPose, ()>(world, |mut pose| {
            let AnimatedPose { joints, inverse_bind_poses, main, last, shown, .. } = &mut *pose;
            for ((&joint, &local), last) in joints.iter().zip(&*inverse_bind_poses).zip(last) {
                *last = self.pose_of(joint, *last, local);
            }
            if let (Some(&joint), Some(&local)) = (joints.get(*main), inverse_bind_poses.get(*main)) {
                *shown = shown.map(|shown| shown.map(|shown| self.pose_of(joint, shown, local)));
            }
        });
    }

    /// Moves the ends of spring bones. Those with a centre are in its coordinates.
    fn springs(&self, world: &mut World) {
        each::<&mut SwingingTails, ()>(world, |mut tails| {
            if tails.center.is_none() {
                tails.ends.iter_mut().flatten().for_each(|tail| *tail = self.place(*tail));
            }
            tails.head = self.place(tails.head);
        });
    }

    /// Moves balls, and what the plugin remembers of transforms that it wrote.
    fn written_transforms(&self, world: &mut World) {
        each::<&mut ProjectileState, ()>(world, |mut ball| ball.shift_origin(self.origin));
        each::<&mut ProjectileRecord, Without<ChildOf>>(world, |mut record| {
            record.written.translation = self.place(record.written.translation);
        });
        each::<&mut RigidPlace, Without<ChildOf>>(world, |mut place| place.shift_origin(self.origin));
        each::<(Entity, &mut ParticleRecord, Has<ChildOf>), ()>(world, |(entity, mut record, is_child)| {
            if !is_child {
                record.written = self.place(record.written);
            }
            record.placed = self.place_of(entity, record.placed);
        });
    }

    fn environment(&self, world: &mut World) {
        each::<(Entity, &mut PlannedPlacement), ()>(world, |(entity, mut planned)| {
            planned.translation = self.place_of(entity, planned.translation);
        });
        let mut zones = world.query_filtered::<Entity, With<WindZone>>();
        let zones: Vec<Entity> = zones.iter(world).collect();
        let mut solver = world.resource_mut::<SolverEnvironment>();
        let SolverEnvironment { environment, obstacles: known, .. } = &mut *solver;
        environment.obstacles.change_coordinates(|slot, place| self.place_of(known.entity(slot), place));
        for zone in &mut environment.wind_zones {
            let place = &mut zone.placement.translation;
            let of = zones
                .iter()
                .find(|&entity| self.moves.get(entity).is_some_and(|moved| moved.from == (*place).into()));
            *place = of.map_or_else(|| self.place(*place), |&entity| self.place_of(entity, *place));
        }
    }

    #[cfg(feature = "mesh")]
    fn surfaces(&self, world: &mut World) {
        each::<&mut Surface, ()>(world, |mut surface| surface.shift_origin(self.origin));
        each::<&mut RopeSurface, ()>(world, |mut surface| surface.shift_origin(self.origin));
    }

    #[cfg(feature = "gpu")]
    fn bodies_on_gpu(&self, world: &mut World) {
        each::<(Entity, &mut OnGpu), ()>(world, |(entity, mut parts)| {
            parts.particles.shift_origin(self.origin);
            parts.anchor = self.pose_of(entity, parts.anchor, Affine3A::IDENTITY);
            self.body(entity, &mut parts.state);
        });
        each::<&mut LastReport, ()>(world, |mut last| last.bounds = self.bounds(last.bounds));
        // The search for what wakes a sleeper takes those anew whose activity changed.
        each::<&mut Activity, With<OnGpu>>(world, |mut activity| activity.set_changed());
        if let Some(mut bodies) = world.get_resource_mut::<GpuBodies>() {
            bodies.shift_origin(self.origin);
        }
    }
}

/// Brings global transforms up to date.
fn propagate(world: &mut World) {
    let propagated = (world.run_system_cached(mark_dirty_trees))
        .and_then(|()| world.run_system_cached(propagate_parent_transforms))
        .and_then(|()| world.run_system_cached(sync_simple_transforms));
    if let Err(error) = propagated {
        error!("ShiftOrigin: {error}");
    }
}

/// Calls `act` on the components of all entities that have them, disabled or not.
fn each<D: IterQueryData, F: QueryFilter>(world: &mut World, act: impl FnMut(D::Item<'_, '_>)) {
    world.query_filtered::<D, (F, Allow<Disabled>)>().iter_mut(world).for_each(act);
}
