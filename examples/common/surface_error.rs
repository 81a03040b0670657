//! How far a medial mesh is from a triangle mesh, measured with parry's triangle meshes: nothing of
//! the builder's own measure is used.

use super::mesh::Mesh;
use rapier3d::parry::query::PointQuery;
use rapier3d::prelude::{Real, TriMesh, Vector};
use rapier3d_medial::MedialMesh;

/// Two-sided distance between two surfaces, sampled, in the unit of the meshes.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceError {
    /// Largest distance found from the source to the solid's boundary.
    pub surface_to_envelope: Real,
    /// Largest distance found from the solid's boundary to the source.
    pub envelope_to_surface: Real,
}

impl SurfaceError {
    /// The larger of the two.
    pub fn largest(&self) -> Real {
        self.surface_to_envelope.max(self.envelope_to_surface)
    }
}

/// Compares the boundary of `mesh`, drawn with triangles of `spacing`, with `source`: at all
/// vertices and at `points` more, spread evenly over each surface. `None` where the boundary is
/// empty.
pub fn surface_error(
    mesh: &MedialMesh,
    source: &Mesh,
    spacing: Real,
    points: usize,
) -> Option<SurfaceError> {
    let (vertices, indices) = mesh.envelope(spacing);
    let envelope = TriMesh::new(vertices, indices).ok()?;
    let source = source.to_parry();
    Some(SurfaceError {
        // Drawing loses strips between thousands of primitives that overlap. There the shape's own
        // projection, a point of the boundary as well, is nearer.
        surface_to_envelope: farthest(&source, &[&envelope, mesh], points),
        envelope_to_surface: farthest(&envelope, &[&source], points),
    })
}

/// The largest distance from points of a surface to the nearest of the points that `to` give, which lie
/// on the other.
fn farthest(from: &TriMesh, to: &[&dyn PointQuery], points: usize) -> Real {
    let vertices = from.vertices().iter().copied();
    let all = vertices.chain(spread_points(from, points));
    all.fold(0.0, |largest, p| {
        let mut distance = Real::INFINITY;
        for other in to {
            distance = distance.min(other.project_local_point(p, false).point.distance(p));
            if distance <= largest {
                break;
            }
        }
        largest.max(distance)
    })
}

/// About `count` points, as many on each triangle as its share of the area calls for. Within a
/// triangle they follow the R2 sequence, folded onto the triangle.
pub fn spread_points(surface: &TriMesh, count: usize) -> impl Iterator<Item = Vector> + '_ {
    // The reciprocals of the plastic number and of its square: the R2 sequence's steps.
    const STEPS: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053];
    let area: f64 = surface.triangles().map(|t| f64::from(t.area())).sum();
    let density = count as f64 / area.max(f64::MIN_POSITIVE);
    let mut owed = 0.0;
    let mut number = 0u32;
    surface.triangles().flat_map(move |t| {
        owed += f64::from(t.area()) * density;
        let here = owed as u32;
        owed -= f64::from(here);
        let first = number;
        number += here;
        (first..number).map(move |k| {
            let [u, v] = STEPS.map(|step| (0.5 + step * f64::from(k)).fract() as Real);
            let [u, v] = if u + v > 1.0 {
                [1.0 - u, 1.0 - v]
            } else {
                [u, v]
            };
            t.a + (t.b - t.a) * u + (t.c - t.a) * v
        })
    })
}
