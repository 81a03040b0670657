//! Shape casts of medial meshes, against each other and against parry's shapes, in exact rigid motion, by the certified
//! query: it chooses how each shape is searched, and turns the bracket of the first contact into parry's answer.

use super::axisymmetric_toi;
use super::cast_answer::{hit, moved_to};
use super::distance;
use super::folds;
use super::initial_contacts::{AtStart, Touching, approach_of_rounding};
use super::sliding::{SinkLimits, Sliding};
use super::swept_region::{started, swept_region};
use super::swept_sphere_parts::{self, SweptParts, Unsweepable};
use crate::elementary::first_contact::motion_is_finite;
use crate::elementary::{InitialContact, Toi, ToiOptions, ToiStatus};
use crate::math::{Pose, Real, Vector};
use crate::medial::simplex::Simplex;
use crate::medial::{MedialMesh, MedialSphere};
use crate::pair::first_contact::{Counts, Query, ToiResult};
use crate::pair::outline::ActivePrimitives;
use crate::pair::{PrimitiveTree, nearest_spheres};
use crate::parry::partners::inside;
use crate::parry::partners::shape_faces::for_each_flat_face;
use parry3d::query::{NonlinearRigidMotion, ShapeCastHit};
use parry3d::shape::Shape;

/// Largest part of its way by which a straight cast may seem to come nearer although it slides, so near the other shape
/// that the normal says little.
const MOST_SLANT: Real = 0.5;

/// Tolerance of a straight cast in units of the length by which one that slides seems to come nearer
/// ([`approach_of_rounding`]). Larger, and rapier's character controller, which leaves gaps of a few micrometres more
/// than it asks for, is stopped by what it only passes; smaller, and rounding of the poses decides.
const PRECISION: Real = 2.0;

/// Tolerance of a cast of a small shape, in units of the longest side of its box. Larger, and small bodies would be hit
/// while they are apart by much of their size.
const TOLERANCE_OF_SIZE: Real = 1.0e-4;

/// Height above a plane, in tolerances beyond the target distance, up to which a mesh counts as lying on it: an impact
/// leaves it within one of them.
const LIES_ABOVE: Real = 2.0;

/// First contact of a medial mesh with another shape, both moving rigidly, from `start` to `end`
/// seconds.
#[derive(Clone, Copy)]
pub struct Cast<'a> {
    /// Motion of the mesh.
    pub motion1: &'a NonlinearRigidMotion,
    /// The mesh.
    pub mesh: &'a MedialMesh,
    /// Motion of the other shape.
    pub motion2: &'a NonlinearRigidMotion,
    /// The other shape, medial or not.
    pub other: &'a dyn Shape,
    /// Start and end in seconds.
    pub times: [Real; 2],
    /// Distance at which they count as in contact.
    pub target_distance: Real,
    /// How contacts at the start are treated.
    pub at_start: AtStart,
    /// Whether a contact at the start is the answer at least if the two approach, as for parry's straight casts.
    /// Without this, rapier's character controller would sink in.
    pub stop_approach: bool,
}

