//! First contact of two bodies in exact rigid motion: the call for medial meshes, and for all shapes that are given
//! as swept spheres. The paper (§4.1) tests each primitive against each; here a best-first search over two trees of
//! bounding spheres visits the few that can come first.

use super::met::{FacesMet, Met};
use super::outline::ActivePrimitives;
use super::pair_list::PairList;
use super::patch::Patch;
use super::piece_contact::PiecesMet;
use super::primitive_tree::PrimitiveTree;
use super::search::{FirstContactSearch, LOOK};
use crate::elementary::first_contact::{motion_is_finite, rounded_down, to_toi};
use crate::elementary::{Paths, Toi, ToiOptions};
use crate::math::counters::counters;
use crate::math::motion::RigidMotion;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialSphere;
use parry3d::query::NonlinearRigidMotion;
use std::sync::Arc;

counters! {
    /// How much work a query did.
    #[derive(Eq)]
    pub struct Counts {
        /// Pairs of tree nodes that were looked at.
        pub nodes: u64,
        /// Elementary tests that were computed, each counted once.
        pub tests: u64,
        /// Looks at two convex pieces, or at a slab and a cylinder or cone, as a whole, each of which takes about as
        /// long as 16 tests.
        pub looks: u64,
    }
}

impl Counts {
    /// The work in tests, of pairs of tree nodes and of primitives.
    pub fn work(&self) -> u64 {
        self.nodes + self.tests + LOOK * self.looks
    }
}

/// First contact of two medial meshes whose bodies move rigidly for `seconds`.
///
/// Motions are in world space, with velocities per second; times in the answer are fractions of `seconds`. The
/// guarantee is that of [`crate::elementary`], for the union of all primitives. Computed in double precision. Bad
/// input gives [`ToiStatus::Unresolved`](crate::ToiStatus::Unresolved) with `lower = 0`.
///
/// ```
/// use rapier3d::parry::query::NonlinearRigidMotion;
/// use rapier3d_medial::math::{Pose, Vector};
/// use rapier3d_medial::{MedialMesh, ToiOptions, ToiStatus, pair::first_contact};
///
/// // A ball of 0.1 m flies at 2 m/s towards another, 1 m away: they touch after 0.4 s.
/// let ball = MedialMesh::ball(0.1)?;
/// let motion = |x, speed| {
///     let start = Pose::from_translation(Vector::new(x, 0.0, 0.0));
///     NonlinearRigidMotion::new(start, Vector::ZERO, Vector::new(speed, 0.0, 0.0), Vector::ZERO)
/// };
/// let options = ToiOptions::default();
/// let toi = first_contact(&ball, &motion(0.0, 2.0), &ball, &motion(1.0, 0.0), 1.0, &options);
/// assert_eq!(toi.status, ToiStatus::Contact);
/// assert!((toi.upper - 0.4).abs() < 1e-3);
/// # Ok::<(), rapier3d_medial::MeshError>(())
/// ```
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

/// Does the same as [`first_contact`] for any two bodies made of primitives, and also returns the work it took.
pub fn first_contact_counted(
    body1: &impl PrimitiveTree,
    motion1: &NonlinearRigidMotion,
    body2: &impl PrimitiveTree,
    motion2: &NonlinearRigidMotion,
    seconds: Real,
    options: &ToiOptions,
) -> (Toi, Counts) {
    let query = Query::new([motion1, motion2], (body1, body2), seconds, options, None);
    let found = query.settle();
    (found.toi, found.counts)
}

/// Everything that a query found.
#[derive(Clone, Debug, PartialEq)]
pub struct ToiResult {
    /// First contact, with the guarantee of [`first_contact()`].
    pub toi: Toi,
    /// Work it took.
    pub counts: Counts,
    /// How deep primitives may get that touched at the start ([`Query::deepest`]).
    pub deepest: f64,
    /// The primitives or faces that met ([`Query::met`]).
    pub met: Option<Met>,
}

