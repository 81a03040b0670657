//! The command line program: exit codes, one-line errors, JSON, and whole output files.

use rapier3d_medial::MedialMesh;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn scratch(name: &str) -> PathBuf {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("cli-{name}"));
    // What an earlier run left would hide what this one does.
    let _ = fs::remove_dir_all(&directory);
    fs::create_dir_all(&directory).unwrap();
    directory
}

fn medial(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_medial"))
        .args(arguments)
        .current_dir(directory)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

#[track_caller]
fn assert_fails(output: &Output, words: &str) {
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains(words), "{message:?} lacks {words:?}");
    assert_eq!(message.trim_end().lines().count(), 1, "{message:?}");
    assert!(output.stdout.is_empty());
}

#[test]
fn info_describes_a_mesh() {
    let directory = scratch("info");
    let torus = MedialMesh::torus(1.0, 0.25, 16).unwrap();
    torus.save_ma(directory.join("torus.ma")).unwrap();

    let output = medial(&directory, &["info", "torus.ma"]);
    assert!(output.status.success());
    let lines = text(&output.stdout);
    assert!(
        lines.contains("primitives  16: slabs 0, cones 16, lone spheres 0"),
        "{lines}"
    );

    let output = medial(&directory, &["info", "torus.ma", "--json"]);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["spheres"], 16);
    assert_eq!(json["cones"], 16);
    assert_eq!(json["slabs"], 0);
    let volume = json["volume"].as_f64().unwrap();
    assert!((volume - f64::from(torus.volume())).abs() < 1e-6);
    assert_eq!(json["box_max"][0], 1.25);
}

#[test]
fn failures_are_one_line_and_exit_code_1() {
    let directory = scratch("failures");
    fs::write(directory.join("broken.ma"), "2 0 0\nv 0 0 0 1\nv 0 0 x 1\n").unwrap();
    fs::write(directory.join("broken.obj"), "v 0 0 0\nv 1 0\n").unwrap();
    fs::write(directory.join("flat.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap();
    fs::write(
        directory.join("broken.ply"),
        "ply\nformat ascii 1.0\nelement\n",
    )
    .unwrap();

    assert_fails(&medial(&directory, &["info", "missing.ma"]), "missing.ma");
    assert_fails(
        &medial(&directory, &["info", "broken.ma"]),
        "broken.ma, line 3",
    );
    assert_fails(&medial(&directory, &["info", "."]), ".");
    let build = |input, output| medial(&directory, &["build", input, "-o", output]);
    assert_fails(&build("missing.obj", "out.ma"), "missing.obj");
    assert_fails(&build("mesh.gltf", "out.ma"), "gltf");
    assert_fails(&build("broken.obj", "out.ma"), "broken.obj, line 2");
    assert_fails(&build("broken.ply", "out.ma"), "broken.ply, line 3");
    assert_fails(&build("flat.obj", "out.ma"), "no triangles");
    assert_fails(&build("flat.obj", "no/such/out.ma"), "no/such");
    assert_fails(&build("flat.obj", "./flat.obj"), "is the input");
    assert!(!directory.join("out.ma").exists());
    let unharmed = fs::read_to_string(directory.join("flat.obj")).unwrap();
    assert_eq!(unharmed.lines().count(), 3);
}

#[test]
fn bad_arguments_exit_with_2() {
    let directory = scratch("arguments");
    let cases: [&[&str]; 8] = [
        &[],
        &["paint"],
        &["info"],
        &["build", "in.obj"],
        &["build", "in.obj", "-o", "out.ma", "--primitives", "0"],
        &["build", "in.obj", "-o", "out.ma", "--primitives", "many"],
        &["build", "in.obj", "-o", "out.ma", "--max-error", "nan"],
        &["build", "in.obj", "-o", "out.ma", "--max-error", "0"],
    ];
    for arguments in cases {
        let output = medial(&directory, arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(!output.stderr.is_empty() && output.stdout.is_empty());
    }
}

#[test]
fn a_reader_that_went_away_is_no_failure() {
    let directory = scratch("pipe");
    MedialMesh::ball(1.0)
        .unwrap()
        .save_ma(directory.join("ball.ma"))
        .unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_medial"))
        .args(["info", "ball.ma"])
        .current_dir(&directory)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(output.stderr.is_empty());
}
