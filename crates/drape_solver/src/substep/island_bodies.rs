//! The bodies of an island with what each of them has to itself in a step, shared out to workers.
//!
//! ```text
//!   bodies   | shirt       | jacket            | cape    |
//!   workers  | leader                          | helper  |     as many cells on both sides as can be
//! ```
//!
//! Design: `docs/design/sweeps_and_threads.md`.

use crate::constants::LEAST_SHARED_BODIES;
use crate::contact::body_contacts::BodyContacts;
use crate::parallel::for_each::balanced_cut;
use crate::parallel::workers::Workers;
use crate::state::body::Body;
use crate::substep::plan::BodyPlan;

/// One body with its contacts and its plan.
pub(crate) type IslandBody<'a> = (&'a mut Body, &'a mut BodyContacts, &'a mut BodyPlan);

/// Some bodies that follow each other in an island, with their contacts and plans.
pub(crate) struct IslandBodies<'a> {
    pub bodies: &'a mut [Body],
    pub contacts: &'a mut [BodyContacts],
    pub plans: &'a mut [BodyPlan],
}

impl IslandBodies<'_> {
    /// Does `work` on each body, on several threads if the bodies are large enough. Bodies see nothing of each other, so the result
    /// does not depend on the threads.
    pub fn for_each(&mut self, workers: &Workers, work: &(dyn Fn(IslandBody) + Sync)) {
        debug_assert!([self.contacts.len(), self.plans.len()] == [self.bodies.len(); 2], "each has its own");
        let cells = self.bodies.iter().map(|body| body.topology.layout.cells());
        let Some(cut) = balanced_cut(cells, LEAST_SHARED_BODIES, workers) else {
            let all = self.bodies.iter_mut().zip(&mut *self.contacts).zip(&mut *self.plans);
            all.for_each(|((body, contacts), plan)| work((body, contacts, plan)));
            return;
        };
        let (before, after) = self.bodies.split_at_mut(cut);
        let (contacts, plans) = (self.contacts.split_at_mut(cut), self.plans.split_at_mut(cut));
        let mut before = IslandBodies { bodies: before, contacts: contacts.0, plans: plans.0 };
        let mut after = IslandBodies { bodies: after, contacts: contacts.1, plans: plans.1 };
        workers.join(&mut || before.for_each(workers, work), &mut || after.for_each(workers, work));
    }
}

#[cfg(test)]
mod tests {
    use core::sync::atomic::{AtomicBool, Ordering};
    use std::sync::Mutex;

    use super::*;
    use crate::build::cloth::ClothBuilder;
    use crate::parallel::testing::Fresh;
    use crate::parallel::threads::{Alone, Threads};
    use crate::state::settings::BodySettings;

    /// Each body is worked on once, with its own contacts and plan, whoever comes; and the helper has its share.
    #[test]
    #[cfg_attr(target_family = "wasm", ignore = "needs threads")]
    fn each_body_is_worked_on_once_with_what_belongs_to_it() {
        let cloth =
            |side| ClothBuilder::new(1.0, 1.0, side, side).build(BodySettings::default()).expect("valid");
        for sides in [&[][..], &[16], &[16, 16], &[4, 20, 4], &[16, 18, 16, 17, 10]] {
            for threads in [&Alone as &dyn Threads, &Fresh(2), &Fresh(3)] {
                let mut bodies: Vec<Body> = sides.iter().map(|&side| cloth(side)).collect();
                let mut plans = vec![BodyPlan::default(); bodies.len()];
                let mut contacts = vec![BodyContacts::default(); bodies.len()];
                let came = Mutex::new(Vec::new());
                // The leader does not take the other body back before a helper has begun it. If bodies are not shared, this hangs.
                let (is_shared, begun) = (sides == [16, 16] && threads.count() > 1, AtomicBool::new(false));
                for (place, (contacts, plan)) in contacts.iter_mut().zip(&mut plans).enumerate() {
                    contacts.obstacles.near.push(place as u32);
                    plan.plan.update = place;
                }
                Workers::run(threads, &mut |workers| {
                    while workers.count() < workers.most() {
                        std::thread::yield_now();
                    }
                    let mut all =
                        IslandBodies { bodies: &mut bodies, contacts: &mut contacts, plans: &mut plans };
                    all.for_each(workers, &|(body, contacts, plan)| {
                        assert_eq!(contacts.obstacles.near, [plan.plan.update as u32]);
                        assert_eq!(
                            body.particles.len(),
                            (sides[plan.plan.update] * sides[plan.plan.update]) as usize
                        );
                        body.pressure += 1.0;
                        let place = plan.plan.update;
                        begun.fetch_or(place == 1, Ordering::AcqRel);
                        while is_shared && !begun.load(Ordering::Acquire) {
                            std::thread::yield_now();
                        }
                        came.lock().expect("no panic").push(std::thread::current().id());
                    });
                });
                assert!(bodies.iter().all(|body| body.pressure == 1.0));
                if is_shared {
                    let came = came.into_inner().expect("no panic");
                    assert_ne!(came[0], came[1], "a helper has its share");
                }
            }
        }
    }
}
