//! Renumbering: an order of the particles of an irregular mesh in which neighbours are near each other in memory.
//!
//! A modeller may number vertices in any order; sticks then jump about in memory. The order of Cuthill and `McKee` (1969,
//! "Reducing the bandwidth of sparse symmetric matrices") goes through the mesh breadth first, from a vertex at its rim,
//! level by level. A stick ends in the level where it begins, or in the next.
//!
//! ```text
//!   as it was      renumbered     levels
//!   7---2---6      0---2---5      0 | 1 2 | 3 4 5 | 6 7 | 8
//!   |   |   |      |   |   |
//!   4---0---3      1---4---7      the ends of a stick are at most 3 apart, and not 7
//!   |   |   |      |   |   |
//!   8---5---1      3---6---8
//! ```
//!
//! Design: `docs/design/memory_layout.md`.

/// The map from particles to slots, and back.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Renumbering {
    slots: Box<[u32]>,
    indices: Box<[u32]>,
}

impl Renumbering {
    /// A better order for `count` particles joined by these sticks; none if the present one is as good.
    pub fn new(count: usize, sticks: &[(u32, u32)]) -> Option<Self> {
        let renumbering = Self::of_order(&Graph::new(count, sticks).breadth_first())?;
        let slots = &renumbering.slots;
        let greatest = |gap: &dyn Fn(u32, u32) -> u32| sticks.iter().map(|&(a, b)| gap(a, b)).max();
        let before = greatest(&|a, b| a.abs_diff(b));
        let after = greatest(&|a, b| slots[a as usize].abs_diff(slots[b as usize]));
        (after < before).then_some(renumbering)
    }

    /// That of these particles, slot by slot; none unless each is there once.
    pub fn of_order(indices: &[u32]) -> Option<Self> {
        let mut slots = vec![u32::MAX; indices.len()];
        for (slot, &index) in (0..).zip(indices) {
            *slots.get_mut(index as usize).filter(|slot| **slot == u32::MAX)? = slot;
        }
        Some(Self { slots: slots.into(), indices: indices.into() })
    }

    /// The number of particles.
    pub fn count(&self) -> usize {
        self.slots.len()
    }

    /// The slot of particle `index`.
    #[inline]
    pub fn slot(&self, index: usize) -> usize {
        self.slots[index] as usize
    }

    /// The particle in `slot`; none behind the last.
    pub fn index(&self, slot: usize) -> Option<usize> {
        self.indices.get(slot).map(|&index| index as usize)
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.slots) + size_of_val(&*self.indices)
    }
}

/// The neighbours of each particle, those with the fewest neighbours first.
struct Graph {
    /// Index of each particle's first neighbour in `neighbours`; one more at the end.
    first: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Graph {
    fn new(count: usize, sticks: &[(u32, u32)]) -> Self {
        let mut first = vec![0; count + 1];
        for end in sticks.iter().flat_map(|&(a, b)| [a, b]) {
            first[end as usize + 1] += 1;
        }
        for particle in 0..count {
            first[particle + 1] += first[particle];
        }
        let mut neighbours = vec![0; 2 * sticks.len()];
        let mut next = first.clone();
        for (from, to) in sticks.iter().flat_map(|&(a, b)| [(a, b), (b, a)]) {
            neighbours[next[from as usize] as usize] = to;
            next[from as usize] += 1;
        }
        let degree = |particle: u32| first[particle as usize + 1] - first[particle as usize];
        for particle in 0..count {
            let own = first[particle] as usize..first[particle + 1] as usize;
            neighbours[own].sort_unstable_by_key(|&neighbour| (degree(neighbour), neighbour));
        }
        Self { first, neighbours }
    }

    fn neighbours(&self, particle: u32) -> &[u32] {
        &self.neighbours[self.first[particle as usize] as usize..self.first[particle as usize + 1] as usize]
    }

    /// All particles, component by component, each breadth first from a particle at its rim.
    fn breadth_first(&self) -> Vec<u32> {
        let count = self.first.len() - 1;
        let mut order = Vec::with_capacity(count);
        let mut level = vec![UNSEEN; count];
        for particle in 0..count as u32 {
            if level[particle as usize] == UNSEEN {
                let start = self.rim(particle, &mut order, &mut level);
                self.visit(start, &mut order, &mut level);
            }
        }
        order
    }

    /// A particle at the rim of the component of `particle`: one from which there are no fewer levels than from the
    /// best of those farthest from it (George and Liu 1979, "An implementation of a pseudoperipheral node finder").
    fn rim(&self, particle: u32, order: &mut Vec<u32>, level: &mut [u32]) -> u32 {
        let begin = order.len();
        let mut start = particle;
        let mut depth = 0;
        loop {
            self.visit(start, order, level);
            let deepest = order.last().map_or(0, |&last| level[last as usize]);
            let farthest = order[begin..].iter().copied().filter(|&p| level[p as usize] == deepest);
            let next = farthest.min_by_key(|&p| (self.neighbours(p).len(), p));
            for visited in order.drain(begin..) {
                level[visited as usize] = UNSEEN;
            }
            match next {
                Some(next) if deepest > depth => (start, depth) = (next, deepest),
                _ => return start,
            }
        }
    }

    /// Appends the component of `start` to `order`, level by level.
    fn visit(&self, start: u32, order: &mut Vec<u32>, level: &mut [u32]) {
        let mut next = order.len();
        level[start as usize] = 0;
        order.push(start);
        while let Some(&particle) = order.get(next) {
            for &neighbour in self.neighbours(particle) {
                if level[neighbour as usize] == UNSEEN {
                    level[neighbour as usize] = level[particle as usize] + 1;
                    order.push(neighbour);
                }
            }
            next += 1;
        }
    }
}

const UNSEEN: u32 = u32::MAX;

#[cfg(test)]
mod tests {
    use super::*;

