//! Kits of convex parts that touch along whole faces, or nearly: a ring of blocks with a bar stuck through its wall, a
//! shelf, steps. What is solid is known from the planes of the parts.

use crate::drums::Prism;
use crate::meshes::{Mesh, capsule};
use crate::oracle::Random;
use crate::solid_distance;
use parry3d::math::{Rotation, Vector};
use rapier3d_medial::{BuildOptions, BuildReport, MedialMesh, Quality, Variant};
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

/// A block from one corner to the opposite one.
fn block([x0, y0, z0]: [f64; 3], [x1, y1, z1]: [f64; 3]) -> Part {
    Part {
        prism: Prism {
            corners: vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]],
            heights: [z0, z1],
        },
        moved: Vector::ZERO,
    }
}

/// Two sides, three boards between them and a back, which reaches from one depth to another.
fn shelf(back: [f64; 2]) -> Vec<Part> {
    let side = |x: f64| block([x, -0.15, -0.5], [x + 0.02, 0.15, 0.5]);
    let board = |z: f64| block([-0.29, -0.15, z], [0.29, 0.15, z + 0.02]);
    let back = block([-0.31, back[0], -0.5], [0.31, back[1], 0.5]);
    let boards = [-0.46, -0.01, 0.44].map(board);
    [-0.31, 0.29]
        .map(side)
        .into_iter()
        .chain(boards)
        .chain([back])
        .collect()
}

/// Steps, each a block that stands on the ground.
fn steps() -> Vec<Part> {
    let step = |k: u32| {
        let (x, z) = (f64::from(k) * 0.1 - 0.3, f64::from(k + 1) * 0.05);
        block([x, -0.15, -0.1], [x + 0.1, 0.15, z - 0.1])
    };
    (0..6).map(step).collect()
}

/// Builds the parts as one mesh, turned, with corners off by up to `off` along each axis.
fn build(
    parts: &[Part],
    turn: Rotation,
    off: f64,
    random: &mut Random,
) -> (MedialMesh, BuildReport) {
    let all = parts.iter().map(Part::mesh).reduce(Mesh::and);
    let mut mesh = all.expect("parts");
    for p in &mut mesh.vertices {
        *p = turn * *p + random.vector(off);
    }
    let options = BuildOptions {
        quality: Quality::Fast,
        ..Default::default()
    };
    let built = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options);
    built.expect("a kit")
}

/// How far a point is outside the nearest part; negative inside.
fn height_over(parts: &[Part], p: Vector) -> f64 {
    let over = parts
        .iter()
        .map(|part| part.prism.height_over(p - part.moved));
    over.fold(f64::INFINITY, f64::min)
}

/// Builds the parts and checks against their planes that the result is exact, but for what its faces are not flat with
/// corners that are `off`.
fn assert_exact(name: &str, parts: &[Part], off: f64, random: &mut Random) {
    let turn = Rotation::from_scaled_axis(Vector::new(0.7, 1.1, 0.4));
    let (medial, report) = build(parts, turn, off, random);
    let error = f64::from(report.hausdorff.error());
    println!("{name}, corners off by {off}: error {error}");
    assert_eq!(report.variant, Variant::Exact, "{name}, {off}: {report:?}");
    assert!(error < 1.0e-5 + 20.0 * off, "{name}, {off}: {error}");
    let (mut solid, mut air) = (0, 0);
    for _ in 0..40_000 {
        let (r, angle) = (random.within(0.1, 0.6), random.within(0.0, TAU));
        let z = random.within(-0.2, 0.2);
        let p = Vector::from([r * angle.cos(), r * angle.sin(), z].map(|x| x as f32));
        let over = height_over(parts, p);
        let distance = solid_distance(&medial, turn * p);
        if over < -1.0e-6 - 2.0 * off {
            solid += 1;
            assert!(distance < 1.0e-6, "{name}: {p} is {distance} outside");
        } else if over > 2.0e-5 + 20.0 * off {
            air += 1;
            assert!(
                distance > 0.0,
                "{name}: {p} is inside, {over} off the parts"
            );
        }
    }
    assert!(solid > 1_000 && air > 3_000, "{solid} {air}");
}

/// Blocks that touch share the edges of their common faces: four triangles and more meet at one.
#[test]
fn rings_of_blocks_that_touch_are_exact() {
    for (blocks, has_bar) in [(8, true), (16, true), (20, false)] {
        let parts = ring(blocks, has_bar, 0.0, &mut Random(1));
        assert_exact("a ring", &parts, 0.0, &mut Random(3));
    }
}

/// Between blocks that are off by a ten-thousandth there are cracks, steps and overlaps. Some of their faces are nearly
/// in one plane.
#[test]
fn rings_of_blocks_with_cracks_are_exact() {
    for (blocks, apart, seed) in [(8, 3.0e-5, 5), (16, 1.0e-4, 6), (16, 3.0e-4, 7)] {
        let parts = ring(blocks, true, apart, &mut Random(seed));
        assert_exact("a ring with cracks", &parts, 0.0, &mut Random(3));
    }
}

/// Corners that a file of few decimals leaves up to a 25,000th off their places.
#[test]
fn kits_rounded_by_their_file_are_exact() {
    for off in [1.0e-5, 4.0e-5] {
        let ring = ring(8, true, 0.0, &mut Random(1));
        for (name, parts) in [
            ("a shelf", shelf([0.15, 0.16])),
            ("steps", steps()),
            ("a ring", ring),
        ] {
            assert_exact(name, &parts, off, &mut Random(5));
        }
    }
}

