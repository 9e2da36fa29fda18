//! The order of a substep: all of its stages, once, as data.
//!
//! ```text
//! integrate            INTEGRATE
//! relax                [ ROPES, CONTACTS, STICKS ] x N, RELAXED
//! project collisions   CLOTH, CONTACTS, VELOCITIES
//! ```
//!
//! An island walks the list [stage by stage](crate::stages), so that a schedule may run systems of its own between the
//! three phases: integrate, relax, project collisions. A body that nothing but obstacles can touch walks the same list in
//! [sweeps](crate::substep::sweep) down its strips: its [plan](crate::substep::plan) is made from this list.
//!
//! To add a stage, add it here and to `run_body_stage` or `run_island_stage` of `stages.rs`. If it runs strip by strip, add it to
//! `Plan::make` in `plan.rs` and write its code in `work.rs`. If not, sweeps leave it out: have `can_be_swept` refuse what needs
//! it (of `sweep.rs` for a body, of `step.rs` for an island).
//!
//! Design: `docs/design/relaxation.md`.

/// A stage of a substep that one body takes by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BodyStage {
    /// Kinematic pins go one substep further.
    MovePins,
    /// Free flight.
    Integrate,
    /// The moving frame takes the particles along.
    Carry,
    /// Drives draw particles towards their animated places.
    Drive,
    /// Pins get the displacement of their move.
    NotePins,
    /// Particles that are joined to movers go where these fly.
    BeginJoints,
    /// Contacts of faces follow their deepest points; all of them forget the last substep.
    BeginContacts,
    FaceContacts,
    EmbeddedContacts,
    ObstacleContacts,
    DynamicContacts,
    /// Particles that are joined to movers have the masses of these while sticks are relaxed.
    ReleaseJoints,
    /// Meshes and torn grids resist curvature in the last iteration, before the sticks, so that these have the last word. Lines of grids do
    /// later.
    Bends,
    Sticks,
    Tethers,
    /// Rows, columns, diagonals and ropes that are solved directly, in the last iteration: bends, then sticks.
    Lines,
    Volume,
    /// They pull at the movers, and go where these are.
    PullJoints,
    AngularMomentum,
    /// Movers get what rounding has kept of the pull of sticks.
    BalanceJoints,
    /// Displacements follow positions.
    Update,
    Damping,
    ObstacleFriction,
    FaceFriction,
    EmbeddedFriction,
    DynamicFriction,
    /// Joined particles go where friction and balls have left the movers.
    FollowJoints,
    /// Limits on motion come last, and backstops, which heed them.
    Limits,
    Backstops,
    /// The motion of the frame is subtracted from the displacements.
    Leave,
    /// The watch notes how far particles are off their ways.
    Watch,
}

/// A stage of a substep that concerns the whole island.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum IslandStage {
    /// Surfaces note where they are, before anything moves.
    NoteStarts,
    BeginMovers,
    IntegrateBalls,
    BeginContacts,
    /// Ropes against themselves and each other: one turn of a knot holds all that hangs on it, so they are projected in
    /// each iteration.
    RopeContacts,
    /// Cloth against cloth and the obstacles below, in turn: expensive, and as good once a substep, after the sticks.
    ClothContacts,
    BallClothContacts,
    BallBallContacts,
    BallObstacleContacts,
    UpdateBalls,
    Rebound,
    BallFriction,
    ImpactZones,
    TurnBalls,
    Account,
    /// Surfaces are kept from passing through each other, whatever came before.
    KeepApart,
}

/// Stages that follow each other: of the island, or of each body by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stages {
    Island(IslandStage),
    Bodies(&'static [BodyStage]),
}

/// The order of a substep, in named spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Order {
    pub integrate: &'static [Stages],
    pub ropes: &'static [Stages],
    pub contacts: &'static [Stages],
    pub sticks: &'static [Stages],
    pub relaxed: &'static [Stages],
    pub cloth: &'static [Stages],
    pub velocities: &'static [Stages],
}

