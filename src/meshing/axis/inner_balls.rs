//! Makes the initial medial mesh from Delaunay tetrahedra of surface samples: circumspheres whose centres lie inside
//! the surface are its balls.
//!
//! Source: Amenta and Bern, "Surface reconstruction by Voronoi filtering" (1999) for inner Voronoi
//! vertices as an approximate medial axis; Li et al., "Q-MAT" (2015), §3, for its mesh. The medial
//! mesh is the part of the Voronoi diagram inside: its vertices are inside tetrahedra, its edges
//! join neighbours, its faces are the Voronoi polygons of Delaunay edges all around which the
//! tetrahedra are inside, cut into fans.
//!
//! Whether a centre is inside is decided by the votes of the normals at the four samples; only
//! where they disagree (up to 4 % of the tetrahedra) by the winding number, which costs more.

use crate::error::BuildError;
use crate::meshing::axis::delaunay::{Delaunay, NONE};
use crate::meshing::draft::{Ball, Draft};
use crate::meshing::geometry::bounds::{Bounds, Point};
use crate::meshing::geometry::random::Random;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::geometry::winding::INSIDE;
use crate::meshing::surface::samples::Sample;
use crate::meshing::watch::{Watch, bytes_of};

/// A sample votes when the centre is seen from it within 72° of its normal or of the opposite:
/// near the tangent plane noise decides.
const VOTE: f64 = 0.3;

/// Random shift of each sample (longest side 1). Samples of boxes and tori are cospherical by the
/// dozen, and exact predicates then cost twenty times more; the shift is far below any error.
pub const JITTER: f64 = 1e-7;

/// The samples' points, each shifted a little; the same in every call.
pub fn shifted(samples: &[Sample]) -> Vec<Point> {
    let mut random = Random::new(4);
    let mut shift = || JITTER * (random.unit() - 0.5);
    samples
        .iter()
        .map(|s| s.point + Point::new(shift(), shift(), shift()))
        .collect()
}

/// Delaunay tetrahedra of the samples.
pub fn tetrahedra(samples: &[Sample], watch: &mut Watch) -> Result<Delaunay, BuildError> {
    let points = shifted(samples);
    let delaunay =
        Delaunay::with_tick(&points, |done| watch.at(done as f64 / points.len() as f64))?;
    let inputs = size_of_val(samples) + bytes_of(&points);
    watch.hold(inputs + delaunay.bytes(points.len()));
    Ok(delaunay)
}

/// The initial medial mesh, and whether each sample is touched by one of its balls. Without
/// `votes` the winding number decides everywhere: where patches overlap, or two layers lie nearer
/// to each other than samples do, a ball touches samples of either, and normals mislead. Balls that
/// are corners of no face count as none then: walls thinner than samples are apart hold such, scattered.
pub fn inner_balls(
    samples: &[Sample],
    delaunay: &Delaunay,
    tree: &TriangleTree,
    votes: bool,
    watch: &mut Watch,
) -> Result<(Draft, Vec<bool>), BuildError> {
    let points = shifted(samples);
    let bounds = Bounds::of(samples.iter().map(|s| s.point));
    let mut draft = Draft::default();
    let mut ball_of = vec![NONE; delaunay.tetrahedra.len()];
    let mut touched = vec![false; samples.len()];
    for (t, corners) in delaunay.tetrahedra.iter().enumerate() {
        if t % 1024 == 0 {
            watch.at(t as f64 / delaunay.tetrahedra.len() as f64)?;
        }
        // The circumsphere is that of the points of the tetrahedra: samples on a flat triangle lie in a plane
        // themselves, and their sphere would be any.
        let Some(ball) = circumsphere(corners.map(|v| points[v as usize])) else {
            continue;
        };
        let around = corners.map(|v| samples[v as usize]);
        let voted = if votes { vote(&ball, around) } else { None };
        let inside = || voted.unwrap_or_else(|| tree.winding(ball.center) > INSIDE);
        if bounds.distance_sq(ball.center) == 0.0 && inside() {
            ball_of[t] = draft.balls.len() as u32;
            draft.balls.push(ball);
        }
    }
    for (t, neighbors) in delaunay.neighbors.iter().enumerate() {
        for &n in neighbors {
            if n != NONE && t < n as usize && ball_of[t] != NONE && ball_of[n as usize] != NONE {
                draft.edges.push([ball_of[t], ball_of[n as usize]]);
            }
        }
    }
    let mut buried = buried(samples.len(), delaunay, &ball_of);
    for t in (0..delaunay.tetrahedra.len()).filter(|&t| ball_of[t] != NONE) {
        if t % 4096 == 0 {
            watch.at(1.0)?;
        }
        for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            if let Some(ring) = ring_around(delaunay, &ball_of, t as u32, i, j) {
                let corners = delaunay.tetrahedra[t];
                let [a, b] = [i, j].map(|k| corners[k] as usize);
                if buried[a] != buried[b] {
                    // Left open, the ring joins the one's void to what is around the other.
                    (buried[a], buried[b]) = (false, false);
                    continue;
                }
                fan(&ring, &mut draft);
            }
        }
    }
    let mut counts = vec![votes; draft.balls.len()];
    for &ball in draft.faces.iter().flatten() {
        counts[ball as usize] = true;
    }
    for (corners, &ball) in delaunay.tetrahedra.iter().zip(&ball_of) {
        if ball != NONE && counts[ball as usize] {
            corners.iter().for_each(|&v| touched[v as usize] = true);
        }
    }
    Ok((draft, touched))
}

