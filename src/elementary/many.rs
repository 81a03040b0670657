//! Many elementary tests on straight paths at once, in eight lanes of `f32`. After each round of the bracket's loop,
//! lanes whose query is finished are filled with new queries. A fixed group of eight would take as long as its slowest
//! member, half as long again as the mean.
//!
//! On x86-64 with AVX2 the eight lanes are one register (`math::lane_avx`, chosen at run time), elsewhere what [`wide`]
//! makes of them. Both give the same bits as the scalar [`super::bracket::bracket`].

use super::bracket::{Bracket, Limits, Running};
use super::earliest::Earliest;
use super::first_contact::{Straight, movers, options_limits, straight_toi};
use super::path::LinearPath;
use super::test_list::Domain;
use super::{MovingSphere, Toi, ToiOptions};
use crate::math::lane::{Octet, Vec3};
use crate::math::nearest::Nearest;
use wide::f32x8;

/// Lanes of a group.
const LANES: usize = 8;

/// Which code runs the lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lanes {
    /// Lanes that any processor of the target has.
    Baseline,
    /// AVX2, if the processor has it; else the baseline.
    Fastest,
}

impl Lanes {
    /// Name of the code that this choice runs on this processor.
    pub fn path(self) -> &'static str {
        #[cfg(target_arch = "x86_64")]
        if self == Self::Fastest && pulp::x86::V3::is_available() {
            return "AVX2";
        }
        "baseline"
    }
}

/// First contacts of many pairs of primitives on straight paths, in their order, with the promise of
/// [`super::first_contact()`]. All elementary tests of all pairs share the lanes. The times may differ from those of
/// [`super::first_contact()`] within the tolerances, since here a test is followed even if another test of its pair has
/// found an earlier contact.
pub fn first_contacts(
    pairs: &[[&[MovingSphere]; 2]],
    options: &ToiOptions,
    lanes: Lanes,
) -> Vec<Toi> {
    let limits = options_limits(options);
    let straight: Vec<Option<Straight<f32>>> = pairs
        .iter()
        .map(|&[a, b]| {
            let movers = movers(a, b, options)?;
            Some(Straight::new(movers, options.target_distance))
        })
        .collect();
    let mut found = Vec::new();
    for domain in [Domain::Box, Domain::Triangle] {
        let (mut tests, mut paths) = (Vec::new(), Vec::new());
        for (index, pair) in straight.iter().enumerate() {
            let Some(pair) = pair else { continue };
            pair.for_each_test(|test| {
                if test.domain == domain {
                    tests.push((index, test));
                    paths.push(pair.path(&test));
                }
                true
            });
        }
        found.extend(
            tests
                .into_iter()
                .zip(brackets(&paths, domain, &limits, lanes)),
        );
    }
    let mut earliest = vec![Earliest::new(limits); pairs.len()];
    for contacts in [true, false] {
        for ((index, test), bracket) in &found {
            if bracket.contact == contacts {
                let earliest = &mut earliest[*index];
                earliest.tests += 1;
                earliest.take(*test, *bracket, limits.start, [0, 0]);
            }
        }
    }
    let mut answers = vec![Toi::bad_input(options); pairs.len()];
    for (index, pair) in straight.iter().enumerate() {
        if let Some(pair) = pair {
            pair.conclude(&mut earliest[index]);
            answers[index] = straight_toi(&earliest[index], pairs[index], options);
        }
    }
    answers
}

/// Brackets of many tests of one domain, in their order.
pub fn brackets(
    paths: &[LinearPath<f32>],
    domain: Domain,
    limits: &Limits<f32>,
    lanes: Lanes,
) -> Vec<Bracket<f32>> {
    #[cfg(target_arch = "x86_64")]
    if let (Lanes::Fastest, Some(avx)) = (lanes, pulp::x86::V3::try_new()) {
        return avx.vectorize(OnAvx(paths, domain, limits));
    }
    let _ = lanes;
    by_domain::<f32x8>(paths, domain, limits)
}

/// [`by_domain`] as pulp calls it: inlined into a function compiled for AVX.
#[cfg(target_arch = "x86_64")]
struct OnAvx<'a>(&'a [LinearPath<f32>], Domain, &'a Limits<f32>);

#[cfg(target_arch = "x86_64")]
impl pulp::NullaryFnOnce for OnAvx<'_> {
    type Output = Vec<Bracket<f32>>;
    #[inline(always)]
    fn call(self) -> Self::Output {
        by_domain::<crate::math::lane_avx::F32x8Avx>(self.0, self.1, self.2)
    }
}

