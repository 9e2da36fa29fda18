//! Balls against cloth, as a question: what overlaps now?

use glam::Vec3;

use crate::body::Body;
use crate::contact_ball_cloth;
use crate::island::Island;

/// An overlap of a ball with a face of a cloth, or with a link of a rope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallClothContact {
    /// The ball, by index in the island.
    pub ball: usize,
    /// The body, by index in the island.
    pub body: usize,
    /// Where its corners are kept.
    pub(crate) slots: [u32; 3],
    /// Weights of its corners in the point that is nearest to the ball's centre; 0 to 1, their sum is 1.
    pub weights: [f32; 3],
    /// Unit vector along which the ball has to go to get free, from the face to the ball.
    pub normal: Vec3,
    /// How far it has to go, in metres: radius and thickness less the distance of the ball's centre.
    pub depth: f32,
}

impl BallClothContact {
    /// The particles at its corners, by index in `body`; a link of a rope has its second end twice.
    ///
    /// # Panics
    /// If `body` is not the one that the contact was found with.
    pub fn particles(&self, body: &Body) -> [usize; 3] {
        let layout = &body.particles.layout;
        self.slots.map(|slot| layout.index(slot as usize).expect("no face has a ghost for a corner"))
    }
}

impl Island {
    /// The overlaps of balls with cloth in the middle of a step, right after
    /// [`integrate`](crate::step::integrate), added to `found`: what the first projection of contacts would act on if
    /// nothing else was pushed meanwhile. Only candidates of the last
    /// [`detect_collisions`](crate::step::detect_collisions) are looked at. Gives the number of faces that were asked for
    /// their nearest point.
    pub fn ball_cloth_contacts(&mut self, found: &mut Vec<BallClothContact>) -> usize {
        contact_ball_cloth::find_all(self, |contact| found.push(contact))
    }
}
