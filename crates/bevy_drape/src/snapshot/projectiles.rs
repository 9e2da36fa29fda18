//! The state of balls.

use bevy::ecs::change_detection::{MAX_CHANGE_AGE, Tick};
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use drape_solver::{Ball, BallSnapshot};

use crate::ball::projectile::{Projectile, ProjectileRecord, ProjectileState};
use crate::body::activity::Activity;
use crate::body::contact_events::ContactEvents;
use crate::body::layers::DrapeLayers;
use crate::snapshot::key::{Key, Keys, SnapshotError, entity, out_of_order};
use crate::snapshot::world::{Placed, PlainTransform, members, put_component, put_disabled};
use crate::transform::interpolation::Interpolated;

/// The state of one ball.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct ProjectileSnapshot {
    order: u64,
    name: Option<String>,
    placed: Placed,
    activity: Activity,
    projectile: Projectile,
    ball: BallSnapshot,
    written: PlainTransform,
    is_refused: bool,
    own_layers: Option<DrapeLayers>,
    tells_contacts: bool,
    is_interpolated: bool,
    is_disabled: bool,
}

impl ProjectileSnapshot {
    fn key(&self) -> Key {
        Key::Ball(self.order)
    }

    fn ball(&self) -> Result<Ball, SnapshotError> {
        Ball::from_snapshot(&self.ball).map_err(|source| SnapshotError::BadState { key: self.key(), source })
    }
}

pub(super) fn take(world: &World, keys: &Keys) -> Vec<ProjectileSnapshot> {
    let mut balls = Vec::new();
    for &(key, entity) in keys {
        let Key::Ball(order) = key else { continue };
        let entity = world.entity(entity);
        let (Some(projectile), Some(state)) = (entity.get::<Projectile>(), entity.get::<ProjectileState>())
        else {
            continue;
        };
        let Some(record) = entity.get::<ProjectileRecord>() else { continue };
        balls.push(ProjectileSnapshot {
            order,
            name: entity.get::<Name>().map(ToString::to_string),
            placed: Placed::take(entity),
            activity: entity.get().copied().unwrap_or_default(),
            projectile: *projectile,
            ball: state.snapshot(),
            written: record.written.into(),
            is_refused: record.refused,
            own_layers: entity.get().copied(),
            tells_contacts: entity.contains::<ContactEvents>(),
            is_interpolated: entity.contains::<Interpolated>(),
            is_disabled: entity.contains::<Disabled>(),
        });
    }
    balls
}

pub(super) fn check(balls: &[ProjectileSnapshot]) -> Result<(), SnapshotError> {
    out_of_order(balls.iter().map(ProjectileSnapshot::key))?;
    balls.iter().try_for_each(|ball| ball.ball().map(drop))
}

/// Restores balls that have been [checked](check).
pub(super) fn restore(
    balls: &[ProjectileSnapshot],
    world: &mut World,
    keys: &Keys,
) -> Result<(), SnapshotError> {
    for &(key, ball) in keys {
        let is_known = balls.binary_search_by_key(&key, ProjectileSnapshot::key).is_ok();
        if matches!(key, Key::Ball(_)) && !is_known {
            world.despawn(ball);
        }
    }
    // A missing ball was spawned here without the component of the filter, if an earlier restoration brought it back.
    let all = members(world);
    let old = Tick::new(world.change_tick().get().wrapping_sub(MAX_CHANGE_AGE));
    for snapshot in balls {
        let mut entity = match entity(&all, snapshot.key()) {
            Some(entity) => world.entity_mut(entity),
            None => world.spawn((snapshot.projectile, snapshot.placed.transform(), snapshot.placed.global())),
        };
        let record = ProjectileRecord {
            order: snapshot.order,
            written: snapshot.written.into(),
            refused: snapshot.is_refused,
        };
        entity.insert((ProjectileState(snapshot.ball()?), record, snapshot.activity));
        put_component(&mut entity, Some(&snapshot.projectile));
        put_component(&mut entity, snapshot.own_layers.as_ref());
        if let Some(name) = &snapshot.name {
            put_component(&mut entity, Some(&Name::new(name.clone())));
        }
        if snapshot.tells_contacts && !entity.contains::<ContactEvents>() {
            entity.insert(ContactEvents);
        }
        if snapshot.is_interpolated && !entity.contains::<Interpolated>() {
            entity.insert(Interpolated);
        }
        put_disabled(&mut entity, snapshot.is_disabled);
        snapshot.placed.restore(&mut entity);
        // A marked change would launch the ball again, which is built already.
        if let Some(mut projectile) = entity.get_mut::<Projectile>() {
            projectile.set_last_changed(old);
        }
    }
    Ok(())
}
