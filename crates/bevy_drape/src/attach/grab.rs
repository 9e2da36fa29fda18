//! Hands that take hold of a cloth or rope at a point, for example for a pointer.
//!
//! [`pick`] finds the particle that a ray meets. A [`Grab`] on its body pulls that particle and those around it to a
//! target:
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::attach::{Grab, pick};
//!
//! fn take_hold(ray: Ray3d, bodies: Query<(Entity, &Particles)>, mut commands: Commands) {
//!     if let Some(picked) = pick(ray, 0.1, bodies.iter().map(|(entity, particles)| (entity, &particles.0)))
//!         && let Ok((_, particles)) = bodies.get(picked.entity)
//!     {
//!         commands.entity(picked.entity).insert(Grab::new(particles, picked.particle, 0.2));
//!     }
//! }
//! ```

use bevy::prelude::*;

use crate::body::particles::Particles;
use crate::clock::DrapeClock;

/// Rate in 1/s at which the distance to the target shrinks. The cloth that hangs from the held piece pulls it back: at
/// 40/s it stays a few centimetres short of the target.
const PULL_RATE: f32 = 40.0;

/// Greatest speed of a pulled particle in m/s: a pointer may jump, cloth should not.
const MAX_PULL_SPEED: f32 = 20.0;

/// A particle that a ray passes by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// The body.
    pub entity: Entity,
    /// Index of the particle in the body.
    pub particle: usize,
    /// Position of the particle in metres.
    pub position: Vec3,
    /// Distance along the ray in metres.
    pub distance: f32,
}

/// Finds the particle of `bodies` that `ray` meets: in front of its origin, within `radius` metres of the ray, with the
/// least sum of the distances along the ray and from the ray. In folded cloth the front layer wins, and within a layer
/// the particle nearest to the ray.
pub fn pick<'a>(
    ray: Ray3d,
    radius: f32,
    bodies: impl IntoIterator<Item = (Entity, &'a drape_solver::Particles)>,
) -> Option<Pick> {
    let mut best = None;
    let mut least = f32::INFINITY;
    for (entity, particles) in bodies {
        for (particle, position) in particles.positions().enumerate() {
            let offset = position - ray.origin;
            let along = offset.dot(*ray.direction);
            let aside = offset.reject_from_normalized(*ray.direction).length();
            // Comparisons with NaN are false, so it is no hit.
            if along >= 0.0 && aside <= radius && along + aside < least {
                least = along + aside;
                best = Some(Pick { entity, particle, position, distance: along });
            }
        }
    }
    best
}

/// Hands that hold a body. Each pulls the particle that it grabbed to its target. The particles around it are pulled
/// along, less with growing distance. Remove the component to let go.
///
/// A hand sets velocities, and sticks and contacts are solved after it: dragging a body into an obstacle, or farther
/// than it reaches, is safe. Pinned particles stay in place.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Grab {
    /// The hands: one for a pointer, several for fingers. They pull one after another.
    pub hands: Vec<Hand>,
}

/// A hand that holds a part of a body.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Hand {
    /// Names the hand, also on a piece that comes off; 0 by default.
    pub id: u64,
    /// Target of the grabbed particle in the world, in metres. A hand whose target is not finite does not pull.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub target: Vec3,
    /// The greatest force in newtons, averaged over a step; infinite by default. A hand cannot lift more than this
    /// force carries. At 0, below 0 or NaN the hand does not pull.
    pub greatest_force: f32,
    /// Particles that are held.
    held: Vec<Held>,
}

impl Default for Hand {
    fn default() -> Self {
        Self { id: 0, target: Vec3::ZERO, greatest_force: f32::INFINITY, held: Vec::new() }
    }
}

/// A particle that is held.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Held {
    particle: u32,
    /// Offset from the grabbed particle.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    offset: Vec3,
    /// 1 for the grabbed particle, falling to 0 at the radius.
    firmness: f32,
}

