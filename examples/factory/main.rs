//! Threads, pegs and gears at real scale, as in NVIDIA's Factory: metres and kilograms, millimetres of thread, tenths
//! of a millimetre of play. Everything is made in code.
//!
//! ```text
//! cargo run --release --example factory
//! ```
//! Options: `--part NAME` (nuts, locks, pegs, gears or rivals alone), `--hertz N` (steps in a second, default 120),
//! `--unit M` (rapier's length unit, default 0.001), `--thread NAME` (of the nuts one alone, such as "M8 tight"),
//! `--out DIR` (where the picture goes; default target/factory).
//!
//! Exits with 1 where a medial nut leaves its thread, one that is turned by a torque jams, its advance is 2 % off the
//! pitch, a peg jams, or the gears' ratio is off by more than 0.1 %. Nuts that go down by their weight alone may be
//! slow.

#[path = "../common/mod.rs"]
mod common;
mod gear;
mod nut;
mod peg;
mod picture;
mod solid;
mod thread;

use common::arguments::{Arguments, example, verdict};
use common::progress::bar;
use common::table::Table;
use nut::{Descent, Drive};
use peg::Shape;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;
use thread::{THREADS, Thread};

/// What bodies collide as.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Medial,
    Hull,
    Parts,
    Triangles,
}

impl Kind {
    /// rapier's collider of a triangle mesh.
    fn collider(
        self,
        vertices: Vec<Vector>,
        indices: Vec<[u32; 3]>,
    ) -> Result<ColliderBuilder, String> {
        match self {
            Self::Hull => ColliderBuilder::convex_hull(&vertices).ok_or("no hull".to_string()),
            Self::Parts => Ok(ColliderBuilder::convex_decomposition(&vertices, &indices)),
            _ => ColliderBuilder::trimesh(vertices, indices).map_err(|e| e.to_string()),
        }
    }
}

/// How worlds are stepped.
struct Setting {
    hertz: Real,
    unit: Real,
    /// The one thread to be turned.
    thread: Option<String>,
}

impl Setting {
    fn world(&self) -> PhysicsWorld {
        let mut world = PhysicsWorld::new();
        let parameters = IntegrationParameters::for_detail(self.unit);
        world.integration_parameters = parameters.expect("checked at the start");
        world.integration_parameters.dt = 1.0 / self.hertz;
        world
    }
}

fn main() -> ExitCode {
    let options = |arguments: &mut Arguments| {
        let setting = Setting {
            hertz: arguments.value("--hertz")?.unwrap_or(120.0),
            unit: arguments.value("--unit")?.unwrap_or(0.001),
            thread: arguments.value("--thread")?,
        };
        let part: Option<String> = arguments.value("--part")?;
        let out: Option<PathBuf> = arguments.value("--out")?;
        Ok((setting, part, out.unwrap_or("target/factory".into())))
    };
    example(options, |(setting, part, out)| {
        IntegrationParameters::for_detail(setting.unit).map_err(|e| e.to_string())?;
        let wanted = |name: &str| part.as_ref().is_none_or(|part| part == name);
        let mut failures = Vec::new();
        if wanted("nuts") {
            failures.extend(nuts(&setting, &out)?);
        }
        if wanted("locks") {
            locks(&setting)?;
        }
        if wanted("pegs") {
            failures.extend(pegs(&setting)?);
        }
        if wanted("gears") {
            failures.extend(gears(&setting)?);
        }
        if wanted("rivals") {
            rivals(&setting)?;
        }
        verdict(failures)
    })
}

fn row(table: &mut Table, name: &str, descent: &Descent, thread: &Thread) {
    let number = |x: Option<f64>, digits: usize| match x {
        Some(x) => format!("{x:.digits$}"),
        None => "-".to_string(),
    };
    let [median, worst] = descent.milliseconds;
    table.row(
        name,
        [
            format!("{:.2}", descent.turns),
            number(descent.known, 2),
            number(descent.advance(thread), 3),
            format!("{:.2}", descent.off),
            format!("{:.3}", 1.0e3 * descent.depth),
            descent.contacts.to_string(),
            format!("{median:.2}"),
            format!("{worst:.2}"),
            format!("{:.2}", descent.contact_milliseconds),
        ],
    );
}

fn header() -> Table {
    let mut table = Table::default();
    let names = [
        "turns",
        "by theory",
        "advance/pitch",
        "off/play",
        "depth mm",
        "contacts",
        "ms p50",
        "ms worst",
        "ms contacts",
    ];
    table.row("", names);
    table
}

