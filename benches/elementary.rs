//! One certified elementary query on one core: `f64`, `f32`, eight lanes of `f32` on both code
//! paths, and the paper's iteration, on the same queries in interleaved rounds. Then the cost of
//! the tolerance.
//!
//! `cargo bench --bench elementary`. Prints medians in ns per query, hits, and a hash of the
//! results; fails if a lane's bits differ from the scalar's.

mod common;

#[allow(
    dead_code,
    reason = "the judge of the tests; here only its queries serve"
)]
#[path = "../tests/common/ccd/mod.rs"]
mod ccd;

use ccd::families::Family;
use ccd::motion::Query;
use ccd::rng::Rng;
use common::{Hash, median, processor};
use rapier3d_medial::elementary::AlternatingStart;
use rapier3d_medial::elementary::alternating::{self, iterate};
use rapier3d_medial::elementary::bracket::{Bracket, Limits, bracket};
use rapier3d_medial::elementary::many::{Lanes, brackets};
use rapier3d_medial::elementary::path::LinearPath;
use rapier3d_medial::elementary::test_list::{Domain, ElementaryTest};
use rapier3d_medial::math::lane::{Scalar, Vec3};
use std::hint::black_box;
use std::time::Instant;

/// Enough that no branch predictor learns them by heart.
const QUERIES: usize = 60_000;
/// Queries of one call of the batch: their results stay in the cache.
const BATCH: usize = 1000;
const ROUNDS: usize = 9;
const CAP: u32 = 64;

/// Where queries come from: a family, and how far its bodies are then moved apart, in sizes.
const MIX: [(&str, Family, f64); 10] = [
    ("separate", Family::Translation, 8.0),
    ("approaching", Family::Translation, 0.0),
    ("small rotation", Family::SmallRotation, 0.0),
    ("large rotation", Family::LargeRotation, 0.0),
    ("grazing", Family::Grazing, 0.0),
    ("touching at the start", Family::TouchApproaching, 0.0),
    ("fast", Family::Fast, 0.0),
    ("thin", Family::Thin, 0.0),
    ("parallel", Family::Parallel, 0.0),
    ("zero size", Family::ZeroSize, 0.0),
];

/// The same queries in both precisions.
struct Queries {
    domain: Domain,
    double: Vec<LinearPath<f64>>,
    single: Vec<LinearPath<f32>>,
}

impl Queries {
    fn draw(domain: Domain) -> Self {
        let (counts, test) = match domain {
            Domain::Box => ([2, 2], ElementaryTest::cone_cone([0, 1], [0, 1])),
            Domain::Triangle => ([1, 3], ElementaryTest::sphere_slab(0)),
        };
        let mut rng = Rng::new(29);
        let drawn: Vec<Query> = (0..QUERIES)
            .map(|i| {
                let (_, family, apart) = MIX[i % MIX.len()];
                let mut query = family.query(counts, false, &mut rng);
                query.shift(0, rng.direction() * apart);
                query
            })
            .collect();
        Self {
            domain,
            double: drawn.iter().map(|q| path(q, &test)).collect(),
            single: drawn.iter().map(|q| rounded(&path(q, &test))).collect(),
        }
    }
}

fn path(query: &Query, test: &ElementaryTest) -> LinearPath<f64> {
    LinearPath::new(test, 0.0, |second, i| {
        let ball = &query.balls[usize::from(second)][usize::from(i)];
        let [c, d] = [ball.center, ball.displacement].map(|v| Vec3::new(v.x, v.y, v.z));
        (c, d, ball.radius)
    })
}

fn rounded(path: &LinearPath<f64>) -> LinearPath<f32> {
    let vector = |v: Vec3<f64>| Vec3::new(v.x as f32, v.y as f32, v.z as f32);
    LinearPath {
        start: path.start.map(vector),
        rate: path.rate.map(vector),
        radius: path.radius.map(|r| r as f32),
        size: 0.0,
    }
}

