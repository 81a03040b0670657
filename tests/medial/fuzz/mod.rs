//! Anything at all for what reads bytes and numbers: it ends, does not panic, and takes no more memory than
//! its input justifies.
//!
//! `MINUTES=10 cargo test --release --all-features --test medial fuzz_for -- --ignored --nocapture`
//! gives each target its share of the time, on as many threads as there are, and prints how often each ran.
//! `ONLY=pairs,shapes` gives it to these, and `CASE=target:number` runs one case again. Finds are kept in `finds.rs`.

mod finds;
mod mutate;
mod queries;
mod targets;

use mutate::Rng;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};
use targets::TARGETS;

/// Cases of each target in an ordinary run of the tests.
const QUICK: u64 = 300;

/// Address space in MiB by which no target may grow the process: a claimed count of 2³² items takes
/// 16,000 and more. Threads of other tests take 64 each.
const ROOM: u64 = 4_096;

/// Seconds after which the long run says that a case hangs, and ends.
const HANGS: u64 = 60;

fn case(target: usize, case: u64) -> Result<(), String> {
    let run = AssertUnwindSafe(|| (TARGETS[target].1)(&mut Rng::of_case(target, case)));
    catch_unwind(run).map_err(|e| {
        let text = e.downcast_ref::<String>().cloned();
        let text = text.or_else(|| e.downcast_ref::<&str>().map(|s| (*s).to_owned()));
        text.unwrap_or_default()
    })
}

/// Most address space that the process ever had, in MiB, where the system tells: reserved counts, used or
/// not.
fn peak() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("VmPeak:"))?;
    Some(line.split_whitespace().next()?.parse::<u64>().ok()? >> 10)
}

/// Time that this thread has run, where the system tells: other programs do not count.
fn ran(since: Instant) -> Duration {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let first = text.as_ref().and_then(|t| t.split_whitespace().next());
    let nanoseconds = first.and_then(|n| n.parse().ok());
    nanoseconds.map_or(since.elapsed(), Duration::from_nanos)
}

#[test]
fn anything_at_all_is_survived() {
    let before = peak();
    for (target, (name, _)) in TARGETS.iter().enumerate() {
        for number in 0..QUICK {
            if let Err(e) = case(target, number) {
                panic!("CASE={name}:{number}: {e}");
            }
        }
    }
    if let (Some(before), Some(after)) = (before, peak()) {
        assert!(after < before + ROOM, "{before} MiB, then {after}");
    }
}

/// What a target did in its time.
#[derive(Default)]
struct Tally {
    cases: u64,
    longest: (Duration, u64),
    /// First case and number of each message.
    finds: BTreeMap<String, (u64, u64)>,
}

fn fuzz(target: usize, first: u64, stride: u64, until: Instant) -> Tally {
    let mut tally = Tally::default();
    let began = Instant::now();
    let (sender, receiver) = std::sync::mpsc::channel::<u64>();
    std::thread::spawn(move || {
        let mut last = first;
        loop {
            match receiver.recv_timeout(Duration::from_secs(HANGS)) {
                Ok(number) => last = number,
                Err(std::sync::mpsc::RecvTimeoutError::Disconnected) => return,
                Err(_) => {
                    println!("hangs: CASE={}:{last}", TARGETS[target].0);
                    std::process::exit(1);
                }
            }
        }
    });
    let mut number = first;
    let mut before = ran(began);
    while Instant::now() < until {
        let _ = sender.send(number);
        let found = case(target, number);
        tally.cases += 1;
        let after = ran(began);
        tally.longest = tally.longest.max((after.saturating_sub(before), number));
        before = after;
        if let Err(message) = found {
            let find = tally.finds.entry(message).or_insert((number, 0));
            find.1 += 1;
        }
        number += stride;
    }
    tally
}

#[test]
#[ignore = "for finding, not for checking: runs as many minutes as MINUTES says; CI runs a share of each target"]
fn fuzz_for() {
    let number = |name: &str| std::env::var(name).ok().and_then(|v| v.parse::<f64>().ok());
    if let Ok(one) = std::env::var("CASE") {
        let (name, case_number) = one.split_once(':').expect("CASE=target:number");
        let target = TARGETS.iter().position(|t| t.0 == name).expect("a target");
        (TARGETS[target].1)(&mut Rng::of_case(
            target,
            case_number.parse().expect("a number"),
        ));
        return;
    }
    let minutes = number("MINUTES").unwrap_or(1.0);
    // Another first case on every run would not be repeatable: it is asked for.
    let first = number("FIRST").unwrap_or(0.0) as u64;
    let threads = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    let only = std::env::var("ONLY").unwrap_or_default();
    let asked = |name: &str| only.is_empty() || only.split(',').any(|o| o == name);
    let targets = TARGETS.iter().enumerate().filter(|t| asked(t.1.0));
    let share = Duration::from_secs_f64(60.0 * minutes / targets.clone().count().max(1) as f64);
    let mut finds = 0;
    for (target, (name, _)) in targets {
        let until = Instant::now() + share;
        let tallies = std::thread::scope(|scope| {
            let run = |k| scope.spawn(move || fuzz(target, first + k, threads, until));
            let running: Vec<_> = (0..threads).map(run).collect();
            let done = running.into_iter().map(|r| r.join().expect("a tally"));
            done.collect::<Vec<_>>()
        });
        let cases: u64 = tallies.iter().map(|t| t.cases).sum();
        let longest = tallies.iter().map(|t| t.longest).max().unwrap_or_default();
        let peak = peak().unwrap_or(0);
        println!("{name}: {cases} cases, longest {longest:.3?}, peak {peak} MiB");
        for (message, (number, times)) in tallies.iter().flat_map(|t| &t.finds) {
            finds += 1;
            println!("  CASE={name}:{number}, {times} times: {message}");
        }
    }
    assert_eq!(finds, 0, "finds");
}
