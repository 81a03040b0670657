//! The tree of bounding spheres over the primitives of a medial mesh, which all queries search.
//!
//! It is built once, in the body's frame: a rigid body keeps its shape, and a sphere keeps its radius
//! when it turns, so only the centre of a node moves with the body.

use super::simplex::Simplex;
use super::sphere::MedialSphere;
use crate::math::{Real, Vector};
use std::ops::Range;

/// A node of the tree: a sphere that encloses some primitives of a medial mesh.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// Centre, in the body's frame.
    pub center: Vector,
    /// Radius, such that the sphere encloses the primitives below it in spite of rounding.
    pub radius: Real,
    /// Leaf: index of its primitive. Inner: index of the first of two neighbouring children.
    index: u32,
    leaf: bool,
}

/// The children of a [`Node`], or its primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NodeKind {
    /// One primitive.
    Primitive(u32),
    /// Two nodes.
    Nodes(u32, u32),
}

impl Node {
    /// A node from its parts, for a tree that [`SphereTree::from_nodes`] checks.
    pub(super) fn new(center: Vector, radius: Real, below: NodeKind) -> Self {
        let (index, leaf) = match below {
            NodeKind::Primitive(index) => (index, true),
            NodeKind::Nodes(index, _) => (index, false),
        };
        Self {
            center,
            radius,
            index,
            leaf,
        }
    }

    /// The primitive or the children of the node.
    pub fn kind(&self) -> NodeKind {
        if self.leaf {
            NodeKind::Primitive(self.index)
        } else {
            NodeKind::Nodes(self.index, self.index + 1)
        }
    }
}

/// Depth of the deepest node of a tree that is loaded: what is built here splits off an eighth at least, so that no
/// tree of fewer than 2³² primitives is deeper, and what goes down one recursively has room.
const MAX_DEPTH: u32 = 192;

/// Bounding spheres over primitives; node 0 is the root.
#[derive(Clone, Debug)]
pub struct SphereTree {
    nodes: Vec<Node>,
}

impl SphereTree {
    /// Builds the tree top down, each node split where its two halves have the smallest surfaces.
    pub fn new(spheres: &[MedialSphere], primitives: &[Simplex]) -> Self {
        let all = (0..primitives.len() as u32).collect();
        Self::of_items(&Items::single(spheres, primitives, all))
    }

    /// Builds the tree in the same way, with the primitives of each group below a node of their own.
    pub fn of_groups(
        spheres: &[MedialSphere],
        primitives: &[Simplex],
        groups: &[Vec<u32>],
    ) -> Self {
        let mut items = Items::single(spheres, primitives, groups.concat());
        let mut end = 0;
        let range = |group: &Vec<u32>| {
            let start = end;
            end += group.len();
            start..end
        };
        items.ranges = groups.iter().map(range).collect();
        Self::of_items(&items)
    }

    fn of_items(items: &Items) -> Self {
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * items.order.len()),
        };
        tree.nodes.push(Node {
            center: Vector::ZERO,
            radius: 0.0,
            index: 0,
            leaf: true,
        });
        tree.build(0, items, &mut items.centers());
        tree
    }

    /// Takes the nodes of a tree built before over `primitives` primitives. Each node but the root has to
    /// be below exactly one that comes before it, and each primitive below exactly one: then every walk
    /// ends. No node may be deeper than [`MAX_DEPTH`]. Otherwise gives the first node that is wrong.
    pub(super) fn from_nodes(nodes: Vec<Node>, primitives: usize) -> Result<Self, usize> {
        let mut seen = vec![false; nodes.len() + primitives];
        let mut first = |index: usize| !std::mem::replace(&mut seen[index], true);
        let mut depths = vec![0u32; nodes.len()];
        for (i, node) in nodes.iter().enumerate() {
            let numbers = node.center.is_finite() && node.radius.is_finite() && node.radius >= 0.0;
            let index = node.index as usize;
            let sound = if node.leaf {
                index < primitives && first(nodes.len() + index)
            } else {
                index > i && index + 1 < nodes.len() && first(index) && first(index + 1)
            };
            if sound && !node.leaf {
                let depth = depths[i] + 1;
                depths[index..index + 2].fill(depth);
            }
            if !(numbers && sound && depths[i] <= MAX_DEPTH) {
                return Err(i);
            }
        }
        // A binary tree of so many leaves has this many nodes: none can be left out.
        if nodes.len() + 1 != 2 * primitives {
            return Err(nodes.len());
        }
        Ok(Self { nodes })
    }

    /// The nodes; the root first.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    fn build(&mut self, node: usize, all: &Items, items: &mut [Item]) {
        let alone = match *items {
            [(_, item)] => all.members(item),
            _ => &[],
        };
        if alone.len() > 1 {
            let group = Items::single(all.spheres, all.primitives, alone.to_vec());
            return self.build(node, &group, &mut group.centers());
        }
        (self.nodes[node].center, self.nodes[node].radius) =
            enclosing_sphere(all.spheres_of(items));
        if let [primitive] = *alone {
            self.nodes[node].index = primitive;
            return;
        }
        let middle = best_split(all, items);
        let first = self.nodes.len();
        let empty = self.nodes[node];
        self.nodes.push(Node {
            leaf: true,
            ..empty
        });
        self.nodes.push(Node {
            leaf: true,
            ..empty
        });
        self.nodes[node].index = first as u32;
        self.nodes[node].leaf = false;
        let (left, right) = items.split_at_mut(middle);
        self.build(first, all, left);
        self.build(first + 1, all, right);
    }
}

