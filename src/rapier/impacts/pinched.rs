//! Bodies that are pressed between two others of which neither gives way: a door and a wall, two fingers, a press and the
//! ground, or the ground and a hand that they hang on by joints.
//!
//! Where such a body is 2 mm or more in both of them, and below the floor ([`crate::rapier::tuning::Tuning::floor`]) in one,
//! there is no way out, and each impact on one side only brings the next one on the other, until the body has had all that it may
//! have in a step.
//! So its deep pairs are left to rapier's solver, which divides the depth between the two sides.

use crate::math::fast_hash::FastMap;
use crate::rapier::impacts::deep_pairs::DeepPairs;
use crate::rapier::view::all_joints::for_each_joint;
use crate::rapier::view::eligible_pairs::Rules;
use crate::rapier::view::groups::Groups;
use crate::rapier::view::motion::Kind;
use crate::rapier::view::step_view::StepView;
use std::collections::BTreeSet;

/// The one of two bodies that gives way to the other, and the other: a free one to one that is not, or to one of a higher
/// dominance group of rapier; `None` if each gives way.
fn yielding(view: &StepView, bodies: [usize; 2]) -> Option<[usize; 2]> {
    let [a, b] = bodies;
    let [free1, free2] = bodies.map(|k| view.bodies[k].kind == Kind::Free);
    let [first, second] = bodies.map(|k| view.bodies[k].dominance);
    match (free1, free2) {
        (true, true) if first == second => None,
        (true, true) if first < second => Some([a, b]),
        (true, false) => Some([a, b]),
        _ => Some([b, a]),
    }
}

/// Whether one of two free bodies alone gives way.
pub fn one_gives_way(view: &StepView, pair: [usize; 2]) -> bool {
    let bodies = pair.map(|k| view.parts[k].body);
    let free = |b: &usize| view.bodies[*b].kind == Kind::Free;
    bodies.iter().all(free) && yielding(view, bodies).is_some()
}

/// Watched pairs of bodies that are pressed, by themselves or through each other, against two that do not give way to them.
/// One of these two moves, and with one of them a body is below the floor; with the other it need not be as deep as to be
/// watched. Or one of the bodies hangs on one of the two by joints, and any pair is below the floor.
pub fn pinched(view: &StepView, deep: &DeepPairs, rules: &Rules) -> Vec<[usize; 2]> {
    let is_below = |pair: &[usize; 2]| deep.watched.get(pair).is_some_and(|deep| deep.way > 0.0);
    if !deep.watched.keys().any(is_below) {
        return Vec::new();
    }
    let free = |b: &usize| view.bodies[*b].kind == Kind::Free;
    let sunk = deep.sunk.iter();
    let sunk = sunk.map(|pair| (*pair, pair.map(|k| view.parts[k].body)));
    let sunk: Vec<_> = sunk.filter(|(_, bodies)| bodies.iter().any(free)).collect();
    let mut groups = Groups::default();
    for (_, bodies) in &sunk {
        if yielding(view, *bodies).is_none() {
            groups.join(*bodies);
        }
    }
    let hands = Hands::find(view, rules);
    let mut held: FastMap<usize, Held> = FastMap::default();
    for (pair, bodies) in &sunk {
        let gives_way = yielding(view, *bodies);
        for body in bodies.iter().filter(|b| free(b)) {
            let held = held.entry(groups.of(*body)).or_default();
            held.overlaps |= is_below(pair);
            held.hands.extend(hands.of(*body));
        }
        if let Some([body, jaw]) = gives_way {
            let held = held.entry(groups.of(body)).or_default();
            held.is_below |= is_below(pair);
            held.moves |= view.bodies[jaw].kind != Kind::Fixed;
            held.jaws.insert(jaw);
        }
    }
    held.retain(|_, held| held.is_pressed());
    let is_pressed = |bodies: [usize; 2]| bodies.iter().any(|b| held.contains_key(&groups.of(*b)));
    let watched = sunk
        .iter()
        .filter(|(pair, _)| deep.watched.contains_key(pair));
    let pairs = watched.filter(|(_, bodies)| is_pressed(*bodies));
    pairs.map(|(pair, _)| *pair).collect()
}

/// What holds a group of bodies that are sunk in each other.
#[derive(Default)]
struct Held {
    /// Bodies that they are sunk in and that do not give way.
    jaws: BTreeSet<usize>,
    /// Whether one of these moves.
    moves: bool,
    /// Bodies that move and do not give way, and on which one of the group hangs.
    hands: BTreeSet<usize>,
    /// Whether one is below the floor with a jaw.
    is_below: bool,
    /// Whether one is below the floor with any body.
    overlaps: bool,
}

impl Held {
    /// Whether two that do not give way press the group, of which one moves.
    fn is_pressed(&self) -> bool {
        let is_between = |hand| self.jaws.iter().any(|jaw| jaw != hand);
        let by_hand = self.hands.iter().any(is_between);
        self.jaws.len() > 1 && self.moves && self.is_below || by_hand && self.overlaps
    }
}

/// Bodies that move and do not give way, and what hangs on them by joints, which press it as a jaw does. Ropes and springs,
/// which lock no axis, do not.
struct Hands {
    groups: Groups,
    /// The hands of each group of free bodies.
    of_group: FastMap<usize, Vec<usize>>,
}

impl Hands {
    fn find(view: &StepView, rules: &Rules) -> Self {
        let mut groups = Groups::default();
        let mut hands = Vec::new();
        let joints = (rules.impulse_joints, rules.multibody_joints);
        for_each_joint(joints.0, joints.1, |handles, joint| {
            let holds = joint.is_enabled() && !joint.locked_axes.is_empty();
            if let [Some(&a), Some(&b)] = handles.map(|handle| view.index.get(&handle))
                && holds
            {
                match [a, b].map(|k| view.bodies[k].kind) {
                    [Kind::Free, Kind::Free] => groups.join([a, b]),
                    [Kind::Free, Kind::Driven] => hands.push([a, b]),
                    [Kind::Driven, Kind::Free] => hands.push([b, a]),
                    _ => {}
                }
            }
        });
        let mut of_group: FastMap<usize, Vec<usize>> = FastMap::default();
        for [held, hand] in hands {
            of_group.entry(groups.of(held)).or_default().push(hand);
        }
        Self { groups, of_group }
    }

    /// The hands on which a body hangs.
    fn of(&self, body: usize) -> &[usize] {
        let of_group = self.of_group.get(&self.groups.of(body));
        of_group.map_or(&[], Vec::as_slice)
    }
}
