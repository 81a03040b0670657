//! Places at which pairs of colliders met in the impacts of this step. Most of them still touch there when one of the
//! two is struck again. The spheres that met tell where and how far that contact has opened since.

use crate::math::fast_hash::FastMap;
use crate::math::{Real, Vector};
use crate::pair::met::{Met, Touch};
use crate::pair::patch::with_room;
use crate::rapier::impacts::hit::Hit;
use crate::rapier::impacts::toi_query::CcdPolicy;
use crate::rapier::view::motion::Mobility;
use crate::rapier::view::step_view::StepView;

type Pair = [usize; 2];

/// Places of one pair that are remembered. Bodies that are wedged in each other touch in several; with one alone, 16
/// heaps of 12 creatures freeze 25 bodies each in 240 steps, with eight 1.6.
const PLACES: usize = 8;

/// The meetings of a pair.
#[derive(Default)]
struct Meetings {
    /// How often they met.
    count: u32,
    /// Places, each primitive pair once, the last at the end.
    places: Vec<PastContact>,
}

/// A place where a pair met.
#[derive(Clone)]
struct PastContact {
    hit: Hit,
    /// Signed distance of the spheres that met, a length. Their radii may be reduced, so it is not the hit's depth.
    distance: Option<Real>,
}

/// All meetings of a step.
#[derive(Default)]
pub struct ImpactHistory {
    of_pair: FastMap<Pair, Meetings>,
    /// Pairs of each body, in the order in which they met first.
    of_body: FastMap<usize, Vec<Pair>>,
}

impl ImpactHistory {
    /// How often a pair met.
    pub fn count(&self, pair: Pair) -> u32 {
        self.of_pair.get(&pair).map_or(0, |m| m.count)
    }

    /// Time at which a pair met last, in seconds into the step.
    fn last_time(&self, pair: Pair) -> Option<Real> {
        let last = self.of_pair.get(&pair)?.places.last();
        last.map(|place| place.hit.time)
    }

    /// Seconds since a pair met last, or since the start of the step, if neither body got another motion since and no
    /// joint bends its path.
    pub fn undisturbed(&self, view: &StepView, pair: Pair, time: Real) -> Option<Real> {
        let since = self.last_time(pair).unwrap_or(0.0);
        let own = pair.into_iter().all(|k| {
            let body = &view.bodies[view.colliders[k].body];
            body.mobility != Mobility::Free || !body.jointed && body.time == since
        });
        (own && time > since).then_some(time - since)
    }

    /// A pair meets.
    pub fn add(&mut self, view: &StepView, pair: Pair, hit: &Hit) {
        let meetings = self.of_pair.entry(pair).or_default();
        if meetings.count == 0 {
            for k in pair {
                let body = view.colliders[k].body;
                self.of_body.entry(body).or_default().push(pair);
            }
        }
        meetings.count += 1;
        let places = &mut meetings.places;
        places.retain(|place| place.hit.primitives != hit.primitives);
        if places.len() == PLACES {
            places.remove(0);
        }
        let touch = (hit.met.as_ref()).and_then(|met| touch(view, pair, met, hit.time));
        places.push(PastContact {
            hit: hit.clone(),
            distance: touch.map(|touch| touch.distance),
        });
    }

    /// Number of places of a pair that are remembered.
    pub fn places(&self, pair: Pair) -> usize {
        self.of_pair.get(&pair).map_or(0, |m| m.places.len())
    }

    /// Pairs that any of some bodies met, each once. Those of fixed bodies are left out: they hand nothing on from one
    /// body to another.
    pub fn of(&self, view: &StepView, bodies: &[usize]) -> Vec<Pair> {
        let mut pairs = Vec::new();
        let free = bodies
            .iter()
            .filter(|b| view.bodies[**b].mobility == Mobility::Free);
        for pair in free.filter_map(|b| self.of_body.get(b)).flatten() {
            if !pairs.contains(pair) {
                pairs.push(*pair);
            }
        }
        pairs
    }

    /// The contact of a pair at one of its places, at `time` seconds into the step, and how far it has opened since
    /// they met there, a length, < 0 where it closed; `None` where that is not known.
    fn contact(
        &self,
        view: &StepView,
        (pair, place): (Pair, usize),
        time: Real,
    ) -> Option<(&Hit, Touch, Real)> {
        let PastContact { hit, distance } = self.of_pair.get(&pair)?.places.get(place)?;
        let touch = touch(view, pair, hit.met.as_ref()?, time)?;
        let opened = touch.distance - (*distance)?;
        Some((hit, touch, opened))
    }

    /// The contact that a pair has left at one of its places, if it is still there and closes so fast that it would be
    /// met again in this step. None of a driven body's.
    pub fn closing(
        &self,
        view: &StepView,
        policy: &CcdPolicy,
        frozen: impl Fn(usize) -> bool,
        (pair, place): (Pair, usize),
        time: Real,
    ) -> Option<Hit> {
        let bodies = pair.map(|k| view.colliders[k].body);
        let driven = |b: usize| view.bodies[b].mobility == Mobility::Driven;
        if bodies.into_iter().any(driven) || bodies.into_iter().all(frozen) {
            return None;
        }
        let (hit, touch, opened) = self.contact(view, (pair, place), time)?;
        let depth = hit.depth - opened;
        let thickness = view.thickness_at(pair, hit.primitives);
        let gap = policy.gap(thickness);
        if opened > gap {
            return None;
        }
        let motions = bodies.map(|b| view.bodies[b].motion_from(time));
        let speed = |point: Vector| {
            let [v1, v2] = (motions.each_ref())
                .map(|m| m.linvel + m.angvel.cross(point - m.start * m.local_center));
            (v1 - v2).dot(touch.normal)
        };
        let corners = touch.corners.map(|corners| with_room(&corners, policy.dt));
        let corners = corners.into_iter().flatten();
        let speeds = corners.map(|(corner, room)| speed(corner.point) - room);
        let approach = speeds.fold(speed(touch.point), Real::max) * (policy.dt - time);
        // A pair that touches may sink in by this before it meets again: by more above the floor than below.
        let tuning = &policy.tuning;
        let above = tuning.floor * thickness - depth;
        let sinks = above
            .min(tuning.sink * thickness)
            .max(tuning.min_sink * gap);
        let closes = approach > opened.max(0.0) + sinks;
        closes.then(|| Hit {
            time,
            normal: touch.normal,
            point: touch.point,
            depth,
            ..hit.clone()
        })
    }
}

/// The contact of what met, where the colliders are at `time` seconds into the step.
pub fn touch(view: &StepView, pair: Pair, met: &Met, time: Real) -> Option<Touch> {
    let [first, second] = pair.map(|k| view.motion(k, time).start);
    met.touch([&first, &second])
}
