//! Misdirected contacts of convex pieces of a medial mesh that are deep in another convex shape: those that push the
//! piece another way than the shortest one out. They are removed.
//!
//! parry finds the contacts of each primitive of a mesh with another shape by itself. If a box is put across a floor,
//! some of its slabs are out sooner above the floor and others below it: these pull the box to and fro, and in the end
//! throw it. parry's EPA algorithm, asked for the piece as a whole, finds the way out of all of it.

use crate::math::fast_hash::FastMap;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::pair::{FILTER_DEPTH, Support};
use crate::parry::contacts::convex_parts::child_of;
use crate::parry::contacts::scaled_contact;
use parry3d::bounding_volume::Aabb;
use parry3d::query::ContactManifold;
use parry3d::shape::{Shape, SupportMap};

/// Cosine of the angle between a contact's normal and the way out from which on the contact helps. No other value was
/// tried.
const HELPING_COSINE: Real = 0.5;

/// Removes contacts of deep pieces that do not push them the shortest way out, as long as others of the piece do. The
/// mesh is body `side` (0 or 1) of the manifolds; `other` is the other shape, and its pose in the mesh's frame.
pub fn leave_out<M, C>(
    manifolds: &mut [ContactManifold<M, C>],
    (mesh, side): (&MedialMesh, usize),
    other: (&dyn Shape, &Pose),
) {
    let pieces = mesh.convex_pieces();
    if pieces.is_empty() {
        return;
    }
    let ids = |m: &ContactManifold<M, C>| {
        let [own, others] =
            [[m.subshape1, m.subshape2], [m.subshape2, m.subshape1]].map(|k| k[side]);
        pieces.node_of(own).map(|node| [node, others])
    };
    let mut ways: FastMap<[u32; 2], Option<Vector>> = FastMap::default();
    for m in manifolds.iter() {
        let depth = m.points.iter().map(|p| -p.dist).fold(0.0, Real::max);
        if let Some([node, part]) = ids(m)
            && let Some(piece) = pieces.of_node(node)
            && depth > FILTER_DEPTH as Real * piece.thickness
        {
            let spheres = piece.spheres.iter().map(|s| (s.center, s.radius));
            ways.entry([node, part])
                .or_insert_with(|| way_out(&Support(spheres.collect()), other, part));
        }
    }
    let helps = |m: &ContactManifold<M, C>, way: Vector| {
        [m.local_n1, m.local_n2][side].dot(way) >= HELPING_COSINE
    };
    ways.retain(|of, way| {
        let of_it = |m: &&ContactManifold<M, C>| ids(m) == Some(*of) && !m.points.is_empty();
        way.is_some_and(|way| manifolds.iter().filter(of_it).any(|m| helps(m, way)))
    });
    for m in manifolds {
        let way = ids(m).and_then(|of| *ways.get(&of)?);
        if way.is_some_and(|way| !helps(m, way)) {
            m.points.clear();
        }
    }
}

/// The direction into a convex part of the other shape along which a piece is least deep in it.
fn way_out(piece: &Support, (other, pose): (&dyn Shape, &Pose), part: u32) -> Option<Vector> {
    let (other, pose) = child_of((other, pose), part)?;
    let bounds = [
        Aabb::from_points(piece.0.iter().flat_map(|(c, r)| [*c - *r, *c + *r])),
        other.compute_local_aabb(),
    ];
    let maps: [&dyn SupportMap; 2] = [piece, other.as_support_map()?];
    let contact = scaled_contact::contact(&pose, maps, bounds.each_ref(), 0.0)?;
    Some(contact.normal1)
}
