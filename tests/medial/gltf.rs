//! glTF scenes: nodes that move, turn over and repeat a mesh, strips and fans, and scenes that lie.

use crate::mesh_file::{CORNERS, QUADS, load, volume};
use rapier3d_medial::meshing::mesh_file::{MeshFormat, read};

/// The box as positions and triangles of indices of one byte.
fn bytes_of_box() -> Vec<u8> {
    let corners = CORNERS.iter().flatten().flat_map(|c| c.to_le_bytes());
    let split = |[a, b, c, d]: [usize; 4]| [a, b, c, a, c, d];
    let indices = QUADS.into_iter().flat_map(split).map(|i| i as u8);
    corners.chain(indices).collect()
}

/// A binary file with these nodes of the scene; node 0 is its root, mesh 0 the box.
fn glb_with(nodes: &str) -> Vec<u8> {
    glb(nodes, "", 8, 5121, &bytes_of_box())
}

/// A binary file: the mesh has `count` positions at the buffer's start, and behind 8 of them 36 indices of
/// a type; `more` goes into its primitive.
fn glb(nodes: &str, more: &str, count: u64, indices: u32, buffer: &[u8]) -> Vec<u8> {
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{nodes}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1{more}}}]}}],
        "accessors":[
        {{"bufferView":0,"componentType":5126,"count":{count},"type":"VEC3","min":[0,0,0],"max":[1,2,3]}},
        {{"bufferView":1,"componentType":{indices},"count":36,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":96}},{{"buffer":0,"byteOffset":96,"byteLength":36}}],
        "buffers":[{{"byteLength":{}}}]}}"#,
        buffer.len()
    )
    .into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut buffer = buffer.to_vec();
    buffer.resize(buffer.len().next_multiple_of(4), 0);
    let mut file = b"glTF".to_vec();
    let length = 12 + 8 + json.len() + 8 + buffer.len();
    for word in [2, length as u32, json.len() as u32] {
        file.extend(word.to_le_bytes());
    }
    file.extend(b"JSON");
    file.extend(json);
    file.extend((buffer.len() as u32).to_le_bytes());
    file.extend(b"BIN\0");
    file.extend(buffer);
    file
}

/// The box, as it is.
pub fn box_file() -> Vec<u8> {
    glb_with(r#"{"mesh":0}"#)
}

#[test]
fn nodes_move_what_hangs_on_them() {
    // Twice as large, then moved along x: on two nodes.
    let nodes = r#"{"translation":[5,0,0],"children":[1]},{"scale":[2,2,2],"mesh":0}"#;
    let mesh = load(&glb_with(nodes), MeshFormat::Gltf).unwrap();
    let x: Vec<f32> = mesh.vertices.iter().map(|v| v.x).collect();
    assert_eq!(x.iter().copied().fold(f32::MAX, f32::min), 5.0);
    assert_eq!(x.iter().copied().fold(f32::MIN, f32::max), 7.0);
    assert_eq!(volume(&mesh), 48.0);
}

#[test]
fn a_mirrored_node_stays_right_side_out() {
    let mesh = load(
        &glb_with(r#"{"scale":[-1,1,1],"mesh":0}"#),
        MeshFormat::Gltf,
    )
    .unwrap();
    assert_eq!(volume(&mesh), 6.0);
}

#[test]
fn a_mesh_on_two_nodes_is_there_twice() {
    let nodes = r#"{"mesh":0,"children":[1]},{"translation":[0,0,9],"mesh":0}"#;
    let mesh = load(&glb_with(nodes), MeshFormat::Gltf).unwrap();
    assert_eq!((mesh.vertices.len(), mesh.indices.len()), (16, 24));
    assert_eq!(volume(&mesh), 12.0);
}

/// Four corners of a square as a strip and as a fan: two triangles that face the same way.
#[test]
fn strips_and_fans_face_one_way() {
    for (mode, order) in [(5, [0, 1, 3, 2]), (6, [0, 1, 2, 3])] {
        let mut buffer = bytes_of_box();
        buffer.truncate(96);
        buffer.extend(order);
        buffer.resize(132, order[3]);
        let more = format!(r#","mode":{mode}"#);
        let file = glb(r#"{"mesh":0}"#, &more, 8, 5121, &buffer);
        let mesh = load(&file, MeshFormat::Gltf).unwrap();
        assert_eq!(mesh.indices.len(), 2, "mode {mode}");
        for t in mesh.indices {
            let [a, b, c] = t.map(|i| mesh.vertices[i as usize]);
            assert!((b - a).cross(c - a).z > 0.0, "mode {mode}");
        }
    }
}

#[test]
fn lies_are_named() {
    let node = r#"{"mesh":0}"#;
    let full = bytes_of_box();
    let mut beyond = full.clone();
    beyond[96] = 8;
    let mut infinite = full.clone();
    infinite[..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let lies = [
        (
            glb_with(r#"{"mesh":0,"children":[0]}"#),
            "node 0 hangs on two",
        ),
        (glb(node, "", 8, 5126, &full), "must Scalar of U32"),
        (
            glb(node, "", 1 << 40, 5121, &full),
            "1099511627776 elements",
        ),
        (glb(node, "", 100, 5121, &full), "positions"),
        (glb(node, "", 8, 5121, &beyond), "vertex 8 (from 0)"),
        (glb(node, "", 8, 5121, &infinite), "not finite"),
        (glb(node, r#","mode":1"#, 8, 5121, &full), "no triangle"),
        (glb("", "", 8, 5121, &full), "nodes"),
        (b"glTF\x02\0\0\0".to_vec(), "byte 12"),
        (b"{}".to_vec(), "given"),
    ];
    for (file, says) in lies {
        let error = load(&file, MeshFormat::Gltf).expect_err(says).to_string();
        assert!(error.contains(says), "{says}: {error}");
    }
}

#[test]
fn buffers_beside_the_file_are_read() {
    let folder = std::env::temp_dir().join(format!("medial-gltf-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("a box.bin"), bytes_of_box()).unwrap();
    let file = glb_with(r#"{"mesh":0}"#);
    let json = &file[20..20 + u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize];
    let json = String::from_utf8_lossy(json).replace(
        r#"{"byteLength":132}]}"#,
        r#"{"byteLength":132,"uri":"a%20box.bin"}]}"#,
    );
    let path = folder.join("box.gltf");
    std::fs::write(&path, json).unwrap();
    let mesh = read(&path).unwrap();
    std::fs::remove_file(folder.join("a box.bin")).unwrap();
    let lost = read(&path).unwrap_err().to_string();
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(volume(&mesh), 6.0);
    assert!(lost.contains("a%20box.bin"), "{lost}");
}

#[test]
fn corners_of_no_whole_triangle_are_refused() {
    let mut file = glb_with(r#"{"mesh":0}"#);
    let count = br#""count":36"#;
    let place = file.windows(count.len()).position(|bytes| bytes == count);
    file[place.unwrap() + count.len() - 1] = b'5';
    let error = load(&file, MeshFormat::Gltf).unwrap_err().to_string();
    assert!(error.contains("35 corners"), "{error}");
}
