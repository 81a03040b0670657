//! The picture of `medial compare`: the triangle mesh, its medial axis, every primitive in a colour of its own, the
//! surface of all with its error in red, the convex decomposition and the convex hull.

use crate::common::light::Facet;
use crate::common::mesh::Mesh;
use crate::common::render::{Camera, Image};
use crate::common::scene_strip::{View, rainbow};
use crate::common::strip::tile;
use crate::common::surfaces::surface;
use crate::compare::SIZE;
use crate::failure::Failure;
use rapier3d::parry::query::PointQuery as _;
use rapier3d::prelude::*;
use rapier3d_medial::{MedialMesh, MedialSphere};

/// Radius (m) at which the medial axis is drawn, of a mesh of [`SIZE`].
const LINE: Real = 0.006;
/// Side of the triangles (m) that surfaces are drawn with.
const SPACING: Real = SIZE / 100.0;
/// Direction from the middle of a body to the eye, of any length.
const TOWARDS_EYE: Vector = Vector::new(0.75, 1.03, 2.35);
/// Opening angle of the pictures (rad).
const FIELD_OF_VIEW: Real = 0.42;
/// Share of the picture that a body fills.
const FILLED: Real = 0.92;
/// Cosine of the angle between two triangles, 40°, from which on the edge between them is drawn sharp.
const CREASE: Real = 0.766;
/// Distances (m) from primitives that differ by less are the same.
const SAME: Real = SIZE / 500.0;
/// Colour of the triangle mesh.
const SLATE: Vector = Vector::new(0.35, 0.37, 0.42);
/// Colour of a surface that is where the mesh is.
const EXACT: Vector = Vector::new(0.80, 0.82, 0.85);
/// Colour of a surface that is as far off as any point.
const OFF: Vector = Vector::new(0.85, 0.06, 0.03);

/// Figures that are written into the picture.
pub struct Labels {
    /// Errors of medial mesh, decomposition and hull (longest side 1).
    pub errors: [f64; 3],
    /// How many hulls the decomposition has.
    pub hulls: usize,
}

/// Draws a mesh of [`SIZE`] about the origin, its medial mesh, its decomposition and its hull, in two rows.
pub fn draw(
    mesh: &Mesh,
    medial: &MedialMesh,
    [parts, hull]: [&SharedShape; 2],
    labels: Labels,
) -> Result<Image, Failure> {
    let off = labels
        .errors
        .map(|error| format!("{:.1} % OFF", 100.0 * error));
    let count = |count: usize, name: &str| match count {
        1 => format!("1 {name}"),
        _ => format!("{count} {name}S"),
    };
    let tiles = [
        (
            colored(mesh, SLATE),
            "TRIANGLE MESH".into(),
            count(mesh.indices.len(), "TRIANGLE"),
        ),
        (
            axis(medial)?,
            "ITS MEDIAL AXIS".into(),
            count(medial.spheres().len(), "SPHERE"),
        ),
        (
            primitives(medial),
            "MEDIAL MESH".into(),
            count(medial.primitive_count(), "PRIMITIVE"),
        ),
        (
            envelope(medial, mesh),
            "ITS SURFACE".into(),
            format!("RED: {}", off[0]),
        ),
        (
            pieces(parts),
            format!("DECOMPOSITION: {}", count(labels.hulls, "HULL")),
            off[1].clone(),
        ),
        (pieces(hull), "CONVEX HULL".into(), off[2].clone()),
    ];
    let (bounds, eye) = (mesh.bounds(), eye_from_middle(mesh));
    let drawn = tiles.map(|(seen, name, size)| picture(seen, bounds, eye, [&name, &size]));
    Ok(tile(&[drawn[..3].to_vec(), drawn[3..].to_vec()]))
}

/// Facets of a body whose box is `bounds`, put on the ground, under two lines of text; `eye` is where it is seen from,
/// from the body's middle.
fn picture(
    mut seen: Vec<Facet>,
    (low, high): (Vector, Vector),
    eye: Vector,
    lines: [&str; 2],
) -> Image {
    for facet in &mut seen {
        facet.corners = facet.corners.map(|p| p - Vector::Y * low.y);
    }
    let target = Vector::Y * (high.y - low.y) / 2.0;
    let view = View {
        camera: Camera {
            eye: target + eye,
            target,
            field_of_view: FIELD_OF_VIEW,
            shadows: 2.0,
        },
        tile: [300, 300],
        steps: &[],
        ghost: 0.0,
    };
    view.labelled(&seen, &lines)
}

