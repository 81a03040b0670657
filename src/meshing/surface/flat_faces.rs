//! The flat faces of a body: its triangles, joined where they lie in one plane.

use crate::error::BuildError;
use crate::meshing::geometry::bounds::{Point, direction, perpendicular};
use crate::meshing::geometry::convex::Plane;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::watch::Watch;

/// Corners of a flat face may be off its plane by this (longest side 1): their rounding to `f32`, at a few
/// sizes from the origin.
pub const FLAT: f64 = 5e-7;

/// Tolerances of flat faces that are tried in order, in units of the body's [`rounding`]. With the second, vertices may
/// be off by a millionth of the size; with the third by a hundred-thousandth, as in a part of 5 cm that is written in
/// metres with six decimals.
pub const FLATNESS: [f64; 3] = [1.0, 4.0, 40.0];

/// The last tolerance of a body of several parts, with which vertices may be off by a 20,000th of the size, as in a
/// shelf of a metre that is written in metres with four decimals. A body of one part is nearer when fitted: where a
/// plate is that warped, five times as near; but of parts that touch a fit closes the cracks between them, and is
/// a hundred times as far off and more.
pub const FLATNESS_OF_PARTS: f64 = 200.0;

/// Distance from a plane up to which a point is on it, in units of the distance that corners of a flat face may have.
pub const ON: f64 = 2.0;

/// Distance (longest side 1) by which rounding to `f32` moves the source's vertices, which may be some sizes from its
/// origin or more.
pub fn rounding(surface: &Surface) -> f64 {
    let far = surface.frame.center.length() / surface.frame.scale;
    FLAT.max(0.5 * f64::from(f32::EPSILON) * far)
}

/// The faces of a body.
pub struct FlatFaces {
    /// Planes of the faces.
    pub planes: Vec<Plane>,
    /// The face of each of the body's triangles.
    pub face_of: Vec<(usize, u32)>,
}

/// A face under collection.
struct Face {
    /// Plane of the face by its largest triangle.
    first: Plane,
    middle: Point,
    /// The directions of that triangle's longest side and height, each over its length: the plane may be off by
    /// rounding at one end of either, so it may turn about a needle's length far more than across it.
    turns: [Point; 2],
    /// Sum of its triangles' normals times their areas, and of their middles times them.
    area: Point,
    moment: Point,
    weight: f64,
}

impl Face {
    /// The face of a triangle, to which none is added yet.
    fn begun([a, b, c]: [Point; 3], normal: Point, area: f64) -> Self {
        let middle = (a + b + c) * (1.0 / 3.0);
        let sides = [b - a, c - b, a - c].into_iter();
        let along = sides.fold(Point::zero(), |long, side| {
            if side.length() > long.length() {
                side
            } else {
                long
            }
        });
        let (length, height) = (along.length(), 2.0 * area / along.length());
        Self {
            first: Plane {
                normal,
                offset: normal.dot(middle),
            },
            middle,
            turns: [
                along * (1.0 / (length * length)),
                normal.cross(along) * (1.0 / (length * height)),
            ],
            area: Point::zero(),
            moment: Point::zero(),
            weight: 0.0,
        }
    }

    /// Whether a triangle lies on it to within `flat`.
    fn holds(&self, normal: Point, corners: &[Point; 3], flat: f64) -> bool {
        self.first.normal.dot(normal) > 0.0
            && corners.iter().all(|p| {
                let to = *p - self.middle;
                let turned = self.turns.map(|turn| to.dot(turn).abs());
                self.first.depth(*p).abs() <= flat * (1.0 + turned[0] + turned[1])
            })
    }

    fn add(&mut self, [a, b, c]: [Point; 3], normal: Point, area: f64) {
        let middle = (a + b + c) * (1.0 / 3.0);
        self.area = self.area + normal * area;
        self.moment = self.moment + middle * area;
        self.weight += area;
    }

    /// The mean plane of its triangles.
    fn plane(&self) -> Plane {
        let normal = direction(self.area);
        let offset = normal.dot(self.moment) / self.weight;
        Plane { normal, offset }
    }
}

