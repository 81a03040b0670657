//! Loose seams: open edges that run along each other with a gap between them, as where each triangle of a mesh was
//! shrunk, or rounded by itself. They join nothing, but tell which way the triangles on both sides should face.

use crate::error::BuildError;
use crate::math::fast_hash::FastMap;
use crate::meshing::geometry::bounds::{Point, coordinate};
use crate::meshing::watch::Watch;

/// Widest gap of a loose seam, in units of the edge's length.
const GAP: f64 = 0.1;

/// Widest gap of a loose seam, however long its edge is (longest side 1).
const MOST_GAP: f64 = 5e-3;

/// Factor by which whatever else runs along an edge is farther from it than its partner; otherwise more than two meet
/// there, and who belongs together is not known.
const CLEARLY: f64 = 3.0;

/// Largest number of edges that each edge is compared with. Only in a tangle do more lie close together.
const MOST_NEAR: usize = 256;

/// Cosine of the sharpest angle of a loose seam: layers that lie on each other end at the same place too.
const SHARPEST: f64 = 0.8;

/// An open edge of a triangle.
pub struct OpenEdge {
    /// First and last vertex, as the triangle uses the edge, and where they are.
    pub vertices: [u32; 2],
    pub ends: [Point; 2],
    /// Unit vector from the edge into the triangle.
    pub inward: Point,
    /// The triangle.
    pub triangle: usize,
}

/// Two open edges along a loose seam.
pub struct Seam {
    /// Places of the two among the open edges.
    pub edges: [usize; 2],
    /// Whether both run the same way, so that one of the triangles must be turned for both to face one way.
    pub against: bool,
}

/// The loose seams between open edges.
pub fn loose_seams(edges: &[OpenEdge], watch: &mut Watch) -> Result<Vec<Seam>, BuildError> {
    let mut cells: FastMap<[i32; 4], Vec<u32>> = FastMap::default();
    for (i, OpenEdge { ends, .. }) in edges.iter().enumerate() {
        watch.every(i)?;
        if let Some(octave) = octave(ends) {
            let key = key(octave, middle(ends));
            cells.entry(key).or_default().push(i as u32);
        }
    }
    let mut partners = Vec::with_capacity(edges.len());
    for i in 0..edges.len() {
        watch.every(i)?;
        if i % 1_024 == 0 {
            watch.again()?;
        }
        partners.push(partner(i, edges, &cells));
    }
    let mutual = (0..edges.len()).filter_map(|i| {
        let (other, against) = partners[i]?;
        let back = partners[other].is_some_and(|(back, _)| back == i);
        let edges = [i, other];
        (i < other && back).then_some(Seam { edges, against })
    });
    Ok(mutual.collect())
}

/// The open edge that an edge has clearly nearest, within the gap, and whether both run the same way.
fn partner(
    edge: usize,
    edges: &[OpenEdge],
    cells: &FastMap<[i32; 4], Vec<u32>>,
) -> Option<(usize, bool)> {
    let own = &edges[edge];
    let ends = &own.ends;
    let octave = octave(ends)?;
    let widest = gap(ends);
    let reach = Point::new(widest, widest, widest);
    let cells_of = |octave: i32| {
        let [lo, hi] = [-1.0, 1.0].map(|sign| key(octave, middle(ends) + reach * sign));
        let across = move |x: i32| (lo[2]..=hi[2]).map(move |y| [x, y]);
        let column = move |[x, y]: [i32; 2]| (lo[3]..=hi[3]).map(move |z| [octave, x, y, z]);
        (lo[1]..=hi[1]).flat_map(across).flat_map(column)
    };
    let near = (octave - 1..=octave + 1).flat_map(cells_of);
    let near = near.filter_map(|key| cells.get(&key)).flatten();
    // The nearest, and how far the one after it is.
    let (mut least, mut found, mut second) = (widest, None, f64::INFINITY);
    for (looked_at, &other) in near.enumerate() {
        if looked_at > MOST_NEAR {
            return None;
        }
        let its = &edges[other as usize];
        let (distance, same_way) = apart(ends, &its.ends);
        let is_folded = its.inward.dot(own.inward) > SHARPEST;
        if its.triangle == own.triangle || is_folded || distance > second {
            continue;
        }
        if distance > least {
            second = distance;
        } else {
            second = found.map_or(second, |_| least);
            least = distance;
            found = Some((other as usize, same_way));
        }
    }
    found.filter(|_| second > CLEARLY * least)
}

/// How far the ends of two edges are from each other at most, and whether the edges run the same way.
fn apart([a, b]: &[Point; 2], [c, d]: &[Point; 2]) -> (f64, bool) {
    let farther = |p: Point, q: Point| p.length().max(q.length());
    let same_way = farther(*a - *c, *b - *d);
    let opposite = farther(*a - *d, *b - *c);
    (same_way.min(opposite), same_way < opposite)
}

fn middle(ends: &[Point; 2]) -> Point {
    (ends[0] + ends[1]) * 0.5
}

fn gap(ends: &[Point; 2]) -> f64 {
    (GAP * (ends[1] - ends[0]).length()).min(MOST_GAP)
}

/// Exponent of the power of two that the length has. Edges along each other have the same or neighbouring ones.
fn octave(ends: &[Point; 2]) -> Option<i32> {
    let length = (ends[1] - ends[0]).length();
    (length > 0.0).then(|| length.log2().floor() as i32)
}

/// The cell of a point among edges of an octave, as wide as the widest gap there.
fn key(octave: i32, p: Point) -> [i32; 4] {
    let width = (GAP * f64::from(octave + 1).exp2()).min(MOST_GAP);
    let cell = |k: usize| (coordinate(p, k) / width).floor() as i32;
    [octave, cell(0), cell(1), cell(2)]
}
