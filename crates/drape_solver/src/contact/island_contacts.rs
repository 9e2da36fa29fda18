//! All contacts of an island, kind by kind.

use crate::contact::ball_ball::BallPair;
use crate::contact::ball_cloth::BallClothContacts;
use crate::contact::ball_obstacle::BallObstacleContacts;
use crate::contact::body_contacts::BodyContacts;
use crate::contact::impact_zone::ImpactZones;
use crate::contact::mover::Mover;
use crate::contact::surface::SurfaceContacts;

/// The contacts that an island may have in a step. Each kind owns its lists, and is handed the bodies and balls that it
/// works on.
#[derive(Clone, Debug, Default)]
pub(crate) struct IslandContacts {
    /// Contacts of bodies with obstacles, by the body's index.
    pub bodies: Vec<BodyContacts>,
    /// Contacts of cloths and ropes with themselves and each other.
    pub surfaces: SurfaceContacts,
    pub ball_cloth: BallClothContacts,
    pub ball_ball: Vec<BallPair>,
    pub ball_obstacle: BallObstacleContacts,
    /// Obstacles that contacts move.
    pub movers: Vec<Mover>,
    pub impact_zones: ImpactZones,
}
