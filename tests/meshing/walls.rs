//! Thin walls: cups whose wall is a hundredth of their height.

use crate::meshes::Mesh;
use crate::oracle::Random;
use crate::solid_distance;
use parry3d::math::Vector;
use rapier3d_medial::{BuildOptions, MedialMesh};
use std::f64::consts::{PI, TAU};

/// Straight sides of a cup.
const AROUND: u32 = 48;

/// Half of a cup's profile about the y axis, radius and height, from the axis at the bottom to that inside: 1 high,
/// wider at the top.
fn profile(wall: f64) -> [[f64; 2]; 6] {
    [
        [0.0, 0.0],
        [0.3, 0.0],
        [0.35, 1.0],
        [0.35 - wall, 1.0],
        [0.3 - wall, wall],
        [0.0, wall],
    ]
}

fn cup(wall: f64) -> Mesh {
    let [bottom, rims @ .., floor] = profile(wall);
    let on_axis = |[_, y]: [f64; 2]| Vector::new(0.0, y as f32, 0.0);
    let mut vertices = vec![on_axis(bottom), on_axis(floor)];
    for [r, y] in rims {
        vertices.extend((0..AROUND).map(|k| {
            let (sin, cos) = (TAU * f64::from(k) / f64::from(AROUND)).sin_cos();
            Vector::new((r * cos) as f32, y as f32, (r * sin) as f32)
        }));
    }
    let at = |rim: u32, k: u32| 2 + rim * AROUND + k % AROUND;
    let mut indices = Vec::new();
    for k in 0..AROUND {
        indices.push([0, at(0, k), at(0, k + 1)]);
        indices.push([1, at(3, k + 1), at(3, k)]);
        for rim in 0..3 {
            let [a, b, c, d] = [
                at(rim, k),
                at(rim, k + 1),
                at(rim + 1, k + 1),
                at(rim + 1, k),
            ];
            indices.extend([[a, c, b], [a, d, c]]);
        }
    }
    Mesh { vertices, indices }
}

/// Distance from the round cup, negative inside, by its profile.
fn distance(wall: f64, p: Vector) -> f64 {
    let corners = profile(wall);
    let q = [f64::from(p.x).hypot(f64::from(p.z)), f64::from(p.y)];
    let (mut nearest, mut is_in) = (f64::INFINITY, false);
    for (k, [ax, ay]) in corners.into_iter().enumerate() {
        let [bx, by] = corners[(k + 1) % corners.len()];
        if (ay > q[1]) != (by > q[1]) && q[0] < ax + (q[1] - ay) / (by - ay) * (bx - ax) {
            is_in = !is_in;
        }
        // The axis is no side.
        if ax == 0.0 && bx == 0.0 {
            continue;
        }
        let [dx, dy] = [bx - ax, by - ay];
        let along = ((q[0] - ax) * dx + (q[1] - ay) * dy) / (dx * dx + dy * dy);
        let along = along.clamp(0.0, 1.0);
        nearest = nearest.min((q[0] - ax - along * dx).hypot(q[1] - ay - along * dy));
    }
    if is_in { -nearest } else { nearest }
}

/// As many samples as 100 primitives ask for are one to two thicknesses of these walls apart.
#[test]
fn cups_with_walls_of_a_hundredth_are_hollow_and_whole() {
    // How far the 48 sides are inside the round cup.
    let sagitta = 0.35 * (1.0 - (PI / f64::from(AROUND)).cos());
    for wall in [0.008, 0.012] {
        let Mesh { vertices, indices } = cup(wall);
        let options = BuildOptions {
            primitives: Some(100),
            ..Default::default()
        };
        let built = MedialMesh::from_trimesh(&vertices, &indices, &options);
        let (medial, report) = built.expect("a cup");
        let mut random = Random(7);
        let mut farthest = 0.0f64;
        for _ in 0..40_000 {
            let [x, y, z] = [(-0.4, 0.4), (-0.05, 1.05), (-0.4, 0.4)]
                .map(|(low, high)| random.within(low, high) as f32);
            let p = Vector::new(x, y, z);
            let truth = distance(wall, p);
            if truth < -sagitta {
                assert!(solid_distance(&medial, p) <= 0.0, "{p} is left out");
            }
            if solid_distance(&medial, p) < 0.0 {
                farthest = farthest.max(truth);
            }
        }
        let reported = f64::from(report.hausdorff.error() / report.longest_side);
        println!("wall {wall}: off by {farthest:.5}, reported {reported:.5}");
        assert!(farthest < 0.01 && reported < 0.01, "{farthest} {reported}");
    }
}
