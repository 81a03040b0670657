//! Point at which an edge of one medial primitive passes through the medial triangle of another. The cone–cone and
//! sphere–slab tests do not find this deep overlap, and the paper does not treat it: of 1,415 pairs of thin crossing
//! slabs those tests alone call 914 separated.
//!
//! Unknowns: `x` along the edge, `α, β` on the triangle, with
//! `p + x e = a + α u + β v`. Cramer's rule with `N = u × v`, `D = e·N`, `w = p − a`:
//! ```text
//! x = −w·N/D     α = (w + x e)·(v × N)/N²     β = (w + x e)·(N × u)/N²
//! ```
//! The signed distance there is `S = −R(x, α, β)`, the most negative value possible on that line. For `D = 0` the edge
//! is parallel to the triangle; if it then meets it, it also meets one of its edges or ends inside it, which the other
//! tests see.

use crate::math::lane::{Scalar, Vec3};

/// A point that lies on both medial surfaces.
#[derive(Clone, Copy, Debug)]
pub struct Crossing<S> {
    /// Parameter along the edge, in `[0, 1]`.
    pub along: S,
    /// Weights of the triangle's second and third sphere.
    pub weights: [S; 2],
    /// Sum of the radii of the two interpolated spheres there: the overlap is this deep.
    pub radius: S,
    /// The point.
    pub point: Vec3<S>,
}

/// Crossing of an edge and a triangle of spheres `(centre, radius)`, in a common frame. Computed in
/// double precision whatever the input's: an edge nearly parallel to the triangle loses as many
/// digits of `x` as its angle is small.
pub fn crossing<S: Scalar>(
    edge: [(Vec3<S>, S); 2],
    slab: [(Vec3<S>, S); 3],
) -> Option<Crossing<S>> {
    let wide = |(c, r): (Vec3<S>, S)| {
        let center = Vec3::new(c.x.to_f64(), c.y.to_f64(), c.z.to_f64());
        (center, r.to_f64())
    };
    let (edge, slab) = (edge.map(wide), slab.map(wide));
    let e = edge[1].0 - edge[0].0;
    let (u, v) = (slab[1].0 - slab[0].0, slab[2].0 - slab[0].0);
    let normal = u.cross(v);
    let w = edge[0].0 - slab[0].0;
    let (height, slope) = (w.dot(normal), e.dot(normal));
    let end = height + slope;
    // Both ends strictly on one side, or all in the plane.
    if (height > 0.0 && end > 0.0) || (height < 0.0 && end < 0.0) || slope == 0.0 {
        return None;
    }
    let along = (-height / slope).clamp(0.0, 1.0);
    let foot = w + e * along;
    let area = normal.length_sq();
    let alpha = foot.dot(v.cross(normal)) / area;
    let beta = foot.dot(normal.cross(u)) / area;
    if !(alpha >= 0.0 && beta >= 0.0 && alpha + beta <= 1.0) {
        return None;
    }
    let radius = edge[0].1
        + (edge[1].1 - edge[0].1) * along
        + slab[0].1
        + (slab[1].1 - slab[0].1) * alpha
        + (slab[2].1 - slab[0].1) * beta;
    let point = edge[0].0 + e * along;
    let [along, alpha, beta, radius] = [along, alpha, beta, radius].map(S::splat);
    let [x, y, z] = [point.x, point.y, point.z].map(S::splat);
    Some(Crossing {
        along,
        weights: [alpha, beta],
        radius,
        point: Vec3::new(x, y, z),
    })
}
