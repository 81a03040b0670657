//! Baked meshes: they come back bit by bit, and what is cut, damaged, forged or random is refused by name.

use crate::oracle::random_mesh;
use proptest::prelude::*;
use rapier3d_medial::math::{Pose, Vector};
use rapier3d_medial::medial::asset::{MAGIC, VERSION};
use rapier3d_medial::medial::tree::Node;
use rapier3d_medial::pair::{contacts, nearest_spheres};
use rapier3d_medial::{AssetError, MedialMesh, MedialSphere, MeshError};
use std::fs;
use std::path::{Path, PathBuf};

pub fn meshes() -> Vec<MedialMesh> {
    let lone = |x: f32| MedialSphere::new(Vector::new(x, 0.5, -0.0), 0.25);
    let source = MedialMesh::capsule(Vector::ZERO, Vector::X, 0.5).unwrap();
    let mut meshes = vec![
        MedialMesh::ball(0.7).unwrap(),
        MedialMesh::torus(1.0, 0.2, 12).unwrap(),
        MedialMesh::cuboid(Vector::new(0.5, 0.3, 0.2)).unwrap(),
        MedialMesh::new(vec![lone(0.0), lone(1.0), lone(3.0)], vec![], vec![]).unwrap(),
        random_mesh(3).with_mass_properties(source.mass_properties(1.0)),
    ];
    meshes.extend((0..5).map(random_mesh));
    meshes
}

/// All there is to a mesh, as bits.
pub fn bits(mesh: &MedialMesh) -> Vec<u32> {
    let sphere = |c: Vector, r: f32| [c.x, c.y, c.z, r].map(f32::to_bits);
    let mass = |density: f32| {
        let m = mesh.mass_properties(density);
        let (c, i, q) = (
            m.local_com,
            m.inv_principal_inertia,
            m.principal_inertia_local_frame,
        );
        [
            c.x,
            c.y,
            c.z,
            m.inv_mass,
            i.x,
            i.y,
            i.z,
            q.x,
            q.y,
            q.z,
            q.w,
            mesh.volume(),
        ]
    };
    let aabb = mesh.aabb();
    let mut all = Vec::new();
    all.extend(
        mesh.spheres()
            .iter()
            .flat_map(|s| sphere(s.center, s.radius)),
    );
    all.extend(mesh.edges().iter().flatten());
    all.extend(mesh.faces().iter().flatten());
    for s in mesh.simplices() {
        all.extend(s.vertices);
        all.extend([s.len, s.owns_vertex, s.owns_edge].map(u32::from));
    }
    for node in mesh.tree().nodes() {
        all.extend(sphere(node.center, node.radius));
        let below = format!("{:?}", Node::kind(node));
        all.extend(below.bytes().map(u32::from));
    }
    all.extend(mass(1.0).map(f32::to_bits));
    all.extend(sphere(aabb.mins, mesh.thickness()));
    all.extend(sphere(aabb.maxs, 0.0));
    all
}

fn scratch(name: &str) -> PathBuf {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("asset-{name}"));
    // What an earlier run left would hide what this one does.
    let _ = fs::remove_dir_all(&directory);
    fs::create_dir_all(&directory).unwrap();
    directory
}

#[test]
fn a_baked_mesh_comes_back_bit_by_bit() {
    let directory = scratch("round-trip");
    let path = directory.join("mesh.medial");
    for mesh in meshes() {
        let again = MedialMesh::from_bytes(&mesh.to_bytes()).unwrap();
        assert_eq!(bits(&again), bits(&mesh));
        assert_ne!(again.instance_id(), mesh.instance_id());
        assert_eq!(again.to_bytes(), mesh.to_bytes());
        mesh.save_asset(&path).unwrap();
        let loaded = MedialMesh::load_asset(&path).unwrap();
        assert_eq!(bits(&loaded), bits(&mesh));
        // It answers as the original does.
        let at = Pose::translation(0.3, 0.1, 0.2);
        let found = |m: &MedialMesh| contacts(m, m, &at, 0.1).0;
        assert_eq!(found(&loaded), found(&mesh));
        assert_eq!(loaded.bvh().leaf_count(), mesh.bvh().leaf_count());
    }
    let names: Vec<_> = fs::read_dir(&directory)
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    assert_eq!(names, ["mesh.medial"], "nothing is left beside the file");
}

