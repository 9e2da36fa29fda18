//! Captures the frames of a run that become pictures. They are drawn after the run, which they do not change.

use bevy::prelude::*;
use bevy_drape::body::Sticks;
use bevy_drape::cannon::{Cannon, CannonFired};
use bevy_drape::clock::DrapeClock;
use bevy_drape::contact::{BallHit, HitTarget};
use bevy_drape::prelude::*;
use bevy_drape::schedule::DrapeSchedule;

use crate::cannon_demo::scene::{Curtain, STEP};
use crate::cannon_demo::views::{BEHIND, CANNON, LEFT, RIGHT, View};

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

/// The viewpoint of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrameView {
    /// A fixed camera.
    Fixed(View),
    /// A camera placed relative to the newest ball.
    Ball(View),
}

/// The pictures of a run.
const FRAMES: [(&str, When, FrameView); 6] = [
    ("frame_01_flight", When::AfterShot(0, 0.2), FrameView::Fixed(CANNON)),
    ("frame_02_impact", When::AfterHit(0, 0.03), FrameView::Fixed(RIGHT)),
    (
        "frame_03_pressing",
        When::AfterHit(0, 0.085),
        FrameView::Ball(View { eye: Vec3::new(2.6, 0.8, 4.6), target: Vec3::new(0.1, 0.25, 0.0) }),
    ),
    ("frame_04_behind", When::AfterHit(0, 0.16), FrameView::Fixed(BEHIND)),
    ("frame_05_swinging", When::AfterHit(0, 1.5), FrameView::Fixed(LEFT)),
    (
        "frame_06_at_rest",
        When::AtTheEnd,
        FrameView::Fixed(View { eye: Vec3::new(-4.6, 2.5, 7.2), target: Vec3::new(0.0, 1.45, 0.0) }),
    ),
];

/// The state of the scene for one picture.
pub struct CapturedFrame {
    /// Name of the picture, without ending.
    pub name: &'static str,
    /// The viewpoint.
    pub view: FrameView,
    /// The curtain's particles.
    pub particles: Particles,
    /// The curtain's sticks.
    pub sticks: Sticks,
    /// The balls and where they are, oldest first.
    pub balls: Vec<(Projectile, Transform)>,
    /// The cannon and where it is.
    pub cannon: Option<(Cannon, Transform)>,
}

/// The frames that were captured so far.
#[derive(Resource, Default)]
pub struct CapturedFrames {
    shots: Vec<Fired>,
    /// Indices of the [`FRAMES`] that were captured.
    done: Vec<usize>,
    /// In the order in which they were taken.
    pub frames: Vec<CapturedFrame>,
}

struct Fired {
    ball: Entity,
    at: f64,
    hit: Option<f64>,
}

/// Fills [`CapturedFrames`].
pub struct FrameCapturePlugin;

impl Plugin for FrameCapturePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<CapturedFrames>().add_systems(DrapeSchedule, watch.after(DrapeSystems::Finish));
    }
}

type CurtainQuery<'w, 's> = Query<'w, 's, (&'static Particles, &'static Sticks), With<Curtain>>;
type BallQuery<'w, 's> = Query<'w, 's, (&'static Projectile, &'static Transform)>;
type CannonQuery<'w, 's> = Query<'w, 's, (&'static Cannon, &'static Transform)>;

fn watch(
    mut captured: ResMut<CapturedFrames>,
    clock: Res<DrapeClock>,
    mut fired: MessageReader<CannonFired>,
    mut hits: MessageReader<BallHit>,
    curtains: CurtainQuery,
    balls: BallQuery,
    cannons: CannonQuery,
) {
    let captured = &mut *captured;
    let newly_fired =
        fired.read().map(|fired| Fired { ball: fired.projectile, at: clock.elapsed(), hit: None });
    captured.shots.extend(newly_fired);
    for hit in hits.read().filter(|hit| hit.kind == HitTarget::Body) {
        if let Some(shot) = captured.shots.iter_mut().find(|shot| shot.ball == hit.projectile) {
            shot.hit.get_or_insert(hit.time);
        }
    }
    // The clock goes on when the step is over.
    let now = clock.elapsed() + f64::from(clock.delta());
    for (index, (_, when, _)) in FRAMES.iter().enumerate() {
        let due = match *when {
            When::AfterShot(shot, seconds) => captured.shots.get(shot as usize).map(|shot| shot.at + seconds),
            When::AfterHit(shot, seconds) => {
                captured.shots.get(shot as usize).and_then(|shot| shot.hit).map(|hit| hit + seconds)
            }
            When::AtTheEnd => None,
        };
        // The step that ends nearest to the due time.
        if due.is_some_and(|due| now + 0.5 * STEP >= due) && !captured.done.contains(&index) {
            captured.capture(index, &curtains, &balls, &cannons);
        }
    }
}

/// Takes the pictures of the end.
pub fn capture_last(
    mut captured: ResMut<CapturedFrames>,
    curtains: CurtainQuery,
    balls: BallQuery,
    cannons: CannonQuery,
) {
    for (index, _) in FRAMES.iter().enumerate().filter(|(_, (_, when, _))| *when == When::AtTheEnd) {
        captured.capture(index, &curtains, &balls, &cannons);
    }
}

impl CapturedFrames {
    fn capture(&mut self, index: usize, curtains: &CurtainQuery, balls: &BallQuery, cannons: &CannonQuery) {
        self.done.push(index);
        let Ok((particles, sticks)) = curtains.single() else {
            return;
        };
        let (name, _, view) = FRAMES[index];
        let balls = self.shots.iter().filter_map(|shot| balls.get(shot.ball).ok());
        self.frames.push(CapturedFrame {
            name,
            view,
            particles: particles.clone(),
            sticks: sticks.clone(),
            balls: balls.map(|(ball, transform)| (*ball, *transform)).collect(),
            cannon: cannons.iter().next().map(|(cannon, transform)| (*cannon, *transform)),
        });
    }
}

impl CapturedFrame {
    /// The place of the camera.
    pub fn camera(&self) -> Transform {
        let ball = self.balls.last().map_or(Vec3::Y, |(_, transform)| transform.translation);
        let view = match self.view {
            FrameView::Fixed(view) => view,
            FrameView::Ball(View { eye, target }) => View { eye: ball + eye, target: ball + target },
        };
        view.camera()
    }
}
