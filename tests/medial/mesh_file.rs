//! Mesh files: the same solid in every format, and variants in the wild.

use rapier3d_medial::BuildError;
use rapier3d_medial::meshing::mesh_file::{MeshFormat, TriangleMesh, read, read_bytes};
use std::path::Path;

pub fn load(bytes: &[u8], format: MeshFormat) -> Result<TriangleMesh, BuildError> {
    read_bytes(bytes, format, Path::new("given"))
}

/// A box of 1 × 2 × 3 as six quads, counter-clockwise from outside.
pub const CORNERS: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 2.0, 0.0],
    [0.0, 2.0, 0.0],
    [0.0, 0.0, 3.0],
    [1.0, 0.0, 3.0],
    [1.0, 2.0, 3.0],
    [0.0, 2.0, 3.0],
];
pub const QUADS: [[usize; 4]; 6] = [
    [0, 3, 2, 1],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
];

pub fn lines<T>(items: impl IntoIterator<Item = T>, line: impl Fn(T) -> String) -> String {
    items.into_iter().map(|i| line(i) + "\n").collect()
}

pub fn obj() -> Vec<u8> {
    let vertices = lines(CORNERS, |[x, y, z]| format!("v {x} {y} {z}"));
    let faces = lines(QUADS, |q| {
        format!("f {} {} {} {}", q[0] + 1, q[1] + 1, q[2] + 1, q[3] + 1)
    });
    format!("# box\no box\n{vertices}{faces}").into_bytes()
}

pub fn off() -> Vec<u8> {
    let vertices = lines(CORNERS, |[x, y, z]| format!("{x} {y} {z}"));
    let faces = lines(QUADS, |[a, b, c, d]| format!("4 {a} {b} {c} {d}"));
    format!("OFF\n8 6 12\n{vertices}{faces}").into_bytes()
}

fn triangles() -> Vec<[[f32; 3]; 3]> {
    let split = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
    QUADS
        .into_iter()
        .flat_map(split)
        .map(|t| t.map(|i| CORNERS[i]))
        .collect()
}

pub fn stl_text() -> Vec<u8> {
    let vertex = |[x, y, z]: [f32; 3]| format!("      vertex {x:e} {y:e} {z:e}");
    let facets = lines(triangles(), |t| {
        let corners = lines(t, vertex);
        format!("  facet normal 0 0 0\n    outer loop\n{corners}    endloop\n  endfacet")
    });
    format!("solid a box\n{facets}endsolid a box\n").into_bytes()
}

pub fn stl_binary() -> Vec<u8> {
    // The header begins as a text would, as many programs write it.
    let mut bytes = b"solid but binary".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(12u32.to_le_bytes());
    for t in triangles() {
        let normal = [0.0f32; 3];
        let numbers = [normal, t[0], t[1], t[2]].into_iter().flatten();
        bytes.extend(numbers.flat_map(f32::to_le_bytes));
        bytes.extend([0, 0]);
    }
    bytes
}

const PLY_HEADER: &str = "comment box
element vertex 8
property float x
property double y
property uchar red
property float z
element face 6
property list uchar int vertex_indices
element tail 1
property short value
end_header
";

pub fn ply_text() -> Vec<u8> {
    let vertices = lines(CORNERS, |[x, y, z]| format!("{x} {y} 255 {z}"));
    let faces = lines(QUADS, |[a, b, c, d]| format!("4 {a} {b} {c} {d}"));
    format!("ply\nformat ascii 1.0\n{PLY_HEADER}{vertices}{faces}7\n").into_bytes()
}

pub fn ply_binary(big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut bytes = format!("ply\nformat binary_{order}_endian 1.0\n{PLY_HEADER}").into_bytes();
    let mut put = |little: &[u8]| {
        let mut field = little.to_vec();
        if big {
            field.reverse();
        }
        bytes.extend(field);
    };
    for [x, y, z] in CORNERS {
        put(&x.to_le_bytes());
        put(&f64::from(y).to_le_bytes());
        put(&[255]);
        put(&z.to_le_bytes());
    }
    for quad in QUADS {
        put(&[4]);
        quad.iter().for_each(|&i| put(&(i as i32).to_le_bytes()));
    }
    put(&7i16.to_le_bytes());
    bytes
}

/// Every good file, with its format.
pub fn good_files() -> Vec<(&'static str, Vec<u8>, MeshFormat)> {
    vec![
        ("obj", obj(), MeshFormat::Obj),
        ("off", off(), MeshFormat::Off),
        ("stl text", stl_text(), MeshFormat::Stl),
        ("stl binary", stl_binary(), MeshFormat::Stl),
        ("ply text", ply_text(), MeshFormat::Ply),
        ("ply little", ply_binary(false), MeshFormat::Ply),
        ("ply big", ply_binary(true), MeshFormat::Ply),
        #[cfg(feature = "gltf")]
        ("glb", crate::gltf::box_file(), MeshFormat::Gltf),
    ]
}