/// The query that `f32` is asked, with all digits.
fn widened(path: &LinearPath<f32>) -> LinearPath<f64> {
    let vector = |v: Vec3<f32>| Vec3::new(v.x.into(), v.y.into(), v.z.into());
    LinearPath {
        start: path.start.map(vector),
        rate: path.rate.map(vector),
        radius: path.radius.map(f64::from),
        size: 0.0,
    }
}

fn limits<S: Scalar>(tolerance: f64) -> Limits<S> {
    Limits {
        tolerance: S::splat(tolerance),
        time_tolerance: S::splat(tolerance),
        start: S::zero(),
        horizon: S::one(),
        max_iterations: CAP,
    }
}

/// What is kept of a query: no contact before, contact at, whether there is one, and whether there is none.
type Answer = (f64, f64, bool, bool);

fn answer<S: Scalar>(b: &Bracket<S>) -> Answer {
    (b.lower.to_f64(), b.upper.to_f64(), b.contact, b.separated)
}

fn certified<S: Scalar>(paths: &[LinearPath<S>], domain: Domain, tolerance: f64) -> Vec<Answer> {
    let limits = limits(tolerance);
    let one = |path| answer(&bracket(black_box(path), domain, &limits));
    paths.iter().map(one).collect()
}

fn batched(queries: &Queries, tolerance: f64, lanes: Lanes) -> Vec<Answer> {
    let limits = limits(tolerance);
    let mut answers = Vec::with_capacity(QUERIES);
    for batch in queries.single.chunks(BATCH) {
        answers.extend(
            brackets(batch, queries.domain, &limits, lanes)
                .iter()
                .map(answer),
        );
    }
    answers
}

fn paper<S: Scalar>(paths: &[LinearPath<S>], domain: Domain, tolerance: f64) -> Vec<Answer> {
    let limits = alternating::AlternatingLimits {
        tolerance: S::splat(tolerance),
        max_iterations: CAP,
        start: AlternatingStart::End,
    };
    let one = |path| {
        let found = iterate(black_box(path), domain, &limits).0;
        let time = found.map_or(1.0, S::to_f64);
        (time, time, found.is_some(), found.is_none())
    };
    paths.iter().map(one).collect()
}

struct Row<'a> {
    name: String,
    run: Box<dyn Fn() -> Vec<Answer> + 'a>,
    times: Vec<f64>,
    answers: Vec<Answer>,
}

impl<'a> Row<'a> {
    fn new(name: impl Into<String>, run: impl Fn() -> Vec<Answer> + 'a) -> Self {
        Self {
            name: name.into(),
            run: Box::new(run),
            times: Vec::new(),
            answers: Vec::new(),
        }
    }
}

/// Runs all rows in turn, [`ROUNDS`] times after a warm-up.
fn race(rows: &mut [Row]) {
    for round in 0..=ROUNDS {
        for row in rows.iter_mut() {
            let clock = Instant::now();
            row.answers = (row.run)();
            if round > 0 {
                row.times
                    .push(clock.elapsed().as_secs_f64() * 1e9 / QUERIES as f64);
            }
        }
    }
}

fn hash(answers: &[Answer]) -> String {
    let mut hash = Hash::new();
    for (lower, upper, contact, _) in answers {
        hash.add(lower.to_bits());
        hash.add(upper.to_bits());
        hash.add(u64::from(*contact));
    }
    hash.short()
}

/// How often the bits of two rows differ.
fn differing(a: &[Answer], b: &[Answer]) -> usize {
    let bits = |a: &Answer| (a.0.to_bits(), a.1.to_bits(), a.2, a.3);
    a.iter().zip(b).filter(|(a, b)| bits(a) != bits(b)).count()
}

