//! Mass properties of what a source surface encloses, at unit density.
//!
//! A simple closed surface is integrated exactly, by the divergence theorem, as a sum over tetrahedra (parry's is in
//! single precision, and off by a thousandth for thin bodies). Where patches overlap that counts matter twice, and
//! where they have openings it depends on the origin. Then volume integrals are summed along a lattice of parallel
//! lines: on each the winding number rises and falls by 1 from triangle to triangle, and matter is where it is 1 or
//! more. The lines' direction is incommensurable with the axes: along an axis they would all miss a thin wall, or all
//! hit it.

use crate::error::BuildError;
use crate::math::Real;
use crate::medial::mass::of_covariance;
use crate::meshing::findings::MassSource;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::surface::checked_surface::{BuilderFrame, Surface};
use crate::meshing::watch::Watch;
use nalgebra::Matrix3;
use parry3d::mass_properties::MassProperties;
use parry3d::math::Matrix;

/// Lines through the solid, about (a count). The error falls with its power −¾: below a thousandth
/// of the volume at this count, for milliseconds.
const LINES: f64 = 65_536.0;

/// Share of its trace by which the inertia tensor about parry's axes may differ from what was integrated.
const AXES: f64 = 5e-6;

/// Share of each principal moment by which parry's may differ: that of a rod about itself is far below its trace.
const MOMENTS: f64 = 2e-5;

/// Thinner matter than this (longest side 1, volume over area) is rounding.
const FLAT: f64 = 1e-9;

/// Mass properties at unit density in the user's frame and unit, and how they were found; none
/// where nothing is enclosed.
pub fn mass_properties(
    surface: &Surface,
    watch: &mut Watch,
) -> Result<(Option<MassProperties>, MassSource), BuildError> {
    let in_builder_frame = if surface.simple {
        exact(surface)
    } else {
        along_lines(surface, watch)?
    };
    let mass = in_builder_frame.and_then(|m| in_user_unit(m, &surface.frame));
    let source = match mass {
        None => MassSource::MedialMesh,
        Some(_) if surface.simple => MassSource::Surface,
        Some(_) => MassSource::Lines,
    };
    Ok((mass, source))
}

/// Mass scales with the third power of the length, inertia with the fifth.
fn in_user_unit(mut mass: MassProperties, frame: &BuilderFrame) -> Option<MassProperties> {
    let scale = frame.scale;
    mass.local_com = (Point::from_vector(mass.local_com) * scale + frame.center).to_vector();
    mass.inv_mass = (f64::from(mass.inv_mass) / scale.powi(3)) as Real;
    let inverse = Point::from_vector(mass.inv_principal_inertia) * (1.0 / scale.powi(5));
    mass.inv_principal_inertia = inverse.to_vector();
    let usable = mass.local_com.is_finite()
        && mass.inv_mass.is_finite()
        && mass.inv_mass > 0.0
        && mass.inv_principal_inertia.is_finite();
    usable.then_some(mass)
}

fn solid_triangles(surface: &Surface) -> impl Iterator<Item = [u32; 3]> + '_ {
    let all = surface.triangles.iter().zip(&surface.sheet);
    all.filter(|t| !*t.1).map(|t| *t.0)
}

fn exact(surface: &Surface) -> Option<MassProperties> {
    let mut sums = Sums::default();
    for t in solid_triangles(surface) {
        sums.add_tetrahedron(t.map(|v| surface.vertices[v as usize]));
    }
    let along_axes = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)];
    let axes = along_axes.map(|(x, y, z)| Point::new(x, y, z));
    (sums.volume > FLAT * surface.area).then(|| sums.mass_properties(axes))?
}

/// Crossing of a line and a triangle.
struct LineCrossing {
    row: i32,
    column: i32,
    /// Place along the line.
    at: f64,
    /// Change of the winding number at the crossing.
    change: i32,
}

fn along_lines(surface: &Surface, watch: &mut Watch) -> Result<Option<MassProperties>, BuildError> {
    let axes = frame_of_lines();
    let turned = |v: u32| {
        let p = surface.vertices[v as usize];
        Point::new(axes[0].dot(p), axes[1].dot(p), axes[2].dot(p))
    };
    let shadow = |t: [u32; 3]| {
        let [a, b, c] = t.map(turned);
        0.5 * (b - a).cross(c - a).z.abs()
    };
    // A line that enters leaves again.
    let area = 0.5 * solid_triangles(surface).map(shadow).sum::<f64>();
    if area <= 0.0 {
        return Ok(None);
    }
    let spacing = (area / LINES).sqrt();
    let mut crossings = Vec::new();
    for (i, t) in solid_triangles(surface).enumerate() {
        watch.every(i)?;
        cross(t.map(turned), t, spacing, &mut crossings);
    }
    crossings.sort_unstable_by(|a, b| {
        let line = (a.row, a.column).cmp(&(b.row, b.column));
        line.then(a.at.total_cmp(&b.at))
    });
    let mut sums = Sums::default();
    let mut stretches: Vec<[f64; 2]> = Vec::new();
    for line in crossings.chunk_by(|a, b| (a.row, a.column) == (b.row, b.column)) {
        if line.iter().map(|c| c.change).sum::<i32>() == 0 {
            find_stretches(line, &mut stretches);
        }
        // A line that comes in or goes out through an opening takes its neighbour's stretches.
        let place = [line[0].column, line[0].row].map(|k| f64::from(k) * spacing);
        for &stretch in &stretches {
            sums.add(place, stretch, spacing * spacing);
        }
    }
    Ok(sums.mass_properties(axes))
}

