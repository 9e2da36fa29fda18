//! Builds the scene in a Bevy app, and fires the planned shots.

use bevy::prelude::*;
use bevy_drape::cannon::{Cannon, FireCannon};
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;

use crate::cannon_demo::scene::{CannonScene, Curtain, Ground, MUZZLE, STEP, cannon_ball};
use crate::cannon_demo::shot::Shot;

/// Builds the scene and fires the planned shots.
pub struct CannonScenePlugin(pub CannonScene);

impl Plugin for CannonScenePlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.0.clone())
            .insert_resource(Time::<Fixed>::from_seconds(STEP))
            .init_resource::<Plan>()
            .add_systems(Startup, begin)
            .add_systems(FixedUpdate, fire_planned_shots);
    }
}

/// The progress of the plan.
#[derive(Resource, Default)]
struct Plan {
    /// Time of the clock at which the scene began, in seconds.
    began: f64,
    /// Number of shots that have been fired.
    fired: u32,
}

/// Begins the scene, in place of the one that is there: a new curtain, a new plan, no balls.
pub fn begin(world: &mut World) {
    type Scene = Or<(With<Curtain>, With<Ground>, With<Cannon>, With<Projectile>)>;
    let old: Vec<Entity> = world.query_filtered::<Entity, Scene>().iter(world).collect();
    for entity in old {
        world.despawn(entity);
    }
    let began = world.resource::<DrapeClock>().elapsed();
    world.insert_resource(Plan { began, fired: 0 });
    let curtain = world.resource::<CannonScene>().curtain();
    let mut cannon = Cannon { ball: cannon_ball(), ..default() };
    Shot::planned(0).aim(&mut cannon);
    world.spawn((Ground, Obstacle::ground(), Transform::default(), Name::new("ground")));
    world.spawn(curtain);
    world.spawn((cannon, Transform::from_translation(MUZZLE), Name::new("cannon")));
}

fn fire_planned_shots(
    clock: Res<DrapeClock>,
    scene: Res<CannonScene>,
    mut plan: ResMut<Plan>,
    mut cannons: Query<(Entity, &mut Cannon)>,
    mut fire: MessageWriter<FireCannon>,
) {
    // Half a step of slack: the clock sums up rounded steps.
    let now = clock.elapsed() - plan.began + 0.5 * STEP;
    while let Some(shot) = next_shot(&scene, plan.fired).filter(|shot| shot.time <= now) {
        plan.fired += 1;
        for (entity, mut cannon) in &mut cannons {
            shot.aim(&mut cannon);
            fire.write(FireCannon { cannon: entity });
        }
    }
}

/// The shot that follows the first `fired`, if there is one.
fn next_shot(scene: &CannonScene, fired: u32) -> Option<Shot> {
    (fired < scene.shots).then(|| Shot::planned(fired))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_shots_as_are_asked_for() {
        for shots in [0, 1, 4, 5, 6, 12, 100] {
            let scene = CannonScene { shots, ..default() };
            let fired: Vec<Shot> = (0..).map_while(|fired| next_shot(&scene, fired)).collect();
            assert_eq!(fired.len(), shots as usize);
            assert!(fired.iter().enumerate().all(|(index, shot)| shot.time == 1.0 + 3.0 * index as f64));
        }
    }
}