/// Vector from the middle of a mesh about the origin to an eye that sees all its vertices.
fn eye_from_middle(mesh: &Mesh) -> Vector {
    let back = TOWARDS_EYE.normalize();
    let right = Vector::Y.cross(back).normalize();
    let up = back.cross(right);
    let slope = FILLED * (FIELD_OF_VIEW / 2.0).tan();
    let distances = mesh.vertices.iter().map(|v| {
        // Seen under `slope` at most, right or left, above or below.
        v.dot(back) + v.dot(right).abs().max(v.dot(up).abs()) / slope
    });
    back * distances.fold(0.0, Real::max)
}

/// The triangles of a mesh in one colour; edges sharper than [`CREASE`] stay sharp.
fn colored(mesh: &Mesh, color: Vector) -> Vec<Facet> {
    let normal = |&triangle: &[u32; 3]| {
        let [a, b, c] = mesh.corners(triangle);
        (b - a).cross(c - a)
    };
    let normals: Vec<Vector> = mesh.indices.iter().map(normal).collect();
    let mut at_vertex = vec![Vec::new(); mesh.vertices.len()];
    for (triangle, corners) in mesh.indices.iter().enumerate() {
        for &v in corners {
            at_vertex[v as usize].push(triangle);
        }
    }
    let smooth = |triangle: usize, v: u32| {
        let own = normals[triangle].normalize_or_zero();
        let around = at_vertex[v as usize].iter().map(|&t| normals[t]);
        let near = around.filter(|n| n.normalize_or_zero().dot(own) >= CREASE);
        match near.sum::<Vector>().normalize_or_zero() {
            Vector::ZERO => Vector::Y,
            normal => normal,
        }
    };
    let triangles = mesh.indices.iter().enumerate();
    triangles
        .map(|(number, &triangle)| Facet {
            corners: mesh.corners(triangle),
            normals: triangle.map(|v| smooth(number, v)),
            color,
        })
        .collect()
}

/// The spheres' centres and what joins them: the same mesh with thin spheres.
fn axis(medial: &MedialMesh) -> Result<Vec<Facet>, Failure> {
    let thin = |s: &MedialSphere| MedialSphere::new(s.center, LINE);
    let spheres = medial.spheres().iter().map(thin).collect();
    let thin = MedialMesh::new(spheres, medial.edges().to_vec(), medial.faces().to_vec())?;
    let (vertices, indices) = thin.envelope(LINE);
    Ok(colored(
        &Mesh { vertices, indices },
        Vector::new(0.70, 0.20, 0.12),
    ))
}

/// Every primitive in a colour of its own: each triangle of the surface of all has that of the first that is as near as
/// any. (Drawn one by one, primitives that share a part of their surface would show through each other in stripes.)
fn primitives(medial: &MedialMesh) -> Vec<Facet> {
    let (vertices, indices) = medial.envelope(SPACING);
    let boxes: Vec<_> = medial
        .primitives()
        .map(|p| (p.aabb().loosened(SAME), p))
        .collect();
    let mut seen = colored(&Mesh { vertices, indices }, EXACT);
    for facet in &mut seen {
        let center = facet.corners.iter().sum::<Vector>() / 3.0;
        let mut nearest = None;
        for (number, (around, primitive)) in boxes.iter().enumerate() {
            if around.contains_local_point(center) {
                let distance = primitive.signed_distance(center).distance;
                if nearest.is_none_or(|(least, _)| distance < least - SAME) {
                    nearest = Some((distance, number));
                }
            }
        }
        facet.color = nearest.map_or(EXACT, |(_, number)| hue(number));
    }
    seen
}

/// The surface of the medial mesh, the redder the further it is from the triangle mesh.
fn envelope(medial: &MedialMesh, source: &Mesh) -> Vec<Facet> {
    let (vertices, indices) = medial.envelope(SPACING);
    let source = source.to_parry();
    let distance = |p: &Vector| source.project_local_point(*p, false).point.distance(*p);
    let off: Vec<Real> = vertices.iter().map(distance).collect();
    let most = off.iter().copied().fold(Real::MIN_POSITIVE, Real::max);
    let mesh = Mesh { vertices, indices };
    let mut seen = colored(&mesh, EXACT);
    for (facet, triangle) in seen.iter_mut().zip(&mesh.indices) {
        let mean = triangle.iter().map(|&v| off[v as usize]).sum::<Real>() / 3.0;
        facet.color = EXACT.lerp(OFF, mean / most);
    }
    seen
}

/// Every part of a compound in a colour of its own.
fn pieces(shape: &SharedShape) -> Vec<Facet> {
    match shape.as_compound() {
        Some(parts) => parts
            .shapes()
            .iter()
            .enumerate()
            .flat_map(|(number, (_, part))| colored(&surface(&**part), hue(number)))
            .collect(),
        None => colored(&surface(&**shape), hue(0)),
    }
}

/// Colours that tell neighbours apart: golden steps round the rainbow.
fn hue(number: usize) -> Vector {
    rainbow((0.618_034 * number as Real).fract())
}
