//! Bodies that are pressed between two others of which neither gives way: a door and a wall, two fingers, a press and
//! the ground, or the ground and a hand that they hang on by joints.
//!
//! Where such a body is 2 mm or more in both of them, and below the floor ([`crate::rapier::tuning::Tuning::floor`]) in
//! one, there is no way out, and each impact on one side only brings the next one on the other, until the body has had
//! all that it may have in a step. So its deep pairs are left to rapier's solver, which divides the depth between the
//! two sides.

use crate::math::Real;
use crate::math::fast_hash::FastMap;
use crate::rapier::impacts::deep_pairs::{Deep, DeepPairs};
use crate::rapier::view::all_joints::for_each_joint;
use crate::rapier::view::eligible_pairs::Rules;
use crate::rapier::view::groups::BodyGroups;
use crate::rapier::view::joint_opening::opening;
use crate::rapier::view::motion::Mobility;
use crate::rapier::view::step_view::StepView;

/// The one of two bodies that gives way to the other, and the other: a free one to one that is not, or to one of a
/// higher dominance group of rapier; `None` if each gives way.
fn yielding(view: &StepView, bodies: [usize; 2]) -> Option<[usize; 2]> {
    let [a, b] = bodies;
    let [free1, free2] = bodies.map(|k| view.bodies[k].mobility == Mobility::Free);
    let [first, second] = bodies.map(|k| view.bodies[k].dominance);
    match (free1, free2) {
        (true, true) if first == second => None,
        (true, true) if first < second => Some([a, b]),
        (true, false) => Some([a, b]),
        _ => Some([b, a]),
    }
}

/// Whether dominance groups keep one of a pair from being pushed back: two free bodies of different groups, or a free
/// body of a higher group than one that nothing stops.
pub fn one_dominates(view: &StepView, pair: [usize; 2]) -> bool {
    let [first, second] = pair.map(|k| &view.bodies[view.colliders[k].body]);
    match [first, second].map(|body| body.mobility == Mobility::Free) {
        [true, true] => first.dominance != second.dominance,
        [true, false] => first.dominance > second.dominance,
        [false, true] => second.dominance > first.dominance,
        [false, false] => false,
    }
}

/// Watched pairs of bodies that are pressed, by themselves or through each other, against two that do not give way to
/// them. One of these two moves, and with one of them a medial collider is below the floor; in the other the bodies
/// need not be as deep as to be watched.
pub fn pinched(view: &StepView, deep: &DeepPairs) -> Vec<[usize; 2]> {
    let free = |b: &usize| view.bodies[*b].mobility == Mobility::Free;
    let is_below = |pair: &[usize; 2]| deep.watched.get(pair).is_some_and(|deep| deep.way > 0.0);
    let sunk = deep.sunk.iter();
    let sunk = sunk.map(|pair| (*pair, pair.map(|k| view.colliders[k].body), is_below(pair)));
    let sunk: Vec<_> = sunk
        .filter(|(_, bodies, _)| bodies.iter().any(free))
        .collect();
    let mut groups = BodyGroups::default();
    for (_, bodies, _) in &sunk {
        if yielding(view, *bodies).is_none() {
            groups.join(*bodies);
        }
    }
    let mut held: FastMap<usize, Held> = FastMap::default();
    for (_, bodies, is_below) in &sunk {
        if let Some([body, jaw]) = yielding(view, *bodies) {
            let held = held.entry(groups.of(body)).or_default();
            held.is_below |= is_below;
            held.moves |= view.bodies[jaw].mobility != Mobility::Fixed;
            held.is_pinched |= held.jaw.is_some_and(|other| other != jaw);
            held.jaw = Some(jaw);
        }
    }
    held.retain(|_, held| held.is_pinched && held.moves && held.is_below);
    let is_pinched = |bodies: [usize; 2]| bodies.iter().any(|b| held.contains_key(&groups.of(*b)));
    let watched = sunk
        .iter()
        .filter(|(pair, ..)| deep.watched.contains_key(pair));
    let pairs = watched.filter(|(_, bodies, _)| is_pinched(*bodies));
    pairs.map(|(pair, ..)| *pair).collect()
}

