//! What the fit promises, against solids of closed form and the slow oracle in double precision.

use crate::meshes::*;
use crate::oracle::{beyond_box, signed_distance};
use parry3d::math::Vector;
use rapier3d_medial::{BuildOptions, BuildReport, MedialMesh, MedialSphere, Quality};
use std::f64::consts::TAU;

fn built(
    mesh: &Mesh,
    quality: Quality,
    primitives: usize,
    enclose: bool,
) -> (MedialMesh, BuildReport) {
    let options = BuildOptions {
        primitives: Some(primitives),
        quality,
        enclose,
        ..Default::default()
    };
    MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options)
        .expect("a planted mesh builds")
}

/// The spheres of each primitive.
fn solids(medial: &MedialMesh) -> Vec<Vec<MedialSphere>> {
    medial.primitives().map(|p| p.spheres().to_vec()).collect()
}

/// Whether `p`, moved by up to `margin`, lies in the union.
fn is_within(solids: &[Vec<MedialSphere>], p: [f64; 3], margin: f64) -> bool {
    let holds =
        |s: &Vec<MedialSphere>| !beyond_box(s, p, margin) && signed_distance(s, p) <= margin;
    solids.iter().any(holds)
}

/// A wavy ring with waves on them: thick and thin parts, no symmetry.
fn wavy_ring() -> Mesh {
    torus(0.5, 0.15, 64, 24).map(|v| {
        let angle = v.y.atan2(v.x);
        v * (1.0 + 0.08 * (5.0 * angle).sin() + 0.05 * (3.0 * angle + 9.0 * v.z).cos())
    })
}

fn error(report: &BuildReport) -> f32 {
    report.hausdorff.error() / report.longest_side
}

/// Three balls that overlap, as one mesh of three closed surfaces.
fn three_balls() -> Mesh {
    let ball =
        |x: f32, y: f32, r: f32| capsule(0.0, r, 24, 10).map(move |v| v + Vector::new(x, y, 0.0));
    ball(0.0, 0.0, 0.3)
        .and(ball(0.4, 0.1, 0.25))
        .and(ball(0.1, 0.45, 0.2))
}

/// 1,536 triangles, 27 primitives: the solid lies between the true ring and itself, offset by .0036 of
/// the longest side either way. (The mesh alone is up to .0029 inside the ring.)
#[test]
fn a_ring_of_27_primitives_follows_the_true_ring() {
    let (big, small) = (0.5, 0.12);
    let mesh = torus(big as f32, small as f32, 48, 16);
    let (medial, report) = built(&mesh, Quality::Balanced, 27, false);
    assert_eq!(mesh.indices.len(), 1536);
    assert!(report.primitives <= 27);
    assert_eq!(report.euler, 0, "the hole is kept");
    let solids = solids(&medial);
    let allowed = 0.0036 * 2.0 * (big + small);
    let mut wrong = 0;
    for i in 0..240 {
        for j in 0..48 {
            let (u, v) = (f64::from(i) / 240.0 * TAU, f64::from(j) / 48.0 * TAU);
            let at = |tube: f64| {
                let reach = big + tube * v.cos();
                [reach * u.cos(), reach * u.sin(), tube * v.sin()]
            };
            let covered = is_within(&solids, at(small - allowed), 0.0);
            let too_far = is_within(&solids, at(small + allowed), 0.0);
            wrong += usize::from(!covered || too_far);
        }
    }
    assert_eq!(wrong, 0, "of {} points", 240 * 48);
}

#[test]
fn a_capsule_is_a_cone_and_a_plate_is_covered_by_few() {
    let (half, radius) = (0.3f64, 0.2f64);
    let (medial, _) = built(&capsule(0.3, 0.2, 32, 12), Quality::Balanced, 1, false);
    let solids_of_capsule = solids(&medial);
    // The mesh lies up to 0.2 (1 − cos 5.6°) inside the capsule.
    let allowed = 0.002;
    for i in 0..64 {
        for j in 0..33 {
            let (u, v) = (
                f64::from(i) / 64.0 * TAU,
                f64::from(j) / 64.0 * TAU - 0.25 * TAU,
            );
            let at = |r: f64| {
                let z = r * v.sin() + if v < 0.0 { -half } else { half };
                [r * v.cos() * u.cos(), r * v.cos() * u.sin(), z]
            };
            assert!(is_within(&solids_of_capsule, at(radius - allowed), 0.0));
            assert!(!is_within(&solids_of_capsule, at(radius + allowed), 0.0));
        }
    }
    let size = Vector::new(1.0, 0.7, 0.1);
    let (medial, report) = built(&refine(cuboid(size), 2), Quality::Balanced, 40, true);
    assert_eq!(report.euler, 1, "a plate is a ball");
    let solids = solids(&medial);
    for p in cuboid(size).dense_points(0.05) {
        assert!(is_within(&solids, p.to_array().map(f64::from), 1e-6), "{p}");
    }
    // A ball that reaches into the plate's edges and corners leaves its faces by at most its radius.
    let error = error(&report);
    assert!(error < 0.05, "{error}");
}