/// Samples all around which the tetrahedra are inside: the faces around such a one close a void where
/// the surface was not resolved, and one of them must go.
pub fn buried(samples: usize, delaunay: &Delaunay, ball_of: &[u32]) -> Vec<bool> {
    let mut buried = vec![true; samples];
    for (t, corners) in delaunay.tetrahedra.iter().enumerate() {
        for (&v, &beyond) in corners.iter().zip(&delaunay.neighbors[t]) {
            if ball_of[t] == NONE {
                buried[v as usize] = false;
            } else if beyond == NONE {
                // The face opposite to `v` is on the hull.
                let on_face = corners.iter().filter(|w| **w != v);
                on_face.for_each(|&w| buried[w as usize] = false);
            }
        }
    }
    buried
}

/// The sphere through four points, unless they lie in a plane.
///
/// With `u, v, w` from the first point, the centre `x` relative to it satisfies
/// `2 u·x = u²`, `2 v·x = v²`, `2 w·x = w²`, so
/// `x = (u² v×w + v² w×u + w² u×v) / (2 u·(v×w))`.
pub fn circumsphere([a, b, c, d]: [Point; 4]) -> Option<Ball> {
    let (u, v, w) = (b - a, c - a, d - a);
    let (uv, vw, wu) = (u.cross(v), v.cross(w), w.cross(u));
    let x = vw * u.length_sq() + wu * v.length_sq() + uv * w.length_sq();
    let x = x * (0.5 / u.dot(vw));
    x.is_finite().then(|| Ball {
        center: a + x,
        radius: x.length(),
    })
}

/// Whether the ball is inside, as its samples' normals say if they agree.
pub fn vote(ball: &Ball, corners: [Sample; 4]) -> Option<bool> {
    let (mut inside, mut outside) = (0, 0);
    for sample in corners {
        let cosine = (ball.center - sample.point).dot(sample.normal) / ball.radius;
        inside += usize::from(cosine < -VOTE);
        outside += usize::from(cosine > VOTE);
    }
    match (inside, outside) {
        (3.., 0) => Some(true),
        (0, 3..) => Some(false),
        _ => None,
    }
}

/// Balls of the tetrahedra around the Delaunay edge between corners `i` and `j` of tetrahedron
/// `first`, in order, if they close a ring of inside ones and `first` is the smallest index among
/// them, so that each ring is found once.
fn ring_around(
    delaunay: &Delaunay,
    ball_of: &[u32],
    first: u32,
    i: usize,
    j: usize,
) -> Option<Vec<u32>> {
    let corners = delaunay.tetrahedra[first as usize];
    let (a, b) = (corners[i], corners[j]);
    let mut ring = vec![ball_of[first as usize]];
    let mut cell = first;
    // The corner to step away from; the other one off the edge is shared with the next cell.
    let mut leave = corners.into_iter().find(|&v| v != a && v != b)?;
    loop {
        let here = delaunay.tetrahedra[cell as usize];
        let next = delaunay.neighbors[cell as usize][here.iter().position(|&v| v == leave)?];
        if next == first {
            return (ring.len() >= 3).then_some(ring);
        }
        if next == NONE || next < first || ball_of[next as usize] == NONE {
            return None;
        }
        ring.push(ball_of[next as usize]);
        let there = delaunay.tetrahedra[next as usize];
        leave = here
            .into_iter()
            .find(|&v| v != a && v != b && v != leave && there.contains(&v))?;
        cell = next;
    }
}

/// Cuts a polygon into triangles from its first corner.
fn fan(ring: &[u32], draft: &mut Draft) {
    for pair in ring[1..].windows(2) {
        draft.faces.push([ring[0], pair[0], pair[1]]);
    }
}