/// Volume inside a closed mesh: positive if its triangles face outwards.
pub fn volume(mesh: &TriangleMesh) -> f32 {
    let at = |i: u32| mesh.vertices[i as usize];
    let six = |&[a, b, c]: &[u32; 3]| at(a).dot(at(b).cross(at(c)));
    mesh.indices.iter().map(six).sum::<f32>() / 6.0
}

pub fn assert_valid(mesh: &TriangleMesh) {
    assert!(!mesh.indices.is_empty());
    assert!(mesh.vertices.iter().all(|v| v.is_finite()));
    for &[a, b, c] in &mesh.indices {
        assert!(a != b && b != c && c != a);
        assert!(
            [a, b, c]
                .iter()
                .all(|&i| (i as usize) < mesh.vertices.len())
        );
    }
}

#[test]
fn every_format_gives_the_same_box() {
    for (name, bytes, format) in good_files() {
        let mesh = load(&bytes, format).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_valid(&mesh);
        assert_eq!(mesh.vertices.len(), 8, "{name}");
        assert_eq!(mesh.indices.len(), 12, "{name}");
        assert_eq!(volume(&mesh), 6.0, "{name}");
    }
}

#[test]
fn equal_vertices_of_indexed_files_become_one() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -0 0 -0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 4 6 5\n";
    let mesh = load(text.as_bytes(), MeshFormat::Obj).unwrap();
    assert_eq!(mesh.vertices.len(), 4);
    assert_eq!(mesh.indices, [[0, 1, 2], [0, 3, 2]]);
}

#[test]
fn variants_in_the_wild_are_read() {
    let quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let obj: [(&str, &[u8]); 6] = [
        ("relative", b"f -4 -3 -2 -1\n"),
        (
            "texture and normal",
            b"vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\n",
        ),
        ("normal only", b"f 1//1 2//1 3//1 4//1\n"),
        ("odd texture", b"f 1/-9/1 2/-9/1 3/0/99 4/1\n"),
        ("continued", b"f 1 2 \\\n 3\\\n 4\n"),
        (
            "latin-1 comment",
            b"# caf\xe9\ng gr\xfcn\nusemtl x\ns off\nl 1 2\nf 1 2 3 4 # quad\n",
        ),
    ];
    for (name, faces) in obj {
        let bytes = [quad.as_bytes(), faces].concat();
        let mesh = load(&bytes, MeshFormat::Obj).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!((mesh.vertices.len(), mesh.indices.len()), (4, 2), "{name}");
    }
    let weighted = b"v 0 0 0 1\nv 1 0 0 1.0 0.5 0.5\nv 0 1 0 1\r\nf 1 2 3\r\n";
    assert_eq!(
        load(weighted, MeshFormat::Obj).unwrap().indices,
        [[0, 1, 2]]
    );
    for off in [
        "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "OFF3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "# made by hand\nCOFF\n\n3 2 0\n0 0 0 255 0 0 255\n1 0 0 1 1 1 1\n0 1 0\n2 0 1\n3 0 1 2 0.5 0.5 0.5\n",
    ] {
        assert_eq!(
            load(off.as_bytes(), MeshFormat::Off).unwrap().indices,
            [[0, 1, 2]]
        );
    }
    let shouted = String::from_utf8(stl_text())
        .unwrap()
        .to_uppercase()
        .replace('\n', "\r\n");
    assert_eq!(
        load(shouted.as_bytes(), MeshFormat::Stl)
            .unwrap()
            .indices
            .len(),
        12
    );
    let mut padded = stl_binary();
    padded.extend([1, 2, 3]);
    assert_eq!(load(&padded, MeshFormat::Stl).unwrap().indices.len(), 12);
}

#[test]
fn endings_name_the_format() {
    let missing = read("/nowhere/mesh.obj").unwrap_err();
    assert!(matches!(missing, BuildError::File { .. }), "{missing}");
    let unknown = read("/nowhere/mesh.fbx").unwrap_err();
    assert!(unknown.to_string().contains("\"fbx\""), "{unknown}");
    let unnamed = read("mesh").unwrap_err();
    assert!(matches!(unnamed, BuildError::UnknownFormat { .. }));
    assert!(unnamed.to_string().contains("no ending"), "{unnamed}");
    assert_eq!(MeshFormat::of(Path::new("A.STL")), Some(MeshFormat::Stl));
}