#[test]
fn every_cut_and_every_changed_byte_is_refused() {
    for mesh in [MedialMesh::ball(0.7).unwrap(), random_mesh(1)] {
        let good = mesh.to_bytes();
        for length in 0..good.len() {
            let error = MedialMesh::from_bytes(&good[..length]).expect_err("cut");
            let named = match error {
                AssetError::NotAnAsset { start } => length < 8 && start == good[..length],
                AssetError::Length { needed, found } => {
                    found == length as u64 && needed > found && length >= 8
                }
                _ => false,
            };
            assert!(named, "cut to {length}");
        }
        let mut longer = good.clone();
        longer.push(0);
        let refused = MedialMesh::from_bytes(&longer);
        assert!(matches!(refused, Err(AssetError::Length { .. })));
        for at in 0..good.len() {
            for change in [1, 0x80, 0xff, 0x55] {
                let mut bad = good.clone();
                bad[at] ^= change;
                let error = MedialMesh::from_bytes(&bad).expect_err("changed");
                let named = match at {
                    0..8 => matches!(error, AssetError::NotAnAsset { .. }),
                    8..12 => matches!(error, AssetError::Version { reads: VERSION, .. }),
                    16..32 => matches!(error, AssetError::Length { .. }),
                    _ => matches!(error, AssetError::Damaged { .. }),
                };
                assert!(named, "byte {at} changed by {change}: {error}");
            }
        }
    }
}

/// A header that claims billions is told from the bytes that are there, before any memory is asked for.
#[test]
fn absurd_counts_are_refused() {
    let good = MedialMesh::ball(0.7).unwrap().to_bytes();
    for at in [16, 20, 24, 28] {
        let mut bad = good.clone();
        bad[at..at + 4].copy_from_slice(&u32::MAX.to_le_bytes());
        let error = MedialMesh::from_bytes(&bad)
            .expect_err("absurd")
            .to_string();
        assert!(error.contains("by its counts"), "{error}");
        let path = scratch("absurd").join("mesh.medial");
        fs::write(&path, &bad).unwrap();
        let error = MedialMesh::load_asset(&path)
            .expect_err("absurd")
            .to_string();
        assert!(
            error.contains("mesh.medial") && error.contains("by its counts"),
            "{error}"
        );
    }
}

#[test]
fn other_files_and_versions_are_named() {
    let directory = scratch("other");
    let path = directory.join("other.medial");
    let mut newer = MedialMesh::ball(0.7).unwrap().to_bytes();
    newer[8] = 7;
    let cases: [(&[u8], &str); 5] = [
        (b"", "not a baked medial mesh"),
        (b"2 1 0\nv 0 0 0 1\n", "not a baked medial mesh"),
        (b"\x89medial\r\n", "not a baked medial mesh"),
        (
            &newer,
            "version 7 of the format, this crate reads version 2",
        ),
        (&MAGIC, "8 bytes"),
    ];
    for (bytes, words) in cases {
        fs::write(&path, bytes).unwrap();
        let error = MedialMesh::load_asset(&path).expect_err("refused");
        assert!(matches!(error, MeshError::Asset { .. }));
        let message = error.to_string();
        assert!(
            message.contains("other.medial") && message.contains(words),
            "{message}"
        );
    }
    for path in [directory.join("missing.medial"), directory.clone()] {
        let error = MedialMesh::load_asset(&path).expect_err("no file");
        assert!(matches!(error, MeshError::File { .. }), "{error}");
    }
    let nowhere = directory.join("no/such/mesh.medial");
    assert!(matches!(
        MedialMesh::ball(1.0).unwrap().save_asset(nowhere),
        Err(MeshError::File { .. })
    ));
}

