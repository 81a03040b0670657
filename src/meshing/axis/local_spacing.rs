//! Distance between samples by local thickness: next to thin matter they are nearer to each other, so that two faces
//! with matter between them do not share a neighbourhood.
//!
//! The thickness at a point of a face is that of the ball which touches the face there (`insert.rs`), and of all such
//! balls around on the same face the largest: next to a convex crease balls are small, whatever lies behind.
//! Source of the measure: Amenta and Bern, "Surface reconstruction by Voronoi filtering" (1999), local feature size.

use crate::error::BuildError;
use crate::math::fast_hash::FastMap;
use crate::meshing::axis::shrinking_ball::shrink_from;
use crate::meshing::geometry::bounds::{Point, coordinate};
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::surface::creases::SharpEdges;
use crate::meshing::surface::samples::Sample;
use crate::meshing::watch::Watch;

/// Distance between samples where matter is thin, in units of the radius of the largest ball around.
const PER_RADIUS: f64 = 1.0;

/// How far "around" reaches, in units of the distance between samples where matter is thick. Balls that touch a face
/// near a convex edge are small, however thick the body is; smaller, and the edges of a box would count as thin.
const AROUND: f64 = 2.0;

/// Least distances between samples that are tried, in units of the distance where matter is thick. The first that keeps
/// to [`MOST_SAMPLES`] is taken; if none does, samples have one distance everywhere.
const LEAST: [f64; 3] = [0.3, 0.5, 0.7];

/// Ratio to which thin matter may raise the number of samples. Time and memory of a build grow with it.
const MOST_SAMPLES: f64 = 2.5;

/// Balls found at points of faces.
pub struct LocalSpacing<'a> {
    creases: &'a SharpEdges,
    /// Distance elsewhere.
    distance: f64,
    least: f64,
    /// Points with the group of their face and the radius of their ball, up to what is of use, by cubes of the size
    /// that counts as around.
    cells: FastMap<[i32; 3], Vec<(Point, u32, f64)>>,
}

impl<'a> LocalSpacing<'a> {
    /// Finds the balls at `probes`, of which each stands for as much of the surface.
    pub fn new(
        tree: &TriangleTree,
        creases: &'a SharpEdges,
        probes: &[Sample],
        distance: f64,
        watch: &mut Watch,
    ) -> Result<Self, BuildError> {
        let mut spacing = Self {
            creases,
            distance,
            least: distance,
            cells: FastMap::default(),
        };
        let enough = distance / PER_RADIUS;
        for (i, probe) in probes.iter().enumerate() {
            if i % 1024 == 0 {
                watch.again()?;
            }
            let ball = shrink_from(tree, probe.point, -probe.normal, enough);
            let group = creases.group[probe.triangle as usize];
            let key = spacing.key(probe.point);
            let found = (probe.point, group, ball.radius);
            spacing.cells.entry(key).or_default().push(found);
        }
        let mut unlimited = Vec::with_capacity(probes.len());
        for (i, probe) in probes.iter().enumerate() {
            if i % 1024 == 0 {
                watch.again()?;
            }
            let group = creases.group[probe.triangle as usize];
            unlimited.push(PER_RADIUS * spacing.thickness(probe.point, group));
        }
        let growth = |least: f64| {
            let times = |h: &f64| (distance / h.clamp(least, distance)).powi(2);
            unlimited.iter().map(times).sum::<f64>() / unlimited.len().max(1) as f64
        };
        let fits = |share: &&f64| growth(**share * distance) <= MOST_SAMPLES;
        spacing.least = LEAST.iter().find(fits).map_or(distance, |s| s * distance);
        Ok(spacing)
    }

    /// Distance between samples at one of them.
    pub fn at(&self, sample: &Sample) -> f64 {
        self.at_face(sample.point, self.creases.group[sample.triangle as usize])
    }

    /// Distance between samples at a point of a face of `group`.
    pub fn at_face(&self, p: Point, group: u32) -> f64 {
        if self.least >= self.distance {
            return self.distance;
        }
        let wanted = PER_RADIUS * self.thickness(p, group);
        wanted.clamp(self.least, self.distance)
    }

    /// The largest radius around on the same face, up to what is of use.
    fn thickness(&self, p: Point, group: u32) -> f64 {
        let [x, y, z] = self.key(p);
        let mut largest: Option<f64> = None;
        for cell in (0..27).map(|k| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]) {
            for &(q, of, radius) in self.cells.get(&cell).into_iter().flatten() {
                let is_around = of == group && (q - p).length_sq() < self.around() * self.around();
                if is_around && largest.is_none_or(|r| radius > r) {
                    largest = Some(radius);
                }
            }
        }
        // No probe at all came upon so narrow a face.
        largest.unwrap_or(0.0)
    }

    fn key(&self, p: Point) -> [i32; 3] {
        [0, 1, 2].map(|k| (coordinate(p, k) / self.around()).floor() as i32)
    }

    fn around(&self) -> f64 {
        AROUND * self.distance
    }
}
