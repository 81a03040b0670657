//! The checked mesh: refusals, derived edges, ownership, the sphere tree, exact solids.

use crate::oracle::{Random, random_mesh};
use proptest::prelude::*;
use rapier3d_medial::math::Vector;
use rapier3d_medial::medial::tree::NodeKind;
use rapier3d_medial::{MedialMesh, MedialPrimitive, MedialSphere, MeshError};
use std::collections::HashSet;

fn unit_spheres(count: usize) -> Vec<MedialSphere> {
    (0..count)
        .map(|i| MedialSphere::new(Vector::X * i as f32, 1.0))
        .collect()
}

/// The message that an input is refused with.
fn refusal(spheres: Vec<MedialSphere>, edges: Vec<[u32; 2]>, faces: Vec<[u32; 3]>) -> String {
    MedialMesh::new(spheres, edges, faces)
        .unwrap_err()
        .to_string()
}

#[test]
fn refusals_name_the_index_and_the_value() {
    let with = |index: usize, sphere: MedialSphere| {
        let mut spheres = unit_spheres(5);
        spheres[index] = sphere;
        refusal(spheres, vec![], vec![])
    };
    let nan = with(3, MedialSphere::new(Vector::new(0.0, f32::NAN, 2.0), 1.0));
    assert!(
        nan.contains("sphere 3") && nan.contains("[0.0, NaN, 2.0]"),
        "{nan}"
    );
    let infinite = with(4, MedialSphere::new(Vector::ZERO, f32::INFINITY));
    assert!(
        infinite.contains("sphere 4") && infinite.contains("radius inf"),
        "{infinite}"
    );
    let negative = with(2, MedialSphere::new(Vector::ZERO, -0.25));
    assert!(
        negative.contains("sphere 2") && negative.contains("-0.25"),
        "{negative}"
    );

    let cases = [
        (refusal(vec![], vec![], vec![]), "at least one sphere"),
        (
            refusal(unit_spheres(3), vec![[0, 1], [1, 3]], vec![]),
            "edge 1 names sphere 3, but there are 3 spheres",
        ),
        (
            refusal(unit_spheres(3), vec![], vec![[0, 1, 2], [2, u32::MAX, 1]]),
            "face 1 names sphere 4294967295, but there are 3 spheres",
        ),
        (
            refusal(unit_spheres(3), vec![[0, 1], [2, 2]], vec![]),
            "edge 1 names sphere 2 twice",
        ),
        (
            refusal(unit_spheres(3), vec![], vec![[1, 0, 1]]),
            "face 0 names sphere 1 twice",
        ),
        (
            refusal(
                vec![MedialSphere::new(Vector::Y, 0.0); 3],
                vec![[0, 1]],
                vec![],
            ),
            "all 3 spheres are the point [0.0, 1.0, 0.0] of radius 0",
        ),
    ];
    for (message, wanted) in cases {
        assert!(message.contains(wanted), "{message:?} lacks {wanted:?}");
    }
}

#[test]
fn edges_are_derived_and_doubles_dropped() {
    let faces = vec![[0, 1, 2], [2, 0, 1], [1, 3, 2]];
    let edges = vec![[4, 3], [3, 4], [2, 1]];
    let mesh = MedialMesh::new(unit_spheres(6), edges, faces).unwrap();
    assert_eq!(mesh.faces(), [[0, 1, 2], [1, 3, 2]]);
    let edges: HashSet<_> = mesh.edges().iter().copied().collect();
    assert_eq!(edges.len(), mesh.edges().len());
    let wanted = [[0, 1], [1, 2], [0, 2], [1, 3], [2, 3], [3, 4]];
    assert_eq!(edges, HashSet::from(wanted));
    let kinds: Vec<_> = mesh.primitives().map(|p| p.spheres().len()).collect();
    assert_eq!(
        kinds,
        [3, 3, 2, 1],
        "two slabs, the cone 3-4, the lone sphere 5"
    );
}

/// Every sphere and edge is owned by one primitive that has it.
#[test]
fn spheres_and_edges_have_one_owner() {
    for seed in 0..20 {
        let mesh = random_mesh(seed);
        let (mut spheres, mut edges) = (Vec::new(), Vec::new());
        for s in mesh.simplices() {
            for k in 0..s.len {
                if s.owns_vertex >> k & 1 == 1 {
                    spheres.push(s.vertices[k as usize]);
                }
                let end = s.vertices[(k as usize + 1) % 3];
                if s.len > 1 && s.owns_edge >> k & 1 == 1 {
                    let start = s.vertices[k as usize];
                    edges.push([start.min(end), start.max(end)]);
                }
            }
        }
        spheres.sort_unstable();
        assert_eq!(
            spheres,
            (0..mesh.spheres().len() as u32).collect::<Vec<_>>()
        );
        edges.sort_unstable();
        let mut wanted = mesh.edges().to_vec();
        wanted.sort_unstable();
        assert_eq!(edges, wanted);
    }
}

