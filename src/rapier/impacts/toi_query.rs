//! First contact of two colliders on the motions of a [`StepView`]: at which distance a pair counts as in contact, and
//! the certified query that finds when.
//!
//! - A fast pair stops a small gap before it touches. If it touches already, it may sink in by a tenth of the thickness
//!   more, but not deeper than [`Tuning::floor`]; if it is deeper than that already, by [`Tuning::press`].
//! - A slow pair is left to rapier's solver down to that floor. At the floor the cores of the bodies meet
//!   ([`crate::elementary::Cores`]), at every place half way to the medial axes, so that no axis crosses another.
//!
//! A pair is fast in relation to the thickness of the parts that may meet: one that is slow for two thick bodies is
//! fast where parts of them that may meet are fast for how thin they are ([`FastParts`]).

use crate::batch::ToiJob;
use crate::elementary::{Cores, InitialContact, Paths, ToiOptions};
use crate::math::counters::counters;
use crate::math::{Real, Vector};
use crate::pair::first_contact::{Counts, Query, ToiResult};
use crate::pair::outline::ActivePrimitives;
use crate::parry::queries::cast::Cast;
use crate::parry::queries::initial_contacts::AtStart;
use crate::parry::queries::sliding::SinkLimits;
use crate::rapier::effects::{Effect, EffectSettings, Effects};
use crate::rapier::impacts::fast_parts::FastParts;
use crate::rapier::impacts::hit::Hit;
use crate::rapier::tuning::Tuning;
use crate::rapier::view::step_view::StepView;
use parry3d::query::NonlinearRigidMotion;

/// Distance by which a pair that touches at the start of the step may be farther apart than the gap at which it was
/// left, in units of rapier's length unit. Smaller, and a pair that rests is muted for rounding; larger, and thin parts
/// that pass beside each other are left to the solver, which stops them.
const TOUCHING_MORE: Real = 1.0e-4;

counters! {
    /// Work that the searches of a step for first contacts took.
    pub struct Work {
        /// Continuous queries.
        pub queries: u64,
        /// Continuous queries in exact rotation.
        pub rotating: u64,
        /// Node pairs and elementary tests.
        pub counts: Counts,
    }
}

impl Work {
    /// Work spent so far, to be compared with [`CcdPolicy::budget`].
    pub fn spent(&self) -> u64 {
        self.counts.work()
    }

    /// Counts a query.
    pub fn begin(&mut self, motions: &[NonlinearRigidMotion; 2], options: &ToiOptions) {
        self.queries += 1;
        let turning = motions.iter().any(|m| m.angvel != Vector::ZERO);
        self.rotating += u64::from(turning && options.paths == Paths::Exact);
    }
}

/// Options of the query for a pair.
pub struct QueryOptions {
    /// The first contact.
    pub first: ToiOptions,
    /// Asked for too where the pair is deep: what it must not sink below.
    pub floor: Option<ToiOptions>,
    /// All of both that may come as near as is asked, where that is known.
    pub reachable: Option<[ActivePrimitives; 2]>,
    /// Depths up to which flat faces over which a body slides are no obstacles.
    pub sinks: SinkLimits,
}

/// Asks for first contacts in a step of `dt` seconds.
#[derive(Clone, Copy)]
pub struct CcdPolicy<'a> {
    /// Effects that the pairs call for.
    pub effects: &'a EffectSettings,
    /// Length of the step in seconds.
    pub dt: Real,
    /// rapier's length unit.
    pub unit: Real,
    /// Distance up to which rapier's solver gets contacts, a length.
    pub prediction: Real,
    /// How far gravity presses a body into rapier's contacts, which are springs, a length.
    pub sag: Real,
    /// rapier's sub-steps in a step.
    pub substeps: usize,
    /// Constants.
    pub tuning: Tuning,
    /// Whether the world may stop once more in this step.
    pub may_stop: bool,
    /// Work that first contacts may take ([`Counts::work`]).
    pub budget: u64,
    /// Whether pairs may bounce in this step ([`Effects::restitution`]), which rapier's solver does not have then.
    pub bouncing: bool,
}