impl ToiResult {
    /// A first contact of which it is not known what met.
    pub fn of(toi: Toi, counts: Counts, deepest: f64) -> Self {
        Self {
            toi,
            counts,
            deepest,
            met: None,
        }
    }
}

/// The query of [`first_contact`], which can be interrupted and resumed, so that it is computed only as far as its
/// answer matters. The answer is the same, bit by bit, however often it is interrupted.
pub struct Query<'a, A, B> {
    motions: [NonlinearRigidMotion; 2],
    seconds: Real,
    options: ToiOptions,
    /// `None` for bad input.
    pub(super) search: Option<FirstContactSearch<'a, A, B>>,
    settled: bool,
}

impl<'a, A: PrimitiveTree, B: PrimitiveTree> Query<'a, A, B> {
    /// A query of which nothing is computed yet. If it is known which primitives of two meshes are `left`, because all
    /// others cannot meet, only these are searched.
    pub fn new(
        motions: [&NonlinearRigidMotion; 2],
        bodies: (&'a A, &'a B),
        seconds: Real,
        options: &ToiOptions,
        left: Option<[ActivePrimitives; 2]>,
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
            FirstContactSearch::new(bodies, pair, options, left)
        };
        Self {
            motions: motions.map(|m| *m),
            seconds,
            options: *options,
            search: (finite && bounds_finite).then(search),
            settled: false,
        }
    }

    /// Has the search go down to listed primitive pairs only.
    pub fn among(mut self, pairs: Option<&PairList>) -> Self {
        if let (Some(search), Some(PairList(listed))) = (&mut self.search, pairs) {
            search.sides.0.keep_near(Arc::clone(listed), 0);
            search.sides.1.keep_near(Arc::clone(listed), 1);
        }
        self
    }

    /// Continues the search until it is proven that nothing meets before a time of at least `until`, a fraction of the
    /// step. Returns that time, rounded down, or `None` if the query is settled; with `until` at 1 it always is.
    pub fn search(&mut self, until: f64) -> Option<Real> {
        self.search_within(until, u64::MAX)
    }

    /// Continues the search like [`Self::search`], but pauses after about `work` node pairs and tests, and then returns
    /// the time before which nothing meets as far as is proven.
    pub fn search_within(&mut self, until: f64, work: u64) -> Option<Real> {
        if self.settled {
            return None;
        }
        let run = |s: &mut FirstContactSearch<A, B>| {
            s.pause = s.worked().saturating_add(work);
            s.run(until)
        };
        let free = self.search.as_mut().and_then(run);
        self.settled = free.is_none();
        free.map(rounded_down)
    }

    /// Continues the search to the end.
    pub fn settle(mut self) -> ToiResult {
        self.search(1.0);
        ToiResult {
            toi: self.toi(),
            counts: self.counts(),
            deepest: self.deepest(),
            met: self.met(),
        }
    }

    /// How deep primitives may get that touched at the start and are allowed to sink in
    /// ([`crate::elementary::InitialContact::Deepen`]): the smallest signed distance, minus the distance that counts as
    /// touching, minus what they may sink in, in units of the thickness of the thinner of the two. Infinite if none
    /// touched. It is complete as soon as it is proven that nothing meets before some time above 0.
    pub fn deepest(&self) -> f64 {
        let depths = self.search.iter().flat_map(|s| &s.touching).map(|t| t.1);
        depths.fold(f64::INFINITY, f64::min)
    }

    /// The pairs of primitives, or of convex pieces, that touched at the start and may get that deep or deeper, in the
    /// units of [`Self::deepest`]; `None` if there are none.
    pub fn may_get_to(&self, depth: f64) -> Option<PairList> {
        let search = self.search.as_ref()?;
        let deep = search.touching.iter().filter(|t| t.1 <= depth);
        let pairs: Vec<[u32; 2]> = deep.map(|t| t.0).collect();
        let bodies = (search.sides.0.body, search.sides.1.body);
        (!pairs.is_empty()).then(|| PairList::of_nodes(bodies, &pairs))
    }

    /// The answer, once the query is settled.
    pub fn toi(&self) -> Toi {
        self.shielded(self.toi_of_found())
    }

    /// The answer with the primitives that were found.
    fn toi_of_found(&self) -> Toi {
        let Some(FirstContactSearch {
            sides,
            earliest,
            found,
            met,
            ..
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
            let i = usize::from(i);
            let s = found.map_or(spheres[i], |of| of.parts[side].sphere(&spheres, i));
            MedialSphere::new(self.pose_at(side, t) * s.center, s.radius)
        };
        let toi = to_toi(earliest, &self.options, pose);
        met.as_ref().map_or(toi, |met| self.of_pieces(toi, met))
    }

    /// Pose of a body at a time, a fraction of the step.
    pub(super) fn pose_at(&self, side: usize, time: Real) -> Pose {
        self.motions[side].position_at_time(time * self.seconds)
    }

    /// The answer with what is known of two convex pieces that met.
    fn of_pieces(&self, toi: Toi, met: &PiecesMet) -> Toi {
        let nearest = (toi.points[0] + toi.points[1]) * 0.5;
        let on_faces = |patch: Patch| self.origin(&toi) + patch.middle.to_vector();
        let middle = met.patch.map_or(nearest, on_faces);
        let half = (met.normal * (0.5 * met.gap)).to_vector();
        Toi {
            normal: met.normal.to_vector(),
            points: [middle - half, middle + half],
            ..toi
        }
    }

    /// Origin of the motions' frame, which begins at the first body's and goes along with the second.
    fn origin(&self, toi: &Toi) -> Vector {
        let [first, second] = &self.motions;
        first.start.translation + second.linvel * (toi.lower * self.seconds)
    }

    /// The primitives or faces that met, or the primitives that shield those, once the query is settled and has found a
    /// contact.
    pub fn met(&self) -> Option<Met> {
        let search = self.search.as_ref()?;
        let (_, found, primitives) = search.earliest.found?;
        let (a, b) = (search.sides.0.body, search.sides.1.body);
        if let Some(shield) = self.shielding_contact(&self.toi_of_found()) {
            let [p, q] = shield.primitives;
            let [(a, of_a), (b, of_b)] = [a.primitive(p), b.primitive(q)];
            return Some(Met::primitives([a, b], [of_a.spheres, of_b.spheres]));
        }
        if let Some(met) = &search.met
            && let Some(patch) = search.joined.or(met.patch)
        {
            let frames = [0, 1].map(|k| search.motions[k].frame(found.lower));
            let corners =
                [0, 1].map(|k| (patch.extremes()).map(|pair| frames[k].local(pair[k]).to_vector()));
            let normal = frames[met.of].local_direction(met.normal);
            return Some(Met::faces(FacesMet {
                corners,
                normal,
                of: met.of,
            }));
        }
        let whole = [a.primitive(primitives[0]), b.primitive(primitives[1])];
        let counted = |side: usize| {
            let (all, share) = whole[side];
            let Some(of) = search.found else {
                return (all, share.spheres);
            };
            let spheres = [0, 1, 2].map(|k| {
                let s = of.parts[side].sphere(&all, k);
                MedialSphere::new(s.center, of.threshold.scale as Real * s.radius)
            });
            (spheres, of.parts[side].spheres)
        };
        let [(a, m), (b, n)] = [counted(0), counted(1)];
        Some(Met::primitives([a, b], [m, n]))
    }

    /// The work done so far.
    pub fn counts(&self) -> Counts {
        let of = |s: &FirstContactSearch<A, B>| Counts {
            nodes: s.nodes.into(),
            tests: s.earliest.tests.into(),
            looks: s.looks,
        };
        self.search.as_ref().map(of).unwrap_or_default()
    }
}
