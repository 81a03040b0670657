//! Openings of a surface: where patches end, as rims of open edges, and how wide they are.
//!
//! Closing an opening with its flattest lid moves the boundary of the solid at most as far as the
//! lid's points are from the surface. Where something else lies over an opening (a lid, the body
//! that a handle is stuck into), its lid is not at the boundary of the solid at all, which the
//! winding number tells: there it is about ½.

use crate::error::BuildError;
use crate::math::fast_hash::FastMap;
use crate::meshing::geometry::bounds::{Point, direction};
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::geometry::union_find::Groups;
use crate::meshing::surface::orient::Patches;
use crate::meshing::watch::Watch;

/// Openings whose lid lies farther from the surface than this (longest side 1) are meant to be
/// open; narrower ones are taken for damage and closed, which costs up to this much error. A
/// spout, an eye socket or a lost triangle is below it; a cup, a pipe or a cabin is not.
pub const WIDE: f64 = 0.03;

/// Openings of a surface that bounds matter by itself, as a share of its area.
pub const OPEN: f64 = 0.1;

/// How far from ½ the winding number may be on a lid that bounds the solid.
const UNDECIDED: f64 = 0.3;

/// Lids are of openings whose area is at most this share of their patch's.
const MOST_OPEN: f64 = 0.2;

/// Largest number of points of a rim towards which a lid is probed, besides its middle, which something else may cover.
const RIM_PROBES: usize = 16;

/// Places of these probes, as shares of the way from the lid's middle to the rim.
const SHARES: [f64; 3] = [0.5, 0.25, 0.75];

/// A rim of open edges of one patch.
pub struct Opening {
    /// The patch that ends here, or the first of those that are sewn together.
    pub patch: u32,
    /// Mean of the rim, by length.
    center: Point,
    edges: Vec<[Point; 2]>,
}

/// The openings that may be wide; each is a connected set of open edges of one patch.
pub fn openings(
    vertices: &[Point],
    patches: &Patches,
    watch: &mut Watch,
) -> Result<Vec<Opening>, BuildError> {
    let all = all_openings(vertices, patches, watch)?;
    let wide = all.into_iter().filter(|o| o.radius() > WIDE);
    Ok(wide.collect())
}

/// Fans that close the openings at the boundary of the solid, each turned to face outward, and its normal. `closed`
/// says which patches are taken for solid.
pub fn lids(
    vertices: &[Point],
    patches: &Patches,
    closed: impl Fn(u32) -> bool,
    tree: &TriangleTree,
    watch: &mut Watch,
) -> Result<Vec<([Point; 3], Point)>, BuildError> {
    let mut lids = Vec::new();
    let areas = patches.sewn_areas();
    for opening in all_openings(vertices, patches, watch)? {
        watch.again()?;
        let fan: Vec<[Point; 3]> = opening
            .edges
            .iter()
            .map(|&[a, b]| [opening.center, a, b])
            .collect();
        let cross = |[a, b, c]: [Point; 3]| (b - a).cross(c - a);
        let area: f64 = fan.iter().map(|t| 0.5 * cross(*t).length()).sum();
        let sewn = areas[opening.patch as usize];
        // A crumb's rim is all around it.
        if !closed(opening.patch)
            || area > MOST_OPEN * sewn
            || !is_at_boundary(tree, opening.center)
        {
            continue;
        }
        for [a, b, c] in fan {
            let normal = direction(cross([a, b, c]));
            let off = normal * (0.3 * opening.radius());
            let middle = (a + b + c) * (1.0 / 3.0);
            if normal.length_sq() == 0.0 || !is_at_boundary(tree, middle) {
                continue;
            }
            lids.push(
                match tree.winding(middle + off) <= tree.winding(middle - off) {
                    true => ([a, b, c], normal),
                    false => ([a, c, b], -normal),
                },
            );
        }
    }
    Ok(lids)
}

fn all_openings(
    vertices: &[Point],
    patches: &Patches,
    watch: &mut Watch,
) -> Result<Vec<Opening>, BuildError> {
    let mut places: FastMap<[u32; 2], u32> = FastMap::default();
    let mut rims = Groups::new(0);
    let mut edges: Vec<u32> = Vec::with_capacity(patches.rims.len());
    for (i, &([a, b], patch)) in patches.rims.iter().enumerate() {
        watch.every(i)?;
        let mut place = |v: u32| *places.entry([patch, v]).or_insert_with(|| rims.add());
        let [a, b] = [a, b].map(&mut place);
        rims.join(a, b);
        edges.push(a);
    }
    let mut found: FastMap<u32, Opening> = FastMap::default();
    for (i, place) in edges.iter().enumerate() {
        watch.every(i)?;
        let root = rims.find(*place);
        let ([a, b], patch) = patches.rims[i];
        let opening = found.entry(root).or_insert_with(|| Opening {
            patch,
            center: Point::zero(),
            edges: Vec::new(),
        });
        opening.edges.push([a, b].map(|v| vertices[v as usize]));
    }
    let mut found: Vec<(u32, Opening)> = found.into_iter().collect();
    found.sort_unstable_by_key(|o| o.0);
    for (_, opening) in &mut found {
        opening.center = opening.mean();
    }
    Ok(found.into_iter().map(|o| o.1).collect())
}

impl Opening {
    fn mean(&self) -> Point {
        let (mut length, mut moment) = (0.0, Point::zero());
        for &[a, b] in &self.edges {
            let own = (b - a).length();
            length += own;
            moment = moment + (a + b) * (0.5 * own);
        }
        moment * (1.0 / length)
    }

    /// Distance of the rim's farthest point from the middle.
    fn radius(&self) -> f64 {
        let far = self.edges.iter().map(|e| (e[0] - self.center).length());
        far.fold(0.0, f64::max)
    }

    /// Whether closing it would move the solid's boundary far from the surface.
    pub fn is_wide(&self, tree: &TriangleTree) -> bool {
        let step = self.edges.len().div_ceil(RIM_PROBES).max(1);
        let rim = self.edges.iter().step_by(step);
        let part_of_way = |share: f64| {
            let at = move |&[p, _]: &[Point; 2]| self.center * (1.0 - share) + p * share;
            rim.clone().map(at)
        };
        let towards = SHARES.into_iter().flat_map(part_of_way);
        std::iter::once(self.center)
            .chain(towards)
            .any(|p| is_at_boundary(tree, p) && !tree.any_within(p, WIDE))
    }
}

/// Whether a point of a lid is at the boundary of the solid.
fn is_at_boundary(tree: &TriangleTree, p: Point) -> bool {
    (tree.winding(p) - 0.5).abs() < UNDECIDED
}
