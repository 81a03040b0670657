//! Polygons in mesh files: covered exactly once by their triangles, whatever their shape.

use crate::mesh_file::{assert_valid, lines, load};
use crate::oracle::Random;
use rapier3d_medial::math::Vector;
use rapier3d_medial::meshing::mesh_file::MeshFormat;

/// Areas of a planar polygon by the shoelace formula, and of its triangles, all of which must
/// face as the polygon does: then the triangles cover it exactly once.
fn assert_covered(polygon: &[[f64; 2]], name: &str) {
    // Tilted so that no coordinate plane is special.
    let tilt = |[x, y]: [f64; 2]| format!("v {} {} {}", x, 0.6 * x + y, 0.3 * x - 0.8 * y);
    let corners: Vec<String> = (1..=polygon.len()).map(|i| i.to_string()).collect();
    let text = format!(
        "{}f {}\n",
        lines(polygon.iter().copied(), tilt),
        corners.join(" ")
    );
    let mesh = load(text.as_bytes(), MeshFormat::Obj).unwrap();
    let flat = |i: u32| {
        let v = mesh.vertices[i as usize];
        let x = f64::from(v.x);
        [x, f64::from(v.y) - 0.6 * x]
    };
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let wanted: f64 = (0..polygon.len())
        .map(|i| cross(polygon[i], polygon[(i + 1) % polygon.len()]) / 2.0)
        .sum();
    let mut covered = 0.0;
    for t in &mesh.indices {
        let [a, b, c] = t.map(flat);
        let area = (cross(a, b) + cross(b, c) + cross(c, a)) / 2.0;
        assert!(
            area * wanted.signum() > -1e-6,
            "{name}: a triangle of area {area}"
        );
        covered += area;
    }
    assert!(
        (covered - wanted).abs() < 1e-4 * wanted.abs(),
        "{name}: {covered} of {wanted}"
    );
    assert_eq!(mesh.indices.len(), polygon.len() - 2, "{name}");
}

#[test]
fn concave_polygons_are_covered_exactly_once() {
    let l = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];
    assert_covered(&l, "L");
    for start in 0..6 {
        let mut turned = l;
        turned.rotate_left(start);
        assert_covered(&turned, "L from another corner");
        turned.reverse();
        assert_covered(&turned, "L clockwise");
    }
    assert_covered(
        &[[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.5, 1.0]],
        "arrow head",
    );
    let with_middles = [
        [0.0, 0.0],
        [1.0, 0.0],
        [2.0, 0.0],
        [2.0, 2.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];
    assert_covered(&with_middles, "corners on straight sides");
    let comb: Vec<[f64; 2]> = (0..200)
        .map(|i| [f64::from(i), if i % 2 == 0 { 5.0 } else { 1.0 }])
        .chain([[199.0, 0.0], [0.0, 0.0]])
        .rev()
        .collect();
    assert_covered(&comb, "comb");
    let mut random = Random(3);
    for case in 0..200 {
        let count = 4 + case % 60;
        let star: Vec<_> = (0..count)
            .map(|i| {
                let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
                let r = random.within(0.05, 1.0);
                [r * angle.cos(), r * angle.sin()]
            })
            .collect();
        assert_covered(&star, "star");
    }
}

/// A square with a square hole, joined by a cut that the outline runs along twice.
#[test]
fn a_hole_joined_by_a_cut_stays_open() {
    let text = "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 1 1 0\nv 1 2 0\nv 2 2 0\nv 2 1 0\n\
                f 1 2 3 4 1 5 6 7 8 5\n";
    let mesh = load(text.as_bytes(), MeshFormat::Obj).unwrap();
    let at = |i: u32| mesh.vertices[i as usize];
    let mut area = 0.0;
    for &[a, b, c] in &mesh.indices {
        let z = (at(b) - at(a)).cross(at(c) - at(a)).z / 2.0;
        let center = (at(a) + at(b) + at(c)) / 3.0 - Vector::new(1.5, 1.5, 0.0);
        assert!(z >= 0.0);
        assert!(
            z == 0.0 || center.x.abs().max(center.y.abs()) > 0.5,
            "the hole is covered"
        );
        area += z;
    }
    assert_eq!(area, 8.0);
}

/// 60,000 corners with 30,000 notches: bounded time.
#[test]
fn a_huge_polygon_ends() {
    let count = 60_000;
    let vertices = lines(0..count, |i| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
        let r = if i % 2 == 0 { 1.0 } else { 0.5 };
        format!("v {:.6} {:.6} 0", r * angle.cos(), r * angle.sin())
    });
    let corners: Vec<String> = (1..=count).map(|i| i.to_string()).collect();
    let text = format!("{vertices}f {}\n", corners.join(" "));
    let mesh = load(text.as_bytes(), MeshFormat::Obj).unwrap();
    assert_valid(&mesh);
}