impl Hand {
    /// Takes hold of particle `particle` and of all within `radius` metres of it, where they are now. Holds
    /// nothing if there is no such particle.
    pub fn new(particles: &drape_solver::Particles, particle: usize, radius: f32) -> Self {
        if particle >= particles.len() {
            return Self::default();
        }
        let target = particles.position(particle);
        let hold = |(i, position): (usize, Vec3)| {
            let offset = position - target;
            let part = if i == particle { 0.0 } else { offset.length() / radius };
            // A bell curve that is zero at the radius.
            let firmness = (1.0 - part * part) * (1.0 - part * part);
            (part < 1.0).then_some(Held { particle: i as u32, offset, firmness })
        };
        let held = particles.positions().enumerate().filter_map(hold).collect();
        Self { target, held, ..Self::default() }
    }

    /// Puts the hand on a body. A hand of the same id on that body lets go first.
    pub fn hold(self, body: &mut EntityWorldMut) {
        match body.get_mut::<Grab>() {
            Some(mut grab) => grab.hold(self),
            None => drop(body.insert(Grab::from(self))),
        }
    }

    /// Indices of the particles that are held.
    pub fn particles(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.held.iter().map(|held| held.particle as usize)
    }

    /// Returns the hand on a piece whose particles have these `origins`; none if it holds none of them.
    fn on(&self, origins: &[u32]) -> Option<Self> {
        let of = |held: &Held| origins.iter().position(|&origin| origin == held.particle).map(|i| (i, *held));
        let held = self.held.iter().filter_map(of);
        let held: Vec<Held> =
            held.map(|(particle, held)| Held { particle: particle as u32, ..held }).collect();
        (!held.is_empty()).then(|| Self { held, ..self.clone() })
    }

    /// Sets the velocities that move the held particles to their targets, within the greatest force over a step of `dt`
    /// seconds.
    fn pull(&self, particles: &mut drape_solver::Particles, dt: f32) {
        if !self.target.is_finite() {
            return;
        }
        // Even a long step does not overshoot the target.
        let rate = PULL_RATE.min(1.0 / dt);
        let change = |particles: &drape_solver::Particles, &Held { particle, offset, firmness }: &Held| {
            let i = particle as usize;
            // The body may have been rebuilt with fewer particles.
            if i >= particles.len() || particles.is_pinned(i) {
                return Vec3::ZERO;
            }
            let way = self.target + offset - particles.position(i);
            let wanted = (way * rate).clamp_length_max(MAX_PULL_SPEED);
            let change = (wanted - particles.velocity(i)) * firmness;
            if change.is_finite() { change } else { Vec3::ZERO }
        };
        let impulse = |held: &Held| {
            let change = change(particles, held).length();
            if change > 0.0 { change / particles.inverse_mass(held.particle as usize) } else { 0.0 }
        };
        let total: f32 = self.held.iter().map(impulse).sum();
        let reach = self.greatest_force * dt;
        if reach.is_nan() || reach <= 0.0 || total == 0.0 {
            return;
        }
        let part = (reach / total).min(1.0);
        for held in &self.held {
            let change = change(particles, held) * part;
            if change != Vec3::ZERO {
                let i = held.particle as usize;
                particles.set_velocity(i, particles.velocity(i) + change);
            }
        }
    }
}

impl From<Hand> for Grab {
    fn from(hand: Hand) -> Self {
        Self { hands: vec![hand] }
    }
}

impl Grab {
    /// A hand on particle `particle` and on all within `radius` metres of it, where they are now. Holds
    /// nothing if there is no such particle.
    pub fn new(particles: &drape_solver::Particles, particle: usize, radius: f32) -> Self {
        Hand::new(particles, particle, radius).into()
    }

    /// Holds the body with another hand. A hand of the same id lets go first.
    pub fn hold(&mut self, hand: Hand) {
        self.let_go(hand.id);
        self.hands.push(hand);
    }

    /// Takes off the hand of this id; true if no hand is left, so that the component can go too.
    pub fn let_go(&mut self, id: u64) -> bool {
        self.hands.retain(|hand| hand.id != id);
        self.hands.is_empty()
    }

    /// Limits the force of its hands, in newtons each.
    pub fn with_greatest_force(mut self, newtons: f32) -> Self {
        self.hands.iter_mut().for_each(|hand| hand.greatest_force = newtons);
        self
    }

