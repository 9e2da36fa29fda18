//! The kinds of things in a world, and which of them touch at all.

use crate::state::settings::BodySettings;

/// Body, ball or obstacle, as far as that decides what it can touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A cloth, rope or rig.
    Body {
        /// True if it touches itself, and other bodies that do so too.
        has_self_contact: bool,
    },
    /// A ball.
    Ball,
    /// An obstacle.
    Obstacle,
}

impl Kind {
    /// The kind of a body with these settings.
    pub fn of_body(settings: &BodySettings) -> Self {
        Self::Body { has_self_contact: settings.has_self_contact() }
    }

    /// True if the two can touch: balls touch everything, bodies each other where both touch themselves, and obstacles do
    /// not touch obstacles.
    pub fn touches(self, other: Self) -> bool {
        match (self, other) {
            (Self::Body { has_self_contact }, Self::Body { has_self_contact: others_has }) => {
                has_self_contact && others_has
            }
            (Self::Obstacle, Self::Obstacle) => false,
            _ => true,
        }
    }

    /// True if it can touch any body at all.
    pub(crate) fn touches_bodies(self) -> bool {
        self != Self::Body { has_self_contact: false }
    }
}
