//! Commands for swords, bullets and hands.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::gestures::Gestures;
//!
//! fn shoot(mut commands: Commands) {
//!     // A bullet leaves a star-shaped hole of 5 cm in whatever cloth is in its way.
//!     commands.pierce(Vec3::new(0.0, 1.5, 0.0), Dir3::NEG_Z, 0.05);
//! }
//! # let mut app = App::new();
//! # app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()));
//! # app.add_systems(Startup, shoot).update();
//! ```

use bevy::prelude::*;

use crate::attach::grab::{Grab, Hand, nearest_particle};
use crate::body::particles::Particles;
use crate::tear::messages::CutCloth;

/// Commands for swords, bullets and hands.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// use bevy_drape::gestures::Gestures;
///
/// fn fight(mut commands: Commands, curtain: Single<Entity, With<Cloth>>) {
///     // A sword that reaches half a metre to both sides goes along this path.
///     commands.cut_along([Vec3::new(-1.0, 1.0, 0.0), Vec3::new(0.0, 1.2, 0.0), Vec3::X], Vec3::Z * 0.5);
///     // A bullet that flies along -Z leaves a hole of 5 cm.
///     commands.pierce(Vec3::new(0.2, 0.5, 0.0), Dir3::NEG_Z, 0.05);
///     // A left hand of 10 cm that pulls with up to 20 N.
///     const LEFT: u64 = 1;
///     commands.grab(*curtain, LEFT, Vec3::ZERO, 0.1).pull(*curtain, LEFT, Vec3::Z, 20.0);
/// }
/// ```
pub trait Gestures {
    /// Grabs the particle of `body` nearest to `place` (in the world, in metres) and all within `radius` of it, with
    /// the hand of this id. The hand releases whatever it held of that body before. Does nothing if `body` is not a
    /// body by then.
    fn grab(&mut self, body: Entity, hand: u64, place: Vec3, radius: f32) -> &mut Self;

    /// Pulls with a hand to `target` (in the world, in metres) with at most `greatest_force` newtons. Does nothing if
    /// the hand does not hold `body` by then.
    fn pull(&mut self, body: Entity, hand: u64, target: Vec3, greatest_force: f32) -> &mut Self;

    /// Releases a hand.
    fn release(&mut self, body: Entity, hand: u64) -> &mut Self;

    /// Cuts everything along `path` with a blade that reaches `depth` to both sides of it (both in the world, in
    /// metres).
    fn cut_along(&mut self, path: impl IntoIterator<Item = Vec3>, depth: Vec3) -> &mut Self;

    /// Tears a star of three slits of `radius` metres around `place`, the hole of a bullet that flies along
    /// `direction`.
    fn pierce(&mut self, place: Vec3, direction: Dir3, radius: f32) -> &mut Self;
}

impl Gestures for Commands<'_, '_> {
    fn grab(&mut self, body: Entity, hand: u64, place: Vec3, radius: f32) -> &mut Self {
        self.queue(move |world: &mut World| {
            let Some(particles) = world.get::<Particles>(body) else { return };
            let Some(nearest) = nearest_particle(particles, place) else { return };
            let mut new = Hand::new(particles, nearest, radius);
            new.id = hand;
            new.hold(&mut world.entity_mut(body));
        });
        self
    }

    fn pull(&mut self, body: Entity, hand: u64, target: Vec3, greatest_force: f32) -> &mut Self {
        self.queue(move |world: &mut World| {
            let mut grab = world.get_mut::<Grab>(body);
            if let Some(hand) = grab.as_mut().and_then(|grab| grab.hand_mut(hand)) {
                (hand.target, hand.greatest_force) = (target, greatest_force);
            }
        });
        self
    }

    fn release(&mut self, body: Entity, hand: u64) -> &mut Self {
        self.queue(move |world: &mut World| {
            let Ok(mut body) = world.get_entity_mut(body) else { return };
            if body.get_mut::<Grab>().is_some_and(|mut grab| grab.let_go(hand)) {
                body.remove::<Grab>();
            }
        });
        self
    }

    fn cut_along(&mut self, path: impl IntoIterator<Item = Vec3>, depth: Vec3) -> &mut Self {
        let cut = CutCloth::along(path, depth);
        self.write_message(cut);
        self
    }

    fn pierce(&mut self, place: Vec3, direction: Dir3, radius: f32) -> &mut Self {
        let cut = CutCloth::star(place, direction, radius);
        self.write_message(cut);
        self
    }
}
