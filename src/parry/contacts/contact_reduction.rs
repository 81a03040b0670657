//! Chooses the contacts that bear the load of a body, four at most for each normal. Of contacts with one normal
//! rapier solves four: the deepest, the farthest from it, and the two farthest to its sides. A body of many
//! primitives need not lie on these, and then it sinks in and never sleeps.
//!
//! Seen along the normal, contact `i` is at `u_i` with a gap `d_i`. A body that is pressed down with its centre of mass
//! over `c` comes to lie on the facet above `c` of the lower convex hull of all `(u_i, d_i)`. That facet attains the
//! smallest `Σ λ_i d_i` with `Σ λ_i u_i = c`, `Σ λ_i = 1`, `λ ≥ 0`, which the simplex method finds: it has three rows,
//! and a pivot is a change of one corner. A fourth contact makes the facet wider; one that does not touch counts the
//! less, the higher it is above the facet, since the body stands on the others before it comes down there. Where `c` is
//! beside all contacts the body tips over, and the deepest contact is among the four.

use super::manifold_points::{normals, places};
use super::previous_contacts::PreviousContact;
use crate::math::{Pose, Real, Vector};
use parry3d::query::ContactManifold;

/// Cosine from which rapier 0.36 takes two manifolds to have one normal (5°).
const ONE_NORMAL: Real = 0.996;

/// Contacts under one normal that rapier solves.
const SOLVED: usize = 4;

/// Gaps that differ by less count as equal, in units of the prediction distance: contacts that bore
/// before stay, and wide ones come first. Without it the choice flickers, and impulses are lost.
const GAP_TOLERANCE: f64 = 0.02;

/// Contacts nearer to each other than this are one, in units of the prediction distance; as in rapier.
const SAME_PLACE: f64 = 0.25;

/// Width of the place that a body rolls over, in units of how far it rolls in a step: of the contacts within that of a
/// deeper one only that one bears. One ahead of a wheel's axle would stop what comes down on it, and the wheel with it.
/// Smaller, and wheels of few cones are braked; larger, and what rocks slowly has one contact. How the other body turns
/// is not looked at.
const ROLL_WIDTH: f64 = 3.0;

/// Steepest facet, as a gradient, where the load is beside all contacts and the body tips over: contacts
/// deeper than that slope from the edge it tips over are not left in. With 1 a knot slept 60 mm deep.
const STEEPEST: f64 = 0.02;

/// Area from which a contact makes the support wider, in units of the square of the largest distance from the centre.
const WIDER: f64 = 1.0e-3;

/// A contact that does not touch counts for less, in proportion to the smaller of its gap and its height above the
/// facet, in units of the prediction distance, but for no less than this part.
const MIN_WEIGHT: f64 = 0.3;

/// Factor for contacts that bore before, which keeps the choice from flickering between contacts that are worth the
/// same.
const KEEP_BONUS: f64 = 1.15;

/// Pivots after which the facet found so far has to do.
const PIVOTS: usize = 64;

/// A contact seen along its normal: a place in the plane across it, and a gap.
#[derive(Clone, Copy)]
struct Seen {
    /// Index of its manifold, and of its point there.
    contact: [usize; 2],
    /// Place in the plane, from the centre of mass.
    at: [f64; 2],
    /// Gap, less what preference is worth.
    gap: f64,
    /// Whether it bore in the step before.
    bore: bool,
}

/// The load that a body's contacts have to bear.
pub struct Load {
    /// Centre of mass of the body, in the first body's frame.
    pub center: Vector,
    /// Largest gap of a contact, a length.
    pub prediction: Real,
    /// How the body turns, where that is known.
    pub turn: Option<Turn>,
}

/// How a body turns in a step, in the frame of its medial mesh.
pub struct Turn {
    /// Angle in radians about each axis.
    pub angle: Vector,
    /// Centre of mass of the body.
    pub center: Vector,
}

