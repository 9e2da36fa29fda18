//! Workers: threads that wait for work in a loop for the length of a step.
//!
//! A body is divided anew in every trip down its strips, tenths of a millisecond apart, and waking a thread takes as
//! long. So the leader calls the host's threads once a step, and those that come wait in a loop for work until they are
//! dismissed. The leader never waits for a helper to come: until then, it does the work alone.
//!
//! ```text
//!   leader  | alone ------ | upper half | wedge | upper half | wedge |
//!   helper  | wakes up ... | lower half |  ...  | lower half |  ...  | dismissed
//! ```
//!
//! Design: `docs/design/sweeps_and_threads.md`.

#![expect(unsafe_code, reason = "a closure that borrows is handed to a thread that outlives the borrow")]

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use crate::parallel::threads::Threads;

/// The greatest number of helpers that get work.
const MOST_HELPERS: usize = 7;

/// The number of rounds of waiting after which a thread yields its core.
const ROUNDS_OF_WAITING: u32 = 1 << 14;

type Job<'a> = &'a mut (dyn FnMut() + Send);

/// The helpers of a leader.
#[derive(Default)]
pub(crate) struct Workers {
    places: [WorkerSlot; MOST_HELPERS],
    is_dismissed: AtomicBool,
    /// The number of helpers that were called.
    called: usize,
}

/// State and job of one helper.
#[repr(align(128))]
#[derive(Default)]
struct WorkerSlot {
    state: AtomicU32,
    job: UnsafeCell<Option<Job<'static>>>,
}

/// No helper is in this place.
const EMPTY: u32 = 0;
/// A helper waits for work.
const IDLE: u32 = 1;
/// A thread has claimed the helper and is about to give it work.
const CLAIMED: u32 = 2;
/// The helper owns the place until it has done the job.
const WORKING: u32 = 3;
/// The job is done: the place belongs to the thread that gave it.
const DONE: u32 = 4;

// SAFETY: `job` is only touched by the thread that `state` names: whoever moved it from IDLE to CLAIMED, until it stores
// WORKING; then the helper, until it stores DONE. These stores release and the loads that see them acquire.
unsafe impl Sync for WorkerSlot {}

impl Workers {
    /// Runs `lead` with this thread as leader, and with as many of `threads` as come to help.
    pub fn run(threads: &dyn Threads, lead: &mut (dyn FnMut(&Self) + Send)) {
        let helpers = threads.count().saturating_sub(1).min(MOST_HELPERS);
        let workers = Self { called: helpers, ..Self::default() };
        let mut lead = || {
            let _end = Release(&workers);
            lead(&workers);
        };
        workers.call(threads, &mut lead, helpers);
    }

    /// Calls the helpers one by one, and runs `lead`.
    fn call(&self, threads: &dyn Threads, lead: Job, helpers: usize) {
        match helpers.checked_sub(1) {
            None => lead(),
            Some(fewer) => {
                threads.join(&mut || self.call(threads, lead, fewer), &mut || self.help(&self.places[fewer]));
            }
        }
    }

    /// Stands by until dismissed.
    fn help(&self, place: &WorkerSlot) {
        if self.is_dismissed.load(Ordering::Acquire) {
            return;
        }
        place.state.store(IDLE, Ordering::Release);
        let mut rounds = 0;
        loop {
            match place.state.load(Ordering::Acquire) {
                WORKING => {
                    // SAFETY: the state is WORKING, so the place is this thread's until `Done` is dropped.
                    let job = unsafe { (*place.job.get()).take() };
                    let _done = Done(place);
                    if let Some(job) = job {
                        job();
                    }
                    rounds = 0;
                }
                IDLE if self.is_dismissed.load(Ordering::Acquire) => {
                    let left = place.state.compare_exchange(IDLE, EMPTY, Ordering::AcqRel, Ordering::Relaxed);
                    if left.is_ok() {
                        return;
                    }
                }
                _ => rounds = wait(rounds),
            }
        }
    }
}

impl Workers {
    /// The number of workers that are free now: the leader, and the helpers that have come and wait.
    pub fn count(&self) -> usize {
        1 + self.places.iter().filter(|place| place.state.load(Ordering::Relaxed) == IDLE).count()
    }

