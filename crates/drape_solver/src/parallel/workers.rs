//! Workers: threads that wait for work in a loop for the length of a step.
//!
//! A body is divided anew in every trip down its strips, tenths of a millisecond apart, and waking a thread takes as
//! long. So the leader calls the host's threads once a step, and those that come wait in a loop for work until they are
//! dismissed. A helper sleeps after a while without work, and the next offer wakes it.
//!
//! The leader never waits for a helper to come: until then, it does the work alone. Nor for one that has lost its core to
//! another thread of the game: what a helper has not begun when the leader is through, the leader takes back and does itself.
//!
//! ```text
//!   leader  | alone ------ | upper half | wedge | upper half | lower half | wedge |
//!   helper  | wakes up ... | lower half |  ...  |  (has no core)  ...             | dismissed
//! ```
//!
//! Design: `docs/design/sweeps_and_threads.md`.

#![expect(unsafe_code, reason = "a closure that borrows is handed to a thread that outlives the borrow")]

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::OnceLock;
use std::thread::Thread;

use crate::parallel::threads::Threads;

/// The greatest number of helpers that get work.
const MOST_HELPERS: usize = 7;

/// The number of rounds of waiting after which a helper sleeps and a leader yields its core: a fifth of a millisecond or less.
const ROUNDS_OF_WAITING: u32 = 1 << 12;

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
    helper: OnceLock<Thread>,
}

/// No helper is in this place.
const EMPTY: u32 = 0;
/// A helper waits for work in a loop.
const IDLE: u32 = 1;
/// A helper sleeps until there is work.
const ASLEEP: u32 = 2;
/// A thread has claimed the place, to put a job into it or to take one back.
const CLAIMED: u32 = 3;
/// There is a job, which the helper may begin and the thread that gave it may take back.
const OFFERED: u32 = 4;
/// The helper owns the place until it has done the job.
const WORKING: u32 = 5;
/// The job is done: the place belongs to the thread that gave it.
const DONE: u32 = 6;

// SAFETY: `job` is only touched by the thread that `state` names: whoever moved it from IDLE, ASLEEP or OFFERED to CLAIMED, until it
// stores OFFERED or IDLE; and the helper from when it moved it from OFFERED to WORKING, until it stores DONE. These stores release,
// and the exchanges and loads that see them acquire.
unsafe impl Sync for WorkerSlot {}

impl WorkerSlot {
    /// Moves the state from one to another, if it is in the first.
    fn shift(&self, from: u32, to: u32) -> bool {
        self.state.compare_exchange(from, to, Ordering::SeqCst, Ordering::Relaxed).is_ok()
    }

    /// Wakes the helper.
    fn wake(&self) {
        self.helper.get().into_iter().for_each(Thread::unpark);
    }
}

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
        if self.is_dismissed.load(Ordering::SeqCst) {
            return;
        }
        place.helper.get_or_init(std::thread::current);
        place.state.store(IDLE, Ordering::Release);
        // Rounds without work, and rounds until the thread that gave the last job takes the place back.
        let [mut idle, mut done] = [0; 2];
        loop {
            match place.state.load(Ordering::Acquire) {
                OFFERED if place.shift(OFFERED, WORKING) => {
                    // SAFETY: the state is WORKING, so the place is this thread's until `Done` is dropped.
                    let job = unsafe { (*place.job.get()).take() };
                    let _done = Done(place);
                    if let Some(job) = job {
                        job();
                    }
                    idle = 0;
                }
                IDLE if self.is_dismissed.load(Ordering::SeqCst) => {
                    if place.shift(IDLE, EMPTY) {
                        return;
                    }
                }
                IDLE if idle >= ROUNDS_OF_WAITING && place.shift(IDLE, ASLEEP) => {
                    self.sleep(place);
                    idle = 0;
                }
                IDLE => {
                    done = 0;
                    wait(&mut idle);
                }
                _ => {
                    idle = 0;
                    wait(&mut done);
                }
            }
        }
    }

    /// Sleeps until there is an offer, or until dismissed.
    fn sleep(&self, place: &WorkerSlot) {
        while place.state.load(Ordering::Acquire) == ASLEEP {
            // The leader first dismisses and then looks who sleeps, so one of the two sees the other.
            if self.is_dismissed.load(Ordering::SeqCst) {
                place.shift(ASLEEP, IDLE);
                return;
            }
            std::thread::park();
        }
    }
}

impl Workers {
    /// The number of workers that are free now: the leader, and the helpers that have come and wait.
    pub fn count(&self) -> usize {
        let is_free = |place: &&WorkerSlot| matches!(place.state.load(Ordering::Relaxed), IDLE | ASLEEP);
        1 + self.places.iter().filter(is_free).count()
    }

    /// The greatest number of workers that may be free in a moment.
    pub fn most(&self) -> usize {
        1 + self.called
    }