impl Turn {
    /// How far the body rolls in the step over what it touches at `p` under a normal, a length: the turn about axes
    /// across the normal times the height of its centre, but no farther than the point turns. A turntable does not
    /// roll, nor does a coin that wobbles on its edge: it turns about a line through the point.
    fn rolls(&self, p: Vector, normal: Vector) -> Real {
        let arm = p - self.center;
        let across = self.angle - normal * self.angle.dot(normal);
        let rolls = across.length() * normal.dot(arm).abs();
        rolls.min(self.angle.cross(arm).length())
    }
}

/// Removes all contacts but those that bear the load: at most four for each normal, chosen for a load.
/// `previous` are the contacts that did so in the step before, on body `side`.
pub fn choose<M, C: Copy>(
    manifolds: &mut [ContactManifold<M, C>],
    pos12: &Pose,
    load: &Load,
    previous: &[PreviousContact<C>],
    side: usize,
) {
    let prediction = f64::from(load.prediction);
    let equal = GAP_TOLERANCE * prediction;
    let mut left_out = Vec::new();
    for group in groups(manifolds, equal) {
        let [n, _] = normals(&manifolds[group[0]]);
        let [x, y] = n.any_orthonormal_pair().into();
        let of_group = group.iter().flat_map(|&m| {
            let points = 0..manifolds[m].points.len();
            points.map(move |i| [m, i])
        });
        let see = |[m, i]: [usize; 2]| {
            let points = places(&manifolds[m], i);
            let from = points[0] - load.center;
            let bore = previous
                .iter()
                .any(|b| f64::from(b.place.distance(points[side])) < SAME_PLACE * prediction);
            Seen {
                contact: [m, i],
                at: [from.dot(x).into(), from.dot(y).into()],
                gap: manifolds[m].points[i].dist.into(),
                bore,
            }
        };
        let mut seen: Vec<Seen> = of_group.map(see).collect();
        // By the gap alone: what bore before would push a wheel on from behind its axle.
        let deepest = seen.iter().min_by(|a, b| a.gap.total_cmp(&b.gap));
        if let (Some(turn), Some(deepest)) = (&load.turn, deepest) {
            let [m, i] = deepest.contact;
            let (place, normal) = (places(&manifolds[m], i)[side], normals(&manifolds[m])[side]);
            let passed = ROLL_WIDTH * f64::from(turn.rolls(place, normal));
            if passed > SAME_PLACE * prediction {
                left_out.extend(without_doubles(&mut seen, passed));
            }
        }
        let bore = seen.iter_mut().filter(|s| s.bore);
        bore.for_each(|s| s.gap -= equal);
        left_out.extend(without_doubles(&mut seen, SAME_PLACE * prediction));
        if seen.iter().filter(|s| s.gap <= prediction).count() <= SOLVED {
            continue;
        }
        left_out.extend(
            seen.extract_if(.., |s| s.gap > prediction)
                .map(|s| s.contact),
        );
        let size = seen
            .iter()
            .map(|s| square(s.at))
            .fold(f64::MIN_POSITIVE, f64::max);
        for s in seen.iter_mut() {
            s.gap -= equal * square(s.at) / size;
        }
        let bear = bearing(&seen, prediction);
        let others = (0..seen.len()).filter(|i| !bear.contains(i));
        left_out.extend(others.map(|i| seen[i].contact));
    }
    // From the last on, so that indices stay.
    left_out.sort_unstable();
    for [m, i] in left_out.into_iter().rev() {
        manifolds[m].points.remove(i);
    }
    for group in groups(manifolds, equal) {
        let n = normals(&manifolds[group[0]]);
        let first = group.iter().copied().fold(group[0], usize::min);
        if first != group[0] {
            turn_to(&mut manifolds[first], n, pos12);
        }
    }
}

