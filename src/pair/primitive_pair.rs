//! Contacts of two primitives at fixed poses.
//!
//! Each elementary test gives its nearest pair of spheres, in contact along the line of their centres (paper §4.5:
//! "contact point and contact normal through the nearest sphere pair"). Where medial surfaces cross, that line is
//! lost, and the true penetration depth and normal take its place ([`crate::elementary::penetration`]). Long
//! parallel cones get a second pair, so that they can rest on a line.

use super::contact_list::ContactList;
use super::first_contact::Counts;
use super::placement::Placement;
use super::primitive_tree::PrimitiveTree;
use super::sphere_pair::SpherePair;
use crate::elementary::certificate::ActiveFace;
use crate::elementary::distance::{
    Ball, Ends, crossing, deeper, face, family, is_beyond, nearest_in_family,
};
use crate::elementary::first_contact::corner_weights;
use crate::elementary::test_list::{Domain, ElementaryTest, OwnedFeatures, for_each_test};
use crate::elementary::{penetration, slab_crossing};
use crate::math::Real;
use crate::math::lane::Vec3;
use crate::math::nearest::{Family, Nearest, edge_minimum};
use crate::math::tolerance::{F64_ROUNDING, ONE_DIRECTION};
use crate::medial::MedialSphere;

/// Squared sine under which two cones count as parallel for a second contact point (6°).
const PARALLEL_SINE_SQ: f64 = 0.01;

/// Two contact points closer than this, in units of the radius sum, are one: a sphere shared by two
/// cones is reported by both.
const SAME_POINT: f64 = 1.0e-4;

/// Feature of a pair whose medial surfaces cross: it belongs to no one test.
const CROSSING: u32 = 1 << 17;

/// Two primitives in the first body's frame.
pub(super) struct PrimitivePair<'a> {
    indices: [u32; 2],
    balls: [[Ball<f64>; 3]; 2],
    shares: [OwnedFeatures; 2],
    place: &'a Placement,
}

impl<'a> PrimitivePair<'a> {
    pub(super) fn new(
        body1: &impl PrimitiveTree,
        body2: &impl PrimitiveTree,
        indices: [u32; 2],
        place: &'a Placement,
    ) -> Self {
        let (a, share_a) = body1.primitive(indices[0]);
        let (b, share_b) = body2.primitive(indices[1]);
        let first = |s: &MedialSphere| (Vec3::from_vector(s.center), f64::from(s.radius));
        let second = |s: &MedialSphere| (place.point(s.center), f64::from(s.radius));
        Self {
            indices,
            balls: [
                [first(&a[0]), first(&a[1]), first(&a[2])],
                [second(&b[0]), second(&b[1]), second(&b[2])],
            ],
            shares: [share_a, share_b],
            place,
        }
    }

    /// Adds the sphere pairs within the list's margin.
    pub(super) fn contacts(&self, found: &mut ContactList, counts: &mut Counts) {
        if let Some(crossing) = self.crossing() {
            self.push_crossing(crossing, found);
            return;
        }
        let faces = self.along_faces();
        let (a, b) = self.spheres();
        let size = |s: &[Ball<f64>]| s.iter().map(|s| s.0.taxicab() + s.1.abs()).sum::<f64>();
        let beyond = found.margin() + F64_ROUNDING * (size(a) + size(b));
        let mut feature = 0;
        for_each_test(self.shares[0], self.shares[1], |test| {
            if !faces.iter().flatten().any(|ends| ends.gap(&test) > beyond) {
                counts.tests += 1;
                self.test(&test, feature, found);
            }
            feature += 1;
            true
        });
    }

    /// How far both reach along the normals of their faces, which keep most tests of flat bodies apart.
    fn along_faces(&self) -> [Option<Ends<f64>>; 2] {
        let (a, b) = self.spheres();
        let y = b[0].0 - a[0].0;
        let of = |s: &[Ball<f64>], y: Vec3<f64>| {
            let &[p, q, r] = s else { return None };
            let n = face([q.0 - p.0, r.0 - p.0], [q.1 - p.1, r.1 - p.1], y)?;
            Some(n * (1.0 / n.length()))
        };
        let ends = |n: Vec3<f64>| Ends::new(a, b, n);
        [of(a, y).map(ends), of(b, -y).map(|n| ends(-n))]
    }

    fn test(&self, test: &ElementaryTest, feature: u32, found: &mut ContactList) {
        let margin = found.margin();
        let f = family(test, &self.balls[0], &self.balls[1]);
        if test.domain == Domain::Box && is_beyond(&f, margin) {
            return;
        }
        let s = nearest_in_family(test.domain, &f);
        if s.distance > margin || s.distance.is_nan() {
            return;
        }
        let normal = self.direction(test.domain, &f, &s);
        self.push(test, feature, &s, normal, found);
        if test.domain == Domain::Box
            && let Some(second) = second_on_line(&f, &s, normal, margin)
        {
            // Not the nearest pair, so its centres alone have its direction.
            let normal = match is_lost(&second) {
                false => second.y * (1.0 / second.length),
                true => self.deepest().1,
            };
            self.push(test, feature | 1 << 16, &second, normal, found);
        }
    }

