//! Light from afar with shadows: the sun as a few near directions (soft shadows), the sky as many
//! directions all round (ambient light that hollows get less of).

use super::mesh::Mesh;
use rapier3d::prelude::{Pose, Real, Vector};
use std::f32::consts::TAU;

/// A triangle of the scene: corners and their normals, in world space.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    /// Corners.
    pub corners: [Vector; 3],
    /// Unit normals at the corners.
    pub normals: [Vector; 3],
    /// Red, green, blue share of the light that it reflects.
    pub color: Vector,
}

/// All triangles of a mesh at a pose.
pub fn facets<'a>(
    mesh: &'a Mesh,
    pose: Pose,
    color: Vector,
) -> impl Iterator<Item = Facet> + use<'a> {
    let normals = mesh.normals();
    mesh.indices.iter().map(move |t| Facet {
        corners: mesh.corners(*t).map(|p| pose.transform_point(p)),
        normals: t.map(|i| pose.rotation * normals[i as usize]),
        color,
    })
}

/// Calls `visit` with index and barycentric coordinates of each pixel centre in a triangle. `xy`
/// are its corners in pixels; either orientation will do.
pub fn for_each_pixel(
    xy: [[Real; 2]; 3],
    [width, height]: [usize; 2],
    mut visit: impl FnMut(usize, [Real; 3]),
) {
    let [[ax, ay], [bx, by], [cx, cy]] = xy;
    let double_area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    if double_area == 0.0 || !double_area.is_finite() {
        return;
    }
    let span = |values: [Real; 3], limit: usize| {
        let [low, high] = [
            values.into_iter().fold(Real::MAX, Real::min),
            values.into_iter().fold(Real::MIN, Real::max),
        ];
        let first = (low - 0.5).ceil().clamp(0.0, limit as Real);
        let end = (high + 0.5).floor().clamp(0.0, limit as Real);
        first as usize..end as usize
    };
    for row in span([ay, by, cy], height) {
        for column in span([ax, bx, cx], width) {
            let (x, y) = (column as Real + 0.5, row as Real + 0.5);
            let u = ((bx - x) * (cy - y) - (by - y) * (cx - x)) / double_area;
            let v = ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / double_area;
            if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
                visit(row * width + column, [u, v, 1.0 - u - v]);
            }
        }
    }
}

/// A direction that light comes from, and what it reaches: an orthographic depth map.
struct Light {
    towards: Vector,
    color: Vector,
    right: Vector,
    up: Vector,
    size: usize,
    /// Metres of one texel.
    texel: Real,
    center: Vector,
    /// Height along `towards` of the first thing that the light meets.
    heights: Vec<Real>,
}

impl Light {
    fn new(towards: Vector, color: Vector, size: usize, center: Vector, radius: Real) -> Self {
        let (right, up) = towards.any_orthonormal_pair();
        Self {
            towards,
            color,
            right,
            up,
            size,
            texel: 2.0 * radius / size as Real,
            center,
            heights: vec![Real::MIN; size * size],
        }
    }

    /// Column, row (in texels) and height of a point.
    fn project(&self, p: Vector) -> [Real; 3] {
        let from_center = p - self.center;
        let half = self.size as Real / 2.0;
        [
            half + from_center.dot(self.right) / self.texel,
            half + from_center.dot(self.up) / self.texel,
            from_center.dot(self.towards),
        ]
    }

    fn shine_on(&mut self, facet: &Facet) {
        let projected = facet.corners.map(|p| self.project(p));
        let heights = &mut self.heights;
        let xy = projected.map(|[x, y, _]| [x, y]);
        for_each_pixel(xy, [self.size; 2], |texel, weights| {
            let height = (0..3).map(|k| weights[k] * projected[k][2]).sum();
            heights[texel] = heights[texel].max(height);
        });
    }

    fn reaches(&self, p: Vector) -> bool {
        let [x, y, height] = self.project(p);
        let limit = self.size as Real;
        let on_map = (0.0..limit).contains(&x) && (0.0..limit).contains(&y);
        !on_map || height >= self.heights[y as usize * self.size + x as usize]
    }
}

/// Sun and sky over a scene.
pub struct Lights(Vec<Light>);

impl Lights {
    /// Lights the facets. Shadows fall within `radius` of `center`.
    pub fn new(facets: &[Facet], center: Vector, radius: Real) -> Self {
        const SUN: (usize, usize) = (8, 1024);
        const SKY: (usize, usize) = (40, 512);
        let sun = Vector::new(0.45, 0.80, 0.40).normalize();
        let (sun_right, sun_up) = sun.any_orthonormal_pair();
        let golden = |k: usize| (TAU * 0.618_034 * k as Real).sin_cos();
        let suns = (0..SUN.0).map(|k| {
            let (sin, cos) = golden(k);
            let off = 0.03 * (k as Real / SUN.0 as Real).sqrt();
            let towards = (sun + (sun_right * cos + sun_up * sin) * off).normalize();
            let color = Vector::new(1.0, 0.94, 0.84) * (0.85 / SUN.0 as Real);
            Light::new(towards, color, SUN.1, center, radius)
        });
        let skies = (0..SKY.0).map(|k| {
            let (sin, cos) = golden(k);
            let y = (k as Real + 0.5) / SKY.0 as Real;
            let across = (1.0 - y * y).sqrt();
            let color = Vector::new(0.82, 0.92, 1.0) * (1.1 / SKY.0 as Real);
            let towards = Vector::new(across * cos, y, across * sin);
            Light::new(towards, color, SKY.1, center, radius)
        });
        let mut lights: Vec<Light> = suns.chain(skies).collect();
        for light in &mut lights {
            facets.iter().for_each(|facet| light.shine_on(facet));
        }
        Self(lights)
    }

    /// Light that a point of a surface gets, per colour; the ground throws some back from below.
    pub fn at(&self, p: Vector, normal: Vector) -> Vector {
        let bounce = Vector::splat(0.10 * (1.0 - normal.y) + 0.04);
        let direct = self.0.iter().map(|light| {
            let slant = normal.dot(light.towards);
            let lifted = p + normal * (2.0 * light.texel);
            if slant > 0.0 && light.reaches(lifted) {
                light.color * slant
            } else {
                Vector::ZERO
            }
        });
        bounce + direct.sum::<Vector>()
    }
}