impl CcdPolicy<'_> {
    /// Rest of the budget.
    pub fn budget_left(&self, work: &Work) -> u64 {
        self.budget.saturating_sub(work.spent())
    }

    /// Gap at which a fast pair counts as in contact, a length.
    pub fn gap(&self, thickness: Real) -> Real {
        let [gap, share] = self.tuning.gap;
        (gap * self.unit)
            .min(share * thickness)
            .max(self.least_gap())
    }

    /// The least of all gaps, a length.
    pub fn least_gap(&self) -> Real {
        (self.tuning.least_gap * self.unit).max(Real::MIN_POSITIVE)
    }

    pub(super) fn effects_of(&self, view: &StepView, pair: [usize; 2]) -> Effects {
        self.effects.of(pair.map(|k| view.colliders[k].handle))
    }

    /// Whether the pair as a whole is fast: by default, when it would travel more than [`Tuning::muted`] of its
    /// thickness in the step where it may come within `margin` (a length).
    pub fn is_fast(&self, view: &StepView, pair: [usize; 2], margin: Real) -> bool {
        match self.effects_of(view, pair).continuous {
            Effect::On => true,
            Effect::Off => false,
            Effect::Auto => {
                let way = self.tuning.muted * view.thickness(pair);
                view.travel(pair, self.dt) > way
                    && view.meeting_speed(pair, [0.0, self.dt], margin) * self.dt > way
            }
        }
    }

    /// Whether first contacts of the pair are wanted from `time` on: by default, of a pair with parts that may meet and
    /// would travel more than a share of the local thickness against each other in a whole step.
    fn is_searched(&self, view: &StepView, pair: [usize; 2], time: Real) -> bool {
        if self.may_bounce(view, pair) {
            return true;
        }
        match self.effects_of(view, pair).continuous {
            Effect::On => return true,
            Effect::Off => return false,
            Effect::Auto => {}
        }
        let least = pair.map(|k| view.colliders[k].least);
        let travel = view.travel(pair, self.dt);
        if travel <= self.tuning.fast * least[0].min(least[1]) {
            return false;
        }
        let skins: Real = pair.iter().map(|k| view.colliders[*k].skin).sum();
        let contact = skins + 2.0 * self.gap(view.thickness(pair));
        let fast = FastParts {
            seconds: self.dt / self.tuning.fast,
            reach: view.travel(pair, self.dt - time) + contact,
            contact,
        };
        fast.may_meet(view, pair, [time, self.dt])
    }

    /// Whether a pair can travel more than `share` of this thickness, or is watched whatever it does. In a
    /// scene at rest none does, and no pair need be looked for.
    pub fn may_be_fast(&self, view: &StepView, share: Real, thickness: Real) -> bool {
        let asked = |e: &Effects| e.continuous == Effect::On || e.guard == Effect::On;
        self.effects.any(asked)
            || self.bouncing
            || 2.0 * view.most_travel(self.dt) > share * thickness
    }

    /// Whether the solver gets contacts of the pair for all that it may reach in the step.
    pub fn speculates(&self, view: &StepView, pair: [usize; 2]) -> bool {
        self.effects_of(view, pair).speculative == Effect::On
    }

    /// Whether the world stops at the pair's first contact.
    pub fn stops(&self, view: &StepView, pair: [usize; 2]) -> bool {
        self.may_stop && self.effects_of(view, pair).stop == Effect::On
    }

    /// Query options from `time` on for a pair that has met so often in this step; `None` if no query is needed.
    /// `deep`: rapier's contacts are, so that even a slow pair is kept above the floor.
    pub fn query_options(
        &self,
        view: &StepView,
        pair: [usize; 2],
        time: Real,
        met: u32,
        deep: bool,
    ) -> Option<QueryOptions> {
        if time >= self.dt || view.travel(pair, self.dt - time) <= 0.0 {
            return None;
        }
        let fast = self.is_searched(view, pair, time);
        let effects = self.effects_of(view, pair);
        let watched = match effects.guard {
            Effect::On => true,
            Effect::Off => false,
            Effect::Auto => deep,
        };
        if !(fast || watched) {
            return None;
        }
        let tuning = &self.tuning;
        let thickness = view.thickness(pair);
        let gap = self.gap(thickness);
        let skin = view.colliders[pair[0]].skin + view.colliders[pair[1]].skin;
        let paths = match effects.exact_rotation {
            Effect::Off => Paths::Straight,
            Effect::On | Effect::Auto => Paths::Exact,
        };
        let at_most = view.foreign_thickness(pair);
        let options = |target: Real, by: Real, share: Real| ToiOptions {
            paths,
            target_distance: skin + target,
            tolerance: tuning.tolerance * gap,
            initial_contact: InitialContact::Deepen { by },
            cores: Some(Cores {
                share,
                at_most,
                tips: tuning.tips,
            }),
            ..ToiOptions::default()
        };
        let min_sink = tuning.min_sink * gap;
        let pressed = match view.are_of_pieces(pair) {
            true => (tuning.flat_sink * thickness).max(min_sink),
            false => min_sink,
        };
        let floor = options(0.5 * self.least_gap(), pressed, tuning.floor);
        // Where a meeting was, the gap is that of the target to within the tolerance: a larger target
        // makes it count as touching.
        let target = if self.stops(view, pair) {
            tuning.stopping * gap
        } else {
            gap * (1.0 + 2.0 * tuning.tolerance * met as Real)
        };
        // A pair that bounces does so where it touches; the solver does not keep it from sinking.
        let by = match self.may_bounce(view, pair) {
            true => min_sink,
            false => (tuning.sink * thickness).max(min_sink),
        };
        let sinks = self.sinks(view, pair, by);
        Some(if fast {
            QueryOptions {
                first: options(target, by, 0.0),
                floor: Some(floor),
                reachable: None,
                sinks,
            }
        } else {
            QueryOptions {
                first: floor,
                floor: None,
                reachable: None,
                sinks,
            }
        })
    }

    /// How deep a pair may lie on flat faces, where it may sink in `by` deeper elsewhere.
    fn sinks(&self, view: &StepView, pair: [usize; 2], by: Real) -> SinkLimits {
        let least = pair.map(|k| view.colliders[k].least);
        let least = least[0].min(least[1]);
        SinkLimits {
            at_start: least.min(self.tuning.flat_depth * self.unit + self.sag),
            at_most: self.tuning.floor * least,
            change: by.min(self.tuning.sink * least),
        }
    }

    /// The first query of a pair of medial meshes at the start of the step, as a job of a batch; `None`
    /// for other pairs, and where nothing is to be asked.
    pub fn job(&self, view: &StepView, pair: [usize; 2], deep: bool) -> Option<ToiJob> {
        let [Some(mesh1), Some(mesh2)] = pair.map(|k| view.colliders[k].medial()) else {
            return None;
        };
        let query_options = self.query_options(view, pair, 0.0, 0, deep)?;
        let [motion1, motion2] = pair.map(|k| view.motion(k, 0.0));
        Some(ToiJob {
            mesh1: mesh1.clone(),
            mesh2: mesh2.clone(),
            motion1,
            motion2,
            seconds: self.dt,
            options: query_options.first,
        })
    }

    /// First contact from `time` on; `known` is the answer to the first query where it was asked before.
    pub fn first_contact(
        &self,
        view: &StepView,
        pair: [usize; 2],
        time: Real,
        query_options: &QueryOptions,
        known: Option<ToiResult>,
        work: &mut Work,
    ) -> Option<Hit> {
        let motions = pair.map(|k| view.motion(k, time));
        let seconds = self.dt - time;
        let mut query = |options: &ToiOptions, known: Option<ToiResult>| {
            let asked = || ask(view, pair, &motions, seconds, options, query_options);
            let found = known.or_else(asked)?;
            work.begin(&motions, options);
            work.counts += found.counts;
            let hit = Hit::of(&found.toi, found.met, time, seconds);
            Some((hit, found.deepest))
        };
        let (hit, deepest) = query(&query_options.first, known)?;
        let meets_later = hit.as_ref().is_none_or(|h| h.time > time);
        let deep = meets_later && deepest <= self.floor_depth();
        let floor = query_options.floor.as_ref().filter(|_| deep);
        match (hit, floor.and_then(|options| query(options, None)?.0)) {
            (Some(a), Some(b)) if a.time <= b.time => Some(a),
            (a, b) => b.or(a),
        }
    }

    /// Distance between two shapes, a length, up to which their surfaces count as `distance` apart, skins included.
    pub fn reach(&self, view: &StepView, [i, j]: [usize; 2], distance: Real) -> Real {
        let skins = view.colliders[i].skin + view.colliders[j].skin;
        distance + skins + TOUCHING_MORE * self.unit
    }

    /// The floor in the units of [`Query::deepest`]: primitives that may get there before they count as in contact have
    /// a query of their own for it.
    pub fn floor_depth(&self) -> f64 {
        -f64::from(self.tuning.floor)
    }
}

