//! The envelope: on the boundary, complete, converging to closed forms, and bounded.

use crate::oracle::{Random, beyond_box, inside, random_mesh, signed_distance};
use rapier3d_medial::math::Vector;
use rapier3d_medial::{MedialMesh, MedialSphere};
use std::collections::HashMap;
use std::f64::consts::PI;

type Surface = (Vec<Vector>, Vec<[u32; 3]>);

fn corners(surface: &Surface) -> impl Iterator<Item = [[f64; 3]; 3]> + '_ {
    let (vertices, triangles) = surface;
    triangles
        .iter()
        .map(|t| t.map(|v| vertices[v as usize].to_array().map(f64::from)))
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

fn area(surface: &Surface) -> f64 {
    corners(surface)
        .map(|[a, b, c]| length(cross(minus(b, a), minus(c, a))) / 2.0)
        .sum()
}

/// By the divergence theorem about a point near the surface: positive if it faces outwards.
fn volume(surface: &Surface) -> f64 {
    let origin = surface.0[0].to_array().map(f64::from);
    corners(surface)
        .map(|t| t.map(|p| minus(p, origin)))
        .map(|[a, b, c]| dot(a, cross(b, c)) / 6.0)
        .sum()
}

/// Smallest signed distance over all primitives, by the oracle.
fn distance(mesh: &MedialMesh, p: Vector) -> f64 {
    let p = p.to_array().map(f64::from);
    mesh.primitives()
        .filter(|primitive| !beyond_box(primitive.spheres(), p, 0.01))
        .map(|primitive| signed_distance(primitive.spheres(), p))
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn ball_is_closed_and_converges_to_the_closed_form() {
    let ball = MedialMesh::new(
        vec![MedialSphere::new(Vector::new(3.0, -1.0, 2.0), 0.5)],
        vec![],
        vec![],
    )
    .unwrap();
    let mut errors = Vec::new();
    for spacing in [0.2, 0.1, 0.05] {
        let surface = ball.envelope(spacing);
        for v in &surface.0 {
            assert!((v.distance(Vector::new(3.0, -1.0, 2.0)) - 0.5).abs() < 1e-6);
        }
        let mut sides: HashMap<(u32, u32), u32> = HashMap::new();
        for &[a, b, c] in &surface.1 {
            for side in [(a, b), (b, c), (c, a)] {
                *sides.entry(side).or_default() += 1;
            }
        }
        for (&(a, b), &count) in &sides {
            assert_eq!((count, sides.get(&(b, a))), (1, Some(&1)), "side {a}-{b}");
        }
        let wanted = (PI, PI / 6.0);
        errors.push((
            1.0 - area(&surface) / wanted.0,
            1.0 - volume(&surface) / wanted.1,
        ));
    }
    let [(_, _), (area_2, volume_2), (area_3, volume_3)] = errors[..] else {
        unreachable!()
    };
    assert!(
        area_3 > 0.0 && area_3 < 0.003 && area_2 / area_3 > 3.0,
        "{errors:?}"
    );
    assert!(
        volume_3 > 0.0 && volume_3 < 0.006 && volume_2 / volume_3 > 3.0,
        "{errors:?}"
    );
}

#[test]
fn torus_converges_to_the_closed_form() {
    let (major, minor) = (1.0, 0.3);
    let torus = MedialMesh::torus(1.0, 0.3, 128).unwrap();
    let (wanted_area, wanted_volume) = (
        4.0 * PI * PI * major * minor,
        2.0 * PI * PI * major * minor * minor,
    );
    let mut last = f64::INFINITY;
    for (spacing, limit) in [(0.1, 0.03), (0.05, 0.008), (0.025, 0.003)] {
        let surface = torus.envelope(spacing);
        let area_error = (area(&surface) / wanted_area - 1.0).abs();
        let volume_error = (volume(&surface) / wanted_volume - 1.0).abs();
        assert!(
            area_error < limit && volume_error < limit,
            "{spacing}: {area_error} {volume_error}"
        );
        assert!(volume_error < last);
        last = volume_error;
    }
}

/// A capsule, a taper with one sphere inside the other's reach, and a single slab: closed forms.
#[test]
fn single_primitives_have_the_closed_area() {
    let capsule = MedialMesh::capsule(Vector::ZERO, Vector::new(0.0, 0.0, 2.0), 0.4).unwrap();
    let wanted = 2.0 * PI * 0.4 * 2.0 + 4.0 * PI * 0.16;
    let found = area(&capsule.envelope(0.02));
    assert!(
        (found / wanted - 1.0).abs() < 2e-3,
        "capsule: {found}, not {wanted}"
    );

    let swallowed = vec![
        MedialSphere::new(Vector::ZERO, 0.5),
        MedialSphere::new(Vector::new(0.2, 0.0, 0.0), 0.1),
    ];
    let swallowed = MedialMesh::new(swallowed, vec![[0, 1]], vec![]).unwrap();
    let found = area(&swallowed.envelope(0.02));
    assert!(
        (found / PI - 1.0).abs() < 2e-3,
        "swallowed: {found}, not {PI}"
    );

    // Steiner: both sides, a half cylinder along each side, a ball in all.
    let corners = [Vector::ZERO, Vector::X, Vector::Y];
    let spheres = corners.map(|c| MedialSphere::new(c, 0.2)).to_vec();
    let slab = MedialMesh::new(spheres, vec![], vec![[0, 1, 2]]).unwrap();
    let wanted = 1.0 + PI * 0.2 * (2.0 + 2f64.sqrt()) + 4.0 * PI * 0.04;
    let found = area(&slab.envelope(0.02));
    assert!(
        (found / wanted - 1.0).abs() < 3e-3,
        "slab: {found}, not {wanted}"
    );
}

#[test]
fn surfaces_shared_by_two_primitives_are_there_once() {
    let ball = MedialSphere::new(Vector::new(0.1, 0.2, 0.3), 0.5);
    let twice = MedialMesh::new(vec![ball, ball, ball], vec![], vec![]).unwrap();
    let once = MedialMesh::new(vec![ball], vec![], vec![]).unwrap();
    assert_eq!(area(&twice.envelope(0.05)), area(&once.envelope(0.05)));

    // One capsule along another: a–c, and a–b–c.
    let line = [0.0, 1.0, 2.0].map(|z| MedialSphere::new(Vector::new(0.0, 0.0, z), 0.4));
    let nested = MedialMesh::new(line.to_vec(), vec![[0, 2], [0, 1], [1, 2]], vec![]).unwrap();
    let wanted = 2.0 * PI * 0.4 * 2.0 + 4.0 * PI * 0.16;
    let found = area(&nested.envelope(0.02));
    assert!(
        (found / wanted - 1.0).abs() < 3e-3,
        "nested capsules: {found}, not {wanted}"
    );

    // A square of two slabs: their planes continue each other.
    let square = [Vector::ZERO, Vector::X, Vector::X + Vector::Y, Vector::Y];
    let spheres = square.map(|c| MedialSphere::new(c, 0.2)).to_vec();
    let plate = MedialMesh::new(spheres, vec![], vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let wanted = 2.0 + PI * 0.2 * 4.0 + 4.0 * PI * 0.04;
    let found = area(&plate.envelope(0.02));
    assert!(
        (found / wanted - 1.0).abs() < 3e-3,
        "plate: {found}, not {wanted}"
    );
}

#[test]
fn sheets_without_thickness_have_two_sides() {
    let corners = [Vector::ZERO, Vector::X, Vector::Y];
    let spheres = corners.map(|c| MedialSphere::new(c, 0.0)).to_vec();
    let sheet = MedialMesh::new(spheres, vec![], vec![[0, 1, 2]]).unwrap();
    let surface = sheet.envelope(0.1);
    assert!((area(&surface) - 1.0).abs() < 1e-5, "{}", area(&surface));
    assert!(volume(&surface).abs() < 1e-6);
}

/// The oracle searches the interpolation weights; it knows nothing of sheets.
#[test]
fn vertices_of_random_solids_lie_on_the_boundary() {
    let spacing = 0.08;
    let mut checked = 0;
    for seed in 0..12 {
        let mesh = random_mesh(seed);
        let (vertices, triangles) = mesh.envelope(spacing);
        for &v in vertices.iter().step_by(5) {
            let d = distance(&mesh, v);
            assert!(d.abs() < 2e-6, "seed {seed}: {v} is {d} from the boundary");
            checked += 1;
        }
        for t in &triangles {
            let [a, b, c] = t.map(|v| vertices[v as usize]);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            assert!(longest < 2.0 * spacing, "seed {seed}: a side of {longest}");
        }
    }
    assert!(checked > 2000, "{checked}");
}

/// Random points of random interpolated spheres that no primitive hides have a vertex nearby.
#[test]
fn the_whole_boundary_of_random_solids_is_there() {
    let spacing = 0.08f32;
    let mut checked = 0;
    for seed in 0..12 {
        let mesh = random_mesh(seed);
        let (vertices, _) = mesh.envelope(spacing);
        let mut random = Random(seed + 500);
        for _ in 0..4000 {
            let primitive = mesh.primitive(random.bits() as usize % mesh.primitive_count());
            let (x, y) = (
                random.within(0.0, 1.0) as f32,
                random.within(0.0, 1.0) as f32,
            );
            let weights = match primitive.spheres().len() {
                1 => [1.0, 0.0, 0.0],
                2 => [1.0 - x, x, 0.0],
                _ if x + y > 1.0 => [x + y - 1.0, 1.0 - x, 1.0 - y],
                _ => [1.0 - x - y, x, y],
            };
            let sphere = primitive.interpolate(weights);
            let point = sphere.center + random.vector(1.0).normalize() * sphere.radius;
            // A point just outside tells a boundary point from a hidden one.
            let outside = point + (point - sphere.center) * 1e-4;
            if inside(&mesh, outside.to_array().map(f64::from)) {
                continue;
            }
            let nearest = vertices
                .iter()
                .map(|v| v.distance(point))
                .fold(f32::MAX, f32::min);
            assert!(
                nearest < 1.5 * spacing,
                "seed {seed}: {point} is {nearest} from a vertex"
            );
            checked += 1;
        }
    }
    assert!(checked > 1000, "{checked}");
}

#[test]
fn volumes_of_random_solids_approach_the_mass() {
    for seed in 0..12 {
        let mesh = random_mesh(seed);
        let wanted = f64::from(mesh.volume());
        for (spacing, limit) in [(0.05, 0.03), (0.02, 0.006)] {
            let found = volume(&mesh.envelope(spacing));
            let error = (found / wanted - 1.0).abs();
            assert!(
                error < limit,
                "seed {seed}, spacing {spacing}: {found}, not {wanted}"
            );
        }
    }
}

#[test]
fn absurd_spacings_and_sizes_are_bounded() {
    let torus = MedialMesh::torus(1.0, 0.3, 24).unwrap();
    let usual = torus.envelope(1.3 * 2.0 / 64.0).1.len();
    for spacing in [f32::NAN, 0.0, -1.0, f32::INFINITY] {
        let found = torus.envelope(spacing).1.len();
        assert!(
            found > 0 && found < 2 * usual,
            "{spacing}: {found} triangles"
        );
    }
    let finest = torus.envelope(1e-30).1.len();
    assert!(finest > 100_000 && finest <= 4_200_000, "{finest}");
    assert!(!torus.envelope(1e30).1.is_empty());
    for radius in [1e-45f32, 1e-30, 1.0, 4e17] {
        for reach in [1e-45f32, 1e-20, 1.0, 1e10, 6e17] {
            let spheres = vec![
                MedialSphere::new(Vector::ZERO, radius),
                MedialSphere::new(Vector::new(reach, 0.0, reach), radius * 0.5),
                MedialSphere::new(Vector::new(0.0, reach, reach), 0.0),
            ];
            let mesh = MedialMesh::new(spheres, vec![[0, 1]], vec![[0, 1, 2]]).unwrap();
            let (vertices, triangles) = mesh.envelope(reach.max(radius));
            assert!(
                triangles
                    .iter()
                    .flatten()
                    .all(|&v| (v as usize) < vertices.len())
            );
        }
    }
}
