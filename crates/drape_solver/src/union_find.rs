//! Groups of what hangs together: a forest in which each points towards the first of its group (Galler and Fischer 1964, "An
//! improved equivalence algorithm").

/// The groups of numbers from 0 on.
#[derive(Clone, Debug, Default)]
pub(crate) struct Groups(Vec<u32>);

impl Groups {
    /// Each of `count` numbers in a group of its own.
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// The same again, keeping the memory.
    pub fn reset(&mut self, count: usize) {
        self.0.clear();
        self.0.extend(0..count as u32);
    }

    /// The least number of the group that `i` is in; the way there is shortened.
    pub fn root(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            let above = self.0[self.0[i as usize] as usize];
            self.0[i as usize] = above;
            i = above;
        }
        i
    }

    /// Makes the groups of both one.
    pub fn join(&mut self, a: u32, b: u32) {
        let (p, q) = (self.root(a), self.root(b));
        self.0[p.max(q) as usize] = p.min(q);
    }
}
