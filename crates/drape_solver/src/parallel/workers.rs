//! Helpers that stand by for the length of a step.
//!
//! A body is shared out anew in every trip down its strips, tenths of a millisecond apart; to wake a thread takes as long.
//! So the threads of the host are asked once a step, and those that come wait in a loop for work until they are
//! dismissed. Nobody waits for one to come: until it does, the work is done without it.
//!
//! ```text
//!   leader  | alone ------ | upper half | wedge | upper half | wedge |
//!   helper  | wakes up ... | lower half |  ...  | lower half |  ...  | dismissed
//! ```

#![expect(unsafe_code, reason = "a closure that borrows is handed to a thread that outlives the borrow")]

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use crate::parallel::threads::Threads;

/// The most helpers that a workers has work for.
const MOST_HELPERS: usize = 7;

/// Rounds of waiting after which a thread lets others have its core.
const ROUNDS_OF_WAITING: u32 = 1 << 14;

type Job<'a> = &'a mut (dyn FnMut() + Send);

/// A leader's helpers.
#[derive(Default)]
pub(crate) struct Workers {
    places: [WorkerSlot; MOST_HELPERS],
    is_dismissed: AtomicBool,
    /// How many were called.
    called: usize,
}

/// Where one helper stands.
#[repr(align(128))]
#[derive(Default)]
struct WorkerSlot {
    state: AtomicU32,
    job: UnsafeCell<Option<Job<'static>>>,
}

/// Nobody has come, or has left again.
const EMPTY: u32 = 0;
/// A helper waits for work.
const IDLE: u32 = 1;
/// Somebody is about to give it work.
const CLAIMED: u32 = 2;
/// The work is there: until it is done, it is the helper's.
const WORKING: u32 = 3;
/// The work is done: the place is that of whoever gave it.
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

    /// Calls helpers, one beside the other, and runs `lead`.
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
    /// How many there are now, with the leader: those that have come and have nothing to do.
    pub fn count(&self) -> usize {
        1 + self.places.iter().filter(|place| place.state.load(Ordering::Relaxed) == IDLE).count()
    }

    /// How many there may be in a moment.
    pub fn most(&self) -> usize {
        1 + self.called
    }

    /// Runs both, at the same time if a helper has nothing to do, and returns when both are through.
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

/// Lets all helpers go when the leader is through, or panics.
struct Release<'a>(&'a Workers);

impl Drop for Release<'_> {
    fn drop(&mut self) {
        self.0.is_dismissed.store(true, Ordering::Release);
    }
}

/// Says that the work is done when it is, or panics.
struct Done<'a>(&'a WorkerSlot);

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.state.store(DONE, Ordering::Release);
    }
}

/// Waits until the work that was given is done.
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
    use crate::parallel::threads::Alone;

    /// Threads of the standard library, a new one for each call.
    struct Fresh(usize);

    impl Threads for Fresh {
        fn count(&self) -> usize {
            self.0
        }

        fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
            std::thread::scope(|scope| {
                scope.spawn(other);
                one();
            });
        }
    }

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