    fn is_permutation(numbers: &Renumbering) -> bool {
        (0..numbers.count()).all(|index| numbers.index(numbers.slot(index)) == Some(index))
            && numbers.index(numbers.count()).is_none()
    }

    /// The numbers from 0 to `count`, shuffled.
    fn shuffled(count: u32) -> Vec<u32> {
        let mut order: Vec<u32> = (0..count).collect();
        order.sort_by_key(|&i| (i.wrapping_mul(0x9e37_79b9), i));
        order
    }

    fn greatest_gap(numbers: &Renumbering, sticks: &[(u32, u32)]) -> usize {
        let gap = |&(a, b): &(u32, u32)| numbers.slot(a as usize).abs_diff(numbers.slot(b as usize));
        sticks.iter().map(gap).max().unwrap_or(0)
    }

    #[test]
    fn a_chain_stays_a_chain() {
        let links: Vec<(u32, u32)> = (0..999).map(|i| (i, i + 1)).collect();
        assert!(Renumbering::new(1000, &links).is_none(), "in order already");
        let order = shuffled(1000);
        let links: Vec<(u32, u32)> =
            links.iter().map(|&(a, b)| (order[a as usize], order[b as usize])).collect();
        let numbers = Renumbering::new(1000, &links).expect("a better order");
        assert!(is_permutation(&numbers));
        assert_eq!(greatest_gap(&numbers, &links), 1);
    }

    #[test]
    #[cfg_attr(miri, ignore = "it takes a sheet of 2,500")]
    fn neighbours_of_a_shuffled_sheet_are_about_a_row_apart() {
        let (side, order) = (50_u32, shuffled(2500));
        let at = |column: u32, row: u32| order[(row * side + column) as usize];
        let mut sticks = Vec::new();
        for (column, row) in (0..side).flat_map(|row| (0..side).map(move |column| (column, row))) {
            if column + 1 < side {
                sticks.push((at(column, row), at(column + 1, row)));
            }
            if row + 1 < side {
                sticks.push((at(column, row), at(column, row + 1)));
            }
        }
        let numbers = Renumbering::new(2500, &sticks).expect("a better order");
        assert!(is_permutation(&numbers));
        assert!(greatest_gap(&numbers, &sticks) <= 2 * side as usize);
    }

    /// Two components and loose particles: all have a slot, and components are not mixed.
    #[test]
    fn parts_follow_each_other() {
        let even: Vec<(u32, u32)> = (0..99).map(|i| (2 * i, 2 * i + 2)).collect();
        let odd = (0..49).map(|i| (2 * i + 1, 2 * i + 3));
        let sticks: Vec<(u32, u32)> = even.into_iter().chain(odd).collect();
        let numbers = Renumbering::new(210, &sticks).expect("a better order");
        assert!(is_permutation(&numbers));
        assert_eq!(greatest_gap(&numbers, &sticks), 1);
    }
}
