//! Cost of merging two balls, and the ball that they become. Source: Li et al., "Q-MAT" (2015), §4.

use crate::meshing::draft::Ball;
use crate::meshing::geometry::quadric::Quadric;
use crate::meshing::simplify::ball_quadrics::stability;
use crate::meshing::simplify::collapse::Simplifier;
use crate::meshing::simplify::crease_cost::{fold_cost, stick_out, stick_out_beyond};

/// Length (longest side 1) added to the error before the stability ratio scales it (Q-MAT's `k`). Collapses that cost
/// nothing are ordered by their stability through it.
const FLAT_COST: f64 = 1e-5;

/// The same term in a medial mesh with creases, where the planes of faces are exact: [`FLAT_COST`] would hide errors of
/// up to .003 (longest side 1).
const EXACT_FLAT_COST: f64 = 1e-9;

/// Radius (longest side 1) below which a merged ball lies on a convex crease and is given radius 0. Balls on a crease
/// have radius 0, and the minimiser of a quadric misses that by rounding.
const ON_CREASE: f64 = 1e-7;

/// Radius (longest side 1) at or below which the minimiser has left the solid through the crease and is not used.
/// A negative radius nearer to 0 is due to rounding and to the other planes in the quadric, and becomes 0.
const BEHIND_CREASE: f64 = -1e-3;

/// Floor under the stability ratio. Measured: 0 to 0.2 loses fins and ears (error .015 for .006 at
/// 2000 primitives); 0.2 to 0.5 is alike.
const STABILITY_FLOOR: f64 = 0.3;

/// A minimiser may lie this many edge lengths from the edge's middle: farther, the quadric is
/// nearly singular there and says nothing.
const MINIMISER_REACH: f64 = 3.0;

/// Weight of the square of how far what is around a merged ball sticks out of the solid. Quadrics do not see it where
/// sheets bend. With 40 a CAD part of 500 primitives is off by a fifth less and a nut by a twentieth, but a threaded
/// rod of 200 by an eighth more.
const PROTRUSION_WEIGHT: f64 = 4.0;

/// Number of primitives below which it is measured how far merged balls stick out. From the first collapse on that
/// would take ten seconds more, and gain nothing.
const MEASURED: usize = 10_000;

/// Length (longest side 1) from which on a merged ball that sticks out is measured even above [`MEASURED`] primitives.
/// Without it, of 180,000 primitives of a nut's thread one place in a hundred was off by .008 when 10,000 were left,
/// which no fit mends.
const ALWAYS_MEASURED: f64 = 1e-3;

impl Simplifier<'_> {
    /// Whether one of two balls lies on a crease.
    pub(crate) fn is_on_crease(&self, a: u32, b: u32) -> bool {
        [a, b]
            .iter()
            .any(|&v| self.complex.balls[v as usize].radius == 0.0)
    }

    /// Cost of merging two balls into `ball` by how far what is around it then sticks out.
    pub(crate) fn measured_cost(&self, a: u32, b: u32, ball: &Ball) -> f64 {
        let (complex, tree) = (&self.complex, self.tree);
        let out = if self.primitives() < MEASURED {
            stick_out(complex, tree, [a, b], ball)
        } else if self.measures_early {
            stick_out_beyond(ALWAYS_MEASURED, complex, tree, [a, b], ball)
        } else {
            0.0
        };
        PROTRUSION_WEIGHT * out * out
    }

    pub(crate) fn flat_cost(&self) -> f64 {
        if self.creased {
            EXACT_FLAT_COST
        } else {
            FLAT_COST
        }
    }

    /// Cost of merging two balls, and the ball that they become.
    pub(crate) fn merge(&self, a: u32, b: u32) -> (f64, Ball) {
        let [ball_a, ball_b] = [a, b].map(|v| self.complex.balls[v as usize]);
        let quadric = self.quadrics[a as usize].plus(&self.quadrics[b as usize]);
        let middle = middle(&ball_a, &ball_b);
        let length = (ball_b.center - ball_a.center).length();
        let near = |m: &Ball| (m.center - middle.center).length() <= MINIMISER_REACH * length;
        let minimiser = quadric.minimiser(&middle).filter(near);
        let balls = if self.is_on_crease(a, b) {
            let snapped = minimiser
                .filter(|m| m.radius > BEHIND_CREASE)
                .map(|m| Ball {
                    radius: if m.radius < ON_CREASE { 0.0 } else { m.radius },
                    ..m
                });
            [Some(ball_a), Some(ball_b), snapped]
        } else {
            match minimiser.filter(|m| m.radius > 0.0) {
                Some(ball) if self.creased => [Some(ball_a), Some(ball_b), Some(ball)],
                Some(ball) => [Some(ball), None, None],
                None => [Some(ball_a), Some(ball_b), Some(middle)],
            }
        };
        self.cheapest_of(a, b, &quadric, balls)
    }

    /// The cheapest of two balls and their middle to merge the two into.
    pub(crate) fn cheapest(&self, a: u32, b: u32) -> (f64, Ball) {
        let [ball_a, ball_b] = [a, b].map(|v| self.complex.balls[v as usize]);
        let middle = middle(&ball_a, &ball_b);
        let quadric = self.quadrics[a as usize].plus(&self.quadrics[b as usize]);
        self.cheapest_of(a, b, &quadric, [ball_a, ball_b, middle].map(Some))
    }

    /// The cheapest of balls to merge two into, and its cost.
    fn cheapest_of(
        &self,
        a: u32,
        b: u32,
        quadric: &Quadric,
        balls: [Option<Ball>; 3],
    ) -> (f64, Ball) {
        let mut best = (f64::INFINITY, f64::INFINITY, self.complex.balls[a as usize]);
        for ball in balls.into_iter().flatten() {
            let error = quadric.error(&ball);
            // Faces that turn over are most of the work where a ball has many neighbours.
            if error < best.0 {
                let folds = self.folds(a, b, &ball);
                if error + folds < best.0 {
                    best = (error + folds, self.scaled(a, b, error) + folds, ball);
                }
            }
        }
        (best.1, best.2)
    }

    fn folds(&self, a: u32, b: u32, ball: &Ball) -> f64 {
        match self.creased {
            true => fold_cost(&self.complex, [a, b], ball),
            false => 0.0,
        }
    }

    /// Cost of a merge of two balls with this error, if no face turns over.
    fn scaled(&self, a: u32, b: u32, error: f64) -> f64 {
        let [ball_a, ball_b] = [a, b].map(|v| &self.complex.balls[v as usize]);
        let stability = stability(ball_a, ball_b).max(STABILITY_FLOOR);
        (error + self.flat_cost()) * stability * stability
    }
}

/// The ball halfway between two.
fn middle(a: &Ball, b: &Ball) -> Ball {
    Ball {
        center: (a.center + b.center) * 0.5,
        radius: 0.5 * (a.radius + b.radius),
    }
}
