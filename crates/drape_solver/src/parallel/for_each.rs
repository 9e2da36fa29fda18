//! Shares out independent things to threads.

use crate::parallel::threads::Threads;
use crate::parallel::workers::Workers;

/// Shares for each thread: those that are through early take over from those that are not.
const SHARES_PER_THREAD: usize = 4;

/// Does `work` on all of `things`, on several threads at once.
pub(crate) fn for_each<T: Send>(things: &mut [T], threads: &dyn Threads, work: &(dyn Fn(&mut T) + Sync)) {
    let share = things.len().div_ceil(threads.count() * SHARES_PER_THREAD).max(1);
    split(things, share, threads, work);
}

fn split<T: Send>(things: &mut [T], share: usize, threads: &dyn Threads, work: &(dyn Fn(&mut T) + Sync)) {
    if things.len() <= share {
        things.iter_mut().for_each(work);
        return;
    }
    let (one, other) = things.split_at_mut(things.len() / 2);
    threads.join(&mut || split(one, share, threads, work), &mut || split(other, share, threads, work));
}

/// The number of things that have half of all `sizes`, as nearly as can be; none if a side would have less than `least`, or if no worker
/// is free for the other.
pub(crate) fn balanced_cut(
    sizes: impl Iterator<Item = usize> + Clone,
    least: usize,
    workers: &Workers,
) -> Option<usize> {
    if workers.count() < 2 {
        return None;
    }
    let total: usize = sizes.clone().sum();
    let mut before = 0;
    let cuts = (1..).zip(sizes).map(|(count, size)| {
        before += size;
        ((2 * before).abs_diff(total), count, before.min(total - before))
    });
    cuts.min().filter(|&(.., smaller)| smaller >= least).map(|(_, count, _)| count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::testing::Fresh;
    use crate::parallel::threads::Alone;

    #[test]
    fn each_is_worked_on_once() {
        for threads in [&Alone as &dyn Threads, &Fresh(2), &Fresh(5)] {
            for count in [0, 1, 2, 7, 100] {
                let mut things: Vec<usize> = (0..count).collect();
                for_each(&mut things, threads, &|thing| *thing += 1);
                assert_eq!(things, (1..=count).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    #[cfg_attr(target_family = "wasm", ignore = "needs threads")]
    fn a_cut_leaves_as_much_on_both_sides_as_can_be() {
        Workers::run(&Fresh(2), &mut |workers| {
            while workers.count() < 2 {
                std::thread::yield_now();
            }
            for (sizes, cut) in [
                (&[][..], 0),
                (&[5], 1),
                (&[3, 3], 1),
                (&[1, 9, 1], 1),
                (&[4, 3, 2, 1], 1),
                (&[1, 2, 3, 4], 3),
            ] {
                let found = balanced_cut(sizes.iter().copied(), 0, workers);
                assert_eq!(found.unwrap_or(0), cut, "{sizes:?}");
            }
            assert_eq!(balanced_cut([5, 4].into_iter(), 4, workers), Some(1));
            assert_eq!(balanced_cut([5, 4].into_iter(), 5, workers), None, "a side is too small");
            assert_eq!(balanced_cut([5, 5].into_iter(), 5, &Workers::default()), None, "nobody is free");
        });
    }
}
