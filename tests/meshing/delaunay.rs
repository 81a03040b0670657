//! The triangulation against its definition, by exact predicates called from here.

use rapier3d_medial::meshing::delaunay::{Delaunay, NONE};
use robust::{Coord3D, insphere, orient3d};
use std::collections::HashMap;

fn exact(p: [f64; 3]) -> Coord3D<f64> {
    let [x, y, z] = p;
    Coord3D { x, y, z }
}

/// SplitMix64, so that the points are the same everywhere.
fn random(count: usize, seed: u64) -> Vec<[f64; 3]> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..count).map(|_| [next(), next(), next()]).collect()
}

fn cube_grid(n: usize) -> Vec<[f64; 3]> {
    let at = |i: usize| [i % n, i / n % n, i / (n * n)].map(|k| k as f64);
    (0..n * n * n).map(at).collect()
}

fn torus_grid(around: usize, across: usize) -> Vec<[f64; 3]> {
    (0..around * across)
        .map(|k| {
            let u = (k / across) as f64 / around as f64 * std::f64::consts::TAU;
            let v = (k % across) as f64 / across as f64 * std::f64::consts::TAU;
            let from_axis = 1.0 + 0.25 * v.cos();
            [from_axis * u.cos(), from_axis * u.sin(), 0.25 * v.sin()]
        })
        .collect()
}

/// Points of the integer sphere x² + y² + z² = 9·25: exactly cospherical.
fn cospherical() -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    for x in -15i32..=15 {
        for y in -15..=15 {
            for z in -15..=15 {
                if x * x + y * y + z * z == 225 {
                    points.push([x, y, z].map(f64::from));
                }
            }
        }
    }
    points
}

/// Checks orientation, empty circumspheres against all points, and that neighbours name each other
/// across the same face. Returns six times the volume.
fn check(points: &[[f64; 3]], delaunay: &Delaunay) -> f64 {
    let mut volume = 0.0;
    for (t, corners) in delaunay.tetrahedra.iter().enumerate() {
        let [a, b, c, d] = corners.map(|v| exact(points[v as usize]));
        let orientation = orient3d(a, b, c, d);
        assert!(orientation > 0.0, "tetrahedron {t} is flat or inverted");
        volume += orientation;
        for (i, &p) in points.iter().enumerate() {
            let inside = insphere(a, b, c, d, exact(p)) > 0.0;
            assert!(!inside, "point {i} is inside the sphere of tetrahedron {t}");
        }
    }
    let mut faces: HashMap<[u32; 3], Vec<(u32, u32)>> = HashMap::new();
    for (t, corners) in delaunay.tetrahedra.iter().enumerate() {
        for k in 0..4 {
            let mut face: Vec<u32> = corners.to_vec();
            face.remove(k);
            face.sort_unstable();
            let neighbor = delaunay.neighbors[t][k];
            let key = [face[0], face[1], face[2]];
            faces.entry(key).or_default().push((t as u32, neighbor));
        }
    }
    for (face, uses) in faces {
        match uses[..] {
            [(_, neighbor)] => assert_eq!(neighbor, NONE, "face {face:?}"),
            [(t, n), (u, m)] => assert_eq!((n, m), (u, t), "face {face:?}"),
            _ => panic!("face {face:?} has {} tetrahedra", uses.len()),
        }
    }
    volume
}

#[test]
fn random_points_have_empty_spheres() {
    for seed in 0..8 {
        let points = random(60 + 40 * seed as usize, seed);
        let delaunay = Delaunay::new(&points);
        let volume = check(&points, &delaunay) / 6.0;
        // The hull of n random points of the unit cube lacks little of it.
        assert!(volume > 0.5 && volume < 1.0, "volume {volume}");
    }
}

#[test]
fn cube_grids_are_filled() {
    for n in 2..=7 {
        let points = cube_grid(n);
        let volume = check(&points, &Delaunay::new(&points));
        let expected = 6.0 * ((n - 1) as f64).powi(3);
        assert_eq!(volume, expected, "grid of {n}");
    }
}

#[test]
fn cospherical_points_are_filled() {
    let points = cospherical();
    assert!(points.len() > 50, "{} points", points.len());
    let delaunay = Delaunay::new(&points);
    // The hull is made by all points: each is a corner of some tetrahedron.
    let volume = check(&points, &delaunay) / 6.0;
    let ball = 4.0 / 3.0 * std::f64::consts::PI * 15f64.powi(3);
    assert!(
        volume > 0.8 * ball && volume < ball,
        "volume {volume} of {ball}"
    );
    let mut used = vec![false; points.len()];
    delaunay
        .tetrahedra
        .iter()
        .flatten()
        .for_each(|&v| used[v as usize] = true);
    assert!(used.iter().all(|u| *u));
}

#[test]
fn torus_grid_has_empty_spheres() {
    let points = torus_grid(40, 12);
    let delaunay = Delaunay::new(&points);
    check(&points, &delaunay);
    assert!(delaunay.tetrahedra.len() > points.len());
}

#[test]
fn repeated_points_change_nothing() {
    let points = random(100, 11);
    let mut doubled = points.clone();
    doubled.extend(points.iter().rev());
    let once = check(&points, &Delaunay::new(&points));
    let twice = check(&doubled, &Delaunay::new(&doubled));
    // The sum's order differs, and with it its rounding.
    assert!((once - twice).abs() < 1e-12 * once, "{once} {twice}");
}

#[test]
fn points_without_volume_have_no_tetrahedra() {
    let plane: Vec<[f64; 3]> = (0..100)
        .map(|i| [(i % 10) as f64, (i / 10) as f64, 2.0])
        .collect();
    let line: Vec<[f64; 3]> = (0..20).map(|i| [i as f64, 2.0 * i as f64, 0.0]).collect();
    for points in [vec![], vec![[1.0; 3]], vec![[1.0; 3]; 9], plane, line] {
        assert!(Delaunay::new(&points).tetrahedra.is_empty(), "{points:?}");
    }
}

#[test]
fn points_that_are_not_finite_are_left_out() {
    let mut points = cube_grid(3);
    points.push([f64::NAN, 0.0, 0.0]);
    points.push([0.0, f64::INFINITY, 0.0]);
    let delaunay = Delaunay::new(&points);
    assert!(delaunay.tetrahedra.iter().flatten().all(|&v| v < 27));
    assert_eq!(check(&points[..27], &delaunay), 48.0);
}
