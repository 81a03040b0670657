//! Bodies far thinner than long: their inertia by integrals over the mesh in double precision, and what a build says
//! of them.

use crate::build;
use crate::meshes::{Mesh, cuboid, prism, torus};
use crate::oracle::Random;
use nalgebra::{Matrix3, SymmetricEigen};
use parry3d::math::{Rotation, Vector};
use rapier3d_medial::meshing::MassSource;
use std::f32::consts::TAU;

/// Volume of the solid inside a closed mesh, and its inertia at density 1 about its centre: tetrahedra with a common
/// corner.
fn moments(mesh: &Mesh) -> (f64, Matrix3<f64>) {
    let (mut volume, mut first, mut second) = (0.0, [0.0; 3], [[0.0; 3]; 3]);
    let vertex = |v: u32| mesh.vertices[v as usize].to_array().map(f64::from);
    let origin = vertex(0);
    for t in &mesh.indices {
        let p = t.map(|v| {
            let at = vertex(v);
            [0, 1, 2].map(|i| at[i] - origin[i])
        });
        let minor = |i: usize, j: usize| p[1][i] * p[2][j] - p[1][j] * p[2][i];
        let sixth = (p[0][0] * minor(1, 2) + p[0][1] * minor(2, 0) + p[0][2] * minor(0, 1)) / 6.0;
        volume += sixth;
        let sum = [0, 1, 2].map(|i| p[0][i] + p[1][i] + p[2][i]);
        for i in 0..3 {
            first[i] += sixth * sum[i] / 4.0;
            for j in 0..3 {
                let products: f64 = p.iter().map(|p| p[i] * p[j]).sum();
                second[i][j] += sixth * (products + sum[i] * sum[j]) / 20.0;
            }
        }
    }
    let about = |i: usize, j: usize| second[i][j] - first[i] * first[j] / volume;
    let trace: f64 = (0..3).map(|i| about(i, i)).sum();
    let entry = |i: usize, j: usize| if i == j { trace } else { 0.0 } - about(i, j);
    (volume, Matrix3::from_fn(entry))
}

/// A regular prism of `sides` sides about the z axis.
fn disc(sides: u32, height: f32, radius: f32) -> Mesh {
    let corner = |k: u32| {
        let (sin, cos) = (TAU * k as f32 / sides as f32).sin_cos();
        (radius * cos, radius * sin)
    };
    let outline: Vec<_> = (0..sides).map(corner).collect();
    let fan: Vec<_> = (1..sides - 1).map(|k| [0, k, k + 1]).collect();
    prism(&outline, height, &fan)
}

/// A tetrahedron 1 m long whose top is `height` above its base.
fn tetrahedron(height: f32) -> Mesh {
    let corners = [
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [0.3, 0.8, 0.0],
        [0.4, 0.3, height],
    ];
    Mesh {
        vertices: corners.map(Vector::from_array).to_vec(),
        indices: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    }
}

/// A lens 1 m across and `thickness` thick in the middle, of triangles that all but lie in one plane.
fn lens(thickness: f32) -> Mesh {
    const RINGS: u32 = 10;
    const AROUND: u32 = 40;
    let point = |ring: u32, k: u32, side: f32| {
        let r = 0.5 * ring as f32 / RINGS as f32;
        let (sin, cos) = (TAU * k as f32 / AROUND as f32).sin_cos();
        Vector::new(
            r * cos,
            side * 0.5 * thickness * (1.0 - 4.0 * r * r),
            r * sin,
        )
    };
    let mut vertices = Vec::new();
    for side in [1.0, -1.0] {
        vertices.push(point(0, 0, side));
        for ring in 1..RINGS {
            vertices.extend((0..AROUND).map(|k| point(ring, k, side)));
        }
    }
    let half = vertices.len() as u32 / 2;
    vertices.extend((0..AROUND).map(|k| point(RINGS, k, 0.0)));
    let at = |side: u32, ring: u32, k: u32| match ring {
        0 => side * half,
        RINGS => 2 * half + k % AROUND,
        _ => side * half + 1 + (ring - 1) * AROUND + k % AROUND,
    };
    let mut indices = Vec::new();
    for side in 0..2 {
        for (ring, k) in (0..RINGS).flat_map(|ring| (0..AROUND).map(move |k| (ring, k))) {
            let [a, b] = [at(side, ring, k), at(side, ring, k + 1)];
            let [c, d] = [at(side, ring + 1, k), at(side, ring + 1, k + 1)];
            let mut new = vec![[a, d, c]];
            if a != b {
                new.push([a, b, d]);
            }
            if side == 1 {
                new.iter_mut().for_each(|t| t.swap(0, 1));
            }
            indices.extend(new);
        }
    }
    Mesh { vertices, indices }
}

