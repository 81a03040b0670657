//! `least_first!`: the order of entries of a `BinaryHeap` from which the least key leaves first.

/// Orders a struct by a key, a float that is not NaN, and of equal keys by ranks, so that of the entries of a
/// `BinaryHeap` the one with the least leaves first. `key + other` adds a second float, which counts before the ranks.
macro_rules! least_first {
    ($name:ty, $key:ident $(+ $more:ident)* $(, $rank:ident)*) => {
        impl Ord for $name {
            #[inline]
            fn cmp(&self, other: &Self) -> std::cmp::Ordering {
                // Reversed: a heap gives its greatest.
                other.$key.total_cmp(&self.$key)
                    $(.then_with(|| other.$more.total_cmp(&self.$more)))*
                    $(.then_with(|| other.$rank.cmp(&self.$rank)))*
            }
        }

        impl PartialOrd for $name {
            #[inline]
            fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
                Some(self.cmp(other))
            }
        }

        impl PartialEq for $name {
            fn eq(&self, other: &Self) -> bool {
                self.cmp(other).is_eq()
            }
        }

        impl Eq for $name {}
    };
}
pub(crate) use least_first;
