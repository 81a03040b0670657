//! The source surface: checked, welded, oriented, and brought to the builder's frame, in which its
//! longest side is 1 and its box is centred at the origin.

use super::bounds::{Bounds, Point, coordinate, direction};
use super::orient;
use crate::error::BuildError;
use crate::math::{Real, Vector};
use parry3d::mass_properties::MassProperties;
use std::collections::HashMap;

/// Vertices nearer than this are one (longest side 1). Well above the rounding of `f32` input,
/// well below any error a build can reach; wider would close slits, narrower leaves seams open.
const WELD: f64 = 1e-6;

/// A triangle lower than this over its longest edge has no usable normal and no area that matters
/// (longest side 1). It still closes the surface: it counts as a neighbour, not as a triangle.
const NEEDLE: f64 = 1e-7;

/// From the user's unit and origin to the builder's, and back.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Middle of the source's box, in the user's unit.
    pub center: Point,
    /// Longest side of the source's box, in the user's unit.
    pub scale: f64,
}

impl Frame {
    /// To the builder's frame.
    pub fn enter(&self, v: Vector) -> Point {
        (Point::from_vector(v) - self.center) * (1.0 / self.scale)
    }
}

/// A triangle mesh that the stages can rely on: finite, no needles, consistently oriented where
/// that is possible.
pub struct Surface {
    /// Welded vertices, in the builder's frame.
    pub vertices: Vec<Point>,
    /// Triangles with area; their vertices differ.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles without area. They count for nothing but enclosure.
    pub needles: Vec<[u32; 3]>,
    /// How far welding moved a vertex at most (longest side 1).
    pub welded: f64,
    /// Unit normal of each triangle, outward where the surface is closed.
    pub normals: Vec<Point>,
    /// How to get back to the user's unit.
    pub frame: Frame,
    /// Sum of the triangles' areas (longest side 1).
    pub area: f64,
    /// Volume enclosed (longest side 1); meaningful when `closed`.
    pub volume: f64,
    /// Whether each edge is used as often in one direction as in the other.
    pub closed: bool,
    /// What was found and what was done about it.
    pub notes: Vec<String>,
}

impl Surface {
    /// Checks and cleans a triangle mesh given in the user's unit.
    pub fn new(vertices: &[Vector], indices: &[[u32; 3]]) -> Result<Self, BuildError> {
        check(vertices, indices)?;
        let frame = frame_of(vertices, indices)?;
        let entered: Vec<Point> = vertices.iter().map(|&v| frame.enter(v)).collect();
        let (vertices, index_of, welded) = weld(&entered, indices);
        let mut notes = Vec::new();
        if vertices.len() < entered.len() {
            let (from, to) = (entered.len(), vertices.len());
            notes.push(format!("{from} vertices: {to} used and distinct"));
        }
        let mut triangles = distinct(indices, &index_of, &mut notes);
        let orientation = orient::orient(&vertices, &mut triangles);
        notes.extend(orientation.notes());
        let has_area = |t: &[u32; 3]| height(corners(&vertices, t)) >= NEEDLE;
        let (triangles, needles): (Vec<_>, Vec<_>) = triangles.into_iter().partition(has_area);
        if !needles.is_empty() {
            notes.push(format!("{} triangles without area ignored", needles.len()));
        }
        if triangles.is_empty() {
            let side = frame.scale;
            return Err(BuildError::ZeroSize {
                message: format!(
                    "none of {} triangles has an area (longest side of the box {side})",
                    indices.len()
                ),
            });
        }
        let crosses = triangles
            .iter()
            .map(|t| cross(corners(&vertices, t)))
            .collect::<Vec<_>>();
        Ok(Self {
            area: crosses.iter().map(|c| 0.5 * c.length()).sum(),
            normals: crosses.into_iter().map(direction).collect(),
            volume: orientation.volume,
            closed: orientation.open_edges == 0 && orientation.unbalanced_edges == 0,
            vertices,
            triangles,
            needles,
            welded,
            frame,
            notes,
        })
    }

    /// Corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Point; 3] {
        corners(&self.vertices, &self.triangles[triangle])
    }

    /// Corners of all triangles, in order.
    pub fn all_corners(&self) -> impl Iterator<Item = [Point; 3]> + '_ {
        (0..self.triangles.len()).map(|i| self.corners(i))
    }

    /// Mass properties at unit density in the user's frame and unit, when the surface encloses a
    /// volume.
    ///
    /// They are integrated in the builder's frame, because parry sums in `f32` about the origin,
    /// and then scaled: mass with the third power of the length, inertia with the fifth.
    pub fn mass_properties(&self) -> Option<MassProperties> {
        // A flat closed surface has a volume of rounding errors only.
        if !self.closed || self.volume < 1e-9 * self.area {
            return None;
        }
        let vertices: Vec<Vector> = self.vertices.iter().map(|v| v.to_vector()).collect();
        let mut mass = MassProperties::from_trimesh(1.0, &vertices, &self.triangles);
        let scale = self.frame.scale;
        mass.local_com =
            (Point::from_vector(mass.local_com) * scale + self.frame.center).to_vector();
        mass.inv_mass = (f64::from(mass.inv_mass) / scale.powi(3)) as Real;
        let inverse = Point::from_vector(mass.inv_principal_inertia) * (1.0 / scale.powi(5));
        mass.inv_principal_inertia = inverse.to_vector();
        let usable = mass.local_com.is_finite()
            && mass.inv_mass.is_finite()
            && mass.inv_mass > 0.0
            && mass.inv_principal_inertia.is_finite();
        usable.then_some(mass)
    }
}

