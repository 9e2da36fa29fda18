//! The scenes by name.

use clap::ValueEnum;
use drape_solver::BodySettings;

use crate::experiments::contact::setup::Setup;
use crate::experiments::contact::{cloths, narrows, ropes};
use crate::failure::Failure;

/// A scene in which cloth or rope touches itself or others of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ContactScene {
    /// A strip of 20 x 100 particles falls over itself.
    Fold20,
    /// The same of 40 x 200 particles.
    Fold40,
    /// Ten sheets fall on a sphere.
    Stack,
    /// A sheet is twisted by two turns, and its ends come nearer.
    Twistin,
    /// The same with ends that do not come nearer, which the sheet cannot follow without stretching.
    Twist,
    /// A rope in a bowline, with a weight in its loop.
    Bowline,
    /// Ten sheets are thrown into a box that is narrower than they are.
    Box,
    /// A sleeve is pulled through a ring that is narrower than it is.
    Sleeve,
    /// Three sheets fall through a funnel.
    Funnel,
    /// A sheet swings about its upper edge, and touches nothing.
    Swing,
    /// Five cannon balls hit a curtain, one a second.
    Curtain,
}

impl ContactScene {
    /// The scene, with bodies of these settings.
    ///
    /// # Errors
    /// [`Failure`] if the solver refuses a body or an obstacle.
    pub fn setup(self, settings: BodySettings) -> Result<Setup, Failure> {
        match self {
            Self::Fold20 => cloths::fold(20, 100, settings),
            Self::Fold40 => cloths::fold(40, 200, settings),
            Self::Stack => cloths::stack(10, 32, settings),
            Self::Twistin => cloths::twist(50, cloths::twisted_and_nearer, settings),
            Self::Twist => cloths::twist(50, cloths::twisted, settings),
            Self::Bowline => ropes::bowline(settings),
            Self::Box => narrows::filled_box(10, 30, settings),
            Self::Sleeve => narrows::sleeve(64, settings),
            Self::Funnel => narrows::funnel(3, 40, settings),
            Self::Swing => cloths::swing(64, settings),
            Self::Curtain => cloths::bombarded_curtain([64, 48], settings),
        }
    }
}
