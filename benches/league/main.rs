//! The league: the same scenes on this crate, on rapier, and on other engines, judged by one judge.
//!
//! `bash benches/league/run.sh` does all of it. The steps of it that are in Rust:
//!
//! ```text
//! cargo bench --bench league -- scenes [--quick]   writes target/league/scenes.json
//! cargo bench --bench league -- run                rapier and this crate, into target/league/runs/
//! cargo bench --bench league -- judge              all runs there: target/league/league.{json, md, png}
//! ```

mod circles;
#[path = "../../examples/common/mod.rs"]
mod common;
mod page;
mod picture;
mod record;
mod rust;
mod scenes;
mod verdict;

use common::arguments::{Arguments, example};
use record::Run;
use scenes::League;
use serde::{Serialize, de::DeserializeOwned};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use verdict::Verdict;

/// Where everything is written, from the crate's root.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/target/league");

struct Options {
    scenes: bool,
    run: bool,
    judge: bool,
    quick: bool,
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<T, String> {
    let text = fs::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
    serde_json::from_slice(&text).map_err(|e| format!("{}: {e}", path.display()))
}

fn write(path: &Path, text: &[u8]) -> Result<(), String> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
}

fn json(value: &impl Serialize) -> Result<Vec<u8>, String> {
    serde_json::to_vec(value).map_err(|e| e.to_string())
}

/// The runs of all engines, this crate's first.
fn runs(folder: &Path) -> Result<Vec<Run>, String> {
    let files = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut paths: Vec<PathBuf> = files.filter_map(|f| Some(f.ok()?.path())).collect();
    paths.retain(|p| p.extension().is_some_and(|e| e == "json"));
    let mut runs = paths
        .iter()
        .map(|p| read(p))
        .collect::<Result<Vec<Run>, _>>()?;
    runs.sort_by_key(|r| {
        (
            r.engine != "rapier3d-medial",
            r.engine.clone(),
            r.setting.clone(),
        )
    });
    Ok(runs)
}

fn judge(folder: &Path, league: &League) -> Result<(), String> {
    verdict::check_planted(league)?;
    let runs = runs(&folder.join("runs"))?;
    let verdicts: Vec<_> = runs.iter().map(|run| Verdict::new(league, run)).collect();
    write(&folder.join("league.json"), &json(&verdicts)?)?;
    let page = page::page(&verdicts);
    write(&folder.join("league.md"), page.as_bytes())?;
    println!("{page}");
    picture::draw(league, &runs, &folder.join("league.png"))
}

fn work(options: Options) -> Result<(), String> {
    let folder = Path::new(FOLDER);
    let scenes = folder.join("scenes.json");
    if options.scenes {
        write(&scenes, &json(&League::new(options.quick))?)?;
    }
    let league: League = read(&scenes)?;
    if options.run {
        for run in rust::runs(&league)? {
            let name = format!("{} {}.json", run.engine, run.setting);
            write(&folder.join("runs").join(name), &json(&run)?)?;
        }
    }
    if options.judge {
        judge(folder, &league)?;
    }
    Ok(())
}

fn main() -> ExitCode {
    let options = |arguments: &mut Arguments| {
        // Cargo adds it.
        arguments.flag("--bench");
        Ok(Options {
            scenes: arguments.flag("scenes"),
            run: arguments.flag("run"),
            judge: arguments.flag("judge"),
            quick: arguments.flag("--quick"),
        })
    };
    example(options, work)
}