/// The checksum of the format, from its description, to forge files with.
pub fn seal(bytes: &mut [u8]) {
    let end = bytes.len() - 8;
    let mut hash = end as u64;
    let whole = end / 8 * 8;
    let mut last = [0; 8];
    last[..end - whole].copy_from_slice(&bytes[whole..end]);
    let words = bytes[..whole]
        .chunks_exact(8)
        .map(|c| c.try_into().unwrap());
    for word in words.chain([last]) {
        let mut spread = u64::from_le_bytes(word).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
        spread = spread.rotate_left(31).wrapping_mul(0x9e37_79b1_85eb_ca87);
        hash = (hash ^ spread).rotate_left(27);
        hash = hash.wrapping_mul(0x9e37_79b1_85eb_ca87);
        hash = hash.wrapping_add(0x85eb_ca77_c2b2_ae63);
    }
    bytes[end..].copy_from_slice(&hash.to_le_bytes());
}

/// Uses all of a mesh that a hostile file was taken for.
pub fn walk(mesh: &MedialMesh) {
    let near = Pose::translation(0.1, 0.05, 0.02);
    contacts(mesh, mesh, &near, 0.1);
    nearest_spheres(mesh, mesh, &near, f32::MAX);
    assert!(mesh.thickness() >= 0.0);
    let _ = mesh.mass_properties(2.0);
    let _ = mesh.to_bytes();
}

/// Each word of a file in turn set to awkward values, under a good checksum: refused with the item's name,
/// or a mesh whose queries end.
#[test]
fn forged_words_are_refused_or_harmless() {
    let awkward = [
        0,
        1,
        2,
        3,
        5,
        6,
        7,
        0xff,
        0x0103,
        0x8000_0000,
        u32::MAX,
        0x0707_0707,
        f32::NAN.to_bits(),
        f32::INFINITY.to_bits(),
        (-1.0_f32).to_bits(),
        f32::MAX.to_bits(),
    ];
    let (mut refused, mut taken) = (0, 0);
    for mesh in [
        MedialMesh::ball(0.7).unwrap(),
        random_mesh(1),
        meshes().swap_remove(3),
    ] {
        let good = mesh.to_bytes();
        for at in (12..good.len() - 8).step_by(4) {
            for value in awkward {
                let mut bad = good.clone();
                bad[at..at + 4].copy_from_slice(&value.to_le_bytes());
                seal(&mut bad);
                match MedialMesh::from_bytes(&bad) {
                    Ok(mesh) => {
                        taken += 1;
                        walk(&mesh);
                    }
                    Err(AssetError::Damaged { .. }) => panic!("the seal is not that of the format"),
                    Err(error) => {
                        refused += 1;
                        assert!(!error.to_string().is_empty());
                    }
                }
            }
        }
    }
    assert!(
        refused > 500 && taken > 500,
        "{refused} refused, {taken} taken"
    );
}

/// What of a forged file is told, and how.
#[test]
fn forged_items_are_named() {
    // 2 spheres, 1 edge, 1 primitive, 1 node.
    let good = MedialMesh::capsule(Vector::ZERO, Vector::X, 0.5)
        .unwrap()
        .to_bytes();
    let nan = f32::NAN.to_bits();
    let cases: [(usize, u32, &str); 13] = [
        (12, 4, "header word 3 is 4"),
        (32, nan, "thickness 0 is NaN"),
        (36, nan, "mass properties 0"),
        (48, (-1.0_f32).to_bits(), "mass properties 0"),
        (76, 2.0_f32.to_bits(), "mass properties 0"),
        (128, nan, "sphere 0 is not finite"),
        (156, (-2.0_f32).to_bits(), "sphere 1 has negative radius -2"),
        (160, 9, "edge 0 names sphere 9"),
        (160, 1, "edge 0 names sphere 1 twice"),
        (168, 1, "primitive 0"),
        (180, 0x0001_0302 + 0x0001_0000, "primitive 0"),
        (180, 0x0001_0102, "sphere 1 is in no primitive"),
        (200, 3, "node 0"),
    ];
    for (at, value, words) in cases {
        let mut bad = good.clone();
        bad[at..at + 4].copy_from_slice(&value.to_le_bytes());
        seal(&mut bad);
        let message = MedialMesh::from_bytes(&bad).expect_err(words).to_string();
        assert!(message.contains(words), "{at}: {message:?} lacks {words:?}");
    }
}

