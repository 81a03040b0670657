//! Kits of convex parts that touch along whole faces, or nearly: a ring of blocks with a bar stuck through its wall.
//! What is solid is known from the planes of the parts.

use crate::drums::Prism;
use crate::meshes::Mesh;
use crate::oracle::Random;
use crate::solid_distance;
use parry3d::math::{Rotation, Vector};
use rapier3d_medial::{BuildOptions, MedialMesh, Quality, Variant};
use std::f64::consts::TAU;

const INNER: f64 = 0.5;
const OUTER: f64 = 0.56;
const HALF: f64 = 0.15;

/// A prism and where it is moved to.
struct Part {
    prism: Prism,
    moved: Vector,
}

impl Part {
    /// The triangles of a side begin at the lower of its first corners: from the two parts that touch there, a common
    /// face is split along different diagonals.
    fn mesh(&self) -> Mesh {
        let Prism { corners, heights } = &self.prism;
        let n = corners.len() as u32;
        let at = |&[x, y]: &[f64; 2]| {
            heights.map(|z| Vector::new(x as f32, y as f32, z as f32) + self.moved)
        };
        let sides = (0..n).flat_map(|i| {
            let [a, b] = [2 * i, 2 * ((i + 1) % n)];
            [[a, b, b + 1], [a, b + 1, a + 1]]
        });
        let ends = (1..n - 1).flat_map(|i| {
            let [a, b] = [2 * i, 2 * (i + 1)];
            [[0, b, a], [1, a + 1, b + 1]]
        });
        Mesh {
            vertices: corners.iter().flat_map(at).collect(),
            indices: sides.chain(ends).collect(),
        }
    }
}

/// A ring of so many blocks, and a bar through its wall if wanted, each moved by up to `apart` along each axis.
fn ring(blocks: usize, has_bar: bool, apart: f64, random: &mut Random) -> Vec<Part> {
    let at = |r: f64, k: usize| {
        let (sin, cos) = ((k as f64 + 0.5) / blocks as f64 * TAU).sin_cos();
        [r * cos, r * sin]
    };
    let block = |k: usize| {
        vec![
            at(INNER, k),
            at(OUTER, k),
            at(OUTER, k + 1),
            at(INNER, k + 1),
        ]
    };
    let bar = vec![[0.28, -0.02], [0.52, -0.02], [0.52, 0.02], [0.28, 0.02]];
    let outlines = (0..blocks).map(block).chain(has_bar.then_some(bar));
    let parts = outlines.map(|corners| Part {
        prism: Prism {
            corners,
            heights: [-HALF, HALF],
        },
        moved: random.vector(apart),
    });
    parts.collect()
}

/// Builds the parts as one mesh, turned, and checks against their planes that the result is exact.
fn assert_exact(parts: &[Part], blocks: usize) {
    let turn = Rotation::from_scaled_axis(Vector::new(0.7, 1.1, 0.4));
    let all = parts.iter().map(Part::mesh).reduce(Mesh::and);
    let mesh = all.expect("parts").map(|p| turn * p);
    let options = BuildOptions {
        quality: Quality::Fast,
        ..Default::default()
    };
    let built = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options);
    let (medial, report) = built.expect("a ring");
    assert_eq!(report.variant, Variant::Exact, "{blocks}: {report:?}");
    assert!(report.hausdorff.error() < 1.0e-5, "{:?}", report.hausdorff);
    let mut random = Random(3);
    let (mut solid, mut air) = (0, 0);
    for _ in 0..20_000 {
        let (r, angle) = (random.within(0.25, 0.6), random.within(0.0, TAU));
        let z = random.within(-0.2, 0.2);
        let p = Vector::from([r * angle.cos(), r * angle.sin(), z].map(|x| x as f32));
        let over = parts
            .iter()
            .map(|part| part.prism.height_over(p - part.moved));
        let over = over.fold(f64::INFINITY, f64::min);
        let distance = solid_distance(&medial, turn * p);
        if over < -1.0e-6 {
            solid += 1;
            assert!(distance < 1.0e-6, "{blocks}: {p} is {distance} outside");
        } else if over > 2.0e-5 {
            air += 1;
            assert!(
                distance > 0.0,
                "{blocks}: {p} is inside, {over} off the parts"
            );
        }
    }
    assert!(solid > 1_000 && air > 3_000, "{solid} {air}");
}

/// Blocks that touch share the edges of their common faces: four triangles and more meet at one.
#[test]
fn rings_of_blocks_that_touch_are_exact() {
    for (blocks, has_bar) in [(8, true), (16, true), (20, false)] {
        assert_exact(&ring(blocks, has_bar, 0.0, &mut Random(1)), blocks);
    }
}

/// Between blocks that are off by a ten-thousandth there are cracks, steps and overlaps. Some of their faces are nearly
/// in one plane.
#[test]
fn rings_of_blocks_with_cracks_are_exact() {
    for (blocks, apart, seed) in [(8, 3.0e-5, 5), (16, 1.0e-4, 6), (16, 3.0e-4, 7)] {
        assert_exact(&ring(blocks, true, apart, &mut Random(seed)), blocks);
    }
}