/// The tensor itself, not only its principal values: of a thin body that is turned, axes taken for those of its frame
/// would make it spin about others.
#[test]
fn inertia_of_thin_bodies_is_that_of_their_meshes_however_they_are_turned() {
    let plate = |height: f32| cuboid(Vector::new(1.0, 0.6, height));
    let bodies = [
        ("disc", disc(64, 0.004, 0.5)),
        ("rod of 8 mm", disc(8, 1.0, 0.008)),
        ("rod of 5 mm", disc(8, 1.0, 0.005)),
        ("rod of 3 mm", disc(8, 1.0, 0.003)),
        ("rod of 1 mm", disc(8, 1.0, 0.001)),
        ("ring of 5 cm", torus(0.5, 0.05, 32, 8)),
        ("ring of 1 cm", torus(0.5, 0.01, 32, 8)),
        ("plate of 1 mm", plate(1e-3)),
        ("plate of 0.1 mm", plate(1e-4)),
        ("tetrahedron of 1 mm", tetrahedron(1e-3)),
        ("tetrahedron of 0.1 mm", tetrahedron(1e-4)),
        ("block", plate(0.3)),
    ];
    let mut random = Random(3);
    for (name, mesh) in bodies {
        for (n, scale) in [1.0, 1.0, 1e-3, 1e3].into_iter().enumerate() {
            let axis = [0, 1, 2].map(|_| random.within(-1.0, 1.0) as f32);
            let turn = match n {
                0 => Rotation::IDENTITY,
                _ => Rotation::from_scaled_axis(Vector::from_array(axis) * 2.0),
            };
            let turned = mesh.clone().map(|p| turn * p * scale);
            let (medial, _) = build(&turned, 40, false);
            let properties = medial.mass_properties(1.0);
            let own = properties.reconstruct_inertia_matrix();
            let (_, known) = moments(&turned);
            for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                let off = (f64::from(own.col(j)[i]) - known[(i, j)]).abs() / known.trace();
                assert!(off < 1e-5, "{name} at {scale}: [{i}][{j}] is off by {off}");
            }
            // The least of a rod is some millionths of the others.
            let mut principal = properties.principal_inertia().to_array().map(f64::from);
            let mut eigenvalues: [f64; 3] = SymmetricEigen::new(known).eigenvalues.into();
            principal.sort_by(f64::total_cmp);
            eigenvalues.sort_by(f64::total_cmp);
            for (own, known) in principal.into_iter().zip(eigenvalues) {
                let off = (own / known - 1.0).abs();
                assert!(off < 1e-4, "{name} at {scale}: {own}, and not {known}");
            }
        }
    }
}

/// Behind a point beside its sharp rim there is less matter than the distance at which winding numbers are asked for.
#[test]
fn flat_tetrahedra_are_not_said_to_overlap() {
    for height in [1e-2, 1e-3, 3e-4, 1e-4] {
        let (_, report) = build(&tetrahedron(height), 40, true);
        assert!(!report.findings.overlapping, "{height}");
        assert_eq!(report.findings.mass, MassSource::Surface, "{height}");
    }
}

/// Those below 7e-5 are thinner than corners may be off the planes of faces, so that no convex piece is left of them.
#[test]
fn lenses_without_thickness_are_built() {
    for thickness in [1e-4, 7e-5, 5e-5, 1e-5, 1e-6] {
        let mesh = lens(thickness);
        let (medial, report) = build(&mesh, 60, true);
        assert!((1..=60).contains(&report.primitives), "{thickness}");
        // The rings of triangles are 0.05 wide: none is lost.
        let error = report.hausdorff.bound();
        assert!(error < 0.025, "{thickness}: off by {error}");
        // Thinner, both sides are welded to one sheet.
        if thickness >= 1e-5 {
            let (mass, known) = (medial.mass_properties(1.0).mass(), moments(&mesh).0);
            let off = f64::from(mass) / known - 1.0;
            assert!(off.abs() < 1e-3, "{thickness}: {mass}, and not {known}");
        }
    }
}