/// The certified query for two colliders, one of them medial. `None` for shapes that cannot be swept.
fn ask(
    view: &StepView,
    pair: [usize; 2],
    motions: &[NonlinearRigidMotion; 2],
    seconds: Real,
    options: &ToiOptions,
    QueryOptions {
        reachable, sinks, ..
    }: &QueryOptions,
) -> Option<ToiResult> {
    let [p, q] = pair.map(|k| &view.colliders[k]);
    if let (Some(a), Some(b)) = (p.medial(), q.medial()) {
        let active = reachable.clone();
        let query = Query::new(motions.each_ref(), (a, b), seconds, options, active);
        return Some(query.settle());
    }
    let flipped = p.medial().is_none();
    let order = if flipped { [1, 0] } else { [0, 1] };
    let [mesh, other] = order.map(|k| [p, q][k]);
    let [motion1, motion2] = order.map(|k| &motions[k]);
    let cast = Cast {
        motion1,
        mesh: mesh.medial()?,
        motion2,
        other: &*other.shape,
        times: [0.0, seconds],
        target_distance: options.target_distance,
        at_start: AtStart::Stop,
        stop_approach: false,
    };
    let left = reachable
        .as_ref()
        .map(|left| order.map(|k| left[k].clone()));
    let mut found = cast.toi_sliding(options, left, Some(*sinks)).ok()?;
    if flipped {
        let toi = &mut found.toi;
        toi.normal = -toi.normal;
        toi.points.swap(0, 1);
        toi.spheres.swap(0, 1);
        toi.primitives.swap(0, 1);
        found.met = found.met.map(|met| met.flipped());
    }
    Some(found)
}
