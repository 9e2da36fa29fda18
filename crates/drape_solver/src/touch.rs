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
    /// Normal impulse in newton seconds.
    pub impulse: f32,
}

/// Adds a projection to the step's touches. The moment of first contact is interpolated between the gap at
/// the start of the substep and the one now:
///
/// ```text
///   gap  \
///   ------\--------- 0      fraction = before / (before - now)
///          \
/// ```
pub(crate) fn record(touches: &mut Vec<Touch>, projection: &Projection, substep_index: u32, substep: f32) {
    let p = projection;
    if let Some(touch) = touches.iter_mut().find(|t| t.ball == p.ball && t.other == p.other) {
        touch.impulse += p.impulse;
        return;
    }
    let before = p.gap - p.gap_change;
    let fraction = if before > 0.0 { before / (before - p.gap) } else { 0.0 };
    touches.push(Touch {
        ball: p.ball,
        other: p.other,
        time: (substep_index as f32 + fraction) * substep,
        ball_position: p.ball_position - p.ball_travel * (1.0 - fraction),
        ball_velocity: p.ball_travel / substep,
        point: p.point,
        normal: p.normal,
        impulse: p.impulse,
    });
}
