//! Decides cheaply which pairs need no search for a first contact, or not yet: those that bounding spheres keep
//! apart, or directions ([`crate::pair::outline`]).

use crate::math::Real;
use crate::math::approach::first_touch;
use crate::math::lane::Vec3;
use crate::math::tolerance::FEW_OPERATIONS;
use crate::medial::proxy_hull::ProxyHull;
use crate::pair::outline::{ActivePrimitives, Outline, apart_until};
use crate::rapier::view::step_view::StepView;
use parry3d::query::NonlinearRigidMotion;
use std::sync::Arc;

/// Extent of a box from which a shape counts as unbounded, a length: a half-space has the largest there
/// is. Smaller, and wide grounds cost queries; larger, and nothing is gained, since rounding hides gaps.
const UNBOUNDED: Real = 1.0e12;

/// Outlines of the colliders on their bodies' motions, each made when first wanted.
pub struct PairCulling {
    made: Vec<Option<CachedOutline>>,
    proxies: Vec<Option<Arc<ProxyHull>>>,
    /// End of the step in seconds.
    end: Real,
}

/// `None` for what is not bounded.
type CachedOutline = Option<Outline>;

impl PairCulling {
    /// A record in which no outline is made yet.
    pub fn new(parts: usize, end: Real) -> Self {
        Self {
            made: (0..parts).map(|_| None).collect(),
            proxies: vec![None; parts],
            end,
        }
    }

    /// The collider's body has another motion.
    pub fn forget(&mut self, part: usize) {
        self.made[part] = None;
    }

    /// Seconds into the step before which two colliders do not come within `reach` of each other, from
    /// `time` on, and what of two meshes may do so after; `None` if they never do.
    pub fn apart_until(
        &mut self,
        view: &StepView,
        pair: [usize; 2],
        time: Real,
        reach: Real,
    ) -> Option<(Real, Option<[ActivePrimitives; 2]>)> {
        let until = spheres_apart_until(view, pair, [time, self.end], reach)?;
        for k in pair {
            if self.made[k].is_none() {
                self.made[k] = Some(self.outline(view, k));
            }
        }
        match pair.map(|k| self.made[k].as_ref().and_then(Option::as_ref)) {
            [Some(a), Some(b)] => {
                let apart = apart_until(a, b, until, reach)?;
                Some((apart.until, Some(apart.left)))
            }
            _ => Some((until, None)),
        }
    }

    /// The outline of a collider from its body's last impact on: of a mesh its own, of other shapes that of
    /// their box.
    fn outline(&mut self, view: &StepView, part: usize) -> CachedOutline {
        let p = &view.colliders[part];
        if self.proxies[part].is_none() {
            let proxy = match p.medial() {
                Some(mesh) => Arc::clone(mesh.proxy_hull()),
                None => {
                    let aabb = p.shape.compute_local_aabb();
                    let bounded = aabb.extents().max_element() < UNBOUNDED;
                    bounded.then(|| Arc::new(ProxyHull::of_points(&aabb.vertices())))?
                }
            };
            self.proxies[part] = Some(proxy);
        }
        let from = view.bodies[p.body].time;
        let motion = view.motion(part, from);
        let proxy = self.proxies[part].as_ref()?;
        Some(Outline::new(proxy, &motion, [from, self.end]))
    }
}

/// Time until which spheres round the centres about which two colliders turn, whose paths are straight, stay apart.
fn spheres_apart_until(
    view: &StepView,
    pair: [usize; 2],
    [time, end]: [Real; 2],
    reach: Real,
) -> Option<Real> {
    let motions = pair.map(|k| view.motion(k, time));
    let center = |m: &NonlinearRigidMotion| m.start * m.local_center;
    let centers = motions.each_ref().map(center);
    let mut radius = reach;
    for (k, motion) in pair.into_iter().zip(&motions) {
        let bound = &view.colliders[k].bound;
        radius += (bound.center() - motion.local_center).length() + bound.radius();
    }
    // Rounding of the positions: a few ulps of all that they are sums of.
    let terms = |m: &NonlinearRigidMotion| m.start.translation.length() + m.local_center.length();
    radius += FEW_OPERATIONS * (motions.iter().map(terms).sum::<Real>() + radius);
    let y = Vec3::<f64>::from_vector(centers[1]) - Vec3::from_vector(centers[0]);
    let rate = Vec3::<f64>::from_vector(motions[1].linvel) - Vec3::from_vector(motions[0].linvel);
    if y.length() > f64::from(radius) {
        let (touch, exists) = first_touch(y, rate, radius.into());
        if !exists || y.dot(rate) >= 0.0 {
            return None;
        }
        let until = (time + touch as Real).next_down();
        return (until <= end).then_some(until.max(time));
    }
    Some(time)
}
