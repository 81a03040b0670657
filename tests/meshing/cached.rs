//! A folder of built meshes: what is in it is loaded, what is not is built and saved.

use crate::meshes::*;
use parry3d::math::Vector;
use rapier3d_medial::{BuildError, BuildOptions, MedialMesh, MeshError};
use std::path::PathBuf;

/// A folder of its own that is not there yet.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("medial_cached_{name}_{}", std::process::id()));
    std::fs::remove_dir_all(&folder).ok();
    folder
}

#[test]
fn a_mesh_is_built_once_for_each_input_and_loaded_from_then_on() {
    let folder = folder("once").join("deeper");
    let options = BuildOptions {
        primitives: Some(30),
        ..Default::default()
    };
    let get = |mesh: &Mesh, options: &BuildOptions| {
        MedialMesh::from_trimesh_cached(&folder, &mesh.vertices, &mesh.indices, options)
            .expect("built or loaded")
    };
    let files = || std::fs::read_dir(&folder).expect("the folder").count();
    let cube = cuboid(Vector::splat(1.0));
    let built = get(&cube, &options);
    let (same, _) =
        MedialMesh::from_trimesh(&cube.vertices, &cube.indices, &options).expect("built");
    assert_eq!(built.to_bytes(), same.to_bytes());
    assert_eq!(get(&cube, &options).to_bytes(), same.to_bytes());
    assert_eq!(files(), 1);

    // That it is loaded, not built: a ball put in its place comes back.
    let entry = std::fs::read_dir(&folder).expect("the folder").next();
    let path = entry.expect("a file").expect("its entry").path();
    let ball = MedialMesh::ball(3.0).expect("a ball");
    ball.save_asset(&path).expect("saved");
    assert_eq!(get(&cube, &options).spheres(), ball.spheres());

    // What is damaged is built again.
    std::fs::write(&path, &same.to_bytes()[..40]).expect("written");
    assert_eq!(get(&cube, &options).to_bytes(), same.to_bytes());
    assert_eq!(std::fs::read(&path).expect("read"), same.to_bytes());

    // Another mesh and other options are other files.
    get(&cuboid(Vector::new(1.0, 1.0, 0.5)), &options);
    let open = BuildOptions {
        enclose: false,
        ..options.clone()
    };
    get(&cube, &open);
    assert_eq!(files(), 3);
    std::fs::remove_dir_all(folder.parent().expect("above it")).expect("removed");
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let folder = folder("file");
    std::fs::write(&folder, "a file, not a folder").expect("written");
    let cube = cuboid(Vector::splat(1.0));
    let options = BuildOptions::default();
    let inside = folder.join("cache");
    let result = MedialMesh::from_trimesh_cached(&inside, &cube.vertices, &cube.indices, &options);
    let Err(BuildError::Mesh(MeshError::File { path, .. })) = result else {
        panic!("no error of a file");
    };
    assert_eq!(path, inside);
    std::fs::remove_file(&folder).expect("removed");
}
