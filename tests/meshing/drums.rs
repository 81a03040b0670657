//! Drums of convex parts that touch in whole faces, with lifters stuck into their walls: what is solid is known from
//! the planes of the parts.

use crate::meshes::Mesh;
use crate::oracle::Random;
use crate::solid_distance;
use parry3d::math::Vector;
use parry3d::shape::ConvexPolyhedron;
use rapier3d_medial::{BuildOptions, BuildReport, MedialMesh, Quality, Variant};
use std::f64::consts::TAU;

/// Inner radius, thickness of the wall, half the length inside.
const RADIUS: f64 = 0.5;
const WALL: f64 = 0.03;
const HALF: f64 = 0.2;

/// A convex polygon, counterclockwise, between two heights.
pub struct Prism {
    pub corners: Vec<[f64; 2]>,
    pub heights: [f64; 2],
}

impl Prism {
    /// How far a point is outside the farthest of its planes; negative inside.
    pub fn height_over(&self, p: Vector) -> f64 {
        let [x, y, z] = [p.x, p.y, p.z].map(f64::from);
        let n = self.corners.len();
        let sides = (0..n).map(|i| {
            let ([ax, ay], [bx, by]) = (self.corners[i], self.corners[(i + 1) % n]);
            let (dx, dy) = (bx - ax, by - ay);
            ((x - ax) * dy - (y - ay) * dx) / dx.hypot(dy)
        });
        let ends = [self.heights[0] - z, z - self.heights[1]];
        sides.chain(ends).fold(f64::NEG_INFINITY, f64::max)
    }

    fn mesh(&self) -> Mesh {
        let corners = self.corners.iter();
        let points: Vec<Vector> = corners
            .flat_map(|&[x, y]| {
                self.heights
                    .map(|z| Vector::new(x as f32, y as f32, z as f32))
            })
            .collect();
        let hull = ConvexPolyhedron::from_convex_hull(&points).expect("a prism");
        let (vertices, indices) = hull.to_trimesh();
        Mesh { vertices, indices }
    }
}

/// A closed drum of so many sides, with so many lifters that stick into corners of its wall, turned by an angle.
pub fn drum(sides: usize, lifters: usize, turned: f64) -> Vec<Prism> {
    let at = |r: f64, k: usize| {
        let (sin, cos) = (turned + (k as f64 + 0.5) / sides as f64 * TAU).sin_cos();
        [r * cos, r * sin]
    };
    let (inner, outer) = (RADIUS, RADIUS + WALL);
    let wall = (0..sides).map(|k| Prism {
        corners: vec![
            at(inner, k),
            at(outer, k),
            at(outer, k + 1),
            at(inner, k + 1),
        ],
        heights: [-HALF - WALL, HALF + WALL],
    });
    let ends = [[HALF, HALF + WALL], [-HALF - WALL, -HALF]].map(|heights| Prism {
        corners: (0..sides).map(|k| at(inner, k)).collect(),
        heights,
    });
    let lifters = (0..lifters).map(|i| {
        let turn = turned + (i as f64 + 0.5) / sides as f64 * (sides / lifters) as f64 * TAU;
        let (sin, cos) = turn.sin_cos();
        let rectangle = [[0.75, -0.04], [0.99, -0.04], [0.99, 0.04], [0.75, 0.04]];
        let turned = rectangle.map(|[x, y]| [x * cos - y * sin, x * sin + y * cos]);
        Prism {
            corners: turned.map(|corner| corner.map(|x| x * RADIUS)).to_vec(),
            heights: [-HALF, HALF],
        }
    });
    wall.chain(ends).chain(lifters).collect()
}

pub fn build(parts: &[Prism], quality: Quality, primitives: usize) -> (MedialMesh, BuildReport) {
    let all = parts.iter().map(Prism::mesh).reduce(Mesh::and);
    let mesh = all.expect("parts");
    let options = BuildOptions {
        primitives: Some(primitives),
        quality,
        ..Default::default()
    };
    let built = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options);
    built.expect("a drum")
}

/// The end of a lifter and the wall leave wedges of air of 15 degrees or so, whose tips are lost to rounding first.
#[test]
fn drums_with_lifters_are_exact() {
    for (sides, lifters, turned) in [(12, 4, 0.1), (12, 4, 0.3), (10, 6, 0.1)] {
        let parts = drum(sides, lifters, turned);
        let (mesh, report) = build(&parts, Quality::Fast, 500);
        assert_eq!(report.variant, Variant::Exact, "{sides} sides: {report:?}");
        assert!(report.hausdorff.error() < 1.0e-5, "{:?}", report.hausdorff);
        let mut random = Random(7);
        let (mut solid, mut air) = (0, 0);
        for _ in 0..20_000 {
            let (r, turn) = (random.within(0.3, 0.55), random.within(0.0, TAU));
            let z = random.within(-0.25, 0.25);
            let p = Vector::from([r * turn.cos(), r * turn.sin(), z].map(|x| x as f32));
            let over = parts.iter().map(|part| part.height_over(p));
            let over = over.fold(f64::INFINITY, f64::min);
            let distance = solid_distance(&mesh, p);
            if over < 0.0 {
                solid += 1;
                assert!(distance < 1.0e-6, "{p} is {distance} outside");
            } else if over > 2.0e-5 {
                air += 1;
                assert!(distance > 0.0, "{p} is inside, {over} off the parts");
            }
        }
        assert!(solid > 3_000 && air > 3_000, "{solid} {air}");
    }
}

/// More than the default allows: the report says how many, and with so many it is exact.
#[test]
fn large_drums_tell_with_how_many_primitives_they_are_exact() {
    let parts = drum(12, 6, 0.0);
    let (_, report) = build(&parts, Quality::Fast, 500);
    let count = report.exact_with.expect("a number");
    assert!(report.variant != Variant::Exact && count > 500);
    let (_, report) = build(&parts, Quality::Fast, count);
    assert_eq!(report.variant, Variant::Exact, "{report:?}");
}
