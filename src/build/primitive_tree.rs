//! A tree over the primitives of a draft: signed distance of points to the solid.
//!
//! A point near the medial axis is about as far from everything around it, a tree's worst case. Two
//! lower bounds of the signed distance to a group prune it, and the larger counts: the signed
//! distance to the box of its volume, and the distance to the box of its centres minus its
//! largest radius.

use super::bounds::{Bounds, Point, coordinate};
use super::draft::{Ball, Corners, Draft, Signed};
use super::prepared::Prepared;

/// Primitives in a leaf.
const LEAF: usize = 2;

struct Node {
    volume: Bounds,
    centers: Bounds,
    largest_radius: f64,
    /// Leaf: first primitive. Inner: first of two neighbouring children.
    first: u32,
    /// Leaf: number of primitives. Inner: 0.
    count: u32,
}

impl Node {
    /// A lower bound of the signed distance; the first one found that reaches `limit`.
    #[inline]
    fn lower_bound(&self, p: Point, limit: f64) -> f64 {
        let volume = self.volume.signed_distance(p);
        if volume >= limit {
            return volume;
        }
        let centers = self.centers.distance_sq(p).sqrt() - self.largest_radius;
        volume.max(centers)
    }
}

/// The primitive nearest to a point.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// Signed distance and weights.
    pub signed: Signed,
    /// Index of the primitive.
    pub primitive: u32,
}

/// Boxes over the primitives of a draft; node 0 is the root.
pub struct PrimitiveTree<'a> {
    draft: &'a Draft,
    primitives: Vec<Corners>,
    prepared: Vec<Prepared>,
    /// Primitives in the order of the leaves.
    order: Vec<u32>,
    nodes: Vec<Node>,
}

impl<'a> PrimitiveTree<'a> {
    /// Builds the tree by halving at the median of the longest spread of the primitives' middles.
    pub fn new(draft: &'a Draft) -> Self {
        let primitives = draft.primitives();
        let middle = |c: &Corners| Ball::interpolate(draft.balls_of(*c), [1.0 / 3.0; 3]);
        let mut items: Vec<(Ball, u32)> = primitives.iter().map(middle).zip(0u32..).collect();
        let prepare = |c: &Corners| Prepared::new(*c, draft.balls_of(*c));
        let mut tree = Self {
            draft,
            prepared: primitives.iter().map(prepare).collect(),
            primitives,
            order: Vec::new(),
            nodes: Vec::with_capacity(items.len()),
        };
        if !items.is_empty() {
            tree.nodes.push(tree.node(&items, 0));
            tree.split(0, 0, &mut items);
        }
        tree.order = items.iter().map(|i| i.1).collect();
        tree
    }

    /// The primitives, as [`Draft::primitives`] lists them.
    pub fn primitives(&self) -> &[Corners] {
        &self.primitives
    }

    fn node(&self, items: &[(Ball, u32)], first: usize) -> Node {
        let balls = items
            .iter()
            .flat_map(|i| self.draft.balls_of(self.primitives[i.1 as usize]));
        Node {
            volume: balls
                .clone()
                .map(|b| Bounds::of_ball(b.center, b.radius))
                .fold(Bounds::EMPTY, Bounds::union),
            centers: Bounds::of(balls.clone().map(|b| b.center)),
            largest_radius: balls.map(|b| b.radius).fold(0.0, f64::max),
            first: first as u32,
            count: items.len() as u32,
        }
    }

    fn split(&mut self, node: usize, first: usize, items: &mut [(Ball, u32)]) {
        if items.len() <= LEAF {
            return;
        }
        let spread = Bounds::of(items.iter().map(|i| i.0.center));
        let (least, most) = items.iter().fold((f64::MAX, 0.0f64), |(least, most), i| {
            (least.min(i.0.radius), most.max(i.0.radius))
        });
        let axis = spread.longest_axis();
        let by_radius = most - least > spread.longest_side();
        let key = |b: &Ball| {
            if by_radius {
                b.radius
            } else {
                coordinate(b.center, axis)
            }
        };
        let middle = items.len() / 2;
        items.select_nth_unstable_by(middle, |a, b| {
            key(&a.0).total_cmp(&key(&b.0)).then(a.1.cmp(&b.1))
        });
        let (left, right) = items.split_at_mut(middle);
        let children = self.nodes.len();
        self.nodes[node].first = children as u32;
        self.nodes[node].count = 0;
        let pair = [self.node(left, first), self.node(right, first + middle)];
        self.nodes.extend(pair);
        self.split(children, first, left);
        self.split(children + 1, first + middle, right);
    }

