//! Input that no medial mesh can be built from, or only with a remark.

use crate::meshes::*;
use crate::solid_distance;
use parry3d::math::Vector;
use rapier3d_medial::Quality;
use rapier3d_medial::{BuildError, BuildOptions, BuildReport, MedialMesh};

type Built = Result<(MedialMesh, BuildReport), BuildError>;

fn attempt(mesh: &Mesh) -> Built {
    let mut options = BuildOptions::default();
    options.quality = Quality::Fast;
    options.primitives = Some(30);
    // Enclosing an open or crowded surface is covered by the flat cards.
    options.enclose = mesh.indices.len() <= 4;
    MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options)
}

fn refusal(mesh: &Mesh) -> String {
    attempt(mesh).expect_err("refused").to_string()
}

fn unit_box() -> Mesh {
    cuboid(Vector::new(1.0, 0.7, 0.4))
}

/// Builds, is finite, and says something that contains `words`.
fn handled(mesh: &Mesh, words: &str) -> BuildReport {
    let (medial, report) = attempt(mesh).expect("handled");
    assert!(medial.primitive_count() <= 30);
    let said = report.notes.join("; ");
    assert!(said.contains(words), "{words:?} not in {said:?}");
    assert!(report.hausdorff.envelope_to_surface.is_finite());
    report
}

#[test]
fn no_triangles() {
    let mesh = Mesh {
        vertices: vec![Vector::ZERO; 5],
        indices: vec![],
    };
    assert!(matches!(
        attempt(&mesh),
        Err(BuildError::Empty { vertices: 5 })
    ));
}

#[test]
fn a_coordinate_that_is_not_finite() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut mesh = unit_box();
        mesh.vertices[3].y = bad;
        assert!(matches!(
            attempt(&mesh),
            Err(BuildError::NotFinite { index: 3, .. })
        ));
        assert!(refusal(&mesh).contains("vertex 3"), "{}", refusal(&mesh));
    }
}

#[test]
fn an_index_out_of_range() {
    let mut mesh = unit_box();
    mesh.indices[7][1] = 8;
    let said = refusal(&mesh);
    assert!(
        said.contains("triangle 7 names vertex 8, but there are 8"),
        "{said}"
    );
    mesh.indices[7][1] = u32::MAX;
    assert!(refusal(&mesh).contains("4294967295"));
}

#[test]
fn no_size() {
    let point = unit_box().map(|_| Vector::new(1.0, 2.0, 3.0));
    assert!(
        refusal(&point).contains("[1.0, 2.0, 3.0]"),
        "{}",
        refusal(&point)
    );
    let line = unit_box().map(|v| Vector::new(v.x, 2.0 * v.x, 0.0));
    assert!(matches!(attempt(&line), Err(BuildError::ZeroSize { .. })));
    assert!(
        refusal(&line).contains("none of 12 triangles"),
        "{}",
        refusal(&line)
    );
}

#[test]
fn sizes_beyond_the_scalar() {
    // Nothing sensible can come of these; they must end in a mesh or an error.
    for scale in [1e-42f32, 1e-30, 1e30, 3e38] {
        if let Ok((medial, _)) = attempt(&unit_box().map(|v| v * scale)) {
            assert!(
                medial.spheres().iter().all(|s| s.radius.is_finite()),
                "{scale}"
            );
        }
    }
}

#[test]
fn an_open_surface() {
    let mut mesh = refine(unit_box(), 3);
    mesh.indices
        .retain(|t| t.iter().any(|&v| mesh.vertices[v as usize].z < 0.4));
    let report = handled(&mesh, "open edges");
    assert!(report.hausdorff.surface_to_envelope < 0.2, "{report:?}");
}

