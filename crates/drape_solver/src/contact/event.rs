//! The contacts of a step, for events and reports.
//!
//! Design: `docs/design/contact_reports.md`.

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

/// One side of a [`Contact`], by index in the island.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Party {
    /// A body.
    Body(usize),
    /// A ball.
    Ball(usize),
}

/// The part of a body that touched something, by index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Feature {
    /// A particle.
    Particle(usize),
    /// A face of the topology.
    Face(usize),
}

/// The contact of two over one step, if one of them [asks](crate::Body::reports_contacts) for reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The body or ball that touched something; of a body and a ball, the ball; of two bodies or two balls, the first.
    pub party: Party,
    /// The other side of the contact.
    pub other: Other,
    /// Time of first contact in seconds from the start of the step: interpolated within the substep for balls; the
    /// start of the substep for particles and sensors.
    pub time: f32,
    /// Point on the other's surface, in the world: for a body, the place of the hardest push; for a ball, the place of
    /// first contact; for a sensor, the place of the first particle or of the ball's centre inside it.
    pub point: Vec3,
    /// Unit normal there, from the other towards the party. In a sensor, from its middle to the point.
    pub normal: Vec3,
    /// Sum of the sizes of all normal impulses over the step, in newton seconds; 0 for a sensor.
    pub impulse: f32,
    /// The part of the body at that point; with two bodies, the part of the party. None between a ball and another or
    /// an obstacle.
    pub feature: Option<Feature>,
}

impl Contact {
    /// The two sides.
    pub fn pair(&self) -> (Party, Other) {
        (self.party, self.other)
    }
}

/// A contact between a ball and something else, over one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The ball, by index in the island.
    pub ball: usize,
    /// The other side of the contact.
    pub other: Other,
    /// Time of first contact in seconds from the start of the step, interpolated within the substep.
    pub time: f32,
    /// Position of the ball's centre at that time, in the world.
    pub ball_position: Vec3,
    /// The ball's velocity before the contact acted, in m/s.
    pub ball_velocity: Vec3,
    /// Point on the other's surface, in the world.
    pub point: Vec3,
    /// Unit normal, from the other towards the ball.
    pub normal: Vec3,
    /// Size of the normal impulse on the ball over the step, in newton seconds.
    pub impulse: f32,
}

/// The index after the element `gone` was taken out of the list; none for that element.
fn moved_up(index: usize, gone: usize) -> Option<usize> {
    (index != gone).then(|| index - usize::from(index > gone))
}

impl Other {
    /// The same thing after `gone` was taken out of the island; none for `gone` itself.
    fn without(self, gone: Self) -> Option<Self> {
        match (self, gone) {
            (Self::Body(i), Self::Body(gone)) => moved_up(i, gone).map(Self::Body),
            (Self::Ball(i), Self::Ball(gone)) => moved_up(i, gone).map(Self::Ball),
            (Self::Obstacle(i), Self::Obstacle(gone)) => moved_up(i, gone).map(Self::Obstacle),
            _ => Some(self),
        }
    }
}

impl Party {
    /// As [`Other::without`].
    fn without(self, gone: Other) -> Option<Self> {
        match (self, gone) {
            (Self::Body(i), Other::Body(gone)) => moved_up(i, gone).map(Self::Body),
            (Self::Ball(i), Other::Ball(gone)) => moved_up(i, gone).map(Self::Ball),
            _ => Some(self),
        }
    }
}

/// The two sides of a contact after `gone` was taken out of the island; none if it was one of them.
pub(crate) fn pair_without((party, other): (Party, Other), gone: Other) -> Option<(Party, Other)> {
    Some((party.without(gone)?, other.without(gone)?))
}

/// One projection of a ball out of something. [`record`] turns it into a touch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BallProjection {
    pub ball: usize,
    pub other: Other,
    /// Gap between the surfaces before the projection, negative, in metres.
    pub gap: f32,
    /// Metres by which the motion of both has changed the gap in this substep so far.
    pub gap_change: f32,
    pub ball_position: Vec3,
    pub ball_travel: Vec3,
    pub point: Vec3,
    pub normal: Vec3,
}

impl BallProjection {
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

/// True if the two have already touched in this step.
pub(crate) fn is_known(touches: &[Touch], ball: usize, other: Other) -> bool {
    touches.iter().any(|touch| touch.ball == ball && touch.other == other)
}

/// Begins the touch of a projection, at the interpolated moment of first contact.
pub(crate) fn begin(touches: &mut Vec<Touch>, p: &BallProjection, substep_index: u32, substep: f32) {
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
pub(crate) fn record(touches: &mut Vec<Touch>, p: &BallProjection, impulse: f32, index: u32, substep: f32) {
    if !is_known(touches, p.ball, p.other) {
        begin(touches, p, index, substep);
    }
    add_impulse(touches, p.ball, p.other, impulse);
}
