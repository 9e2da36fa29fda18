//! A query: the overlaps of balls with cloth in the middle of a step.
//!
//! Design: `docs/design/ball_cloth.md`.

use glam::Vec3;

use crate::state::body::Body;

/// An overlap of a ball with a face of a cloth, or with a link of a rope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallClothContact {
    /// The ball, by index in the island.
    pub ball: usize,
    /// The body, by index in the island.
    pub body: usize,
    /// Slots of the corners.
    pub(crate) slots: [u32; 3],
    /// Weights of the corners at the point nearest to the ball's centre: 0 to 1, with a sum of 1.
    pub weights: [f32; 3],
    /// Unit vector from the face to the ball, along which the ball leaves the face.
    pub normal: Vec3,
    /// Penetration depth in metres: radius and thickness less the distance of the ball's centre.
    pub depth: f32,
}

impl BallClothContact {
    /// The particles at its corners, by index in `body`; a link of a rope repeats its second end.
    ///
    /// # Panics
    /// If `body` is not the one that the contact was found with.
    pub fn particles(&self, body: &Body) -> [usize; 3] {
        let layout = &body.particles.layout;
        self.slots.map(|slot| layout.index(slot as usize).expect("no face has a ghost for a corner"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::cloth::ClothBuilder;
    use crate::island::Island;
    use crate::motion::environment::Environment;
    use crate::state::ball::{Ball, BallMaterial};
    use crate::state::settings::BodySettings;
    use crate::step;

    /// The overlaps that are found by testing all candidates.
    fn by_all(island: &Island) -> Vec<BallClothContact> {
        let mut island = island.clone();
        island.context.contacts.ball_cloth.forget_search();
        let mut found = Vec::new();
        island.ball_cloth_contacts(&mut found);
        found
    }

    /// Balls pass through a free, heavily deformed cloth. The search misses nothing, not even a face that a ball's
    /// centre has passed. The grids lie in rows, in square patches, or are too small to be cut.
    #[test]
    #[cfg_attr(miri, ignore = "fast balls take hundreds of substeps")]
    fn the_search_finds_the_same_as_a_test_of_all_candidates() {
        for (columns, rows) in [(40, 30), (17, 13), (6, 5)] {
            let body = ClothBuilder::new(2.0, 1.5, columns, rows)
                .placed(Vec3::new(-1.0, 0.75, 0.0), Vec3::X, Vec3::NEG_Y)
                .build(BodySettings::default())
                .expect("valid");
            let mut island = Island::of_body(body);
            for (x, speed) in [(0.1, 40.0), (-0.3, 15.0)] {
                let start = Vec3::new(x, 0.05, 0.4);
                let velocity = Vec3::new(0.5, 0.0, -speed);
                island.balls.push(Ball::new(BallMaterial::default(), start, velocity).expect("valid"));
            }
            let environment = Environment::default();
            let (mut contacts, mut passed) = (0, 0);
            for _ in 0..12 {
                step::begin(&mut island, &environment).expect("finite");
                step::accumulate_forces(&mut island, &environment);
                step::detect_collisions(&mut island, &environment);
                for _ in 0..island.substeps() {
                    step::integrate(&mut island, &environment);
                    let mut found = Vec::new();
                    island.ball_cloth_contacts(&mut found);
                    assert_eq!(found, by_all(&island));
                    contacts += found.len();
                    // The same with the balls thrown through the cloth.
                    let mut through = island.clone();
                    for ball in &mut through.balls {
                        ball.project(Vec3::NEG_Z * 0.2, Vec3::ZERO);
                    }
                    found.clear();
                    through.ball_cloth_contacts(&mut found);
                    assert_eq!(found, by_all(&through));
                    passed += found.iter().filter(|contact| contact.depth > 0.155).count();
                    step::relax(&mut island, &environment);
                    step::project_collisions(&mut island, &environment);
                }
                step::finish(&mut island).expect("finite");
            }
            assert!(contacts > 20 && passed > 20, "{contacts} contacts, {passed} passed");
        }
    }
}
