//! Where pairs of colliders met in the impacts of this step. Most of them still touch there when one of the two is
//! struck again, and the poses tell how far such a contact has opened since.

use crate::math::fast_hash::FastMap;
use crate::math::{Pose, Real, Vector};
use crate::rapier::impacts::toi_query::{CcdPolicy, Hit};
use crate::rapier::view::motion::Kind;
use crate::rapier::view::step_view::StepView;

type Pair = [usize; 2];

/// The last meeting of a pair.
#[derive(Clone, Copy)]
struct Meeting {
    /// How often they met.
    count: u32,
    /// The hit's point in the frames of both bodies.
    points: [Vector; 2],
    /// In the frame of the first body.
    normal: Vector,
    /// Depth then, a length.
    depth: Real,
    /// The primitives that met.
    primitives: [u32; 2],
}

/// All meetings of a step.
#[derive(Default)]
pub struct ImpactHistory {
    last: FastMap<Pair, Meeting>,
    /// Pairs of each body, in the order in which they met first.
    of_body: FastMap<usize, Vec<Pair>>,
}

impl ImpactHistory {
    /// How often a pair met.
    pub fn count(&self, pair: Pair) -> u32 {
        self.last.get(&pair).map_or(0, |m| m.count)
    }

    /// A pair meets.
    pub fn add(&mut self, view: &StepView, pair: Pair, hit: &Hit) {
        let poses = poses(view, pair, hit.time);
        let count = self.count(pair);
        if count == 0 {
            for k in pair {
                let body = view.parts[k].body;
                self.of_body.entry(body).or_default().push(pair);
            }
        }
        let meeting = Meeting {
            count: count + 1,
            points: poses.map(|pose| pose.inverse_transform_point(hit.point)),
            normal: poses[0].rotation.inverse() * hit.normal,
            depth: hit.depth,
            primitives: hit.primitives,
        };
        self.last.insert(pair, meeting);
    }

    /// Pairs that any of some bodies met, each once.
    pub fn of(&self, bodies: &[usize]) -> Vec<Pair> {
        let mut pairs = Vec::new();
        for pair in bodies.iter().filter_map(|b| self.of_body.get(b)).flatten() {
            if !pairs.contains(pair) {
                pairs.push(*pair);
            }
        }
        pairs
    }

    /// The contact of a pair that met, at `time` seconds into the step, and how far it has opened since, a
    /// length, < 0 where it closed; `None` where no normal is known.
    pub fn contact(&self, view: &StepView, pair: Pair, time: Real) -> Option<(Hit, Real)> {
        let meeting = self.last.get(&pair)?;
        let poses = poses(view, pair, time);
        let [p, q] = [0, 1].map(|k| poses[k] * meeting.points[k]);
        let normal = poses[0].rotation * meeting.normal;
        let opened = (q - p).dot(normal);
        let hit = Hit {
            time,
            normal,
            point: (p + q) * 0.5,
            depth: meeting.depth - opened,
            primitives: meeting.primitives,
        };
        (normal != Vector::ZERO).then_some((hit, opened))
    }

    /// The contact that a pair of dynamic bodies has left, if it is still there and closes so fast that it
    /// would be met again in this step.
    pub fn closing(
        &self,
        view: &StepView,
        policy: &CcdPolicy,
        frozen: impl Fn(usize) -> bool,
        pair: Pair,
        time: Real,
    ) -> Option<Hit> {
        let bodies = pair.map(|k| view.parts[k].body);
        let free = |b: usize| view.bodies[b].kind == Kind::Free;
        if !bodies.into_iter().all(free) || bodies.into_iter().all(frozen) {
            return None;
        }
        let (hit, opened) = self.contact(view, pair, time)?;
        let thickness = view.thickness_at(pair, hit.primitives);
        let gap = policy.gap(thickness);
        if opened > gap {
            return None;
        }
        let velocity = |b: usize| {
            let m = view.bodies[b].motion_from(time);
            m.linvel + m.angvel.cross(hit.point - m.start * m.local_center)
        };
        let [v1, v2] = bodies.map(velocity);
        let approach = (v1 - v2).dot(hit.normal) * (policy.dt - time);
        // What touches may sink in before it is met again, above the floor by more than below.
        let tuning = &policy.tuning;
        let above = tuning.floor * thickness - hit.depth;
        let sinks = above.min(tuning.sink * thickness).max(tuning.hair * gap);
        (approach > opened.max(0.0) + sinks).then_some(hit)
    }
}

/// Of the bodies of both.
fn poses(view: &StepView, pair: Pair, time: Real) -> [Pose; 2] {
    pair.map(|k| {
        let body = &view.bodies[view.parts[k].body];
        body.motion_from(time).start
    })
}