/// The manifolds that have contacts, in groups of about one normal, much as rapier makes them. Its normal of a group is
/// that of the first manifold, however far apart that is; here those that touch, up to a gap of `equal`, come first in
/// each.
fn groups<M, C>(manifolds: &[ContactManifold<M, C>], equal: f64) -> Vec<Vec<usize>> {
    let is_apart = |m: &usize| {
        let mut gaps = manifolds[*m].points.iter().map(|p| f64::from(p.dist));
        !gaps.any(|gap| gap <= equal)
    };
    let mut order: Vec<usize> = (0..manifolds.len()).collect();
    order.retain(|m| !manifolds[*m].points.is_empty());
    order.sort_by_key(is_apart);
    let mut groups: Vec<(Vector, Vec<usize>)> = Vec::new();
    for m in order {
        let [n, _] = normals(&manifolds[m]);
        match groups
            .iter_mut()
            .find(|(first, _)| first.dot(n) >= ONE_NORMAL)
        {
            Some((_, group)) => group.push(m),
            None => groups.push((n, vec![m])),
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

/// Turns a manifold to these normals out of both bodies, each in its body's frame; gaps are told along them.
fn turn_to<M, C>(manifold: &mut ContactManifold<M, C>, [n1, n2]: [Vector; 2], pos12: &Pose) {
    let in_part = |pose: Option<&Pose>, n: Vector| pose.map_or(n, |p| p.rotation.inverse() * n);
    manifold.local_n1 = in_part(manifold.subshape_pos1(), n1);
    manifold.local_n2 = in_part(manifold.subshape_pos2(), n2);
    for i in 0..manifold.points.len() {
        let [p1, p2] = places(manifold, i);
        manifold.points[i].dist = n1.dot(pos12 * p2 - p1);
    }
}

/// Takes out the contacts that have a deeper one within `radius`: neighbours meet in the sphere they
/// share, and parry names the ends of an edge twice.
fn without_doubles(seen: &mut Vec<Seen>, radius: f64) -> Vec<[usize; 2]> {
    seen.sort_by(|a, b| a.gap.total_cmp(&b.gap).then(a.contact.cmp(&b.contact)));
    let (mut kept, mut doubles): (Vec<Seen>, _) = (Vec::new(), Vec::new());
    for s in seen.drain(..) {
        let apart = |k: &Seen| square([0, 1].map(|axis| s.at[axis] - k.at[axis]));
        if kept.iter().any(|k| apart(k) < radius * radius) {
            doubles.push(s.contact);
        } else {
            kept.push(s);
        }
    }
    *seen = kept;
    doubles
}

/// Four of the contacts: the corners of the facet above the origin; if it lacks one, also the deepest, to which the
/// body tips over; then those that make the area over which the body stands largest, or are farthest from the others
/// where none makes it larger.
fn bearing(seen: &[Seen], prediction: f64) -> Vec<usize> {
    let (corners, plane) = facet(seen);
    let mut bear: Vec<usize> = corners.into_iter().flatten().collect();
    let deepest = (0..seen.len()).min_by(|i, j| seen[*i].gap.total_cmp(&seen[*j].gap));
    if bear.len() < corners.len() {
        bear.extend(deepest.filter(|i| !bear.contains(i)));
    }
    let least = WIDER * seen.iter().map(|s| square(s.at)).fold(0.0, f64::max);
    while bear.len() < SOLVED {
        let chosen: Vec<[f64; 2]> = bear.iter().map(|b| seen[*b].at).collect();
        let worth = |s: &Seen| {
            let low = (1.0 - above(&plane, s).min(s.gap) / prediction.max(f64::MIN_POSITIVE))
                .clamp(MIN_WEIGHT, 1.0);
            let counts = if s.bore { KEEP_BONUS * low } else { low };
            let gain = counts * gained(&chosen, s.at);
            let to = |c: &[f64; 2]| square([s.at[0] - c[0], s.at[1] - c[1]]);
            let apart = counts * counts * chosen.iter().map(to).fold(f64::MAX, f64::min);
            (if gain > least { gain } else { 0.0 }, apart)
        };
        let rest = (0..seen.len()).filter(|i| !bear.contains(i));
        let rest = rest.map(|i| (i, worth(&seen[i])));
        let next = rest.max_by(|(_, a), (_, b)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let Some((next, _)) = next else { break };
        bear.push(next);
    }
    bear
}

/// Height of a contact above a plane, which is its height at the origin and its gradient.
fn above(plane: &[f64; 3], s: &Seen) -> f64 {
    s.gap - (plane[0] + plane[1] * s.at[0] + plane[2] * s.at[1])
}

/// Area that a point adds to a triangle, twice; the triangle's own of two points and this one.
fn gained(of: &[[f64; 2]], p: [f64; 2]) -> f64 {
    let twice =
        |a: [f64; 2], b: [f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    match *of {
        [a, b] => twice(a, b).abs(),
        [a, b, c] => {
            let parts = [twice(a, b), twice(b, c), twice(c, a)];
            let whole: f64 = parts.iter().sum();
            // The parts on the other side of an edge.
            parts
                .iter()
                .map(|part| (-part * whole.signum()).max(0.0))
                .sum()
        }
        _ => 0.0,
    }
}

/// The corners of the facet above the origin, and its plane. One is missing where the origin is not above the contacts:
/// the body then lies on an edge or on one contact.
fn facet(seen: &[Seen]) -> ([Option<usize>; 3], [f64; 3]) {
    // Three corners that are not there, so far out and so high that any real facet is below them.
    let reach = 2.0 * seen.iter().map(|s| square(s.at)).fold(0.0, f64::max).sqrt();
    let highest = seen.iter().map(|s| s.gap).fold(f64::MIN, f64::max);
    let around = [[2.0, 0.0], [-1.0, 2.0], [-1.0, -2.0]];
    let far = around.map(|at| at.map(|x: f64| x * reach));
    let mut corners = far.map(|at| (None, at, highest + STEEPEST * reach));
    let mut plane = through(&corners.map(|(_, at, gap)| (at, gap)));
    for _ in 0..PIVOTS {
        let above = |i: &usize| above(&plane, &seen[*i]);
        let by_height = |i: &usize, j: &usize| above(i).total_cmp(&above(j));
        let lowest = (0..seen.len()).min_by(by_height);
        let Some(enters) = lowest.filter(|i| above(i) < -1.0e-12 * reach) else {
            break;
        };
        // The corner that the origin is left of when the new one takes its place cannot stay.
        let at = corners.map(|(_, at, _)| at);
        let (origin, new) = (shares(&at, [0.0; 2]), shares(&at, seen[enters].at));
        let ratio = |k: &usize| origin[*k].max(0.0) / new[*k];
        let leaves = (0..3)
            .filter(|k| new[*k] > 1.0e-9)
            .min_by(|i, j| ratio(i).total_cmp(&ratio(j)));
        let Some(leaves) = leaves else { break };
        let mut changed = corners;
        changed[leaves] = (Some(enters), seen[enters].at, seen[enters].gap);
        let next = through(&changed.map(|(_, at, gap)| (at, gap)));
        if !next.iter().all(|x| x.is_finite()) {
            break;
        }
        (corners, plane) = (changed, next);
    }
    (corners.map(|(i, _, _)| i), plane)
}

/// Shares of three corners in a point: barycentric coordinates.
fn shares(at: &[[f64; 2]; 3], p: [f64; 2]) -> [f64; 3] {
    let area = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let [a, b, c] = *at;
    let whole = area(a, b, c);
    [area(p, b, c), area(a, p, c), area(a, b, p)].map(|part| part / whole)
}

/// The plane through three corners: its height at the origin and its gradient.
fn through(corners: &[([f64; 2], f64); 3]) -> [f64; 3] {
    let at = corners.map(|(at, _)| at);
    let height = |p| {
        let shares = shares(&at, p);
        (0..3).map(|k| shares[k] * corners[k].1).sum::<f64>()
    };
    let base: f64 = height([0.0; 2]);
    [base, height([1.0, 0.0]) - base, height([0.0, 1.0]) - base]
}

fn square(at: [f64; 2]) -> f64 {
    at[0] * at[0] + at[1] * at[1]
}
