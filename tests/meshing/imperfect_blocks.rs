//! Blocks of flat faces as modellers leave them: with edges cut on one side only, with vertices a little off, and far
//! from the origin. Inside and outside are known in `f64` from the grid that they were made from.

use crate::blocks::{Grid, Placed, built};
use crate::meshes::Mesh;
use crate::oracle::Random;
use parry3d::math::Vector;
use rapier3d_medial::Quality;
use rapier3d_medial::meshing::Variant;

const BLOCKS: usize = 8;

/// Blocks that `spoil` leaves off by at most `off` (longest side 1) are exact within `20 off`, or 1e-5: points farther
/// than twice that from the boundary are inside or outside as the grid says.
fn stay_exact(seed: u64, off: f64, spoil: impl Fn(&mut Random, &Placed, Mesh) -> Mesh) {
    let mut random = Random(seed);
    for k in 0..BLOCKS {
        let grid = Grid::random(&mut random, [[3, 3, 1], [3, 2, 2]][k % 2]);
        let mut placed = Placed::random(&mut random, k % 3 == 0);
        let mut side = grid.mesh(|p| placed.at(p)).longest_side();
        // Where the block is to be far away, its own place would be lost among the digits.
        placed.offset = random.vector(f64::from(side));
        let mesh = spoil(&mut random, &placed, grid.mesh(|p| placed.at(p)));
        side = mesh.longest_side();
        let (medial, report) = built(&mesh, Quality::Fast);
        assert_eq!(report.variant, Variant::Exact, "block {k}: {report:?}");
        let close = (20.0 * off).max(1e-5) as f32 * side;
        assert!(report.hausdorff.error() <= close, "block {k}: {report:?}");
        assert_eq!(report.hausdorff.uncovered, 0.0, "block {k}: {report:?}");
        let moved = mesh.vertices[0] - grid.mesh(|p| placed.at(p)).vertices[0];
        let [lo, hi] = [0, 1].map(|end| {
            [0, 1, 2].map(|k| {
                let line = &grid.lines[k];
                line[end * (line.len() - 1)]
            })
        });
        let mut judged = 0;
        for _ in 0..1_000 {
            let p = [0, 1, 2].map(|k| {
                let part = 1.2 * random.within(0.0, 1.0) - 0.1;
                lo[k] + (hi[k] - lo[k]) * part
            });
            if grid.distance(p) * placed.scale < 2.0 * f64::from(close) {
                continue;
            }
            judged += 1;
            let inside = crate::solid_distance(&medial, placed.at(p) + moved) < 0.0;
            assert_eq!(inside, grid.holds(p), "block {k} at {p:?}");
        }
        assert!(judged > 900, "{judged}");
    }
}

/// Cuts every third triangle at an edge, at a vertex of its own: T-junctions, and edges cut twice.
#[test]
fn blocks_with_edges_cut_on_one_side_are_exact() {
    stay_exact(7, 0.0, |random, _, mesh| {
        let Mesh {
            mut vertices,
            indices,
        } = mesh;
        let mut cut = Vec::new();
        for (k, [a, b, c]) in indices.into_iter().enumerate() {
            if k % 3 > 0 {
                cut.push([a, b, c]);
                continue;
            }
            let middle = vertices.len() as u32;
            let at = random.within(0.2, 0.8) as f32;
            let [from, to] = [a, b].map(|v| vertices[v as usize]);
            vertices.push(from + (to - from) * at);
            cut.extend([[a, middle, c], [middle, b, c]]);
        }
        Mesh {
            vertices,
            indices: cut,
        }
    });
}

#[test]
fn blocks_with_vertices_off_by_a_millionth_are_exact() {
    stay_exact(11, 2e-6, |random, _, mut mesh| {
        let by = 1e-6 * mesh.longest_side();
        for v in &mut mesh.vertices[1..] {
            *v += random.vector(1.0) * by;
        }
        mesh
    });
}

/// Blocks of 5 cm, their places in metres rounded to six decimals, as files have them.
#[test]
fn blocks_rounded_by_their_file_are_exact() {
    stay_exact(17, 2e-5, |_, _, mesh| {
        let scale = 0.05 / mesh.longest_side();
        let rounded = |x: f32| ((f64::from(x * scale) * 1e6).round() * 1e-6) as f32 / scale;
        mesh.map(|v| Vector::new(rounded(v.x), rounded(v.y), rounded(v.z)))
    });
}

/// A hundred sizes away coordinates are rounded to some millionths of the size.
#[test]
fn blocks_far_from_the_origin_are_exact() {
    let far = 100.0;
    let rounding = 0.5 * f64::from(f32::EPSILON) * (far + 2.0);
    stay_exact(13, rounding, |_, _, mesh| {
        let side = mesh.longest_side();
        let way = Vector::new(0.6, -0.64, 0.48) * (far as f32 * side);
        mesh.map(|v| v + way)
    });
}
