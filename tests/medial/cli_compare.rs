//! `medial compare`: its figures beside what is known of the body, its picture, and what it refuses.

use crate::cli::{CORNER, assert_fails, medial, scratch, text};
use serde_json::Value;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

const KINDS: [&str; 4] = [
    "medial mesh",
    "convex decomposition",
    "convex hull",
    "triangle mesh",
];

/// Width, height and pixels (red, green, blue) of a picture.
fn pixels(path: &Path) -> ([u32; 2], Vec<u8>) {
    let decoder = png::Decoder::new(BufReader::new(File::open(path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgb);
    ([info.width, info.height], bytes)
}

/// The hull of an L of three unit cubes bridges its inner corner: the middle of the bridge is 1/2 from the faces of the
/// L, of its longest side 2.
#[test]
fn errors_are_those_of_a_known_body() {
    let directory = scratch("compare");
    // A vertex that no triangle uses is no part of the body.
    let stray = "v 9 9 9\n".to_owned();
    fs::write(directory.join("corner.obj"), CORNER.to_owned() + &stray).unwrap();
    let run = [
        "compare",
        "corner.obj",
        "-p",
        "40",
        "-o",
        "out.png",
        "--steps",
        "3",
        "--json",
    ];
    let output = medial(&directory, &run);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["triangles"], 20);
    assert_eq!(json["longest_side"], 2.0);
    assert_eq!(json["steps"], 3);
    let rows = json["colliders"].as_array().unwrap();
    let names: Vec<_> = rows.iter().map(|row| row["collider"].as_str()).collect();
    assert_eq!(names, KINDS.map(Some));
    for row in rows {
        let times = &row["step_milliseconds"];
        let [mean, longest] = ["mean", "longest"].map(|k| times[k].as_f64().unwrap());
        assert!(mean > 0.0 && longest >= mean, "{times}");
        assert!(row["seconds_to_build"].as_f64().unwrap() >= 0.0);
    }
    let error = |row: usize| rows[row]["error"].as_f64().unwrap();
    // Points of the hull's slanted face are at most 1/2 from the faces of the L: (1.5, 1.5) from x = 1 and y = 1.
    assert!((error(2) - 0.5 / 2.0).abs() < 2e-3, "{}", error(2));
    assert!(error(0) > 0.0 && error(0) < 0.1, "{}", error(0));
    assert!(error(1) < error(2), "{}", error(1));
    assert!(rows[0]["pieces"].as_u64().unwrap() <= 40);
    assert_eq!(rows[2]["pieces"], 1);
    assert_eq!(rows[3]["pieces"], 20);
    assert_eq!(error(3), 0.0);

    let ([width, height], bytes) = pixels(&directory.join("out.png"));
    assert_eq!([width, height], [908, 604]);
    // The hull, last in the second row, is drawn red where the first tile has the grey body.
    let middle = |column: usize, row: usize| {
        let (x, y) = (304 * column + 150, 304 * row + 150);
        let at = 3 * (y * width as usize + x);
        [bytes[at], bytes[at + 1], bytes[at + 2]].map(i32::from)
    };
    let red = |[r, g, b]: [i32; 3]| r > g + 40 && r > b + 40;
    assert!(red(middle(2, 1)), "{:?}", middle(2, 1));
    assert!(!red(middle(0, 0)), "{:?}", middle(0, 0));
}

#[test]
fn the_table_names_each_collider() {
    let directory = scratch("compare-table");
    fs::write(directory.join("corner.obj"), CORNER).unwrap();
    let run = ["compare", "corner.obj", "-p", "20", "-q", "fast"];
    let output = medial(&directory, &[&run[..], &["--steps", "0"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let lines = text(&output.stdout);
    assert!(lines.starts_with("compare.png\n"), "{lines}");
    for name in KINDS {
        assert!(lines.lines().any(|l| l.starts_with(name)), "{lines}");
    }
    assert!(!lines.contains("ms a step"), "no step was timed: {lines}");
    assert!(directory.join("compare.png").is_file());
}

#[test]
fn compare_names_what_it_cannot_compare() {
    let directory = scratch("compare-refused");
    fs::write(directory.join("corner.obj"), CORNER).unwrap();
    fs::write(directory.join("notes.txt"), "no mesh").unwrap();
    fs::write(directory.join("empty.obj"), "v 0 0 0\n").unwrap();
    let line = "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n";
    fs::write(directory.join("line.obj"), line).unwrap();
    fs::create_dir(directory.join("folder.png")).unwrap();
    let compare = |mesh: &str, output: &str| {
        let run = ["compare", mesh, "-o", output, "--steps", "0", "-q", "fast"];
        medial(&directory, &run)
    };
    assert_fails(&compare("missing.obj", "out.png"), "missing.obj");
    assert_fails(&compare("notes.txt", "out.png"), "notes.txt");
    assert_fails(&compare("empty.obj", "out.png"), "empty.obj");
    assert_fails(&compare("line.obj", "out.png"), "line.obj");
    assert_fails(&compare("corner.obj", "out.jpg"), "ends in .png");
    assert_fails(&compare("corner.obj", "folder.png"), "folder.png");
    assert_fails(&compare("corner.obj", "no/such/out.png"), "no/such");
    assert!(!directory.join("out.png").exists());
}