    /// Runs both closures, at the same time if a helper begins the other one in time, and returns when both have ended.
    pub fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        // Those that are awake come first.
        let mut places =
            [IDLE, ASLEEP].into_iter().flat_map(|state| self.places.iter().map(move |place| (place, state)));
        let Some((place, state)) = places.find(|(place, state)| place.shift(*state, CLAIMED)) else {
            one();
            other();
            return;
        };
        // SAFETY: only the lifetime is changed. The job is not used after this function returns, or unwinds: `Offer` does not let
        // it before the job is taken back, or the helper has stored DONE, after which the helper does not touch the job again.
        let job = unsafe { core::mem::transmute::<Job<'_>, Job<'static>>(&mut *other) };
        // SAFETY: the state is CLAIMED by this thread.
        unsafe { *place.job.get() = Some(job) };
        let mut offer = Offer { place, is_open: true };
        place.state.store(OFFERED, Ordering::Release);
        if state == ASLEEP {
            place.wake();
        }
        one();
        if offer.end() {
            other();
        }
    }
}

/// Dismisses all helpers when the leader ends or panics.
struct Release<'a>(&'a Workers);

impl Drop for Release<'_> {
    fn drop(&mut self) {
        self.0.is_dismissed.store(true, Ordering::SeqCst);
        let is_asleep = |place: &&WorkerSlot| place.state.load(Ordering::SeqCst) == ASLEEP;
        self.0.places.iter().filter(is_asleep).for_each(WorkerSlot::wake);
    }
}

/// Marks the job as done when it ends or panics.
struct Done<'a>(&'a WorkerSlot);

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.state.store(DONE, Ordering::Release);
    }
}

/// A job that was offered to a helper.
struct Offer<'a> {
    place: &'a WorkerSlot,
    is_open: bool,
}

impl Offer<'_> {
    /// Takes the job back if the helper has not begun it, which is true then; else waits until it is done.
    fn end(&mut self) -> bool {
        self.is_open = false;
        let is_taken_back = self.place.shift(OFFERED, CLAIMED);
        if is_taken_back {
            // SAFETY: the state is CLAIMED by this thread.
            unsafe { *self.place.job.get() = None };
        } else {
            let mut rounds = 0;
            while self.place.state.load(Ordering::Acquire) != DONE {
                wait(&mut rounds);
            }
        }
        self.place.state.store(IDLE, Ordering::Release);
        is_taken_back
    }
}

/// Waits for one more round.
fn wait(rounds: &mut u32) {
    if *rounds < ROUNDS_OF_WAITING {
        *rounds += 1;
        core::hint::spin_loop();
    } else {
        std::thread::yield_now();
    }
}

impl Drop for Offer<'_> {
    fn drop(&mut self) {
        if self.is_open {
            self.end();
        }
    }
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
            until(|| workers.count() == 2);
            let begun = AtomicBool::new(false);
            workers.join(&mut || until(|| begun.load(Ordering::Acquire)), &mut || {
                of_helper = Some(std::thread::current().id());
                begun.store(true, Ordering::Release);
            });
        });
        assert!(of_helper.is_some_and(|id| id != std::thread::current().id()));
    }

    fn until(is_so: impl Fn() -> bool) {
        while !is_so() {
            std::thread::yield_now();
        }
    }

    #[test]
    #[cfg_attr(target_family = "wasm", ignore = "needs threads")]
    fn a_panic_waits_for_the_other_half() {
        let [begun, finished] = [const { AtomicBool::new(false) }; 2];
        let outcome = std::panic::catch_unwind(|| {
            Workers::run(&Fresh(2), &mut |workers| {
                until(|| workers.count() == 2);
                let mut one = || {
                    until(|| begun.load(Ordering::Acquire));
                    panic!("on purpose");
                };
                workers.join(&mut one, &mut || {
                    begun.store(true, Ordering::Release);
                    std::thread::sleep(core::time::Duration::from_millis(20));
                    finished.store(true, Ordering::Release);
                });
            });
        });
        assert!(outcome.is_err() && finished.load(Ordering::Acquire));
    }

    /// A helper may have lost its core, and the leader must not wait for it: it took 35 s for what it does in 14 s alone, on two cores of
    /// which one was busy with another program. If this fails, it hangs.
    #[test]
    fn what_a_helper_does_not_begin_is_taken_back() {
        let workers = Workers { called: 1, ..Workers::default() };
        // It waits, and never looks.
        for state in [IDLE, ASLEEP] {
            workers.places[0].state.store(state, Ordering::Release);
            let (mut ones, mut others) = (0, 0);
            for _ in 0..10 {
                workers.join(&mut || ones += 1, &mut || others += 1);
            }
            assert_eq!((ones, others), (10, 10));
            assert_eq!(workers.count(), 2, "it is free again");
        }
    }

    #[test]
    #[cfg_attr(target_family = "wasm", ignore = "needs threads")]
    fn a_helper_that_sleeps_is_woken_by_an_offer() {
        let mut of_helper = None;
        Workers::run(&Fresh(2), &mut |workers| {
            until(|| workers.places.iter().any(|place| place.state.load(Ordering::Acquire) == ASLEEP));
            let begun = AtomicBool::new(false);
            workers.join(&mut || until(|| begun.load(Ordering::Acquire)), &mut || {
                of_helper = Some(std::thread::current().id());
                begun.store(true, Ordering::Release);
            });
            until(|| workers.places.iter().any(|place| place.state.load(Ordering::Acquire) == ASLEEP));
        });
        assert!(of_helper.is_some_and(|id| id != std::thread::current().id()));
    }
}
