//! Mesh files: the same solid in every format, polygons against planted areas, and every
//! malformed class with the place that the error must name.

use crate::oracle::Random;
use proptest::prelude::*;
use rapier3d_medial::BuildError;
use rapier3d_medial::build::mesh_file::{MeshFormat, TriangleMesh, read, read_bytes};
use rapier3d_medial::math::Vector;
use std::path::Path;

fn load(bytes: &[u8], format: MeshFormat) -> Result<TriangleMesh, BuildError> {
    read_bytes(bytes, format, Path::new("given"))
}

/// A box of 1 × 2 × 3 as six quads, counter-clockwise from outside.
const CORNERS: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 2.0, 0.0],
    [0.0, 2.0, 0.0],
    [0.0, 0.0, 3.0],
    [1.0, 0.0, 3.0],
    [1.0, 2.0, 3.0],
    [0.0, 2.0, 3.0],
];
const QUADS: [[usize; 4]; 6] = [
    [0, 3, 2, 1],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
];

fn lines<T>(items: impl IntoIterator<Item = T>, line: impl Fn(T) -> String) -> String {
    items.into_iter().map(|i| line(i) + "\n").collect()
}

fn obj() -> Vec<u8> {
    let vertices = lines(CORNERS, |[x, y, z]| format!("v {x} {y} {z}"));
    let faces = lines(QUADS, |q| {
        format!("f {} {} {} {}", q[0] + 1, q[1] + 1, q[2] + 1, q[3] + 1)
    });
    format!("# box\no box\n{vertices}{faces}").into_bytes()
}