    /// The greatest number of workers that may be free in a moment.
    pub fn most(&self) -> usize {
        1 + self.called
    }

    /// Runs both closures, at the same time if a helper is free, and returns when both have ended.
    pub fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        let is_claimed = |place: &&WorkerSlot| {
            place.state.compare_exchange(IDLE, CLAIMED, Ordering::AcqRel, Ordering::Relaxed).is_ok()
        };
        let Some(place) = self.places.iter().find(is_claimed) else {
            one();
            other();
            return;
        };
        // SAFETY: only the lifetime is changed. The job is not used after this function returns, or unwinds: `Wait` does
        // not let it before the helper has stored DONE, after which the helper does not touch the job again.
        let job = unsafe { core::mem::transmute::<Job<'_>, Job<'static>>(other) };
        // SAFETY: the state is CLAIMED by this thread.
        unsafe { *place.job.get() = Some(job) };
        let _wait = Wait(place);
        place.state.store(WORKING, Ordering::Release);
        one();
    }
}

/// Dismisses all helpers when the leader ends or panics.
struct Release<'a>(&'a Workers);

impl Drop for Release<'_> {
    fn drop(&mut self) {
        self.0.is_dismissed.store(true, Ordering::Release);
    }
}

/// Marks the job as done when it ends or panics.
struct Done<'a>(&'a WorkerSlot);

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.state.store(DONE, Ordering::Release);
    }
}

/// Waits until the job that was given is done.
struct Wait<'a>(&'a WorkerSlot);

impl Drop for Wait<'_> {
    fn drop(&mut self) {
        let mut rounds = 0;
        while self.0.state.load(Ordering::Acquire) != DONE {
            rounds = wait(rounds);
        }
        self.0.state.store(IDLE, Ordering::Release);
    }
}

fn wait(rounds: u32) -> u32 {
    if rounds < ROUNDS_OF_WAITING {
        core::hint::spin_loop();
    } else {
        std::thread::yield_now();
    }
    rounds.saturating_add(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::testing::Fresh;
    use crate::parallel::threads::Alone;

    /// Adds up `numbers`, halved until they are few.
    fn sum(workers: &Workers, numbers: &[u64]) -> u64 {
        if numbers.len() < 4 {
            return numbers.iter().sum();
        }
        let (left, right) = numbers.split_at(numbers.len() / 2);
        let (mut a, mut b) = (0, 0);
        workers.join(&mut || a = sum(workers, left), &mut || b = sum(workers, right));
        a + b
    }

    #[test]
    fn every_job_is_done_once_whoever_comes() {
        let numbers: Vec<u64> = (0..100).collect();
        for threads in [&Alone as &dyn Threads, &Fresh(1), &Fresh(2), &Fresh(4), &Fresh(20)] {
            let mut total = 0;
            Workers::run(threads, &mut |workers| {
                (0..20).for_each(|_| total += sum(workers, &numbers));
            });
            assert_eq!(total, 20 * 4950);
        }
    }

    /// With two threads the helper does come, and has its part.
    #[test]
    #[cfg_attr(target_family = "wasm", ignore = "needs threads")]
    fn a_helper_that_has_come_is_used() {
        let mut of_helper = None;
        Workers::run(&Fresh(2), &mut |workers| {
            while workers.count() < 2 {
                std::thread::yield_now();
            }
            workers.join(&mut || {}, &mut || of_helper = Some(std::thread::current().id()));
        });
        assert!(of_helper.is_some_and(|id| id != std::thread::current().id()));
    }

    #[test]
    #[cfg_attr(target_family = "wasm", ignore = "needs threads")]
    fn a_panic_waits_for_the_other_half() {
        let finished = AtomicBool::new(false);
        let outcome = std::panic::catch_unwind(|| {
            Workers::run(&Fresh(2), &mut |workers| {
                while workers.count() < 2 {
                    std::thread::yield_now();
                }
                workers.join(&mut || panic!("on purpose"), &mut || {
                    std::thread::sleep(core::time::Duration::from_millis(20));
                    finished.store(true, Ordering::Release);
                });
            });
        });
        assert!(outcome.is_err() && finished.load(Ordering::Acquire));
    }
}