impl Cast<'_> {
    /// The first contact as a bracket, with the mesh as first body; times are fractions of the duration of the
    /// cast. `options` replace the cast's own target and treatment of contacts at the start. If it is known which
    /// primitives of both are `left` (the mesh first), no others of the mesh are searched.
    pub fn toi(
        &self,
        options: &ToiOptions,
        left: Option<[ActivePrimitives; 2]>,
    ) -> Result<ToiResult, Unsweepable> {
        self.toi_sliding(options, left, None)
    }

    /// Does the same as [`Self::toi`]. Flat faces on whose plane the mesh lies, no deeper than `sinks` allows, are left
    /// out or become planes (`sliding.rs`).
    pub(crate) fn toi_sliding(
        &self,
        options: &ToiOptions,
        left: Option<[ActivePrimitives; 2]>,
        sinks: Option<SinkLimits>,
    ) -> Result<ToiResult, Unsweepable> {
        let [start, end] = self.times;
        let motions = [self.motion1, self.motion2].map(|m| started(m, start));
        let seconds = end - start;
        let finite = motions.iter().all(motion_is_finite);
        if !(finite && seconds >= 0.0 && seconds.is_finite()) {
            let toi = Toi::bad_input(options);
            return Ok(ToiResult::of(toi, Counts::default(), f64::INFINITY));
        }
        // A contact is where the two are to within the tolerance.
        let target = options.target_distance + LIES_ABOVE * options.tolerance;
        let motions = motions.each_ref();
        let slides = |s| Sliding::new((self.mesh, self.other), motions, seconds, target, s);
        let parts = SweptParts::under(sinks.and_then(slides));
        self.query(motions, seconds, options, left, parts)
    }

    /// The hit, with the mesh as first shape, or `None` if there is none.
    pub fn run(&self) -> Result<(Option<ShapeCastHit>, Counts), Unsweepable> {
        let [start, end] = self.times;
        let seconds = end - start;
        let finite = motion_is_finite(self.motion1) && motion_is_finite(self.motion2);
        if !(finite && seconds >= 0.0 && seconds.is_finite()) {
            return Ok((None, Counts::default()));
        }
        let motion1 = started(self.motion1, start);
        let motion2 = started(self.motion2, start);
        let way = (motion1.linvel - motion2.linvel) * seconds;
        let grazing = self.grazing([&motion1, &motion2], way);
        let usual = ToiOptions::default();
        let boxes = [self.mesh.aabb(), self.other.compute_local_aabb()];
        let [own, others] = boxes.map(|b| b.extents().max_element());
        let fine = TOLERANCE_OF_SIZE * own.min(others);
        let mut options = ToiOptions {
            target_distance: self.target_distance,
            tolerance: usual.tolerance.min(fine.max(grazing)),
            ..usual
        };
        if self.stop_approach {
            options.tolerance = options.tolerance.min(PRECISION * grazing);
        }
        let query = |options: &ToiOptions| {
            let motions = [&motion1, &motion2];
            self.query(motions, seconds, options, None, SweptParts::default())
        };
        let found = query(&options)?;
        let ToiResult {
            mut toi,
            mut counts,
            ..
        } = found;
        let stops = self.at_start == AtStart::Stop;
        if toi.upper <= 0.0 && !stops {
            let touching = self.touching([&motion1, &motion2], &toi, options.tolerance)?;
            let further = if !self.stop_approach {
                touching.sinking(self.at_start, self.foreign_thickness(), seconds, &options)
            } else if !touching.approaches(seconds) {
                if touching.is_sure && self.are_convex() {
                    // In straight motion the signed distance of convex bodies is convex in time.
                    return Ok((None, counts));
                }
                touching.unless_nearer(seconds, &options)
            } else {
                let toi = touching.in_place_of(toi);
                return Ok((Some(hit(&toi, [&motion1, &motion2], [start, 0.0])), counts));
            };
            options = further;
            let further = query(&options)?;
            toi = further.toi;
            counts += further.counts;
        }
        // A mesh that slides along at the target distance is within the tolerance of a hit wherever it is, with a
        // normal that may be off by as much as the tolerance lets the nearest points be. A hit it is where it comes
        // nearer by more: otherwise a character could not step up along a wall.
        let slant = 2.0 * options.tolerance / self.target_distance.max(Real::MIN_POSITIVE);
        let slant = slant.sqrt().min(MOST_SLANT);
        let slides =
            toi.status == ToiStatus::Contact && way.dot(toi.normal) <= slant * way.length();
        if slides && self.stop_approach && !stops {
            let by = options.tolerance + grazing;
            options.target_distance -= by;
            let nearer = query(&options)?;
            counts += nearer.counts;
            // Two convex bodies on straight paths come nearer ever more slowly, so before the hit by this much at
            // least.
            let back = by / way.dot(nearer.toi.normal).max(Real::MIN_POSITIVE);
            let lower = (nearer.toi.lower - back).max(toi.lower);
            toi = moved_to(lower, nearer.toi, [&motion1, &motion2], seconds);
        }
        if toi.status == ToiStatus::Separated {
            return Ok((None, counts));
        }
        let times = [start, toi.lower * seconds];
        Ok((Some(hit(&toi, [&motion1, &motion2], times)), counts))
    }

    /// Whether both shapes are known to be convex: then what touches at the start counts by its deepest contact alone.
    fn are_convex(&self) -> bool {
        let is_convex = |mesh: &MedialMesh| PrimitiveTree::is_convex(mesh, 0);
        let other = self.other.as_shape::<MedialMesh>();
        is_convex(self.mesh) && other.map_or_else(|| self.other.is_convex(), is_convex)
    }

    /// Length by which a straight cast that slides along the other shape seems to come nearer, for all that rounding
    /// does.
    fn grazing(&self, motions: [&NonlinearRigidMotion; 2], way: Vector) -> Real {
        let places = motions.map(|m| m.start.translation.abs().max_element());
        let extent = self.mesh.aabb().extents().max_element();
        approach_of_rounding(places[0] + places[1] + extent + way.length())
    }

    /// Thickness of the other shape where it is not medial, infinite where it is: a mesh knows its own.
    fn foreign_thickness(&self) -> Real {
        match self.other.as_shape::<MedialMesh>() {
            Some(_) => Real::INFINITY,
            None => swept_sphere_parts::thickness(self.other),
        }
    }

    /// How they touch at the start, of which the first contact there is known.
    fn touching(
        &self,
        motions: [&NonlinearRigidMotion; 2],
        toi: &Toi,
        tolerance: Real,
    ) -> Result<Touching, Unsweepable> {
        let [start1, start2] = motions.map(|m| m.start);
        // Shapes that the query took for touching may be farther apart by its tolerance, with a normal that says less.
        let reach = self.target_distance + tolerance;
        let pos12 = start1.inverse() * start2;
        let (nearest, _) = distance::nearest(self.mesh, self.other, &pos12, reach)?;
        let least = |mesh: &MedialMesh| mesh.thicknesses().least();
        let other = self.other.as_shape::<MedialMesh>();
        let least = other.map_or(Real::MAX, least).min(least(self.mesh));
        let is_sure = nearest.is_some_and(|c| c.distance > -least);
        let (gap, normal, points, primitives) = match nearest {
            Some(c) => {
                let points = [start1 * c.points[0], start2 * c.points[1]];
                (c.distance, start1.rotation * c.normal, points, c.primitives)
            }
            // Farther off by rounding.
            None => (self.target_distance, toi.normal, toi.points, toi.primitives),
        };
        let velocity = |k: usize| {
            let m = motions[k];
            m.linvel + m.angvel.cross(points[k] - m.start * m.local_center)
        };
        let sizes = [start1.translation, start2.translation, points[0], points[1]];
        Ok(Touching {
            gap,
            normal,
            points,
            primitives,
            is_sure,
            slip: velocity(0) - velocity(1),
            size: sizes.into_iter().map(|p| p.abs().max_element()).sum(),
        })
    }

    /// First contact in `seconds` of motions that start now; times are fractions of it. `parts` have none yet.
    fn query(
        &self,
        [motion1, motion2]: [&NonlinearRigidMotion; 2],
        seconds: Real,
        options: &ToiOptions,
        left: Option<[ActivePrimitives; 2]>,
        mut parts: SweptParts,
    ) -> Result<ToiResult, Unsweepable> {
        if let Some(other) = self.other.as_shape::<MedialMesh>() {
            return Ok(self.search(other, motion1, motion2, seconds, options, left));
        }
        let region = swept_region(
            self.mesh,
            motion1,
            motion2,
            seconds,
            options.target_distance,
        );
        if let Some(sliding) = &mut parts.sliding {
            for_each_flat_face(self.other, &Pose::IDENTITY, &region, &mut |face| {
                sliding.look(face)
            });
        }
        if !swept_sphere_parts::add_shape(&mut parts, self.other, &region) {
            return Err(Unsweepable);
        }
        let axisymmetric = &parts.axisymmetric;
        let mut found = self.search(&parts.primitives, motion1, motion2, seconds, options, left);
        folds::correct_normal(&mut found, &parts, self.mesh, [motion1, motion2], seconds);
        found.toi.primitives[1] = parts.primitive_subshape(found.toi.primitives[1]);
        if !axisymmetric.is_empty() {
            let mut other = axisymmetric_toi::first_contact(
                self.mesh,
                motion1,
                axisymmetric,
                motion2,
                seconds,
                options,
            );
            other.toi.primitives[1] = parts.axisymmetric_subshape(other.toi.primitives[1]);
            found.counts += other.counts;
            found.toi = axisymmetric_toi::earlier(found.toi, other.toi);
            // The spheres that met a cylinder or a cone do not tell the contact.
            if found.toi.lower == other.toi.lower {
                found.met = None;
            }
            found.deepest = found.deepest.min(other.deepest);
        }
        if options.initial_contact == InitialContact::Stop
            && let Some(inside) = self.starts_inside(motion1, motion2, options)
        {
            found.toi = inside;
            found.met = None;
        }
        Ok(found)
    }

    fn search(
        &self,
        other: &impl PrimitiveTree,
        motion1: &NonlinearRigidMotion,
        motion2: &NonlinearRigidMotion,
        seconds: Real,
        options: &ToiOptions,
        left: Option<[ActivePrimitives; 2]>,
    ) -> ToiResult {
        let (motions, bodies) = ([motion1, motion2], (self.mesh, other));
        let found = Query::new(motions, bodies, seconds, options, left).settle();
        ToiResult {
            toi: self.with_normal(found.toi, other, motion1, motion2),
            ..found
        }
    }

    /// The overlap at the start, if a medial sphere's centre is inside the other then, deeper than the
    /// target.
    fn starts_inside(
        &self,
        motion1: &NonlinearRigidMotion,
        motion2: &NonlinearRigidMotion,
        options: &ToiOptions,
    ) -> Option<Toi> {
        let pos21 = motion2.start.inverse() * motion1.start;
        let spheres = self.mesh.spheres();
        let placed = |s: &MedialSphere| MedialSphere::new(pos21 * s.center, s.radius);
        let inside = |s: &MedialSphere| {
            s.radius + options.target_distance >= 0.0
                && inside::holds_point(self.other, pos21 * s.center)
        };
        if !spheres.iter().any(inside) {
            return None;
        }
        let mut toi = Toi {
            status: ToiStatus::Overlapping,
            lower: 0.0,
            upper: 0.0,
            ..Toi::separated(options)
        };
        let placed: Vec<_> = spheres.iter().map(placed).collect();
        if let Some(way) = inside::min_translation(self.other, &placed) {
            let of_sphere = |s: &Simplex| s.vertices.contains(&(way.sphere as u32));
            let primitive = self.mesh.simplices().iter().position(of_sphere);
            let MedialSphere { center, radius } = placed[way.sphere];
            let out = way.direction;
            let world = |p: Vector| motion2.start * p;
            let foot = world(center + out * way.to_surface);
            toi.normal = motion2.start.rotation * -out;
            toi.points = [world(center - out * radius), foot];
            toi.spheres = [
                MedialSphere::new(world(center), radius),
                MedialSphere::new(foot, 0.0),
            ];
            toi.primitives = [primitive.unwrap_or(0) as u32, 0];
        }
        Some(toi)
    }

    /// Adds to an answer the normal and the points of the deepest contact, where medial surfaces cross at the start:
    /// the query leaves these open.
    fn with_normal(
        &self,
        mut toi: Toi,
        other: &impl PrimitiveTree,
        motion1: &NonlinearRigidMotion,
        motion2: &NonlinearRigidMotion,
    ) -> Toi {
        if toi.status != ToiStatus::Overlapping || toi.normal != Vector::ZERO {
            return toi;
        }
        let pos12 = motion1.start.inverse() * motion2.start;
        if let (Some(c), _) = nearest_spheres(self.mesh, other, &pos12, self.target_distance) {
            toi.normal = motion1.start.rotation * c.normal;
            toi.points = [motion1.start * c.points[0], motion2.start * c.points[1]];
            toi.primitives = c.primitives;
        }
        toi
    }
}
