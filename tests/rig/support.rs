//! An app with exact time, whose log can be read.

use std::io;
use std::sync::{Arc, Mutex};

use bevy::ecs::schedule::{LogLevel, ScheduleBuildSettings, SingleThreadedExecutor};
use bevy::log::tracing_subscriber::{self, util::SubscriberInitExt};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::body::{Activity, DefaultBodySurface, DefaultSolverSettings};
use bevy_drape::prelude::*;
use bevy_drape::rig::{InRig, Particle, Stick};
use bevy_drape::schedule::DrapeSchedule;

/// Length of a step in seconds.
pub const STEP: f32 = 1.0 / 60.0;

/// An app that takes one step of 1/60 s per update.
pub struct Rigs {
    pub app: App,
    log: Log,
    _logging: Box<dyn std::any::Any>,
}

#[derive(Clone, Default)]
struct Log(Arc<Mutex<Vec<u8>>>);

impl io::Write for Log {
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        self.0.lock().expect("no writer panicked").extend_from_slice(text);
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Rigs {
    /// Without drag, so that the laws of free motion hold exactly.
    pub fn new() -> Self {
        Self::with_drag(0.0)
    }

    pub fn with_drag(drag: f32) -> Self {
        Self::with_settings(drag, SolverSettings::default())
    }

    pub fn with_settings(drag: f32, settings: SolverSettings) -> Self {
        let log = Log::default();
        let writer = log.clone();
        let logging = tracing_subscriber::fmt()
            .with_ansi(false)
            .with_writer(move || writer.clone())
            .finish()
            .set_default();
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
            .insert_resource(Time::<Fixed>::from_hz(60.0))
            .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
            .insert_resource(DefaultSolverSettings(settings))
            .insert_resource(DefaultBodySurface(BodySurface { drag, ..default() }));
        app.edit_schedule(DrapeSchedule, |schedule| {
            // The log is that of this thread.
            schedule.set_executor(SingleThreadedExecutor::new());
            schedule.set_build_settings(ScheduleBuildSettings {
                ambiguity_detection: LogLevel::Error,
                ..default()
            });
        });
        // The first update takes no step.
        app.update();
        Self { app, log, _logging: Box::new(logging) }
    }

    pub fn weightless() -> Self {
        let mut rigs = Self::new();
        rigs.app.insert_resource(DrapeGravity(Vec3::ZERO));
        rigs
    }

    pub fn steps(&mut self, count: u32) {
        for _ in 0..count {
            self.app.update();
        }
    }

    pub fn seconds(&mut self, seconds: f32) {
        self.steps((seconds / STEP).round() as u32);
    }

    pub fn spawn(&mut self, bundle: impl Bundle) -> Entity {
        self.app.world_mut().spawn(bundle).id()
    }

    pub fn spawn_empty(&mut self) -> Entity {
        self.app.world_mut().spawn_empty().id()
    }

    pub fn free(&mut self, mass: f32, place: Vec3) -> Entity {
        self.spawn((Particle::new(mass), Transform::from_translation(place)))
    }

    pub fn pin(&mut self, place: Vec3) -> Entity {
        self.spawn((Particle::pinned(), Transform::from_translation(place)))
    }

    pub fn join(&mut self, a: Entity, b: Entity) -> Entity {
        self.spawn(Stick::new(a, b))
    }

    /// Particles in a row, joined by sticks; the ends pinned as asked.
    pub fn chain(&mut self, from: Vec3, to: Vec3, count: usize, pinned: [bool; 2]) -> Vec<Entity> {
        let particles: Vec<Entity> = (0..count)
            .map(|i| {
                let place = from.lerp(to, i as f32 / (count - 1) as f32);
                let is_pinned = (i == 0 && pinned[0]) || (i == count - 1 && pinned[1]);
                if is_pinned { self.pin(place) } else { self.free(0.1, place) }
            })
            .collect();
        for pair in particles.windows(2) {
            self.join(pair[0], pair[1]);
        }
        particles
    }

    pub fn edit<C: Component<Mutability = bevy::ecs::component::Mutable>>(
        &mut self,
        entity: Entity,
        edit: impl FnOnce(&mut C),
    ) {
        let mut component = self.app.world_mut().get_mut::<C>(entity).expect("the entity has the component");
        edit(&mut component);
    }

    pub fn despawn(&mut self, entity: Entity) {
        self.app.world_mut().despawn(entity);
    }

    /// The entity's translation, as written by the plugin.
    pub fn place(&self, entity: Entity) -> Vec3 {
        self.app.world().get::<Transform>(entity).expect("particles have transforms").translation
    }

    /// The entity's global translation, up to date after an update.
    pub fn global(&self, entity: Entity) -> Vec3 {
        self.app.world().get::<GlobalTransform>(entity).expect("particles have transforms").translation()
    }

    pub fn in_rig(&self, particle: Entity) -> Option<InRig> {
        self.app.world().get::<InRig>(particle).copied()
    }

    /// The body that the particle is simulated in.
    pub fn body(&self, particle: Entity) -> Entity {
        self.in_rig(particle).expect("the particle is simulated").body
    }

    pub fn velocity(&self, particle: Entity) -> Vec3 {
        let InRig { body, index } = self.in_rig(particle).expect("the particle is simulated");
        self.app.world().get::<Particles>(body).expect("a rig has columns").velocity(index)
    }

    pub fn activity(&self, particle: Entity) -> Activity {
        *self.app.world().get::<Activity>(self.body(particle)).expect("a rig has an activity")
    }

    /// All entities with a `C`.
    pub fn all<C: Component>(&mut self) -> Vec<Entity> {
        self.app.world_mut().query_filtered::<Entity, With<C>>().iter(self.app.world()).collect()
    }

    pub fn count<C: Component>(&mut self) -> usize {
        self.all::<C>().len()
    }

    /// The lines logged so far that hold all of `words`.
    pub fn logged(&self, words: &[&str]) -> Vec<String> {
        let text = self.log.0.lock().expect("no writer panicked").clone();
        let text = String::from_utf8(text).expect("the log is text");
        let lines = text.lines().filter(|line| words.iter().all(|word| line.contains(word)));
        lines.map(str::to_owned).collect()
    }

    #[track_caller]
    pub fn assert_no_errors(&self) {
        assert_eq!(self.logged(&["ERROR"]), Vec::<String>::new());
    }
}

#[track_caller]
pub fn assert_near(found: Vec3, expected: Vec3, tolerance: f32) {
    assert!(found.distance(expected) <= tolerance, "{found} is not within {tolerance} of {expected}");
}