fn find_stretches(line: &[LineCrossing], stretches: &mut Vec<[f64; 2]>) {
    stretches.clear();
    let (mut winding, mut start) = (0, 0.0);
    for crossing in line {
        let before = winding;
        winding += crossing.change;
        if before < 1 && winding >= 1 {
            start = crossing.at;
        } else if before >= 1 && winding < 1 {
            stretches.push([start, crossing.at]);
        }
    }
}

/// Adds the crossings of a triangle, given in the lines' frame; `t` orders its corners.
fn cross(corners: [Point; 3], t: [u32; 3], spacing: f64, crossings: &mut Vec<LineCrossing>) {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    if normal.z == 0.0 {
        return;
    }
    let (low, high) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
    let first = (low / spacing).ceil() as i32;
    let last = (high / spacing).floor() as i32;
    for row in first..=last {
        let y = f64::from(row) * spacing;
        let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            // Neighbours must find the same end on their common edge.
            let (i, j) = if t[i] < t[j] { (i, j) } else { (j, i) };
            let (p, q) = (corners[i], corners[j]);
            if (p.y <= y) != (q.y <= y) {
                let x = p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y));
                ends = [ends[0].min(x), ends[1].max(x)];
            }
        }
        let from = (ends[0] / spacing).ceil();
        let to = (ends[1] / spacing).ceil();
        let mut column = from;
        while column < to {
            let (dx, dy) = (column * spacing - a.x, y - a.y);
            crossings.push(LineCrossing {
                row,
                column: column as i32,
                at: a.z - (normal.x * dx + normal.y * dy) / normal.z,
                change: if normal.z < 0.0 { 1 } else { -1 },
            });
            column += 1.0;
        }
    }
}

/// Integrals of 1, of the coordinates, and of their products.
#[derive(Default)]
struct Sums {
    volume: f64,
    first: [f64; 3],
    second: [[f64; 3]; 3],
}

impl Sums {
    fn add(&mut self, [x, y]: [f64; 2], [a, b]: [f64; 2], weight: f64) {
        let length = (b - a) * weight;
        let z = 0.5 * (a + b);
        let p = [x, y, z];
        self.volume += length;
        for i in 0..3 {
            self.first[i] += length * p[i];
            for j in 0..3 {
                self.second[i][j] += length * p[i] * p[j];
            }
        }
        self.second[2][2] += length * (b - a) * (b - a) / 12.0;
    }

    /// Adds a tetrahedron whose fourth corner is the origin; negative where the origin is in front of the triangle.
    fn add_tetrahedron(&mut self, corners: [Point; 3]) {
        let [a, b, c] = corners;
        let volume = a.dot(b.cross(c)) / 6.0;
        let corners = corners.map(|p| [p.x, p.y, p.z]);
        let sum = |i: usize| corners.iter().map(|p| p[i]).sum::<f64>();
        self.volume += volume;
        for i in 0..3 {
            self.first[i] += volume * sum(i) / 4.0;
            for j in 0..3 {
                let products: f64 = corners.iter().map(|p| p[i] * p[j]).sum();
                self.second[i][j] += volume * (products + sum(i) * sum(j)) / 20.0;
            }
        }
    }

    fn mass_properties(&self, axes: [Point; 3]) -> Option<MassProperties> {
        if self.volume <= 0.0 {
            return None;
        }
        let mean = self.first.map(|m| m / self.volume);
        // About the centre, in the lines' frame, then turned into the builder's.
        let covariance = |i: usize, j: usize| self.second[i][j] - self.volume * mean[i] * mean[j];
        let center = axes[0] * mean[0] + axes[1] * mean[1] + axes[2] * mean[2];
        let axes = Matrix3::from_fn(|r, i| [axes[i].x, axes[i].y, axes[i].z][r]);
        let covariance = axes * Matrix3::from_fn(covariance) * axes.transpose();
        let exact = of_covariance(center, self.volume, covariance);
        Some(in_parrys_axes(&exact, covariance).unwrap_or(exact))
    }
}

/// The same mass properties about the axes that parry finds, if these are right: a body that has them moves as one
/// whose inertia parry computed, bit by bit. It finds them in single precision, and of thin bodies takes those of the
/// frame.
fn in_parrys_axes(exact: &MassProperties, covariance: Matrix3<f64>) -> Option<MassProperties> {
    let tensor = Matrix3::identity() * covariance.trace() - covariance;
    let column = |s: usize| [0, 1, 2].map(|r| tensor[(r, s)] as Real).into();
    let columns = Matrix::from_cols(column(0), column(1), column(2));
    let found = MassProperties::with_inertia_matrix(exact.local_com, exact.mass(), columns);
    let again = found.reconstruct_inertia_matrix();
    let off = |k: usize| (f64::from(again.col(k % 3)[k / 3]) - tensor[(k / 3, k % 3)]).abs();
    let principal = |of: &MassProperties| {
        let mut moments = of.principal_inertia().to_array().map(f64::from);
        moments.sort_by(f64::total_cmp);
        moments
    };
    let mut moments = principal(&found).into_iter().zip(principal(exact));
    let is_right = (0..9).all(|k| off(k) <= AXES * tensor.trace())
        && moments.all(|(found, exact)| (found - exact).abs() <= MOMENTS * exact);
    is_right.then_some(found)
}

/// An orthonormal frame whose axes have incommensurable components; the lines run along the third.
fn frame_of_lines() -> [Point; 3] {
    let unit = |v: Point| v * (1.0 / v.length());
    let along = unit(Point::new(1.0, 2f64.sqrt(), 3f64.sqrt()));
    let x = unit(along.cross(Point::new(7f64.sqrt(), 1.0, 5f64.sqrt())));
    [x, along.cross(x), along]
}