/// Checks in double precision that each node holds every sphere below it; the primitives found
/// below.
fn check_node(mesh: &MedialMesh, node: u32, above: &mut Vec<u32>, found: &mut Vec<u32>) {
    above.push(node);
    let nodes = mesh.tree().nodes();
    match nodes[node as usize].kind() {
        NodeKind::Nodes(left, right) => {
            check_node(mesh, left, above, found);
            check_node(mesh, right, above, found);
        }
        NodeKind::Primitive(primitive) => {
            found.push(primitive);
            for sphere in mesh.primitive(primitive as usize).spheres() {
                for &ancestor in above.iter() {
                    let n = nodes[ancestor as usize];
                    let d = (sphere.center.as_dvec3() - n.center.as_dvec3()).length();
                    let reach = d + f64::from(sphere.radius);
                    assert!(
                        reach <= f64::from(n.radius),
                        "node {ancestor}: {reach} > {}",
                        n.radius
                    );
                }
            }
        }
    }
    above.pop();
}

#[test]
fn tree_nodes_enclose_all_below_them() {
    for seed in 0..40 {
        let mesh = random_mesh(seed);
        let mut random = Random(seed);
        // Far from the origin the coordinates carry few digits of the shape.
        let shift = random.vector([0.0, 10.0, 1e4, 1e7][seed as usize % 4]);
        let scale = [1.0, 1e-6, 1e6][seed as usize % 3];
        let spheres = mesh
            .spheres()
            .iter()
            .map(|s| MedialSphere::new(s.center * scale + shift, s.radius * scale));
        let mesh = MedialMesh::new(
            spheres.collect(),
            mesh.edges().to_vec(),
            mesh.faces().to_vec(),
        )
        .unwrap();
        let mut found = Vec::new();
        check_node(&mesh, 0, &mut Vec::new(), &mut found);
        found.sort_unstable();
        assert_eq!(
            found,
            (0..mesh.primitive_count() as u32).collect::<Vec<_>>()
        );
    }
}

#[test]
fn exact_solids_are_what_they_say() {
    let capsule = MedialMesh::capsule(Vector::X, Vector::Y, 0.5).unwrap();
    assert!(matches!(capsule.primitive(0), MedialPrimitive::Cone(_)));
    let point = MedialMesh::capsule(Vector::X, Vector::X, 0.5).unwrap();
    assert!(matches!(point.primitive(0), MedialPrimitive::Sphere(s) if s.center == Vector::X));
    let torus = MedialMesh::torus(2.0, 0.5, 12).unwrap();
    assert_eq!((torus.spheres().len(), torus.primitive_count()), (12, 12));
    let aabb = torus.aabb();
    assert!((aabb.maxs - Vector::new(2.5, 0.5, 2.5)).length() < 1e-6);
    assert!((aabb.mins + Vector::new(2.5, 0.5, 2.5)).length() < 1e-6);
    for s in torus.spheres() {
        assert!((s.center.length() - 2.0).abs() < 1e-6 && s.center.y == 0.0);
    }
}

#[test]
fn exact_solids_refuse_what_is_no_size() {
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let refusals = [
            (MedialMesh::ball(bad), "radius"),
            (MedialMesh::capsule(Vector::X, Vector::Y, bad), "radius"),
            (MedialMesh::torus(bad, 0.5, 12), "major_radius"),
            (MedialMesh::torus(2.0, bad, 12), "minor_radius"),
        ];
        for (refused, name) in refusals {
            match refused {
                Err(MeshError::Parameter { what, value, .. }) => {
                    assert_eq!(what, name);
                    assert!(value == f64::from(bad) || bad.is_nan());
                }
                other => panic!("{bad}: {other:?}"),
            }
        }
    }
    for segments in [0, 1, 2, 4097, usize::MAX] {
        let refused = MedialMesh::torus(2.0, 0.5, segments);
        assert!(matches!(
            refused,
            Err(MeshError::Parameter {
                what: "segments",
                ..
            })
        ));
    }
    let far = MedialMesh::capsule(Vector::X * f32::INFINITY, Vector::Y, 1.0);
    assert!(matches!(far, Err(MeshError::NotFinite { index: 0, .. })));
}

proptest! {
    /// Any bits: refused, or a mesh all of whose answers are there.
    #[test]
    fn any_numbers_are_refused_or_served(
        numbers in prop::collection::vec((any::<[f32; 3]>(), any::<f32>()), 0..6),
        edges in prop::collection::vec(any::<[u8; 2]>(), 0..4),
        faces in prop::collection::vec(any::<[u8; 3]>(), 0..3),
        modulus in 1u32..8,
    ) {
        let spheres: Vec<_> = numbers
            .into_iter()
            .map(|(c, r)| MedialSphere::new(Vector::from_array(c), r.abs()))
            .collect();
        let edges = edges.iter().map(|e| e.map(|i| u32::from(i) % modulus)).collect();
        let faces = faces.iter().map(|f| f.map(|i| u32::from(i) % modulus)).collect();
        if let Ok(mesh) = MedialMesh::new(spheres, edges, faces) {
            prop_assert!(mesh.primitive_count() > 0);
            prop_assert!(!mesh.tree().nodes().is_empty());
            prop_assert!(mesh.volume().is_finite());
            prop_assert!(mesh.thickness() >= 0.0);
        }
    }
}
