//! Keeps the moments of a run that are worth a picture, to be drawn when it is over: the run does not notice.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::scene::{Curtain, STEP};

/// When a picture is taken. Shots are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
enum When {
    /// Seconds after a shot.
    AfterShot(u32, f64),
    /// Seconds after a shot's first touch of the curtain.
    AfterHit(u32, f64),
    /// When the run is over.
    AtTheEnd,
}

/// Where a picture is taken from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// From one place to another.
    Fixed {
        /// The camera's place.
        eye: Vec3,
        /// What is in the middle.
        target: Vec3,
    },
    /// From a place seen from the newest ball, to near that ball.
    Ball {
        /// The camera's place less the ball's.
        eye: Vec3,
        /// What is in the middle, less the ball's place.
        target: Vec3,
    },
}

/// The pictures of a run.
const MOMENTS: [(&str, When, View); 6] = [
    (
        "frame_01_flight",
        When::AfterShot(0, 0.2),
        View::Fixed { eye: Vec3::new(-2.9, 2.1, 16.6), target: Vec3::new(0.25, 1.4, 6.0) },
    ),
    (
        "frame_02_impact",
        When::AfterHit(0, 0.03),
        View::Fixed { eye: Vec3::new(4.4, 2.3, 5.4), target: Vec3::new(0.1, 1.6, 0.0) },
    ),
    (
        "frame_03_pressing",
        When::AfterHit(0, 0.085),
        View::Ball { eye: Vec3::new(2.6, 0.8, 4.6), target: Vec3::new(0.1, 0.25, 0.0) },
    ),
    (
        "frame_04_behind",
        When::AfterHit(0, 0.16),
        View::Fixed { eye: Vec3::new(-4.8, 2.2, -4.6), target: Vec3::new(0.0, 1.5, -0.6) },
    ),
    (
        "frame_05_swinging",
        When::AfterHit(0, 1.5),
        View::Fixed { eye: Vec3::new(-4.9, 2.2, 5.6), target: Vec3::new(0.0, 1.6, 0.0) },
    ),
    (
        "frame_06_at_rest",
        When::AtTheEnd,
        View::Fixed { eye: Vec3::new(-4.6, 2.5, 7.2), target: Vec3::new(0.0, 1.45, 0.0) },
    ),
];

/// The scene at one moment.
pub struct Snapshot {
    /// Name of the picture, without ending.
    pub name: &'static str,
    /// Where it is taken from.
    pub view: View,
    /// The curtain's particles.
    pub particles: Particles,
    /// The curtain's sticks.
    pub sticks: Sticks,
    /// The balls and where they are, oldest first.
    pub balls: Vec<(Projectile, Transform)>,
    /// The cannon and where it is.
    pub cannon: Option<(Cannon, Transform)>,
}

/// What was kept.
#[derive(Resource, Default)]
pub struct Moments {
    shots: Vec<Fired>,
    /// Indices of [`MOMENTS`] that are over.
    done: Vec<usize>,
    /// In the order in which they were taken.
    pub snapshots: Vec<Snapshot>,
}

struct Fired {
    ball: Entity,
    at: f64,
    hit: Option<f64>,
}

/// Keeps [`Moments`].
pub struct MomentsPlugin;

impl Plugin for MomentsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Moments>().add_systems(DrapeSchedule, watch.after(DrapeSystems::Finish));
    }
}

type CurtainQuery<'w, 's> = Query<'w, 's, (&'static Particles, &'static Sticks), With<Curtain>>;
type BallQuery<'w, 's> = Query<'w, 's, (&'static Projectile, &'static Transform)>;
type CannonQuery<'w, 's> = Query<'w, 's, (&'static Cannon, &'static Transform)>;

fn watch(
    mut moments: ResMut<Moments>,
    clock: Res<DrapeClock>,
    mut fired: MessageReader<CannonFired>,
    mut hits: MessageReader<BallHit>,
    curtains: CurtainQuery,
    balls: BallQuery,
    cannons: CannonQuery,
) {
    let moments = &mut *moments;
    let newly_fired =
        fired.read().map(|fired| Fired { ball: fired.projectile, at: clock.elapsed(), hit: None });
    moments.shots.extend(newly_fired);
    for hit in hits.read().filter(|hit| hit.kind == HitTarget::Body) {
        if let Some(shot) = moments.shots.iter_mut().find(|shot| shot.ball == hit.projectile) {
            shot.hit.get_or_insert(hit.time);
        }
    }
    // The clock goes on when the step is over.
    let now = clock.elapsed() + f64::from(clock.delta());
    for (index, (_, when, _)) in MOMENTS.iter().enumerate() {
        let due = match *when {
            When::AfterShot(shot, seconds) => moments.shots.get(shot as usize).map(|shot| shot.at + seconds),
            When::AfterHit(shot, seconds) => {
                moments.shots.get(shot as usize).and_then(|shot| shot.hit).map(|hit| hit + seconds)
            }
            When::AtTheEnd => None,
        };
        // The step that ends nearest to the moment.
        if due.is_some_and(|due| now + 0.5 * STEP >= due) && !moments.done.contains(&index) {
            moments.take(index, &curtains, &balls, &cannons);
        }
    }
}

/// Takes the pictures of the end.
pub fn take_last(
    mut moments: ResMut<Moments>,
    curtains: CurtainQuery,
    balls: BallQuery,
    cannons: CannonQuery,
) {
    for (index, _) in MOMENTS.iter().enumerate().filter(|(_, (_, when, _))| *when == When::AtTheEnd) {
        moments.take(index, &curtains, &balls, &cannons);
    }
}

impl Moments {
    fn take(&mut self, index: usize, curtains: &CurtainQuery, balls: &BallQuery, cannons: &CannonQuery) {
        self.done.push(index);
        let Ok((particles, sticks)) = curtains.single() else {
            return;
        };
        let (name, _, view) = MOMENTS[index];
        let balls = self.shots.iter().filter_map(|shot| balls.get(shot.ball).ok());
        self.snapshots.push(Snapshot {
            name,
            view,
            particles: particles.clone(),
            sticks: sticks.clone(),
            balls: balls.map(|(ball, transform)| (*ball, *transform)).collect(),
            cannon: cannons.iter().next().map(|(cannon, transform)| (*cannon, *transform)),
        });
    }
}

impl Snapshot {
    /// Where the camera is.
    pub fn camera(&self) -> Transform {
        let ball = self.balls.last().map_or(Vec3::Y, |(_, transform)| transform.translation);
        let (eye, target) = match self.view {
            View::Fixed { eye, target } => (eye, target),
            View::Ball { eye, target } => (ball + eye, ball + target),
        };
        Transform::from_translation(eye).looking_at(target, Vec3::Y)
    }
}
