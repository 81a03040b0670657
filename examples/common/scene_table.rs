//! The scene's runs in numbers.

use super::scene::Run;
use super::table::Table;

/// A column for each run. Times are over the steps that all runs have, so that a run is not
/// cheaper for lying still longer.
pub fn table(runs: &[&Run]) -> Table {
    let mut table = Table::default();
    table.row("", runs.iter().map(|run| run.kind.name().to_lowercase()));
    let mut row = |name: &str, cell: &dyn Fn(&Run) -> String| {
        table.row(name, runs.iter().map(|run| cell(run)));
    };
    let common = runs.iter().map(|run| run.milliseconds.len()).min();
    let common = common.unwrap_or(0);
    let per_step = |run: &Run, count: usize| count as f64 / run.milliseconds.len() as f64;
    row(
        &format!("ms per step, median of the first {common}"),
        &|run| format!("{:.3}", run.quantile(common, 0.5)),
    );
    row(&format!("ms per step, p99 of the first {common}"), &|run| {
        format!("{:.3}", run.quantile(common, 0.99))
    });
    row("elementary tests per step", &|run| {
        format!("{:.0}", per_step(run, run.elementary_tests as usize))
    });
    row("steps until all sleep", &|run| match run.asleep_after {
        Some(steps) => steps.to_string(),
        None => format!("over {}", run.milliseconds.len()),
    });
    row("touching pairs per step", &|run| {
        format!("{:.1}", per_step(run, run.audit.contacts))
    });
    row(
        "ghosts per step: the true meshes are over 1 % of their size apart",
        &|run| format!("{:.1}", per_step(run, run.audit.ghosts)),
    );
    row("ghosts among the touching pairs in the end", &|run| {
        let (contacts, ghosts) = run.audit.last;
        format!("{ghosts} of {contacts}")
    });
    row("inner lines crossed", &|run| {
        run.audit.crossings.to_string()
    });
    row("deepest overlap, % of the radii", &|run| {
        format!("{:.0}", 100.0 * run.audit.deepest)
    });
    row("lowest point, mm", &|run| {
        format!("{:.1}", 1.0e3 * run.audit.lowest)
    });
    table
}
