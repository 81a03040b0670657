//! The command line program and paths that are no plain files: links, pipes, folders, names that are not UTF-8; and
//! that each message names the file and what is wrong with it.

use crate::cli::{CORNER, assert_fails, medial, scratch, text};
use rapier3d_medial::MedialMesh;
use serde_json::Value;
use std::fs;
use std::process::Command;

/// A file at the end of a link is replaced, and a pipe is written to: neither is replaced by a file of its own. (As
/// root the program once put a file in the place of `/dev/full`.)
#[cfg(unix)]
#[test]
fn links_and_pipes_stay() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let directory = scratch("links");
    let torus = MedialMesh::torus(1.0, 0.25, 16).unwrap();
    torus.save_ma(directory.join("torus.ma")).unwrap();
    let bake = |output| medial(&directory, &["bake", "torus.ma", "-o", output]);

    fs::write(directory.join("real.medial"), "old").unwrap();
    symlink("real.medial", directory.join("link.medial")).unwrap();
    let output = bake("link.medial");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let link = fs::symlink_metadata(directory.join("link.medial")).unwrap();
    assert!(link.is_symlink());
    let real = fs::read(directory.join("real.medial")).unwrap();
    assert_eq!(real, torus.to_bytes());

    let pipe = directory.join("pipe.medial");
    let made = Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    let reader = {
        let pipe = pipe.clone();
        std::thread::spawn(move || fs::read(pipe))
    };
    let output = bake("pipe.medial");
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(reader.join().unwrap().unwrap(), torus.to_bytes());
    let still = fs::symlink_metadata(&pipe).unwrap();
    assert!(still.file_type().is_fifo());
}

/// Several meshes go into a folder: where the output has the name of a file, or is one, nothing is made.
#[test]
fn several_meshes_do_not_go_into_a_file() {
    let directory = scratch("several");
    for name in ["first.obj", "second.obj"] {
        fs::write(directory.join(name), CORNER).unwrap();
    }
    fs::write(directory.join("notes"), "kept").unwrap();
    for output in ["both.medial", "both.ma", "both.obj", "notes"] {
        let run = medial(
            &directory,
            &["build", "first.obj", "second.obj", "-o", output],
        );
        let message = text(&run.stderr);
        assert!(
            !run.status.success() && message.contains(output),
            "{message}"
        );
        assert!(message.contains("name a folder"), "{message}");
        assert!(!directory.join(output).is_dir());
    }
    assert_eq!(fs::read(directory.join("notes")).unwrap(), b"kept");
}

/// What cannot be written is told before any work: before the input is read, and before a folder is made.
#[test]
fn outputs_that_cannot_be_written_are_refused_first() {
    let directory = scratch("refused");
    let long = format!("{}.medial", "a".repeat(300));
    fs::create_dir_all(directory.join("out/corner.ma")).unwrap();
    for [output, named] in [[long.as_str(); 2], ["out", "corner.ma"]] {
        let run = medial(&directory, &["build", "corner.obj", "-o", output]);
        assert_fails(&run, named);
    }
    let run = ["build", "a/same.obj", "b/same.obj", "-o", "new"];
    assert_fails(&medial(&directory, &run), "would go there");
    assert!(!directory.join("new").exists());
}

/// The ending of the output says whether it is baked, in large letters too; where something else asks for a baked file,
/// another ending is refused.
#[test]
fn the_ending_says_whether_a_file_is_baked() {
    let directory = scratch("endings");
    fs::write(directory.join("corner.obj"), CORNER).unwrap();
    let built = medial(&directory, &["build", "corner.obj", "-o", "corner.MEDIAL"]);
    assert!(built.status.success(), "{}", text(&built.stderr));
    MedialMesh::load_asset(directory.join("corner.MEDIAL")).expect("a baked mesh");
    let refused: [&[&str]; 2] = [
        &["build", "corner.obj", "--bake", "-o", "corner.ma"],
        &["bake", "corner.MEDIAL", "-o", "corner.ma"],
    ];
    for arguments in refused {
        assert_fails(&medial(&directory, arguments), "ends in .medial");
        assert!(!directory.join("corner.ma").exists());
    }
}

/// JSON cannot hold a path that is not UTF-8: its bytes are replaced there, and the file has its own name.
#[cfg(target_os = "linux")]
#[test]
fn names_need_not_be_utf_8() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let directory = scratch("names");
    let input = OsStr::from_bytes(b"corner\xff.obj");
    let output = OsStr::from_bytes(b"out\xff.medial");
    fs::write(directory.join(input), CORNER).unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_medial"))
        .arg("build")
        .arg(input)
        .arg("-o")
        .arg(output)
        .args(["-p", "20", "--quality", "fast", "--json"])
        .current_dir(&directory)
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", text(&run.stderr));
    let built: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(built["output"], "out\u{fffd}.medial");
    MedialMesh::load_asset(directory.join(output)).unwrap();
}

#[test]
fn messages_name_the_file_and_the_fault() {
    let directory = scratch("messages");
    let ball = MedialMesh::ball(1.0).unwrap();
    ball.save_ma(directory.join("ball.ma")).unwrap();
    fs::write(directory.join("empty.obj"), "").unwrap();
    fs::write(
        directory.join("far.obj"),
        "v 0 0 0\nv 1e38 0 0\nv 0 1e38 0\nf 1 2 3\n",
    )
    .unwrap();
    fs::create_dir(directory.join("folder")).unwrap();

    let run = |arguments: &[&str]| medial(&directory, arguments);
    let against = run(&["info", "ball.ma", "--against", "empty.obj"]);
    assert_fails(&against, "empty.obj: the mesh has no triangles");
    let far = run(&["build", "far.obj", "-o", "out.medial"]);
    assert_fails(&far, "far.obj: vertex 1 is too far from the origin");
    for of_folder in [
        run(&["compare", "folder"]),
        run(&["info", "--curve", "folder"]),
    ] {
        assert_fails(&of_folder, "folder: is a directory");
    }
    let mesh = run(&["bake", "empty.obj", "-o", "out.medial"]);
    assert_fails(&mesh, "medial build empty.obj -o OUT.medial");
}