use BodyStage as Body;
use IslandStage as Island;

/// Bodies, balls and obstacles fly freely.
const INTEGRATE: &[Stages] = &[
    Stages::Island(Island::NoteStarts),
    Stages::Island(Island::BeginMovers),
    Stages::Bodies(&[
        Body::MovePins,
        Body::Integrate,
        Body::Carry,
        Body::Drive,
        Body::NotePins,
        Body::BeginJoints,
        Body::BeginContacts,
    ]),
    Stages::Island(Island::IntegrateBalls),
    Stages::Island(Island::BeginContacts),
];

const ROPES: &[Stages] = &[Stages::Island(Island::RopeContacts)];

/// Everything that touches, once.
const CONTACTS: &[Stages] = &[
    Stages::Island(Island::BallClothContacts),
    Stages::Island(Island::BallBallContacts),
    Stages::Island(Island::BallObstacleContacts),
    Stages::Bodies(&[
        Body::FaceContacts,
        Body::EmbeddedContacts,
        Body::ObstacleContacts,
        Body::DynamicContacts,
    ]),
];

/// All constraints of a body on itself, once.
const STICKS: &[Stages] = &[Stages::Bodies(&[
    Body::ReleaseJoints,
    Body::Bends,
    Body::Sticks,
    Body::Tethers,
    Body::Lines,
    Body::Volume,
    Body::PullJoints,
])];

const RELAXED: &[Stages] = &[Stages::Bodies(&[Body::AngularMomentum])];

const CLOTH: &[Stages] = &[Stages::Island(Island::ClothContacts)];

/// Velocities follow positions; then come friction, restitution, impact zones, limits and backstops.
const VELOCITIES: &[Stages] = &[
    Stages::Bodies(&[
        Body::BalanceJoints,
        Body::Update,
        Body::Damping,
        Body::ObstacleFriction,
        Body::FaceFriction,
        Body::EmbeddedFriction,
        Body::DynamicFriction,
    ]),
    Stages::Island(Island::UpdateBalls),
    Stages::Island(Island::Rebound),
    Stages::Island(Island::BallFriction),
    Stages::Island(Island::ImpactZones),
    Stages::Island(Island::TurnBalls),
    Stages::Island(Island::Account),
    Stages::Bodies(&[Body::FollowJoints, Body::Limits, Body::Backstops, Body::Leave, Body::Watch]),
    Stages::Island(Island::KeepApart),
];

impl Default for Order {
    fn default() -> Self {
        Self {
            integrate: INTEGRATE,
            ropes: ROPES,
            contacts: CONTACTS,
            sticks: STICKS,
            relaxed: RELAXED,
            cloth: CLOTH,
            velocities: VELOCITIES,
        }
    }
}

/// A span of the list, with the number of the projection of contacts and sticks that its stages belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    pub stages: &'static [Stages],
    pub projection: u32,
    /// The number of stages of a body before this span.
    pub first: usize,
}

impl Order {
    /// Free flight.
    pub fn integrate(self) -> [Span; 1] {
        [Span { stages: self.integrate, projection: 0, first: 0 }]
    }

    /// One iteration of contacts and sticks, by its number.
    pub fn iteration(self, index: u32) -> [Span; 3] {
        let parts = [self.ropes, self.contacts, self.sticks];
        let length: usize = parts.into_iter().map(body_stages).sum();
        spans(parts, index, body_stages(self.integrate) + index as usize * length)
    }

    /// The end of a relaxation of this many iterations.
    pub fn relaxed(self, iterations: u32) -> [Span; 1] {
        spans([self.relaxed], iterations, self.iteration(iterations)[0].first)
    }

    /// Contacts once more, and all that follows from them.
    pub fn project_collisions(self, iterations: u32) -> [Span; 3] {
        let first = self.relaxed(iterations)[0].first + body_stages(self.relaxed);
        spans([self.cloth, self.contacts, self.velocities], iterations, first)
    }