    /// Sets the target of all hands, in the world, in metres.
    pub fn pull_to(&mut self, target: Vec3) {
        self.hands.iter_mut().for_each(|hand| hand.target = target);
    }

    /// Returns the target of the first hand; none without hands.
    pub fn target(&self) -> Option<Vec3> {
        self.hands.first().map(|hand| hand.target)
    }

    /// Returns the hand with this id.
    pub fn hand_mut(&mut self, id: u64) -> Option<&mut Hand> {
        self.hands.iter_mut().find(|hand| hand.id == id)
    }

    /// Returns the hands on a torn body, or on a piece of it, whose particles have these `origins`; none if no hand
    /// holds it.
    pub(crate) fn on(&self, origins: &[u32]) -> Option<Self> {
        let hands: Vec<Hand> = self.hands.iter().filter_map(|hand| hand.on(origins)).collect();
        (!hands.is_empty()).then_some(Self { hands })
    }

    /// Indices of the particles that are held, by one hand after another.
    pub fn particles(&self) -> impl Iterator<Item = usize> + '_ {
        self.hands.iter().flat_map(Hand::particles)
    }
}

/// Pulls with all hands.
pub(crate) fn pull_grabbed(mut bodies: Query<(&Grab, &mut Particles)>, clock: Res<DrapeClock>) {
    for (grab, mut particles) in &mut bodies {
        for hand in &grab.hands {
            hand.pull(&mut particles, clock.delta());
        }
    }
}

/// Finds the particle nearest to `place`; none if there are no particles, or `place` is not finite.
pub(crate) fn nearest_particle(particles: &drape_solver::Particles, place: Vec3) -> Option<usize> {
    let away = particles.positions().enumerate().map(|(i, position)| (i, position.distance_squared(place)));
    let nearest = away.filter(|(_, away)| away.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1));
    nearest.map(|(i, _)| i)
}

#[cfg(test)]
mod tests {
    use bevy::time::TimeUpdateStrategy;

    use super::*;
    use crate::body::{Activity, Sticks};
    use crate::prelude::*;

    fn row(z: f32) -> drape_solver::Particles {
        let places: Vec<Vec3> = (0..5).map(|i| Vec3::new(0.1 * i as f32, 0.0, z)).collect();
        drape_solver::Particles::new(Vec3::ZERO, &places, &[1.0; 5]).expect("valid")
    }

    /// Looks along -Z at (x, 0).
    fn ray(x: f32) -> Ray3d {
        Ray3d::new(Vec3::new(x, 0.0, 5.0), Dir3::NEG_Z)
    }

    #[test]
    fn the_nearest_particle_of_the_front_layer_is_picked() {
        let [front, back] = [Entity::from_raw_u32(1), Entity::from_raw_u32(2)].map(|e| e.expect("valid"));
        let (near, far) = (row(0.0), row(-1.0));
        // The ray goes right through a particle of the layer behind, and beside one of the layer in front.
        let picked = pick(ray(0.21), 0.08, [(back, &far), (front, &near)]).expect("a hit");
        assert_eq!((picked.entity, picked.particle), (front, 2));
        assert!((picked.distance - 5.0).abs() < 1e-6);
    }

    #[test]
    fn what_is_beside_or_behind_the_ray_is_not_picked() {
        let entity = Entity::from_raw_u32(1).expect("valid");
        assert_eq!(pick(ray(0.45), 0.04, [(entity, &row(0.0))]), None, "5 cm beside the last one");
        assert_eq!(pick(ray(0.2), 0.04, [(entity, &row(6.0))]), None, "behind the eye");
    }

    #[test]
    fn hold_is_firm_in_the_middle_and_ends_at_the_radius() {
        let grab = Grab::new(&row(0.0), 2, 0.15);
        assert_eq!(grab.particles().collect::<Vec<_>>(), [1, 2, 3]);
        assert_eq!(grab.hands[0].held[1].firmness, 1.0);
        assert!(grab.hands[0].held[0].firmness < 0.5 && grab.hands[0].held[0].firmness > 0.0);
        assert_eq!(Grab::new(&row(0.0), 9, 0.15).particles().count(), 0, "no such particle");
    }

