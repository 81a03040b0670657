//! Exact solids against closed forms: volumes, and membership of random points by a distance written
//! down for each.

use crate::oracle::{Random, inside, signed_distance};
use rapier3d_medial::math::Vector;
use rapier3d_medial::{MedialMesh, MedialSphere, MeshError};
use std::f64::consts::{PI, SQRT_2};

type Point = [f64; 3];

/// Random points about the mesh, those nearer to the surface than rounding left out, are in it exactly
/// where `distance` is negative.
fn same_solid(name: &str, mesh: &MedialMesh, seed: u64, distance: impl Fn(Point) -> f64) {
    let (mut random, mut held, mut cases) = (Random(seed), 0, 0);
    let aabb = mesh.aabb();
    let (center, half) = (aabb.center(), aabb.half_extents());
    let scale = f64::from(half.max_element());
    while cases < 3000 {
        let p = [0, 1, 2].map(|k| {
            let reach = 1.3 * f64::from(half[k]);
            f64::from(center[k]) + random.within(-reach, reach)
        });
        let d = distance(p);
        if d.abs() < 1.0e-5 * scale {
            continue;
        }
        cases += 1;
        held += usize::from(d < 0.0);
        // The closed form of the oracle rounds where a slab is 4000 times as long as wide; its search does
        // not.
        let searched = || {
            mesh.primitives()
                .any(|q| signed_distance(q.spheres(), p) < 0.0)
        };
        let found = inside(mesh, p) || (d < 0.0 && searched());
        assert_eq!(found, d < 0.0, "{name}: {p:?}, {d}");
    }
    assert!(
        (100..2900).contains(&held),
        "{name}: {held} of {cases} inside"
    );
}

fn volume(name: &str, mesh: &MedialMesh, wanted: f64) {
    let error = (f64::from(mesh.volume()) - wanted).abs() / wanted;
    assert!(
        error < 2.0e-4,
        "{name}: {} instead of {wanted}",
        mesh.volume()
    );
}

