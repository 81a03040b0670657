//! Samples for a medial mesh that keeps creases: none on a convex crease, but mirrored pairs on both
//! sides of it, whose bisector runs into it; then reflex edges, vertices, and blue noise.

use super::bounds::{Point, direction};
use super::creases::{Creases, SharpEdge};
use super::random::Random;
use super::samples::{CANDIDATES, Grid, Sample, even_samples, spacing, vertex_samples_where};
use super::surface::Surface;
use super::triangle_tree::TriangleTree;
use super::watch::Watch;
use crate::error::BuildError;

/// Distance between pairs along a crease, and of each half of a pair from it, over that of samples.
const PAIRS: f64 = 0.8;
const OFFSET: f64 = 0.35;

/// Pairs are this much nearer to each other at least, over their own distance, than steps are along a
/// crease: chains of short edges would have a pair for each.
const LEAST_STEP: f64 = 0.7;

/// How often a pair comes nearer by half, where the faces beside the crease are narrow.
const HALVINGS: usize = 4;

/// A half may be off its face by this share of its offset.
const OFF_FACE: f64 = 0.2;

/// Samples along a reflex edge, over the distance of samples: their step, and how near others may be.
const REFLEX_STEP: f64 = 0.9;
const REFLEX_GAP: f64 = 0.6;

/// About `count` samples and more along sharp edges; and the distance between them.
pub fn crease_samples(
    surface: &Surface,
    tree: &TriangleTree,
    creases: &Creases,
    count: usize,
    watch: &mut Watch,
) -> Result<(Vec<Sample>, f64), BuildError> {
    let distance = spacing(surface, count);
    let mut sampler = Sampler {
        surface,
        tree,
        creases,
        distance,
        grid: Grid::new(distance),
        on_creases: Grid::new(distance),
        samples: Vec::new(),
    };
    for (i, edge) in creases.convex.iter().enumerate() {
        if i % 64 == 0 {
            watch.again()?;
        }
        sampler.add_pairs(edge);
    }
    let mut on_crease = vec![false; surface.vertices.len()];
    for v in creases.convex.iter().flat_map(|e| e.vertices) {
        on_crease[v as usize] = true;
    }
    for edge in &creases.reflex {
        sampler.add_reflex(edge, &on_crease);
    }
    let mut random = Random::new(1);
    let mut vertices = vertex_samples_where(surface, |v| !on_crease[v]);
    random.shuffle(&mut vertices);
    let mut inner = even_samples(surface, CANDIDATES * count, &mut random);
    random.shuffle(&mut inner);
    for (i, sample) in vertices.into_iter().chain(inner).enumerate() {
        if i % 4096 == 0 {
            watch.again()?;
        }
        if !sampler.grid.is_near(sample.point, distance) {
            sampler.add(sample);
        }
    }
    Ok((sampler.samples, distance))
}

struct Sampler<'a> {
    surface: &'a Surface,
    tree: &'a TriangleTree,
    creases: &'a Creases,
    distance: f64,
    grid: Grid,
    /// Places on creases that have a pair.
    on_creases: Grid,
    samples: Vec<Sample>,
}

impl Sampler<'_> {
    fn add(&mut self, sample: Sample) {
        self.grid.add(sample.point);
        self.samples.push(sample);
    }

    fn add_pairs(&mut self, edge: &SharpEdge) {
        let [a, b] = edge.vertices.map(|v| self.surface.vertices[v as usize]);
        let gap = PAIRS * self.distance;
        let length = (b - a).length();
        let steps = (length / gap).ceil().max(1.0);
        let step = length / steps;
        for i in 0..steps as usize {
            let place = a + (b - a) * ((i as f64 + 0.5) / steps);
            let clear = PAIRS * gap.min(step.max(LEAST_STEP * gap));
            if self.on_creases.is_near(place, clear) {
                continue;
            }
            let mut offset = OFFSET * gap.min(step.max(0.5 * gap));
            for _ in 0..HALVINGS {
                let [one, other] = edge.triangles.map(|t| self.beside(t, a, b, place, offset));
                if let (Some(one), Some(other)) = (one, other) {
                    self.on_creases.add(place);
                    self.add(one);
                    self.add(other);
                    break;
                }
                offset *= 0.5;
            }
        }
    }

    /// The point `offset` away from `place` on the crease `ab`, across the face of `triangle`, if it is
    /// on that face.
    fn beside(
        &self,
        triangle: u32,
        a: Point,
        b: Point,
        place: Point,
        offset: f64,
    ) -> Option<Sample> {
        let along = direction(b - a);
        let across = |p: Point| (p - place) - along * (p - place).dot(along);
        let ways = self.surface.corners(triangle as usize).map(across);
        let farther = |x: Point, y: Point| if y.length_sq() > x.length_sq() { y } else { x };
        let inward = direction(ways.into_iter().fold(Point::zero(), farther));
        let wanted = place + inward * offset;
        let (point, nearest) = self.tree.closest_from(wanted, 0);
        let nearest = self.tree.given(nearest);
        let group = |t: u32| self.creases.group[t as usize];
        let on_face = (point - wanted).length() < OFF_FACE * offset;
        (on_face && group(nearest) == group(triangle)).then(|| Sample {
            point,
            normal: self.surface.normals[nearest as usize],
            triangle: nearest,
        })
    }

    fn add_reflex(&mut self, edge: &SharpEdge, on_crease: &[bool]) {
        let [a, b] = edge.vertices.map(|v| self.surface.vertices[v as usize]);
        let steps = ((b - a).length() / (REFLEX_STEP * self.distance)).ceil();
        let steps = steps.max(1.0) as usize;
        let [at_a, at_b] = edge.vertices.map(|v| on_crease[v as usize]);
        let normals = edge.triangles.map(|t| self.surface.normals[t as usize]);
        for i in 0..=steps {
            let point = a + (b - a) * (i as f64 / steps as f64);
            let at_crease = (i == 0 && at_a) || (i == steps && at_b);
            if !at_crease && !self.grid.is_near(point, REFLEX_GAP * self.distance) {
                self.add(Sample {
                    point,
                    normal: direction(normals[0] + normals[1]),
                    triangle: edge.triangles[0],
                });
            }
        }
    }
}