/// A middle, and the number of what is there among [`Items`].
type Item = (Vector, u32);

/// Items that a tree is built over: primitives, or groups of them.
struct Items<'a> {
    spheres: &'a [MedialSphere],
    primitives: &'a [Simplex],
    /// The primitives, item by item.
    order: Vec<u32>,
    /// Range of `order` that each item takes.
    ranges: Vec<Range<usize>>,
}

impl<'a> Items<'a> {
    /// One item for each of these primitives.
    fn single(spheres: &'a [MedialSphere], primitives: &'a [Simplex], order: Vec<u32>) -> Self {
        Self {
            spheres,
            primitives,
            ranges: (0..order.len()).map(|k| k..k + 1).collect(),
            order,
        }
    }

    fn members(&self, item: u32) -> &[u32] {
        &self.order[self.ranges[item as usize].clone()]
    }

    /// The middle of each item: that of the middles of its primitives.
    fn centers(&self) -> Vec<Item> {
        let middle = |i: &u32| {
            let p = &self.primitives[*i as usize];
            let n = Real::from(p.len);
            let sum = (0..p.len as usize)
                .map(|k| self.spheres[p.vertices[k] as usize].center)
                .fold(Vector::ZERO, |a, b| a + b);
            sum / n
        };
        let center = |item: u32| {
            let members = self.members(item);
            let sum = members.iter().map(middle).fold(Vector::ZERO, |a, b| a + b);
            (sum / members.len() as Real, item)
        };
        (0..self.ranges.len() as u32).map(center).collect()
    }

    /// The spheres of the primitives of these items.
    fn spheres_of(&self, items: &[Item]) -> impl Iterator<Item = MedialSphere> + Clone {
        (items.iter().flat_map(|&(_, item)| self.members(item)))
            .flat_map(|i| self.primitives[*i as usize].vertices)
            .map(|v| self.spheres[v as usize])
    }

    /// How many primitives these items have.
    fn count(&self, items: &[Item]) -> usize {
        let members = items.iter().map(|&(_, item)| self.members(item).len());
        members.sum()
    }
}

/// Candidate split positions per axis; more change the cost of a query by less than 2 %.
const SPLITS: usize = 8;

/// Orders the items along the axis, and gives the position, of the cheapest of a few splits: the
/// surface area heuristic with balls, `count × radius²` summed over both halves, a half's radius
/// being half the diagonal of its box.
fn best_split(all: &Items, items: &mut [Item]) -> usize {
    let n = items.len();
    let order = |items: &mut [Item], axis: usize| {
        items.sort_unstable_by(|a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    };
    let cost = |half: &[Item]| {
        let (lo, hi) = all.spheres_of(half).fold(
            (Vector::splat(Real::MAX), Vector::splat(Real::MIN)),
            |(lo, hi), s| {
                let r = Vector::splat(s.radius);
                (lo.min(s.center - r), hi.max(s.center + r))
            },
        );
        all.count(half) as Real * (hi - lo).length_squared()
    };
    let mut best = (Real::MAX, 0, n / 2);
    for axis in 0..3 {
        order(items, axis);
        for k in 1..SPLITS {
            let at = (n * k / SPLITS).clamp(1, n - 1);
            let total = cost(&items[..at]) + cost(&items[at..]);
            if total < best.0 {
                best = (total, axis, at);
            }
        }
    }
    order(items, best.1);
    best.2
}

/// A small sphere around others: centre of their box, moved towards the farthest sphere with
/// shrinking steps (Bădoiu and Clarkson), then the exact radius for that centre, rounded up.
fn enclosing_sphere(members: impl Iterator<Item = MedialSphere> + Clone) -> (Vector, Real) {
    let farthest = |c: Vector| {
        members
            .clone()
            .map(|s| ((s.center - c).length() + s.radius, s))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .unwrap_or_default()
    };
    let (lo, hi) = members.clone().fold(
        (Vector::splat(Real::MAX), Vector::splat(Real::MIN)),
        |(lo, hi), s| {
            let r = Vector::splat(s.radius);
            (lo.min(s.center - r), hi.max(s.center + r))
        },
    );
    let mut center = lo * 0.5 + hi * 0.5;
    let mut best = (farthest(center).0, center);
    /// Steps towards the farthest sphere, each shorter than the one before. With more the ball is smaller.
    const ROUNDS: usize = 24;
    for round in 1..=ROUNDS {
        let (distance, s) = farthest(center);
        let away = s.center - center;
        let length = away.length();
        if length <= 0.0 {
            break;
        }
        center += away * (distance / length / (round as Real + 1.0) * 0.5).min(1.0);
        let reach = farthest(center).0;
        if reach < best.0 {
            best = (reach, center);
        }
    }
    // The distance above is off by a few ulps of the coordinates it was computed from.
    let size = best.0 + best.1.abs().max_element();
    (best.1, best.0 + 8.0 * Real::EPSILON * size)
}
