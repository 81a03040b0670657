//! Contacts of two bodies at fixed poses: pairs of near spheres, from which contact manifolds are made
//! (`parry/contacts/manifolds.rs`). A walk down both trees finds them. Parts that a few directions keep apart
//! ([`super::outline`]) are not searched. Two convex pieces, which the builder makes of blocks, are settled as a
//! whole (`face_contacts.rs`), and so is a convex piece that is deep in a primitive (`hulls.rs`); of all other bodies
//! primitives are taken pair by pair (`primitive_pair.rs`).

use super::contact_list::ContactList;
use super::descent::Descent;
use super::first_contact::Counts;
use super::hulls::Hulls;
use super::outline;
use super::placement::Placement;
use super::primitive_pair::PrimitivePair;
use super::primitive_tree::PrimitiveTree;
use super::sphere_pair::SpherePair;
use crate::elementary::distance::Ball;
use crate::elementary::penetration::{self, gap_along};
use crate::math::lane::Vec3;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialSphere;

/// Times that a node pair is split before directions are tried on it again, once they have failed on [`FAILED`] of the
/// inner nodes, and on three of four. In threads, whose ridges lie in each other's grooves, directions keep few nodes
/// apart but most primitives: with 1 a nut and its bolt take 7,300 tries, with 3 from the start 5,000.
const SPLITS: u8 = 3;

/// Failures after which that is done: what are fewer costs less than it may save.
const FAILED: u32 = 256;

/// Contacts of two bodies at fixed poses: pairs of spheres within `prediction` (a length) of each other, all of them up
/// to 2,048, and of more the nearest, with all within an eighth of `prediction`. `pos12` is the pose of the second body
/// in the frame of the first. Computed in double precision; result and order depend on the input only. A pose that is
/// not finite gives no contacts.
pub fn contacts(
    body1: &impl PrimitiveTree,
    body2: &impl PrimitiveTree,
    pos12: &Pose,
    prediction: Real,
) -> (Vec<SpherePair>, Counts) {
    let mut found = ContactList::new(prediction.into());
    let mut counts = Counts::default();
    if !(pos12.is_finite() && prediction.is_finite()) {
        return (Vec::new(), counts);
    }
    let place = Placement::new(pos12);
    let Some(near) = outline::near(body1, body2, |p| place.point(p), prediction) else {
        return (Vec::new(), counts);
    };
    // With the splits since directions were tried.
    let mut stack: Vec<([u32; 2], u8)> = Vec::new();
    for i in 0..body1.roots() {
        stack.extend((0..body2.roots()).map(|j| ([i, j], SPLITS)));
    }
    let mut hulls = Hulls::new((body1, body2), &place);
    // Inner nodes that directions kept apart, and that they did not.
    let mut inner = [0; 2];
    while let Some(([i, j], splits)) = stack.pop() {
        if !near.meet([i, j]) {
            continue;
        }
        counts.nodes += 1;
        let margin = found.margin();
        let (a, b) = (body1.bound(i), body2.bound(j));
        let (ra, rb) = (f64::from(a.1), f64::from(b.1));
        let y = place.point(b.0) - Vec3::from_vector(a.0);
        let reach = ra + rb + margin;
        // Bounds carry their own rounding; what is left is that of this subtraction.
        if y.length_sq() > reach * reach * (1.0 + 1.0e-12) {
            continue;
        }
        let step = Descent::of((body1, body2), [i, j]);
        let is_leaf = matches!(step, Descent::Leaves(_));
        let [kept, split] = inner;
        let is_idle = split >= FAILED && 3 * kept <= split && margin >= 0.0;
        let is_tried = is_leaf || !(near.is_exact() || is_idle && splits < SPLITS);
        let is_apart = is_tried && hulls.gap([i, j], margin) > margin;
        inner[usize::from(!is_apart)] += u32::from(is_tried && !is_leaf);
        if is_apart {
            continue;
        }
        if let Some(contacts) = hulls.pieces_contacts([i, j], margin, &mut counts) {
            found.extend(contacts);
            continue;
        }
        let splits = if is_tried {
            1
        } else {
            splits.saturating_add(1)
        };
        match step {
            Descent::Leaves(primitives) => {
                let pair = PrimitivePair::new(body1, body2, primitives, &place);
                pair.contacts(&mut found, &mut counts);
            }
            Descent::First(children) => {
                stack.extend(children.map(|c| ([c, j], splits)).into_iter().rev())
            }
            Descent::Second(children) => {
                stack.extend(children.map(|c| ([i, c], splits)).into_iter().rev())
            }
        }
    }
    (found.into_contacts(), counts)
}

/// The spheres of a convex piece, placed, or of the primitive where it is of none.
fn placed_spheres(
    body: &impl PrimitiveTree,
    piece: Option<u32>,
    primitive: &[Ball<f64>],
    point: impl Fn(Vector) -> Vec3<f64>,
) -> Vec<Ball<f64>> {
    match piece.and_then(|node| body.convex_piece(node)) {
        Some(piece) => {
            let placed = |s: &MedialSphere| (point(s.center), f64::from(s.radius));
            piece.spheres.iter().map(placed).collect()
        }
        None => primitive.to_vec(),
    }
}

/// The sphere pair of two overlapping primitives, or of the convex pieces that they are of, along the normal nearest to
/// `old`, that of the step before, among those hardly deeper than the least ([`penetration::HYSTERESIS`]). `at`: their
/// deepest contact now; the points stay in the middle of its.
pub(crate) fn along_old_normal(
    body1: &impl PrimitiveTree,
    body2: &impl PrimitiveTree,
    pos12: &Pose,
    at: &SpherePair,
    old: Vector,
) -> SpherePair {
    let place = Placement::new(pos12);
    let pair = PrimitivePair::new(body1, body2, at.primitives, &place);
    let [p, q] = at.primitives;
    let (a, b) = pair.spheres();
    let (old, new) = (Vec3::from_vector(old), Vec3::from_vector(at.normal));
    let (gap, n) = match (body1.piece_of(p), body2.piece_of(q)) {
        (None, None) => penetration::deepest(a, b, old, penetration::HYSTERESIS),
        pieces => {
            let a = placed_spheres(body1, pieces.0, a, Vec3::from_vector);
            let b = placed_spheres(body2, pieces.1, b, |center| place.point(center));
            let [before, now] = [old, new].map(|n| gap_along(&a, &b, n));
            match before >= now - penetration::HYSTERESIS * now.abs() {
                true => (before, old),
                false => (now, new),
            }
        }
    };
    let middle = (Vec3::from_vector(at.points[0]) + place.point(at.points[1])) * 0.5;
    pair.across(middle, gap, n)
}
