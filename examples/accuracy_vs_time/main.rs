//! What accuracy costs in time: sizes and representations, bounding volumes, tolerance and precision,
//! motion models, time steps and effects, and the paper's benchmarks, each against a truth that is
//! not ours.
//!
//! ```text
//! cargo run --release --example accuracy_vs_time              # minutes
//! cargo run --release --example accuracy_vs_time -- --quick   # under a minute
//! ```
//! Options: `--quick` (fewer motions and sizes), `--part NAME` (steps, tolerance, motion, paper or
//! collisions alone), `--mesh FILE` (your own body flies instead of the creature, scaled to its width),
//! `--out DIR` (default target/accuracy_vs_time). With `--features gpu,rapier3d/profiler` the paper's
//! benchmarks run on a device too, where there is one, and rapier's step is told apart.
//!
//! Writes a table (CSV) and a plot (SVG) for each experiment, one table of all (`accuracy.csv`) and
//! one page, `index.html`. Exits with 1 where a medial mesh missed a contact by more than its shape's
//! error, or a certified query missed one at all.

mod benchmarks;
mod bodies;
mod brute_force;
// The tests use the rest of it.
#[allow(dead_code)]
#[path = "../../tests/common/ccd/mod.rs"]
mod ccd;
#[path = "../common/mod.rs"]
mod common;
mod crash;
mod elementary;
mod outcome;
mod page;
mod paper;
mod plot;
mod random;
mod report;
mod representations;
mod stack;
mod steps;
mod trees;
mod volumes;

use bodies::Bodies;
use common::arguments::Arguments;
use common::mesh::Mesh;
use common::progress::bar;
use crash::Crash;
use peak_alloc::PeakAlloc;
use rapier3d_medial::Quality;
use rapier3d_medial::meshing::mesh_file;
use report::Section;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Counts what is allocated, to tell what a shape keeps.
#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// The experiments, as `--part` names them.
const PARTS: [&str; 5] = ["steps", "tolerance", "motion", "paper", "collisions"];

type Result<T> = std::result::Result<T, Box<dyn Error>>;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("accuracy_vs_time: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<()> {
    let mut arguments = Arguments::from_env();
    let quick = arguments.flag("--quick");
    let part: Option<String> = arguments.value("--part")?;
    let mesh: Option<PathBuf> = arguments.value("--mesh")?;
    let out = arguments.value("--out")?;
    let out: PathBuf = out.unwrap_or_else(|| "target/accuracy_vs_time".into());
    arguments.finish()?;
    fs::create_dir_all(&out)?;
    let start = Instant::now();

    let own = mesh.map(mesh_file::read).transpose()?.map(|read| Mesh {
        vertices: read.vertices,
        indices: read.indices,
    });
    let mut sections = Vec::new();
    // What is measured is written at once: a run that is stopped has given what it came to.
    let mut add = |more: Vec<Section>| {
        sections.extend(more);
        write(&sections, &out)
    };
    if let Some(unknown) = part.as_ref().filter(|part| !PARTS.contains(&part.as_str())) {
        return Err(format!("--part cannot be `{unknown}`: it is one of {PARTS:?}").into());
    }
    let queries = if quick { 1_000 } else { 6_000 };
    let seconds = if quick { 1.0 } else { 4.0 };
    for name in PARTS {
        if part.as_ref().is_some_and(|part| part != name) {
            continue;
        }
        match name {
            "steps" => {
                add(with_bar(name, 40, |tick| steps::measure(seconds, tick)).map(|s| vec![s])?)?
            }
            "tolerance" => add(with_bar(name, 24, |tick| {
                vec![elementary::tolerance(queries, tick)]
            }))?,
            "motion" => add(with_bar(name, 6, |tick| {
                vec![elementary::motion(queries / 4, tick)]
            }))?,
            "paper" => add(with_bar(name, 9, |tick| paper::measure(quick, tick))?)?,
            _ => collisions(quick, &own, &mut add)?,
        }
    }
    println!("{}", out.join("index.html").display());
    println!("{:.0} s", start.elapsed().as_secs_f64());
    check(&sections)
}