    /// A curtain of 1 m x 1 m asleep, and an app to wake it in.
    fn sleeping_curtain() -> (App, Entity) {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, DrapePlugins::default()))
            .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
        let cloth = app.world_mut().spawn(Cloth::new(1.0, 1.0).with_particles(11, 11)).id();
        app.finish();
        app.cleanup();
        for _ in 0..600 {
            app.update();
            if app.world().get::<Activity>(cloth) == Some(&Activity::Resting) {
                return (app, cloth);
            }
        }
        panic!("the curtain does not come to rest");
    }

    fn particle(app: &App, cloth: Entity, i: usize) -> Vec3 {
        app.world().get::<Particles>(cloth).expect("built").position(i)
    }

    #[test]
    fn a_grabbed_curtain_wakes_follows_and_falls_back_when_let_go() {
        let (mut app, cloth) = sleeping_curtain();
        let middle = 60;
        let hanging = particle(&app, cloth, middle);
        let mut grab = Grab::new(app.world().get::<Particles>(cloth).expect("built"), middle, 0.2);
        let target = hanging + Vec3::new(0.0, 0.2, 0.3);
        grab.pull_to(target);
        app.world_mut().entity_mut(cloth).insert(grab);
        for _ in 0..120 {
            app.update();
        }
        let miss = particle(&app, cloth, middle).distance(target);
        assert!(miss < 0.05, "held {miss} m off the target");
        assert_eq!(app.world().get::<Activity>(cloth), Some(&Activity::Active), "a held cloth stays awake");
        let stretch = drape_solver::state::measure::stretch(
            app.world().get::<Particles>(cloth).expect("built"),
            app.world().get::<Sticks>(cloth).expect("built"),
        );
        assert!(stretch.rms < 0.05, "rms stretch {}", stretch.rms);

        app.world_mut().entity_mut(cloth).remove::<Grab>();
        for _ in 0..1200 {
            app.update();
        }
        let off = particle(&app, cloth, middle).distance(hanging);
        assert!(off < 0.02, "hangs {off} m off its place");
    }

    #[test]
    fn pins_hold_against_the_hand_and_a_target_that_is_no_place_is_ignored() {
        let (mut app, cloth) = sleeping_curtain();
        let pin = particle(&app, cloth, 5);
        let mut grab = Grab::new(app.world().get::<Particles>(cloth).expect("built"), 16, 0.25);
        grab.pull_to(Vec3::new(0.0, 100.0, 0.0));
        app.world_mut().entity_mut(cloth).insert(grab);
        for step in 0..120 {
            if step == 60 {
                app.world_mut().get_mut::<Grab>(cloth).expect("inserted").pull_to(Vec3::NAN);
            }
            app.update();
        }
        assert_eq!(particle(&app, cloth, 5), pin);
        let particles = app.world().get::<Particles>(cloth).expect("built");
        assert!(particles.is_finite());
        // One row below the pins: it cannot be farther from them than the cloth is long.
        let away = particles.position(16).distance(pin);
        assert!(away < 0.12, "torn off by {away} m");
    }

    #[test]
    fn a_hand_lifts_what_its_force_carries_and_no_more() {
        for (part_of_weight, lifts) in [(0.7, false), (1.5, true)] {
            let (mut app, cloth) = sleeping_curtain();
            let particles = app.world().get::<Particles>(cloth).expect("built");
            let free = Cloth::new(1.0, 1.0).with_particles(11, 11).with_pins(ClothPins::None);
            // 0.25 kg.
            let weight = 0.25 * 9.81;
            let grab = Grab::new(particles, 60, 10.0).with_greatest_force(part_of_weight * weight);
            app.world_mut().entity_mut(cloth).insert((free, grab));
            for _ in 0..60 {
                app.update();
            }
            let height = particle(&app, cloth, 60).y;
            assert_eq!(height > -0.2, lifts, "{part_of_weight} of its weight: at {height} m");
        }
    }
}
