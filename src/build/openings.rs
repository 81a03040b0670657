//! Openings of a surface: where patches end, as rims of open edges, and how wide they are.
//!
//! Closing an opening with its flattest lid moves the boundary of the solid at most as far as the
//! lid's points are from the surface. Where something else lies over an opening (a lid, the body
//! that a handle is stuck into), its lid is not at the boundary of the solid at all, which the
//! winding number tells: there it is about ½.

use super::bounds::Point;
use super::orient::Patches;
use super::triangle_tree::TriangleTree;
use super::watch::Watch;
use crate::error::BuildError;
use crate::math::fast_hash::FastMap;

/// Openings whose lid lies farther from the surface than this (longest side 1) are meant to be
/// open; narrower ones are taken for damage and closed, which costs up to this much error. A
/// spout, an eye socket or a lost triangle is below it; a cup, a pipe or a cabin is not.
const WIDE: f64 = 0.03;

/// How far from ½ the winding number may be on a lid that bounds the solid.
const UNDECIDED: f64 = 0.3;

/// Points of a rim that a lid is looked at towards, at most.
const RIM: usize = 16;

/// A rim of open edges of one patch.
pub struct Opening {
    /// The patch that ends here.
    pub patch: u32,
    /// Mean of the rim, by length.
    center: Point,
    rim: Vec<Point>,
}

/// The openings that may be wide; each is a connected set of open edges of one patch.
pub fn openings(
    vertices: &[Point],
    patches: &Patches,
    watch: &mut Watch,
) -> Result<Vec<Opening>, BuildError> {
    let mut places: FastMap<[u32; 2], u32> = FastMap::default();
    let mut rims = Rims::default();
    let mut edges: Vec<u32> = Vec::with_capacity(patches.open_edges.len());
    for (i, &([a, b], patch)) in patches.open_edges.iter().enumerate() {
        watch.every(i)?;
        let mut place = |v: u32| *places.entry([patch, v]).or_insert_with(|| rims.add());
        let [a, b] = [a, b].map(&mut place);
        edges.push(rims.join(a, b));
    }
    // Length and first moment of each rim, by root.
    let mut sums: FastMap<u32, (f64, Point)> = FastMap::default();
    let ends = |i: usize| patches.open_edges[i].0.map(|v| vertices[v as usize]);
    for (i, place) in edges.iter_mut().enumerate() {
        watch.every(i)?;
        *place = rims.root(*place);
        let [a, b] = ends(i);
        let length = (b - a).length();
        let sum = sums.entry(*place).or_insert((0.0, Point::zero()));
        *sum = (sum.0 + length, sum.1 + (a + b) * (0.5 * length));
    }
    let mut wide: FastMap<u32, (u32, Point, Vec<Point>)> = FastMap::default();
    for (i, place) in edges.iter().enumerate() {
        watch.every(i)?;
        let (length, moment) = sums[place];
        let center = moment * (1.0 / length);
        let [a, _] = ends(i);
        if (a - center).length() > WIDE {
            let patch = patches.open_edges[i].1;
            let rim = wide.entry(*place).or_insert((patch, center, Vec::new()));
            rim.2.push(a);
        }
    }
    let mut openings: Vec<(u32, Opening)> = wide
        .into_iter()
        .map(|(place, (patch, center, points))| {
            let step = points.len().div_ceil(RIM);
            let rim = points.into_iter().step_by(step).collect();
            let opening = Opening { patch, center, rim };
            (place, opening)
        })
        .collect();
    openings.sort_unstable_by_key(|o| o.0);
    Ok(openings.into_iter().map(|o| o.1).collect())
}

impl Opening {
    /// Whether closing it would move the solid's boundary far from the surface.
    pub fn is_wide(&self, tree: &TriangleTree) -> bool {
        let towards = self.rim.iter().map(|&p| (self.center + p) * 0.5);
        std::iter::once(self.center)
            .chain(towards)
            .any(|p| (tree.winding(p) - 0.5).abs() < UNDECIDED && !tree.any_within(p, WIDE))
    }
}

/// Union and find over the ends of open edges.
#[derive(Default)]
struct Rims(Vec<u32>);

impl Rims {
    fn add(&mut self) -> u32 {
        self.0.push(self.0.len() as u32);
        self.0.len() as u32 - 1
    }

    fn root(&mut self, mut at: u32) -> u32 {
        while self.0[at as usize] != at {
            let up = self.0[at as usize];
            self.0[at as usize] = self.0[up as usize];
            at = self.0[at as usize];
        }
        at
    }

    fn join(&mut self, a: u32, b: u32) -> u32 {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
        a.min(b)
    }
}
