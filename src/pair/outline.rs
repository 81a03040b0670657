//! Rules out most primitives of two bodies before they are searched, by a few directions that keep them apart.
//!
//! Along a direction, all primitives of the first body that end before the second body begins cannot touch it for
//! the rest of the step (or at all, for bodies at rest), and neither can those of the second that begin after the first
//! ends. What is left of both gives the next direction. Nothing is left of most neighbours in a crowd after a few
//! rounds, and little of those that touch.
//!
//! On straight paths the gap of two sets of balls along a direction is a concave function of time (the smallest of
//! linear functions minus the largest), so between two times it is no less than the chord of its values there. If a
//! direction gets no further, the next one is its mirror image at the line between the two balls that overlap
//! most (Chung and Wang, "Quick collision detection of polytopes in virtual environments", 1996).

use super::primitive_tree::PrimitiveTree;
use crate::math::lane::Vec3;
use crate::math::motion::RigidMotion;
use crate::math::{Real, Vector};
use crate::medial::proxy_hull::{MAX_PROXY_ITEMS, ProxyHull};
use parry3d::query::NonlinearRigidMotion;
use std::sync::Arc;

/// Directions tried. With 6 a ninth more queries are begun in a heap of links, with 24 a twentieth fewer.
const TRIES: usize = 12;

/// The balls and primitives of a body's coarse hull, at rest or on straight paths that enclose its motion. Outlines
/// of two bodies must be in one frame.
pub struct Outline {
    /// Time at which the motion starts, and how long it goes on, in seconds.
    times: [f64; 2],
    /// Position at the start, displacement, and radius grown by the sagitta.
    balls: Vec<(Vec3<f64>, Vec3<f64>, f64)>,
    proxy: Arc<ProxyHull>,
    /// Bound of the coordinates in play.
    size: f64,
}

impl Outline {
    /// The outline of a body at rest, whose points `place` moves into the common frame.
    pub fn resting(proxy: &Arc<ProxyHull>, place: impl Fn(Vector) -> Vec3<f64>) -> Self {
        let mut size = 0.0;
        let placed = proxy.balls.iter().map(|(center, radius)| {
            let (center, radius) = (place(*center), f64::from(*radius));
            size = f64::max(size, center.taxicab() + radius);
            (center, Vec3::zero(), radius)
        });
        Self {
            times: [0.0, 1.0],
            balls: placed.collect(),
            proxy: Arc::clone(proxy),
            size,
        }
    }

    /// The outline of a body on a motion from `from` to `end`, in seconds.
    pub fn new(
        proxy: &Arc<ProxyHull>,
        motion: &NonlinearRigidMotion,
        [from, end]: [Real; 2],
    ) -> Self {
        let times = [f64::from(from), f64::from(end) - f64::from(from)];
        let rigid = RigidMotion::<f64>::alone(motion, times[1]);
        let ends = [0.0, 1.0].map(|t| rigid.frame(t));
        let mut size = 0.0;
        let moved = proxy.balls.iter().map(|(center, radius)| {
            let center = Vec3::from_vector(*center);
            let [start, last] = ends.map(|frame| frame.point(center));
            let sagitta = rigid.acceleration(ends[0].arm(center)) / 8.0;
            let radius = f64::from(*radius) + sagitta;
            size = f64::max(size, start.taxicab() + last.taxicab() + radius);
            (start, last - start, radius)
        });
        Self {
            times,
            balls: moved.collect(),
            proxy: Arc::clone(proxy),
            size,
        }
    }
}

/// Parts of a body not culled yet, seen between two times.
struct CullState<'a> {
    outline: &'a Outline,
    /// Fractions of its motion at both times.
    shares: [f64; 2],
    /// Primitives left, and their balls.
    primitives: u64,
    balls: u64,
    /// How far each ball reaches along the direction at both times.
    reach: [[f64; 2]; MAX_PROXY_ITEMS],
}

/// Places of the bits that are set.
fn bits(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let first = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (first < MAX_PROXY_ITEMS).then_some(first)
    })
}

impl<'a> CullState<'a> {
    fn new(outline: &'a Outline, from: f64) -> Self {
        let [start, length] = outline.times;
        let count = outline.proxy.primitives.len();
        let mut state = Self {
            outline,
            shares: [(from - start) / length, 1.0],
            primitives: (0..count).fold(0, |m, k| m | 1 << k),
            balls: 0,
            reach: [[0.0; 2]; MAX_PROXY_ITEMS],
        };
        state.keep(state.primitives);
        state
    }

    fn keep(&mut self, primitives: u64) {
        let of = &self.outline.proxy.primitives;
        self.primitives = primitives;
        self.balls = bits(primitives).fold(0, |all, k| all | of[k]);
    }

    /// Looks along `n`, a unit vector: how far it reaches at both times, and with which balls.
    fn look(&mut self, n: Vec3<f64>) -> [(f64, usize); 2] {
        let mut most = [(f64::MIN, 0); 2];
        for k in bits(self.balls) {
            let (start, chord, radius) = self.outline.balls[k];
            let (base, rate) = (n.dot(start) + radius, n.dot(chord));
            self.reach[k] = self.shares.map(|share| base + share * rate);
            for (most, reach) in most.iter_mut().zip(self.reach[k]) {
                if reach > most.0 {
                    *most = (reach, k);
                }
            }
        }
        most
    }

