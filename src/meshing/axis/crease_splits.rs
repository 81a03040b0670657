//! A medial mesh with creases made finer where its sheets bend.
//!
//! Next to a reflex edge, and between curved faces, sheets bend more than samples tell. An edge is off by how
//! far the ball at its middle sticks out of the solid: its radius there, plus the signed distance. Edges that are
//! off too much are split by the ball that touches the faces there, and the triangles at them into 2, 3 or 4.

use crate::error::BuildError;
use crate::math::fast_hash::FastMap;
use crate::medial::simplex::{sides, sorted};
use crate::meshing::axis::clip::CreasedMesh;
use crate::meshing::axis::tangent::{Faces, Tangent, TangentPlane};
use crate::meshing::draft::Ball;
use crate::meshing::geometry::bounds::direction;
use crate::meshing::geometry::triangle_tree::GUESS;
use crate::meshing::watch::Watch;

/// Distance (longest side 1) by which the ball at the middle of an edge may stick out of the solid before the edge is
/// split. Larger, and the initial mesh has that error; smaller, and it has more triangles.
const SPLIT: f64 = 5e-4;

/// Passes of splitting, each of which looks at the edges that the one before made. Each halves the edges at most once.
const PASSES: usize = 3;

/// Distance (longest side 1) by which the ball at the middle of an edge may stick out after the last pass. An edge that
/// is off by more lies in no sheet of the medial axis: it joins balls of unrelated places, and is left out with its
/// triangles.
const DROP: f64 = 3e-3;

/// Edges shorter than this (longest side 1) are not looked at.
const MIN_EDGE: f64 = 1e-3;

/// A ball may move by this many distances between samples to become tangent.
const TANGENT_REACH: f64 = 2.0;

/// Splits what is off, and leaves out what then still is.
pub fn refine(
    mesh: &mut CreasedMesh,
    faces: &Faces,
    spacing: f64,
    watch: &mut Watch,
) -> Result<(), BuildError> {
    let mut refiner = Refiner {
        mesh,
        faces,
        spacing,
        off: FastMap::default(),
    };
    for _ in 0..PASSES {
        let middles = refiner.middles(watch)?;
        if middles.is_empty() {
            break;
        }
        refiner.split(&middles);
    }
    refiner.measure(watch)?;
    refiner.drop_worst();
    Ok(())
}

struct Refiner<'a> {
    mesh: &'a mut CreasedMesh,
    faces: &'a Faces<'a>,
    spacing: f64,
    /// Distance by which each edge looked at is off.
    off: FastMap<[u32; 2], f64>,
}

