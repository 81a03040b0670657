//! Welding: vertices at one place become one vertex. Triangles that are then the same as another go;
//! those that are then a segment or a point are kept apart, for they are part of the surface too.

use crate::error::BuildError;
use crate::math::fast_hash::{FastMap, FastSet};
use crate::meshing::findings::Findings;
use crate::meshing::geometry::bounds::{Point, coordinate};
use crate::meshing::watch::Watch;

/// Vertices nearer than this are one (longest side 1). Well above the rounding of `f32` input,
/// well below any error a build can reach; wider would close slits, narrower leaves seams open.
const WELD: f64 = 1e-6;

/// Cells of the grid, in units of [`WELD`]. A vertex then looks into 3.4 cells on average, and a
/// cell holds less than a hundred vertices however dense they are.
const CELL: f64 = 4.0;

/// Mesh after welding.
pub struct Welded {
    /// The distinct vertices that triangles use, in order of first use.
    pub vertices: Vec<Point>,
    /// Triangles of three different vertices, each set of vertices once.
    pub triangles: Vec<[u32; 3]>,
    /// Places of the triangles that were given with either orientation.
    pub both_ways: Vec<usize>,
    /// Triangles that welding left with two vertices or one, unless another triangle has these too: segments and
    /// points.
    pub collapsed: Vec<[u32; 3]>,
    /// How far a vertex was moved at most (longest side 1).
    pub moved: f64,
}

/// Welds a mesh whose indices are in range.
pub fn weld(
    vertices: &[Point],
    indices: &[[u32; 3]],
    findings: &mut Findings,
    watch: &mut Watch,
) -> Result<Welded, BuildError> {
    let mut places = Places::default();
    let mut index_of = vec![u32::MAX; vertices.len()];
    let mut moved_sq = 0.0f64;
    for (i, triangle) in indices.iter().enumerate() {
        watch.every(i)?;
        for &v in triangle {
            if index_of[v as usize] != u32::MAX {
                continue;
            }
            let p = vertices[v as usize];
            let index = places.index_of(p);
            moved_sq = moved_sq.max((places.points[index as usize] - p).length_sq());
            index_of[v as usize] = index;
        }
    }
    findings.vertices_unused = index_of.iter().filter(|&&i| i == u32::MAX).count();
    let used = vertices.len() - findings.vertices_unused;
    findings.vertices_welded = used - places.points.len();
    // Place of each triangle, and whether it was given with its vertices in even order, and in odd.
    let mut seen: FastMap<[u32; 3], (usize, [bool; 2])> = FastMap::default();
    let mut triangles = Vec::with_capacity(indices.len());
    let mut collapsed = Vec::new();
    for (i, triangle) in indices.iter().enumerate() {
        watch.every(i)?;
        let t = triangle.map(|v| index_of[v as usize]);
        let mut key = t;
        key.sort_unstable();
        if key[0] == key[1] || key[1] == key[2] {
            findings.triangles_collapsed += 1;
            collapsed.push([key[0], key[2], key[2]]);
            continue;
        }
        let (place, given) = seen.entry(key).or_insert((triangles.len(), [false; 2]));
        given[usize::from(is_even(t))] = true;
        match *place == triangles.len() {
            true => triangles.push(t),
            false => findings.triangles_repeated += 1,
        }
    }
    let both_ways = seen.into_values().filter(|(_, given)| *given == [true; 2]);
    let mut both_ways: Vec<usize> = both_ways.map(|(place, _)| place).collect();
    both_ways.sort_unstable();
    leave_out_covered(&mut collapsed, &triangles, watch)?;
    Ok(Welded {
        vertices: places.points,
        triangles,
        both_ways,
        collapsed,
        moved: moved_sq.sqrt(),
    })
}

/// Whether three different vertices are in ascending order but for a rotation.
fn is_even([a, b, c]: [u32; 3]) -> bool {
    [a < b, b < c, c < a].into_iter().filter(|up| *up).count() == 2
}

impl Welded {
    /// Leaves out the vertices that nothing uses.
    pub fn leave_out_unused(&mut self) {
        let mut index_of = vec![u32::MAX; self.vertices.len()];
        let mut used = Vec::new();
        for v in self
            .triangles
            .iter_mut()
            .chain(&mut self.collapsed)
            .flatten()
        {
            let index = &mut index_of[*v as usize];
            if *index == u32::MAX {
                *index = used.len() as u32;
                used.push(self.vertices[*v as usize]);
            }
            *v = *index;
        }
        self.vertices = used;
    }
}

/// Takes out segments and points that are an edge or a corner of a triangle, or are listed before.
fn leave_out_covered(
    collapsed: &mut Vec<[u32; 3]>,
    triangles: &[[u32; 3]],
    watch: &mut Watch,
) -> Result<(), BuildError> {
    if collapsed.is_empty() {
        return Ok(());
    }
    // Both ends of an edge, the smaller first; of a corner, that vertex twice.
    let mut covered = FastSet::default();
    for (i, &[a, b, c]) in triangles.iter().enumerate() {
        watch.every(i)?;
        let edges = [[a, b], [b, c], [c, a]].map(|[u, v]| [u.min(v), u.max(v)]);
        covered.extend(edges.into_iter().chain([a, b, c].map(|v| [v, v])));
    }
    collapsed.retain(|&[a, b, _]| covered.insert([a, b]));
    Ok(())
}

/// Points farther apart than [`WELD`], in cells.
#[derive(Default)]
struct Places {
    points: Vec<Point>,
    /// Index, for each point, of the one before it in its cell.
    before: Vec<u32>,
    last: FastMap<[i32; 3], u32>,
}

impl Places {
    /// The index of the point that `p` is, which may be new.
    fn index_of(&mut self, p: Point) -> u32 {
        // Coordinates are at most ½, so that cells fit 32 bits.
        let key = |p: Point| [0, 1, 2].map(|k| (coordinate(p, k) / (CELL * WELD)).floor() as i32);
        let reach = Point::new(WELD, WELD, WELD);
        let (lo, hi) = (key(p - reach), key(p + reach));
        for x in lo[0]..=hi[0] {
            for y in lo[1]..=hi[1] {
                for z in lo[2]..=hi[2] {
                    let mut at = self.last.get(&[x, y, z]).copied().unwrap_or(u32::MAX);
                    while at != u32::MAX {
                        if (self.points[at as usize] - p).length_sq() < WELD * WELD {
                            return at;
                        }
                        at = self.before[at as usize];
                    }
                }
            }
        }
        let new = self.points.len() as u32;
        let before = self.last.insert(key(p), new).unwrap_or(u32::MAX);
        self.points.push(p);
        self.before.push(before);
        new
    }
}
