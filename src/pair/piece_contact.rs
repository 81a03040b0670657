//! Where two convex pieces meet, as the search for a first contact finds it ([`super::convex_pieces`]): at the middle
//! of where faces of them lie on each other, so that what falls flat is struck evenly, or else at their nearest points.

use super::face_contacts::{FacingFaces, facing_faces};
use super::hull_gap::{HullGap, PlacedHull, nearest_points};
use super::patch::Patch;
use super::primitive_tree::PrimitiveTree;
use crate::elementary::distance::{Ball, signed_distance, signed_distance_along};
use crate::elementary::penetration::gap_along;
use crate::math::lane::Vec3;
use crate::math::motion::RigidMotion;
use crate::medial::MedialSphere;
use crate::medial::thickness;
use crate::medial::tree::NodeKind;

/// Largest number of times that the nearest primitives are asked for a better direction.
const ROUNDS: usize = 3;

/// Two pieces that are looked at as a whole.
#[derive(Clone, Copy)]
pub(super) struct PiecePair {
    /// The gap of their hulls at which they meet, a length.
    pub(super) contact: f64,
    /// Whether they touched at the start.
    pub(super) touched: bool,
    /// The direction tried last.
    pub(super) direction: Vec3<f64>,
    /// How near they are at a time, where that is known and was not looked at yet.
    pub(super) known: Option<(f64, PieceGap)>,
}

/// Contact of two convex pieces, in the frame of the motions.
#[derive(Clone, Copy)]
pub(super) struct PiecesMet {
    /// Nodes that hold the two pieces, one of each body.
    pub(super) nodes: [u32; 2],
    /// The primitives of them that are about nearest.
    pub(super) primitives: [u32; 2],
    /// Signed distance of these then, never less than that of the bodies.
    pub(super) distance: f64,
    /// Gap of their hulls then, a length.
    pub(super) gap: f64,
    /// The direction of that gap, of length 1, from the first to the second.
    pub(super) normal: Vec3<f64>,
    /// The body with the flattest face, 0 or 1.
    pub(super) of: usize,
    /// Patch in which faces of the two lie on each other, if they do.
    pub(super) patch: Option<Patch>,
}

impl PiecesMet {
    /// Two hulls of which the nearest primitives and the gap are known.
    pub(super) fn of(
        nodes: [u32; 2],
        hulls: [&PlacedHull; 2],
        (primitives, distance, found): ([u32; 2], f64, &HullGap),
        tolerance: f64,
    ) -> Self {
        let (patch, of) = patch(hulls, found.direction, found.gap, [tolerance; 2]);
        Self {
            nodes,
            primitives,
            distance,
            gap: found.gap,
            normal: found.direction,
            of,
            patch,
        }
    }
}

/// Result of a look at the convex pieces that two nodes hold.
pub(super) enum PieceLook {
    /// The pieces do not meet.
    Free,
    /// The pieces do not meet before this time.
    FreeUntil(f64),
    /// The pieces meet.
    Met(Box<PiecesMet>),
    /// The nodes hold no pieces, or their primitives have to decide.
    Split,
}

/// The convex hull of what a node holds, placed at a time.
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

/// Patch in which faces of two hulls lie on each other along a direction, at the depth that `gap` says and up to
/// `margin` (a length) above it, and the hull (0 or 1) with the flattest face.
pub(super) fn patch(
    hulls: [&PlacedHull; 2],
    n: Vec3<f64>,
    gap: f64,
    [tolerance, margin]: [f64; 2],
) -> (Option<Patch>, usize) {
    // Far apart along a direction that is not quite across the faces, the nearest points are not opposite each other.
    let is_opposite = |f: &FacingFaces| gap * n.cross(f.normal).length() <= tolerance;
    let faces = facing_faces(hulls, n, gap + margin).filter(is_opposite);
    let Some(faces) = faces else {
        return (None, 0);
    };
    let corners: Vec<[Vec3<f64>; 2]> = faces.corners.iter().map(|c| c.points).collect();
    (Patch::of(&corners, n), faces.of)
}

/// How near two pieces are at a time.
#[derive(Clone, Copy)]
pub(super) struct PieceGap {
    /// The largest gap of their hulls found: never more than their distance.
    pub(super) hull: HullGap,
    /// Two of their primitives, and the signed distance of these: never less than theirs.
    pub(super) primitives: Option<[u32; 2]>,
    pub(super) distance: f64,
}