impl Refiner<'_> {
    /// Measures the edges of all triangles that are not yet.
    fn measure(&mut self, watch: &mut Watch) -> Result<Vec<[u32; 2]>, BuildError> {
        let mut new = Vec::new();
        for (i, face) in self.mesh.draft.faces.iter().enumerate() {
            if i % 64 == 0 {
                watch.again()?;
            }
            for edge in sides(face) {
                if let std::collections::hash_map::Entry::Vacant(place) = self.off.entry(edge) {
                    let [a, b] = edge.map(|v| self.mesh.draft.balls[v as usize]);
                    let short = (a.center - b.center).length() < MIN_EDGE;
                    let off = if short {
                        0.0
                    } else {
                        self.faces.off(&middle(&a, &b))
                    };
                    place.insert(off);
                    new.push(edge);
                }
            }
        }
        Ok(new)
    }

    /// New balls in the middle of edges that are off.
    fn middles(&mut self, watch: &mut Watch) -> Result<FastMap<[u32; 2], u32>, BuildError> {
        let mut middles = FastMap::default();
        for (i, edge) in self.measure(watch)?.into_iter().enumerate() {
            if i % 64 == 0 {
                watch.again()?;
            }
            if self.off[&edge] > SPLIT
                && let Some(tangent) = self.between(edge)
            {
                middles.insert(edge, self.mesh.push(tangent));
            }
        }
        Ok(middles)
    }

    /// The ball near the middle of an edge that touches the faces which both its ends touch, or else all that
    /// either does, or at least the nearest.
    fn between(&self, edge: [u32; 2]) -> Option<Tangent> {
        let [a, b] = edge.map(|v| self.mesh.draft.balls[v as usize]);
        let [of_a, of_b] = edge.map(|v| &self.mesh.triangles[v as usize]);
        let between = middle(&a, &b);
        let radius = between.radius - self.faces.off(&between);
        if radius <= 1e-6 {
            return None;
        }
        let start = Ball { radius, ..between };
        let group = |t: &u32| self.faces.creases.group[*t as usize];
        let of_both = of_a
            .iter()
            .filter(|t| of_b.iter().any(|u| group(u) == group(t)));
        let of_both: Vec<u32> = of_both.copied().collect();
        let mut of_either = [&of_a[..], &of_b[..]].concat();
        of_either.sort_unstable();
        of_either.dedup();
        let reach = TANGENT_REACH * self.spacing;
        let tangent = |of: &[u32]| self.faces.tangent(start, of, reach);
        tangent(&of_both)
            .or_else(|| tangent(&of_either))
            .or_else(|| {
                let (point, triangle) = self
                    .faces
                    .tree
                    .closest_triangle(start.center, between.radius);
                let normal = direction(point - start.center);
                Some(Tangent {
                    ball: start,
                    planes: vec![TangentPlane { normal, point }],
                    triangles: vec![self.faces.tree.given(triangle)],
                })
            })
    }

    /// Splits edges, and the triangles at them.
    fn split(&mut self, middles: &FastMap<[u32; 2], u32>) {
        let draft = &mut self.mesh.draft;
        for face in std::mem::take(&mut draft.faces) {
            let found = sides(&face).map(|edge| middles.get(&edge).copied());
            // Turned so that the sides that are split come first.
            let split = found.iter().flatten().count();
            let first = |k: &usize| match split {
                1 => found[*k].is_some(),
                2 => found[(*k + 2) % 3].is_none(),
                _ => true,
            };
            let k = (0..3).find(first).unwrap_or(0);
            let [a, b, c] = [0, 1, 2].map(|i| face[(k + i) % 3]);
            match [0, 1, 2].map(|i| found[(k + i) % 3]) {
                [Some(ab), None, None] => draft.faces.extend([[a, ab, c], [ab, b, c]]),
                [Some(ab), Some(bc), None] => {
                    draft.faces.extend([[ab, b, bc], [a, ab, bc], [a, bc, c]]);
                }
                [Some(ab), Some(bc), Some(ca)] => {
                    let corners = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
                    draft.faces.extend(corners);
                }
                _ => draft.faces.push(face),
            }
        }
        for [a, b] in std::mem::take(&mut draft.edges) {
            match middles.get(&sorted([a, b])) {
                Some(&middle) => draft.edges.extend([[a, middle], [middle, b]]),
                None => draft.edges.push([a, b]),
            }
        }
    }

    fn drop_worst(&mut self) {
        let keeps = |edge: [u32; 2]| self.off.get(&sorted(edge)).is_none_or(|off| *off <= DROP);
        let draft = &mut self.mesh.draft;
        draft
            .faces
            .retain(|face| sides(face).into_iter().all(keeps));
        draft.edges.retain(|edge| keeps(*edge));
    }
}

impl Faces<'_> {
    /// How far a ball sticks out of the solid.
    pub fn off(&self, ball: &Ball) -> f64 {
        ball.radius
            + self
                .tree
                .signed_distance(ball.center, ball.radius.max(GUESS))
    }
}

fn middle(a: &Ball, b: &Ball) -> Ball {
    Ball::interpolate([*a, *b, *b], [0.5, 0.5, 0.0])
}
