//! Many elementary tests on straight paths at once: eight lanes of `f32`, each refilled with the
//! next query as soon as its own is finished. Without that a group of eight takes as long as its
//! slowest member, half as long again as the mean.
//!
//! On x86-64 with AVX the lanes are one register (`math::lane_avx`, chosen at run time),
//! elsewhere what [`wide`] makes of them. Both, and the scalar [`super::bracket::bracket`], give the
//! same bits.

use super::bracket::{Bracket, Limits, Running};
use super::path::LinearPath;
use super::test_list::Domain;
use crate::math::lane::{Mask, Octet, Vec3};
use crate::math::nearest::Nearest;
use wide::f32x8;

/// Lanes of a group.
const LANES: usize = 8;

/// Which code runs the lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lanes {
    /// What any processor of the target has.
    Baseline,
    /// AVX, if the processor has it; else the baseline.
    Fastest,
}

impl Lanes {
    /// Name of the code that this choice runs on this processor.
    pub fn path(self) -> &'static str {
        #[cfg(target_arch = "x86_64")]
        if self == Self::Fastest && pulp::x86::V3::is_available() {
            return "AVX";
        }
        "baseline"
    }
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
    // First what one direction settles, and what each query needs from the whole step.
    let mut results = Vec::with_capacity(paths.len());
    let mut open: Vec<(usize, f32)> = Vec::with_capacity(paths.len());
    for group in paths.chunks(LANES) {
        let running = Running::new(&side_by_side::<L>(group), domain, &wide_limits);
        let speeds = running.speed.to_array();
        for (lane, speed) in speeds.into_iter().enumerate().take(group.len()) {
            let bracket = lane_of(&running.bracket, lane, 0);
            if !bracket.separated {
                open.push((results.len(), speed));
            }
            results.push(bracket);
        }
    }
    // Then the rest, each lane on its own clock.
    let Some(first) = open.first() else {
        return results;
    };
    let mut path = side_by_side::<L>(std::slice::from_ref(&paths[first.0]));
    let mut running = Running::new(&path, domain, &wide_limits);
    running.active = L::Mask::splat(false);
    let mut waiting = open.into_iter();
    let mut slots = [None; LANES];
    let mut rounds = [0; LANES];
    loop {
        let still = L::bits(running.active);
        for lane in 0..LANES {
            if still >> lane & 1 == 1 && rounds[lane] < limits.max_iterations {
                continue;
            }
            if let Some(index) = slots[lane].take() {
                results[index] = lane_of(&running.bracket, lane, rounds[lane]);
            }
            L::set_mask(&mut running.active, lane, false);
            if let Some((index, speed)) = waiting.next() {
                slots[lane] = Some(index);
                rounds[lane] = 0;
                replace(&mut path, lane, &paths[index]);
                restart(&mut running, &results[index], speed, lane);
            }
        }
        if L::bits(running.active) == 0 {
            return results;
        }
        running.advance(&path, domain, &wide_limits);
        for round in &mut rounds {
            *round += 1;
        }
    }
}

/// Up to eight paths side by side, member by member; the last path fills the lanes left over.
#[inline(always)]
fn side_by_side<L: Octet>(group: &[LinearPath<f32>]) -> LinearPath<L> {
    let last = group.len() - 1;
    let lanes: [&LinearPath<f32>; LANES] = std::array::from_fn(|lane| &group[lane.min(last)]);
    let all = |member: &dyn Fn(&LinearPath<f32>) -> f32| L::from_array(lanes.map(member));
    let vector = |of: &dyn Fn(&LinearPath<f32>) -> Vec3<f32>| {
        Vec3::new(all(&|p| of(p).x), all(&|p| of(p).y), all(&|p| of(p).z))
    };
    LinearPath {
        start: std::array::from_fn(|k| vector(&|p| p.start[k])),
        rate: std::array::from_fn(|k| vector(&|p| p.rate[k])),
        radius: std::array::from_fn(|k| all(&|p| p.radius[k])),
    }
}

/// Replaces the path of one lane.
#[inline(always)]
fn replace<L: Octet>(all: &mut LinearPath<L>, lane: usize, one: &LinearPath<f32>) {
    let set = |v: &mut Vec3<L>, to: Vec3<f32>| {
        v.x.set(lane, to.x);
        v.y.set(lane, to.y);
        v.z.set(lane, to.z);
    };
    for k in 0..4 {
        set(&mut all.start[k], one.start[k]);
        set(&mut all.rate[k], one.rate[k]);
        all.radius[k].set(lane, one.radius[k]);
    }
}

/// Puts a query that [`Running::new`] left open into a lane.
#[inline(always)]
fn restart<L: Octet>(running: &mut Running<L>, from: &Bracket<f32>, speed: f32, lane: usize) {
    let b = &mut running.bracket;
    b.lower.set(lane, from.lower);
    b.upper.set(lane, from.upper);
    b.tolerance.set(lane, from.tolerance);
    b.slack.set(lane, from.slack);
    running.speed.set(lane, speed);
    L::set_mask(&mut b.contact, lane, false);
    L::set_mask(&mut b.separated, lane, false);
    L::set_mask(&mut running.active, lane, true);
    L::set_mask(&mut running.fresh, lane, true);
    L::set_mask(&mut running.rooted, lane, false);
}

#[inline(always)]
fn lane_of<L: Octet>(b: &Bracket<L>, lane: usize, iterations: u32) -> Bracket<f32> {
    let get = |v: L| v.to_array()[lane];
    let is_set = |mask: L::Mask| L::bits(mask) >> lane & 1 == 1;
    let vector = |v: Vec3<L>| Vec3::new(get(v.x), get(v.y), get(v.z));
    Bracket {
        lower: get(b.lower),
        upper: get(b.upper),
        contact: is_set(b.contact),
        separated: is_set(b.separated),
        tolerance: get(b.tolerance),
        slack: get(b.slack),
        start_distance: get(b.start_distance),
        nearest: Nearest {
            alpha: get(b.nearest.alpha),
            beta: get(b.nearest.beta),
            distance: get(b.nearest.distance),
            y: vector(b.nearest.y),
            length: get(b.nearest.length),
        },
        normal: vector(b.normal),
        iterations,
    }
}
