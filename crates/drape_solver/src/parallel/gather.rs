//! Shares a list out to workers, each of whom gathers results of its own.
//!
//! ```text
//!   items    | 1st part     | 2nd part     | 3rd part     |
//!   results  | found        | spare[0]     | spare[1]     |   then all are appended to `found`, in order
//! ```
//!
//! Design: `docs/design/sweeps_and_threads.md`.

use crate::parallel::workers::Workers;

/// Results that are gathered in parts.
pub(crate) trait Gathered: Default + Send {
    /// Takes over the results of a later part, which is empty then.
    fn append(&mut self, later: &mut Self);
}

impl<T: Send> Gathered for Vec<T> {
    fn append(&mut self, later: &mut Self) {
        self.append(later);
    }
}

/// Results of the later parts, kept so that a warm step allocates nothing.
pub(crate) type Spare<R> = Vec<R>;

/// Items of a part come in multiples of this: whole vectors of sixteen.
const STEP: usize = 16;

/// Does `work` on all items, and adds what it finds to `found`, in the order of the items: the result does not depend on the
/// workers. Each part has at least so many items.
pub(crate) fn gather<I: Send, R: Gathered>(
    items: &mut [I],
    least: usize,
    workers: &Workers,
    spare: &mut Spare<R>,
    found: &mut R,
    work: &(dyn Fn(&mut [I], &mut R) + Sync),
) {
    let parts = (items.len() / least).clamp(1, workers.count());
    if spare.len() + 1 < parts {
        spare.resize_with(parts - 1, R::default);
    }
    let later = &mut spare[..parts - 1];
    share(items, found, later, workers, work);
    later.iter_mut().for_each(|later| found.append(later));
}

/// Shares the items among as many parts as there are results.
fn share<I: Send, R: Gathered>(
    items: &mut [I],
    found: &mut R,
    later: &mut [R],
    workers: &Workers,
    work: &(dyn Fn(&mut [I], &mut R) + Sync),
) {
    let parts = later.len() + 1;
    let before = parts / 2;
    if before == 0 {
        work(items, found);
        return;
    }
    let middle = items.len() * before / parts / STEP * STEP;
    let (items, other_items) = items.split_at_mut(middle);
    let (later, others) = later.split_at_mut(before - 1);
    let Some((other, others)) = others.split_first_mut() else { return };
    workers.join(&mut || share(items, found, later, workers, work), &mut || {
        share(other_items, other, others, workers, work);
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::testing::Fresh;
    use crate::parallel::threads::{Alone, Threads};

    #[test]
    #[cfg_attr(target_family = "wasm", ignore = "needs threads")]
    fn all_is_found_in_order_by_any_number_of_workers() {
        for threads in [&Alone as &dyn Threads, &Fresh(2), &Fresh(3), &Fresh(5)] {
            for count in [0, 1, 15, 16, 100, 1000] {
                let expected: Vec<usize> = (0..count).filter(|number| number % 3 == 0).collect();
                Workers::run(threads, &mut |workers| {
                    while workers.count() < workers.most() {
                        std::thread::yield_now();
                    }
                    let mut items: Vec<usize> = (0..count).collect();
                    let (mut spare, mut found) = (Spare::default(), Vec::<usize>::new());
                    for _ in 0..2 {
                        found.clear();
                        gather(&mut items, 16, workers, &mut spare, &mut found, &|items, found| {
                            found.extend(items.iter().filter(|number| **number % 3 == 0));
                        });
                        assert_eq!(found, expected);
                    }
                });
            }
        }
    }
}
