//! The boundary of the solid decides: what other parts hide counts for nothing, and is told.

use crate::broken::*;
use crate::combined::combined;
use crate::meshes::*;
use crate::oracle::Random;
use crate::planted::uncovered;
use parry3d::math::{Rotation, Vector};
use rapier3d_medial::meshing::Variant;
use rapier3d_medial::meshing::hausdorff::hausdorff;
use rapier3d_medial::{BuildOptions, BuildReport, MedialMesh, Quality};

fn built(mesh: &Mesh, primitives: usize, quality: Quality) -> (MedialMesh, BuildReport) {
    let options = BuildOptions {
        primitives: Some(primitives),
        quality,
        ..Default::default()
    };
    MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options).expect("built")
}

fn error(report: &BuildReport) -> f32 {
    report.hausdorff.error() / report.longest_side
}

fn area(mesh: &Mesh) -> f32 {
    let twice = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
        (b - a).cross(c - a).length()
    };
    0.5 * mesh.indices.iter().map(twice).sum::<f32>()
}

fn cube() -> Mesh {
    cuboid(Vector::ONE)
}

/// Of two cubes, one moved by (a, b, c), three faces of each lie in the other: a rectangle of each.
#[test]
fn report_tells_the_area_hidden_by_overlapping_boxes() {
    let (a, b, c) = (0.5, 0.25, 0.375f32);
    let both = cube().and(cube().map(|v| v + Vector::new(a, b, c)));
    let (_, report) = built(&both, 60, Quality::Fast);
    let rectangles = (1.0 - b) * (1.0 - c) + (1.0 - a) * (1.0 - c) + (1.0 - a) * (1.0 - b);
    let off = report.hidden_area / (2.0 * rectangles) - 1.0;
    assert!(off.abs() < 0.03, "{off}: {:?}", report.notes);
    assert_eq!(report.findings.patches_hidden, 0);
    assert!(
        report
            .notes
            .iter()
            .any(|n| n.contains("lies inside solid matter"))
    );
    let volume = 2.0 - (1.0 - a) * (1.0 - b) * (1.0 - c);
    assert!((report.hausdorff.uncovered).abs() < 1e-5);
    let (medial, _) = built(&both, 60, Quality::Fast);
    let mass = medial.mass_properties(1.0).mass();
    assert!((mass / volume - 1.0).abs() < 3e-3, "{mass} {volume}");
}

/// A part inside another changes nothing but what is told, and a copy of a body nothing at all.
#[test]
fn parts_inside_a_body_count_for_nothing() {
    let outer = capsule(0.6, 0.3, 24, 8);
    let inner = cuboid(Vector::new(0.2, 0.15, 0.1)).map(|v| v + Vector::new(0.02, 0.03, 0.1));
    let (_, alone) = built(&outer, 8, Quality::Fast);
    let (medial, report) = built(&outer.clone().and(inner.clone()), 8, Quality::Fast);
    assert_eq!(report.findings.patches_hidden, 1);
    assert_eq!(report.findings.triangles_hidden, 12);
    assert!((report.hidden_area / area(&inner) - 1.0).abs() < 1e-3);
    let ratio = error(&report) / error(&alone);
    assert!((0.7..1.4).contains(&ratio), "{ratio}");
    let mass = medial.mass_properties(1.0).mass();
    assert!((mass / volume(&outer) - 1.0).abs() < 3e-3, "{mass}");
    // Measured from outside, it is the same.
    let both = outer.clone().and(inner.clone());
    let again = hausdorff(&medial, &both.vertices, &both.indices).expect("measured");
    let again = again.error() / report.longest_side;
    assert!(
        (again / error(&report) - 1.0).abs() < 0.3,
        "{again} {}",
        error(&report)
    );
    for same in [repeat(outer.clone()), repeat_turned(outer.clone())] {
        let (_, report) = built(&same, 8, Quality::Fast);
        assert_eq!(report.hidden_area, 0.0);
        assert!((error(&report) / error(&alone) - 1.0).abs() < 1e-3);
    }
}

/// A box, turned and moved.
struct Turned {
    half: [f64; 3],
    turn: Rotation,
    middle: Vector,
}

