//! The constants of the event loop ([`Tuning`]), each halved and doubled: what goes wrong, and how much
//! more there is to do. Counts only, so that the machine does not matter.

use crate::scenes::{Flights, HEAP, Heaps, Stepper};
use rapier3d_medial::prelude::*;
use rapier3d_medial::rapier::Tuning;

type Change = (&'static str, fn(&mut Tuning, f32));

/// Of the loop itself, and of the stops.
const CHANGES: [(bool, Change); 14] = [
    (false, ("fast", |t, x| t.fast *= x)),
    (false, ("floor", |t, x| t.floor *= x)),
    (false, ("muted", |t, x| t.muted *= x)),
    (false, ("gap", |t, x| t.gap = t.gap.map(|g| g * x))),
    (false, ("tolerance", |t, x| t.tolerance *= x)),
    (false, ("touching", |t, x| t.touching *= x)),
    (false, ("sink", |t, x| t.sink *= x)),
    (false, ("min_sink", |t, x| t.min_sink *= x)),
    (
        false,
        ("max_events", |t, x| {
            t.max_events = (t.max_events as f32 * x) as u32
        }),
    ),
    (false, ("push_depth", |t, x| t.push_depth *= x)),
    (false, ("tips", |t, x| t.tips *= x)),
    (false, ("push", |t, x| t.push *= x)),
    (true, ("stopping", |t, x| t.stopping *= x)),
    (
        true,
        ("max_stops", |t, x| {
            t.max_stops = (t.max_stops as f32 * x) as usize
        }),
    ),
];

/// Speed in metres per second, and restitution, of each kind of heap: at restitution 0 bodies stay
/// together, which asks most of the loop; at 0.9 energy stays, so that a gain would show.
const KINDS: [(f32, f32); 4] = [(20.0, 0.0), (60.0, 0.0), (150.0, 0.0), (150.0, 0.9)];

fn rows() -> Vec<(String, Stepper)> {
    let stepper = |stop: bool, tuning: Tuning| {
        let mut effects = Effects::default();
        if stop {
            effects.stop = Effect::On;
        }
        Stepper::Medial(effects, tuning)
    };
    let mut rows = vec![("as they are".to_string(), stepper(false, Tuning::default()))];
    for (stop, (name, change)) in CHANGES {
        if stop && rows.iter().all(|(name, _)| name != "as they are, `stop`") {
            let same = stepper(true, Tuning::default());
            rows.push(("as they are, `stop`".to_string(), same));
        }
        for (factor, sign) in [(0.5, "/ 2"), (2.0, "× 2")] {
            let mut tuning = Tuning::default();
            change(&mut tuning, factor);
            rows.push((format!("`{name}` {sign}"), stepper(stop, tuning)));
        }
    }
    rows
}

/// Prints the table.
pub fn sweep() {
    let rows = rows();
    let steppers: Vec<Stepper> = rows.iter().map(|(_, s)| *s).collect();
    let flights = Flights::new(8_201, 1_500, 100);
    println!(
        "\nTwo fast bodies: {} sure contacts, {} sure misses\n",
        flights.contacts, flights.clear
    );
    println!(
        "| | missed | ghosts | first change p50 / p95 | final velocity p50 / p95 | queries, impacts, stops per flight |"
    );
    println!("|---|---|---|---|---|---|");
    for (row, (name, _)) in flights.run(&steppers, 1).into_iter().zip(&rows) {
        println!("| {name} | {} |", row.findings());
    }
    for (speed, restitution) in KINDS {
        let loops: usize = HEAP.iter().product();
        println!("\n3 heaps of {loops} loops at {speed} m/s, restitution {restitution}\n");
        println!(
            "| | wrong links | deepest, of the radii | energy | queries, impacts, frozen, stops per step |"
        );
        println!("|---|---|---|---|---|");
        let seeds = [8_301 + speed as u64, 3];
        for (row, (name, _)) in Heaps::run(seeds, (speed, restitution), &steppers, 1)
            .into_iter()
            .zip(&rows)
        {
            println!("| {name} | {} |", row.findings());
        }
    }
}
