//! Groups of bodies that contacts or joints hold together.

use crate::math::fast_hash::FastMap;

/// Groups of bodies, by one of each that stands for all.
#[derive(Default)]
pub struct BodyGroups {
    next: FastMap<usize, usize>,
}

impl BodyGroups {
    /// The body that stands for the group of another.
    pub fn of(&self, mut body: usize) -> usize {
        while let Some(next) = self.next.get(&body) {
            body = *next;
        }
        body
    }

    /// Makes the groups of two bodies one.
    pub fn join(&mut self, bodies: [usize; 2]) {
        let [a, b] = bodies.map(|body| self.of(body));
        if a != b {
            self.next.insert(a, b);
        }
    }
}
