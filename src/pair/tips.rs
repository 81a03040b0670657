//! Primitives without their tips. Where the radius of a primitive grows from nearly nothing, as towards the edges of a
//! box, its outermost piece is thinner than what has to be kept from passing through another body
//! ([`crate::elementary::Cores::tips`]). What is left is one primitive or two, with spheres that lie on the whole one.
//! Which tips may be cut off, and why nothing passes through: `docs/effects.md`.

use super::apart::Balls;
use crate::elementary::distance::Ball;
use crate::math::Real;
use crate::math::lane::Vec3;
use crate::medial::MedialSphere;

/// A part of a primitive, as up to three spheres that are means of the primitive's own: `shares[k][i]` is the share
/// of the primitive's sphere `i` in sphere `k` of the part. The shares of one sphere sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SubPrimitive {
    shares: [[f64; 3]; 3],
    /// Number of spheres.
    pub(super) spheres: usize,
}

impl SubPrimitive {
    /// All of a primitive of so many spheres.
    pub(super) fn whole(spheres: usize) -> Self {
        Self {
            shares: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            spheres,
        }
    }

    pub(super) fn is_whole(&self) -> bool {
        *self == Self::whole(self.spheres)
    }

    /// The spheres of this part.
    pub(super) fn of(&self, all: &[Ball<f64>; 3]) -> [Ball<f64>; 3] {
        if self.is_whole() {
            return *all;
        }
        self.shares.map(|shares| {
            let sum = |sum: Ball<f64>, (s, share): (&Ball<f64>, f64)| {
                (sum.0 + s.0 * share, sum.1 + s.1 * share)
            };
            all.iter().zip(shares).fold((Vec3::zero(), 0.0), sum)
        })
    }

    /// The spheres of this part while they move over a piece of the step. A mean of points is no farther off its chord
    /// than the points themselves.
    pub(super) fn of_swept(&self, all: &Balls) -> Balls {
        if self.is_whole() {
            return *all;
        }
        all.mixed(&self.shares[..self.spheres])
    }

    /// One sphere of this part.
    pub(super) fn sphere(&self, all: &[MedialSphere; 3], k: usize) -> MedialSphere {
        if self.is_whole() {
            return all[k];
        }
        let mut sphere = MedialSphere::default();
        for (s, share) in all.iter().zip(self.shares[k]) {
            sphere.center += s.center * share as Real;
            sphere.radius += s.radius * share as Real;
        }
        sphere
    }
}

/// Parts of a primitive that remain without its tips: one or two.
#[derive(Clone, Copy)]
pub(super) struct SubPrimitives {
    parts: [SubPrimitive; 2],
    len: usize,
}

impl SubPrimitives {
    /// All of a primitive of so many spheres.
    pub(super) fn whole(spheres: usize) -> Self {
        Self {
            parts: [SubPrimitive::whole(spheres); 2],
            len: 1,
        }
    }

    /// Parts of a primitive where its radius is `kept` or more; the whole primitive if it is thinner everywhere.
    pub(super) fn without_tips(spheres: &[Ball<f64>], kept: f64) -> Self {
        let mut whole = Self::whole(spheres.len());
        let at = |k: usize| SubPrimitive::whole(3).shares[k];
        // From a thin sphere towards a thick one, where it is as thick as asked.
        let cut = |from: usize, to: usize| {
            let share = (kept - spheres[from].1) / (spheres[to].1 - spheres[from].1);
            let mut shares = [0.0; 3];
            (shares[from], shares[to]) = (1.0 - share, share);
            shares
        };
        let part = |shares: [[f64; 3]; 3]| SubPrimitive {
            shares,
            spheres: spheres.len(),
        };
        let is_thin = |k: usize| spheres.get(k).is_some_and(|s| s.1 < kept);
        let thin = [0, 1, 2].map(is_thin);
        let count = thin.iter().filter(|thin| **thin).count();
        if count == 0 || count == spheres.len() {
            return whole;
        }
        // From the one sphere that differs from the others on, in the order of the primitive.
        let is_odd = |k: &usize| thin[*k] == (2 * count <= spheres.len());
        let [i, j, k] = (0..spheres.len())
            .find(is_odd)
            .map_or([0; 3], |k| match spheres.len() {
                2 => [k, 1 - k, 1 - k],
                _ => [k, (k + 1) % 3, (k + 2) % 3],
            });
        if !thin[i] {
            whole.parts = [part([at(i), cut(j, i), cut(k, i)]); 2];
        } else {
            let (p, q) = (cut(i, j), cut(i, k));
            whole.parts = [part([p, at(j), at(k)]), part([p, at(k), q])];
            whole.len = if spheres.len() == 3 { 2 } else { 1 };
        }
        whole
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &SubPrimitive> {
        self.parts[..self.len].iter()
    }
}
