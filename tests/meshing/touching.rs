//! Parts that touch in whole faces, as kits of boxes and voxels do: the faces between them are not of the solid.

use crate::meshes::Mesh;
use parry3d::math::{Pose, Vector};
use parry3d::query::{Ray, RayCast};
use parry3d::shape::Cuboid;
use rapier3d_medial::{BuildOptions, BuildReport, MedialMesh};

/// Half the side of a cell.
const HALF: f32 = 0.1;

/// Boxes of two by three by two half-cells, one for each place in a grid.
fn cells(places: &[[i32; 3]]) -> Mesh {
    let half = Vector::new(2.0, 3.0, 2.0) * HALF;
    let mut all = Mesh {
        vertices: vec![],
        indices: vec![],
    };
    for place in places {
        let (vertices, indices) = Cuboid::new(half).to_trimesh();
        let at = Vector::from(place.map(|k| k as f32)) * 2.0 * half;
        all = all.and(Mesh { vertices, indices }.map(|v| v + at));
    }
    all
}

fn build(mesh: &Mesh) -> (MedialMesh, BuildReport) {
    let built = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &BuildOptions::default());
    built.expect("a medial mesh")
}

fn grid([x, y, z]: [i32; 3]) -> Vec<[i32; 3]> {
    let column = |x| move |y| (0..z).map(move |z| [x, y, z]);
    let slice = move |x| (0..y).flat_map(column(x));
    (0..x).flat_map(slice).collect()
}

#[test]
fn cells_side_by_side_are_one_solid() {
    let without = |all: Vec<[i32; 3]>, gone: [i32; 3]| -> Vec<[i32; 3]> {
        all.into_iter().filter(|place| *place != gone).collect()
    };
    let kits = [
        ("2 × 2", grid([2, 1, 2])),
        ("2 × 2 upright", grid([2, 2, 1])),
        ("3 × 3 × 3", grid([3, 3, 3])),
        ("a corner", without(grid([2, 2, 2]), [1, 1, 1])),
        ("a frame", without(grid([3, 1, 3]), [1, 0, 1])),
    ];
    for (name, places) in kits {
        let mut mesh = cells(&places);
        for inside_out in [false, true] {
            if inside_out {
                mesh = mesh.inside_out();
            }
            let (medial, report) = build(&mesh);
            let error = report.hausdorff.error();
            let volume = 96.0 * HALF.powi(3) * places.len() as f32;
            let mass = medial.mass_properties(1.0).mass();
            println!("{name}: error {error}, mass {mass} of {volume}");
            assert!(report.findings.triangles_shared > 0, "{name}");
            assert!(error < 1.0e-5, "{name}: error {error}");
            assert!(
                (mass / volume - 1.0).abs() < 2.0e-3,
                "{name}: {mass} of {volume}"
            );
        }
    }
}

/// Both sides of a sheet are of the same corners too.
#[test]
fn a_sheet_with_two_sides_across_a_frame_stays() {
    let places: Vec<[i32; 3]> = grid([3, 1, 3])
        .into_iter()
        .filter(|p| *p != [1, 0, 1])
        .collect();
    let frame = cells(&places);
    let corner = |x: f32, z: f32| Vector::new(x, 1.5, z) * 2.0 * HALF;
    let sheet = Mesh {
        vertices: vec![
            corner(1.0, 1.0),
            corner(3.0, 1.0),
            corner(3.0, 3.0),
            corner(1.0, 3.0),
        ],
        indices: vec![[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]],
    };
    for (mesh, hit) in [(frame.clone(), false), (frame.and(sheet), true)] {
        let medial = build(&mesh).0;
        let from = Vector::new(0.41, 2.0, 0.37);
        let ray = Ray::new(from, Vector::NEG_Y);
        let hits = medial.intersects_ray(&Pose::IDENTITY, &ray, 5.0);
        assert_eq!(hits, hit);
    }
}