fn to_segment(p: Point, a: Point, b: Point) -> f64 {
    let dot = |u: Point, v: Point| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let minus = |u: Point, v: Point| [0, 1, 2].map(|k| u[k] - v[k]);
    let (e, w) = (minus(b, a), minus(p, a));
    let x = if dot(e, e) > 0.0 {
        (dot(w, e) / dot(e, e)).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let off = [0, 1, 2].map(|k| w[k] - e[k] * x);
    dot(off, off).sqrt()
}

fn to_box(p: Point, h: Point) -> f64 {
    let out = [0, 1, 2].map(|k| p[k].abs() - h[k]);
    let outside = out
        .map(|x| x.max(0.0))
        .map(|x| x * x)
        .iter()
        .sum::<f64>()
        .sqrt();
    outside + out.into_iter().fold(f64::MIN, f64::max).min(0.0)
}

/// Every order of the half extents, equal ones, flat ones, and a needle.
#[test]
fn boxes_are_exact() {
    let sharp: [[f32; 3]; 8] = [
        [0.5, 0.3, 0.2],
        [0.3, 0.2, 0.5],
        [0.2, 0.5, 0.3],
        [0.5, 0.5, 0.5],
        [0.5, 0.5, 0.2],
        [0.2, 0.5, 0.2],
        [40.0, 0.01, 0.02],
        [1.0, 1.0, 1.0e-3],
    ];
    let flat: [[f32; 3]; 4] = [
        [0.5, 0.0, 0.3],
        [0.0, 0.4, 0.0],
        [0.0, 0.0, 0.0],
        [0.2, 0.4, 0.0],
    ];
    for (k, h) in sharp.iter().chain(&flat).enumerate() {
        for border in [0.0_f32, 0.1, 0.7] {
            let name = format!("{h:?} rounded by {border}");
            let extents = Vector::from(*h);
            let mesh = match border {
                0.0 if h.contains(&0.0) => continue,
                0.0 => MedialMesh::cuboid(extents),
                _ => MedialMesh::round_cuboid(extents, border),
            };
            let mesh = mesh.unwrap();
            let (h, r) = (h.map(f64::from), f64::from(border));
            let [a, b, c] = h;
            let faces = 8.0 * (a * b + b * c + c * a);
            // Steiner's formula: volume, faces, edges (total length 8 (a + b + c), a quarter each), corners.
            let wanted = 8.0 * a * b * c
                + faces * r
                + 2.0 * PI * (a + b + c) * r * r
                + 4.0 / 3.0 * PI * r.powi(3);
            volume(&name, &mesh, wanted);
            same_solid(&name, &mesh, k as u64, |p| to_box(p, h) - r);
        }
    }
    assert_eq!(
        MedialMesh::cuboid(Vector::new(0.5, 0.3, 0.2))
            .unwrap()
            .primitive_count(),
        22
    );
    assert_eq!(
        MedialMesh::cuboid(Vector::ONE).unwrap().primitive_count(),
        12
    );
    let plate = MedialMesh::round_plate(0.5, 0.3, 0.1).unwrap();
    assert_eq!(plate.primitive_count(), 2);
    same_solid("plate", &plate, 1, |p| to_box(p, [0.5, 0.0, 0.3]) - 0.1);
}

/// Two bars that meet at right angles share a quarter of a bicylinder (16/3 r³), three an eighth of a
/// tricylinder (8 (2 − √2) r³) of all three; outside the corner a ball shows, a quarter or an eighth of it.
#[test]
fn frames_are_exact() {
    let (x, y, z, r) = (0.8, 0.5, 0.6, 0.15);
    let frame = MedialMesh::rectangle_frame(x as f32, z as f32, r as f32).unwrap();
    let corners = [[-x, 0.0, -z], [x, 0.0, -z], [x, 0.0, z], [-x, 0.0, z]];
    let sides: Vec<_> = (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]).collect();
    let cube = r * r * r;
    let wanted = PI * r * r * 4.0 * (x + z) + 4.0 * (PI / 3.0 - 4.0 / 3.0) * cube;
    volume("rectangle frame", &frame, wanted);
    let near = |edges: &[[Point; 2]], p: Point| {
        edges
            .iter()
            .map(|[a, b]| to_segment(p, *a, *b))
            .fold(f64::MAX, f64::min)
            - r
    };
    same_solid("rectangle frame", &frame, 5, |p| near(&sides, p));

    let cage = MedialMesh::box_frame(Vector::new(x as f32, y as f32, z as f32), r as f32).unwrap();
    let mut edges = Vec::new();
    for s in [-1.0, 1.0] {
        for t in [-1.0, 1.0] {
            edges.push([[-x, s * y, t * z], [x, s * y, t * z]]);
            edges.push([[s * x, -y, t * z], [s * x, y, t * z]]);
            edges.push([[s * x, t * y, -z], [s * x, t * y, z]]);
        }
    }
    let corner = -3.0 * 4.0 / 3.0 + (2.0 - SQRT_2) + PI / 6.0;
    let wanted = PI * r * r * 8.0 * (x + y + z) + 8.0 * corner * cube;
    volume("box frame", &cage, wanted);
    assert_eq!(cage.primitive_count(), 12);
    same_solid("box frame", &cage, 6, |p| near(&edges, p));
}

#[test]
fn tubes_are_exact() {
    // A straight tube with linear radii is one cone; its volume is in closed form.
    let (r1, r2, length) = (0.4, 0.1, 2.0);
    let at = |part: f64| {
        let radius = r1 + (r2 - r1) * part;
        MedialSphere::new(Vector::new(0.0, (length * part) as f32, 0.0), radius as f32)
    };
    let spheres = [0.0, 0.2, 0.5, 0.9, 1.0].map(at);
    let straight = MedialMesh::tube(&spheres, false).unwrap();
    let sin = (r1 - r2) / length;
    let cos2 = 1.0 - sin * sin;
    let height = length - (r1 - r2) * sin;
    let cap = |r: f64, h: f64| PI * h * h * (3.0 * r - h) / 3.0;
    let frustum = PI * height / 3.0 * cos2 * (r1 * r1 + r1 * r2 + r2 * r2);
    let wanted = frustum + cap(r1, r1 * (1.0 + sin)) + cap(r2, r2 * (1.0 - sin));
    volume("straight tube", &straight, wanted);

    let ring = MedialMesh::torus(1.0, 0.2, 24).unwrap();
    let tube = MedialMesh::tube(ring.spheres(), true).unwrap();
    assert_eq!(tube.edges(), ring.edges());

    let bent = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.2],
        [0.3, 1.2, 1.0],
    ];
    let spheres = bent.map(|p| MedialSphere::new(Vector::from(p.map(|x: f64| x as f32)), 0.15));
    let wire = MedialMesh::tube(&spheres, false).unwrap();
    let near = |p| {
        (1..4)
            .map(|k| to_segment(p, bent[k - 1], bent[k]))
            .fold(f64::MAX, f64::min)
    };
    same_solid("bent tube", &wire, 7, |p| near(p) - f64::from(0.15_f32));
    assert_eq!(
        MedialMesh::tube(&spheres[..1], false)
            .unwrap()
            .primitive_count(),
        1
    );
}

