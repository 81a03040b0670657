//! The command line program where an error is asked for: tolerances in a unit, and curves of error by count.

use crate::cli::{CORNER, assert_fails, medial, scratch, text};
use rapier3d_medial::MedialMesh;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The unit cube, as a file.
fn write_cube(directory: &Path) {
    let mut text = String::new();
    for k in 0..8 {
        text += &format!("v {} {} {}\n", k & 1, k >> 1 & 1, k >> 2);
    }
    for [a, b, c, d] in [
        [1, 3, 4, 2],
        [5, 6, 8, 7],
        [1, 2, 6, 5],
        [3, 7, 8, 4],
        [1, 5, 7, 3],
        [2, 4, 8, 6],
    ] {
        text += &format!("f {a} {b} {c} {d}\n");
    }
    fs::write(directory.join("cube.obj"), text).unwrap();
}

#[test]
fn a_tolerance_is_a_length_in_a_known_unit() {
    let directory = scratch("tolerance");
    write_cube(&directory);
    let build = |more: &[&str]| {
        let mut arguments = vec!["build", "cube.obj", "-o", "cube.ma", "-q", "fast", "--json"];
        arguments.extend(more);
        medial(&directory, &arguments)
    };
    // In its own unit, or that of the file: .4 of the cube's side allows one ball, a thousandth does not.
    for (tolerance, unit, count) in [
        ("0.4", None, 1),
        ("4mm", Some("cm"), 1),
        ("0.4 m", Some("m"), 1),
        ("1e-3", None, 12),
        ("1mm", Some("m"), 12),
    ] {
        let mut more = vec!["--tolerance", tolerance];
        more.extend(unit.into_iter().flat_map(|unit| ["--unit", unit]));
        let output = build(&more);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(json["mesh"]["primitives"], count, "{tolerance} {unit:?}");
        assert_eq!(json["target_reached"], true);
    }
    assert_fails(&build(&["--tolerance", "0.02mm"]), "say --unit mm");
    for (more, words) in [
        (["--tolerance", "0"], "positive"),
        (["--tolerance=-1mm", "--unit=mm"], "positive"),
        (["--tolerance", "NaN"], "positive"),
        (["--tolerance", "inf"], "positive"),
        (["--tolerance", "1furlong"], "unknown unit \"furlong\""),
        (["--tolerance", "mm"], "as 0.02mm"),
        (["--unit", "parsec"], "unknown unit"),
        (["--max-error", "0"], "positive"),
        (["--max-error=-0.1", "--unit=mm"], "positive"),
    ] {
        let output = build(&more);
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        assert!(
            text(&output.stderr).contains(words),
            "{}",
            text(&output.stderr)
        );
    }
}

#[test]
fn a_curve_lists_errors_by_count() {
    let directory = scratch("curve");
    write_cube(&directory);
    let curve = [
        "info", "cube.obj", "--curve", "--counts", "12,3", "-q", "fast",
    ];
    let output = medial(&directory, &curve);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let rows: Vec<Vec<f64>> = text(&output.stdout)
        .lines()
        .skip(2)
        .map(|row| row.split_whitespace().map(|x| x.parse().unwrap()).collect())
        .collect();
    assert_eq!([rows[0][0], rows[1][0]], [3.0, 12.0]);
    assert!(rows[0][1] > 0.05 && rows[1][1] < 1e-6, "{rows:?}");

    // A concave body of flat faces is exact here too, as it is when it is built.
    fs::write(directory.join("corner.obj"), CORNER).unwrap();
    let curve = [
        "info",
        "corner.obj",
        "--curve",
        "--counts",
        "20,50",
        "--json",
    ];
    let curve: Value = serde_json::from_slice(&medial(&directory, &curve).stdout).unwrap();
    let error = |k: usize| curve["points"][k]["error"].as_f64().unwrap();
    assert!(error(0) > 0.01 && error(1) < 1e-5, "{curve}");

    // In another unit all errors are in that unit; they are told as parts of the longest side, which is told too.
    let scaled = [
        "info", "cube.obj", "--curve", "--counts", "3", "-q", "fast", "--scale", "0.001", "--json",
    ];
    let scaled: Value = serde_json::from_slice(&medial(&directory, &scaled).stdout).unwrap();
    let side = scaled["longest_side"].as_f64().unwrap();
    assert!((0.0009..0.0021).contains(&side), "{scaled}");

    MedialMesh::ball(1.0)
        .unwrap()
        .save_ma(directory.join("ball.ma"))
        .unwrap();
    let of_ball = medial(&directory, &["info", "ball.ma", "--curve"]);
    assert_fails(&of_ball, "ball.ma is not a triangle mesh");
    assert_fails(
        &medial(&directory, &["info", "no.obj", "--curve"]),
        "no.obj",
    );
}