/// [`run`], compiled once for each domain: its loops over corners then have a known length.
#[inline(always)]
fn by_domain<L: Octet>(
    paths: &[LinearPath<f32>],
    domain: Domain,
    limits: &Limits<f32>,
) -> Vec<Bracket<f32>> {
    match domain {
        Domain::Box => run::<L>(paths, Domain::Box, limits),
        Domain::Triangle => run::<L>(paths, Domain::Triangle, limits),
    }
}

/// A query between two rounds.
#[derive(Clone, Copy)]
struct OpenQuery {
    index: usize,
    /// State of a query in the rows of [`to_rows`] and [`from_rows`].
    state: [f32; LANES],
}

#[inline(always)]
fn run<L: Octet>(
    paths: &[LinearPath<f32>],
    domain: Domain,
    limits: &Limits<f32>,
) -> Vec<Bracket<f32>> {
    let splat = |x: f32| L::splat(x.into());
    let wide_limits = Limits {
        tolerance: splat(limits.tolerance),
        time_tolerance: splat(limits.time_tolerance),
        start: splat(limits.start),
        horizon: splat(limits.horizon),
        max_iterations: limits.max_iterations,
    };
    // Rounds are counted in f32, which is exact until then.
    let cap = splat(limits.max_iterations.min(1 << 24) as f32);
    // First what needs no iteration.
    let mut results = Vec::with_capacity(paths.len());
    let mut open = Vec::with_capacity(paths.len());
    for group in paths.chunks(LANES) {
        let lanes = std::array::from_fn(|lane| &group[lane.min(group.len() - 1)]);
        let running = Running::new(&side_by_side::<L>(lanes), domain, &wide_limits);
        let active = L::bits(running.active);
        let states = to_rows(&running, L::zero());
        for (lane, state) in states.into_iter().enumerate().take(group.len()) {
            let is_open = active >> lane & 1 == 1;
            let index = results.len();
            results.push(waiting(&state, !is_open));
            if is_open && limits.max_iterations > 0 {
                open.push(OpenQuery { index, state });
            }
        }
    }
    // Then rounds of the last eight that are open; those still open after a round go back.
    while let Some(&last) = open.last() {
        let count = open.len().min(LANES);
        let mut group = [last; LANES];
        group[..count].copy_from_slice(&open[open.len() - count..]);
        open.truncate(open.len() - count);
        let path = side_by_side::<L>(group.each_ref().map(|query| &paths[query.index]));
        let (mut running, rounds) = from_rows::<L>(group.map(|query| query.state), &wide_limits);
        running.advance(&path, domain, &wide_limits);
        let rounds = rounds + L::one();
        let again = L::bits(running.active & rounds.lt(cap));
        let states = to_rows(&running, rounds);
        for lane in (0..count).filter(|lane| again >> lane & 1 == 1) {
            open.push(OpenQuery {
                state: states[lane],
                ..group[lane]
            });
        }
        let finished = (0..count).filter(|lane| again >> lane & 1 == 0);
        finish(&running, &states, finished, &group, &mut results);
    }
    results
}

// Not `array::map` in the functions below: it is not always inlined, and what is not inlined is not
// compiled for AVX.

/// Members of each lane together.
#[inline(always)]
fn columns<L: Octet>(rows: [L; LANES]) -> [[f32; LANES]; LANES] {
    let [a, b, c, d, e, f, g, h] = L::transpose(rows);
    [
        a.to_array(),
        b.to_array(),
        c.to_array(),
        d.to_array(),
        e.to_array(),
        f.to_array(),
        g.to_array(),
        h.to_array(),
    ]
}

/// The reverse of [`columns`].
#[inline(always)]
fn rows_of<L: Octet>(columns: [[f32; LANES]; LANES]) -> [L; LANES] {
    let [a, b, c, d, e, f, g, h] = columns;
    L::transpose([
        L::from_array(a),
        L::from_array(b),
        L::from_array(c),
        L::from_array(d),
        L::from_array(e),
        L::from_array(f),
        L::from_array(g),
        L::from_array(h),
    ])
}

/// Packs the state that passes from round to round, one row a query.
#[inline(always)]
fn to_rows<L: Octet>(running: &Running<L>, rounds: L) -> [[f32; LANES]; LANES] {
    let b = &running.bracket;
    let rooted = L::select(running.rooted, L::one(), L::zero());
    columns([
        b.lower,
        b.upper,
        b.tolerance,
        b.slack,
        b.start_distance,
        rooted,
        rounds,
        L::zero(),
    ])
}