/// Corners farther off: cracks between the parts are as wide as those are off.
#[test]
fn kits_with_uneven_corners_are_nearly_exact() {
    let rings =
        [1.0e-4, 3.0e-4, 6.0e-4].map(|off| ("a ring", ring(8, true, 0.0, &mut Random(1)), off));
    let others = [1.0e-4, 3.0e-4].into_iter().flat_map(|off| {
        [
            ("a shelf", shelf([0.15, 0.16]), off),
            ("steps", steps(), off),
        ]
    });
    for (name, parts, off) in rings.into_iter().chain(others) {
        assert_exact(name, &parts, off, &mut Random(5));
    }
}

/// Two towers on a plate with a slit between them, too narrow for so few primitives. Its walls are as deep inside the
/// result as the error says, or less: cracks that a fit fills count with their depth.
#[test]
fn slits_that_a_fit_fills_count_in_its_error() {
    let slit = 0.0025;
    let tower = |x: f64| block([x, -0.15, -0.3], [x + 0.2, 0.15, 0.4]);
    let plate = block([-0.3, -0.2, -0.4], [0.3, 0.2, -0.29]);
    let parts = [tower(-0.2 - 0.5 * slit), tower(0.5 * slit), plate];
    let off = 6.0e-4;
    let all = parts.iter().map(Part::mesh).reduce(Mesh::and);
    let mut mesh = all.expect("parts");
    let mut random = Random(5);
    for p in &mut mesh.vertices {
        *p += random.vector(off);
    }
    let options = BuildOptions {
        quality: Quality::Fast,
        primitives: Some(40),
        ..Default::default()
    };
    let (medial, report) =
        MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options).expect("towers");
    assert_ne!(report.variant, Variant::Exact);
    let error = report.hausdorff.error();
    let mut deepest = 0.0f32;
    for _ in 0..2_000 {
        let p = [random.within(-0.15, 0.15), random.within(-0.28, 0.4)];
        let p = Vector::new(0.5 * slit as f32, p[0] as f32, p[1] as f32);
        deepest = deepest.max(-solid_distance(&medial, p));
    }
    println!("error {error}, {deepest} deep");
    let rounding = 2.0 * off as f32;
    assert!(deepest <= 1.05 * error + rounding, "{deepest} {error}");
}

/// The medial axis of thin boards with knobs and round legs fits badly when edges are collapsed in the order of their
/// quadric error, with 20 primitives as with 200: it is not that more gain nothing, as for a ring.
#[test]
fn a_shelf_with_knobs_is_fitted_with_the_primitives_it_may_have() {
    let at = |mesh: Mesh, to: [f32; 3]| Mesh {
        vertices: mesh
            .vertices
            .iter()
            .map(|p| *p + Vector::from(to))
            .collect(),
        ..mesh
    };
    let knobs = [[-0.2, -0.14, 0.3], [0.1, -0.14, -0.2], [0.15, -0.14, 0.1]];
    let legs = [-0.27, 0.27].map(|x| at(capsule(0.05, 0.03, 12, 4), [x, 0.0, -0.53]));
    let sides = [-0.3, 0.3].map(|x| block([x - 0.011, -0.15, -0.5], [x + 0.011, 0.15, 0.5]));
    let boards =
        [-0.48, 0.0, 0.48].map(|z| block([-0.3, -0.14, z - 0.011], [0.3, 0.14, z + 0.011]));
    let back = block([-0.3, 0.129, -0.5], [0.3, 0.151, 0.5]);
    let parts = sides.into_iter().chain(boards).chain([back]);
    let shelf = parts
        .map(|part| part.mesh())
        .chain(knobs.map(|to| at(capsule(0.001, 0.03, 12, 4), to)))
        .chain(legs)
        .reduce(Mesh::and)
        .expect("parts");
    let options = BuildOptions {
        primitives: Some(200),
        ..Default::default()
    };
    let (_, report) = MedialMesh::from_trimesh(&shelf.vertices, &shelf.indices, &options)
        .expect("a shelf with knobs");
    let error = report.hausdorff.error();
    assert!(report.primitives > 100, "{report:?}");
    assert!(error < 0.05, "{error}");
}

/// Samples are one and a half to three thicknesses of these backs apart: hardly a ball between their faces has a
/// neighbour. Faces are too uneven for pieces.
#[test]
fn thin_backs_of_kits_are_kept() {
    for thickness in [0.008, 0.01, 0.012] {
        let parts = shelf([0.17, 0.17 + thickness]);
        let mut random = Random(5);
        let (medial, report) = build(&parts, Rotation::IDENTITY, 1.0e-3, &mut random);
        println!("{thickness}: error {}", report.hausdorff.error());
        assert_ne!(report.variant, Variant::Exact);
        let (mut solid, mut air) = (0, 0);
        for _ in 0..40_000 {
            let p = [0.35, 0.2, 0.55].map(|half| random.within(-half, half) as f32);
            let p = Vector::from(p);
            let over = height_over(&parts, p);
            let distance = solid_distance(&medial, p);
            if over < -2.5e-3 {
                solid += 1;
                assert!(distance < 0.0, "{thickness}: {p} is left out");
            } else if over > 0.1 {
                air += 1;
                assert!(distance > 0.0, "{thickness}: {p} is inside");
            }
        }
        assert!(solid > 500 && air > 1_000, "{solid} {air}");
    }
}
