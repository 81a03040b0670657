//! Broken mesh files: every malformed class with the place that its error must name; files cut
//! at every byte, damaged, and random.

use crate::mesh_file::{assert_valid, good_files, load, ply_binary, stl_binary};
use proptest::prelude::*;
use rapier3d_medial::BuildError;
use rapier3d_medial::meshing::mesh_file::MeshFormat;
use std::path::Path;

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
            "vertex 4 (from 1) is not among the 3",
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
