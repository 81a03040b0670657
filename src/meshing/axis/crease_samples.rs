//! Samples for a medial mesh that keeps creases: none on a convex crease, but mirrored pairs on both
//! sides of it, whose bisector runs into it; then reflex edges, vertices, and blue noise.

use crate::error::BuildError;
use crate::meshing::axis::local_spacing::LocalSpacing;
use crate::meshing::geometry::bounds::{Point, direction};
use crate::meshing::geometry::random::Random;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::creases::{SharpEdge, SharpEdges};
use crate::meshing::surface::samples::{
    CANDIDATES, Grid, Sample, dense_samples, even_samples, spacing, vertex_samples_where,
};
use crate::meshing::watch::Watch;

/// Distance between two pairs along a crease, in units of the distance between samples on its faces.
const PAIRS: f64 = 0.8;

/// Distance of each half of a pair from the crease, in units of the distance between pairs.
const OFFSET: f64 = 0.35;

/// Pairs are this much nearer to each other at least, over their own distance, than steps are along a
/// crease: chains of short edges would have a pair for each.
const LEAST_STEP: f64 = 0.7;

/// How often a pair comes nearer by half, where the faces beside the crease are narrow.
const HALVINGS: usize = 4;

/// A half may be off its face by this share of its offset.
const OFF_FACE: f64 = 0.2;

/// Largest distance between samples along a reflex edge, in units of the distance between samples on its faces.
const REFLEX_STEP: f64 = 0.9;

/// Distance to an earlier sample within which a reflex edge gets none, in the same unit. It must be below
/// [`REFLEX_STEP`], or neighbours along the edge would keep each other out.
const REFLEX_GAP: f64 = 0.6;

/// Samples of a body with creases.
pub struct CreaseSamples {
    /// The samples.
    pub samples: Vec<Sample>,
    /// The distance to the next around each.
    pub distances: Vec<f64>,
    /// Distance of samples where matter is thick.
    pub spacing: f64,
}

/// About `count` samples, and more along sharp edges and where matter is thin.
pub fn crease_samples(
    surface: &Surface,
    tree: &TriangleTree,
    creases: &SharpEdges,
    count: usize,
    watch: &mut Watch,
) -> Result<CreaseSamples, BuildError> {
    let distance = spacing(surface, count);
    let mut on_crease = vec![false; surface.vertices.len()];
    for v in creases.convex.iter().flat_map(|e| e.vertices) {
        on_crease[v as usize] = true;
    }
    let mut random = Random::new(1);
    let mut vertices = vertex_samples_where(surface, |v| !on_crease[v]);
    random.shuffle(&mut vertices);
    let mut inner = even_samples(surface, CANDIDATES * count, &mut random);
    let local = LocalSpacing::new(tree, creases, &inner, distance, watch)?;
    let mut dense = vec![1.0f64; surface.triangles.len()];
    for sample in &inner {
        let own = &mut dense[sample.triangle as usize];
        *own = own.max((distance / local.at(sample)).powi(2));
    }
    let share = surface.area / (CANDIDATES * count) as f64;
    let more = |t: usize| dense[t] - 1.0;
    inner.extend(dense_samples(surface, share, more, &mut Random::new(6)));
    random.shuffle(&mut inner);
    let mut sampler = Sampler {
        surface,
        tree,
        creases,
        local,
        grid: Grid::new(distance),
        on_creases: Grid::new(distance),
        samples: Vec::new(),
        distances: Vec::new(),
    };
    for (i, edge) in creases.convex.iter().enumerate() {
        if i % 64 == 0 {
            watch.again()?;
        }
        sampler.add_pairs(edge);
    }
    for edge in &creases.reflex {
        sampler.add_reflex(edge, &on_crease);
    }
    for (i, sample) in vertices.into_iter().chain(inner).enumerate() {
        if i % 4096 == 0 {
            watch.again()?;
        }
        let distance = sampler.local.at(&sample);
        if !sampler.grid.is_near(sample.point, distance) {
            sampler.add(sample, distance);
        }
    }
    Ok(CreaseSamples {
        samples: sampler.samples,
        distances: sampler.distances,
        spacing: distance,
    })
}

struct Sampler<'a> {
    surface: &'a Surface,
    tree: &'a TriangleTree,
    creases: &'a SharpEdges,
    local: LocalSpacing<'a>,
    grid: Grid,
    /// Places on creases that have a pair.
    on_creases: Grid,
    samples: Vec<Sample>,
    distances: Vec<f64>,
}

impl Sampler<'_> {
    fn add(&mut self, sample: Sample, distance: f64) {
        self.grid.add(sample.point);
        self.samples.push(sample);
        self.distances.push(distance);
    }

    /// The distance between samples on either face of an edge.
    fn distance(&self, edge: &SharpEdge, place: Point) -> f64 {
        let group = |t: u32| self.creases.group[t as usize];
        let [one, other] = edge.triangles.map(|t| self.local.at_face(place, group(t)));
        one.min(other)
    }

    fn add_pairs(&mut self, edge: &SharpEdge) {
        let [a, b] = edge.vertices.map(|v| self.surface.vertices[v as usize]);
        let length = (b - a).length();
        let along = [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| self.distance(edge, a + (b - a) * t));
        let distance = along.into_iter().fold(f64::INFINITY, f64::min);
        let gap = PAIRS * distance;
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
                    self.add(one, distance);
                    self.add(other, distance);
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
        let (point, nearest) = self.tree.closest_triangle(wanted, offset);
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
        let distance = self.distance(edge, (a + b) * 0.5);
        let steps = ((b - a).length() / (REFLEX_STEP * distance)).ceil();
        let steps = steps.max(1.0) as usize;
        let [at_a, at_b] = edge.vertices.map(|v| on_crease[v as usize]);
        let normals = edge.triangles.map(|t| self.surface.normals[t as usize]);
        for i in 0..=steps {
            let point = a + (b - a) * (i as f64 / steps as f64);
            let at_crease = (i == 0 && at_a) || (i == steps && at_b);
            if !at_crease && !self.grid.is_near(point, REFLEX_GAP * distance) {
                self.add(
                    Sample {
                        point,
                        normal: direction(normals[0] + normals[1]),
                        triangle: edge.triangles[0],
                    },
                    distance,
                );
            }
        }
    }
}
