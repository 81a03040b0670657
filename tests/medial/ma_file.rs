//! The `.ma` format: variants in the wild, exact round trips, and every malformed class with the
//! line that the error must name.

use crate::oracle::{Random, random_mesh};
use proptest::prelude::*;
use rapier3d_medial::math::Vector;
use rapier3d_medial::{MedialMesh, MedialSphere, MeshError};
use std::fs;
use std::path::{Path, PathBuf};

fn read(text: &str) -> Result<MedialMesh, MeshError> {
    MedialMesh::read_ma(text.as_bytes(), Path::new("given.ma"))
}

const PLAIN: &str = "\
4 4 1
v 0 0 0 0.5
v 1 0 0 0.25
v 0 1 0 0.125
v 0 0 2.5e0 1
e 0 1
e 1 2
e 0 2
e 2 3
f 0 1 2
";

fn assert_is_plain(mesh: &MedialMesh) {
    let sphere = |x, y, z, r| MedialSphere::new(Vector::new(x, y, z), r);
    let spheres = [
        sphere(0.0, 0.0, 0.0, 0.5),
        sphere(1.0, 0.0, 0.0, 0.25),
        sphere(0.0, 1.0, 0.0, 0.125),
        sphere(0.0, 0.0, 2.5, 1.0),
    ];
    assert_eq!(mesh.spheres(), spheres);
    let mut edges = mesh.edges().to_vec();
    edges.sort();
    assert_eq!(edges, [[0, 1], [0, 2], [1, 2], [2, 3]]);
    assert_eq!(mesh.faces(), [[0, 1, 2]]);
    assert_eq!(mesh.primitive_count(), 2);
}

#[test]
fn variants_in_the_wild_read_alike() {
    let only_dangling =
        "4 1 1\nv 0 0 0 .5\nv 1 0 0 .25\nv 0 1 0 .125\nv 0 0 2.5 1\ne 3 2\nf 0 1 2\n";
    let flags = PLAIN
        .lines()
        .map(|l| format!("{l} 0 1\n"))
        .collect::<String>();
    let noise = PLAIN
        .lines()
        .map(|l| {
            format!(
                "# made by hand\n\n  \t{}   # why not\n \n",
                l.replace(' ', "\t ")
            )
        })
        .collect::<String>();
    let faces_first = {
        let mut lines: Vec<_> = PLAIN.lines().collect();
        lines[1..].reverse();
        let mut text = lines.join("\n");
        text = text.replace("v 0 0 0 0.5", "");
        // The spheres keep their order among themselves.
        let spheres: Vec<_> = PLAIN.lines().filter(|l| l.starts_with('v')).collect();
        let rest: Vec<_> = text.lines().filter(|l| !l.starts_with('v')).collect();
        format!("{}\n{}", rest.join("\n"), spheres.join("\n"))
    };
    for text in [
        PLAIN,
        &PLAIN.replace('\n', "\r\n"),
        &PLAIN.replace('\n', "   \n"),
        PLAIN.trim_end(),
        only_dangling,
        &flags,
        &noise,
        &faces_first,
    ] {
        assert_is_plain(&read(text).unwrap_or_else(|e| panic!("{e}\n{text}")));
    }
}

