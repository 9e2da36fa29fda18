//! Listed sticks as data: those of irregular meshes and rigs, whose ends are stored.
//!
//! A batch has its sticks in the order of slots, cut into the blocks of particles where they begin;
//! `constraint/listed_stick.rs` relaxes them.
//!
//! Design: `docs/design/listed_sticks.md`.

use crate::simd::rows::{BLOCK, block_count};

/// The number of sticks that are relaxed at once.
pub(crate) const GROUP: usize = 8;

/// The ends and lengths of some sticks, side by side, so that they come into the cache together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub(crate) struct StickGroup {
    /// Starts of the rows of the two ends: four times their slots.
    pub ends: [[u32; GROUP]; 2],
    /// Metres.
    pub rest_lengths: [f32; GROUP],
}

/// All listed sticks of a body, batch after batch. A batch begins with a new group.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ListedSticks {
    pub groups: Vec<StickGroup>,
    /// Index of the next stick.
    pub next: usize,
}

impl ListedSticks {
    /// True if there are no sticks.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Begins a new batch and returns the index of its first stick.
    pub fn begin_batch(&mut self) -> usize {
        self.next = self.groups.len() * GROUP;
        self.next
    }

    /// Adds a stick between two slots, `rest_length` metres apart.
    pub fn push(&mut self, slots: [u32; 2], rest_length: f32) {
        if self.next == self.groups.len() * GROUP {
            self.groups.push(StickGroup::default());
        }
        self.set(self.next, slots, rest_length);
        self.next += 1;
    }

    fn set(&mut self, place: usize, slots: [u32; 2], rest_length: f32) {
        let (group, lane) = (&mut self.groups[place / GROUP], place % GROUP);
        for (ends, slot) in group.ends.iter_mut().zip(slots) {
            ends[lane] = 4 * slot;
        }
        group.rest_lengths[lane] = rest_length;
    }

    /// Starts of the rows of the ends of stick `place`.
    #[inline(always)]
    pub fn ends(&self, place: usize) -> [u32; 2] {
        self.groups[place / GROUP].ends.map(|ends| ends[place % GROUP])
    }

    /// The slots of the ends of stick `place`.
    pub fn slots(&self, place: usize) -> [u32; 2] {
        self.ends(place).map(|first| first / 4)
    }

    /// The rest length of stick `place` in metres.
    #[inline(always)]
    pub fn rest_length(&self, place: usize) -> f32 {
        self.groups[place / GROUP].rest_lengths[place % GROUP]
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.groups)
    }
}

/// The sticks of one batch.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ListedBatch {
    /// Index of the first stick in the list of all.
    pub first: usize,
    /// True if no two of them share a particle.
    pub is_independent: bool,
    /// Index of the first stick of each block; one more at the end. A stick is in the block of its lower end, or, so
    /// that groups stay whole, in an earlier one.
    pub first_of_block: Vec<u32>,
    /// Greatest number of blocks from a stick's block to the one in which it ends.
    pub reach: usize,
}

impl ListedBatch {
    /// A batch of sticks from place `first` on, yet to be [arranged](Self::arrange).
    pub fn new(first: usize, is_independent: bool) -> Self {
        Self { first, is_independent, first_of_block: Vec::new(), reach: 0 }
    }

    /// Brings the batch's sticks, `count` in number, into the order of their slots.
    pub fn arrange(
        &mut self,
        sticks: &mut ListedSticks,
        count: usize,
        cells: usize,
        slot: impl Fn(u32) -> u32,
    ) {
        let places = self.first..self.first + count;
        let moved = |i: usize| (sticks.slots(i).map(&slot), sticks.rest_length(i));
        let mut order: Vec<([u32; 2], f32)> = places.clone().map(moved).collect();
        order.sort_by_key(|&([a, b], _)| (a.min(b), a.max(b)));
        for (i, &(slots, rest_length)) in places.zip(&order) {
            sticks.set(i, slots, rest_length);
        }
        let cuts = [1, GROUP].map(|group| cut(&order, block_count(cells), group));
        let reaches = cuts.each_ref().map(|cuts| reach(&order, cuts));
        // Groups stay whole, unless that would lengthen the reach.
        let [anywhere, at_groups] = cuts;
        let cuts = if reaches[1] > reaches[0] { anywhere } else { at_groups };
        self.reach = reaches[0].min(reaches[1]);
        self.first_of_block = cuts.into_iter().map(|place| (self.first + place) as u32).collect();
    }

    /// Greatest number of blocks from a stick's block to the one in which it ends.
    pub fn reach(&self) -> usize {
        self.reach
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.first_of_block)
    }
}

/// Index of the first stick of each block, for sticks in order of their lower ends; one more at the end. Groups of
/// `group` sticks are not cut.
fn cut(order: &[([u32; 2], f32)], blocks: usize, group: usize) -> Vec<usize> {
    let is_before = |block: usize| move |&([a, b], _): &([u32; 2], f32)| (a.min(b) as usize) < block * BLOCK;
    let first = |block| order.partition_point(is_before(block)).next_multiple_of(group).min(order.len());
    (0..=blocks).map(first).collect()
}

/// Greatest number of blocks from a stick's block to the one in which it ends.
fn reach(order: &[([u32; 2], f32)], cuts: &[usize]) -> usize {
    let block_of_end = |&([a, b], _): &([u32; 2], f32)| a.max(b) as usize / BLOCK;
    let blocks = cuts.windows(2).enumerate();
    let reaches = blocks.map(|(block, cut)| {
        let last = order[cut[0]..cut[1]].iter().map(block_of_end).max();
        last.map_or(0, |last| last.saturating_sub(block))
    });
    reaches.max().unwrap_or(0)
}