    /// Keeps the primitives that reach beyond `limits`, at one of both times; returns whether any does not.
    fn keep_beyond(&mut self, limits: [f64; 2]) -> bool {
        let reach = &self.reach;
        let beyond = |k: usize| !(reach[k][0] < limits[0] && reach[k][1] < limits[1]);
        let of = &self.outline.proxy.primitives;
        let kept = bits(self.primitives).filter(|p| bits(of[*p]).any(beyond));
        let kept = kept.fold(0, |m, p| m | 1 << p);
        let fewer = kept != self.primitives;
        if fewer {
            self.keep(kept);
        }
        fewer
    }

    fn at(&self, ball: usize, time: usize) -> (Vec3<f64>, f64) {
        let (start, chord, radius) = self.outline.balls[ball];
        (start + chord * self.shares[time], radius)
    }

    /// Middle of all balls at both times, added.
    fn middle(&self) -> Vec3<f64> {
        let both = self.shares[0] + self.shares[1];
        let sum = bits(self.balls).fold(Vec3::zero(), |sum, k| {
            let (start, chord, _) = self.outline.balls[k];
            sum + start * 2.0 + chord * both
        });
        sum * (1.0 / f64::from(self.balls.count_ones()))
    }
}

/// The primitives of a body that may still meet the other body.
#[derive(Clone)]
pub struct ActivePrimitives {
    /// The body.
    proxy: Arc<ProxyHull>,
    /// Primitives of the node that are not done with.
    primitives: u64,
}

impl ActivePrimitives {
    /// Whether any of these primitives is below a node of the mesh's tree.
    pub fn meets(&self, node: u32) -> bool {
        let primitives = self.proxy.nodes.get(node as usize);
        primitives.is_none_or(|p| p & self.primitives != 0)
    }
}

/// The primitives of two bodies at rest that may be near each other; by default all.
#[derive(Default)]
pub struct NearPrimitives(Option<[ActivePrimitives; 2]>);

impl NearPrimitives {
    /// Whether any of these primitives are below a node of each body.
    pub fn meet(&self, [i, j]: [u32; 2]) -> bool {
        let left = self.0.as_ref();
        left.is_none_or(|[a, b]| a.meets(i) && b.meets(j))
    }

    /// Whether directions were tried on every primitive, so that others would hardly tell more.
    pub fn is_exact(&self) -> bool {
        let left = self.0.as_ref();
        left.is_some_and(|left| left.iter().all(|left| left.proxy.is_exact))
    }
}

/// The primitives of two bodies at rest that may be within `reach` (a length) of each other; `None` if there are none.
/// `place` moves points of the second body into the frame of the first.
pub fn near(
    body1: &impl PrimitiveTree,
    body2: &impl PrimitiveTree,
    place: impl Fn(Vector) -> Vec3<f64>,
    reach: Real,
) -> Option<NearPrimitives> {
    let (Some(proxy1), Some(proxy2)) = (body1.proxy_hull(), body2.proxy_hull()) else {
        return Some(NearPrimitives::default());
    };
    let a = Outline::resting(proxy1, Vec3::from_vector);
    let b = Outline::resting(proxy2, place);
    let apart = apart_until(&a, &b, 0.0, reach)?;
    Some(NearPrimitives(Some(apart.left)))
}

/// Time until which two bodies certainly stay apart.
pub struct Apart {
    /// Time until which they stay apart, in seconds into the step.
    pub until: Real,
    /// The primitives that may meet after that. All others stay apart until the motions end.
    pub left: [ActivePrimitives; 2],
}

/// Time until which two bodies certainly stay farther apart than `target`, from `from` on (seconds into the step), as
/// far as a few directions can prove it. `None` if they do so until the motions end, which must be at the same time for
/// both.
///
/// The motions may have been computed anew from a later time on in single precision; a few ulps are allowed for that.
pub fn apart_until(a: &Outline, b: &Outline, from: Real, target: Real) -> Option<Apart> {
    let least = f64::from(target) + 16.0 * f64::from(Real::EPSILON) * (a.size + b.size);
    let (start, end) = (f64::from(from), a.times[0] + a.times[1]);
    let (mut a, mut b) = (CullState::new(a, start), CullState::new(b, start));
    // Fraction of the time that the best direction keeps them apart.
    let mut free = 0.0;
    let mut n = b.middle() - a.middle();
    for _ in 0..TRIES {
        let length = n.length();
        if !(length > 0.0 && length.is_finite()) {
            break;
        }
        n = n * (1.0 / length);
        let (far, near) = (a.look(n), b.look(-n));
        let room = [0, 1].map(|k| -near[k].0 - far[k].0 - least);
        if room[0] > 0.0 && room[1] > 0.0 {
            return None;
        }
        if room[0] > 0.0 {
            free = f64::max(free, room[0] / (room[0] - room[1]));
        }
        let fewer = [
            a.keep_beyond(near.map(|near| -near.0 - least)),
            b.keep_beyond(far.map(|far| -far.0 - least)),
        ];
        if a.balls == 0 || b.balls == 0 {
            return None;
        }
        if fewer.contains(&true) {
            n = b.middle() - a.middle();
            continue;
        }
        // Mirrored at the time of the smaller gap.
        let k = usize::from(room[1] < room[0]);
        let (p, q) = (a.at(far[k].1, k), b.at(near[k].1, k));
        let across = (q.0 - n * q.1) - (p.0 + n * p.1);
        let square = across.length_sq();
        if square <= 0.0 {
            break;
        }
        n = n - across * (2.0 * n.dot(across) / square);
    }
    let until = (start + free * (end - start)) as Real;
    Some(Apart {
        until: until.next_down().max(from),
        left: [&a, &b].map(|state| ActivePrimitives {
            proxy: Arc::clone(&state.outline.proxy),
            primitives: state.primitives,
        }),
    })
}