impl Turned {
    fn random(random: &mut Random, straight: bool, far: f32) -> Self {
        let turn = Rotation::from_scaled_axis(random.vector(3.0));
        Self {
            half: [0; 3].map(|_| f64::from(random.within(0.1, 0.7) as f32)),
            turn: if straight { Rotation::IDENTITY } else { turn },
            middle: random.vector(f64::from(far)),
        }
    }

    fn mesh(&self) -> Mesh {
        let half = Vector::from_array(self.half.map(|x| x as f32));
        cuboid(2.0 * half).map(|v| self.turn * (v - half) + self.middle)
    }

    /// Depth of a point below the nearest side, in `f64`; negative outside.
    fn depth(&self, p: Vector) -> f64 {
        let off = [0, 1, 2].map(|k| f64::from(p[k]) - f64::from(self.middle[k]));
        let depths = [Vector::X, Vector::Y, Vector::Z].into_iter().zip(self.half);
        let depths = depths.map(|(axis, half)| {
            let axis = (self.turn * axis).to_array().map(f64::from);
            half - (0..3).map(|k| axis[k] * off[k]).sum::<f64>().abs()
        });
        depths.fold(f64::MAX, f64::min)
    }
}

/// Boxes that overlap: inside and outside are known from a point's depth in each.
#[test]
fn boxes_that_overlap_are_exact() {
    let mut random = Random(2211);
    let mut primitives = Vec::new();
    for case in 0..17 {
        let count = if case == 16 { 20 } else { 2 + case % 4 };
        let far = |k: usize| if k == 0 { 0.0 } else { 0.5 };
        let boxes: Vec<Turned> = (0..count)
            .map(|k| Turned::random(&mut random, case % 3 == 0, far(k)))
            .collect();
        let mesh = boxes.iter().map(Turned::mesh).reduce(Mesh::and);
        let mesh = mesh.expect("boxes");
        let (medial, report) = built(&mesh, 1_000, Quality::Fast);
        assert_eq!(report.variant, Variant::Exact, "case {case}: {report:?}");
        assert!(error(&report) <= 1e-5, "case {case}: {report:?}");
        primitives.push(report.primitives / count);
        let mut judged = [0; 2];
        for _ in 0..3_000 {
            let p = random.vector(1.4);
            let depths = boxes.iter().map(|b| b.depth(p));
            let depth = depths.fold(f64::MIN, f64::max);
            if depth.abs() < 4e-6 * f64::from(report.longest_side) {
                continue;
            }
            judged[usize::from(depth > 0.0)] += 1;
            let inside = crate::solid_distance(&medial, p) < 0.0;
            assert_eq!(inside, depth > 0.0, "case {case} at {p:?}: {depth}");
        }
        assert!(judged.iter().all(|n| *n > 20), "case {case}: {judged:?}");
    }
    println!("primitives a box {primitives:?}");
    assert!(primitives.iter().all(|n| *n <= 22), "{primitives:?}");
}

/// The same shape as one surface and as parts that overlap: a capsule of two that share half their length.
#[test]
fn parts_that_overlap_are_as_near_as_one() {
    let half = |z: f32| capsule(0.4, 0.2, 24, 8).map(move |v| v + Vector::new(0.0, 0.0, z));
    let (_, one) = built(&capsule(0.6, 0.2, 24, 8), 3, Quality::Balanced);
    let (_, two) = built(&half(0.2).and(half(-0.2)), 3, Quality::Balanced);
    let (one, two) = (error(&one), error(&two));
    assert!(two < 1.5 * one + 1e-3, "{two} as parts, {one} as one");
}

