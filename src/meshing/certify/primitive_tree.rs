//! A tree over the primitives of a draft: signed distance of points to the solid.
//!
//! A point near the medial axis is about as far from everything around it, a tree's worst case. Two
//! lower bounds of the signed distance to a group prune it, and the larger counts: the signed
//! distance to the box of its volume, and the distance to the box of its centres minus its
//! largest radius. Single primitives are pruned by how far their balls reach as well, along the direction in which the
//! point lies from the primitive nearest so far: of a round body all primitives at a place are about as near.

use crate::meshing::certify::prepared_primitives::Prepared;
use crate::meshing::draft::{Ball, Corners, Draft, Signed};
use crate::meshing::geometry::bounds::{Bounds, Point, coordinate, direction};
use crate::meshing::geometry::four_boxes::{
    Child, FourBalls, FourBoxes, FourPoints, nearest_first, slack,
};
use std::ops::ControlFlow;
use wide::f32x4;

/// Four groups of primitives, or single ones.
struct Node {
    volumes: FourBoxes,
    centers: FourBoxes,
    largest_radii: f32x4,
    /// The three balls of single primitives, if there are any among the children.
    balls: Option<[FourBalls; 3]>,
    children: [Child; 4],
}

impl Node {
    /// Lower bounds of the signed distances; `way` is any unit vector, or zero.
    #[inline]
    fn lower_bounds(&self, p: &FourPoints, way: &FourPoints) -> [f32; 4] {
        let volumes = self.volumes.signed_distance(p);
        let centers = self.centers.distance_sq(p).sqrt() - self.largest_radii;
        let mut bounds = volumes.fast_max(centers);
        if let Some([a, b, c]) = &self.balls {
            let reach = a.reach(way).fast_max(b.reach(way)).fast_max(c.reach(way));
            bounds = bounds.fast_max(p.dot(way) - reach);
        }
        bounds.to_array()
    }
}

/// The primitive nearest to a point.
#[derive(Clone, Copy, Debug)]
pub struct NearestPrimitive {
    /// Signed distance and weights.
    pub signed: Signed,
    /// Index of the primitive.
    pub primitive: u32,
}

impl NearestPrimitive {
    /// Becomes the other if that is nearer, or as near with a lower index: so the order in which the tree
    /// is searched does not show.
    #[inline]
    fn take_nearer(&mut self, other: Self) {
        let (mine, its) = (self.signed.distance, other.signed.distance);
        if its < mine || its == mine && other.primitive > self.primitive {
            *self = other;
        }
    }
}

/// Boxes over the primitives of a draft; node 0 is the root.
pub struct DraftTree<'a> {
    draft: &'a Draft,
    primitives: Vec<Corners>,
    prepared: Vec<Prepared>,
    nodes: Vec<Node>,
    /// Largest coordinate of any box.
    reach: f64,
}

impl<'a> DraftTree<'a> {
    /// Builds the tree by halving twice, at the median of the longest spread of the primitives' middles.
    pub fn new(draft: &'a Draft) -> Self {
        let primitives = draft.primitives();
        let middle = |c: &Corners| Ball::interpolate(draft.balls_of(*c), [1.0 / 3.0; 3]);
        let mut items: Vec<Item> = primitives.iter().map(middle).zip(0u32..).collect();
        let prepare = |c: &Corners| Prepared::new(*c, draft.balls_of(*c));
        let far = |b: &Ball| {
            let c = b.center;
            c.x.abs().max(c.y.abs()).max(c.z.abs()) + b.radius
        };
        let mut tree = Self {
            draft,
            prepared: primitives.iter().map(prepare).collect(),
            nodes: Vec::with_capacity(items.len() / 2 + 1),
            reach: draft.balls.iter().map(far).fold(0.0, f64::max),
            primitives,
        };
        tree.group(&mut items);
        tree
    }

    /// The primitives, as [`Draft::primitives`] lists them.
    pub fn primitives(&self) -> &[Corners] {
        &self.primitives
    }

    /// Adds the node of a group, and those below it; gives its index.
    fn group(&mut self, items: &mut [Item]) -> u32 {
        let (left, right) = halve(items);
        let ((a, b), (c, d)) = (halve(left), halve(right));
        let parts = [a, b, c, d];
        let index = self.nodes.len() as u32;
        self.nodes.push(self.node(&parts));
        for (k, part) in parts.into_iter().enumerate() {
            let child = match part {
                [] => Child::Nothing,
                [only] => Child::Leaf(only.1),
                several => Child::Group(self.group(several)),
            };
            self.nodes[index as usize].children[k] = child;
        }
        index
    }

