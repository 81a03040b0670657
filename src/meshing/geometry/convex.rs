//! Planes, and convex polyhedra cut by them.

use crate::meshing::geometry::bounds::{Point, direction, perpendicular};

/// The plane of a face: `normal · x = offset`.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// Outward unit normal.
    pub normal: Point,
    /// Distance from the origin along it.
    pub offset: f64,
}

impl Plane {
    /// Depth of a point below the plane.
    pub fn depth(&self, p: Point) -> f64 {
        self.offset - self.normal.dot(p)
    }
}

/// A flat face of a convex polyhedron.
#[derive(Clone)]
pub struct Face {
    /// Index of its plane.
    pub plane: u32,
    /// Corners of the face, in order around it.
    pub corners: Vec<Point>,
}

/// A convex polyhedron as its faces.
#[derive(Clone)]
pub struct Convex {
    pub faces: Vec<Face>,
}

impl Convex {
    /// The cube of corners `±half`, all faces of plane `plane`.
    pub fn cube(half: f64, plane: u32) -> Self {
        let side = |axis: usize, sign: f64| {
            let corner = |u: f64, v: f64| {
                let mut p = [0.0; 3];
                p[axis] = sign * half;
                p[(axis + 1) % 3] = u * half;
                p[(axis + 2) % 3] = v * half;
                Point::new(p[0], p[1], p[2])
            };
            let around = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            Face {
                plane,
                corners: around.map(|(u, v)| corner(u, v)).to_vec(),
            }
        };
        let sides = (0..3).flat_map(|axis| [side(axis, -1.0), side(axis, 1.0)]);
        Self {
            faces: sides.collect(),
        }
    }

    /// All corners, each once for every face that it is of.
    pub fn corners(&self) -> impl Iterator<Item = Point> + Clone + '_ {
        self.faces
            .iter()
            .flat_map(|face| face.corners.iter().copied())
    }

    /// A point inside.
    pub fn middle(&self) -> Point {
        let sum = self.corners().fold(Point::zero(), |sum, p| sum + p);
        sum * (1.0 / self.corners().count().max(1) as f64)
    }

    /// Volume (longest side 1).
    pub fn volume(&self) -> f64 {
        let middle = self.middle();
        let fans = self.faces.iter().flat_map(|face| {
            let from = face.corners[0] - middle;
            let fan = face.corners[1..].windows(2);
            fan.map(move |w| from.dot((w[0] - middle).cross(w[1] - middle)).abs())
        });
        fans.sum::<f64>() / 6.0
    }

    /// The parts below and above a plane, whose new face is of plane `index`; `None` for a part that has no thickness.
    /// Points within `on` of the plane are on it: planes through vertices that were rounded miss each other's corners
    /// by less.
    pub fn cut(&self, plane: &Plane, index: u32, on: f64) -> [Option<Self>; 2] {
        let depths = || self.corners().map(|p| plane.depth(p));
        [1.0, -1.0].map(|sign| {
            let reaches = |sign: f64| depths().any(|depth| sign * depth > on);
            match (reaches(sign), reaches(-sign)) {
                (false, _) => None,
                (true, false) => Some(self.clone()),
                (true, true) => self.side(plane, (index, on), sign),
            }
        })
    }

    /// The part where `sign` times the depth is positive.
    fn side(&self, plane: &Plane, (index, on): (u32, f64), sign: f64) -> Option<Self> {
        let height = |p: Point| off(sign * plane.depth(p), on);
        let mut faces = Vec::with_capacity(self.faces.len() + 1);
        let mut on_cut: Vec<Point> = Vec::new();
        for face in &self.faces {
            let (kept, crossings) = above(&face.corners, height);
            on_cut.extend(crossings);
            faces.extend(kept.map(|corners| Face {
                plane: face.plane,
                corners,
            }));
        }
        faces.push(Face {
            plane: index,
            corners: around(on_cut, plane.normal, on)?,
        });
        Some(Self { faces })
    }
}