/// Trees that go round, go back, or reach a primitive twice would not end, or not see all.
#[test]
fn forged_trees_are_refused() {
    let mesh = MedialMesh::tube(
        &[0.0, 1.0, 2.0].map(|x| MedialSphere::new(Vector::X * x, 0.2)),
        false,
    );
    let good = mesh.unwrap().to_bytes();
    // 3 spheres, 2 edges, 2 primitives: nodes from byte 224, index in their fifth word.
    let index = |node: usize| 128 + 3 * 16 + 2 * 8 + 2 * 16 + node * 20 + 16;
    let set = |values: [u32; 3]| {
        let mut bad = good.clone();
        for (node, value) in values.into_iter().enumerate() {
            bad[index(node)..index(node) + 4].copy_from_slice(&value.to_le_bytes());
        }
        seal(&mut bad);
        MedialMesh::from_bytes(&bad)
    };
    let leaf = |primitive: u32| primitive << 1 | 1;
    assert!(set([1 << 1, leaf(0), leaf(1)]).is_ok());
    assert!(set([1 << 1, leaf(1), leaf(0)]).is_ok());
    for bad in [
        [0, leaf(0), leaf(1)],
        [1 << 1, 0, leaf(1)],
        [1 << 1, 1 << 1, leaf(1)],
        [1 << 1, leaf(0), leaf(0)],
        [1 << 1, leaf(0), leaf(2)],
        [2 << 1, leaf(0), leaf(1)],
        [leaf(0), leaf(1), 1 << 1],
        [u32::MAX - 1, leaf(0), leaf(1)],
    ] {
        let error = set(bad).expect_err("a forged tree").to_string();
        assert!(error.starts_with("node "), "{bad:?}: {error}");
    }
}

/// A tree that splits off one primitive at a time is as deep as it has primitives: what goes down it recursively would
/// need a stack without end.
#[test]
fn forged_trees_that_are_too_deep_are_refused() {
    let comb = |count: usize| {
        let spheres = (0..count).map(|k| MedialSphere::new(Vector::X * k as f32, 0.2));
        let mesh = MedialMesh::new(spheres.collect(), vec![], vec![]).expect("spheres");
        let mut bytes = mesh.to_bytes();
        for node in 0..2 * count - 1 {
            let word = match node % 2 {
                0 if node + 1 < 2 * count - 1 => (node as u32 + 1) << 1,
                _ => ((node as u32 / 2) << 1) | 1,
            };
            let at = 128 + count * 32 + node * 20 + 16;
            bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        }
        seal(&mut bytes);
        MedialMesh::from_bytes(&bytes)
    };
    assert!(comb(190).is_ok());
    let error = comb(300).expect_err("a comb").to_string();
    assert!(error.starts_with("node "), "{error}");
}

proptest! {
    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        prop_assert!(MedialMesh::from_bytes(&bytes).is_err());
        let mut headed = [&MAGIC[..], &VERSION.to_le_bytes(), &bytes].concat();
        prop_assert!(MedialMesh::from_bytes(&headed).is_err());
        if headed.len() >= 16 {
            seal(&mut headed);
            let _ = MedialMesh::from_bytes(&headed);
        }
    }

    /// Random words in place of random words, sealed: refused, or every query ends.
    #[test]
    fn random_forgeries_never_panic(
        seed in 0u64..5,
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0u32..12), 1..4),
    ) {
        let mut bytes = random_mesh(seed).to_bytes();
        let words = bytes.len() / 4 - 2;
        for (at, value) in changes {
            let at = 4 * (32 + at.index(words - 32));
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        }
        seal(&mut bytes);
        if let Ok(mesh) = MedialMesh::from_bytes(&bytes) {
            walk(&mesh);
        }
    }
}
