//! Records an app step by step.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::Sticks;
use bevy_drape::clock::DrapeClock;
use bevy_drape::drape_solver::{StickBatch, StickKind, Topology};
use bevy_drape::prelude::*;
use bevy_drape::schedule::DrapeSchedule;
use bevy_drape::snapshot::{Key, members};

use super::error::RecordingError;
use super::packet::Header;
use super::recorder::{Recorder, Sample};
use super::track::{Form, Track, TrackKind};

/// Records every step of an app between [`start`](Self::start) and [`finish`](Self::finish).
///
/// ```no_run
/// # use bevy::prelude::*;
/// use bevy_drape_script::recording::{Header, RecordSteps, RecordingError};
///
/// # fn run(app: &mut App) -> Result<(), RecordingError> {
/// let header = Header { scene: "curtain".into(), dt: 1.0 / 60.0 };
/// RecordSteps::create("curtain.drape", header)?.start(app);
/// for _ in 0..600 {
///     app.update();
/// }
/// RecordSteps::finish(app.world_mut())
/// # }
/// ```
#[derive(Resource)]
pub struct RecordSteps {
    recorder: Recorder<Box<dyn Write + Send + Sync>>,
    /// The error that stopped it.
    fault: Option<RecordingError>,
}

/// Marks an app to which the recording system was added.
#[derive(Resource)]
struct IsAdded;

impl RecordSteps {
    /// Records to `writer`.
    ///
    /// # Errors
    /// [`RecordingError::Unwritable`] if the writer fails.
    pub fn new(writer: impl Write + Send + Sync + 'static, header: Header) -> Result<Self, RecordingError> {
        let writer: Box<dyn Write + Send + Sync> = Box::new(writer);
        Ok(Self { recorder: Recorder::new(writer, header)?, fault: None })
    }

    /// Records to a file at `path`, which is overwritten if it exists.
    ///
    /// # Errors
    /// [`RecordingError::Unwritable`] if the file cannot be made.
    pub fn create(path: impl AsRef<Path>, header: Header) -> Result<Self, RecordingError> {
        Self::new(BufWriter::new(File::create(path)?), header)
    }

    /// Records the app's steps from now on.
    pub fn start(self, app: &mut App) {
        app.insert_resource(self);
        if !app.world().contains_resource::<IsAdded>() {
            app.insert_resource(IsAdded);
            app.add_systems(
                DrapeSchedule,
                record_step.after(DrapeSystems::Finish).run_if(resource_exists::<Self>),
            );
        }
    }

    /// The number of steps recorded so far.
    pub fn frames(&self) -> u64 {
        self.recorder.frames()
    }

    /// Ends the recording, if there is one.
    ///
    /// # Errors
    /// The error that stopped the recording, or [`RecordingError::Unwritable`].
    pub fn finish(world: &mut World) -> Result<(), RecordingError> {
        let Some(Self { recorder, fault }) = world.remove_resource::<Self>() else { return Ok(()) };
        match fault {
            Some(fault) => Err(fault),
            None => recorder.finish().map(drop),
        }
    }
}

fn record_step(world: &mut World) {
    let mut keys = members(world);
    keys.retain(|&(_, entity)| !world.entity(entity).contains::<Disabled>());
    world.resource_scope(|world, mut steps: Mut<RecordSteps>| {
        let RecordSteps { recorder, fault } = &mut *steps;
        if fault.is_none() {
            let clock = world.resource::<DrapeClock>();
            // The clock advances after the last system of the step.
            let time = clock.elapsed() + f64::from(clock.delta());
            let samples = keys.iter().filter_map(|&(key, entity)| sample(world.entity(entity), key));
            *fault = recorder.push(time, samples.collect()).err();
        }
    });
}

/// The current state of an entity.
fn sample(entity: EntityRef<'_>, key: Key) -> Option<Sample<'_>> {
    let id = entity.id().to_bits();
    let name = move |noun: &str, order: u64| {
        entity.get::<Name>().map_or_else(|| format!("{noun} {order}"), ToString::to_string)
    };
    Some(match key {
        Key::Body(order) => {
            let (particles, sticks) = (entity.get::<Particles>()?, entity.get::<Sticks>()?);
            let describe = move || Track { name: name("body", order), kind: body_kind(&sticks.0) };
            let positions = particles.local_positions().map(|place| place.to_array());
            Sample::body(id, describe, particles.origin().to_array(), positions)
        }
        Key::Ball(order) => {
            let ball = entity.get::<ProjectileState>()?;
            let kind = TrackKind::Ball { radius: ball.material().radius };
            let values = ball.position().to_array().into_iter().chain(ball.rotation().to_array());
            let describe = Box::new(move || Track { name: name("ball", order), kind });
            Sample { id, describe, values: values.collect() }
        }
        Key::Obstacle(order) => {
            let (obstacle, place) = (entity.get::<Obstacle>()?, entity.get::<GlobalTransform>()?);
            let shape = obstacle.shape.solid(entity.get()).ok().flatten()?;
            let kind = TrackKind::Obstacle { form: Form::of(&shape) };
            let describe = Box::new(move || Track { name: name("obstacle", order), kind });
            Sample { id, describe, values: place.affine().to_cols_array().to_vec() }
        }
    })
}

fn body_kind(topology: &Topology) -> TrackKind {
    // Of a cut face, the side that has the greater part of it, if there is one.
    let mut shares = vec![1.0; topology.faces().len()];
    topology.face_parts().iter().for_each(|part| shares[part.face as usize] = 0.0);
    topology.face_parts().iter().for_each(|part| shares[part.face as usize] += part.share());
    let faces = topology.faces().iter().zip(shares).filter(|&(_, share)| share > 0.499);
    let mut faces: Vec<[u32; 3]> = faces.map(|(&face, _)| face).collect();
    if faces.is_empty() {
        faces = topology.faces().to_vec();
    }
    let structural = topology.batches().iter().filter(|batch| batch.material.kind == StickKind::Structural);
    let sticks = if faces.is_empty() {
        structural.flat_map(StickBatch::range).map(|i| topology.stick(i)).collect()
    } else {
        Vec::new()
    };
    TrackKind::Body { particles: topology.particle_count() as u32, faces, sticks }
}
