//! Gears and threads: meshes made in code have the volume of their formula, and their medial meshes cover them and
//! bulge out by no more than is reported, by points that the builder has not seen.

use crate::broken::volume;
use crate::machine::{gear, nut, threaded_rod};
use crate::meshes::*;
use crate::oracle::{Random, inside};
use crate::planted::uncovered;
use parry3d::query::PointQuery;
use parry3d::shape::TriMesh;
use rapier3d_medial::{BuildOptions, BuildReport, MedialMesh};
use std::f32::consts::{PI, TAU};

/// Depth of an ISO thread of pitch 1.
const DEPTH: f32 = 0.541_27;

fn built(mesh: &Mesh, primitives: usize) -> (MedialMesh, BuildReport) {
    let options = BuildOptions {
        primitives: Some(primitives),
        ..Default::default()
    };
    MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options).expect("a part builds")
}

/// Volume within a thread of crest radius 1: an eighth of each pitch is crest, a quarter root, and the rest flanks.
fn volume_in_thread(pitch: f32, turns: u32, around: u32) -> f32 {
    let root = 1.0 - DEPTH * pitch;
    let squares = 0.125 + 0.25 * root * root + 0.625 * (1.0 + root + root * root) / 3.0;
    let step = TAU / around as f32;
    PI * squares * pitch * turns as f32 * step.sin() / step
}

#[test]
fn parts_have_the_volume_of_their_formula() {
    let closed = |name: &str, mesh: &Mesh, wanted: f32, within: f32| {
        let off = volume(mesh) / wanted - 1.0;
        assert!(off.abs() < within, "{name}: {off}");
        let mut edges = std::collections::HashSet::new();
        for &[a, b, c] in &mesh.indices {
            assert!(
                [[a, b], [b, c], [c, a]]
                    .into_iter()
                    .all(|e| edges.insert(e)),
                "{name}"
            );
        }
        assert!(
            edges.iter().all(|&[a, b]| edges.contains(&[b, a])),
            "{name} is open"
        );
    };
    let (pitch, turns, around) = (0.3, 4, 48);
    let thread = volume_in_thread(pitch, turns, around);
    closed("rod", &threaded_rod(pitch, turns, around), thread, 5e-3);
    let hexagon = 2.0 * 3f32.sqrt() * 1.5 * 1.5 * pitch * turns as f32;
    closed(
        "nut",
        &nut(1.5, pitch, turns, around),
        hexagon - thread,
        5e-3,
    );
    // Teeth and gaps are equally wide at the pitch radius 1; the gaps are a quarter of a module deeper.
    let (teeth, bore, thickness) = (16u32, 0.3f32, 0.4f32);
    let module = 2.0 / teeth as f32;
    let ring = PI * (1.0 - bore * bore) - 0.25 * module * PI;
    closed(
        "gear",
        &gear(teeth, bore, thickness),
        ring * thickness,
        0.05,
    );
}

/// Points before the faces, farther from all of the source than the error, lie outside the solid.
fn assert_no_bloat(name: &str, mesh: &Mesh, medial: &MedialMesh, error: f32) {
    let source = TriMesh::new(mesh.vertices.clone(), mesh.indices.clone()).expect("a mesh");
    let mut random = Random(11);
    let mut tried = 0;
    for _ in 0..1_500 {
        let t = mesh.indices[random.bits() as usize % mesh.indices.len()];
        let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
        let [u, v] = [0, 1].map(|_| random.within(0.0, 1.0) as f32);
        let (u, v) = if u + v > 1.0 {
            (1.0 - u, 1.0 - v)
        } else {
            (u, v)
        };
        let normal = (b - a).cross(c - a).normalize();
        let p = a + (b - a) * u + (c - a) * v + normal * (1.2 * error);
        if source.distance_to_local_point(p, false) > 1.1 * error {
            tried += 1;
            let at = [p.x, p.y, p.z].map(f64::from);
            assert!(!inside(medial, at), "{name}: bloated at {p:?}");
        }
    }
    assert!(tried > 500, "{name}: {tried} points");
}

/// The medial mesh of a part has at most so many primitives, covers it, and is off by at most `most` (longest side 1),
/// by the report and at points of its own.
fn assert_near(name: &str, mesh: &Mesh, primitives: usize, most: f32) {
    let (medial, report) = built(mesh, primitives);
    let error = report.hausdorff.error();
    let share = error / report.longest_side;
    println!("{name}: {share} {:?}", report.variant);
    assert!(
        report.primitives <= primitives,
        "{name}: {}",
        report.primitives
    );
    assert!(share < most, "{name}: {share}");
    let (points, out) = uncovered(&medial, mesh, report.longest_side, 4e-6);
    assert!(
        out == 0 && points > 100,
        "{name}: {out} of {points} uncovered"
    );
    assert_no_bloat(name, mesh, &medial, error);
}

#[test]
fn a_nut_keeps_its_thread() {
    assert_near("nut", &nut(1.6, 0.4, 2, 24), 200, 0.018);
}

#[test]
#[ignore = "half a minute: CI builds a nut"]
fn gears_and_rods_keep_their_teeth() {
    assert_near("gear", &gear(8, 0.3, 0.5), 100, 0.055);
    assert_near("rod", &threaded_rod(0.4, 3, 24), 200, 0.028);
}
