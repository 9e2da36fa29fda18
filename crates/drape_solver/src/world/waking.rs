//! Finds what is at rest in the way of what moves.
//!
//! Whatever moves, appears or vanishes in a step disturbs a box. What rests in that box and can touch it wakes up, and
//! disturbs a box itself: so a whole pile wakes at once.
//!
//! `Proxy::wakes` is the rule. `Waking::wake` lists what wakes; its callers make that active: `Members::wake`
//! (`members.rs`) in a `World`, `sleep/waking.rs` in the plugin.

use crate::state::layers::Layers;
use crate::state::obstacle::Obstacle;
use crate::world::activity::Activity;
use crate::world::bounds::Bounds;
use crate::world::kind::Kind;
use crate::world::resting_tree::{Key, RestingTree};

/// Something as the broad phase sees it: a box, and what it can touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proxy {
    /// Of something awake, where it can get within the step; of a sleeper, where it can be touched.
    pub bounds: Bounds,
    /// Its layers.
    pub layers: Layers,
    /// Its kind.
    pub kind: Kind,
}

impl Proxy {
    /// The proxy of a place where something was, or appears: it touches all that rests there.
    pub fn of_space(bounds: Bounds, layers: Layers) -> Self {
        Self { bounds, layers, kind: Kind::Obstacle }
    }

    /// The proxy of all places where an obstacle is in the coming step.
    pub fn of_obstacle(obstacle: &Obstacle) -> Self {
        Self::of_space(Bounds::from(obstacle.swept_bounds()), obstacle.layers())
    }

    /// True if it wakes `sleeper`.
    pub fn wakes(&self, sleeper: &Self) -> bool {
        self.kind.touches(sleeper.kind)
            && self.layers.interact(sleeper.layers)
            && self.bounds.overlaps(sleeper.bounds)
    }
}

/// True if a body or ball is to be active at once, whoever touches it: it was `disturbed` in its sleep (a force, an edit,
/// another wind), or could not be simulated and has been `mended`.
pub fn is_roused(activity: Activity, disturbed: bool, mended: bool) -> bool {
    mended || activity == Activity::Resting && disturbed
}

/// Boxes of all that rests, and of all that disturbs it in the coming step.
#[derive(Clone)]
pub struct Waking<K> {
    disturbances: Vec<Proxy>,
    bodies: RestingTree<K>,
    balls: RestingTree<K>,
    found: Vec<K>,
}

impl<K> Default for Waking<K> {
    fn default() -> Self {
        Self {
            disturbances: Vec::new(),
            bodies: RestingTree::default(),
            balls: RestingTree::default(),
            found: Vec::new(),
        }
    }
}

impl<K: Key> Waking<K> {
    /// Puts a body to rest at `bounds`, or moves it there.
    pub fn rest_body(&mut self, key: K, bounds: Bounds) {
        self.bodies.insert(key, bounds);
    }

    /// Puts a ball to rest at `bounds`, or moves it there.
    pub fn rest_ball(&mut self, key: K, bounds: Bounds) {
        self.balls.insert(key, bounds);
    }

    /// Takes a body out that does not rest any more, if it is here.
    pub fn remove_body(&mut self, key: K) {
        self.bodies.remove(key);
    }

    /// Takes a ball out that does not rest any more. If it is here, what lies on it wakes.
    pub fn remove_ball(&mut self, key: K) {
        if let Some(bounds) = self.balls.remove(key) {
            self.disturb(Proxy::of_space(bounds, Layers::ALL));
        }
    }

    /// Has the next [`wake`](Self::wake) wake what rests in the way of `proxy`.
    pub fn disturb(&mut self, proxy: Proxy) {
        self.disturbances.push(proxy);
    }

