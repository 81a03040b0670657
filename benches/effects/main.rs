//! What each effect costs and what goes wrong without it: the table of docs/measurements/effects.md.
//!
//! ```text
//! cargo bench --bench effects              # some minutes
//! cargo bench --bench effects -- --quick   # a minute: fewer flights and heaps
//! cargo bench --bench effects -- --planted # seconds: the planted scenes only
//! cargo bench --bench effects -- --sweep   # the event loop's constants, halved and doubled
//! ```
//!
//! Pairs and heaps, on seeds that no test uses: fast bodies that surely meet or surely do
//! not, judged by free flights without colliders; heaps of closed loops thrown together at 60 m/s, judged
//! by linking numbers; loops that fall and come to rest; and, without times, three kinds in which the
//! answer is planted. Every row runs the same scenes; the rows take
//! turns, each three times, and a step counts with the least of its three times.

#[allow(dead_code, reason = "shared with the tests")]
#[path = "../../tests/common/bodies.rs"]
mod bodies;
#[allow(dead_code, reason = "shared with the benches")]
#[path = "../common/mod.rs"]
mod common;
#[allow(dead_code, reason = "shared with the tests")]
#[path = "../../tests/scenes/fast_pairs.rs"]
mod fast_pairs;
#[allow(dead_code, reason = "shared with the tests")]
#[path = "../../tests/scenes/heaps.rs"]
mod heaps;
#[path = "../../tests/common/linking.rs"]
mod linking;
#[path = "../../tests/scenes/oracle.rs"]
mod oracle;
mod planted;
#[path = "../../tests/common/random.rs"]
mod random;
mod scenes;
mod sweep;

use common::processor;
use rapier3d_medial::prelude::*;
use rapier3d_medial::rapier::Tuning;
use scenes::{Calm, Flights, Heaps, Stepper};

/// Turns of each row.
const TURNS: usize = 3;

/// How a row of the table steps its worlds.
fn rows() -> Vec<(&'static str, Stepper)> {
    let but = |change: fn(&mut Effects)| {
        let mut effects = Effects::default();
        change(&mut effects);
        Stepper::Medial(effects, Tuning::default())
    };
    vec![
        ("all automatic", but(|_| ())),
        ("without `continuous`", but(|e| e.continuous = Effect::Off)),
        ("without `guard`", but(|e| e.guard = Effect::Off)),
        (
            "without `exact_rotation`",
            but(|e| e.exact_rotation = Effect::Off),
        ),
        (
            "without `full_manifolds`",
            but(|e| e.full_manifolds = Effect::Off),
        ),
        ("with `stop` (paper, §4.5)", but(|e| e.stop = Effect::On)),
        (
            "`speculative` alone",
            but(|e| {
                e.continuous = Effect::Off;
                e.guard = Effect::Off;
                e.speculative = Effect::On;
            }),
        ),
        ("all off", Stepper::Medial(Effects::OFF, Tuning::default())),
        ("rapier's own step", Stepper::Rapier),
    ]
}

fn main() {
    let asked = |option: &str| std::env::args().any(|a| a == option);
    println!("{}", processor());
    if asked("--sweep") {
        return sweep::sweep();
    }
    let quick = asked("--quick");
    let rows = rows();
    if asked("--planted") {
        return planted::table(&rows);
    }
    let steppers: Vec<Stepper> = rows.iter().map(|(_, s)| *s).collect();
    let name = |k: usize| rows[k].0;

    let flights = Flights::new(
        7_201,
        if quick { 150 } else { 1_500 },
        if quick { 20 } else { 100 },
    );
    println!(
        "\nTwo fast bodies: {} sure contacts, {} sure misses\n",
        flights.contacts, flights.clear
    );
    println!(
        "| | µs per step | missed | ghosts | first change p50 / p95 | final velocity p50 / p95 | queries, impacts, stops per flight |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (k, row) in flights.run(&steppers, TURNS).into_iter().enumerate() {
        println!("| {} | {row} |", name(k));
    }

    let seeds = if quick { 2 } else { 6 };
    println!(
        "\n{seeds} heaps of {} loops at 60 m/s\n",
        scenes::HEAP.iter().product::<usize>()
    );
    println!(
        "| | µs per step | wrong links | deepest, of the radii | energy | queries, impacts, frozen, stops per step |"
    );
    println!("|---|---|---|---|---|---|");
    for (k, row) in Heaps::run([7_301, seeds], (60.0, 0.0), &steppers, TURNS)
        .into_iter()
        .enumerate()
    {
        println!("| {} | {row} |", name(k));
    }

    println!(
        "\n{seeds} times {} loops at 3 m/s, {} steps\n",
        scenes::FEW.iter().product::<usize>(),
        scenes::CALM_STEPS
    );
    println!(
        "| | µs per step | of these the last 60 | still awake | queries, muted, impacts per step | contacts per step |"
    );
    println!("|---|---|---|---|---|---|");
    for (k, row) in Calm::run([7_401, seeds], &steppers, TURNS)
        .into_iter()
        .enumerate()
    {
        println!("| {} | {row} |", name(k));
    }

    planted::table(&rows);
}
