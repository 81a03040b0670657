//! How long until a mesh of 5,000 slabs can be queried: read as text and prepared, or baked before.
//!
//! `cargo bench --bench loading`. Prints medians of interleaved repetitions in ms, and ratios. Mass
//! properties count, as rapier asks for them when the collider is inserted; so does parry's tree of boxes,
//! which is built when the mesh first meets another shape, on a line of its own.

mod common;

use common::{Hash, median, processor};
use rapier3d::math::Vector;
use rapier3d_medial::{MedialMesh, MedialSphere};
use std::hint::black_box;
use std::time::Instant;

/// Squares along a side of the sheet, of two slabs each.
const SQUARES: u32 = 50;

const REPETITIONS: usize = 20;

/// A wavy sheet.
fn sheet() -> MedialMesh {
    let along = SQUARES + 1;
    let sphere = |i: u32| {
        let (x, z) = ((i % along) as f32 / 50.0, (i / along) as f32 / 50.0);
        let y = 0.3 * (x * 5.0).sin() * (z * 4.0).cos();
        MedialSphere::new(Vector::new(x, y, z), 0.02 + 0.01 * (x * 9.0).sin().abs())
    };
    let square = |k: u32| {
        let a = k / SQUARES * along + k % SQUARES;
        [[a, a + 1, a + along], [a + 1, a + along + 1, a + along]]
    };
    let spheres = (0..along * along).map(sphere).collect();
    let faces = (0..SQUARES * SQUARES).flat_map(square).collect();
    MedialMesh::new(spheres, vec![], faces).expect("a sheet")
}

fn milliseconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64() * 1.0e3
}

fn main() {
    println!("{}", processor());
    let mesh = sheet();
    let (mut text, directory) = (Vec::new(), std::env::temp_dir());
    mesh.write_ma(&mut text).expect("written");
    let [ma, baked] = ["ma", "medial"].map(|e| directory.join(format!("loading_bench.{e}")));
    mesh.save_ma(&ma).expect("written");
    let bake = milliseconds(|| mesh.save_asset(&baked).expect("written"));
    let bytes = mesh.to_bytes();
    let mut times: [Vec<f64>; 4] = Default::default();
    for _ in 0..REPETITIONS {
        times[0].push(milliseconds(|| {
            black_box(MedialMesh::load_ma(&ma).expect("a mesh"));
        }));
        times[1].push(milliseconds(|| {
            black_box(
                MedialMesh::load_asset(&baked)
                    .expect("a mesh")
                    .mass_properties(1.0),
            );
        }));
        times[2].push(milliseconds(|| {
            black_box(
                MedialMesh::from_bytes(&bytes)
                    .expect("a mesh")
                    .mass_properties(1.0),
            );
        }));
        let fresh = MedialMesh::from_bytes(&bytes).expect("a mesh");
        times[3].push(milliseconds(|| {
            black_box(fresh.bvh());
        }));
    }
    let [prepared, loaded, memory, boxes] = times.map(|mut t| median(&mut t));
    let mass = milliseconds(|| {
        let fresh = MedialMesh::load_ma(&ma).expect("a mesh");
        black_box(fresh.mass_properties(1.0));
    }) - prepared;
    for path in [ma, baked] {
        // A leftover in the directory for temporary files does no harm.
        let _ = std::fs::remove_file(path);
    }
    let mut hash = Hash::new();
    bytes.iter().for_each(|b| hash.add(u64::from(*b)));
    println!(
        "{} primitives, hash of the asset {}",
        mesh.primitive_count(),
        hash.short()
    );
    println!(
        "text {} kB, baked {} kB",
        text.len() / 1000,
        bytes.len() / 1000
    );
    println!("load_ma, trees and all      {prepared:9.3} ms");
    println!("mass properties of the solid {mass:8.3} ms");
    println!("baking, mass and writing    {bake:9.3} ms");
    println!("load_asset                  {loaded:9.3} ms");
    println!("from_bytes                  {memory:9.3} ms");
    println!("first use of parry's boxes  {boxes:9.3} ms");
    println!("load_ma / load_asset        {:9.0}", prepared / loaded);
    println!(
        "and with mass properties    {:9.0}",
        (prepared + mass) / loaded
    );
}