    /// Unit direction of a nearest pair; where the centres coincide, the deepest one.
    fn direction(&self, domain: Domain, f: &Family<f64>, s: &Nearest<f64>) -> Vec3<f64> {
        if is_lost(s) {
            return self.deepest().1;
        }
        ActiveFace::new(domain, f, s, &[Vec3::zero(); 4]).direction(domain, f)
    }

    fn deepest(&self) -> (f64, Vec3<f64>) {
        let (a, b) = self.spheres();
        let middle =
            |s: &[Ball<f64>]| s.iter().fold(Vec3::zero(), |m, b| m + b.0) * (1.0 / s.len() as f64);
        penetration::deepest(a, b, middle(b) - middle(a), 0.0)
    }

    /// The crossing of an edge of one primitive with the slab of the other, whether this pair owns the edge or not.
    /// With a crossing the nearest spheres mean nothing for this pair.
    fn crossing(&self) -> Option<slab_crossing::Crossing<f64>> {
        let (a, b) = self.spheres();
        [crossing(a, u8::MAX, b), crossing(b, u8::MAX, a)]
            .into_iter()
            .flatten()
            .reduce(deeper)
    }

    /// The spheres that count, of both.
    pub(super) fn spheres(&self) -> (&[Ball<f64>], &[Ball<f64>]) {
        let [a, b] = &self.balls;
        (&a[..self.shares[0].spheres], &b[..self.shares[1].spheres])
    }

    fn push_crossing(&self, crossing: slab_crossing::Crossing<f64>, found: &mut ContactList) {
        let (gap, n) = self.deepest();
        if gap <= found.margin() {
            found.extend([self.across(crossing.point, gap, n)]);
        }
    }

    /// A contact whose points lie on both sides of a point.
    pub(super) fn across(&self, middle: Vec3<f64>, gap: f64, n: Vec3<f64>) -> SpherePair {
        let half = n * (-0.5 * gap);
        self.sphere_pair(CROSSING, gap, n, [middle + half, middle - half])
    }

    fn push(
        &self,
        test: &ElementaryTest,
        feature: u32,
        s: &Nearest<f64>,
        normal: Vec3<f64>,
        found: &mut ContactList,
    ) {
        let w = corner_weights(test.domain, s);
        let mut spheres = [(Vec3::zero(), 0.0); 2];
        for ((i, j), w) in test.corners.iter().zip(w) {
            for (side, k) in [(0, *i), (1, *j)] {
                let ball = self.balls[side][k as usize];
                spheres[side].0 = spheres[side].0 + ball.0 * w;
                spheres[side].1 += ball.1 * w;
            }
        }
        let [a, b] = spheres;
        // Along the certified normal, so that the points and the normal agree with the distance.
        let point1 = a.0 + normal * a.1;
        let point2 = b.0 - normal * b.1;
        let pair = self.sphere_pair(feature, s.distance, normal, [point1, point2]);
        found.add(pair, [point1, normal], SAME_POINT * (a.1 + b.1));
    }

    fn sphere_pair(
        &self,
        feature: u32,
        distance: f64,
        normal: Vec3<f64>,
        points: [Vec3<f64>; 2],
    ) -> SpherePair {
        SpherePair {
            primitives: self.indices,
            feature,
            distance: distance as Real,
            normal: normal.to_vector(),
            points: [points[0].to_vector(), self.place.inverse_point(points[1])],
        }
    }
}

/// Whether the centres of a pair are too near each other to give a direction.
fn is_lost(s: &Nearest<f64>) -> bool {
    let radius = s.length - s.distance;
    !(s.length > penetration::LOST * radius.abs() && s.length > 0.0)
}

/// Second contact of nearly parallel cones: the sphere pair at the other end of the line along which they run side by
/// side, if that is further away than the cones are thick.
fn second_on_line(
    f: &Family<f64>,
    s: &Nearest<f64>,
    normal: Vec3<f64>,
    margin: f64,
) -> Option<Nearest<f64>> {
    let (uu, vv) = (f.u.length_sq(), f.v.length_sq());
    if f.u.cross(f.v).length_sq() >= PARALLEL_SINE_SQ * uu * vv || uu == 0.0 || vv == 0.0 {
        return None;
    }
    let thick = s.length - s.distance;
    let run = |c: &Nearest<f64>| {
        let along_first = (c.alpha - s.alpha).abs() * uu.sqrt();
        let along_second = (c.beta - s.beta).abs() * vv.sqrt();
        along_first.min(along_second)
    };
    [
        f.at(0.0, edge_minimum(f.w, f.v, f.db)),
        f.at(1.0, edge_minimum(f.w + f.u, f.v, f.db)),
        f.at(edge_minimum(f.w, f.u, f.da), 0.0),
        f.at(edge_minimum(f.w + f.v, f.u, f.da), 1.0),
    ]
    .into_iter()
    .filter(|c| {
        c.distance <= margin && run(c) > thick && c.y.dot(normal) >= ONE_DIRECTION * c.length
    })
    .max_by(|a, b| run(a).total_cmp(&run(b)))
}