    /// The ball that gives a signed distance.
    pub fn ball(&self, nearest: &Nearest) -> Ball {
        let corners = self.primitives[nearest.primitive as usize];
        Ball::interpolate(self.draft.balls_of(corners), nearest.signed.weights)
    }

    /// Signed distance of `p` to one primitive.
    #[inline]
    pub fn distance_to(&self, primitive: u32, p: Point) -> Signed {
        self.prepared[primitive as usize].signed_distance(p)
    }

    /// The primitive of smallest signed distance. `hint` is a primitive that is likely near, as the
    /// one of the point before; any index is allowed.
    pub fn nearest(&self, p: Point, hint: u32) -> Nearest {
        let primitive = hint.min(self.primitives.len().saturating_sub(1) as u32);
        let mut best = Nearest {
            signed: self.distance_to(primitive, p),
            primitive,
        };
        self.visit(p, best.signed.distance, |signed, primitive| {
            if signed.distance < best.signed.distance {
                best = Nearest { signed, primitive };
            }
            Some(best.signed.distance)
        });
        best
    }

    /// As [`Self::nearest`], but `None` where the smallest signed distance is not between `least` and
    /// `most`.
    pub fn nearest_between(&self, p: Point, least: f64, most: f64, hint: u32) -> Option<Nearest> {
        let signed = self.distance_to(hint, p);
        let mut best = Nearest {
            signed,
            primitive: hint,
        };
        if signed.distance < least {
            return None;
        }
        self.visit(p, signed.distance.min(most), |signed, primitive| {
            if signed.distance < best.signed.distance {
                best = Nearest { signed, primitive };
            }
            let lowest = best.signed.distance;
            (lowest >= least).then_some(lowest.min(most))
        });
        (least..=most)
            .contains(&best.signed.distance)
            .then_some(best)
    }

    /// Whether some signed distance is below `limit`; `hint` is a primitive that may have it.
    pub fn any_below(&self, p: Point, limit: f64, hint: u32) -> bool {
        let mut found = self.distance_to(hint, p).distance < limit;
        if !found {
            self.visit(p, limit, |signed, _| {
                found = signed.distance < limit;
                (!found).then_some(limit)
            });
        }
        found
    }

    /// Calls `see` for primitives whose distance may be below `limit`, nearer groups first; `see`
    /// returns the new limit, or `None` to stop.
    fn visit(&self, p: Point, mut limit: f64, mut see: impl FnMut(Signed, u32) -> Option<f64>) {
        // Halving keeps the depth below 32, and each level leaves one node waiting.
        let mut stack = [(0.0, 0u32); 64];
        let mut len = 1;
        stack[0] = (self.nodes[0].lower_bound(p, limit), 0);
        while len > 0 {
            len -= 1;
            let (bound, index) = stack[len];
            if bound >= limit {
                continue;
            }
            let node = &self.nodes[index as usize];
            let first = node.first as usize;
            if node.count > 0 {
                for &primitive in &self.order[first..first + node.count as usize] {
                    match see(self.distance_to(primitive, p), primitive) {
                        Some(new) => limit = new,
                        None => return,
                    }
                }
                continue;
            }
            let bound = |child: usize| (self.nodes[child].lower_bound(p, limit), child as u32);
            let (left, right) = (bound(first), bound(first + 1));
            let (near, far) = match left.0 <= right.0 {
                true => (left, right),
                false => (right, left),
            };
            for child in [far, near] {
                if child.0 < limit {
                    stack[len] = child;
                    len += 1;
                }
            }
        }
    }
}
