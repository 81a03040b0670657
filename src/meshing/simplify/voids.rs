//! Voids of a complex of faces: closed surfaces that collapses leave inside matter where the solid
//! has none.
//!
//! Source: Edelsbrunner and Harer, "Computational topology" (2010), chapters III and IV: faces that
//! have an edge to themselves belong to no closed surface and are peeled off; over what is left, the
//! boundaries are reduced modulo 2, and each face whose boundary vanishes closes one surface more.
//! Faces come in by falling area, so that the one which closes a surface, and goes, is its smallest:
//! its neighbours cover it best. All its edges stay, for they have other faces.

use crate::math::fast_hash::FastMap;
use crate::medial::simplex::sides;
use crate::meshing::draft::Draft;
use crate::meshing::geometry::bounds::Point;

/// A set modulo 2, in ascending order.
type Chain = Vec<u32>;

/// Takes a face out of each closed surface whose middle `is_solid`. The draft must list the edges of
/// its faces.
pub fn open_voids(draft: &mut Draft, is_solid: impl Fn(Point) -> bool) {
    let balls = &draft.balls;
    let dropped = superfluous(&draft.faces, |v| balls[v as usize].center, is_solid);
    let mut place = 0;
    draft.faces.retain(|_| {
        place += 1;
        !dropped.contains(&(place - 1))
    });
}

/// Faces to drop, as indices, so that no closed surface is left whose middle `is_solid`.
///
/// One surface around each true cavity stays.
fn superfluous(
    faces: &[[u32; 3]],
    at: impl Fn(u32) -> Point,
    is_solid: impl Fn(Point) -> bool,
) -> Vec<usize> {
    let mut closed = core(faces);
    let area = |f: usize| {
        let [a, b, c] = faces[f].map(&at);
        (b - a).cross(c - a).length_sq()
    };
    closed.sort_by(|&f, &g| area(g).total_cmp(&area(f)).then(f.cmp(&g)));
    let mut edges = FastMap::default();
    // By its last edge: a boundary, and the faces (places in `closed`) that it is of.
    let mut reduced: FastMap<u32, (Chain, Chain)> = FastMap::default();
    let mut cavities: Vec<Chain> = Vec::new();
    let mut dropped = Vec::new();
    for (place, &f) in closed.iter().enumerate() {
        let mut boundary: Chain = sides(&faces[f])
            .map(|edge| {
                let new = edges.len() as u32;
                *edges.entry(edge).or_insert(new)
            })
            .into();
        boundary.sort_unstable();
        let mut sum = vec![place as u32];
        while let Some(last) = boundary.last() {
            let Some((other, of)) = reduced.get(last) else {
                break;
            };
            boundary = added(&boundary, other);
            sum = added(&sum, of);
        }
        if let Some(&last) = boundary.last() {
            reduced.insert(last, (boundary, sum));
            continue;
        }
        let solid = |surface: &Chain| {
            let corners = surface.iter().flat_map(|&g| faces[closed[g as usize]]);
            let middle = corners.map(&at).fold(Point::zero(), |a, b| a + b);
            is_solid(middle * (1.0 / (3 * surface.len()) as f64))
        };
        if solid(&sum) || cavities.iter().any(|c| solid(&added(&sum, c))) {
            dropped.push(f);
        } else {
            cavities.push(sum);
        }
    }
    dropped
}

/// Faces all of whose edges have another of these faces.
fn core(faces: &[[u32; 3]]) -> Vec<usize> {
    let mut at_edge: FastMap<[u32; 2], Vec<u32>> = FastMap::default();
    for (f, face) in faces.iter().enumerate() {
        for edge in sides(face) {
            at_edge.entry(edge).or_default().push(f as u32);
        }
    }
    let mut is_in = vec![true; faces.len()];
    let mut waiting: Vec<usize> = (0..faces.len()).collect();
    while let Some(f) = waiting.pop() {
        let edges = sides(&faces[f]);
        let free = |e: &[u32; 2]| at_edge.get(e).is_none_or(|list| list.len() < 2);
        if !is_in[f] || !edges.iter().any(free) {
            continue;
        }
        is_in[f] = false;
        for edge in edges {
            let Some(list) = at_edge.get_mut(&edge) else {
                continue;
            };
            list.retain(|&g| g as usize != f);
            waiting.extend(list.iter().map(|&g| g as usize));
        }
    }
    (0..faces.len()).filter(|&f| is_in[f]).collect()
}

/// The sum of two chains: what is in one only.
fn added(a: &Chain, b: &Chain) -> Chain {
    let mut sum = Vec::with_capacity(a.len() + b.len());
    let (mut a, mut b) = (a.iter().peekable(), b.iter().peekable());
    loop {
        match (a.peek(), b.peek()) {
            (Some(x), Some(y)) if x == y => {
                a.next();
                b.next();
            }
            (Some(x), Some(y)) if x > y => sum.extend(b.next()),
            (Some(_), _) => sum.extend(a.next()),
            (None, Some(_)) => sum.extend(b.next()),
            (None, None) => return sum,
        }
    }
}
