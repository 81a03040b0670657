//! A small renderer for pictures of a scene on a ground plane: no GPU, no display.

use super::light::{Facet, Lights, for_each_pixel};
use rapier3d::prelude::{Real, Vector};

/// Samples along each side of a pixel.
const SAMPLES: usize = 3;
/// Colour where the ground fades out, and above.
const HORIZON: Vector = Vector::new(0.80, 0.85, 0.90);
const ZENITH: Vector = Vector::new(0.50, 0.64, 0.80);

/// An eye in the world, y up.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Where it is.
    pub eye: Vector,
    /// What it looks at: the middle of the picture.
    pub target: Vector,
    /// Vertical opening angle, in radians.
    pub field_of_view: Real,
    /// How far from the target shadows fall.
    pub shadows: Real,
}

/// A picture, rows from the top.
#[derive(Clone, Debug)]
pub struct Image {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green, blue.
    pub pixels: Vec<[u8; 3]>,
}

impl Camera {
    /// Right, up and forward: the axes of the picture.
    fn axes(&self) -> [Vector; 3] {
        let forward = (self.target - self.eye).normalize();
        let right = forward.cross(Vector::Y).normalize();
        [right, right.cross(forward), forward]
    }
}

/// Draws the facets, lit by sun and sky, on the ground y = 0.
pub fn render(camera: &Camera, facets: &[Facet], width: usize, height: usize) -> Image {
    let (columns, rows) = (width * SAMPLES, height * SAMPLES);
    let [right, up, forward] = camera.axes();
    let focal = rows as Real / 2.0 / (camera.field_of_view / 2.0).tan();
    let (middle_x, middle_y) = (columns as Real / 2.0, rows as Real / 2.0);

    // What each sample sees first: a facet and the weights of its corners.
    let mut depths = vec![Real::MAX; columns * rows];
    let mut seen = vec![None; columns * rows];
    for facet in facets {
        let from_eye = facet.corners.map(|p| p - camera.eye);
        let depth = from_eye.map(|v| v.dot(forward));
        if depth.iter().any(|d| *d < 0.05) {
            continue;
        }
        let xy = [0, 1, 2].map(|k| {
            let scale = focal / depth[k];
            [
                middle_x + from_eye[k].dot(right) * scale,
                middle_y - from_eye[k].dot(up) * scale,
            ]
        });
        for_each_pixel(xy, [columns, rows], |sample, weights| {
            // 1/depth is linear in the picture, depth is not.
            let shares = [0, 1, 2].map(|k| weights[k] / depth[k]);
            let depth = 1.0 / shares.iter().sum::<Real>();
            if depth < depths[sample] {
                depths[sample] = depth;
                seen[sample] = Some((facet, shares.map(|s| s * depth)));
            }
        });
    }

    let lights = Lights::new(facets, camera.target, camera.shadows);
    let color_of = |sample: usize| {
        if let Some((facet, weights)) = seen[sample] {
            let blend = |v: [Vector; 3]| (0..3).map(|k| v[k] * weights[k]).sum::<Vector>();
            let (point, normal) = (blend(facet.corners), blend(facet.normals).normalize());
            return facet.color * lights.at(point, normal);
        }
        let x = (sample % columns) as Real + 0.5 - middle_x;
        let y = middle_y - (sample / columns) as Real - 0.5;
        ground(
            camera,
            (right * x + up * y + forward * focal).normalize(),
            &lights,
        )
    };
    let mut image = Image::filled(width, height, [0; 3]);
    for (pixel, color) in image.pixels.iter_mut().enumerate() {
        let (x, y) = (pixel % width * SAMPLES, pixel / width * SAMPLES);
        let samples =
            (0..SAMPLES * SAMPLES).map(|k| color_of((y + k / SAMPLES) * columns + x + k % SAMPLES));
        let mean = samples.sum::<Vector>() / (SAMPLES * SAMPLES) as Real;
        *color = mean
            .to_array()
            .map(|c| (c.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0) as u8);
    }
    image
}

/// Colour of ground or sky along a direction from the eye.
fn ground(camera: &Camera, direction: Vector, lights: &Lights) -> Vector {
    let sky = HORIZON.lerp(ZENITH, direction.y.clamp(0.0, 1.0).powf(0.7));
    if direction.y >= -1.0e-3 {
        return sky;
    }
    let distance = -camera.eye.y / direction.y;
    let point = camera.eye + direction * distance;
    let odd_tile = (point.x.floor() + point.z.floor()).rem_euclid(2.0) > 0.5;
    let color = Vector::new(0.60, 0.59, 0.57) * if odd_tile { 0.88 } else { 1.0 };
    let haze = (distance / 40.0).min(1.0).powi(2);
    (color * lights.at(point, Vector::Y)).lerp(sky, haze)
}

impl Image {
    /// A picture of one colour.
    pub fn filled(width: usize, height: usize, color: [u8; 3]) -> Self {
        Self {
            width,
            height,
            pixels: vec![color; width * height],
        }
    }
}
