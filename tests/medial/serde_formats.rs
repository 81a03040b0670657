//! Meshes through serde: JSON, and a binary format.

use crate::asset::{bits, meshes};
use rapier3d_medial::MedialMesh;

#[test]
fn a_mesh_goes_through_serde_bit_by_bit() {
    for mesh in meshes() {
        let text = serde_json::to_string(&mesh).unwrap();
        let again: MedialMesh = serde_json::from_str(&text).unwrap();
        assert_eq!(bits(&again), bits(&mesh), "JSON");
        let bytes = postcard::to_allocvec(&mesh).unwrap();
        let again: MedialMesh = postcard::from_bytes(&bytes).unwrap();
        assert_eq!(bits(&again), bits(&mesh), "postcard");
    }
}

#[test]
fn serde_refuses_what_is_no_mesh() {
    let cases = [
        (r#"{"spheres":[]}"#, "at least one sphere"),
        (
            r#"{"spheres":[[0,0,0,-1]]}"#,
            "sphere 0 has negative radius -1",
        ),
        (
            r#"{"spheres":[[0,0,0,1]],"edges":[[0,4]]}"#,
            "edge 0 names sphere 4",
        ),
        (r#"{"spheres":[[0,0,0]]}"#, "length 3"),
        (r#"{"spheres":[[0,0,0,1]],"sphere":1}"#, "unknown field"),
        (
            r#"{"spheres":[[0,0,0,1]],"source_mass":[0,0,0,-1,0,0,0,0,0,0,1]}"#,
            "mass properties 1",
        ),
    ];
    for (text, words) in cases {
        let message = serde_json::from_str::<MedialMesh>(text)
            .expect_err(text)
            .to_string();
        assert!(message.contains(words), "{message:?} lacks {words:?}");
    }
    let bytes = postcard::to_allocvec(&MedialMesh::ball(1.0).unwrap()).unwrap();
    for length in 0..bytes.len() {
        assert!(postcard::from_bytes::<MedialMesh>(&bytes[..length]).is_err());
    }
    for at in 0..bytes.len() {
        let mut bad = bytes.clone();
        bad[at] ^= 0x11;
        assert!(
            postcard::from_bytes::<MedialMesh>(&bad).is_err(),
            "byte {at}"
        );
    }
}