/// Each malformed text, the line its error must name, and words it must contain.
#[test]
fn every_malformed_class_names_its_line() {
    let cases = [
        ("", 1, "empty"),
        ("\n\n# nothing\n", 1, "empty"),
        ("4 4\n", 1, "faces is missing"),
        ("4 x 1\n", 1, "\"x\""),
        ("-4 4 1\n", 1, "\"-4\""),
        ("99999999999999 0 0\n", 1, "99999999999999"),
        ("4000000000 0 0\nv 0 0 0 1\n", 2, "1 of 4000000000 spheres"),
        ("2 0 0\nv 0 0 0 1\n", 2, "1 of 2 spheres"),
        ("1 0 0\n\nv 0 0 0\n", 3, "radius is missing"),
        ("1 0 0\nv 0 0 0 1,5\n", 2, "\"1,5\""),
        ("1 0 0\nv 0 nan 0 1\n", 2, "y is NaN"),
        ("1 0 0\nv 0 0 0 inf\n", 2, "the radius is inf"),
        ("1 0 0\nv 0 0 1e99 1\n", 2, "z is inf"),
        ("1 0 0\nv 0 0 0 -0.5\n", 2, "-0.5 is negative"),
        (
            "1 0 0\nv 0 0 0 1\nv 0 0 1 1\n",
            3,
            "more than the 1 spheres",
        ),
        ("1 0 0\nv 0 0 0 1\nx 1 2 3\n", 3, "\"x 1 2 3\""),
        ("1 0 0\nv 0 0 0 1\n\u{0}\u{1}\u{fffd}\n", 3, "\\0\\u{1}"),
        ("2 1 0\nv 0 0 0 1\nv 0 0 1 1\n", 3, "0 of 1 edges"),
        (
            "2 1 0\nv 0 0 0 1\nv 0 0 1 1\ne 0 2\n",
            4,
            "sphere 2 is not among the 2",
        ),
        ("2 1 0\nv 0 0 0 1\nv 0 0 1 1\ne 0 -1\n", 4, "\"-1\""),
        ("2 1 0\nv 0 0 0 1\nv 0 0 1 1\ne 0\n", 4, "index is missing"),
        (
            "2 1 0\nv 0 0 0 1\nv 0 0 1 1\n# edge\ne 1 1\n",
            5,
            "sphere 1 is named twice",
        ),
        (
            "2 0 0\nv 0 0 0 1\nv 0 0 1 1\ne 0 1\n",
            4,
            "more than the 0 edges",
        ),
        (
            "3 0 1\nv 0 0 0 1\nv 0 0 1 1\nv 1 0 0 1\nf 0 1 3\n",
            5,
            "sphere 3",
        ),
        (
            "3 0 1\nv 0 0 0 1\nv 0 0 1 1\nv 1 0 0 1\nf 0 1 0\n",
            5,
            "twice",
        ),
        (
            "3 0 1\nv 0 0 0 1\nv 0 0 1 1\nv 1 0 0 1\nf 0 1 1.5\n",
            5,
            "\"1.5\"",
        ),
    ];
    for (text, wanted_line, words) in cases {
        match read(text) {
            Err(MeshError::Syntax {
                path,
                line,
                message,
            }) => {
                assert_eq!(path, Path::new("given.ma"));
                assert_eq!(line, wanted_line, "{text:?}: {message}");
                assert!(
                    message.contains(words),
                    "{text:?}: {message:?} lacks {words:?}"
                );
            }
            other => panic!("{text:?}: {other:?}"),
        }
    }
}

#[test]
fn a_line_without_end_is_refused() {
    let text = format!("1 0 0\nv 0 0 0 {}\n", "1".repeat(3 << 20));
    let error = read(&text).unwrap_err().to_string();
    assert!(
        error.starts_with("given.ma, line 2: the line is longer"),
        "{error}"
    );
}

#[test]
fn whole_mesh_faults_are_those_of_new() {
    assert!(matches!(read("0 0 0\n"), Err(MeshError::Empty)));
    let zero = read("2 1 0\nv 1 2 3 0\nv 1 2 3 0\ne 0 1\n");
    assert!(matches!(zero, Err(MeshError::ZeroSize { count: 2, .. })));
}

/// A file cut at any byte is an error with a line, or (cut within its last number) still a mesh.
#[test]
fn truncated_files_never_panic() {
    let mut complete = 0;
    for end in 0..PLAIN.len() {
        match read(&PLAIN[..end]) {
            Ok(_) => complete += 1,
            Err(MeshError::Syntax { line, .. }) => assert!((1..=10).contains(&line)),
            Err(other) => panic!("cut at {end}: {other}"),
        }
    }
    assert_eq!(
        complete, 1,
        "only the cut before the last line break is complete"
    );
}

