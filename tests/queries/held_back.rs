//! Contacts that are left out because nearer ones hold them back do not close, however the bodies move; and
//! those that stay could.

use crate::ccd::rng::Rng;
use rapier3d_medial::math::{Real, Vector};
use rapier3d_medial::pair::{RelativeMotionBound, SpherePair};

fn between(rng: &mut Rng, low: f64, high: f64) -> Real {
    rng.range(low, high) as Real
}

fn direction(rng: &mut Rng) -> Vector {
    let d = rng.direction();
    Vector::new(d.x as Real, d.y as Real, d.z as Real).normalize()
}

fn contact(at: Vector, normal: Vector, distance: Real) -> SpherePair {
    SpherePair {
        primitives: [0, 0],
        feature: 0,
        distance,
        normal,
        points: [at; 2],
    }
}

/// A contact, and one beside it under another normal, further apart.
fn two(rng: &mut Rng, bound: &RelativeMotionBound) -> [SpherePair; 2] {
    let gap = |rng: &mut Rng| bound.skins + between(rng, -0.1, 1.2) * bound.travel;
    let normal = direction(rng);
    let k = contact(direction(rng), normal, gap(rng));
    let aside = direction(rng) * between(rng, 0.0, 0.5);
    let tilt = direction(rng) * between(rng, 0.0, 0.6);
    let c = contact(k.points[0] + aside, (normal + tilt).normalize(), gap(rng));
    if k.distance <= c.distance {
        [k, c]
    } else {
        [c, k]
    }
}

/// The furthest that the second closes: what moves at the first goes as far along the second's normal as the
/// first lets it, and the turn adds to it.
fn furthest(bound: &RelativeMotionBound, [k, c]: &[SpherePair; 2]) -> Real {
    let gap = (k.distance - bound.skins).max(0.0);
    let mut moved = c.normal * bound.travel;
    if moved.dot(k.normal) > gap {
        let across = c.normal - k.normal * c.normal.dot(k.normal);
        let left = (bound.travel * bound.travel - gap * gap).max(0.0).sqrt();
        moved = k.normal * gap + across.normalize_or_zero() * left;
    }
    // The best axis is across the arm, and turns it along the normal.
    let arm = c.points[0] - k.points[0];
    let axis = arm.cross(c.normal).normalize_or_zero() * bound.angle;
    (moved + axis.cross(arm)).dot(c.normal)
}

/// A move that the first contact allows.
fn any_move(rng: &mut Rng, bound: &RelativeMotionBound, [k, c]: &[SpherePair; 2]) -> Real {
    let gap = (k.distance - bound.skins).max(0.0);
    let mut moved = direction(rng) * between(rng, 0.0, 1.0) * bound.travel;
    let over = moved.dot(k.normal) - gap;
    if over > 0.0 {
        moved -= k.normal * over;
    }
    let turn = direction(rng) * between(rng, 0.0, 1.0) * bound.angle;
    (moved + turn.cross(c.points[0] - k.points[0])).dot(c.normal)
}

#[test]
fn contacts_held_back_do_not_close() {
    let mut rng = Rng::new(77);
    let (mut dropped, mut late) = (0, 0);
    for _ in 0..20_000 {
        let way = between(&mut rng, 0.001, 0.02);
        let bound = RelativeMotionBound {
            travel: way,
            angle: between(&mut rng, 0.0, 2.0) * way,
            skins: if rng.chance(0.5) { 0.0 } else { 0.004 },
        };
        let pair = two(&mut rng, &bound);
        let gap = pair[1].distance - bound.skins;
        let mut left = pair.to_vec();
        bound.drop_held_back(&mut left);
        assert_eq!(left[0], pair[0], "the nearest stays");
        if left.len() == 1 {
            dropped += 1;
            assert!(
                furthest(&bound, &pair) <= gap + 1.0e-6,
                "{bound:?} {pair:?}"
            );
            for _ in 0..20 {
                assert!(any_move(&mut rng, &bound, &pair) <= gap + 1.0e-6);
            }
        } else if furthest(&bound, &pair) < 0.9 * gap {
            // Only where the turn cannot add up with the way: the arm is along the normal.
            late += 1;
        }
    }
    assert!((2_000..15_000).contains(&dropped), "{dropped}");
    assert!(late < 2_000, "{late}");
}