fn side_by_side(name: &str, queries: &Queries) {
    let domain = queries.domain;
    let (double, single) = (&queries.double, &queries.single);
    let lanes = |lanes: Lanes| format!("f32 x 8, {}", lanes.path());
    let tolerance = 1.0e-6;
    let mut rows = [
        Row::new("f64", || certified(double, domain, tolerance)),
        Row::new("f32", || certified(single, domain, tolerance)),
        Row::new(lanes(Lanes::Baseline), || {
            batched(queries, tolerance, Lanes::Baseline)
        }),
        Row::new(lanes(Lanes::Fastest), || {
            batched(queries, tolerance, Lanes::Fastest)
        }),
        Row::new("the paper's, f64", || paper(double, domain, tolerance)),
        Row::new("the paper's, f32", || paper(single, domain, tolerance)),
    ];
    race(&mut rows);
    let sure = rows[0].answers.clone();
    let hits = |answers: &[Answer]| answers.iter().filter(|a| a.2).count();
    println!("\n{name}, tolerance {tolerance:e}: {QUERIES} queries");
    for (k, (family, ..)) in MIX.iter().enumerate() {
        let own: Vec<Answer> = sure.iter().skip(k).step_by(MIX.len()).copied().collect();
        print!("{family} {} %, ", 100 * hits(&own) / own.len());
    }
    println!("all {} % hits", 100 * hits(&sure) / sure.len());
    println!(
        "{:<20}{:>10}{:>9}{:>9}{:>10}",
        "", "median ns", "x f64", "missed", "hash"
    );
    let reference = rows[0].times.clone();
    for row in &mut rows {
        let pairs = row.times.iter().zip(&reference);
        let ratio = median(&mut pairs.map(|(time, f64s)| time / f64s).collect::<Vec<_>>());
        let ns = median(&mut row.times);
        let missed = sure.iter().zip(&row.answers).filter(|(a, b)| a.2 && !b.2);
        println!(
            "{:<20}{ns:>10.0}{:>9.2}{:>9}{:>10}",
            row.name,
            ratio,
            missed.count(),
            hash(&row.answers)
        );
    }
    // What `f32` does not tell: unresolved, or apart, of which some are once their numbers are rounded.
    let open = |a: &Answer| !a.2 && !a.3;
    let wide: Vec<_> = single.iter().map(widened).collect();
    let exact = certified(&wide, domain, tolerance);
    let not_told =
        || (sure.iter().zip(&rows[1].answers).zip(&exact)).filter(|((a, b), _)| a.2 && !b.2);
    println!(
        "of the {} that f32 does not tell: {} unresolved, {} apart once rounded",
        not_told().count(),
        not_told().filter(|((_, b), _)| open(b)).count(),
        not_told().filter(|((_, b), e)| !open(b) && !e.2).count(),
    );
    let differ = [2, 3].map(|k| differing(&rows[1].answers, &rows[k].answers));
    println!("lanes that differ from scalar f32: {differ:?}");
    assert_eq!(differ, [0, 0], "lanes and scalar disagree");
}

fn sweep(name: &str, queries: &Queries) {
    println!("\n{name}, ns against tolerance");
    println!("{:<10}{:>8}{:>8}{:>8}", "", "f64", "f32", "x 8");
    for exponent in 2..=6 {
        let tolerance = 10.0_f64.powi(-exponent);
        let domain = queries.domain;
        let mut rows = [
            Row::new("", || certified(&queries.double, domain, tolerance)),
            Row::new("", || certified(&queries.single, domain, tolerance)),
            Row::new("", || batched(queries, tolerance, Lanes::Fastest)),
        ];
        race(&mut rows);
        let [double, single, wide] = rows.each_mut().map(|row| median(&mut row.times));
        let hashes = rows.each_ref().map(|row| hash(&row.answers));
        println!("1e-{exponent:<7}{double:>8.0}{single:>8.0}{wide:>8.0}  {hashes:?}");
    }
}

fn main() {
    println!("{}, one core", processor());
    let kinds = [
        ("cone-cone", Queries::draw(Domain::Box)),
        ("sphere-slab", Queries::draw(Domain::Triangle)),
    ];
    for (name, queries) in &kinds {
        side_by_side(name, queries);
    }
    for (name, queries) in &kinds {
        sweep(name, queries);
    }
}