/// Distance to a polygon in the xz-plane: 0 in it (even-odd rule).
fn to_polygon(p: Point, corners: &[[f32; 2]]) -> f64 {
    let at = |i: usize| corners[i % corners.len()].map(f64::from);
    let [x, z] = [p[0], p[2]];
    let crossings = (0..corners.len()).filter(|&i| {
        let ([ax, az], [bx, bz]) = (at(i), at(i + 1));
        (az > z) != (bz > z) && x < ax + (bx - ax) * (z - az) / (bz - az)
    });
    if crossings.count() % 2 == 1 {
        return p[1].abs();
    }
    let side = |i: usize| {
        let ([ax, az], [bx, bz]) = (at(i), at(i + 1));
        to_segment(p, [ax, 0.0, az], [bx, 0.0, bz])
    };
    (0..corners.len()).map(side).fold(f64::MAX, f64::min)
}

#[test]
fn polygons_are_exact() {
    let r = 0.1_f32;
    let wide = f64::from(r);
    let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 0.7]];
    let [a, b, c] = triangle.map(|[x, z]| Vector::new(x, 0.0, z));
    let steiner = |area: f64, around: f64| {
        2.0 * wide * area + PI / 2.0 * wide * wide * around + 4.0 / 3.0 * PI * wide.powi(3)
    };
    let wanted = steiner(0.35, 1.0 + 0.7 + 1.49_f64.sqrt());
    volume(
        "triangle",
        &MedialMesh::round_triangle(a, b, c, r).unwrap(),
        wanted,
    );
    volume(
        "triangle",
        &MedialMesh::round_polygon(&triangle, r).unwrap(),
        wanted,
    );

    let ell = [
        [0.0, 0.0],
        [1.0, 0.0],
        [1.0, 0.3],
        [0.3, 0.3],
        [0.3, 1.0],
        [0.0, 1.0],
    ];
    // Corners on a straight side, and on the line of another side.
    let square = [
        [0.0, 0.0],
        [0.4, 0.0],
        [1.0, 0.0],
        [1.0, 0.5],
        [1.0, 1.0],
        [0.4, 1.0],
        [0.4, 0.5],
        [0.0, 0.5],
    ];
    let mut outlines = vec![triangle.to_vec(), ell.to_vec(), square.to_vec()];
    let mut random = Random(11);
    for count in [5, 8, 13, 40] {
        // A star about its centre: never crosses itself, mostly concave.
        let mut star: Vec<[f32; 2]> = (0..count)
            .map(|i| {
                let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
                let reach = random.within(0.2, 1.0);
                [(reach * angle.cos()) as f32, (reach * angle.sin()) as f32]
            })
            .collect();
        outlines.push(star.clone());
        star.reverse();
        outlines.push(star);
    }
    for (k, corners) in outlines.iter().enumerate() {
        let mesh = MedialMesh::round_polygon(corners, r).unwrap();
        assert_eq!(mesh.primitive_count(), corners.len() - 2);
        same_solid(&format!("{corners:?}"), &mesh, k as u64, |p| {
            to_polygon(p, corners) - wide
        });
    }

    // A comb of many teeth: its slabs add up to its area.
    let teeth = 500;
    let mut comb: Vec<[f32; 2]> = (0..=2 * teeth)
        .map(|i| [i as f32, (i % 2) as f32 * 8.0 + 1.0])
        .collect();
    comb.extend([[2.0 * teeth as f32, 0.0], [0.0, 0.0]]);
    let mesh = MedialMesh::round_polygon(&comb, r).unwrap();
    let area: f32 = mesh
        .primitives()
        .map(|p| {
            let [a, b, c] = p.as_slab().map(|s| s.center);
            0.5 * (b - a).cross(c - a).length()
        })
        .sum();
    assert!(
        (area / (2.0 * teeth as f32 * 5.0) - 1.0).abs() < 1.0e-4,
        "{area}"
    );
}