/// Watched pairs below the floor that joints press together as jaws do: one of the two bodies hangs by joints on a
/// hand, a third body that moves and does not give way. Either the other body does not give way; or it is itself deep
/// in one that does not, and the hand's joint is open by at least as much as the pair would have to part
/// ([`Deep::way`]): a hand that holds a chain of rings over the ground presses nothing. Ropes and springs, which lock
/// no axis, do not count.
pub fn pressed_by_joints(view: &StepView, deep: &DeepPairs, rules: &Rules) -> Vec<[usize; 2]> {
    let is_below = |(_, deep): &(&[usize; 2], &Deep)| deep.way > 0.0;
    let below: Vec<_> = deep.watched.iter().filter(is_below).collect();
    if below.is_empty() {
        return Vec::new();
    }
    let hands = Hands::find(view, rules);
    let bodies = |pair: &[usize; 2]| pair.map(|k| view.colliders[k].body);
    let sunk = deep.sunk.iter();
    let stuck: Vec<_> = sunk
        .filter_map(|pair| yielding(view, bodies(pair)))
        .collect();
    let is_pressed = |pair: &[usize; 2], way: Real| {
        let [a, b] = bodies(pair);
        match yielding(view, [a, b]) {
            Some([body, jaw]) => hands.hold(body, jaw, 0.0),
            None => [[a, b], [b, a]].iter().any(|[held, other]| {
                let mut jaws = stuck.iter().filter(|[body, _]| body == other);
                jaws.any(|[_, jaw]| hands.hold(*held, *jaw, way))
            }),
        }
    };
    let pressed = below.into_iter();
    let pressed = pressed.filter(|(pair, deep)| is_pressed(pair, deep.way));
    pressed.map(|(pair, _)| *pair).collect()
}

/// Bodies that hang by joints on hands: bodies that move and do not give way.
struct Hands {
    /// Free bodies that joints hold together.
    groups: BodyGroups,
    /// A body that hangs on a hand, the hand, and the length by which their joint is open.
    held: Vec<([usize; 2], Real)>,
}

impl Hands {
    fn find(view: &StepView, rules: &Rules) -> Self {
        let mut groups = BodyGroups::default();
        let mut held = Vec::new();
        let joints = (rules.impulse_joints, rules.multibody_joints);
        for_each_joint(joints.0, joints.1, |handles, joint| {
            let [Some(&a), Some(&b)] = handles.map(|handle| view.index.get(&handle)) else {
                return;
            };
            if !joint.is_enabled() || joint.locked_axes.is_empty() {
                return;
            }
            match [a, b].map(|k| view.bodies[k].mobility) {
                [Mobility::Free, Mobility::Free] => groups.join([a, b]),
                [Mobility::Free, Mobility::Driven] => {
                    held.push(([a, b], opening(view, [a, b], joint)))
                }
                [Mobility::Driven, Mobility::Free] => {
                    held.push(([b, a], opening(view, [a, b], joint)))
                }
                _ => {}
            }
        });
        Self { groups, held }
    }

    /// Whether a body hangs on a hand other than `jaw`, by a joint that is open by `way` or more.
    fn hold(&self, body: usize, jaw: usize, way: Real) -> bool {
        let mut held = self.held.iter();
        held.any(|([held, hand], opening)| {
            *hand != jaw && self.groups.of(*held) == self.groups.of(body) && *opening >= way
        })
    }
}

/// The bodies that hold a group of bodies and do not give way to it.
#[derive(Default)]
struct Held {
    /// One of the bodies that do not give way.
    jaw: Option<usize>,
    /// Whether there is another.
    is_pinched: bool,
    /// Whether one of them moves.
    moves: bool,
    /// Whether one is below the floor with them.
    is_below: bool,
}