fn scratch(name: &str) -> PathBuf {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("ma-{name}"));
    fs::create_dir_all(&directory).unwrap();
    directory
}

#[test]
fn saved_files_read_back_bit_by_bit() {
    let directory = scratch("round-trip");
    let path = directory.join("mesh.ma");
    for seed in 0..20 {
        let mesh = random_mesh(seed);
        mesh.save_ma(&path).unwrap();
        let again = MedialMesh::load_ma(&path).unwrap();
        assert_eq!(again.spheres(), mesh.spheres());
        assert_eq!(again.edges(), mesh.edges());
        assert_eq!(again.faces(), mesh.faces());
    }
    let names: Vec<_> = fs::read_dir(&directory)
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    assert_eq!(names, ["mesh.ma"], "nothing is left beside the file");
}

#[test]
fn awkward_numbers_survive() {
    let mut random = Random(5);
    let mut numbers = vec![
        f32::MIN_POSITIVE,
        f32::MAX,
        1e-45,
        1.0 / 3.0,
        16_777_217.0,
        -0.0,
        1e-7,
    ];
    while numbers.len() < 16_000 {
        let value = f32::from_bits(random.bits() as u32);
        if value.is_finite() {
            numbers.push(value);
        }
    }
    let spheres: Vec<_> = numbers
        .chunks_exact(4)
        .map(|c| MedialSphere::new(Vector::new(c[0], c[1], c[2]), c[3].abs()))
        // What reaches farther is refused.
        .filter(|s| s.center.abs().max_element() + s.radius <= 1.0e18)
        .collect();
    assert!(spheres.len() > 900);
    let mesh = MedialMesh::new(spheres, vec![], vec![]).unwrap();
    let mut text = Vec::new();
    mesh.write_ma(&mut text).unwrap();
    let again = MedialMesh::read_ma(text.as_slice(), Path::new("memory")).unwrap();
    for (a, b) in again.spheres().iter().zip(mesh.spheres()) {
        assert_eq!(
            a.center.to_array().map(f32::to_bits),
            b.center.to_array().map(f32::to_bits)
        );
        assert_eq!(a.radius.to_bits(), b.radius.to_bits());
    }
}

#[test]
fn files_that_cannot_be_opened_or_written_name_the_path() {
    let directory = scratch("errors");
    let missing = directory.join("missing.ma");
    let error = MedialMesh::load_ma(&missing).unwrap_err();
    assert!(error.to_string().contains("missing.ma"), "{error}");
    let mesh = MedialMesh::ball(1.0).unwrap();
    for path in [
        directory.join("no/such/directory.ma"),
        directory.clone(),
        PathBuf::from("/"),
    ] {
        let error = mesh.save_ma(&path).unwrap_err();
        assert!(matches!(error, MeshError::File { .. }), "{error}");
    }
    assert!(matches!(
        MedialMesh::load_ma(&directory),
        Err(MeshError::File { .. })
    ));
    let neighbours = fs::read_dir(directory.parent().unwrap()).unwrap();
    let left = neighbours.filter(|e| {
        e.as_ref()
            .unwrap()
            .file_name()
            .to_string_lossy()
            .contains("partial")
    });
    assert_eq!(left.count(), 0, "a failed save leaves no partial file");
}

proptest! {
    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = MedialMesh::read_ma(bytes.as_slice(), Path::new("junk"));
    }

    #[test]
    fn random_words_of_the_format_never_panic(
        words in prop::collection::vec(prop::sample::select(vec![
            "v", "e", "f", "0", "1", "2", "3", "-1", "1e38", "0.5", "nan", "\n", "\n", "#", "é",
        ]), 0..120)
    ) {
        let text = format!("3 2 1\n{}", words.join(" "));
        let _ = MedialMesh::read_ma(text.as_bytes(), Path::new("junk"));
    }
}