/// A fit mends what a plain collapse leaves, with sheets beside solids too.
#[test]
fn sheets_and_thin_matter_are_fitted() {
    let wings =
        card(8).map(|v| Vector::new(4.0 * v.x - 2.0, v.y - 0.5, 0.3 * (2.0 * v.x - 1.0).powi(2)));
    // The error of a fit to few primitives depends on chance: it is the mean of some counts.
    for (name, mesh, counts) in [
        (
            "a ball with wings",
            ball(0.8).and(wings),
            &[25, 40, 50, 60][..],
        ),
        ("a body with thin wings", winged(), &[60]),
    ] {
        let mut sums = [0.0; 2];
        for &primitives in counts {
            let (_, plain) = built(&mesh, primitives, Quality::Fast);
            let (medial, fitted) = built(&mesh, primitives, Quality::Balanced);
            sums[0] += error(&plain);
            sums[1] += error(&fitted);
            let (points, out) = uncovered(&medial, &mesh, fitted.longest_side, 4e-6);
            assert!(
                out == 0 && points > 100,
                "{name}: {out} of {points} uncovered"
            );
        }
        let [plain, fitted] = sums.map(|sum| sum / counts.len() as f32);
        assert!(
            fitted < 0.8 * plain,
            "{name}: {fitted} fitted, {plain} plain"
        );
    }
}

/// Small openings have lids: what lost triangles is as near as what did not.
#[test]
fn lost_triangles_change_little() {
    for (whole, primitives) in [
        (capsule(0.0, 1.0, 48, 20), 1),
        (capsule(0.8, 0.3, 24, 8), 6),
    ] {
        let torn = lose(whole.clone(), 3, 2);
        let (_, report) = built(&whole, primitives, Quality::Balanced);
        let (medial, damaged) = built(&torn, primitives, Quality::Balanced);
        assert!(damaged.findings.edges_open > 0 && damaged.findings.patches_mended == 1);
        let (own, other) = (error(&damaged), error(&report));
        assert!(own < 1.5 * other + 1e-3, "{own} torn, {other} whole");
        let mass = medial.mass_properties(1.0).mass();
        assert!((mass / volume(&whole) - 1.0).abs() < 0.01, "{mass}");
    }
}

/// 364 patches, most of them crumbs of a body that fell apart and lost pieces, beside an open sheet.
#[test]
fn a_mesh_in_hundreds_of_pieces_is_fitted() {
    let mesh = combined(56);
    let (medial, report) = built(&mesh, 60, Quality::Balanced);
    assert!(report.findings.patches > 300);
    assert!(error(&report) < 0.1, "{}", error(&report));
    let (points, out) = uncovered(
        &medial,
        &mesh,
        report.longest_side,
        report.longest_side * 1e-6,
    );
    assert!(out == 0 && points > 100, "{out} of {points} uncovered");
}

/// A closed surface whose vertices are anywhere: all of its triangles are inside it here and outside there. Cut into
/// pieces of .6 % of the size to tell them apart it is millions, each with thousands of triangles to look at; the
/// builder takes larger pieces, and says so.
#[test]
fn a_surface_of_noise_is_built() {
    let mut random = Random(7);
    let mut noise = torus(0.5, 0.2, 18, 8);
    noise.vertices.fill_with(|| random.vector(0.5));
    let (medial, report) = built(&noise, 100, Quality::Fast);
    assert!(report.findings.overlapping && report.findings.boundary_coarse);
    let said = report.notes.iter().any(|note| note.contains("tangled"));
    assert!(said, "{:?}", report.notes);
    let (points, out) = uncovered(&medial, &noise, report.longest_side, 1e-6);
    assert!(points > 20 && out == 0, "{out} of {points} uncovered");
    let (_, report) = built(&cube(), 100, Quality::Fast);
    assert!(!report.findings.boundary_coarse);
}

/// Each triangle of noise is about as long as the body, and a search for the nearest looks at many times as many boxes
/// as on a surface that is not tangled. The fit ends once it has looked at too many, says so, and covers the surface
/// nonetheless.
#[test]
fn a_fit_to_noise_ends() {
    let mut random = Random(7);
    let mut noise = torus(0.5, 0.2, 30, 12);
    noise.vertices.fill_with(|| random.vector(0.5));
    let (medial, report) = built(&noise, 5, Quality::Balanced);
    assert!(report.findings.boundary_coarse && report.findings.fit_cut_short);
    let said = report.notes.iter().any(|n| n.contains("fit was ended"));
    assert!(said, "{:?}", report.notes);
    let (points, out) = uncovered(&medial, &noise, report.longest_side, 1e-6);
    assert!(points > 20 && out == 0, "{out} of {points} uncovered");
    let (_, report) = built(&torus(0.5, 0.2, 30, 12), 5, Quality::Balanced);
    assert!(!report.findings.fit_cut_short);
}
