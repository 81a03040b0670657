//! The targets, and what each must hold besides ending.

use super::mutate::{Rng, broken};
use super::queries;
use crate::asset::{meshes, seal, walk};
use crate::mesh_file::{assert_valid, good_files, load};
use rapier3d_medial::MedialMesh;
use rapier3d_medial::meshing::mesh_file::MeshFormat;
use std::path::Path;
use std::sync::LazyLock;

type Target = (&'static str, fn(&mut Rng));

pub const TARGETS: &[Target] = &[
    ("obj", |rng| mesh_file(rng, MeshFormat::Obj)),
    ("stl", |rng| mesh_file(rng, MeshFormat::Stl)),
    ("ply", |rng| mesh_file(rng, MeshFormat::Ply)),
    ("off", |rng| mesh_file(rng, MeshFormat::Off)),
    #[cfg(feature = "gltf")]
    ("glb", |rng| mesh_file(rng, MeshFormat::Gltf)),
    ("ma", ma),
    ("asset", asset),
    ("new", queries::new),
    ("elementary", queries::elementary),
    ("pairs", queries::pairs),
    ("shapes", queries::shapes),
    #[cfg(feature = "serde")]
    ("json", json),
    #[cfg(feature = "serde-serialize")]
    ("world", worlds::damaged),
    #[cfg(feature = "serde-serialize")]
    ("forged world", worlds::forged),
];

static FILES: LazyLock<Vec<(MeshFormat, Vec<u8>)>> =
    LazyLock::new(|| good_files().into_iter().map(|f| (f.2, f.1)).collect());
static MESHES: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let baked = meshes().into_iter().map(|m| m.to_bytes());
    baked.collect()
});
static MA: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let text = |m: MedialMesh| {
        let mut text = Vec::new();
        m.write_ma(&mut text).expect("memory takes it");
        text
    };
    meshes().into_iter().map(text).collect()
});

fn mesh_file(rng: &mut Rng, format: MeshFormat) {
    let own = FILES.iter().filter(|f| f.0 == format);
    let own: Vec<_> = own.map(|f| f.1.clone()).collect();
    let bytes = broken(rng, &own);
    if let Ok(mesh) = load(&bytes, format) {
        assert_valid(&mesh);
        // Nothing is made up: each corner takes some bytes.
        assert!(mesh.vertices.len() + mesh.indices.len() <= bytes.len());
    }
}

fn ma(rng: &mut Rng) {
    let bytes = broken(rng, &MA);
    if let Ok(mesh) = MedialMesh::read_ma(&bytes[..], Path::new("given")) {
        let mut text = Vec::new();
        mesh.write_ma(&mut text).expect("memory takes it");
        let again = MedialMesh::read_ma(&text[..], Path::new("again")).expect("what was written");
        assert_eq!(mesh.primitive_count(), again.primitive_count());
    }
}

/// Damaged ones are refused; forged ones, of a good checksum, are refused or harmless.
fn asset(rng: &mut Rng) {
    let mut bytes = broken(rng, &MESHES);
    if MedialMesh::from_bytes(&bytes).is_ok() {
        assert!(MESHES.contains(&bytes), "damage goes unnoticed");
    }
    if bytes.len() > 8 {
        seal(&mut bytes);
        if let Ok(mesh) = MedialMesh::from_bytes(&bytes) {
            walk(&mesh);
            let again = MedialMesh::from_bytes(&mesh.to_bytes()).expect("what was baked");
            assert_eq!(mesh.primitive_count(), again.primitive_count());
        }
    }
}

#[cfg(feature = "serde")]
fn json(rng: &mut Rng) {
    static JSON: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
        let text = |m: &MedialMesh| serde_json::to_vec(m).expect("JSON holds it");
        meshes().iter().map(text).collect()
    });
    let bytes = broken(rng, &JSON);
    if let Ok(mesh) = serde_json::from_slice::<MedialMesh>(&bytes) {
        assert!(mesh.primitive_count() > 0 && mesh.aabb().mins.is_finite());
    }
}

#[cfg(feature = "serde-serialize")]
mod worlds {
    use super::{Rng, broken};
    use rapier3d::prelude::*;
    use rapier3d_medial::prelude::*;
    use rapier3d_medial::rapier::{SavedWorld, load_world, save_world};
    use std::sync::LazyLock;

    fn world(bodies: usize) -> PhysicsWorld {
        let mut world = PhysicsWorld::new();
        let mut pipeline = MedialPipeline::new(MedialOptions::default());
        pipeline.attach(&mut world);
        world.insert_collider(ColliderBuilder::cuboid(9.0, 0.1, 9.0), None);
        let mesh = MedialMesh::torus(0.5, 0.1, 9).expect("a torus");
        for i in 0..bodies {
            let body =
                RigidBodyBuilder::dynamic().translation(Vector::Y * (0.15 * i as Real + 0.2));
            let collider = match i % 3 {
                0 => ColliderBuilder::ball(0.2),
                _ => ColliderBuilder::medial_mesh(mesh.clone()),
            };
            world.insert(body, collider);
        }
        for _ in 0..5 {
            pipeline.step(&mut world);
        }
        world
    }

    /// Any byte changed is refused.
    pub fn damaged(rng: &mut Rng) {
        static SAVED: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
            [0, 1, 4]
                .map(|n| save_world(&world(n)).expect("a world"))
                .to_vec()
        });
        let bytes = broken(rng, &SAVED);
        if load_world(&bytes).is_ok() {
            assert!(SAVED.contains(&bytes), "damage goes unnoticed");
        }
    }

    /// Past the checksum it is for rapier's own types to read. What they read may still contradict itself
    /// and trip rapier's own assertions in its first step, with any world: `into_world` is not asked.
    pub fn forged(rng: &mut Rng) {
        static WRITTEN: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
            let write = |n| {
                let saved = SavedWorld::new(&world(n)).expect("a world");
                postcard::to_stdvec(&saved).expect("written")
            };
            [0, 1, 4].map(write).to_vec()
        });
        let bytes = broken(rng, &WRITTEN);
        drop(postcard::from_bytes::<SavedWorld>(&bytes));
    }
}