    /// The bounds of four groups.
    fn node(&self, parts: &[&mut [Item]; 4]) -> Node {
        let balls = |k: usize| {
            let of = |i: &Item| self.draft.balls_of(self.primitives[i.1 as usize]);
            parts[k].iter().flat_map(of)
        };
        let around = |bounds: &dyn Fn(Ball) -> Bounds| {
            FourBoxes::new([0, 1, 2, 3].map(|k| balls(k).map(bounds).reduce(Bounds::union)))
        };
        let radius = |k: usize| balls(k).map(|b| b.radius).fold(0.0, f64::max) as f32;
        let corner = |k: usize, corner: usize| match &*parts[k] {
            [only] => Some(self.draft.balls_of(self.primitives[only.1 as usize])[corner]),
            _ => None,
        };
        let four = |i: usize| FourBalls::new([0, 1, 2, 3].map(|k| corner(k, i)));
        let has_leaf = parts.iter().any(|part| part.len() == 1);
        Node {
            volumes: around(&|b| Bounds::of_ball(b.center, b.radius)),
            centers: around(&|b| Bounds::of([b.center])),
            largest_radii: f32x4::from([0, 1, 2, 3].map(radius)),
            balls: has_leaf.then(|| std::array::from_fn(four)),
            children: [Child::Nothing; 4],
        }
    }

    /// The ball that gives a signed distance.
    pub fn ball(&self, nearest: &NearestPrimitive) -> Ball {
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
    pub fn nearest(&self, p: Point, hint: u32) -> NearestPrimitive {
        let primitive = hint.min(self.primitives.len().saturating_sub(1) as u32);
        let mut best = self.hinted(primitive, p);
        self.visit(p, best, best.signed.distance, |signed, primitive| {
            best.take_nearer(NearestPrimitive { signed, primitive });
            Some(best.signed.distance)
        });
        best
    }

    /// Does the same as [`Self::nearest`] if the smallest signed distance is between `least` and `most`. Otherwise it
    /// returns some primitive whose signed distance is not between them either.
    pub fn nearest_between(&self, p: Point, least: f64, most: f64, hint: u32) -> NearestPrimitive {
        let mut best = self.hinted(hint, p);
        if best.signed.distance >= least {
            let limit = best.signed.distance.min(most);
            self.visit(p, best, limit, |signed, primitive| {
                best.take_nearer(NearestPrimitive { signed, primitive });
                let lowest = best.signed.distance;
                (lowest >= least).then_some(lowest.min(most))
            });
        }
        best
    }

    /// Whether some signed distance is below `limit`; `hint` is a primitive that may have it.
    pub fn any_below(&self, p: Point, limit: f64, hint: u32) -> bool {
        let hinted = self.hinted(hint, p);
        let mut found = hinted.signed.distance < limit;
        if !found {
            self.visit(p, hinted, limit, |signed, _| {
                found = signed.distance < limit;
                (!found).then_some(limit)
            });
        }
        found
    }

    /// Whether all primitives of a signed distance below `limit` keep a condition; `hint` is one that may
    /// break it.
    pub fn all_below(
        &self,
        p: Point,
        limit: f64,
        hint: u32,
        mut keeps: impl FnMut(&NearestPrimitive) -> bool,
    ) -> bool {
        let mut keep = |near: &NearestPrimitive| near.signed.distance >= limit || keeps(near);
        let hinted = self.hinted(hint, p);
        let mut all = keep(&hinted);
        if all {
            self.visit(p, hinted, limit, |signed, primitive| {
                all = keep(&NearestPrimitive { signed, primitive });
                all.then_some(limit)
            });
        }
        all
    }

    /// A primitive that is likely the nearest.
    fn hinted(&self, primitive: u32, p: Point) -> NearestPrimitive {
        NearestPrimitive {
            signed: self.distance_to(primitive, p),
            primitive,
        }
    }

    /// Calls `see` for primitives whose distance may be below `limit`, nearer groups first; `see`
    /// returns the new limit, or `None` to stop. The nearer `guess` is, the fewer primitives are looked at.
    fn visit(
        &self,
        p: Point,
        guess: NearestPrimitive,
        limit: f64,
        mut see: impl FnMut(Signed, u32) -> Option<f64>,
    ) {
        let way = direction(p - self.ball(&guess).center);
        let [point, way] = [p, way].map(FourPoints::splat);
        let look = |group: u32| {
            let node = &self.nodes[group as usize];
            (node.lower_bounds(&point, &way), node.children)
        };
        nearest_first(limit, slack(p, self.reach), look, |primitive| {
            match see(self.distance_to(primitive, p), primitive) {
                Some(new) => ControlFlow::Continue(Some(new)),
                None => ControlFlow::Break(()),
            }
        });
    }
}

/// Middle of a primitive, and its index.
type Item = (Ball, u32);

/// Halves primitives at the median of the longest spread of their middles, or of their radii.
fn halve(items: &mut [Item]) -> (&mut [Item], &mut [Item]) {
    let middle = items.len() / 2;
    if middle == 0 {
        return items.split_at_mut(0);
    }
    let spread = Bounds::of(items.iter().map(|i| i.0.center));
    let (least, most) = items.iter().fold((f64::MAX, 0.0f64), |(least, most), i| {
        (least.min(i.0.radius), most.max(i.0.radius))
    });
    let axis = spread.longest_axis();
    let by_radius = most - least > spread.longest_side();
    let key = |b: &Ball| match by_radius {
        true => b.radius,
        false => coordinate(b.center, axis),
    };
    items.select_nth_unstable_by(middle, |a, b| {
        key(&a.0).total_cmp(&key(&b.0)).then(a.1.cmp(&b.1))
    });
    items.split_at_mut(middle)
}