fn nuts(setting: &Setting, out: &std::path::Path) -> Result<Vec<String>, String> {
    let mut failures = Vec::new();
    let mut table = header();
    let is_wanted = |t: &&Thread| setting.thread.as_ref().is_none_or(|name| name == t.name);
    let threads: Vec<Thread> = THREADS.iter().filter(is_wanted).copied().collect();
    let progress = bar("nuts", 3 * threads.len());
    progress.tick();
    for thread in threads {
        let made = nut::colliders(&thread, Kind::Medial)?;
        // Three turns without friction.
        let three = (6.0 * thread.pitch / thread.acceleration()).sqrt();
        let drives = [
            ("weight", Drive::Weight(0.0), three),
            ("torque", Drive::Torque, 0.6),
            ("hammer", Drive::Hammer, 1.0),
        ];
        for (how, drive, seconds) in drives {
            let descent = nut::turn(&thread, &made, (Kind::Medial, drive), setting, seconds);
            let name = format!("{}, {how}", thread.name);
            row(&mut table, &name, &descent, &thread);
            progress.inc(1);
            if descent.tunnels() {
                failures.push(format!("{name}: the nut left its thread"));
            }
            let off = descent.advance(&thread).map(|a| (a - 1.0).abs());
            let is_slow = off.is_none() && drive != Drive::Torque;
            if drive != Drive::Hammer && !is_slow && !off.is_some_and(|off| off < 0.02) {
                failures.push(format!("{name}: the advance is off by {off:?}"));
            }
            if thread.name == "M20 loose" && how == "weight" {
                picture::nut(&thread, &descent, out)?;
            }
        }
    }
    progress.finish_and_clear();
    println!("{table}");
    Ok(failures)
}

/// From which friction on a nut stays where it is.
fn locks(setting: &Setting) -> Result<(), String> {
    let thread = THREADS[0];
    let made = nut::colliders(&thread, Kind::Medial)?;
    let locks = thread.locks_at();
    println!(
        "\n{} locks at a friction of {locks:.4} by theory",
        thread.name
    );
    for share in [0.8, 0.9, 0.95, 1.05, 1.1, 1.2] {
        let drive = Drive::Weight((share * locks) as Real);
        let descent = nut::turn(&thread, &made, (Kind::Medial, drive), setting, 1.0);
        println!("{share} of it: {:.3} turns in a second", descent.turns);
    }
    Ok(())
}

fn pegs(setting: &Setting) -> Result<Vec<String>, String> {
    let mut failures = Vec::new();
    let mut table = Table::default();
    table.row(
        "",
        ["in after s", "mm inside", "depth mm", "ms p50", "ms worst"],
    );
    println!("\npegs fall freely in {:.3} s", peg::free_fall());
    let progress = bar("pegs", 6);
    for shape in [Shape::Round, Shape::Square] {
        for kind in [Kind::Medial, Kind::Triangles, Kind::Parts] {
            let made = peg::colliders(shape, kind)?;
            let slide = peg::slide(shape, &made, kind, setting);
            progress.inc(1);
            let [median, worst] = slide.milliseconds;
            let seconds = slide.seconds.map(|s| format!("{s:.3}"));
            table.row(
                &format!("{shape:?}, {kind:?}"),
                [
                    seconds.unwrap_or("never".to_string()),
                    format!("{:.2}", 1.0e3 * slide.inside),
                    format!("{:.4}", 1.0e3 * slide.depth),
                    format!("{median:.2}"),
                    format!("{worst:.2}"),
                ],
            );
            if kind == Kind::Medial && slide.seconds.is_none() {
                failures.push(format!("the peg {shape:?} jams"));
            }
        }
    }
    progress.finish_and_clear();
    println!("{table}");
    Ok(failures)
}

fn gears(setting: &Setting) -> Result<Vec<String>, String> {
    let drive = gear::drive(setting, 10.0)?;
    let errors = [1, 2].map(|k| drive.error(k));
    let [median, worst] = drive.milliseconds;
    println!(
        "\ngears of {:?} teeth and {:?} primitives: turned {:.3?} rad, ratios off by {:.5?}, {median:.2} ms a step, at worst {worst:.2}",
        gear::TEETH,
        drive.primitives,
        drive.angles,
        errors
    );
    let failed = errors.iter().any(|e| e.abs() >= 0.001 || e.is_nan());
    Ok(failed
        .then(|| format!("ratios off by {errors:?}"))
        .into_iter()
        .collect())
}

/// rapier's own shapes of the loosest thread.
fn rivals(setting: &Setting) -> Result<(), String> {
    let thread = THREADS[0];
    let mut table = header();
    let progress = bar("rapier's own", 6);
    for kind in [Kind::Hull, Kind::Parts, Kind::Triangles] {
        let clock = Instant::now();
        let made = nut::colliders(&thread, kind)?;
        let built = clock.elapsed().as_secs_f64();
        for (how, drive) in [("weight", Drive::Weight(0.0)), ("hammer", Drive::Hammer)] {
            let descent = nut::turn(&thread, &made, (kind, drive), setting, 0.5);
            row(
                &mut table,
                &format!("{kind:?}, {how}, built in {built:.1} s"),
                &descent,
                &thread,
            );
            progress.inc(1);
        }
    }
    progress.finish_and_clear();
    println!("\n{}, rapier's own:\n{table}", thread.name);
    Ok(())
}
