//! Groups of indices that are joined step by step (union and find). Source: Galler and Fisher, "An improved
//! equivalence algorithm" (1964).

/// Groups of indices; the lowest index of each stands for it.
pub struct Groups(Vec<u32>);

impl Groups {
    /// Groups in which each index is alone.
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// Adds an index, alone in its group, and returns it.
    pub fn add(&mut self) -> u32 {
        self.0.push(self.0.len() as u32);
        self.0.len() as u32 - 1
    }

    /// Index that stands for the group of another.
    pub fn find(&mut self, mut index: u32) -> u32 {
        while self.0[index as usize] != index {
            let up = self.0[index as usize];
            self.0[index as usize] = self.0[up as usize];
            index = up;
        }
        index
    }

    /// Makes the groups of two indices one.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