#[test]
fn a_union_of_balls_is_covered_and_not_left() {
    let mesh = three_balls();
    let (medial, report) = built(&mesh, Quality::Balanced, 30, true);
    let solids = solids(&medial);
    let balls = [(0.0, 0.0, 0.3), (0.4, 0.1, 0.25), (0.1, 0.45, 0.2)];
    let truth = |p: [f64; 3]| {
        let to = |(x, y, r): (f64, f64, f64)| {
            ((p[0] - x).powi(2) + (p[1] - y).powi(2) + p[2] * p[2]).sqrt() - r
        };
        balls.into_iter().map(to).fold(f64::INFINITY, f64::min)
    };
    for p in mesh.dense_points(0.03) {
        assert!(is_within(&solids, p.to_array().map(f64::from), 1e-6), "{p}");
    }
    // What the solid holds is near the true union: by the error reported, and the mesh's own.
    let allowed = f64::from(report.hausdorff.bound()) + 0.005;
    for i in 0..20 * 20 * 20 {
        let unit = |k: i32| f64::from(k % 20) / 19.0;
        let p = [
            1.1 * unit(i) - 0.35,
            1.1 * unit(i / 20) - 0.35,
            0.8 * unit(i / 400) - 0.4,
        ];
        if truth(p) > allowed {
            assert!(!is_within(&solids, p, 0.0), "{p:?} is {} off", truth(p));
        }
    }
}

/// Counts that are round, from one of which to the next the builder promises it, up to where it tries
/// smaller ones in any case.
#[test]
fn neither_a_higher_quality_nor_more_primitives_are_worse() {
    let bar = capsule(0.4, 0.15, 16, 5).map(|v| Vector::new(v.x + v.z * v.z, v.y, v.z));
    let cases = [
        ("wavy ring", wavy_ring(), 0, [10, 50].as_slice()),
        ("bent bar", bar, 1, &[10, 100]),
        ("L", l_shape(), 1, &[10, 30]),
    ];
    for (name, mesh, euler, counts) in cases {
        let at = |quality, primitives| {
            let (_, report) = built(&mesh, quality, primitives, true);
            assert!(report.primitives <= primitives);
            assert_eq!(report.euler, euler, "{name} {quality:?} {primitives}");
            let better = report.notes.iter().any(|n| n.contains("fit better than"));
            assert!(!better || report.primitives < primitives, "{name}");
            error(&report)
        };
        let errors: Vec<f32> = counts.iter().map(|n| at(Quality::Balanced, *n)).collect();
        println!("{name}: {errors:?}");
        assert!(errors.is_sorted_by(|a, b| a >= b), "{name}: {errors:?}");
        let (fast, best) = (at(Quality::Fast, counts[0]), at(Quality::Best, counts[0]));
        assert!(
            best <= errors[0] && errors[0] <= fast,
            "{name}: {fast} {errors:?} {best}"
        );
        if name == "wavy ring" {
            assert!(
                errors[0] < 0.8 * fast,
                "the fit is worth its time: {fast} {}",
                errors[0]
            );
        }
    }
}

/// All plain collapses of a ring are alike from 50 primitives on: its error is that of its facets.
#[test]
fn a_round_body_is_not_fitted_to_larger_counts_than_it_needs() {
    let (_, report) = built(&torus(0.5, 0.12, 48, 16), Quality::Balanced, 500, true);
    let says = report.notes.iter().any(|n| n.starts_with("a round body"));
    assert!(says && report.primitives <= 200, "{:?}", report.notes);
    // The mesh is up to .0029 inside the true ring.
    assert!(error(&report) < 0.0034, "{}", error(&report));
}

/// The certificate after a fit, by points of every triangle; and what may stay uncovered is used.
#[test]
fn a_fitted_solid_covers_its_source_or_as_much_as_asked() {
    let mesh = wavy_ring();
    let side = f64::from(mesh.longest_side());
    let mut bloats = Vec::new();
    for allowed in [0.0, 0.02f32] {
        let options = BuildOptions {
            primitives: Some(10),
            allow_uncovered: allowed,
            ..Default::default()
        };
        let built = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options);
        let (medial, report) = built.expect("built");
        let margin = f64::from(allowed) * side + 1e-6;
        let solids = solids(&medial);
        let points: Vec<Vector> = mesh.dense_points(0.03).into_iter().step_by(3).collect();
        let out = points
            .iter()
            .filter(|p| !is_within(&solids, p.to_array().map(f64::from), margin));
        assert_eq!(out.count(), 0, "of {}", points.len());
        assert!(f64::from(report.hausdorff.uncovered) <= margin);
        bloats.push(report.hausdorff.bloat);
    }
    assert!(bloats[1] < bloats[0], "{bloats:?}");
}

#[cfg(feature = "parallel")]
#[test]
fn the_number_of_threads_does_not_matter() {
    let mesh = wavy_ring();
    let on = |threads: usize, primitives: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let (medial, report) = pool
            .expect("threads")
            .install(|| built(&mesh, Quality::Balanced, primitives, true));
        let bits =
            |s: &MedialSphere| [s.center.x, s.center.y, s.center.z, s.radius].map(f32::to_bits);
        let spheres: Vec<_> = medial.spheres().iter().map(bits).collect();
        let (edges, faces) = (medial.edges().to_vec(), medial.faces().to_vec());
        (spheres, edges, faces, report.hausdorff)
    };
    for primitives in [10, 200] {
        assert_eq!(on(1, primitives), on(2, primitives), "{primitives}");
    }
}
