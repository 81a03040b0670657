//! Contacts that cannot move anything, because axes of a body are locked: nothing but rounding moves it along their
//! normals. They get a distance from which rapier solves none, and stay where they are, since how deep they are tells
//! what a body is driven into.
//!
//! An impulse along a normal `n` changes the speed of two bodies along it by
//!
//! `r = Σ n·(W n) + (a × n)·(I⁻¹ (a × n))`,
//!
//! the sum over both bodies of inverse mass `W` and inverse inertia `I⁻¹`, both 0 along locked axes, with the arm `a`
//! of the contact. rapier's solver divides by `r` (Catto, Iterative Dynamics with Temporal Coherence, 2005). Where `n`
//! is a locked axis but for rounding, `r` is the square of that rounding, and the body is thrown along what is left of
//! `n`: a box that may move in a plane only, and touches a wall behind it, got 24 m/s.

use crate::math::fast_hash::{FastMap, FastSet};
use crate::math::{Pose, Real, Vector};
use crate::parry::contacts::manifold_points::{normals, places};
use crate::parry::shape_id::ShapeId;
use parry3d::math::AngularInertia;
use parry3d::query::ContactManifold;
use parry3d::shape::Shape;

/// Square of the sine of an angle, 0.001 rad, below which what is left of a direction is rounding: of a normal along
/// the axes that are not locked, and of an arm from the axis of turning to a contact, across the normal, about those
/// axes. With 1e-4 a box on a rail passes through a wedge of half a degree.
const HELD: Real = 1.0e-6;

/// Square of the rounding of a contact's place, in units of its arm.
const PLACED: Real = 1.0e-10;

/// Distance of a contact that is not solved.
pub const UNSOLVED: Real = Real::MAX;

/// How a body responds to an impulse.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// Centre of mass in the world.
    pub center: Vector,
    /// Inverse mass along the world's axes, 0 where locked.
    pub inverse_mass: Vector,
    /// Inverse inertia in the world, 0 about locked axes.
    pub inverse_inertia: AngularInertia,
    /// Inverse mass without locked axes.
    pub unlocked: Real,
    /// Whether some of its axes are locked, but not all.
    pub is_partly_locked: bool,
    /// rapier's dominance group: what it does with bodies of lower ones does not move it.
    pub dominance: i8,
}

impl Response {
    /// Whether an impulse along `n` at a point of the world, both in the world, moves it by rounding alone. Its slide
    /// and its turn count each for itself: a body that has much inertia for its mass turns slowly, but truly.
    fn is_held(&self, point: Vector, n: Vector) -> bool {
        let arm = point - self.center;
        let turn = arm.cross(n);
        let axis = (self.inverse_inertia * turn).normalize_or_zero();
        let lever = turn.dot(axis);
        let slides = n.dot(self.inverse_mass * n);
        // How far along the axis it is adds nothing to its lever, but for the rounding of its place.
        let across = arm.length_squared() - arm.dot(axis) * arm.dot(axis);
        let rounding = (HELD * across).max(PLACED * arm.length_squared());
        slides <= HELD * self.unlocked && lever * lever <= rounding
    }
}

/// The bodies of two colliders that move when they push each other, of which one at least is partly locked.
pub struct Moved<'a>(Vec<&'a Response>);

impl<'a> Moved<'a> {
    /// Those of two bodies; `None` if neither of them is partly locked.
    pub fn of(bodies: &'a [Option<Response>; 2]) -> Option<Self> {
        let lowest = bodies.iter().flatten().map(|body| body.dominance).min();
        let moved = bodies.iter().flatten();
        let moved: Vec<_> = moved.filter(|b| Some(b.dominance) == lowest).collect();
        let is_any_locked = moved.iter().any(|body| body.is_partly_locked);
        is_any_locked.then_some(Self(moved))
    }

    /// Whether a contact at a point under a normal, both in the world, cannot move any of them but for rounding.
    pub fn is_held(&self, point: Vector, n: Vector) -> bool {
        self.0.iter().all(|body| body.is_held(point, n))
    }
}

/// The colliders of a world in which bodies have locked axes.
#[derive(Default)]
pub struct LockedBodies {
    /// Pose of each medial collider and of each other one on a body that impulses move, by its shape, which several may
    /// share; and how that body responds, if they move it.
    placed: FastMap<ShapeId, Vec<(Pose, Option<Response>)>>,
    /// Shapes of those on bodies of which some axes are locked.
    locked: FastSet<ShapeId>,
}

impl LockedBodies {
    /// Adds a collider.
    pub fn add(&mut self, shape: ShapeId, pose: Pose, response: Option<Response>) {
        if response.is_some_and(|body| body.is_partly_locked) {
            self.locked.insert(shape);
        }
        self.placed.entry(shape).or_default().push((pose, response));
    }

    /// Keeps from the solver the contacts of two shapes at relative pose `pos12` that cannot move either. Shape `side`
    /// is medial.
    pub fn take_from_solver<M, C>(
        &self,
        shapes: [&dyn Shape; 2],
        side: usize,
        pos12: &Pose,
        manifolds: &mut [ContactManifold<M, C>],
    ) {
        if !shapes
            .iter()
            .any(|s| self.locked.contains(&ShapeId::new(*s)))
        {
            return;
        }
        let Some((pose, bodies)) = self.pair(shapes, side, pos12) else {
            return;
        };
        let Some(moved) = Moved::of(&bodies) else {
            return;
        };
        for m in manifolds {
            let n = pose.rotation * normals(m)[0];
            for i in 0..m.points.len() {
                if moved.is_held(pose * places(m, i)[0], n) {
                    m.points[i].dist = UNSOLVED;
                }
            }
        }
    }

    /// Pose of the first of two colliders with these shapes, and how the bodies of both respond.
    fn pair(
        &self,
        shapes: [&dyn Shape; 2],
        side: usize,
        pos12: &Pose,
    ) -> Option<(Pose, [Option<Response>; 2])> {
        let placed = |k: usize| self.placed.get(&ShapeId::new(shapes[k]));
        let (pose, response) = *placed(side)?.first()?;
        let is_other = |(other, _): &&(Pose, Option<Response>)| {
            let [one, two] = if side == 0 {
                [&pose, other]
            } else {
                [other, &pose]
            };
            one.inv_mul(two) == *pos12
        };
        let other = placed(1 - side).and_then(|placed| placed.iter().find(is_other));
        let mut bodies = [response, other.and_then(|(_, response)| *response)];
        let mut first = pose;
        if side == 1 {
            bodies.swap(0, 1);
            first = pose * pos12.inverse();
        }
        Some((first, bodies))
    }
}
