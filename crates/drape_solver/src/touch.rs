//! What touched what in a step, for events and reports.

use glam::Vec3;

/// The other side of a ball's contact, by index in the island or the environment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Other {
    /// A body of the island.
    Body(usize),
    /// Another ball of the island.
    Ball(usize),
    /// An obstacle of the environment.
    Obstacle(usize),
}

/// A contact between a ball and something else, over one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The ball, by index in the island.
    pub ball: usize,
    /// What it touched.
    pub other: Other,
    /// When in the step they first touched, in seconds from its start: interpolated within the substep.
    pub time: f32,
    /// Where the ball's centre was at that time, in the world.
    pub ball_position: Vec3,
    /// The ball's velocity before the contact acted, in m/s.
    pub ball_velocity: Vec3,
    /// Point of the other's surface, in the world.
    pub point: Vec3,
    /// Unit normal, from the other towards the ball.
    pub normal: Vec3,
    /// Size of the normal impulse on the ball over the step, in newton seconds.
    pub impulse: f32,
}

/// One projection of a ball against something: what [`record`] makes touches of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projection {
    pub ball: usize,
    pub other: Other,
    /// Gap between the surfaces before the projection, negative, in metres.
    pub gap: f32,
    /// How much the gap changed in this substep so far by the motion of both, in metres.
    pub gap_change: f32,
    pub ball_position: Vec3,
    pub ball_travel: Vec3,
    pub point: Vec3,
    pub normal: Vec3,
}

impl Projection {
    /// The part of the substep after which the two first met, interpolated between the gap at its start and now:
    ///
    /// ```text
    ///   gap  \
    ///   ------\--------- 0      fraction = before / (before - now)
    ///          \
    /// ```
    pub fn fraction(&self) -> f32 {
        let before = self.gap - self.gap_change;
        if before > 0.0 { before / (before - self.gap) } else { 0.0 }
    }
}

/// Whether the two have touched in this step already.
pub(crate) fn is_known(touches: &[Touch], ball: usize, other: Other) -> bool {
    touches.iter().any(|touch| touch.ball == ball && touch.other == other)
}

/// Begins the touch of a projection, at the interpolated moment of first contact.
pub(crate) fn begin(touches: &mut Vec<Touch>, p: &Projection, substep_index: u32, substep: f32) {
    let fraction = p.fraction();
    touches.push(Touch {
        ball: p.ball,
        other: p.other,
        time: (substep_index as f32 + fraction) * substep,
        ball_position: p.ball_position - p.ball_travel * (1.0 - fraction),
        ball_velocity: p.ball_travel / substep,
        point: p.point,
        normal: p.normal,
        impulse: 0.0,
    });
}

/// Adds a normal impulse (newton seconds) to a touch that has begun.
pub(crate) fn add_impulse(touches: &mut [Touch], ball: usize, other: Other, impulse: f32) {
    if let Some(touch) = touches.iter_mut().find(|touch| touch.ball == ball && touch.other == other) {
        touch.impulse += impulse;
    }
}

/// Adds a projection with its normal impulse (newton seconds) to the step's touches.
pub(crate) fn record(touches: &mut Vec<Touch>, p: &Projection, impulse: f32, index: u32, substep: f32) {
    if !is_known(touches, p.ball, p.other) {
        begin(touches, p, index, substep);
    }
    add_impulse(touches, p.ball, p.other, impulse);
}
