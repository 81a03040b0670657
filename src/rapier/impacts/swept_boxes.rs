//! Boxes of the colliders of a step, each from its body's last impact to the end, and which of them meet: in a tree,
//! since every impact changes a few.

use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::partitioning::{Bvh, BvhBuildStrategy};

/// Boxes by the index of their collider.
#[derive(Default)]
pub struct SweptBoxes {
    all: Vec<Aabb>,
    tree: Bvh,
}

impl SweptBoxes {
    /// The boxes of all colliders.
    pub fn new(all: Vec<Aabb>) -> Self {
        let sound: Vec<Aabb> = all.iter().map(in_tree).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &sound);
        Self { all, tree }
    }

    /// Whether there are none yet.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Gives a collider another one.
    pub fn set(&mut self, k: usize, aabb: Aabb) {
        self.tree.insert(in_tree(&aabb), k as u32);
        self.all[k] = aabb;
    }

    /// Colliders whose boxes meet that of `k`, itself among them, in the order of their indices.
    pub fn meeting(&self, k: usize) -> Vec<usize> {
        let aabb = &self.all[k];
        let near = self.tree.intersect_aabb(aabb).map(|j| j as usize);
        let mut met: Vec<usize> = near.filter(|j| aabb.intersects(&self.all[*j])).collect();
        met.sort_unstable();
        met
    }
}

/// Box as the tree holds it: nothing where it has no numbers, so that boxes round it stay sound.
fn in_tree(aabb: &Aabb) -> Aabb {
    match aabb.mins.is_nan() || aabb.maxs.is_nan() {
        true => Aabb::new_invalid(),
        false => *aabb,
    }
}