#[test]
fn bad_parameters_are_named_with_their_value() {
    let v = Vector::new;
    let at = |x: f32, r: f32| MedialSphere::new(v(x, 0.0, 0.0), r);
    let nan = f32::NAN;
    let cases: Vec<(Result<MedialMesh, MeshError>, &[&str])> = vec![
        (
            MedialMesh::cuboid(v(1.0, 0.0, 1.0)),
            &["half_extents.y", "0", "positive"],
        ),
        (
            MedialMesh::cuboid(v(1.0, 1.0, f32::INFINITY)),
            &["half_extents.z", "inf"],
        ),
        (
            MedialMesh::round_cuboid(v(-0.5, 1.0, 1.0), 0.1),
            &["half_extents.x", "-0.5", "at least 0"],
        ),
        (
            MedialMesh::round_cuboid(v(1.0, 1.0, 1.0), 0.0),
            &["border_radius", "0"],
        ),
        (
            MedialMesh::round_cuboid(v(1.0, nan, 1.0), 0.1),
            &["half_extents.y", "NaN"],
        ),
        (MedialMesh::round_plate(1.0, -2.0, 0.1), &["half_z", "-2"]),
        (
            MedialMesh::rectangle_frame(1.0, 0.25, 0.25),
            &["half_z", "0.25", "above the radius"],
        ),
        (
            MedialMesh::rectangle_frame(1.0, 1.0, nan),
            &["radius", "NaN"],
        ),
        (
            MedialMesh::box_frame(v(1.0, 0.1, 1.0), 0.5),
            &["half_extents.y", "0.1"],
        ),
        (
            MedialMesh::box_frame(v(1.0, f32::INFINITY, 1.0), 0.5),
            &["half_extents.y", "inf"],
        ),
        (MedialMesh::tube(&[], false), &["at least one sphere"]),
        (
            MedialMesh::tube(&[at(0.0, 1.0), at(1.0, 1.0)], true),
            &["closed tube", "2", "at least 3"],
        ),
        (
            MedialMesh::tube(&[at(0.0, 1.0), at(1.0, -1.0)], false),
            &["sphere 1", "-1"],
        ),
        (
            MedialMesh::tube(&[at(0.0, 1.0), at(nan, 1.0)], false),
            &["sphere 1", "NaN"],
        ),
        (
            MedialMesh::round_triangle(v(nan, 0.0, 0.0), Vector::X, Vector::Y, 0.1),
            &["sphere 0", "NaN"],
        ),
        (
            MedialMesh::round_triangle(Vector::ZERO, Vector::X, Vector::Y, -0.1),
            &["radius", "-0.1"],
        ),
        (
            MedialMesh::round_polygon(&[[0.0, 0.0], [1.0, 0.0]], 0.1),
            &["corners", "2"],
        ),
        (
            MedialMesh::round_polygon(&[[0.0, 0.0]; 5000], 0.1),
            &["corners", "5000"],
        ),
        (
            MedialMesh::round_polygon(&[[0.0, 0.0], [1.0, nan], [1.0, 1.0]], 0.1),
            &["sphere 1", "NaN"],
        ),
        // A bow tie; a corner given twice; a fold back; a line; a corner that touches a side.
        (
            MedialMesh::round_polygon(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]], 0.1),
            &["edges 0 and 2"],
        ),
        (
            MedialMesh::round_polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]], 0.1),
            &["edges 1 and 2"],
        ),
        (
            MedialMesh::round_polygon(&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [0.0, 1.0]], 0.1),
            &["edges 0 and 1"],
        ),
        (
            MedialMesh::round_polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], 0.1),
            &["edges 1 and 2"],
        ),
        (
            MedialMesh::round_polygon(
                &[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]],
                0.1,
            ),
            &["edges 0 and 2"],
        ),
    ];
    for (k, (result, words)) in cases.iter().enumerate() {
        let message = result.as_ref().expect_err(&format!("case {k}")).to_string();
        for word in *words {
            assert!(
                message.contains(word),
                "case {k}: {message:?} lacks {word:?}"
            );
        }
    }
}