fn check(vertices: &[Vector], indices: &[[u32; 3]]) -> Result<(), BuildError> {
    if indices.is_empty() {
        return Err(BuildError::Empty {
            vertices: vertices.len(),
        });
    }
    if let Some(index) = vertices.iter().position(|v| !v.is_finite()) {
        return Err(BuildError::NotFinite {
            index,
            position: vertices[index].into(),
        });
    }
    let count = vertices.len();
    for (index, triangle) in indices.iter().enumerate() {
        if let Some(&value) = triangle.iter().find(|&&v| v as usize >= count) {
            return Err(BuildError::IndexOutOfRange {
                index,
                value: value.into(),
                count,
            });
        }
    }
    Ok(())
}

/// The frame from the box of the vertices that triangles use: a stray vertex must not shrink the
/// rest.
fn frame_of(vertices: &[Vector], indices: &[[u32; 3]]) -> Result<Frame, BuildError> {
    let used = indices
        .iter()
        .flatten()
        .map(|&v| Point::from_vector(vertices[v as usize]));
    let bounds = Bounds::of(used);
    let scale = bounds.longest_side();
    if scale <= 0.0 {
        return Err(BuildError::ZeroSize {
            message: format!(
                "all triangles lie in the point {:?}",
                <[Real; 3]>::from(bounds.lo.to_vector())
            ),
        });
    }
    Ok(Frame {
        center: bounds.center(),
        scale,
    })
}

/// Merges vertices nearer than [`WELD`]; gives the distinct ones, the new index of each old one, and
/// the largest distance between the two.
fn weld(vertices: &[Point], indices: &[[u32; 3]]) -> (Vec<Point>, Vec<u32>, f64) {
    // Large cells: a vertex then rarely lies near a cell's side, so that one look-up does.
    let cell = 64.0 * WELD;
    let key = |p: Point| [0, 1, 2].map(|k| (coordinate(p, k) / cell).floor() as i64);
    let reach = Point::new(WELD, WELD, WELD);
    let mut grid: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut distinct: Vec<Point> = Vec::new();
    let mut index_of = vec![u32::MAX; vertices.len()];
    let mut moved_sq = 0.0f64;
    for &v in indices.iter().flatten() {
        if index_of[v as usize] != u32::MAX {
            continue;
        }
        let p = vertices[v as usize];
        let (lo, hi) = (key(p - reach), key(p + reach));
        let mut twin = None;
        for x in lo[0]..=hi[0] {
            for y in lo[1]..=hi[1] {
                for z in lo[2]..=hi[2] {
                    let near = grid.get(&[x, y, z]).into_iter().flatten();
                    twin = twin.or(near
                        .copied()
                        .find(|&i| (distinct[i as usize] - p).length_sq() < WELD * WELD));
                }
            }
        }
        index_of[v as usize] = twin.unwrap_or_else(|| {
            let new = distinct.len() as u32;
            distinct.push(p);
            grid.entry(key(p)).or_default().push(new);
            new
        });
        let kept = distinct[index_of[v as usize] as usize];
        moved_sq = moved_sq.max((kept - p).length_sq());
    }
    (distinct, index_of, moved_sq.sqrt())
}

/// Triangles of three different vertices, each set of vertices once.
fn distinct(indices: &[[u32; 3]], index_of: &[u32], notes: &mut Vec<String>) -> Vec<[u32; 3]> {
    let mut seen = std::collections::HashSet::new();
    let (mut collapsed, mut repeated) = (0usize, 0usize);
    let mut triangles = Vec::with_capacity(indices.len());
    for t in indices {
        let t = t.map(|v| index_of[v as usize]);
        if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] {
            collapsed += 1;
            continue;
        }
        let mut key = t;
        key.sort_unstable();
        if seen.insert(key) {
            triangles.push(t);
        } else {
            repeated += 1;
        }
    }
    if collapsed > 0 {
        notes.push(format!(
            "{collapsed} triangles of fewer than three points ignored"
        ));
    }
    if repeated > 0 {
        notes.push(format!("{repeated} repeated triangles ignored"));
    }
    triangles
}

fn corners(vertices: &[Point], t: &[u32; 3]) -> [Point; 3] {
    t.map(|v| vertices[v as usize])
}

fn cross([a, b, c]: [Point; 3]) -> Point {
    (b - a).cross(c - a)
}

/// Height of a triangle over its longest edge.
fn height(t: [Point; 3]) -> f64 {
    let longest_sq = (t[1] - t[0])
        .length_sq()
        .max((t[2] - t[1]).length_sq())
        .max((t[0] - t[2]).length_sq());
    if longest_sq > 0.0 {
        cross(t).length() / longest_sq.sqrt()
    } else {
        0.0
    }
}
