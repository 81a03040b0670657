//! The tables, in Markdown: a row for each engine and setting.

use crate::verdict::{Flights, Thrown, Verdict};

fn heading(columns: &[String]) -> String {
    let rule = "|---".repeat(columns.len() + 1);
    format!("\n| | {} |\n{rule}|\n", columns.join(" | "))
}

fn table(
    verdicts: &[Verdict],
    columns: &[String],
    cells: impl Fn(&Verdict) -> Vec<String>,
) -> String {
    let row = |v: &Verdict| {
        let native = if v.is_wasm { ", wasm" } else { "" };
        let name = format!("{} {}, {}{native}", v.engine, v.version, v.setting);
        format!("| {name} | {} |\n", cells(v).join(" | "))
    };
    heading(columns) + &verdicts.iter().map(row).collect::<String>()
}

fn named<T>(scenes: &[(String, T)], suffix: &str) -> Vec<String> {
    scenes
        .iter()
        .map(|(name, _)| format!("{name}{suffix}"))
        .collect()
}

fn flight((name, flights): &(String, Flights)) -> String {
    let Flights {
        missed,
        linked,
        ghosts,
        ..
    } = flights;
    match name.starts_with("rings") {
        true => format!("{missed} · {linked} · {ghosts}"),
        false => format!("{missed} · {ghosts}"),
    }
}

fn thrown((_, thrown): &(String, Thrown)) -> String {
    let escaped = match thrown.outside {
        0 => String::new(),
        n => format!(" (+ {n} outside)"),
    };
    let Thrown {
        changed,
        ms,
        longest,
        ..
    } = thrown;
    format!("{changed}{escaped} · {ms:.2} · {longest:.1}")
}

/// All tables.
pub fn page(verdicts: &[Verdict]) -> String {
    let Some(first) = verdicts.first() else {
        return "No engine ran.\n".to_string();
    };
    let mut page = String::new();
    let counts = &first.flights[0].1;
    page += &format!(
        "## Flights\n\n{} sure hits and {} clear passes a cell: missed · felt but linked afterwards · ghosts (rod: missed · ghosts), by speed in m/s.\n",
        counts.hits, counts.passes
    );
    page += &table(verdicts, &named(&first.flights, ""), |v| {
        v.flights.iter().map(flight).collect()
    });
    page += "\n## Thrown rings\n\nPairs whose linking number changed · ms a step · longest step, by speed in m/s.\n";
    page += &table(verdicts, &named(&first.thrown, ""), |v| {
        v.thrown.iter().map(thrown).collect()
    });
    page += "\n## Rest\n\nSleeping is off.\n";
    let columns = [
        "ms falling",
        "ms at rest",
        "rings that drift",
        "farthest, mm",
        "outside",
    ];
    page += &table(verdicts, &columns.map(String::from), |v| {
        let rest = &v.rest;
        vec![
            format!("{:.2}", rest.falling),
            format!("{:.2}", rest.resting),
            rest.drifting.to_string(),
            format!("{:.1}", 1.0e3 * rest.farthest),
            rest.outside.to_string(),
        ]
    });
    page += "\n## Elastic cubes\n\nEnergy over that at the start: at the end (least to most of the seeds), the most on the way; ms a step.\n";
    page += &table(verdicts, &named(&first.elastic, " Hz"), |v| {
        let cell = |e: &crate::verdict::Elastic| {
            let ends = [e.ends.first(), e.ends.last()].map(|x| x.copied().unwrap_or(f64::NAN));
            let escaped = match e.outside {
                0 => String::new(),
                n => format!(" ({n} outside)"),
            };
            format!(
                "{:.3} to {:.3} · {:.3}{escaped} · {:.2}",
                ends[0], ends[1], e.most, e.ms
            )
        };
        v.elastic.iter().map(|(_, e)| cell(e)).collect()
    });
    page
}
