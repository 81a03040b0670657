//! The initial medial mesh of sheets: the triangles themselves, as thin slabs.
//!
//! Where the two sides of matter lie nearer to each other than samples do, and where there are more
//! triangles than any result needs, vertices are merged by the cells of a grid: Rossignac and
//! Borrel, "Multi-resolution 3D approximations for rendering complex scenes" (1993).

use crate::error::BuildError;
use crate::math::fast_hash::{FastMap, FastSet};
use crate::meshing::draft::{Ball, Draft};
use crate::meshing::geometry::bounds::{Point, coordinate};
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::watch::Watch;

/// Half-thickness of a sheet before enclosure (longest side 1).
pub const SHEET: f64 = 1e-3;

/// Most triangles that a medial mesh of sheets starts from: ten times what any count of primitives
/// in use needs, and a second's collapse.
const MAX_TRIANGLES: usize = 60_000;

/// Winding number from which a point of a sheet counts as inside solid matter.
const INSIDE: f64 = 0.75;

/// Triangles to become slabs.
#[derive(Default)]
struct TriangleList {
    points: Vec<Point>,
    triangles: Vec<[u32; 3]>,
}

/// Slabs of the open patches, and how many of their triangles were left out because they lie
/// inside solid matter.
pub fn open_sheets(
    surface: &Surface,
    tree: &TriangleTree,
    watch: &mut Watch,
) -> Result<(Draft, usize), BuildError> {
    let mut soup = TriangleList::new(surface, |t| surface.sheet[t], watch)?;
    if soup.triangles.len() > MAX_TRIANGLES {
        soup.merge_by_cells(soup.coarsest(), watch)?;
    }
    let buried = match surface.sheet.contains(&false) {
        true => soup.drop_buried(tree, watch)?,
        false => 0,
    };
    Ok((soup.into_draft(watch)?, buried))
}

/// Slabs of matter thinner than `thickness`, given by the triangles on both its sides.
pub fn thin_sheets(
    surface: &Surface,
    thin: &[bool],
    thickness: f64,
    watch: &mut Watch,
) -> Result<Draft, BuildError> {
    let mut soup = TriangleList::new(surface, |t| thin[t], watch)?;
    soup.merge_by_cells(thickness.max(soup.coarsest()), watch)?;
    soup.into_draft(watch)
}

impl TriangleList {
    fn new(
        surface: &Surface,
        wanted: impl Fn(usize) -> bool,
        watch: &mut Watch,
    ) -> Result<Self, BuildError> {
        let mut soup = Self::default();
        let mut index_of: FastMap<u32, u32> = FastMap::default();
        for (i, t) in surface.triangles.iter().enumerate() {
            watch.every(i)?;
            if !wanted(i) {
                continue;
            }
            soup.triangles.push(t.map(|v| {
                *index_of.entry(v).or_insert_with(|| {
                    soup.points.push(surface.vertices[v as usize]);
                    soup.points.len() as u32 - 1
                })
            }));
        }
        Ok(soup)
    }

    /// Side of the cells that leave about [`MAX_TRIANGLES`] triangles: a cell of a flat sheet gives two.
    fn coarsest(&self) -> f64 {
        let area_of = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| self.points[v as usize]);
            0.5 * (b - a).cross(c - a).length()
        };
        let area: f64 = self.triangles.iter().map(area_of).sum();
        (2.0 * area / MAX_TRIANGLES as f64).sqrt()
    }

    /// Merges all points of a cell at their mean.
    fn merge_by_cells(&mut self, cell: f64, watch: &mut Watch) -> Result<(), BuildError> {
        let mut places: FastMap<[i32; 3], u32> = FastMap::default();
        let mut sums: Vec<(Point, f64)> = Vec::new();
        let mut place_of = Vec::with_capacity(self.points.len());
        for (i, &p) in self.points.iter().enumerate() {
            watch.every(i)?;
            let key = [0, 1, 2].map(|k| (coordinate(p, k) / cell).floor() as i32);
            let place = *places.entry(key).or_insert_with(|| {
                sums.push((Point::zero(), 0.0));
                sums.len() as u32 - 1
            });
            let sum = &mut sums[place as usize];
            *sum = (sum.0 + p, sum.1 + 1.0);
            place_of.push(place);
        }
        self.points = sums.into_iter().map(|(p, n)| p * (1.0 / n)).collect();
        let mut seen = FastSet::default();
        self.triangles.retain_mut(|t| {
            *t = t.map(|v| place_of[v as usize]);
            t.sort_unstable();
            seen.insert(*t)
        });
        Ok(())
    }

    /// Leaves out triangles inside solid matter; returns their number.
    fn drop_buried(&mut self, tree: &TriangleTree, watch: &mut Watch) -> Result<usize, BuildError> {
        let mut inside = Vec::with_capacity(self.points.len());
        for (i, &p) in self.points.iter().enumerate() {
            if i % 256 == 0 {
                watch.at(0.5)?;
            }
            inside.push(tree.winding(p) > INSIDE);
        }
        let before = self.triangles.len();
        self.triangles.retain(|t| {
            let [a, b, c] = t.map(|v| self.points[v as usize]);
            let middle = (a + b + c) * (1.0 / 3.0);
            !(t.iter().all(|&v| inside[v as usize]) && tree.winding(middle) > INSIDE)
        });
        Ok(before - self.triangles.len())
    }

    /// Makes a draft of the sheets. A strip narrower than a cell has become an edge, and a speck a point: they stay as
    /// cones and balls.
    fn into_draft(self, watch: &mut Watch) -> Result<Draft, BuildError> {
        let mut draft = Draft::default();
        let mut index_of: FastMap<u32, u32> = FastMap::default();
        for (i, t) in self.triangles.iter().enumerate() {
            watch.every(i)?;
            let [a, b, c] = t.map(|v| {
                *index_of.entry(v).or_insert_with(|| {
                    draft.balls.push(Ball {
                        center: self.points[v as usize],
                        radius: SHEET,
                    });
                    draft.balls.len() as u32 - 1
                })
            });
            if a != b && b != c && c != a {
                draft.faces.push([a, b, c]);
            } else if a != c {
                draft.edges.push([a, c]);
            } else if a != b {
                draft.edges.push([a, b]);
            }
        }
        Ok(draft)
    }
}