fn off() -> Vec<u8> {
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

fn stl_text() -> Vec<u8> {
    let vertex = |[x, y, z]: [f32; 3]| format!("      vertex {x:e} {y:e} {z:e}");
    let facets = lines(triangles(), |t| {
        let corners = lines(t, vertex);
        format!("  facet normal 0 0 0\n    outer loop\n{corners}    endloop\n  endfacet")
    });
    format!("solid a box\n{facets}endsolid a box\n").into_bytes()
}

fn stl_binary() -> Vec<u8> {
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

fn ply_text() -> Vec<u8> {
    let vertices = lines(CORNERS, |[x, y, z]| format!("{x} {y} 255 {z}"));
    let faces = lines(QUADS, |[a, b, c, d]| format!("4 {a} {b} {c} {d}"));
    format!("ply\nformat ascii 1.0\n{PLY_HEADER}{vertices}{faces}7\n").into_bytes()
}

fn ply_binary(big: bool) -> Vec<u8> {
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
fn good_files() -> Vec<(&'static str, Vec<u8>, MeshFormat)> {
    vec![
        ("obj", obj(), MeshFormat::Obj),
        ("off", off(), MeshFormat::Off),
        ("stl text", stl_text(), MeshFormat::Stl),
        ("stl binary", stl_binary(), MeshFormat::Stl),
        ("ply text", ply_text(), MeshFormat::Ply),
        ("ply little", ply_binary(false), MeshFormat::Ply),
        ("ply big", ply_binary(true), MeshFormat::Ply),
    ]
}

/// Volume inside a closed mesh: positive if its triangles face outwards.
fn volume(mesh: &TriangleMesh) -> f32 {
    let at = |i: u32| mesh.vertices[i as usize];
    let six = |&[a, b, c]: &[u32; 3]| at(a).dot(at(b).cross(at(c)));
    mesh.indices.iter().map(six).sum::<f32>() / 6.0
}

fn assert_valid(mesh: &TriangleMesh) {
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

/// Places and words that the errors of broken text files must name.
#[test]
fn malformed_text_names_its_line() {
    use MeshFormat::{Obj, Off, Ply, Stl};
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
    let facet = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
               property float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n";
    let cases = [
        (Obj, "v 0 0\n".to_owned(), "line 1", "z is missing"),
        (Obj, "\nv 0 x 0\n".to_owned(), "line 2", "\"x\""),
        (Obj, "v 0 NaN 0\n".to_owned(), "line 1", "y is NaN"),
        (Obj, "v 0 0 1e99\n".to_owned(), "line 1", "z is inf"),
        (Obj, format!("{triangle}f 1 2\n"), "line 4", "2 corners"),
        (Obj, format!("{triangle}f 1 2 b\n"), "line 4", "\"b\""),
        (Obj, format!("{triangle}f 1 2 0\n"), "line 4", "vertex 0"),
        (Obj, format!("{triangle}f 1 2 -4\n"), "line 4", "vertex -4"),
        (
            Obj,
            format!("{triangle}\nf 1 2 4\n"),
            "line 5",
            "vertex 3 (from 0)",
        ),
        (
            Obj,
            format!("{triangle}f 1 2 99999999999999999999\n"),
            "line 4",
            "99999",
        ),
        (Off, "".to_owned(), "line 1", "ends before the keyword"),
        (Off, "0FF\n".to_owned(), "line 1", "\"0FF\""),
        (
            Off,
            "OFF BINARY\n3 1 0\n".to_owned(),
            "line 1",
            "\"BINARY\"",
        ),
        (Off, "OFF\n".to_owned(), "line 1", "ends before the counts"),
        (
            Off,
            "OFF\n3\n".to_owned(),
            "line 2",
            "number of faces is missing",
        ),
        (
            Off,
            "OFF\n4000000000 4000000000 0\n".to_owned(),
            "line 2",
            "vertex 0 of 4000000000",
        ),
        (
            Off,
            "OFF\n3 1 0\n0 0 0\n1 inf 0\n".to_owned(),
            "line 4",
            "y is inf",
        ),
        (Off, off.to_owned(), "line 5", "face 0 of 1"),
        (Off, format!("{off}3 0 1\n"), "line 6", "index is missing"),
        (
            Off,
            format!("{off}3 0 1 3\n"),
            "line 6",
            "vertex 3 (from 0) is not among the 3",
        ),
        (Off, format!("{off}3 0 1 -1\n"), "line 6", "\"-1\""),
        (
            Off,
            format!("{off}4000000000 0 1 2\n"),
            "line 6",
            "4000000000 corners",
        ),
        (Stl, "solid\nfacit\n".to_owned(), "line 2", "\"facit\""),
        (
            Stl,
            "solid\nendsolid\nfacet normal 0 0 1\n".to_owned(),
            "line 3",
            "`solid`",
        ),
        (Stl, facet.to_owned(), "line 5", "ends before `vertex`"),
        (
            Stl,
            format!("{facet}vertex 0 1\n"),
            "line 6",
            "z is missing",
        ),
        (
            Stl,
            format!("{facet}vertex 0 1 nan\n"),
            "line 6",
            "z is NaN",
        ),
        (
            Stl,
            format!("{facet}vertex 0 1 0\nvertex 1 1 1\n"),
            "line 7",
            "expected `endloop`",
        ),
        (
            Stl,
            format!("{facet}vertex 0 1 0\nendloop\nendfacet\n"),
            "line 8",
            "`endsolid`",
        ),
        (Ply, "".to_owned(), "line 1", "end of file"),
        (Ply, "plyx\n".to_owned(), "line 1", "magic number"),
        (
            Ply,
            "ply\nformat ascii 1.0\n".to_owned(),
            "line 3",
            "end_header",
        ),
        (
            Ply,
            "ply\nformat ascii 1.0\nelement vertex -3\n".to_owned(),
            "line 3",
            "element vertex -3",
        ),
        (
            Ply,
            format!("{ply}0 0 0\n1 0\n"),
            "line 11",
            "found nothing",
        ),
        (Ply, format!("{ply}0 0 0\n1 nan 0\n"), "line 11", "nan"),
        (
            Ply,
            format!("{ply}0 0 0\n1 0 0\n"),
            "line 12",
            "expected 3, got 2",
        ),
        (
            Ply,
            format!("{ply}0 0 0\n1 0 0\n0 1 0\n3 0 1\n"),
            "line 13",
            "only 2",
        ),
    ];
    for (format, text, place, words) in cases {
        match load(text.as_bytes(), format) {
            Err(BuildError::Syntax {
                path,
                location,
                message,
            }) => {
                assert_eq!(path, Path::new("given"));
                assert_eq!(location, place, "{text:?}: {message}");
                assert!(
                    message.contains(words),
                    "{text:?}: {message:?} lacks {words:?}"
                );
                assert!(
                    !message.contains('\n') && message.len() < 400,
                    "{message:?}"
                );
            }
            other => panic!("{text:?}: {other:?}"),
        }
    }
}

#[test]
fn malformed_values_of_binary_files_are_named() {
    let mut stl = stl_binary();
    // Triangle 2, corner 1, y: 50 bytes a triangle, 12 a corner after the normal.
    let at = 84 + 2 * 50 + 24 + 4;
    stl[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(matches!(
        load(&stl, MeshFormat::Stl),
        Err(BuildError::NotFinite { index: 7, .. })
    ));

    let mut ply = ply_binary(false);
    let last_index = ply.len() - 2 - 4;
    ply[last_index..last_index + 4].copy_from_slice(&8i32.to_le_bytes());
    let found = load(&ply, MeshFormat::Ply);
    let Err(BuildError::IndexOutOfRange {
        index: 5,
        value: 8,
        count: 8,
    }) = found
    else {
        panic!("{found:?}");
    };
    ply[last_index..last_index + 4].copy_from_slice(&(-1i32).to_le_bytes());
    let error = load(&ply, MeshFormat::Ply).unwrap_err().to_string();
    assert!(error.contains("face 5"), "{error}");

    let mut short = stl_binary();
    short.truncate(84 + 50 * 7 + 20);
    let error = load(&short, MeshFormat::Stl).unwrap_err().to_string();
    assert!(error.contains("after 7 of 12 triangles"), "{error}");
}

/// Counts that no memory holds are refused at once.
#[test]
fn absurd_counts_are_refused() {
    let mut stl = stl_binary();
    stl[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let error = load(&stl, MeshFormat::Stl).unwrap_err().to_string();
    assert!(error.contains("12 of 4294967295 triangles"), "{error}");
    for (properties, count) in [
        ("", "4000000000"),
        ("property float x\n", "18446744073709551615"),
    ] {
        for format in ["ascii", "binary_little_endian"] {
            let text = format!(
                "ply\nformat {format} 1.0\nelement vertex {count}\n{properties}end_header\n1\n"
            );
            let error = load(text.as_bytes(), MeshFormat::Ply)
                .unwrap_err()
                .to_string();
            assert!(error.contains(count), "{error}");
        }
    }
    let list = "ply\nformat binary_little_endian 1.0\nelement face 1\n\
                property list uint double vertex_indices\nend_header\n\u{7f}\u{7f}\u{7f}\u{7f}abc";
    assert!(matches!(
        load(list.as_bytes(), MeshFormat::Ply),
        Err(BuildError::Syntax { .. })
    ));
}

#[test]
fn meshes_without_triangles_are_empty() {
    let nothing: [(&[u8], MeshFormat); 5] = [
        (b"", MeshFormat::Obj),
        (b"v 0 0 0\nv 1 0 0\nv 2 0 0\n", MeshFormat::Obj),
        (b"v 0 0 0\nv 1 0 0\nv 0 0 0\nf 1 2 3\n", MeshFormat::Obj),
        (b"solid\nendsolid\n", MeshFormat::Stl),
        (b"OFF\n0 0 0\n", MeshFormat::Off),
    ];
    for (bytes, format) in nothing {
        let found = load(bytes, format);
        assert!(matches!(found, Err(BuildError::Empty { .. })), "{found:?}");
    }
}

/// A good file cut at any byte: an error, or the whole mesh if only the end of its last word is
/// gone. (An OBJ file, without counts or an end mark, may lose faces unnoticed.)
#[test]
fn truncated_files_never_panic() {
    for (name, bytes, format) in good_files() {
        let whole = load(&bytes, format).unwrap();
        let mut errors = 0;
        for end in 0..bytes.len() {
            match load(&bytes[..end], format) {
                Ok(mesh) if format == MeshFormat::Obj => assert_valid(&mesh),
                Ok(mesh) => assert_eq!(mesh, whole, "{name} cut at {end}"),
                Err(_) => errors += 1,
            }
        }
        assert!(
            2 * errors > bytes.len(),
            "{name}: {errors} errors of {}",
            bytes.len()
        );
    }
}

#[test]
fn endings_name_the_format() {
    let missing = read("/nowhere/mesh.obj").unwrap_err();
    assert!(matches!(missing, BuildError::File { .. }), "{missing}");
    let unknown = read("/nowhere/mesh.gltf").unwrap_err();
    assert!(unknown.to_string().contains("\"gltf\""), "{unknown}");
    assert!(matches!(
        read("mesh").unwrap_err(),
        BuildError::UnknownFormat { .. }
    ));
    assert_eq!(MeshFormat::of(Path::new("A.STL")), Some(MeshFormat::Stl));
}

/// Areas of a planar polygon by the shoelace formula, and of its triangles, all of which must
/// face as the polygon does: then the triangles cover it exactly once.
fn assert_covered(polygon: &[[f64; 2]], name: &str) {
    // Tilted so that no coordinate plane is special.
    let tilt = |[x, y]: [f64; 2]| format!("v {} {} {}", x, 0.6 * x + y, 0.3 * x - 0.8 * y);
    let corners: Vec<String> = (1..=polygon.len()).map(|i| i.to_string()).collect();
    let text = format!(
        "{}f {}\n",
        lines(polygon.iter().copied(), tilt),
        corners.join(" ")
    );
    let mesh = load(text.as_bytes(), MeshFormat::Obj).unwrap();
    let flat = |i: u32| {
        let v = mesh.vertices[i as usize];
        let x = f64::from(v.x);
        [x, f64::from(v.y) - 0.6 * x]
    };
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let wanted: f64 = (0..polygon.len())
        .map(|i| cross(polygon[i], polygon[(i + 1) % polygon.len()]) / 2.0)
        .sum();
    let mut covered = 0.0;
    for t in &mesh.indices {
        let [a, b, c] = t.map(flat);
        let area = (cross(a, b) + cross(b, c) + cross(c, a)) / 2.0;
        assert!(
            area * wanted.signum() > -1e-6,
            "{name}: a triangle of area {area}"
        );
        covered += area;
    }
    assert!(
        (covered - wanted).abs() < 1e-4 * wanted.abs(),
        "{name}: {covered} of {wanted}"
    );
    assert_eq!(mesh.indices.len(), polygon.len() - 2, "{name}");
}

#[test]
fn concave_polygons_are_covered_exactly_once() {
    let l = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];
    assert_covered(&l, "L");
    for start in 0..6 {
        let mut turned = l;
        turned.rotate_left(start);
        assert_covered(&turned, "L from another corner");
        turned.reverse();
        assert_covered(&turned, "L clockwise");
    }
    assert_covered(
        &[[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.5, 1.0]],
        "arrow head",
    );
    let with_middles = [
        [0.0, 0.0],
        [1.0, 0.0],
        [2.0, 0.0],
        [2.0, 2.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];
    assert_covered(&with_middles, "corners on straight sides");
    let comb: Vec<[f64; 2]> = (0..200)
        .map(|i| [f64::from(i), if i % 2 == 0 { 5.0 } else { 1.0 }])
        .chain([[199.0, 0.0], [0.0, 0.0]])
        .rev()
        .collect();
    assert_covered(&comb, "comb");
    let mut random = Random(3);
    for case in 0..200 {
        let count = 4 + case % 60;
        let star: Vec<_> = (0..count)
            .map(|i| {
                let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
                let r = random.within(0.05, 1.0);
                [r * angle.cos(), r * angle.sin()]
            })
            .collect();
        assert_covered(&star, "star");
    }
}

/// A square with a square hole, joined by a cut that the outline runs along twice.
#[test]
fn a_hole_joined_by_a_cut_stays_open() {
    let text = "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 1 1 0\nv 1 2 0\nv 2 2 0\nv 2 1 0\n\
                f 1 2 3 4 1 5 6 7 8 5\n";
    let mesh = load(text.as_bytes(), MeshFormat::Obj).unwrap();
    let at = |i: u32| mesh.vertices[i as usize];
    let mut area = 0.0;
    for &[a, b, c] in &mesh.indices {
        let z = (at(b) - at(a)).cross(at(c) - at(a)).z / 2.0;
        let center = (at(a) + at(b) + at(c)) / 3.0 - Vector::new(1.5, 1.5, 0.0);
        assert!(z >= 0.0);
        assert!(
            z == 0.0 || center.x.abs().max(center.y.abs()) > 0.5,
            "the hole is covered"
        );
        area += z;
    }
    assert_eq!(area, 8.0);
}

/// 60,000 corners with 30,000 notches: bounded time.
#[test]
fn a_huge_polygon_ends() {
    let count = 60_000;
    let vertices = lines(0..count, |i| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
        let r = if i % 2 == 0 { 1.0 } else { 0.5 };
        format!("v {:.6} {:.6} 0", r * angle.cos(), r * angle.sin())
    });
    let corners: Vec<String> = (1..=count).map(|i| i.to_string()).collect();
    let text = format!("{vertices}f {}\n", corners.join(" "));
    let mesh = load(text.as_bytes(), MeshFormat::Obj).unwrap();
    assert_valid(&mesh);
}

fn formats() -> impl Strategy<Value = MeshFormat> {
    prop::sample::select(vec![
        MeshFormat::Obj,
        MeshFormat::Stl,
        MeshFormat::Ply,
        MeshFormat::Off,
    ])
}

proptest! {
    #[test]
    fn random_bytes_never_panic(
        format in formats(),
        prefix in prop::sample::select(vec!["", "solid x\n", "OFF\n", "OFF 3 1 0\n", "ply\n", "v 0 0 0\nf "]),
        bytes in prop::collection::vec(any::<u8>(), 0..600),
    ) {
        if let Ok(mesh) = load(&[prefix.as_bytes(), &bytes].concat(), format) {
            assert_valid(&mesh);
        }
    }

    #[test]
    fn damaged_files_never_panic(
        which in 0..7usize,
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let (_, mut bytes, format) = good_files().swap_remove(which);
        for (at, byte) in damage {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Ok(mesh) = load(&bytes, format) {
            assert_valid(&mesh);
        }
    }
}
