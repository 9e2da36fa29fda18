//! Disjoint sets of numbers, as a forest in which each number points towards the least of its set (Galler and Fischer
//! 1964, "An improved equivalence algorithm").
//!
//! Design: `docs/design/rest_and_islands.md`.

/// Numbers from 0 on, in disjoint groups.
#[derive(Clone, Debug, Default)]
pub(crate) struct Groups(Vec<u32>);

impl Groups {
    /// Puts each of `count` numbers into a group of its own.
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// Puts each of `count` numbers into a group of its own again, and keeps the memory.
    pub fn reset(&mut self, count: usize) {
        self.0.clear();
        self.0.extend(0..count as u32);
    }

    /// The least number of the group of `i`. Halves the path to it, which speeds up later searches.
    pub fn root(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            let above = self.0[self.0[i as usize] as usize];
            self.0[i as usize] = above;
            i = above;
        }
        i
    }

    /// Merges the groups of `a` and `b`; false if they were one already.
    pub fn join(&mut self, a: u32, b: u32) -> bool {
        if self.0[a as usize] == self.0[b as usize] {
            return false;
        }
        let (p, q) = (self.root(a), self.root(b));
        self.0[p.max(q) as usize] = p.min(q);
        p != q
    }
}
