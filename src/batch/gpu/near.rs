//! Sorts the device's list of primitive pairs, which `prove` in `shaders/cull.wgsl` writes, by mesh pair. A mesh pair
//! whose answer says that another number of them has to be there is left to the CPU: some found no room, or the
//! driver has not run all that it was given.

use super::Proposal;
use super::layout::{FREE, GIVEN_UP, MOST_MEETINGS, Near};

/// Primitives of one body of a mesh pair: index of the first among all on the device, and how many.
#[derive(Clone, Copy, Debug, Default)]
pub struct Range {
    /// The index.
    pub first: u32,
    /// The number.
    pub count: u32,
}

/// The answers to a batch of mesh pairs, in their order, and the primitive pairs that may come within reach.
#[derive(Clone, Debug, Default)]
pub struct Proposals {
    each: Vec<Proposal>,
    near: Vec<[u32; 2]>,
    /// Places at which the entries of each mesh pair, or piece of its step, begin, and the place at which the last end.
    starts: Vec<u32>,
    /// How many entries of each were found.
    found: Vec<u32>,
}

/// Mesh pairs of a batch whose lists are missing or not complete.
#[derive(Clone, Copy, Debug, Default)]
pub struct ListingGaps {
    /// Mesh pairs that were given up, or never begun.
    pub given_up: u64,
    /// Mesh pairs of which not all primitive pairs are listed.
    pub unlisted: u64,
}

impl Proposals {
    /// The primitive pairs that an answer lists: by their indices in the two meshes, in no order, and repeatedly where
    /// they are near in several pieces of the step. Empty for other answers.
    pub fn near(&self, proposal: Proposal) -> &[[u32; 2]] {
        let Proposal::Near { first, count } = proposal else {
            return &[];
        };
        let range = first as usize..(first + count) as usize;
        self.near.get(range).unwrap_or_default()
    }

    /// Takes over the answers to a range of mesh pairs of another batch, with their lists.
    pub fn take_part(&mut self, from: &Self, range: std::ops::Range<usize>) {
        self.clear();
        for &said in from.each.get(range).unwrap_or_default() {
            let near = from.near(said);
            let first = self.near.len() as u32;
            self.near.extend(near);
            self.each.push(match said {
                Proposal::Near { count, .. } => Proposal::Near { first, count },
                other => other,
            });
        }
    }

    /// Forgets all entries; memory is kept.
    pub fn clear(&mut self) {
        self.each.clear();
        self.near.clear();
    }

    /// Takes what the device says of a batch. Every mesh pair was asked in one piece or in several that follow each
    /// other: `asked` is the mesh pair of each, `ranges` its meshes' primitives, `answers` how many entries it has.
    /// Mesh pairs without a piece are unfit.
    pub fn take(
        &mut self,
        sweeps: usize,
        (asked, ranges): (&[u32], &[[Range; 2]]),
        answers: &[u32],
        list: &[[u8; size_of::<Near>()]],
        stamp: u32,
    ) -> ListingGaps {
        self.clear();
        self.each.resize(sweeps, Proposal::Unfit);
        let given_up = |answer: u32| !(FREE..GIVEN_UP).contains(&answer);
        // Without a list it is far more than any has entries.
        let lists = FREE..FREE + MOST_MEETINGS as u32;
        let is_open = |answer: u32| !lists.contains(&answer);
        let entries = |answer: u32| if is_open(answer) { 0 } else { answer - FREE };
        self.starts.clear();
        self.starts.push(0);
        self.found.clear();
        self.found.resize(answers.len(), 0);
        let mut end = 0;
        for &answer in answers {
            // The device never has more, whatever an answer says.
            end = u32::saturating_add(end, entries(answer)).min(MOST_MEETINGS as u32);
            self.starts.push(end);
        }
        self.near.resize(end as usize, [0; 2]);
        for entry in list {
            let entry: Near = bytemuck::cast(*entry);
            if entry.stamp == stamp {
                self.place(&entry, ranges);
            }
        }
        let mut found = ListingGaps::default();
        for (k, (&sweep, &answer)) in asked.iter().zip(answers).enumerate() {
            let said = &mut self.each[sweep as usize];
            let (first, count) = (self.starts[k], entries(answer));
            let is_whole = self.found[k] == count && self.starts[k + 1] - first == count;
            found.given_up += u64::from(given_up(answer));
            found.unlisted += u64::from(!is_whole);
            *said = match *said {
                _ if is_open(answer) || !is_whole => Proposal::Open,
                Proposal::Open => Proposal::Open,
                Proposal::Near { first, count: some } => Proposal::Near {
                    first,
                    count: some + count,
                },
                Proposal::Free | Proposal::Unfit if count == 0 => Proposal::Free,
                Proposal::Free | Proposal::Unfit => Proposal::Near { first, count },
            };
        }
        found
    }

    /// Puts an entry among those of its mesh pair. What the mesh pair has no room or no primitive for is counted as
    /// well, or left out: then the count is not right.
    fn place(&mut self, entry: &Near, ranges: &[[Range; 2]]) {
        let pair = entry.pair as usize;
        let (Some(ranges), Some(found)) = (ranges.get(pair), self.found.get_mut(pair)) else {
            return;
        };
        let indices = [0, 1].map(|k| entry.primitives[k].wrapping_sub(ranges[k].first));
        if (0..2).any(|k| indices[k] >= ranges[k].count) {
            return;
        }
        let place = self.starts[pair] + *found;
        if place < self.starts[pair + 1] {
            self.near[place as usize] = indices;
        }
        *found = found.saturating_add(1);
    }
}

impl std::ops::Deref for Proposals {
    type Target = [Proposal];
    fn deref(&self) -> &[Proposal] {
        &self.each
    }
}