    /// The stages of one body through a whole substep of this many iterations, each with the number of its projection.
    pub fn of_body(self, iterations: u32) -> impl Iterator<Item = (BodyStage, u32)> {
        let relax = (0..iterations).flat_map(move |index| self.iteration(index));
        let all = self.integrate().into_iter().chain(relax).chain(self.relaxed(iterations));
        all.chain(self.project_collisions(iterations)).flat_map(|span| {
            let of_bodies = |stages: &'static Stages| match stages {
                Stages::Bodies(stages) => *stages,
                Stages::Island(_) => &[],
            };
            span.stages.iter().flat_map(of_bodies).map(move |&stage| (stage, span.projection))
        })
    }
}

fn spans<const N: usize>(parts: [&'static [Stages]; N], projection: u32, mut first: usize) -> [Span; N] {
    parts.map(|stages| {
        let span = Span { stages, projection, first };
        first += body_stages(stages);
        span
    })
}

/// The number of stages that a body takes in a part of the list.
fn body_stages(stages: &[Stages]) -> usize {
    let count = |stages: &Stages| match stages {
        Stages::Bodies(stages) => stages.len(),
        Stages::Island(_) => 0,
    };
    stages.iter().map(count).sum()
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::build::cloth::{ClothBuilder, Edge};
    use crate::island::Island;
    use crate::motion::environment::Environment;
    use crate::simd::miri::unless_miri;
    use crate::state::hash::StateHasher;
    use crate::state::settings::BodySettings;
    use crate::step::{accumulate_forces, begin, can_be_swept, detect_collisions, finish, step, substep};

    const SUBSTEPS: u32 = 4;

    /// A curtain that swings, large enough for sweeps that carry several substeps.
    fn curtain(order: Order) -> Island {
        let size = unless_miri(64, 9);
        let cloth = ClothBuilder::new(1.0, 1.0, size, size).pin_edge(Edge::Top);
        let settings = BodySettings { substeps: SUBSTEPS, ..BodySettings::default() };
        let mut island = Island::of_body(cloth.build(settings).expect("valid"));
        island.context.order = order;
        island
    }

    fn hash(island: &Island) -> u64 {
        StateHasher::new().particles(&island.bodies[0].particles).finish()
    }

    /// The hash after some steps, in sweeps and stage by stage.
    fn both_ways(order: Order) -> [u64; 2] {
        let environment = Environment { gravity: Vec3::new(3.0, -9.81, 4.0), ..Environment::default() };
        let [mut swept, mut staged] = [curtain(order), curtain(order)];
        for _ in 0..5 {
            step(&mut swept, &environment).expect("valid");
            begin(&mut staged, &environment).expect("valid");
            assert!(can_be_swept(&swept), "the first way is that of sweeps");
            accumulate_forces(&mut staged, &environment);
            detect_collisions(&mut staged, &environment);
            (0..SUBSTEPS).for_each(|_| substep(&mut staged, &environment));
            finish(&mut staged).expect("valid");
        }
        [hash(&swept), hash(&staged)]
    }

    /// The order stands once: a stage that is put into the middle of the list is taken by both ways of walking it.
    #[test]
    fn a_stage_put_into_the_order_is_taken_by_sweeps_and_stage_by_stage() {
        const STICKS: &[Stages] = &[Stages::Bodies(&[
            BodyStage::Tethers,
            BodyStage::Sticks,
            BodyStage::Tethers,
            BodyStage::Lines,
            BodyStage::Volume,
        ])];
        let [swept, staged] = both_ways(Order::default());
        assert_eq!(swept, staged);
        let [changed_swept, changed_staged] = both_ways(Order { sticks: STICKS, ..Order::default() });
        assert_eq!(changed_swept, changed_staged);
        assert_ne!(changed_swept, swept, "tethers before the sticks change the result");
    }
}