/// The creature and the blob: all representations, the grid, the trees.
fn collisions(
    quick: bool,
    own: &Option<Mesh>,
    add: &mut dyn FnMut(Vec<Section>) -> Result<()>,
) -> Result<()> {
    let (motions, sizes, quality): (usize, &[usize], _) = if quick {
        (4, &[20, 100, 500], Quality::Fast)
    } else {
        let sizes = &[20, 50, 100, 500, 1000, 2000, 5000];
        (40, sizes, Quality::default())
    };
    let cells = crash::SPEEDS.len() * crash::TURNS.len();
    let crash = with_bar("truth", motions * cells, |tick| {
        Crash::new(own.clone(), motions, tick)
    });
    let medial = with_bar("build", sizes.len(), |tick| {
        Bodies::medial(&crash.meshes, sizes, quality, tick)
    })?;
    let find = |size| sizes.iter().position(|s| *s == size);
    let default = &medial[find(500).expect("a size that is always built")];
    let peers = with_bar("peers", 1, |_| {
        Bodies::peers(&crash.meshes, default.spheres, quick)
    });
    let asked = |b: &Bodies| crash.cases.len().div_ceil(b.every);
    let ticks = medial.iter().chain(&peers).map(asked).sum();
    add(with_bar("representations", ticks, |tick| {
        representations::measure(&crash, &medial, &peers, tick)
    }))?;
    add(with_bar("grid", crash.cases.len(), |tick| {
        vec![representations::grid(&crash, default, tick)]
    }))?;
    let points = if quick { 20_000 } else { 200_000 };
    add(with_bar("leaves", medial.len(), |tick| {
        vec![trees::quality(&crash, &medial, points, tick)]
    }))?;
    let source = crash.meshes[0].vertices.len();
    let (vertices, every) = match quick {
        true => (vec![default.spheres, 1_000], 2),
        false => (vec![default.spheres, 1_000, 3_000, source], 5),
    };
    let few: Vec<&Bodies> = medial.iter().filter(|b| b.parts > 50).collect();
    let asked = crash.cases.len().div_ceil(every) * (few.len() + 2 * vertices.len());
    add(with_bar("trees", asked, |tick| {
        vec![trees::queries(&crash, &few, &vertices, every, tick)]
    }))?;
    Ok(())
}

/// Runs an experiment under a progress bar of some ticks.
fn with_bar<T>(name: &'static str, ticks: usize, run: impl FnOnce(&(dyn Fn() + Sync)) -> T) -> T {
    let bar = bar(name, ticks);
    let start = Instant::now();
    let result = run(&|| bar.inc(1));
    bar.finish();
    println!("{name}: {:.1} s", start.elapsed().as_secs_f64());
    result
}

/// The tables, the plots, all tables in one file, and the page.
fn write(sections: &[Section], out: &Path) -> Result<()> {
    let machine = machine();
    let mut all = format!("# {machine}\n");
    for section in sections {
        let csv = section.csv();
        fs::write(out.join(section.name).with_extension("csv"), &csv)?;
        all += &format!("# {}\n{csv}", section.name);
        let svg = plot::svg(&section.plot)?;
        fs::write(out.join(section.name).with_extension("svg"), svg)?;
    }
    fs::write(out.join("accuracy.csv"), all)?;
    let index = out.join("index.html");
    fs::write(&index, page::page(sections, &machine)?)?;
    Ok(())
}

/// The processor and the number of threads: what the times are of.
fn machine() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find(|line| line.starts_with("model name"));
    let name = name.and_then(|line| line.split(": ").nth(1));
    let name = name.unwrap_or("unknown processor");
    format!(
        "{name}, one thread, {} {}.",
        std::env::consts::OS,
        std::env::consts::ARCH
    )
}

/// What must hold whatever the machine: certified queries miss nothing, and where triangles and
/// medial meshes disagree, it is by no more than their shapes.
fn check(sections: &[Section]) -> Result<()> {
    let mut failures = Vec::new();
    for section in sections {
        let column = |name| section.head.iter().position(|head| *head == name);
        let column = column("beyond shape error").or(column("missed"));
        for row in &section.rows {
            let certified = ["medial mesh", "certified", "exact", "all, default"];
            let certified = certified.iter().any(|start| row[0].starts_with(start));
            if certified && column.is_some_and(|c| row[c] != "0") {
                failures.push(format!("{}: {}", section.name, row.join(" ")));
            }
        }
    }
    match failures[..] {
        [] => Ok(()),
        _ => Err(failures.join("\n").into()),
    }
}