    /// Appends to `woken` all that the disturbances wake, and those that they wake in turn. `sleeper` tells about something
    /// at rest; `None` if it is gone.
    pub fn wake(&mut self, sleeper: impl Fn(K) -> Option<Proxy>, woken: &mut Vec<K>) {
        let Self { disturbances, bodies, balls, found } = self;
        if balls.is_empty() && bodies.is_empty() {
            disturbances.clear();
        }
        let mut next = 0;
        while let Some(&disturbance) = disturbances.get(next) {
            next += 1;
            balls.find(disturbance.bounds, found);
            if disturbance.kind.touches_bodies() {
                bodies.find(disturbance.bounds, found);
            }
            for key in found.drain(..) {
                let proxy = sleeper(key);
                if proxy.is_some_and(|sleeper| !disturbance.wakes(&sleeper)) {
                    continue;
                }
                balls.remove(key);
                bodies.remove(key);
                if let Some(proxy) = proxy {
                    woken.push(key);
                    disturbances.push(proxy);
                }
            }
        }
        disturbances.clear();
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    impl Key for usize {
        fn index(self) -> usize {
            self
        }
    }

    const CLOTH: Kind = Kind::Body { has_self_contact: false };
    const LAYERED: Kind = Kind::Body { has_self_contact: true };

    fn at(x: f32, kind: Kind) -> Proxy {
        let bounds = Bounds::new(Vec3::X * x, Vec3::new(x + 1.0, 1.0, 1.0));
        Proxy { bounds, layers: Layers::ALL, kind }
    }

    /// Those of the sleepers that `by` wakes, in order.
    fn woken(sleepers: &[Proxy], by: Proxy) -> Vec<usize> {
        let mut waking = Waking::default();
        for (key, sleeper) in sleepers.iter().enumerate() {
            match sleeper.kind {
                Kind::Ball => waking.rest_ball(key, sleeper.bounds),
                _ => waking.rest_body(key, sleeper.bounds),
            }
        }
        waking.disturb(by);
        let mut woken = Vec::new();
        waking.wake(|key| Some(sleepers[key]), &mut woken);
        woken.sort_unstable();
        woken
    }

    #[test]
    fn a_row_wakes_from_end_to_end_and_what_is_apart_sleeps_on() {
        let row = [0.0, 0.9, 1.8, 2.7, 4.0].map(|x| at(x, Kind::Ball));
        assert_eq!(woken(&row, at(-0.5, Kind::Ball)), [0, 1, 2, 3]);
        assert!(woken(&row, at(7.0, Kind::Ball)).is_empty());
    }

    #[test]
    fn bodies_wake_balls_and_each_other_only_with_self_contact() {
        let sleepers = [at(0.0, CLOTH), at(0.0, LAYERED), at(0.0, Kind::Ball)];
        assert_eq!(woken(&sleepers[..2], at(0.5, CLOTH)), [0; 0]);
        assert_eq!(woken(&sleepers[..2], at(0.5, LAYERED)), [1]);
        // Through the ball.
        assert_eq!(woken(&sleepers, at(0.5, CLOTH)), [0, 1, 2]);
        assert_eq!(woken(&sleepers, Proxy::of_space(at(0.5, CLOTH).bounds, Layers::ALL)), [0, 1, 2]);
    }

    #[test]
    fn layers_decide() {
        let sleeper = Proxy { layers: Layers::new(2, 2), ..at(0.0, CLOTH) };
        assert!(woken(&[sleeper], Proxy { layers: Layers::new(1, 1), ..at(0.0, Kind::Ball) }).is_empty());
        assert_eq!(woken(&[sleeper], at(0.0, Kind::Ball)), [0]);
    }

    #[test]
    fn a_disturbance_counts_once_and_the_gone_wake_nobody() {
        let mut waking = Waking::default();
        let mut woken = Vec::new();
        waking.disturb(at(0.0, Kind::Ball));
        waking.wake(|_| None, &mut woken);
        waking.rest_ball(0_usize, at(0.0, Kind::Ball).bounds);
        waking.wake(|_| Some(at(0.0, Kind::Ball)), &mut woken);
        assert!(woken.is_empty(), "the disturbance is over");
        waking.disturb(at(0.0, Kind::Ball));
        waking.wake(|_| None, &mut woken);
        assert!(woken.is_empty(), "it is gone");
        waking.rest_body(1, at(0.0, CLOTH).bounds);
        waking.rest_ball(2, at(0.0, CLOTH).bounds);
        waking.remove_ball(2);
        waking.wake(|_| Some(at(0.0, CLOTH)), &mut woken);
        assert_eq!(woken, [1], "it lay on the ball that is not there any more");
    }

    #[test]
    fn only_sleepers_are_roused_and_what_is_mended() {
        assert!(is_roused(Activity::Resting, true, false) && is_roused(Activity::Culled, false, true));
        assert!(!is_roused(Activity::Resting, false, false) && !is_roused(Activity::Culled, true, false));
        assert!(!is_roused(Activity::Frozen, true, false));
    }
}
