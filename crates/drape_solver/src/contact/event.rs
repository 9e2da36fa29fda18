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

/// One side of a [`Contact`], by index in the island.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Party {
    /// A body.
    Body(usize),
    /// A ball.
    Ball(usize),
}

/// What of a body touched, by index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Feature {
    /// A particle.
    Particle(usize),
    /// A face of the topology.
    Face(usize),
}

/// What happened between two over one step, for those that [ask](crate::Body::reports_contacts) for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The body or ball that touched something; of a body and a ball, the ball; of two bodies or two balls, the first.
    pub party: Party,
    /// What it touched.
    pub other: Other,
    /// When in the step they first touched, in seconds from its start. Interpolated within the substep for balls; the
    /// start of the substep for particles and sensors.
    pub time: f32,
    /// Point of the other's surface, in the world: of a body, where it was pushed the hardest; of a ball, where they first
    /// touched; in a sensor, where the first particle or the ball's centre was found.
    pub point: Vec3,
    /// Unit normal there, from the other towards the party. In a sensor, from its middle to the point.
    pub normal: Vec3,
    /// Sum of the sizes of all normal impulses over the step, in newton seconds; 0 for a sensor.
    pub impulse: f32,
    /// The part of the body at that point: of two bodies, of the party. None between a ball and another or an obstacle.
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

/// What is left of an index once `gone` was taken out of the list, with those behind it moving up. None if it is the one.
fn moved_up(index: usize, gone: usize) -> Option<usize> {
    (index != gone).then(|| index - usize::from(index > gone))
}

impl Other {
    /// The same thing once `gone` was taken out of the island; none if it is that.
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

/// The two sides of a contact once `gone` was taken out of the island; none if it was one of them.
pub(crate) fn pair_without((party, other): (Party, Other), gone: Other) -> Option<(Party, Other)> {
    Some((party.without(gone)?, other.without(gone)?))
}

/// One projection of a ball against something: what [`record`] makes touches of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BallProjection {
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

/// Whether the two have touched in this step already.
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
