//! Blue-noise samples of the source surface: no two nearer than a given distance, no large gaps.
//! Source: dart throwing (Cook, "Stochastic sampling in computer graphics", 1986) among candidates
//! spread evenly by area.

use crate::error::BuildError;
use crate::math::fast_hash::FastMap;
use crate::meshing::geometry::bounds::{Point, coordinate, direction};
use crate::meshing::geometry::random::Random;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::watch::Watch;

/// Candidates per sample wanted. Fewer leave gaps, more cost time for a few samples.
pub const CANDIDATES: usize = 6;

/// Distance between samples over √(area / samples). Random darts fill 0.547 of the plane with
/// discs (Rényi's parking problem in the plane), so the limit is √(4 · 0.547 / π) = 0.83; with
/// [`CANDIDATES`] darts per sample this value gives the count asked for, within a tenth.
const SPACING: f64 = 0.76;

/// A point of the surface and the outward unit normal there.
#[derive(Clone, Copy)]
pub struct Sample {
    /// Point of the sample.
    pub point: Point,
    /// Unit normal; at vertices the mean of the triangles', weighted by their angles.
    pub normal: Point,
    /// A triangle that it lies in.
    pub triangle: u32,
}

/// About `count` samples: vertices first, so that corners are kept, then points of triangles.
pub fn blue_noise(
    surface: &Surface,
    count: usize,
    watch: &mut Watch,
) -> Result<Vec<Sample>, BuildError> {
    let mut random = Random::new(1);
    let mut corners = vertex_samples(surface);
    random.shuffle(&mut corners);
    let mut inner = even_samples(surface, CANDIDATES * count, &mut random);
    random.shuffle(&mut inner);
    let distance = spacing(surface, count);
    let mut grid = Grid::new(distance);
    let total = corners.len() + inner.len();
    let mut kept = Vec::with_capacity(count);
    for (i, sample) in corners.into_iter().chain(inner).enumerate() {
        if i % 4096 == 0 {
            watch.at(i as f64 / total as f64)?;
        }
        if !grid.is_near(sample.point, distance) {
            grid.add(sample.point);
            kept.push(sample);
        }
    }
    Ok(kept)
}

/// Distance between about `count` blue-noise samples.
pub fn spacing(surface: &Surface, count: usize) -> f64 {
    SPACING * (surface.area / count as f64).sqrt()
}

/// Points spread by area: one at random in each of `count` equal shares of it.
pub fn even_samples(surface: &Surface, count: usize, random: &mut Random) -> Vec<Sample> {
    let share = surface.area / count as f64;
    let mut samples = dense_samples(surface, share, |_| 1.0, random);
    samples.truncate(count);
    samples
}

/// Points spread by area and by how `dense` they are to be on each triangle: one in each `share` of the area where
/// that is 1.
pub fn dense_samples(
    surface: &Surface,
    share: f64,
    dense: impl Fn(usize) -> f64,
    random: &mut Random,
) -> Vec<Sample> {
    let mut samples = Vec::new();
    let (mut passed, mut next) = (0.0, share * random.unit());
    for (triangle, &normal) in surface.normals.iter().enumerate() {
        let [a, b, c] = surface.corners(triangle);
        passed += 0.5 * (b - a).cross(c - a).length() * dense(triangle);
        while next < passed {
            // The square root makes the point uniform over the triangle.
            let (s, t) = (random.unit().sqrt(), random.unit());
            let point = a * (1.0 - s) + b * (s * (1.0 - t)) + c * (s * t);
            samples.push(Sample {
                point,
                normal,
                triangle: triangle as u32,
            });
            next = share * (samples.len() as f64 + random.unit());
        }
    }
    samples
}

/// One sample at each vertex, with the angle-weighted normal (Baerentzen and Aanaes 2005), whose
/// sign tells inside from outside.
pub fn vertex_samples(surface: &Surface) -> Vec<Sample> {
    vertex_samples_where(surface, |_| true)
}

/// [`vertex_samples`] at the vertices, by index, that `wanted` says.
pub fn vertex_samples_where(surface: &Surface, wanted: impl Fn(usize) -> bool) -> Vec<Sample> {
    let mut normals = vec![(Point::zero(), 0); surface.vertices.len()];
    for (t, (vertices, &normal)) in surface.triangles.iter().zip(&surface.normals).enumerate() {
        let corners = surface.corners(t);
        for k in 0..3 {
            let u = corners[(k + 1) % 3] - corners[k];
            let v = corners[(k + 2) % 3] - corners[k];
            let angle = u.cross(v).length().atan2(u.dot(v));
            let sum = &mut normals[vertices[k] as usize];
            *sum = (sum.0 + normal * angle, t as u32);
        }
    }
    let used = |n: &Point| n.length_sq() > 0.0;
    let vertices = surface.vertices.iter().zip(normals).enumerate();
    vertices
        .filter(|&(v, (_, (n, _)))| used(&n) && wanted(v))
        .map(|(_, (&point, (n, triangle)))| Sample {
            point,
            normal: direction(n),
            triangle,
        })
        .collect()
}

/// Points in cubic cells, to find those near another.
pub struct Grid {
    cell: f64,
    last: FastMap<[i32; 3], u32>,
    /// Points, each with the index of the one before it in its cell.
    points: Vec<(Point, u32)>,
}

impl Grid {
    /// An empty grid for points about `distance` apart.
    pub fn new(distance: f64) -> Self {
        Self {
            // Three distances: a point's reach then meets 4.6 cells on average, and a cell holds
            // about ten points of a surface. One distance means 27 cells.
            cell: 3.0 * distance,
            last: FastMap::default(),
            points: Vec::new(),
        }
    }

    fn key(&self, p: Point) -> [i32; 3] {
        [0, 1, 2].map(|k| (coordinate(p, k) / self.cell).floor() as i32)
    }

    /// Whether a point is nearer to `p` than `distance`.
    pub fn is_near(&self, p: Point, distance: f64) -> bool {
        let reach = Point::new(distance, distance, distance);
        let (lo, hi) = (self.key(p - reach), self.key(p + reach));
        for x in lo[0]..=hi[0] {
            for y in lo[1]..=hi[1] {
                for z in lo[2]..=hi[2] {
                    let mut at = self.last.get(&[x, y, z]).copied();
                    while let Some(&(q, before)) = at.and_then(|i| self.points.get(i as usize)) {
                        if (q - p).length_sq() < distance * distance {
                            return true;
                        }
                        at = Some(before);
                    }
                }
            }
        }
        false
    }

    /// Adds a point.
    pub fn add(&mut self, p: Point) {
        let new = self.points.len() as u32;
        let key = self.key(p);
        let before = self.last.insert(key, new).unwrap_or(u32::MAX);
        self.points.push((p, before));
    }
}