/// The height, or 0 if it is within `on`.
fn off(height: f64, on: f64) -> f64 {
    if height.abs() <= on { 0.0 } else { height }
}

/// The parts of a convex polygon below and above a plane; `None` for one that is a point or an edge. Points within `on`
/// of the plane are on it. A polygon that lies on it is below.
pub fn cut_polygon(corners: &[Point], plane: &Plane, on: f64) -> [Option<Vec<Point>>; 2] {
    let height = |sign: f64| move |p: Point| off(sign * plane.depth(p), on);
    let is_above = |sign: f64| corners.iter().any(|p| height(sign)(*p) > 0.0);
    match [1.0, -1.0].map(is_above) {
        [true, true] => [1.0, -1.0].map(|sign| above(corners, height(sign)).0),
        [_, false] => [Some(corners.to_vec()), None],
        [false, true] => [None, Some(corners.to_vec())],
    }
}

/// The part of a convex polygon whose heights are not negative, if some are positive, and its corners of height 0.
fn above(
    corners: &[Point],
    height: impl Fn(Point) -> f64,
) -> (Option<Vec<Point>>, impl Iterator<Item = Point>) {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    let mut level = Vec::new();
    let mut is_above = false;
    for (i, &p) in corners.iter().enumerate() {
        let q = corners[(i + 1) % corners.len()];
        let (h, k) = (height(p), height(q));
        is_above |= h > 0.0;
        if h >= 0.0 {
            kept.push(p);
        }
        let crossing = (h * k < 0.0).then(|| p + (q - p) * (h / (h - k)));
        kept.extend(crossing);
        level.extend(crossing.or((h == 0.0).then_some(p)));
    }
    let is_polygon = is_above && kept.len() >= 3;
    (is_polygon.then_some(kept), level.into_iter())
}

/// Points of a convex polygon across `normal`, each once, in order; `None` for fewer than three. Points within `on` of
/// each other are one.
fn around(points: Vec<Point>, normal: Point, on: f64) -> Option<Vec<Point>> {
    let mut all: Vec<Point> = Vec::with_capacity(points.len());
    for p in points {
        if all.iter().all(|q| (p - *q).length() > on) {
            all.push(p);
        }
    }
    if all.len() < 3 {
        return None;
    }
    let middle = all.iter().fold(Point::zero(), |sum, p| sum + *p) * (1.0 / all.len() as f64);
    let u = perpendicular(direction(normal));
    let v = normal.cross(u);
    let angle = |p: &Point| (*p - middle).dot(v).atan2((*p - middle).dot(u));
    all.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(normal: Point, offset: f64) -> Plane {
        Plane { normal, offset }
    }

    #[test]
    fn a_cube_cut_in_eight_has_eight_eighths() {
        let mut parts = vec![Convex::cube(0.5, 9)];
        let axes = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)];
        for (i, (x, y, z)) in axes.into_iter().enumerate() {
            let cut = plane(Point::new(x, y, z), 0.1);
            let halves = parts.iter().flat_map(|p| p.cut(&cut, i as u32, 1e-6));
            parts = halves.flatten().collect();
        }
        let mut volumes: Vec<f64> = parts.iter().map(Convex::volume).collect();
        volumes.sort_by(f64::total_cmp);
        assert_eq!(volumes.len(), 8);
        assert!((volumes[0] - 0.4f64.powi(3)).abs() < 1e-12, "{volumes:?}");
        assert!((volumes.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_plane_that_touches_cuts_nothing_off() {
        let cube = Convex::cube(0.5, 9);
        let diagonal = direction(Point::new(1.0, 1.0, 0.0));
        let [below, above] = cube.cut(&plane(diagonal, 0.5f64.sqrt()), 0, 1e-6);
        assert!(below.is_some() && above.is_none());
        let [below, above] = cube.cut(&plane(diagonal, 0.0), 0, 1e-6);
        let volumes = [below, above].map(|p| p.map_or(0.0, |p| p.volume()));
        assert!(
            volumes.iter().all(|v| (v - 0.5).abs() < 1e-12),
            "{volumes:?}"
        );
    }
}