impl PieceGap {
    /// The distance of two hulls whose nearest primitives are not known.
    pub(super) fn of(hull: HullGap) -> Self {
        Self {
            hull,
            primitives: None,
            distance: f64::MAX,
        }
    }

    /// The largest gap of two nodes' pieces that can be found, starting from the gap of their hulls, and a pair of
    /// primitives that are about nearest. `place` takes a point from a body's frame to the common one, `local` takes it
    /// back.
    pub(super) fn search(
        ((first, second), nodes): ((&impl PrimitiveTree, &impl PrimitiveTree), [u32; 2]),
        (hulls, hull): ([&PlacedHull; 2], HullGap),
        place: impl Fn(usize, Vec3<f64>) -> Vec3<f64>,
        local: impl Fn(usize, Vec3<f64>) -> Vec3<f64>,
    ) -> Self {
        let [a, b] = hulls.map(|hull| &hull.spheres[..]);
        let mut near = Self::of(nearest_points(hulls, hull));
        let Some(mut points) = near.hull.nearest else {
            return near;
        };
        for _ in 0..ROUNDS {
            let pair = [
                nearest_primitive(first, nodes[0], local(0, points[0])),
                nearest_primitive(second, nodes[1], local(1, points[1])),
            ];
            if near.primitives == Some(pair) {
                break;
            }
            let (of_a, m) = first.primitive(pair[0]);
            let (of_b, n) = second.primitive(pair[1]);
            let placed = |k: usize, s: MedialSphere| {
                (place(k, Vec3::from_vector(s.center)), f64::from(s.radius))
            };
            let (of_a, of_b) = (of_a.map(|s| placed(0, s)), of_b.map(|s| placed(1, s)));
            let (distance, direction) =
                signed_distance_along(&of_a[..m.spheres], &of_b[..n.spheres]);
            if distance < near.distance {
                (near.distance, near.primitives) = (distance, Some(pair));
            }
            let Some(n) = direction else { break };
            let gap = gap_along(a, b, n);
            if gap <= near.hull.gap {
                break;
            }
            (near.hull.gap, near.hull.direction) = (gap, n);
            points = [farthest(a, n), farthest(b, -n)];
        }
        near
    }
}

/// The primitive below a node that is nearest to a point of the body's frame.
pub(super) fn nearest_primitive(body: &impl PrimitiveTree, node: u32, point: Vec3<f64>) -> u32 {
    let bound = |node: u32| {
        let (center, radius) = body.bound(node);
        (point - Vec3::from_vector(center)).length() - f64::from(radius)
    };
    let (mut nearest, mut least) = (0, f64::MAX);
    let mut stack = vec![node];
    while let Some(node) = stack.pop() {
        if bound(node) >= least {
            continue;
        }
        match body.kind(node) {
            NodeKind::Nodes(a, b) => {
                let is_nearer = bound(a) <= bound(b);
                stack.extend(if is_nearer { [b, a] } else { [a, b] });
            }
            NodeKind::Primitive(p) => {
                let (spheres, share) = body.primitive(p);
                let spheres = spheres.map(|s| (Vec3::from_vector(s.center), f64::from(s.radius)));
                let distance = signed_distance(&spheres[..share.spheres], &[(point, 0.0)]);
                if distance < least {
                    (nearest, least) = (p, distance);
                }
            }
        }
    }
    nearest
}

/// The farthest point of spheres along a unit direction.
pub(super) fn farthest(spheres: &[Ball<f64>], n: Vec3<f64>) -> Vec3<f64> {
    let end = |s: &Ball<f64>| n.dot(s.0) + s.1;
    let most = spheres.iter().max_by(|a, b| end(a).total_cmp(&end(b)));
    most.map_or(Vec3::zero(), |(center, radius)| *center + n * *radius)
}

/// Whether what a node holds is blunt ([`thickness::is_blunt`]), or a surface.
pub(super) fn is_blunt(body: &impl PrimitiveTree, node: u32) -> bool {
    match (body.convex_piece(node), body.kind(node)) {
        (Some(piece), _) => piece.is_blunt,
        (None, NodeKind::Primitive(p)) => {
            let (spheres, share) = body.primitive(p);
            !body.thickness(p).is_finite() || thickness::is_blunt(&spheres[..share.spheres])
        }
        (None, NodeKind::Nodes(..)) => false,
    }
}
