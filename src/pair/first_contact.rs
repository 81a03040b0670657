//! First contact of two bodies in exact rigid motion: the call for medial meshes, and for all shapes that are given
//! as swept spheres. The paper (§4.1) tests each primitive against each; here a best-first search over two trees of
//! bounding spheres visits the few that can come first.

use super::outline::Left;
use super::search::Search;
use super::volumes::Volumes;
use crate::elementary::first_contact::{motion_is_finite, rounded_down, to_toi};
use crate::elementary::{Paths, Toi, ToiOptions};
use crate::math::Real;
use crate::math::motion::RigidMotion;
use crate::medial::MedialSphere;
use parry3d::query::NonlinearRigidMotion;

/// Work done by one query.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Node pairs looked at.
    pub nodes: u32,
    /// Elementary tests whose kernel ran, however often.
    pub tests: u32,
}

/// First contact of two meshes whose bodies move rigidly over `seconds`.
///
/// Motions are in world space, velocities per second; times in the answer are fractions of the
/// step. The guarantee is that of [`crate::elementary`], for the union of all primitives. Computed
/// in double precision.
pub fn first_contact(
    mesh1: &crate::MedialMesh,
    motion1: &NonlinearRigidMotion,
    mesh2: &crate::MedialMesh,
    motion2: &NonlinearRigidMotion,
    seconds: Real,
    options: &ToiOptions,
) -> Toi {
    first_contact_counted(mesh1, motion1, mesh2, motion2, seconds, options).0
}

/// As [`first_contact`] for any two bodies, with the work it took.
pub fn first_contact_counted(
    body1: &impl Volumes,
    motion1: &NonlinearRigidMotion,
    body2: &impl Volumes,
    motion2: &NonlinearRigidMotion,
    seconds: Real,
    options: &ToiOptions,
) -> (Toi, Counts) {
    let query = Query::new([motion1, motion2], (body1, body2), seconds, options, None);
    let found = query.settle();
    (found.toi, found.counts)
}

/// All that a query found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToiResult {
    /// First contact, with the guarantee of [`first_contact()`].
    pub toi: Toi,
    /// Work it took.
    pub counts: Counts,
    /// As [`Query::deepest`].
    pub deepest: f64,
}

/// A query of [`first_contact`] that is taken only as far as its answer matters. Its answer is the same,
/// bit by bit, however often it pauses.
pub struct Query<'a, A, B> {
    motions: [NonlinearRigidMotion; 2],
    seconds: Real,
    options: ToiOptions,
    /// `None` for bad input.
    search: Option<Search<'a, A, B>>,
    settled: bool,
}

impl<'a, A: Volumes, B: Volumes> Query<'a, A, B> {
    /// Nothing is searched yet. Where it is known what is `left` of two meshes, nothing else is looked at.
    pub fn new(
        motions: [&NonlinearRigidMotion; 2],
        bodies: (&'a A, &'a B),
        seconds: Real,
        options: &ToiOptions,
        left: Option<[Left; 2]>,
    ) -> Self {
        let finite = motions.iter().all(|m| motion_is_finite(m)) && seconds.is_finite();
        let bounds_finite = options.tolerance.is_finite()
            && options.time_tolerance.is_finite()
            && options.target_distance.is_finite();
        let search = || {
            let [motion1, motion2] = motions;
            let mut pair = RigidMotion::<f64>::pair(motion1, motion2, seconds.into());
            if options.paths == Paths::Straight {
                pair = pair.map(|m| m.straightened());
            }
            Search::new(bodies, pair, options, left)
        };
        Self {
            motions: motions.map(|m| *m),
            seconds,
            options: *options,
            search: (finite && bounds_finite).then(search),
            settled: false,
        }
    }

    /// Searches on, until nothing meets before some time after `until`, a fraction of the step. Returns that
    /// time, rounded down, or `None` once the query is settled: with `until` at 1 it always is.
    pub fn search(&mut self, until: f64) -> Option<Real> {
        if self.settled {
            return None;
        }
        let free = self.search.as_mut().and_then(|s| s.run(until));
        self.settled = free.is_none();
        free.map(rounded_down)
    }

    /// Searches to the end.
    pub fn settle(mut self) -> ToiResult {
        self.search(1.0);
        ToiResult {
            toi: self.toi(),
            counts: self.counts(),
            deepest: self.deepest(),
        }
    }

    /// How deep primitives that touched at the start and were let sink in
    /// ([`crate::elementary::InitialContact::Deepen`]) were: the least signed distance, less what counts as
    /// touching, in units of the thickness of the thinner of the two. Infinite where none touched. All of them are known once
    /// nothing meets before a time after 0.
    pub fn deepest(&self) -> f64 {
        self.search.as_ref().map_or(f64::INFINITY, |s| s.deepest)
    }

    /// The answer, once it is settled.
    pub fn toi(&self) -> Toi {
        let Some(Search {
            sides, earliest, ..
        }) = &self.search
        else {
            return Toi::bad_input(&self.options);
        };
        let pose = |side: usize, i: u8, t: Real| {
            let Some((_, _, primitives)) = earliest.found else {
                return MedialSphere::default();
            };
            let spheres = match side {
                0 => sides.0.body.primitive(primitives[0]).0,
                _ => sides.1.body.primitive(primitives[1]).0,
            };
            let s = spheres[i as usize];
            let at = self.motions[side].position_at_time(t * self.seconds);
            MedialSphere::new(at * s.center, s.radius)
        };
        to_toi(earliest, &self.options, pose)
    }

    /// Work done so far.
    pub fn counts(&self) -> Counts {
        let of = |s: &Search<A, B>| Counts {
            nodes: s.nodes,
            tests: s.earliest.tests,
        };
        self.search.as_ref().map(of).unwrap_or_default()
    }
}
