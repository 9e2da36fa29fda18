//! bevy_verlet in an app: an entity for each point and each stick. What is timed is an update of the app.

use std::time::Duration;

use bevy::MinimalPlugins;
use bevy::app::{App, FixedPostUpdate};
use bevy::ecs::prelude::{Entity, Query, Res, ResMut, Resource, With, Without};
use bevy::math::Vec3;
use bevy::time::{Fixed, Time, TimeUpdateStrategy};
use bevy::transform::components::Transform;
use bevy_verlet::{VerletConfig, VerletLocked, VerletPlugin, VerletPoint, VerletStick};
use drape_bench::Failure;
use drape_bench::options::SolverOptions;
use drape_bench::scene::Scene;
use drape_bench::simulation::{Simulation, timed};
use drape_bench::solver::refuse_sleepers;
use drape_bench::world::{GRAVITY, STEP};
use drape_solver::glam;

use crate::silk::out_of_sphere;

/// The app. The crate takes substeps x sweeps as iterations of one step, and meets the sphere once.
pub struct Verlet {
    app: App,
    points: Vec<Entity>,
    steps: u32,
}

/// Steps that were taken, and how long they are.
#[derive(Resource, Default)]
struct Steps {
    taken: u32,
    length: f32,
}

impl Verlet {
    /// Loads `scene`.
    ///
    /// # Errors
    /// [`Failure`] if bodies should rest, or there are more iterations than the crate can count.
    pub fn new(scene: &Scene, options: &SolverOptions) -> Result<Self, Failure> {
        refuse_sleepers("verlet", scene)?;
        // The crate sweeps once more than its setting says.
        let depth = u8::try_from(options.substeps * options.sweeps - 1)
            .map_err(|_| Failure::Peer("verlet takes at most 256 iterations".to_owned()))?;
        let step = Duration::from_secs_f32(STEP);
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, VerletPlugin::default()))
            .insert_resource(Time::<Fixed>::from_duration(step))
            .insert_resource(TimeUpdateStrategy::ManualDuration(step))
            .insert_resource(VerletConfig {
                gravity: Vec3::from_array(GRAVITY.to_array()),
                friction: 0.0,
                sticks_computation_depth: depth,
                parallel_processing: false,
            })
            .init_resource::<Steps>()
            .add_systems(FixedPostUpdate, collide);
        // The first update takes no time and so no step.
        app.update();
        let steps = app.world().resource::<Steps>().taken;
        let mut points = Vec::new();
        for _ in 0..scene.bodies {
            let first = points.len();
            for (i, position) in scene.model.positions.iter().enumerate() {
                let place = Transform::from_translation(Vec3::from_array(position.to_array()));
                let mut entity = app.world_mut().spawn((place, VerletPoint::default()));
                if scene.model.pinned.binary_search(&(i as u32)).is_ok() {
                    entity.insert(VerletLocked);
                }
                points.push(entity.id());
            }
            for &stick in &scene.model.natural_order {
                let [point_a_entity, point_b_entity] = stick.map(|end| points[first + end as usize]);
                let length = scene.model.rest_length(stick);
                app.world_mut().spawn(VerletStick { point_a_entity, point_b_entity, length });
            }
        }
        Ok(Self { app, points, steps })
    }
}

/// Moves points out of the sphere, and counts the step.
fn collide(
    mut points: Query<&mut Transform, (With<VerletPoint>, Without<VerletLocked>)>,
    time: Res<Time>,
    mut steps: ResMut<Steps>,
) {
    for mut place in &mut points {
        if let Some(outside) = out_of_sphere(place.translation) {
            place.translation = outside;
        }
    }
    steps.taken += 1;
    steps.length = time.delta_secs();
}

impl Simulation for Verlet {
    fn step(&mut self) -> Result<Duration, Failure> {
        let time = timed(|| self.app.update());
        self.steps += 1;
        let &Steps { taken, length } = self.app.world().resource();
        if taken != self.steps || (length - STEP).abs() > 1e-6 {
            let reason = format!("verlet took {taken} steps of {length} s instead of {}", self.steps);
            return Err(Failure::Peer(reason));
        }
        Ok(time)
    }

    fn positions(&self) -> Vec<glam::Vec3> {
        let places = self.points.iter().filter_map(|&point| self.app.world().get::<Transform>(point));
        places.map(|place| glam::Vec3::from_array(place.translation.to_array())).collect()
    }

    fn energy(&self) -> Option<f64> {
        None
    }

    fn bytes_per_particle(&self) -> Option<f64> {
        None
    }
}