/// Queries as [`to_rows`] left them, and their rounds so far.
#[inline(always)]
fn from_rows<L: Octet>(rows: [[f32; LANES]; LANES], limits: &Limits<L>) -> (Running<L>, L) {
    let [
        lower,
        upper,
        tolerance,
        slack,
        start_distance,
        rooted,
        rounds,
        _,
    ] = rows_of::<L>(rows);
    let mut running = Running::at(limits, slack);
    running.bracket.lower = lower;
    running.bracket.upper = upper;
    running.bracket.tolerance = tolerance;
    running.bracket.start_distance = start_distance;
    running.rooted = L::zero().lt(rooted);
    running.fresh = rounds.le(L::zero());
    (running, rounds)
}

/// A query before its first round, with its state.
fn waiting(state: &[f32; LANES], separated: bool) -> Bracket<f32> {
    let &[lower, upper, tolerance, slack, ..] = state;
    Bracket {
        lower,
        upper,
        contact: false,
        separated,
        tolerance,
        slack,
        start_distance: 0.0,
        nearest: Nearest {
            alpha: 0.0,
            beta: 0.0,
            distance: 0.0,
            y: Vec3::zero(),
            length: 0.0,
        },
        normal: Vec3::zero(),
        iterations: 0,
    }
}

/// Writes the results of the lanes that are finished.
#[inline(always)]
fn finish<L: Octet>(
    running: &Running<L>,
    states: &[[f32; LANES]; LANES],
    finished: impl Iterator<Item = usize>,
    group: &[OpenQuery; LANES],
    results: &mut [Bracket<f32>],
) {
    let Bracket {
        nearest: s,
        normal: n,
        ..
    } = &running.bracket;
    let rows = [
        s.alpha, s.beta, s.distance, s.y.x, s.y.y, s.y.z, s.length, n.x,
    ];
    let rows = columns(rows);
    let rest = [n.y.to_array(), n.z.to_array()];
    let contact = L::bits(running.bracket.contact);
    let separated = L::bits(running.bracket.separated);
    for lane in finished {
        let [lower, upper, tolerance, slack, start_distance, _, rounds, _] = states[lane];
        let [alpha, beta, distance, x, y, z, length, normal] = rows[lane];
        results[group[lane].index] = Bracket {
            lower,
            upper,
            contact: contact >> lane & 1 == 1,
            separated: separated >> lane & 1 == 1,
            tolerance,
            slack,
            start_distance,
            nearest: Nearest {
                alpha,
                beta,
                distance,
                y: Vec3::new(x, y, z),
                length,
            },
            normal: Vec3::new(normal, rest[0][lane], rest[1][lane]),
            iterations: rounds as u32,
        };
    }
}

/// Eight paths side by side, member by member.
#[inline(always)]
fn side_by_side<L: Octet>(paths: [&LinearPath<f32>; LANES]) -> LinearPath<L> {
    let eight = |row: fn(&LinearPath<f32>) -> [f32; LANES]| rows_of::<L>(paths.map(row));
    let [x0, y0, z0, x1, y1, z1, x2, y2] = eight(|p| {
        let [a, b, c, _] = p.start;
        [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y]
    });
    let [z2, x3, y3, z3, r0, r1, r2, r3] = eight(|p| {
        let ([_, _, c, d], r) = (p.start, p.radius);
        [c.z, d.x, d.y, d.z, r[0], r[1], r[2], r[3]]
    });
    let [dx0, dy0, dz0, dx1, dy1, dz1, dx2, dy2] = eight(|p| {
        let [a, b, c, _] = p.rate;
        [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y]
    });
    let [dz2, dx3, dy3, dz3, size, ..] = eight(|p| {
        let [_, _, c, d] = p.rate;
        [c.z, d.x, d.y, d.z, p.size, 0.0, 0.0, 0.0]
    });
    LinearPath {
        start: [
            Vec3::new(x0, y0, z0),
            Vec3::new(x1, y1, z1),
            Vec3::new(x2, y2, z2),
            Vec3::new(x3, y3, z3),
        ],
        rate: [
            Vec3::new(dx0, dy0, dz0),
            Vec3::new(dx1, dy1, dz1),
            Vec3::new(dx2, dy2, dz2),
            Vec3::new(dx3, dy3, dz3),
        ],
        radius: [r0, r1, r2, r3],
        size,
    }
}
