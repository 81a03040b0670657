//! The command line program: exit codes, one-line errors, JSON, and whole output files.

use rapier3d_medial::MedialMesh;
use serde_json::Value;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

pub fn scratch(name: &str) -> PathBuf {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("cli-{name}"));
    // What an earlier run left would hide what this one does.
    let _ = fs::remove_dir_all(&directory);
    fs::create_dir_all(&directory).unwrap();
    directory
}

pub fn medial(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_medial"))
        .args(arguments)
        .current_dir(directory)
        .output()
        .unwrap()
}

pub fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

#[track_caller]
pub fn assert_fails(output: &Output, words: &str) {
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
    assert_eq!(json["euler"], 0);
    let inertia = torus.mass_properties(1.0).principal_inertia();
    let told = json["principal_inertia"].as_array().unwrap();
    for (told, inertia) in told.iter().zip(inertia.to_array()) {
        assert!((told.as_f64().unwrap() / f64::from(inertia) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_baked_mesh_is_described_as_its_source() {
    let directory = scratch("bake");
    let torus = MedialMesh::torus(1.0, 0.25, 16).unwrap();
    torus.save_ma(directory.join("torus.ma")).unwrap();
    let output = medial(&directory, &["bake", "torus.ma", "-o", "torus.medial"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let baked = fs::read(directory.join("torus.medial")).unwrap();
    assert_eq!(baked, torus.to_bytes());
    let described = |name| medial(&directory, &["info", name]).stdout;
    assert_eq!(
        text(&described("torus.medial")),
        text(&described("torus.ma"))
    );

    fs::write(directory.join("cut.medial"), &baked[..200]).unwrap();
    let mut damaged = baked.clone();
    damaged[150] ^= 1;
    fs::write(directory.join("damaged.medial"), &damaged).unwrap();
    let bake = |input, output| medial(&directory, &["bake", input, "-o", output]);
    assert_fails(&bake("missing.ma", "out.medial"), "missing.ma");
    assert_fails(&bake("cut.medial", "out.medial"), "cut.medial: 200 bytes");
    assert_fails(&bake("torus.ma", "./torus.ma"), "is the input");
    assert_fails(
        &medial(&directory, &["info", "damaged.medial"]),
        "damaged.medial: damaged: checksum",
    );
    assert!(!directory.join("out.medial").exists());
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
    for output in ["out.obj", "out.dat", "out"] {
        assert_fails(&build("flat.obj", output), "ends in .ma or .medial");
    }
    let of_mesh = medial(&directory, &["info", "flat.obj"]);
    assert_fails(&of_mesh, "flat.obj is a triangle mesh");
    assert!(!directory.join("out.ma").exists());
    let unharmed = fs::read_to_string(directory.join("flat.obj")).unwrap();
    assert_eq!(unharmed.lines().count(), 3);
}

#[test]
fn bad_arguments_exit_with_2() {
    let directory = scratch("arguments");
    let cases: [&[&str]; 12] = [
        &[],
        &["paint"],
        &["info"],
        &["build", "in.obj"],
        &["build", "in.obj", "-o", "out.ma", "--primitives", "0"],
        &["build", "in.obj", "-o", "out.ma", "--primitives", "many"],
        &["build", "in.obj", "-o", "out.ma", "--max-error", "nan"],
        &["build", "in.obj", "-o", "out.ma", "--max-error", "0"],
        &["build", "in.obj", "-o", "out.ma", "--scale", "-1"],
        &["build", "in.obj", "-o", "out.ma", "--quiet", "--json"],
        &["compare", "in.obj", "--primitives", "0"],
        &["compare", "in.obj", "--steps", "-1"],
    ];
    for arguments in cases {
        let output = medial(&directory, arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(!output.stderr.is_empty() && output.stdout.is_empty());
    }
}

/// An L-shaped prism of volume 3: closed, concave, with concave polygons.
pub const CORNER: &str = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n\
                      v 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\n\
                      f 6 5 4 3 2 1\nf 7 8 9 10 11 12\nf 1 2 8 7\nf 2 3 9 8\n\
                      f 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n";

#[test]
fn build_writes_a_mesh_and_info_measures_it_alike() {
    let directory = scratch("build");
    fs::write(directory.join("corner.obj"), CORNER).unwrap();
    let run = [
        "build",
        "corner.obj",
        "-o",
        "out.ma",
        "--primitives",
        "30",
        "--json",
    ];
    let output = medial(&directory, &run);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let built: Value = serde_json::from_slice(&output.stdout).unwrap();
    let mesh = MedialMesh::load_ma(directory.join("out.ma")).unwrap();
    assert!(mesh.primitive_count() <= 30);
    assert_eq!(built["mesh"]["primitives"], mesh.primitive_count());
    assert_eq!(built["triangles"], 20);
    assert_eq!(built["longest_side"], 2.0);
    assert!(
        mesh.volume() > 3.0,
        "an enclosing mesh holds the volume 3 of the source"
    );

    let output = medial(
        &directory,
        &["info", "out.ma", "--against", "corner.obj", "--json"],
    );
    let info: Value = serde_json::from_slice(&output.stdout).unwrap();
    for side in ["surface_to_envelope", "envelope_to_surface"] {
        let [built, again] = [&built, &info].map(|v| v["errors"][side].as_f64().unwrap());
        assert!(built > 0.0 && built < 0.2, "{side}: {built}");
        assert!(
            (again / built - 1.0).abs() < 0.3,
            "{side}: {built} built, {again} measured"
        );
    }
    assert!(info["errors"]["uncovered"].as_f64().unwrap() < 1e-5);

    let lines = medial(&directory, &["info", "out.ma", "--against", "corner.obj"]);
    assert!(text(&lines.stdout).contains("collider to mesh"));
    assert_fails(
        &medial(&directory, &["info", "out.ma", "--against", "no.obj"]),
        "no.obj",
    );
}

/// The file is the old one or the whole new one, whenever the build is killed.
#[test]
fn an_interrupted_build_leaves_no_half_written_file() {
    let directory = scratch("interrupted");
    fs::write(directory.join("corner.obj"), CORNER).unwrap();
    fs::write(directory.join("out.ma"), "old").unwrap();
    let mut interrupted = 0;
    for delay in [0, 30, 100, 300, 1000] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_medial"))
            .args(["build", "corner.obj", "-o", "out.ma", "--primitives", "500"])
            .current_dir(&directory)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        thread::sleep(Duration::from_millis(delay));
        child.kill().unwrap();
        child.wait().unwrap();
        if fs::read_to_string(directory.join("out.ma")).unwrap() == "old" {
            interrupted += 1;
        } else {
            MedialMesh::load_ma(directory.join("out.ma")).unwrap();
            fs::write(directory.join("out.ma"), "old").unwrap();
        }
    }
    assert!(interrupted > 0);
}

/// One command builds a folder and a file beside it; a mesh that cannot be built costs only itself.
#[test]
fn several_meshes_are_built_into_a_folder() {
    let directory = scratch("several");
    fs::create_dir(directory.join("in")).unwrap();
    fs::write(directory.join("in/first.obj"), CORNER).unwrap();
    fs::write(directory.join("in/second.v2.obj"), CORNER).unwrap();
    fs::write(directory.join("in/notes.txt"), "no mesh").unwrap();
    fs::write(directory.join("broken.obj"), "v 0 0 0\nv 1 0\n").unwrap();
    let names = || {
        let entries = fs::read_dir(directory.join("out")).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name()).collect();
        names.sort();
        names
    };

    let run = ["build", "in", "-o", "out", "-p", "40", "--json"];
    let output = medial(&directory, &run);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let built: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(built.as_array().unwrap().len(), 2);
    assert_eq!(names(), ["first.ma", "second.v2.ma"]);

    let output = medial(
        &directory,
        &["build", "broken.obj", "in", "-o", "out", "-p", "40"],
    );
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("broken.obj, line 2"), "{message}");
    assert!(message.contains("1 of 3 meshes failed"), "{message}");
    // A mesh without triangles is refused without its name by what builds it.
    fs::write(directory.join("flat.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap();
    let run = ["build", "flat.obj", "in", "-o", "out", "-p", "40", "--json"];
    let output = medial(&directory, &run);
    assert!(
        text(&output.stderr).contains("medial: flat.obj: "),
        "{}",
        text(&output.stderr)
    );
    let built: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(built.as_array().unwrap().len(), 3);
    assert_eq!(built[0]["input"], "flat.obj");
    assert!(
        built[0]["error"].as_str().unwrap().contains("no triangles"),
        "{built}"
    );
    assert_eq!(names(), ["first.ma", "second.v2.ma"]);
    MedialMesh::load_ma(directory.join("out/first.ma")).unwrap();

    fs::write(directory.join("first.obj"), CORNER).unwrap();
    let twice = medial(&directory, &["build", "in", "first.obj", "-o", "out"]);
    assert_fails(&twice, "would go there");
    fs::create_dir(directory.join("empty")).unwrap();
    assert_fails(
        &medial(&directory, &["build", "empty", "-o", "out"]),
        "no triangle mesh",
    );
}

/// Millimetres with z up become metres with y up, baked, without a word.
#[test]
fn meshes_are_scaled_turned_and_baked() {
    let directory = scratch("turned");
    let plate = "v 0 0 0\nv 1000 0 0\nv 1000 2000 0\nv 0 2000 0\n\
                 v 0 0 3000\nv 1000 0 3000\nv 1000 2000 3000\nv 0 2000 3000\n\
                 f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    fs::create_dir(directory.join("in")).unwrap();
    fs::write(directory.join("in/box.obj"), plate).unwrap();
    let run = [
        "build", "in", "-o", "out", "-p", "30", "--bake", "--scale", "0.001", "--up", "z",
        "--quiet",
    ];
    let output = medial(&directory, &run);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
    let mesh = MedialMesh::load_asset(directory.join("out/box.medial")).unwrap();
    let size = mesh.aabb().extents();
    for (size, is) in size.to_array().into_iter().zip([1.0, 3.0, 2.0]) {
        assert!((size - is).abs() < 1e-4, "{size} for {is}");
    }
    assert!((mesh.mass_properties(1.0).mass() - 6.0).abs() < 1e-4);
}

/// Ctrl-C ends the build soon and in order: nothing is left, not even an unfinished file. The mesh comes through a
/// pipe, which the command opens once it listens for Ctrl-C: so the first one always comes in time, on any machine. The
/// later ones come while it builds, or after it.
#[cfg(unix)]
#[test]
fn ctrl_c_leaves_nothing() {
    let directory = scratch("ctrl-c");
    let pipe = directory.join("corner.obj");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    for delay in [None, Some(1), Some(10), Some(100), Some(300)] {
        let child = Command::new(env!("CARGO_BIN_EXE_medial"))
            .args(["build", "corner.obj", "-o", "out.ma", "--primitives", "500"])
            .current_dir(&directory)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let (opened, open) = mpsc::channel();
        let path = pipe.clone();
        thread::spawn(move || opened.send(fs::OpenOptions::new().write(true).open(path)));
        let open = open.recv_timeout(Duration::from_secs(60));
        let mut mesh = open.expect("the command reads the mesh").unwrap();
        let interrupt = || {
            let child = child.id().to_string();
            Command::new("kill")
                .args(["-INT", &child])
                .status()
                .unwrap()
        };
        if delay.is_none() {
            assert!(interrupt().success());
            thread::sleep(Duration::from_millis(300));
        }
        // A command that ends while it reads closes the pipe.
        let _ = mesh.write_all(CORNER.as_bytes());
        drop(mesh);
        if let Some(delay) = delay {
            thread::sleep(Duration::from_millis(delay));
            interrupt();
        }
        let output = child.wait_with_output().unwrap();
        let code = output.status.code();
        assert!(
            code == Some(130) || (code == Some(0) && delay.is_some()),
            "{code:?} after {delay:?}"
        );
        if code == Some(130) {
            assert!(text(&output.stderr).contains("cancelled during"));
        }
        let mut left = fs::read_dir(&directory)
            .unwrap()
            .map(|e| e.unwrap().file_name());
        let whole = |name: std::ffi::OsString| {
            name == "corner.obj" || (code == Some(0) && name == "out.ma")
        };
        assert!(left.all(whole), "{code:?}");
        let _ = fs::remove_file(directory.join("out.ma"));
    }
}

/// A file that cannot take its place is removed again.
#[test]
fn a_write_that_fails_leaves_nothing() {
    let directory = scratch("unwritable");
    fs::write(directory.join("corner.obj"), CORNER).unwrap();
    fs::create_dir_all(directory.join("out/corner.ma/taken")).unwrap();
    let run = ["build", "corner.obj", "-o", "out", "--primitives", "20"];
    assert_fails(&medial(&directory, &run), "corner.ma");
    let left: Vec<_> = fs::read_dir(directory.join("out")).unwrap().collect();
    assert_eq!(left.len(), 1, "{left:?}");
}

#[test]
fn info_succeeds_when_its_reader_closes_the_pipe() {
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
