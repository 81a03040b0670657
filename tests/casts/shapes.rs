//! The medial mesh that is cast, and every built-in shape, each about as large as the mesh.

use parry3d::math::{IVector, Pose, Rotation, Vector};
use parry3d::shape::{SharedShape, TriMeshBuilderError};
use parry3d::utils::Array2;
use rapier3d_medial::{MedialMesh, MedialSphere};

/// A ring of unequal spheres with two slabs on its rim, one of them with a sharp tip.
pub fn ring() -> MedialMesh {
    let mut spheres: Vec<MedialSphere> = (0..10)
        .map(|i| {
            let (sin, cos) = (i as f32 * std::f32::consts::TAU / 10.0).sin_cos();
            let radius = 0.12 + 0.06 * (i as f32 * 2.3).sin();
            MedialSphere::new(Vector::new(0.8 * cos, 0.1 * sin, 0.8 * sin), radius)
        })
        .collect();
    let mut edges: Vec<[u32; 2]> = (0..10).map(|i| [i, (i + 1) % 10]).collect();
    spheres.push(MedialSphere::new(Vector::new(1.3, 0.3, 0.2), 0.05));
    spheres.push(MedialSphere::new(Vector::new(-1.2, -0.4, -0.1), 0.0));
    edges.extend([[0, 10], [1, 10], [5, 11], [6, 11]]);
    MedialMesh::new(spheres, edges, vec![[0, 1, 10], [5, 6, 11]]).expect("a valid mesh")
}

fn corners() -> Vec<Vector> {
    [
        [0.9, 0.1, 0.0],
        [-0.7, 0.3, 0.2],
        [0.1, 0.9, -0.1],
        [0.0, -0.8, 0.3],
        [0.2, 0.1, 0.8],
        [-0.1, 0.0, -0.7],
        [0.6, 0.6, 0.4],
    ]
    .map(Vector::from)
    .to_vec()
}

fn octahedron() -> Result<SharedShape, TriMeshBuilderError> {
    let faces = vec![
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    SharedShape::trimesh(corners()[..6].to_vec(), faces)
}

/// Name, shape, and how far from its centre a cast aims so that about half of them hit.
pub fn every_shape() -> Vec<(&'static str, SharedShape, f64)> {
    let v = Vector::new;
    let triangle = [v(-0.8, 0.0, 0.3), v(0.9, 0.2, 0.0), v(0.0, -0.3, -0.9)];
    let [a, b, c] = triangle;
    let heights = (0..36).map(|i| 0.3 * (i as f32 * 1.7).sin()).collect();
    let voxels = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [-1, 0, 1], [0, -1, 0]];
    let voxels: Vec<IVector> = voxels.map(|[x, y, z]| IVector::new(x, y, z)).to_vec();
    let tilted = Pose::from_parts(v(-0.6, 0.2, 0.1), Rotation::from_rotation_x(0.7));
    let compound = SharedShape::compound(vec![
        (
            Pose::from_translation(v(0.6, 0.0, 0.0)),
            SharedShape::ball(0.3),
        ),
        (tilted, SharedShape::cylinder(0.4, 0.2)),
        (tilted, SharedShape::cuboid(0.2, 0.1, 0.5)),
        (
            Pose::from_translation(v(0.0, 0.5, 0.3)),
            SharedShape::round_cone(0.3, 0.2, 0.05),
        ),
    ]);
    let second = SharedShape::new(ring());
    vec![
        ("ball", SharedShape::ball(0.6), 1.8),
        ("capsule", SharedShape::capsule(a, b, 0.2), 1.8),
        ("segment", SharedShape::segment(a, b), 1.8),
        ("triangle", SharedShape::triangle(a, b, c), 1.8),
        (
            "round triangle",
            SharedShape::round_triangle(a, b, c, 0.1),
            1.8,
        ),
        ("cuboid", SharedShape::cuboid(0.7, 0.4, 0.3), 1.8),
        (
            "round cuboid",
            SharedShape::round_cuboid(0.6, 0.3, 0.2, 0.1),
            1.8,
        ),
        (
            "hull",
            SharedShape::convex_hull(&corners()).expect("a hull"),
            2.2,
        ),
        (
            "round hull",
            SharedShape::round_convex_hull(&corners(), 0.1).expect("a hull"),
            2.0,
        ),
        ("trimesh", octahedron().expect("a mesh"), 2.1),
        (
            "heightfield",
            SharedShape::heightfield(Array2::new(6, 6, heights), v(3.0, 1.0, 3.0)),
            3.5,
        ),
        ("polyline", SharedShape::polyline(corners(), None), 1.8),
        (
            "voxels",
            SharedShape::voxels(v(0.5, 0.4, 0.6), &voxels),
            1.8,
        ),
        ("compound", compound, 1.8),
        ("half-space", SharedShape::halfspace(Vector::Y), 5.0),
        ("cylinder", SharedShape::cylinder(0.6, 0.4), 1.8),
        (
            "round cylinder",
            SharedShape::round_cylinder(0.5, 0.3, 0.1),
            1.8,
        ),
        ("cone", SharedShape::cone(0.6, 0.5), 1.8),
        ("round cone", SharedShape::round_cone(0.5, 0.4, 0.1), 1.8),
        ("medial mesh", second, 1.8),
    ]
}