/// The faces that the triangles `body` of a surface make; `None` where there are more than `most`, where a triangle is
/// off the plane of its face by more than `flat` (longest side 1), or where they bound no convex body.
pub fn convex_faces(
    surface: &Surface,
    body: Vec<usize>,
    flat: f64,
    most: usize,
    watch: &mut Watch,
) -> Result<Option<FlatFaces>, BuildError> {
    let Some(faces) = flat_faces(surface, body, flat, most, watch)? else {
        return Ok(None);
    };
    for (i, &(t, _)) in faces.face_of.iter().enumerate() {
        watch.every(i)?;
        for p in surface.corners(t) {
            if faces.planes.iter().any(|plane| plane.depth(p) < -flat) {
                return Ok(None);
            }
        }
    }
    Ok((faces.planes.len() >= 4).then_some(faces))
}

/// The faces that the triangles `body` of a surface make; `None` where there are more than `most`, or where a triangle
/// is off the plane of its face by more than `flat` (longest side 1).
pub fn flat_faces(
    surface: &Surface,
    mut body: Vec<usize>,
    flat: f64,
    most: usize,
    watch: &mut Watch,
) -> Result<Option<FlatFaces>, BuildError> {
    let area = |t: usize| {
        let [a, b, c] = surface.corners(t);
        0.5 * (b - a).cross(c - a).length()
    };
    // The plane of the largest is known best.
    body.sort_by(|&t, &u| area(u).total_cmp(&area(t)));
    let mut faces: Vec<Face> = Vec::new();
    let mut face_of = Vec::with_capacity(body.len());
    for (i, &t) in body.iter().enumerate() {
        watch.every(i)?;
        let corners = surface.corners(t);
        let normal = surface.normals[t];
        let is_on = |face: &Face| face.holds(normal, &corners, flat);
        let place = faces.iter().position(is_on).unwrap_or_else(|| {
            faces.push(Face::begun(corners, normal, area(t)));
            faces.len() - 1
        });
        if faces.len() > most {
            return Ok(None);
        }
        faces[place].add(corners, normal, area(t));
        face_of.push((t, place as u32));
    }
    let mut planes: Vec<Plane> = faces.iter().map(Face::plane).collect();
    let mut corners = vec![Vec::new(); planes.len()];
    for (i, &(t, own)) in face_of.iter().enumerate() {
        watch.every(i)?;
        corners[own as usize].extend(surface.corners(t));
    }
    for (plane, corners) in planes.iter_mut().zip(&corners) {
        let is_off = |plane: &Plane| corners.iter().any(|p| plane.depth(*p).abs() > flat);
        if is_off(plane) {
            *plane = through(corners, plane);
        }
        if is_off(plane) {
            return Ok(None);
        }
    }
    Ok(Some(FlatFaces { planes, face_of }))
}

/// The plane nearest to points by the squares of their distances, given one that is near. Normals of small triangles of
/// noisy vertices say little; corners that are far apart say more.
fn through(points: &[Point], near: &Plane) -> Plane {
    let middle = points.iter().fold(Point::zero(), |sum, p| sum + *p) * (1.0 / points.len() as f64);
    let u = perpendicular(near.normal);
    let v = near.normal.cross(u);
    // The plane `height = a x + b y` over the near one, about the middle.
    let (mut xx, mut xy, mut yy, mut xh, mut yh) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for p in points {
        let to = *p - middle;
        let (x, y, h) = (to.dot(u), to.dot(v), to.dot(near.normal));
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        (xh, yh) = (xh + x * h, yh + y * h);
    }
    let determinant = xx * yy - xy * xy;
    if determinant <= 0.0 {
        return *near;
    }
    let a = (xh * yy - yh * xy) / determinant;
    let b = (yh * xx - xh * xy) / determinant;
    let normal = direction(near.normal - u * a - v * b);
    Plane {
        normal,
        offset: normal.dot(middle),
    }
}
