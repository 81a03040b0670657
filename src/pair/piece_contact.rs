//! Where two convex pieces meet, as the search for a first contact finds it ([`super::convex_pieces`]): at the middle of
//! where faces of them lie on each other, so that what falls flat is struck evenly, or else at their nearest points.

use super::face_contacts::{SECOND, face_corners};
use super::hull_gap::PlacedHull;
use super::patch::Patch;
use super::placement::Placement;
use super::primitive_tree::{PrimitiveTree, below};
use super::sphere_pair::SpherePair;
use crate::elementary::distance::signed_distance;
use crate::math::Pose;
use crate::math::lane::Vec3;
use crate::math::motion::RigidMotion;

/// Two pieces that are looked at as a whole.
#[derive(Clone, Copy)]
pub(super) struct Pieces {
    /// The gap of their hulls at which they meet, a length.
    pub(super) contact: f64,
    /// Whether they touched at the start.
    pub(super) touched: bool,
    /// The direction tried last.
    pub(super) direction: Vec3<f64>,
}

/// Where two pieces met, in the frame of the motions.
#[derive(Clone, Copy)]
pub(super) struct PiecesMet {
    /// The bodies' nodes that hold them.
    pub(super) nodes: [u32; 2],
    /// Gap of their hulls then, a length.
    pub(super) gap: f64,
    /// The direction of that gap, of length 1, from the first to the second.
    pub(super) normal: Vec3<f64>,
    /// The body with the flattest face, 0 or 1.
    pub(super) of: usize,
    /// Where faces of them lie on each other, if they do.
    pub(super) patch: Option<Patch>,
    /// Their nearest points, to single precision.
    pub(super) nearest: [Vec3<f64>; 2],
}

/// What a look at two nodes says of the convex pieces that they hold.
pub(super) enum Look {
    /// They do not meet.
    Free,
    /// They do not meet before this time.
    FreeUntil(f64),
    /// They meet.
    Met(PiecesMet),
    /// They hold no pieces, or their primitives decide.
    Split,
}

/// What a node holds at a time, as a hull.
pub(super) fn placed<'a>(
    body: &'a impl PrimitiveTree,
    motion: &RigidMotion<f64>,
    node: u32,
    time: f64,
) -> PlacedHull<'a> {
    let turned = motion.sin_cos(time);
    let point = |p| motion.point(Vec3::from_vector(p)).at(time, turned).position;
    let direction = |n| motion.direction(Vec3::from_vector(n), turned);
    PlacedHull::of_node(body, node, point, direction)
}

/// Where faces of two hulls lie on each other along a direction, as deep as a gap says, and which of the two has the flattest.
pub(super) fn patch(
    hulls: [&PlacedHull; 2],
    n: Vec3<f64>,
    gap: f64,
    tolerance: f64,
) -> (Option<Patch>, usize) {
    let place = Placement::new(&Pose::IDENTITY);
    let corners = face_corners(hulls, n, [0; 2], &place, gap + tolerance);
    let middle = |c: &SpherePair| Vec3::from_vector((c.points[0] + c.points[1]) * 0.5);
    let middles: Vec<Vec3<f64>> = corners.iter().map(middle).collect();
    let of = corners.first().is_some_and(|c| c.feature & SECOND != 0);
    (Patch::of(&middles), of.into())
}

/// The primitive below a node that is nearest to a point at a time.
pub(super) fn nearest_primitive(
    body: &impl PrimitiveTree,
    motion: &RigidMotion<f64>,
    node: u32,
    point: Vec3<f64>,
    time: f64,
) -> u32 {
    let turned = motion.sin_cos(time);
    let distance = |p: &u32| {
        let (spheres, share) = body.primitive(*p);
        let spheres = spheres.map(|s| {
            let center = motion.point(Vec3::from_vector(s.center));
            (center.at(time, turned).position, f64::from(s.radius))
        });
        signed_distance(&spheres[..share.spheres], &[(point, 0.0)])
    };
    let all = below(body, node).into_iter().map(|p| (distance(&p), p));
    all.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |(_, p)| p)
}