#[test]
fn one_triangle_and_a_flat_card() {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
    ];
    let vertices: Vec<Vector> = corners.map(Vector::from).to_vec();
    let card = vec![[0, 1, 2], [1, 3, 2]];
    let two_sided = vec![[0, 1, 2], [1, 3, 2], [0, 2, 1], [1, 2, 3]];
    for indices in [vec![[0, 1, 2]], card, two_sided] {
        let report = handled(
            &Mesh {
                vertices: vertices.clone(),
                indices,
            },
            "sheets",
        );
        assert!(report.hausdorff.surface_to_envelope < 0.01, "{report:?}");
        assert!(report.hausdorff.envelope_to_surface < 0.01, "{report:?}");
    }
}

#[test]
fn a_crowded_edge() {
    // Two tetrahedra and a fin at a common edge.
    let mut mesh = unit_box();
    mesh.vertices.push(Vector::new(0.5, -0.5, 0.2));
    mesh.indices.push([0, 1, 8]);
    handled(&mesh, "non-manifold");
}

#[test]
fn repeated_and_collapsed_triangles() {
    let mut mesh = unit_box();
    mesh.indices.push(mesh.indices[0]);
    mesh.indices.push([2, 2, 5]);
    let report = handled(&mesh, "1 repeated triangle dropped");
    assert!(
        report
            .notes
            .iter()
            .any(|n| n.contains("1 triangle of fewer")),
        "{report:?}"
    );
    // The rest is the whole box: closed, with its own mass.
    let (medial, _) = attempt(&mesh).expect("handled");
    assert!((medial.mass_properties(1.0).mass() - 0.28).abs() < 1e-5);
}

#[test]
fn needles_close_the_surface() {
    // Vertex 8 lies on an edge of the box; a triangle without area joins it to that edge.
    let mut mesh = unit_box();
    let at = mesh
        .indices
        .iter()
        .position(|t| *t == [0, 1, 5])
        .expect("side of the box");
    mesh.vertices.push(Vector::new(0.5, 0.0, 0.0));
    mesh.indices.swap_remove(at);
    mesh.indices.extend([[0, 8, 5], [8, 1, 5], [0, 1, 8]]);
    let report = handled(&mesh, "1 triangle without area");
    assert!(
        !report.notes.iter().any(|n| n.contains("open")),
        "{report:?}"
    );
}

#[test]
fn a_surface_in_pieces_is_sewn() {
    // Each triangle with vertices of its own.
    let source = unit_box();
    let corners = source.indices.iter().flatten();
    let vertices: Vec<Vector> = corners.map(|&v| source.vertices[v as usize]).collect();
    let indices = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let report = handled(&Mesh { vertices, indices }, "28 vertices welded");
    assert!(
        !report.notes.iter().any(|n| n.contains("open")),
        "{report:?}"
    );
}

#[test]
fn triangles_that_face_the_wrong_way() {
    let mut mixed = unit_box();
    mixed
        .indices
        .iter_mut()
        .step_by(3)
        .for_each(|t| t.swap(0, 1));
    let (_, right) = attempt(&unit_box()).expect("built");
    for mesh in [unit_box().inside_out(), mixed] {
        let report = handled(&mesh, "turned to face outward");
        // A box is exact: what is left is rounding.
        let error = |r: &BuildReport| r.hausdorff.surface_to_envelope.max(1e-6);
        let ratio = error(&report) / error(&right);
        assert!((0.5..2.0).contains(&ratio), "{ratio}");
        let (medial, _) = attempt(&mesh).expect("handled");
        assert!(solid_distance(&medial, Vector::new(0.5, 0.35, 0.2)) < -0.15);
        assert!((medial.mass_properties(1.0).mass() - 0.28).abs() < 1e-5);
    }
}

#[test]
fn options_out_of_range() {
    let mesh = unit_box();
    let with = |primitives, max_error| {
        let mut options = BuildOptions::default();
        options.quality = Quality::Fast;
        options.primitives = primitives;
        options.max_error = max_error;
        MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options)
    };
    let said = with(Some(0), None).expect_err("no primitives").to_string();
    assert!(said.contains("`primitives` is 0"), "{said}");
    for bad in [0.0, -0.1, f32::NAN, f32::INFINITY] {
        let said = with(None, Some(bad)).expect_err("no error").to_string();
        assert!(said.contains("`max_error`"), "{said}");
    }
}
